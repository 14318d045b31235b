#!/usr/bin/python3
"""What a frame budget costs and keeps: the table of docs/benchmarks/playback.md.

Plays a film of the demo's water with --arrival draw under several budgets, by each renderer, and tells the times of its pictures, how
many of 100 stayed within the budget, how finely they were sampled, and their error (RMSE in linear light, 255ths) against the pictures
of the same film without a budget. The last three pictures of a film stand still: as far as their pages are there they must be those
without a budget, byte by byte, or the script ends with 1. The first pictures of a film, of whose pages and kind nothing is known yet, are told apart (--first) and not
counted; pictures that lack pages are counted, and left out of the error.

usage: scripts/bench/budget.py --bin build/release/tools --work FOLDER [--budgets 10,16,33,66,100] [--renderers cpu,gl] [--table FILE]
"""
import argparse
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys

import mc  # the record of the machine

STILL = 3  # pictures at the end that stand still
COLUMNS = ["renderer", "budget ms", "pictures", "median ms", "p95", "longest", "within", "longest of the first", "samples a pixel (median)",
           "least", "RMSE, 255ths", "worst picture", "absent pages"]


def make(options):
    mesh, triangles = options.work / "budget.t4h", options.work / "budget.t4d"
    frames = sorted(options.data.glob("*.nrrd"))
    subprocess.run([options.bin / "tet4d-mc", *frames, "--iso", "0.5", "--cap", "-q", "-f", "-o", mesh], check=True)
    subprocess.run([options.bin / "dyntri-build", mesh, "-q", "-f", "-o", triangles], check=True)
    return triangles, len(frames) - 1


def play(options, file, times, renderer, folder, words):
    """What --stats says of each picture; the pictures are in `folder`."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    stats = options.work / "budget.json"
    subprocess.run([options.bin / "tet4d-play", file, "--offscreen", "--renderer", renderer, "--size", options.size, "--samples", options.samples,
                    "--camera", options.camera, "--times", times, "-q", "-o", folder / "%05d.png", "--stats", stats, "-f", *words], check=True)
    return json.loads(stats.read_text())["frames"]


def error(options, picture, exact):
    if picture.read_bytes() == exact.read_bytes():
        return 0.0
    told = subprocess.run([options.bin / "tet4d-report", "pictures", picture, exact, "--json"], check=True, capture_output=True, text=True)
    return 255 * json.loads(told.stdout)["rmse"]


def percentile(values, share):
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]


def row(options, renderer, budget, frames, exact, folder):
    """The cells of a film, and whether it came to rest as it should."""
    moving = frames[options.first:-STILL]
    ms = [frame["ms"] for frame in moving]
    names = sorted(folder.glob("*.png"))
    errors = [error(options, name, exact / name.name)
              for name, frame in list(zip(names, frames))[options.first:-STILL] if frame["absent"] == 0]
    within = "—" if budget == "none" else f"{100 * sum(one <= float(budget) for one in ms) / len(ms):.0f} %"
    rms = math.sqrt(statistics.fmean(one * one for one in errors)) if errors else math.nan
    samples = [frame["samples"] for frame in moving]
    rests = all(name.read_bytes() == (exact / name.name).read_bytes()
                for name, frame in list(zip(names, frames))[-STILL:] if frame["absent"] == 0)
    return [renderer, budget, len(moving), f"{statistics.median(ms):.1f}", f"{percentile(ms, 0.95):.1f}", f"{max(ms):.0f}", within,
            f"{max(frame['ms'] for frame in frames[:options.first]):.0f}", f"{statistics.median(samples):.2g}", f"{min(samples):.2g}",
            f"{rms:.2f}", f"{max(errors, default=math.nan):.2f}", sum(frame["absent"] for frame in frames)], rests


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--data", type=pathlib.Path, default=mc.ROOT / "tests/data/dambreak")
    parser.add_argument("--camera", type=pathlib.Path, default=mc.ROOT / "scripts/demo-camera.json")
    parser.add_argument("--size", default="1024x1024")
    parser.add_argument("--samples", default="4")
    parser.add_argument("--step", type=float, default=0.15, help="frames between two pictures")
    parser.add_argument("--first", type=int, default=8, help="pictures told apart")
    parser.add_argument("--budgets", default="10,16,33,66,100")
    parser.add_argument("--renderers", default="cpu,gl")
    parser.add_argument("--table", type=pathlib.Path)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    file, last = make(options)
    end = f"{int(last / options.step) * options.step:g}f"
    times = ",".join([f"0f:{end}:{options.step:g}f", *STILL * [end]])
    machine = mc.machine()
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    loads, restless = [], []
    for renderer in options.renderers.split(","):
        exact, bound = options.work / "exact", options.work / "bound"
        play(options, file, times, renderer, exact, [])
        for budget in ["none", *options.budgets.split(",")]:
            words = ["--arrival", "draw", *(["--budget-ms", budget] if budget != "none" else [])]
            frames = play(options, file, times, renderer, bound, words)
            loads.append(os.getloadavg()[0])
            cells, rests = row(options, renderer, budget, frames, exact, bound)
            lines.append("| " + " | ".join(map(str, cells)) + " |")
            print(lines[-1], file=sys.stderr, flush=True)
            if not rests:
                restless.append(f"{renderer}, {budget} ms: a picture that stands still is not the one without a budget")
        shutil.rmtree(exact)
        shutil.rmtree(bound)
    text = (f"Commit {mc.commit()}, {machine['cpu']}, {machine['cores']} cores, load {min(loads):.1f} to {max(loads):.1f}; {options.size}, "
            f"{options.samples} samples a pixel.\n\n" + "\n".join(lines) + "\n")
    print(text)
    if options.table:
        options.table.write_text(text, encoding="utf-8")
    for line in restless:
        print(line)
    return 1 if restless else 0


if __name__ == "__main__":
    sys.exit(main())
