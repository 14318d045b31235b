#!/usr/bin/python3
"""Rows and plots of hyper-qslim beside its orders and VTK: runs `tet4d-report qslim` on the inputs given, and makes the tables of
docs/benchmarks/simplification.md and the plots of docs/gallery of the rows.

An input is PATH or PATH=ISO: a hypermesh (.t4h), a directory of frames (with its isovalue), or a mesh sequence (sequence.json, or
its folder). Without inputs: the dam break of tests/data at 0.5, and blobs of the report's own.

usage: scripts/bench/qslim.py --bin DIR [INPUT...] [--folder DIR] [--full] [--stiff] [--no-run] [--gallery DIR]
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
COLUMNS = [("series", "order"), ("ratio", "to"), ("reached", "reached"), ("tets", "tetrahedra"), ("seconds_work", "seconds"),
           ("seconds_cpu", "CPU, whole program"), ("peak_bytes", "peak"), ("rms_at", "rms at frames"), ("rms_between", "rms between"),
           ("p99_between", "p99 between"), ("max_at", "max at"), ("max_between", "max between"), ("volume_error_between", "volume"),
           ("closed_slices", "closed slices")]
STIFF = [("case", "case"), ("order", "order"), ("metric", "metric"), ("tets_in", "tetrahedra in"), ("tets", "out"),
         ("us_per_tet", "us a tetrahedron"), ("rms_at", "rms at frames"), ("rms_between", "rms between"), ("max_between", "max between"),
         ("volume_error_between", "volume")]


def cell(name, row):
    value = row.get(name)
    if value is None:
        return row.get("absent", "–") if name == "seconds_work" else "–"
    if name == "ratio":
        return f"{100 * value:g} %"
    if name == "reached":
        return f"{100 * value:.3g} %{', stalls' if 'stall' in row else ''}"
    if name == "peak_bytes":
        return f"{value / 1e6:.0f} MB"
    if name.startswith("volume"):
        return f"{100 * value:.2g} %"
    return f"{value:,}" if isinstance(value, int) else f"{value:.3g}" if isinstance(value, float) else str(value)


def table(rows, columns):
    columns = [(name, heading) for name, heading in columns if any(name in row for row in rows)]
    yield "| " + " | ".join(heading for _, heading in columns) + " |"
    yield "|" + "---|" * len(columns)
    for row in rows:
        yield "| " + " | ".join(cell(name, row) for name, _ in columns) + " |"


def runs(options):
    """The folder of each run of tet4d-report, with its words."""
    inputs = options.inputs or [str(ROOT / "tests/data/dambreak") + "=0.5", "blobs"]
    for given in inputs:
        path, _, iso = given.partition("=")
        if given == "blobs":
            yield options.folder / "blobs", ["qslim"]
            continue
        path = pathlib.Path(path)
        description = path / "sequence.json"
        if not iso and description.is_file() and "triangles_file" in json.loads(description.read_text(encoding="utf-8")):
            path = description
        name = path.parent.name if path.name == "sequence.json" else path.stem
        yield options.folder / name, ["qslim", str(path), *(["--iso", iso] if iso else [])]
    if options.stiff:
        yield options.folder / "stiff", ["stiff", "qslim"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("inputs", nargs="*", metavar="INPUT")
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("report-qslim"), help="a folder in it for each input")
    parser.add_argument("--full", action="store_true", help="all orders, metrics and ratios")
    parser.add_argument("--stiff", action="store_true", help="the stiff cases too")
    parser.add_argument("--no-run", action="store_true", help="only tables and plots, of rows that are there")
    parser.add_argument("--gallery", type=pathlib.Path, help="copy the plots of error against run time there")
    options = parser.parse_args()
    for folder, words in runs(options):
        if not options.no_run:
            more = ["--full"] if options.full else []
            subprocess.run([options.bin / "tet4d-report", *words, "--folder", folder, "--resume", "-q", *more], check=True)
        rows = [json.loads(line) for line in (folder / "runs.jsonl").read_text(encoding="utf-8").splitlines() if line]
        rows = [row for row in rows if row["exit"] == 0]
        loads = [row["load"] for row in rows if "load" in row]
        stiff = words[0] == "stiff"
        unit = "cells" if stiff else rows[0]["unit"]
        print(f"## {'Stiff cases' if stiff else rows[0]['input']}\n\n{'To a tenth. ' if stiff else ''}Lengths in {unit}. Commit "
              f"{rows[0]['commit']}, {rows[0]['machine']}, load {min(loads):.1f} to {max(loads):.1f}.\n")
        print("\n".join(table(rows, STIFF if stiff else COLUMNS)) + "\n")
        if options.gallery:
            for plot in sorted(folder.glob("*-growth.png" if stiff else "qslim-*-error-seconds.png")):
                shutil.copy(plot, options.gallery / plot.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
