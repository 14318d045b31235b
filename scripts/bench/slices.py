#!/usr/bin/python3
"""Rows of docs/benchmarks/playback.md: slices of a hypermesh on the CPU beside VTK's, on the same blobs in the same minutes.

Ours: slice_bench (tests/bench) on the dynamic triangles, one thread, warm, points merged. VTK: vtkContour3DLinearGrid of the time
coordinate with a scalar tree, one and two threads, points merged, warm (scripts/peers/vtk_peer.py). Both slice at the same times; the
programs take turns, medians of the runs count.

With --simplify and --sequences a second table: what a slice costs where tetrahedra span many frames, in the blobs simplified by
hyper-qslim and in mesh sequences without what moves straight. There is no peer in it: cost is compared with the slice's size.

usage: scripts/bench/slices.py --build DIR [--size N] [--frames N] [--slices N] [--runs N] [--work DIR] [--json FILE]
       [--simplify 0.1,0.01] [--sequences FOLDER] [--tolerances every,0.5%] [--no-peer]
needs: python3-numpy; python3-vtk9 for the peer, whose row says so without it.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mc  # the blobs, the record of the machine

PEER = mc.ROOT / "scripts" / "peers" / "vtk_peer.py"


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{words[0]}: exit {done.returncode}\n{done.stderr[-2000:]}")
    return done.stdout


def prepare(options, work):
    """The blobs as a hypermesh, its plain arrays and dynamic triangles."""
    with open(work / "blobs.raw", "wb") as file:
        for k in range(options.frames):
            file.write(mc.blobs(options.size, k / (options.frames - 1)).tobytes())
    tools, n = options.build / "tools", options.size
    run(tools / "tet4d-mc", work / "blobs.raw", "--size", f"{n},{n},{n}", "--type", "f32", "--iso", "0.5", "-q", "-f", "-o",
        work / "blobs.t4h")
    (work / "blobs.raw").unlink()
    run(tools / "dyntri-build", work / "blobs.t4h", "-q", "-f", "-o", work / "blobs.t4d")
    if not options.no_peer:
        run(tools / "tet4d-convert", work / "blobs.t4h", "-q", "-f", "-o", work / "blobs.hyper")


def bench(options, file):
    return json.loads(run(options.build / "tests/bench/slice_bench", file, options.slices))


def ours(options, work):
    return {"slicer": "tet4d, dynamic triangles in bands", "threads": 1, **bench(options, work / "blobs.t4d")}


def peer(options, work, threads):
    times = [(i + 0.5) / options.slices * (options.frames - 1) for i in range(options.slices)]
    line = json.loads(run(PEER, "slices", work / "blobs.hyper", 1, threads, *times))
    return {"slicer": "vtkContour3DLinearGrid, scalar tree", "threads": threads, **line}


def measure(options, work):
    """One row a slicer: the run with the median time, the slicers taking turns."""
    slicers = [lambda: ours(options, work)]
    if not options.no_peer:
        slicers += [lambda: peer(options, work, 1), lambda: peer(options, work, 2)]
    runs = [[slicer() for slicer in slicers] for _ in range(options.runs)]
    rows = []
    for same in zip(*runs):
        row = dict(same[0])
        if "absent" not in row:
            row["slice_ms"] = statistics.median(one["slice_ms"] for one in same)
        rows.append(row)
    return rows


def long_lives(options, work):
    """Name and dynamic triangles of each input whose tetrahedra span many frames, made when it is its turn."""
    tools = options.build / "tools"
    mesh, triangles = work / "long.t4h", work / "long.t4d"
    yield f"blobs {options.size}³ x {options.frames}", work / "blobs.t4d"
    for ratio in filter(None, options.simplify.split(",")):
        run(tools / "hyper-qslim", work / "blobs.t4h", "--ratio", ratio, "-q", "-f", "-o", mesh)
        run(tools / "dyntri-build", mesh, "-q", "-f", "-o", triangles)
        yield f"… simplified to {100 * float(ratio):g} %", triangles
    for sequence in sorted(options.sequences.glob("*/sequence.json")) if options.sequences else []:
        if "triangles_file" not in json.loads(sequence.read_text(encoding="utf-8")):
            continue
        for tolerance in options.tolerances.split(","):
            how = ["--linear-window", 1] if tolerance == "every" else ["--linear-tolerance", tolerance]
            run(tools / "tet4d-mc", sequence, *how, "-q", "-f", "-o", mesh)
            run(tools / "dyntri-build", mesh, "-q", "-f", "-o", triangles)
            yield f"{sequence.parent.name.removeprefix('seq-')}, {'every frame' if tolerance == 'every' else tolerance}", triangles


def long_row(options, name, file):
    runs = [bench(options, file) for _ in range(options.runs)]
    return {"input": name, **runs[0], "slice_ms": statistics.median(one["slice_ms"] for one in runs)}


def long_table(rows):
    yield ("| input | tetrahedra | frames | pages alive | triangles: in the file | in pages alive | handed over | alive | handed over / alive "
           "| ms a slice | ns a triangle alive |")
    yield "|" + "---|" * 11
    for row in rows:
        yield (f"| {row['input']} | {row['tets']:,} | {row['frames']} | {row['pages']:.0f} of {row['file_pages']} | {row['file_triangles']:,} | "
               f"{row['all']:,.0f} | {row['processed']:,.0f} | {row['drawn']:,.0f} | {row['processed_per_drawn']:.2f} | {row['slice_ms']:.3f} | "
               f"{1e6 * row['slice_ms'] / row['drawn']:.0f} |")


def table(options, rows):
    yield f"| blobs {options.size}³ x {options.frames} | threads | tetrahedra | triangles a slice | ms a slice | of ours |"
    yield "|---|---|---|---|---|---|"
    for row in rows:
        if "absent" in row:
            yield f"| {row['slicer']} | {row['threads']} | | | {row['absent']} | |"
            continue
        yield (f"| {row['slicer']} | {row['threads']} | {row['tets']:,} | {row['triangles']:,.0f} | {row['slice_ms']:.2f} | "
               f"{row['slice_ms'] / rows[0]['slice_ms']:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True, help="a release build, tests included")
    parser.add_argument("--size", type=int, default=128, help="samples an axis")
    parser.add_argument("--frames", type=int, default=16)
    parser.add_argument("--slices", type=int, default=8, help="times, spread evenly")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--work", type=pathlib.Path, help="where the files go and stay; default: a folder that is gone at the end")
    parser.add_argument("--json", type=pathlib.Path, help="append the rows there, a line each")
    parser.add_argument("--simplify", default="", metavar="R,R", help="the blobs to these ratios, too")
    parser.add_argument("--sequences", type=pathlib.Path, metavar="FOLDER", help="of folders with a sequence.json each, too")
    parser.add_argument("--tolerances", default="every,0.5%", help="of straight motion in the sequences; every: all frames are kept")
    parser.add_argument("--no-peer", action="store_true", help="without VTK's rows")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="tet4d-bench-") as folder:
        work = (options.work or pathlib.Path(folder)).resolve()
        work.mkdir(parents=True, exist_ok=True)
        prepare(options, work)
        rows = measure(options, work)
        long_rows = []
        if options.simplify or options.sequences:
            long_rows = [long_row(options, name, file) for name, file in long_lives(options, work)]
    machine = mc.machine()
    print(f"Commit {mc.commit()}, {machine['cpu']}, {machine['cores']} cores, load {os.getloadavg()[0]:.1f}.\n")
    print("\n".join(table(options, rows)))
    if long_rows:
        print("\n" + "\n".join(long_table(long_rows)))
    if options.json:
        with open(options.json, "a", encoding="utf-8") as file:
            file.writelines(json.dumps(row) + "\n" for row in rows + long_rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
