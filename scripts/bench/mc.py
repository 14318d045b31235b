#!/usr/bin/python3
"""Measures the way from frames to dynamic triangles: errors against closed forms, sizes, seconds, bytes and memory.

Makes its own inputs (moving balls with known measures, and moving blobs), runs tet4d-mc, dyntri-build and tet4d-convert as a
user does, and measures what they wrote by code of its own: hypermeshes with measure_hypermesh (tests/measure), slices
from their PLY files here. Prints a markdown table and, with --json, one JSON line a row.

usage: scripts/bench/mc.py --bin DIR [--measure FILE] [--work DIR] [--runs N] [--only NAME,...] [--json FILE] [--table FILE]
needs: python3-numpy; python3-vtk9 for the row of the peer, left out without it.
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
import tempfile
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]


# ---------------------------------------------------------------- inputs
class Ball:
    """A ball of centre c + v t and radius r + g t, in cells and frames. size: samples an axis; the shape scales with it, so the
    speed in cells a frame stays and size halves the grid step in space and time together."""

    def __init__(self, size, frames, velocity, growth):
        self.frames, self.last = frames, frames - 1
        # Off the lattice, so that no symmetry flatters the figures.
        self.centre = np.array([0.40, 0.45, 0.55]) * size + [0.137, -0.291, 0.083]
        self.velocity = np.array(velocity, float)
        self.radius, self.growth = 0.27 * size, growth

    def radius_at(self, t):
        return self.radius + self.growth * t

    def field(self, size, t):
        axis = np.arange(size, dtype=np.float64)
        x, y, z = (axis - c for c in self.centre + t * self.velocity)
        square = x[None, None, :] ** 2 + y[None, :, None] ** 2 + z[:, None, None] ** 2
        return (self.radius_at(t) - np.sqrt(square)).astype("<f4")

    def slice_area(self, t):
        return 4 * math.pi * self.radius_at(t) ** 2

    def slice_volume(self, t):
        return self.slice_area(t) * self.radius_at(t) / 3

    def integrals(self, steps=4000, directions=400):
        """Enclosed 4-volume and 3-volume by quadrature: the hypersurface over direction n of the sphere has the normal speed
        w = v.n + g, and its 3-volume is that of the slices times sqrt(1 + w^2)."""
        t = (np.arange(steps) + 0.5) * self.last / steps
        u, weight = np.polynomial.legendre.leggauss(directions)
        w = np.linalg.norm(self.velocity) * u + self.growth
        mean = float((np.sqrt(1 + w * w) * weight).sum() / 2)
        r = self.radius_at(t)
        area = float((4 * math.pi * r ** 2).mean() * self.last)
        return float((4 * math.pi / 3 * r ** 3).mean() * self.last), area * mean


def blobs(size, t):
    """Moving blobs, surface at 0.5: 24 Gaussians on closed Lissajous paths, the field of the peers' benchmarks."""
    g = np.random.default_rng(4404)
    k = 24
    c, a = g.uniform(-0.45, 0.45, (k, 3)), g.uniform(0.1, 0.4, (k, 3))
    w, p, s = g.integers(1, 3, (k, 3)), g.uniform(0, 2 * np.pi, (k, 3)), g.uniform(0.08, 0.16, k)
    axis = np.linspace(-1, 1, size)
    field = np.zeros((size, size, size), "<f4")
    for i in range(k):
        q = c[i] + a[i] * np.sin(2 * np.pi * w[i] * t + p[i])
        e = [np.exp(-(axis - q[d]) ** 2 / (2 * s[i] * s[i])).astype("<f4") for d in range(3)]
        field += e[2][:, None, None] * e[1][None, :, None] * e[0][None, None, :]
    return field


def write_frames(folder, size, fields):
    folder.mkdir(parents=True)
    for k, field in enumerate(fields):
        with open(folder / f"frame_{k:04d}.nrrd", "wb") as file:
            file.write(f"NRRD0004\ntype: float\ndimension: 3\nsizes: {size} {size} {size}\nendian: little\n"
                       "encoding: raw\n\n".encode())
            file.write(field.tobytes())
    return folder


# ---------------------------------------------------------------- slices
PLY_TYPES = {"float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8", "uchar": "u1", "uint8": "u1",
             "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4"}


