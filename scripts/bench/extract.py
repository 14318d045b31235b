#!/usr/bin/python3
"""Measures how fast tet4d-mc extracts: in memory beside VTK's flying edges on the same frames in the same minutes, as a whole program
from file to file, against the limit of disk and memory, with the peak of its memory, at three sizes.

In memory: bench_marching (tests/hypermesh), pages dropped; the peer: vtkFlyingEdges3D a frame, one thread, geometry only. The two
take turns; ratios are medians of the pairs. Whole program: the frames are one raw float32 file, warm, hashing included.

usage: scripts/bench/extract.py --build DIR [--work DIR] [--runs N] [--only NAME,...] [--json FILE] [--table FILE]
needs: python3-numpy; python3-vtk9 for the peer, left out without it.
"""
import argparse
import json
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mc  # the inputs, the waiting for a quiet moment, the record of the machine


def sphere(size, frame):
    """Distance to a sphere of radius 64 whose centre moves 0.3 cells a frame; as a field of 256 cells a side."""
    axis = np.arange(size, dtype=np.float32)
    x, y, z = (axis - (c + v * frame) for c, v in zip((118.3, 127.6, 128.2), (0.3, 0.05, -0.02)))
    return (64 - np.sqrt(x[None, None, :] ** 2 + y[None, :, None] ** 2 + z[:, None, None] ** 2)).astype("<f4")


CASES = {  # name: (size, frames, isovalue, field of (size, k, frames))
    "blobs-64x32": (64, 32, 0.5, lambda n, k, t: mc.blobs(n, k / (t - 1))),
    "blobs-128x16": (128, 16, 0.5, lambda n, k, t: mc.blobs(n, k / (t - 1))),
    "blobs-256x16": (256, 16, 0.5, lambda n, k, t: mc.blobs(n, k / (t - 1))),
    "sphere-256x64": (256, 64, 0.0, lambda n, k, t: sphere(n, k)),
}


def write_raw(path, size, frames, field):
    with open(path, "wb") as file:
        for k in range(frames):
            file.write(field(size, k, frames).tobytes())
    path.with_suffix(".nhdr").write_text(
        f"NRRD0004\ntype: float\ndimension: 4\nsizes: {size} {size} {size} {frames}\nendian: little\nencoding: raw\n"
        f"data file: {path.name}\n\n", encoding="ascii")


def flying_edges(path, size, frames, iso):
    """Seconds for all frames, one thread, or None without VTK."""
    try:
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk
    except ImportError:
        return None
    vtk.vtkSMPTools.Initialize(1)
    fields = np.memmap(path, "<f4", "r", shape=(frames, size ** 3))
    spent = 0.0
    for field in fields:
        image = vtk.vtkImageData()
        image.SetDimensions(size, size, size)
        image.GetPointData().SetScalars(numpy_to_vtk(np.array(field), deep=0))
        edges = vtk.vtkFlyingEdges3D()
        edges.SetInputData(image)
        edges.SetValue(0, iso)
        edges.ComputeNormalsOff(), edges.ComputeGradientsOff(), edges.ComputeScalarsOff()
        begin = time.perf_counter()
        edges.Update()
        spent += time.perf_counter() - begin
    return spent


class Bench:
    def __init__(self, options):
        self.options, self.runner = options, mc.Runner(options)
        self.marching = options.build / "tests" / "hypermesh" / "bench_marching"

    def in_memory(self, path, iso, threads, *more):
        """One run after one warm-up, as bench_marching prints it."""
        text = subprocess.run([str(self.marching), str(iso), "2", str(threads), *more, str(path.with_suffix(".nhdr"))],
                              check=True, capture_output=True, text=True).stdout
        return json.loads(text.splitlines()[-1])

    def compare(self, path, size, frames, iso):
        """Ours on one and two threads and the peer, in turn."""
        ours, both, peer, ratios, scaling, busy = [], [], [], [], [], []
        for _ in range(self.options.runs):
            busy.append(self.runner.wait_for_quiet())
            one, two = self.in_memory(path, iso, 1), self.in_memory(path, iso, 2)
            edges = flying_edges(path, size, frames, iso)
            ours.append(one), both.append(two)
            scaling.append(one["seconds_wall"] / two["seconds_wall"])
            if edges:
                peer.append(edges)
                ratios.append(edges / one["seconds_wall"])
        middle = lambda values: statistics.median(values) if values else None
        return {"tets": ours[0]["tets"], "samples": ours[0]["samples"],
                "memory_s": middle([r["seconds_wall"] for r in ours]), "memory_2_s": middle([r["seconds_wall"] for r in both]),
                "tets_per_s": middle([r["tets_per_s"] for r in ours]),
                "tets_per_s_2": middle([r["tets_per_s"] for r in both]), "scaling": middle(scaling),
                "samples_per_s": middle([r["samples_per_s"] for r in ours]), "peer_s": middle(peer),
                "samples_over_peer": middle(ratios), "busy": max(busy)}

    def whole(self, path, size, iso, threads, work):
        arguments = [path, "--size", f"{size},{size},{size}", "--type", "f32", "--iso", iso, "-j", threads, "-o",
                     work / "out.t4h"]
        return self.runner.timed("tet4d-mc", arguments, work / "stats.json")


