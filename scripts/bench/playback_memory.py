#!/usr/bin/python3
"""A film four times larger than the memory it is played in: forward, backward and by random jumps.

Makes a ball that moves through a grid, plays it with tet4d-play under a data limit (as prlimit --data sets it) of a
quarter of the file, and compares every picture with the same film played without a limit: one that waits for its pages
must be the same, byte by byte; one that draws what has come (--arrival draw) must be the same wherever no page was
absent. Pictures that differ end the script with 1, and so do stalls of the pager in films that run forward or backward:
a picture after the first that spent more on asking and waiting for its pages (load_ms of --stats) than two medians of a
whole picture and 20 ms. A film that stalls while other programs keep the machine busy is played again, three times at
most. Other times are told, not judged: the first two pictures, whose buffers are new, apart from the rest.

usage: scripts/bench/playback_memory.py --bin build/release/tools --work FOLDER [--size 64] [--frames 321] [--films forward,…] [--table FILE]
"""
import argparse
import json
import os
import pathlib
import random
import resource
import shutil
import statistics
import subprocess
import sys
import time

STACK_BYTES = 1 << 20  # of a thread: the limit counts stacks as if they were full
WIDTH, HEIGHT = 320, 240
NEW = 2  # pictures that fill buffers for the first time
STALL_MEDIANS, STALL_FLOOR_MS = 2, 20
LONGEST_MEDIANS = 3  # of a whole picture of a film that waits; longer ones are nobody's fault if the film without a limit has them too
RUNNING = ("forward", "backward")  # whose next pages are known
PLAYS, MAX_BUSY = 3, 0.1  # of a film that stalls on a machine whose cores other programs use to more than this share

COLUMNS = ["film", "arrival", "pictures", "first two ms", "median ms", "p95", "longest", "longest / median", "… without a limit", "longest load ms",
           "plays", "others", "absent pages", "read / file", "unused", "pages' peak MB"]


def make(options, work):
    import numpy

    size, frames = options.size, options.frames
    axis = numpy.arange(size, dtype=numpy.float32)
    z, y, x = numpy.meshgrid(axis, axis, axis, indexing="ij", sparse=True)
    mc = subprocess.Popen([options.bin / "tet4d-mc", "-", "--size", f"{size},{size},{size}", "--type", "f32", "--iso", "0", "-q",
                           "-o", work / "ball.t4h"], stdin=subprocess.PIPE)
    for k in range(frames):
        centre = 0.4 * size + 0.2 * size * k / frames
        ball = 0.31 * size - numpy.sqrt((x - centre) ** 2 + (y - 0.503 * size) ** 2 + (z - 0.497 * size) ** 2)
        mc.stdin.write(ball.astype(numpy.float32).tobytes())
    mc.stdin.close()
    assert mc.wait() == 0
    subprocess.run([options.bin / "dyntri-build", work / "ball.t4h", "-q", "-o", work / "ball.t4d"], check=True)
    (work / "ball.t4h").unlink()
    return work / "ball.t4d"


def play(options, work, name, file, times, limit=None, words=()):
    def bound():
        resource.setrlimit(resource.RLIMIT_STACK, (STACK_BYTES, resource.getrlimit(resource.RLIMIT_STACK)[1]))
        if limit:
            resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))

    film, stats = work / f"{name}.y4m", work / f"{name}.json"
    subprocess.run([options.bin / "tet4d-play", file, "--offscreen", "--renderer", "cpu", "--size", f"{WIDTH}x{HEIGHT}", "--samples", "1",
                    "--times", times, "-q", "-f", "-o", film, "--stats", stats, *words], check=True, preexec_fn=bound)
    told = json.loads(stats.read_text())
    content = film.read_bytes()
    start = content.index(b"\n") + 1
    step = 6 + WIDTH * HEIGHT * 3 // 2
    pictures = [content[start + i * step : start + (i + 1) * step] for i in range(len(told["frames"]))]
    film.unlink()
    return pictures, told


def times_of(frames):
    """What the frames of --stats say of their times, in milliseconds."""
    rest = sorted(f["ms"] for f in frames[NEW:])
    return {"first": [f["ms"] for f in frames[:NEW]], "median": statistics.median(rest), "p95": rest[int(0.95 * len(rest))],
            "longest": rest[-1], "load": max(f["load_ms"] for f in frames[1:])}


