#!/usr/bin/python3
"""Rows of docs/benchmarks/sequences.md: mesh sequences to hypermeshes, with every frame kept and with straight motion left
out. The sequences are folders with a sequence.json (raw arrays); those that are not there are left out.

usage: scripts/bench/sequences.py --bin FOLDER --data FOLDER [--runs N] [--table FILE]
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

TOLERANCES = (None, "0", "0.1%", "0.5%")  # None: every frame is kept


def run(program, arguments):
    result = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True)
    if result.returncode != 0:
        raise SystemExit(f"{program.name}: exit {result.returncode}\n{result.stderr[-2000:]}")


def row_of(options, sequence, tolerance, work):
    out, stats = work / "x.t4h", work / "s.json"
    how = ["--linear-window", 1] if tolerance is None else ["--linear-tolerance", tolerance]
    seconds = []
    for _ in range(options.runs + 1):
        run(options.bin / "tet4d-mc", [sequence / "sequence.json", *how, "-j", 1, "-q", "-f", "-o", out, "--stats", stats])
        record = json.loads(stats.read_text(encoding="utf-8"))
        seconds.append(record["seconds_wall"])
    run(options.bin / "tet4d-info", ["--validate", "--links", "--json", out])
    counts, error = record["counts"], record["error"]
    return (f"| {sequence.name.removeprefix('seq-')} | {counts['triangles']:,} x {counts['frames']} | "
            f"{'every frame' if tolerance is None else tolerance} | {counts['tets']:,} "
            f"({100 * counts['tets'] / counts['tets_expanded']:.1f} %) | {error['linear_tolerance']:.3g} | "
            f"{error['linear_measured']:.3g} | {statistics.median(seconds[1:]):.2f} | "
            f"{counts['tets'] / statistics.median(seconds[1:]) / 1e6:.1f} | {out.stat().st_size / 1e6:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--data", type=pathlib.Path, required=True, help="folder of the sequences' folders")
    parser.add_argument("--runs", type=int, default=3, help="counted runs of tet4d-mc")
    parser.add_argument("--table", type=pathlib.Path, help="write the table there too")
    options = parser.parse_args()
    lines = ["| sequence | triangles x frames | `--linear-tolerance` | tetrahedra (of all) | tolerance | measured | "
             "`tet4d-mc` s | M tets/s | .t4h MB |", "|---" * 9 + "|"]
    with tempfile.TemporaryDirectory(prefix="tet4d-bench-") as work:
        for sequence in sorted(options.data.glob("*/sequence.json")):
            if "triangles_file" not in json.loads(sequence.read_text(encoding="utf-8")):
                continue
            for tolerance in TOLERANCES:
                lines.append(row_of(options, sequence.parent, tolerance, pathlib.Path(work)))
                print(lines[-1], file=sys.stderr)
    text = "\n".join(lines) + "\n"
    print(text)
    if options.table:
        options.table.write_text(text, encoding="utf-8")
    return 0 if len(lines) > 2 else 77


if __name__ == "__main__":
    sys.exit(main())