def limit_seconds(input_bytes, tets):
    """What reading at 5 GB/s and emitting 40 M tetrahedra a second would take."""
    return input_bytes / 5e9 + tets / 40e6


def bench(options, name, work):
    size, frames, iso, field = CASES[name]
    path, b = work / f"{name}.raw", Bench(options)
    write_raw(path, size, frames, field)
    input_bytes, voxels = path.stat().st_size, size ** 3
    row = {"input": name, "size": size, "frames": frames, "input_bytes": input_bytes}
    row.update(b.compare(path, size, frames, iso))
    for threads in (1, 2):
        whole = b.whole(path, size, iso, threads, work)
        row.update({f"whole_{threads}_s": whole["wall"], f"whole_{threads}_cpu_s": whole["cpu"],
                    "anonymous_bytes": whole["stats"]["anonymous_bytes"]})
    row["bytes"] = (work / "out.t4h").stat().st_size
    row["limit_s"] = limit_seconds(input_bytes, row["tets"])
    row["memory_bound"] = 2 * voxels * 4 + 2.5 * voxels + (64 << 20)
    path.unlink()
    return row


def table(rows, record):
    out = [f"Commit {record['commit']}, {record['machine']['cpu']}, {record['machine']['cores']} cores; medians of {record['runs']} "
           "runs, the programs taking turns.", "",
           "| input | tets | in memory s, 1 thread | M tets/s | ns/sample | M samples/s | flying edges s | samples/s over the peer's | "
           "2 threads M tets/s | scaling | others |", "|---" * 11 + "|"]
    for r in rows:
        peer = ["–", "–"] if not r["peer_s"] else [f"{r['peer_s']:.3f}", f"{r['samples_over_peer']:.2f}"]
        out.append(f"| {r['input']} | {r['tets']:,} | {r['memory_s']:.3f} | {r['tets_per_s'] / 1e6:.1f} | "
                   f"{1e9 * r['memory_s'] / r['samples']:.2f} | {r['samples_per_s'] / 1e6:.0f} | {peer[0]} | {peer[1]} | "
                   f"{r['tets_per_s_2'] / 1e6:.1f} | {r['scaling']:.2f} | {r['busy']:.0%} |")
    out += ["", "| input | input MB | file to file s, 1 thread (CPU) | 2 threads (CPU) | .t4h MB | limit s | of the limit, 1 thread | "
            "anonymous MB | bound MB |", "|---" * 9 + "|"]
    for r in rows:
        out.append(f"| {r['input']} | {r['input_bytes'] / 1e6:.0f} | {r['whole_1_s']:.3f} ({r['whole_1_cpu_s']:.3f}) | "
                   f"{r['whole_2_s']:.3f} ({r['whole_2_cpu_s']:.3f}) | {r['bytes'] / 1e6:.1f} | {r['limit_s']:.3f} | "
                   f"{r['whole_1_s'] / r['limit_s']:.2f} | {r['anonymous_bytes'] / 1e6:.1f} | {r['memory_bound'] / 1e6:.1f} |")
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True, help="a release build, tests included")
    parser.add_argument("--work", type=pathlib.Path, help="folder for inputs and outputs (default: temporary)")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", default="", help="inputs whose name begins with one of these, comma-separated")
    parser.add_argument("--max-busy", type=float, default=0.1, help="share of the cores others may use while timing")
    parser.add_argument("--patience", type=float, default=60, help="seconds to wait for that before each run")
    parser.add_argument("--json", type=pathlib.Path, help="append one JSON line a row")
    parser.add_argument("--table", type=pathlib.Path, help="write the table there too")
    options = parser.parse_args()
    options.bin = options.build / "tools"
    work = options.work or pathlib.Path(tempfile.mkdtemp(prefix="tet4d-bench-"))
    record = {"commit": mc.commit(), "machine": mc.machine(), "runs": options.runs}
    wanted = [name for name in options.only.split(",") if name]
    rows = []
    try:
        for name in CASES:
            if wanted and not any(name.startswith(w) for w in wanted):
                continue
            rows.append(bench(options, name, work))
            print(f"{name}: {rows[-1]['tets_per_s'] / 1e6:.1f} M tets/s in memory, {rows[-1]['whole_2_s']:.3f} s file to file",
                  file=sys.stderr)
    finally:
        if options.work is None:
            shutil.rmtree(work, ignore_errors=True)
    text = table(rows, record)
    print(text)
    if options.table:
        options.table.write_text(text, encoding="utf-8")
    if options.json:
        with open(options.json, "a", encoding="utf-8") as file:
            for row in rows:
                file.write(json.dumps({**record, **row}) + "\n")


if __name__ == "__main__":
    main()