def read_ply(path):
    """Points and triangles of a binary little-endian PLY."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in data[:end].decode("ascii").splitlines():
        words = line.split()
        if words[0] == "format" and words[1] != "binary_little_endian":
            raise SystemExit(f"{path}: format {words[1]} is not read here")
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        if words[0] == "property":
            elements[-1][2].append(words[1:])
    result = {}
    for name, count, properties in elements:
        fields = []
        for words in properties:
            if words[0] == "list":
                fields += [("n", PLY_TYPES[words[1]]), ("v", PLY_TYPES[words[2]], (3,))]
            else:
                fields.append((words[1], PLY_TYPES[words[0]]))
        result[name] = np.frombuffer(data, np.dtype(fields), count, end)
        end += result[name].nbytes
    if (result["face"]["n"] != 3).any():
        raise SystemExit(f"{path}: a face is no triangle")
    points = np.stack([result["vertex"][axis].astype(np.float64) for axis in "xyz"], 1)
    return points, result["face"]["v"].astype(np.int64)


def measure_slice(path):
    points, faces = read_ply(path)
    points = points - points.mean(axis=0)
    a, b, c = (points[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forward, backward = (np.unique(s[:, 0] * len(points) + s[:, 1]) for s in (sides, sides[:, ::-1]))
    closed = len(forward) == len(sides) and np.array_equal(forward, backward)
    return {"area": float(np.linalg.norm(normal, axis=1).sum() / 2),
            "volume": float(np.einsum("ij,ij->i", a, normal).sum() / 6), "closed": bool(closed), "triangles": len(faces)}


# ---------------------------------------------------------------- runs
def busy_fraction(seconds):
    """Share of all cores that worked, over the next `seconds`."""
    def sample():
        with open("/proc/stat", encoding="ascii") as file:
            numbers = [int(word) for word in file.readline().split()[1:9]]
        return sum(numbers), numbers[3] + numbers[4]
    total, idle = sample()
    time.sleep(seconds)
    total_after, idle_after = sample()
    return 1 - (idle_after - idle) / max(1, total_after - total)


class Runner:
    def __init__(self, options):
        self.bin, self.runs, self.max_busy, self.patience = options.bin, options.runs, options.max_busy, options.patience

    def wait_for_quiet(self):
        """Returns the machine's busy share just before a run; waits for a quiet moment, but not for ever."""
        deadline = time.monotonic() + self.patience
        while True:
            busy = busy_fraction(1.0)
            if busy <= self.max_busy or time.monotonic() > deadline:
                return busy

    def once(self, program, arguments):
        begin = time.perf_counter()
        child = subprocess.Popen([str(self.bin / program), *map(str, arguments)], stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT)
        text = child.stdout.read().decode(errors="replace")
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            raise SystemExit(f"{program} {' '.join(map(str, arguments))}: exit {child.returncode}\n{text[-2000:]}")
        return {"wall": time.perf_counter() - begin, "cpu": usage.ru_utime + usage.ru_stime}

    def timed(self, program, arguments, stats_file):
        """Medians over the runs, one warm-up before, and the program's own record of the last run."""
        self.once(program, [*arguments, "--stats", stats_file, "-f", "-q"])
        rows, busy = [], []
        for _ in range(self.runs):
            busy.append(self.wait_for_quiet())
            rows.append(self.once(program, [*arguments, "--stats", stats_file, "-f", "-q"]))
            # The child's ru_maxrss would count this interpreter before exec; the program's own record does not.
            result_stats = json.loads(pathlib.Path(stats_file).read_text(encoding="utf-8"))
            rows[-1]["peak"] = result_stats["peak_bytes"]
        result = {key: statistics.median(row[key] for row in rows) for key in ("wall", "cpu", "peak")}
        result.update(busy=max(busy), stats=result_stats)
        return result


def relative(measured, exact):
    return None if measured is None else abs(measured - exact) / exact


