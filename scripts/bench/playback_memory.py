#!/usr/bin/python3
"""A film four times larger than the memory it is played in: forward, backward and by random jumps.

Makes a ball that moves through a grid, plays it with tet4d-play under a data limit (as prlimit --data sets it) of a
quarter of the file, and compares every picture with the same film played without a limit: one that waits for its pages
must be the same, byte by byte; one that draws what has come (--arrival draw) must be the same wherever no page was
absent. Pictures that differ end the script with 1. Times are told, not judged.

usage: scripts/bench/playback_memory.py --bin build/release/tools --work FOLDER [--size 64] [--frames 321] [--films forward,…] [--table FILE]
"""
import argparse
import json
import pathlib
import random
import resource
import shutil
import statistics
import subprocess
import sys

import numpy

STACK_BYTES = 1 << 20  # of a thread: the limit counts stacks as if they were full
WIDTH, HEIGHT = 320, 240


def make(options, work):
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
            "| film | arrival | pictures | median ms | p95 | longest | longest / median | absent pages | read / file | unused | pages' peak MB |",
            "|---|---|---|---|---|---|---|---|---|---|---|"]
    wrong = 0
    for name, times in films(options.frames).items():
        if name not in options.films.split(","):
            continue
        right, _ = play(options, options.work, "free", file, times)
        for arrival in ("wait", "draw"):
            words = ["--memory", memory, "--arrival", arrival, "--fps", "12"]
            pictures, told = play(options, options.work, "bound", file, times, limit, words)
            shown = told["frames"]
            wrong += sum(a != b and not f["absent"] for a, b, f in zip(right, pictures, shown, strict=True))
            wrong += sum(f["absent"] for f in shown) if arrival == "wait" else 0
            ms = sorted(f["ms"] for f in shown[1:])
            middle, counts = statistics.median(ms), told["counts"]
            rows.append(f"| {name} | {arrival} | {len(shown)} | {middle:.1f} | {ms[int(0.95 * len(ms))]:.1f} | {ms[-1]:.1f} | {ms[-1] / middle:.2f} | "
                        f"{sum(f['absent'] for f in shown)} | {counts['page_bytes_read'] / file.stat().st_size:.2f} | "
                        f"{100 * counts['page_bytes_unused'] / max(counts['page_bytes_read'], 1):.0f} % | {counts['page_bytes_peak'] / 1e6:.0f} |")
    text = "\n".join(rows) + "\n"
    print(text)
    if options.table:
        options.table.write_text(text)
    shutil.rmtree(options.work)
    if wrong:
        print(f"{wrong} wrong pictures")
        sys.exit(1)


main()
