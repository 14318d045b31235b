#!/usr/bin/python3
"""The renderers beside one another: plain C++ (cpu), OpenGL's lookup shader (gl, gl --flat) and the paper's baseline (tets).

A film of pictures half a frame apart, then jumps: each page once, in an order in which no page follows its neighbour,
held for some pictures. Time to adapt is what the first picture after a jump takes beyond the median of those that
follow it on the same page. Prints the rows of docs/benchmarks/playback.md.

usage: scripts/bench/renderers.py --bin build/release/tools --work FOLDER [--data tests/data/dambreak] [--mesh X.t4h]
       [--size 1024x1024] [--step 0.5] [--renderers cpu,gl,gl-flat,tets] [--label COMMIT]
"""
import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys

HELD = 4  # pictures on a page


def make(options):
    mesh = options.mesh or options.work / "renderers.t4h"
    if not options.mesh:
        frames = sorted(options.data.glob("*.nrrd"))
        subprocess.run([options.bin / "tet4d-mc", *frames, "--iso", "0.5", "--cap", "-q", "-f", "-o", mesh], check=True)
    triangles = options.work / "renderers.t4d"
    stats = options.work / "renderers-build.json"
    subprocess.run([options.bin / "dyntri-build", mesh, "-q", "-f", "-o", triangles, "--stats", stats], check=True)
    counts = json.loads(stats.read_text())["counts"]
    return mesh, triangles, counts["tets"], counts["frames"] - 1


def play(options, renderer, file, times, words):
    stats = options.work / "renderers.json"
    name, *flags = renderer.split("-")
    command = [options.bin / "tet4d-play", file, "--offscreen", "--renderer", name, "--samples", "1", "--size", options.size,
               "--times", times, "--format", "y4m", "-o", os.devnull, "-q", "-f", "--stats", stats,
               *(["--flat"] if "flat" in flags else []), *words]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    told = json.loads(stats.read_text())
    told["cpu_s"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return told


# Page k holds the frames k to k + 1; the first visit warms up what is compiled when it is first drawn.
def jump_times(last):
    pages = [p for p in (k * 13 % last for k in range(last))] if last % 13 else list(range(0, last, 2))
    return pages, ",".join(f"{page + 0.2 + 0.15 * i:g}f" for page in pages for i in range(HELD))


def adapt(told):
    ms = [frame["ms"] for frame in told["frames"]]
    visits = [ms[i:i + HELD] for i in range(HELD, len(ms), HELD)]
    first = [visit[0] for visit in visits]
    later = [statistics.median(visit[1:]) for visit in visits]
    extra = [a - b for a, b in zip(first, later)]
    return statistics.median(first), statistics.median(later), statistics.median(extra)


def row(options, renderer, mesh, triangles, tets, last):
    file = mesh if renderer == "tets" else triangles
    words = ["--camera", options.camera] if options.camera else []
    film = play(options, renderer, file, f"0f:{last}f:{options.step}f", words)
    jumps = play(options, renderer, file, jump_times(last)[1], words)
    frames = film["frames"]
    ms = [frame["ms"] for frame in frames]
    drawn, processed = (sum(frame[key] for frame in frames) for key in ("drawn", "processed"))
    gpu = film["counts"].get("gpu_bytes", 0)
    first, later, extra = adapt(jumps)
    return [renderer.replace("-", " --"), options.label, f"{os.getloadavg()[0]:.1f}", f"{statistics.median(ms):.1f} (longest {max(ms):.0f})",
            f"{film['cpu_s']:.1f}", f"{drawn / sum(ms) / 1000:.2f}", f"{processed / sum(ms) / 1000:.2f}", f"{drawn / processed:.2f}",
            f"{gpu / tets:.1f}" if gpu else "—", f"{first:.1f}", f"{later:.1f}", f"{extra:.1f}"]


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--data", type=pathlib.Path, default=root / "tests/data/dambreak")
    parser.add_argument("--mesh", type=pathlib.Path)
    parser.add_argument("--size", default="1024x1024")
    parser.add_argument("--step", default="0.5")
    parser.add_argument("--renderers", default="cpu,gl,gl-flat,tets")
    parser.add_argument("--camera", type=pathlib.Path, default=root / "scripts/demo-camera.json")
    parser.add_argument("--label", default="")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    if options.mesh:
        options.camera = None
    mesh, triangles, tets, last = make(options)
    print("| renderer | commit | load | ms a picture (median) | CPU s, whole film | M triangles drawn a s | M processed a s | drawn of processed "
          "| driver's bytes a tetrahedron | ms after a jump | ms later | to adapt |")
    print("|" + "---|" * 12)
    for renderer in options.renderers.split(","):
        print("| " + " | ".join(row(options, renderer, mesh, triangles, tets, last)) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