def slice_times(last):
    """Frames, and places between them that no frame's grid favours."""
    at_frames = sorted({0, 1, last // 2, last})
    between = [k + f for k, f in ((0, 0.25), (last // 3, 0.5), (last // 2, 0.37), (last - 1, 0.8))]
    return at_frames, between


def bench_mesh(runner, options, row, frames, ball, work):
    """One input, one split: builds, measures and, for a ball, compares."""
    mesh, dynamic = work / "mesh.t4h", work / "mesh.t4d"
    mc = runner.timed("tet4d-mc", [frames, "--iso", row["iso"], "--split", row["split"], "-j", row["threads"], "-o", mesh],
                      work / "mc.json")
    measured = json.loads(subprocess.run([str(options.measure), "--check", str(mesh)], check=True, capture_output=True,
                                         text=True).stdout)
    tets, samples = measured["tets"], row["size"] ** 3 * row["frames"]
    row.update(tets=tets, vertices=measured["vertices"], active_cells=measured["active_cells"],
               tets_per_cell=tets / max(1, measured["active_cells"]), faults=measured["faults"],
               volume3=measured["volume3"], volume4=measured["volume4"], bytes=mesh.stat().st_size,
               bytes_per_tet=mesh.stat().st_size / max(1, tets), mc_wall=mc["wall"], mc_cpu=mc["cpu"], mc_peak=mc["peak"],
               mc_anonymous=mc["stats"].get("anonymous_bytes"), mc_phases=mc["stats"].get("phases"),
               tets_per_s=tets / mc["wall"], tets_per_cpu_s=tets / mc["cpu"], samples_per_s=samples / mc["wall"],
               mc_busy=mc["busy"])
    if row["split"] == "hull":  # the Kuhn split is an oracle, not something to play
        dt = runner.timed("dyntri-build", [mesh, "-j", row["threads"], "-o", dynamic], work / "dt.json")
        row.update(dt_wall=dt["wall"], dt_cpu=dt["cpu"], dt_peak=dt["peak"], dt_triangles=dt["stats"]["counts"]["triangles"],
                   dt_bytes=dynamic.stat().st_size, dt_tets_per_s=tets / dt["wall"], dt_busy=dt["busy"])
    if ball is None:
        return row
    volume4, volume3 = ball.integrals()
    row.update(exact_volume4=volume4, exact_volume3=volume3, error_volume4=relative(measured["volume4"], volume4),
               error_volume3=relative(measured["volume3"], volume3))
    for place, times in zip(("frame", "between"), slice_times(ball.last)):
        areas, volumes, closed, triangles = [], [], True, []
        for t in times:
            runner.once("tet4d-convert", [mesh, "--at", f"{t}f", "-o", work / "slice.ply", "-f", "-q"])
            got = measure_slice(work / "slice.ply")
            areas.append(relative(got["area"], ball.slice_area(t)))
            volumes.append(relative(got["volume"], ball.slice_volume(t)))
            closed &= got["closed"]
            triangles.append(got["triangles"])
        row.update({f"error_area_{place}": max(areas), f"error_slice_volume_{place}": max(volumes),
                    f"closed_{place}": closed, f"slice_triangles_{place}": statistics.mean(triangles)})
    return row


def bench_peer(runner, size, frames, row):
    """What users do today: an isosurface a frame, VTK's flying edges, frames already in memory."""
    try:
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk
    except ImportError:
        return None
    vtk.vtkSMPTools.Initialize(row["threads"])
    fields = [np.ascontiguousarray(blobs(size, k / (frames - 1))) for k in range(frames)]
    results = []
    busy = []
    for _ in range(runner.runs + 1):
        busy.append(runner.wait_for_quiet())
        triangles, wall, cpu = 0, 0.0, 0.0
        for field in fields:
            image = vtk.vtkImageData()
            image.SetDimensions(size, size, size)
            image.GetPointData().SetScalars(numpy_to_vtk(field.ravel(), deep=0))
            edges = vtk.vtkFlyingEdges3D()
            edges.SetInputData(image)
            edges.SetValue(0, 0.5)
            edges.ComputeNormalsOff(), edges.ComputeGradientsOff(), edges.ComputeScalarsOff()
            begin, begin_cpu = time.perf_counter(), time.process_time()
            edges.Update()
            wall, cpu = wall + time.perf_counter() - begin, cpu + time.process_time() - begin_cpu
            triangles += edges.GetOutput().GetNumberOfPolys()
        results.append((wall, cpu))
    wall, cpu = (statistics.median(r[i] for r in results[1:]) for i in range(2))
    row.update(mc_wall=wall, mc_cpu=cpu, samples_per_s=size ** 3 * frames / wall, triangles=triangles, mc_busy=max(busy[1:]),
               peer="vtkFlyingEdges3D " + vtk.vtkVersion().GetVTKVersion())
    return row


# ---------------------------------------------------------------- the record
def machine():
    model = "unknown"
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    with open("/proc/meminfo", encoding="ascii") as file:
        memory = int(file.readline().split()[1]) * 1024
    return {"cpu": model, "cores": os.cpu_count(), "memory": memory}


def commit():
    def git(*arguments):
        return subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True).stdout.strip()
    return git("rev-parse", "--short", "HEAD") + ("+" if git("status", "--porcelain", "-uno") else "")


def percent(value):
    return "–" if value is None else f"{100 * value:.3g} %"


def table(rows, record):
    out = [f"Commit {record['commit']}, {record['machine']['cpu']}, {record['machine']['cores']} cores; medians of "
           f"{record['runs']} runs. Others: the most of the cores that other programs used just before a run of tet4d-mc, of "
           "dyntri-build.", ""]
    exact = [r for r in rows if "error_volume4" in r]
    if exact:
        out += ["| input | split | 4-volume | 3-volume | slice area, frames | between | slice volume, frames | between | "
                "slices closed | tets per active cell | faults |", "|---" * 11 + "|"]
        for r in exact:
            out.append(f"| {r['input']} | {r['split']} | {percent(r['error_volume4'])} | {percent(r['error_volume3'])} | "
                       f"{percent(r['error_area_frame'])} | {percent(r['error_area_between'])} | "
                       f"{percent(r['error_slice_volume_frame'])} | {percent(r['error_slice_volume_between'])} | "
                       f"{'yes' if r['closed_frame'] and r['closed_between'] else 'no'} | {r['tets_per_cell']:.2f} | "
                       f"{r['faults']} |")
        out.append("")
        volume3 = {(r["input"], r["split"]): r["volume3"] for r in exact}
        pairs = [(name, volume3[name, "kuhn"] / volume3[name, "hull"] - 1) for name, split in volume3
                 if split == "kuhn" and (name, "hull") in volume3]
        if pairs:
            out += ["3-volume of the Kuhn split against the hull's: " +
                    ", ".join(f"{name} {100 * difference:+.3f} %" for name, difference in pairs) + ".", ""]
    orders = [r for r in rows if r.get("orders")]
    if orders:
        keys = list(orders[0]["orders"])
        out += ["Order of convergence (2 is second order), each row against the row of half its size:", "",
                "| input | split | " + " | ".join(k.replace("_", " ") for k in keys) + " |", "|---" * (2 + len(keys)) + "|"]
        for r in orders:
            out.append(f"| {r['input']} | {r['split']} | " + " | ".join(f"{r['orders'][k]:.2f}" for k in keys) + " |")
        out.append("")
    out += ["| input | split | threads | tets | `tet4d-mc` s (CPU) | M tets/s (CPU s) | M samples/s | peak MB | "
            ".t4h MB (B/tet) | `dyntri-build` s (CPU) | M tets/s (CPU s) | peak MB | .t4d MB | "
            "triangles/tet | others |", "|---" * 15 + "|"]
    for r in rows:
        if "peer" in r:
            out.append(f"| {r['input']} | {r['peer']}, in memory | {r['threads']} | {r['triangles']:,} triangles | {r['mc_wall']:.3f} "
                       f"({r['mc_cpu']:.3f}) | | {r['samples_per_s'] / 1e6:.1f} | | | | | | | | {percent(r['mc_busy'])} |")
            continue
        line = (f"| {r['input']} | {r['split']} | {r['threads']} | {r['tets']:,} | {r['mc_wall']:.3f} ({r['mc_cpu']:.3f}) | "
                f"{r['tets_per_s'] / 1e6:.2f} ({r['tets_per_cpu_s'] / 1e6:.2f}) | {r['samples_per_s'] / 1e6:.1f} | "
                f"{r['mc_peak'] / 1e6:.1f} | {r['bytes'] / 1e6:.2f} ({r['bytes_per_tet']:.1f}) | ")
        if "dt_wall" in r:
            line += (f"{r['dt_wall']:.3f} ({r['dt_cpu']:.3f}) | {r['dt_tets_per_s'] / 1e6:.2f} "
                     f"({r['tets'] / r['dt_cpu'] / 1e6:.2f}) | {r['dt_peak'] / 1e6:.1f} | {r['dt_bytes'] / 1e6:.2f} | "
                     f"{r['dt_triangles'] / max(1, r['tets']):.2f} | {r['mc_busy']:.0%}, {r['dt_busy']:.0%} |")
        else:
            line += f"| | | | | {r['mc_busy']:.0%} |"
        out.append(line)
    return "\n".join(out) + "\n"


ERRORS = ("error_volume4", "error_volume3", "error_area_frame", "error_area_between", "error_slice_volume_frame",
          "error_slice_volume_between")
MOVING, GROWING = ((0.40, 0.23, -0.17), 0.0), ((0.40, 0.23, -0.17), 0.1)


def cases():
    """(name, size, frames, split, threads, ball or None)"""
    for split in ("hull", "kuhn"):
        for size in (16, 32, 64):
            yield f"ball-{size}x{size // 2}", size, size // 2, split, 1, MOVING
    yield "growing-64x32", 64, 32, "hull", 1, GROWING
    yield "still-64x32", 64, 32, "hull", 1, ((0, 0, 0), 0.0)
    for threads in (1, 2):
        yield "blobs-128x16", 128, 16, "hull", threads, None


def add_orders(rows):
    by_key = {(r["input"].split("-")[0], r["split"], r["size"]): r for r in rows if "error_volume4" in r}
    for (name, split, size), row in by_key.items():
        half = by_key.get((name, split, size // 2))
        if half:
            row["orders"] = {k.removeprefix("error_"): math.log2(half[k] / row[k]) for k in ERRORS if half[k] and row[k]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--measure", type=pathlib.Path, help="measure_hypermesh (default: found from --bin)")
    parser.add_argument("--work", type=pathlib.Path, help="folder for inputs and outputs, emptied (default: temporary)")
    parser.add_argument("--runs", type=int, default=3, help="counted runs of each program")
    parser.add_argument("--only", default="", help="inputs whose name begins with one of these, comma-separated")
    parser.add_argument("--max-busy", type=float, default=0.1, help="share of the cores others may use while timing")
    parser.add_argument("--patience", type=float, default=60, help="seconds to wait for that before each run")
    parser.add_argument("--json", type=pathlib.Path, help="append one JSON line a row")
    parser.add_argument("--table", type=pathlib.Path, help="write the table there too")
    options = parser.parse_args()
    options.measure = options.measure or options.bin.parent / "tests" / "measure" / "measure_hypermesh"
    for program in [options.bin / "tet4d-mc", options.bin / "dyntri-build", options.bin / "tet4d-convert", options.measure]:
        if not program.exists():
            sys.exit(f"mc.py: {program} is not there; build it, or say where it is with --bin and --measure")
    work = options.work or pathlib.Path(tempfile.mkdtemp(prefix="tet4d-bench-"))
    runner = Runner(options)
    record = {"commit": commit(), "machine": machine(), "runs": options.runs, "load": os.getloadavg()}
    wanted = [name for name in options.only.split(",") if name]
    rows = []
    try:
        for name, size, frames, split, threads, shape in cases():
            if wanted and not any(name.startswith(w) for w in wanted):
                continue
            ball = Ball(size, frames, *shape) if shape else None
            folder = work / name
            if not folder.exists():
                write_frames(folder, size, ((ball.field(size, k) if ball else blobs(size, k / (frames - 1)))
                                            for k in range(frames)))
            row = {"input": name, "size": size, "frames": frames, "split": split, "threads": threads,
                   "iso": 0 if ball else 0.5}
            rows.append(bench_mesh(runner, options, row, folder, ball, work))
            print(f"{name} {split}: {row['tets']:,} tets, {row['mc_wall']:.3f} s", file=sys.stderr)
            if ball is None:
                peer = bench_peer(runner, size, frames, {"input": name, "size": size, "frames": frames, "split": "peer",
                                                         "threads": threads, "iso": 0.5})
                rows += [peer] if peer else []
        add_orders(rows)
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