def stalls(name, arrival, told, free):
    """What a film did that it should not, in words: a picture of a running film waited for the pager (jumps have to: their pages are
    not known before), or a whole picture took longer than the bar and than any of the film without a limit."""
    if name in RUNNING and told["load"] > STALL_MEDIANS * told["median"] + STALL_FLOOR_MS:
        return f"{name}, {arrival}: a picture waited {told['load']:.1f} ms for its pages, of {told['median']:.1f} ms a picture"
    if arrival == "wait" and told["longest"] > max(LONGEST_MEDIANS * told["median"], free["longest"]):
        return (f"{name}, {arrival}: a picture took {told['longest']:.1f} ms, {told['median']:.1f} ms the median, {free['longest']:.1f} ms the "
                "longest without a limit")
    return ""


def cpu_seconds():
    """Of all programs on this machine, and of this one with its children."""
    with open("/proc/stat", encoding="ascii") as file:
        ticks = [int(word) for word in file.readline().split()[1:9]]
    ours = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return (sum(ticks) - ticks[3] - ticks[4]) / os.sysconf("SC_CLK_TCK"), sum(one.ru_utime + one.ru_stime for one in ours)


def watched(action):
    """What the action returns, and the share of the cores that other programs had meanwhile."""
    start, (all_before, ours_before) = time.monotonic(), cpu_seconds()
    result = action()
    all_after, ours_after = cpu_seconds()
    spent = (time.monotonic() - start) * os.cpu_count()
    return result, max(0.0, (all_after - all_before - ours_after + ours_before) / spent)


def films(frames):
    jumps = random.Random(4)
    last = frames - 1
    return {
        "forward": f"0f:{last}f:0.5f",
        "backward": f"{last}f:0f:-0.5f",
        # Each time stays for four pictures, as under a hand that stops to look.
        "jumps": ",".join(",".join(4 * [f"{jumps.uniform(0, last):.3f}f"]) for _ in range(last // 4)),
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--frames", type=int, default=321)
    parser.add_argument("--films", default="forward,backward,jumps")
    parser.add_argument("--table", type=pathlib.Path)
    options = parser.parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    options.work.mkdir(parents=True)
    file = make(options, options.work)
    limit = file.stat().st_size // 4
    memory = str(limit * 3 // 4)
    rows = [f"File {file.stat().st_size / 1e6:.0f} MB, data limit {limit / 1e6:.0f} MB, of it --memory {int(memory) / 1e6:.0f} MB.", "",
            "| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    wrong, stalled = 0, []
    for name, times in films(options.frames).items():
        if name not in options.films.split(","):
            continue
        right, told = play(options, options.work, "free", file, times)
        free = times_of(told["frames"])
        for arrival in ("wait", "draw"):
            words = ["--memory", memory, "--arrival", arrival, "--fps", "12"]
            for plays in range(1, PLAYS + 1):
                (pictures, told), others = watched(lambda: play(options, options.work, "bound", file, times, limit, words))
                shown = told["frames"]
                wrong += sum(a != b and not f["absent"] for a, b, f in zip(right, pictures, shown, strict=True))
                wrong += sum(f["absent"] for f in shown) if arrival == "wait" else 0
                ms, counts = times_of(shown), told["counts"]
                if not stalls(name, arrival, ms, free) or others <= MAX_BUSY:
                    break
            stalled += filter(None, [stalls(name, arrival, ms, free)])
            cells = [name, arrival, len(shown), ", ".join(f"{one:.1f}" for one in ms["first"]), f"{ms['median']:.1f}", f"{ms['p95']:.1f}",
                     f"{ms['longest']:.1f}", f"{ms['longest'] / ms['median']:.2f}", f"{free['longest'] / free['median']:.2f}",
                     f"{ms['load']:.1f}", plays, f"{100 * others:.0f} %",
                     sum(f["absent"] for f in shown), f"{counts['page_bytes_read'] / file.stat().st_size:.2f}",
                     f"{100 * counts['page_bytes_unused'] / max(counts['page_bytes_read'], 1):.0f} %", f"{counts['page_bytes_peak'] / 1e6:.0f}"]
            assert len(cells) == len(COLUMNS)
            rows.append("| " + " | ".join(map(str, cells)) + " |")
    text = "\n".join(rows) + "\n"
    print(text)
    if options.table:
        options.table.write_text(text)
    shutil.rmtree(options.work)
    if wrong:
        print(f"{wrong} wrong pictures")
    for line in stalled:
        print(f"stall: {line}")
    if wrong or stalled:
        sys.exit(1)


if __name__ == "__main__":
    main()
