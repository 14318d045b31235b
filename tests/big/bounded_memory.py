"""A quarter of a gigabyte of frames through tet4d-mc with an eighth of that as its data limit, frames as one file and as
many: the same bytes, a valid mesh, the volume of the moving ball that is in the frames.

usage: bounded_memory.py PROGRAMS_DIR WORK_DIR
"""

import json
import math
import pathlib
import resource
import shutil
import subprocess
import sys

import numpy

SIZE, FRAMES, RADIUS, STEP = 128, 32, 30.0, 1.25
INPUT_BYTES = SIZE**3 * FRAMES * 4
LIMIT_BYTES = INPUT_BYTES // 8


def frame(k):
    axis = numpy.arange(SIZE, dtype=numpy.float32)
    z, y, x = numpy.meshgrid(axis, axis, axis, indexing="ij", sparse=True)
    centre = 50 + STEP * k
    return RADIUS - numpy.sqrt((x - centre) ** 2 + (y - 63.3) ** 2 + (z - 64.1) ** 2, dtype=numpy.float32)


def header(sizes, time=None):
    clock = "" if time is None else f"time:={time}\n"
    dimension = len(sizes.split())
    return f"NRRD0004\ntype: float\ndimension: {dimension}\nsizes: {sizes}\nendian: little\nencoding: raw\n{clock}\n".encode()


def run(limit, *command):
    def bound():
        resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))

    subprocess.run([str(word) for word in command], check=True, preexec_fn=bound)


def main():
    programs, work = map(pathlib.Path, sys.argv[1:])
    shutil.rmtree(work, ignore_errors=True)
    (work / "frames").mkdir(parents=True)
    with open(work / "all.nrrd", "wb") as one:
        one.write(header(f"{SIZE} {SIZE} {SIZE} {FRAMES}"))
        for k in range(FRAMES):
            samples = frame(k).tobytes()
            one.write(samples)
            (work / "frames" / f"f_{k:03d}.nrrd").write_bytes(header(f"{SIZE} {SIZE} {SIZE}", k) + samples)

    run(LIMIT_BYTES, programs / "tet4d-mc", work / "all.nrrd", "--iso", 0, "-j", 1, "-q", "-o", work / "one.t4h")
    run(LIMIT_BYTES, programs / "tet4d-mc", work / "frames", "--iso", 0, "-j", 1, "-q", "-o", work / "many.t4h")
    assert (work / "one.t4h").read_bytes() == (work / "many.t4h").read_bytes(), "one file and many give other bytes"
    # --stats watches the memory from a thread whose stack counts too, so it runs without the limit.
    run(INPUT_BYTES, programs / "tet4d-mc", work / "all.nrrd", "--iso", 0, "-j", 1, "-q", "-f", "-o", work / "many.t4h",
        "--stats", work / "s.json")
    stats = json.loads((work / "s.json").read_text())
    assert stats["anonymous_bytes"] < LIMIT_BYTES, stats
    assert stats["counts"]["tets"] > 1_000_000, stats

    verdict = subprocess.run([programs / "tet4d-info", "--validate", "--json", work / "one.t4h"], check=True, capture_output=True)
    assert json.loads(verdict.stdout)["valid"] is True
    run(INPUT_BYTES, programs / "dyntri-build", work / "one.t4h", "-j", 1, "-q", "-o", work / "one.t4d")

    # A slice between two frames encloses the ball's volume.
    run(INPUT_BYTES, programs / "tet4d-convert", work / "one.t4h", "--at", "15.5f", "-q", "-o", work / "slice.ply")
    volume = ply_volume(work / "slice.ply")
    exact = 4 / 3 * math.pi * RADIUS**3
    assert abs(volume / exact - 1) < 5e-3, (volume, exact)
    print(f"{INPUT_BYTES} bytes of frames, data limit {LIMIT_BYTES}, anonymous {stats['anonymous_bytes']}, "
          f"{stats['counts']['tets']} tetrahedra, slice volume / exact {volume / exact:.5f}")
    shutil.rmtree(work)


def ply_volume(path):
    content = path.read_bytes()
    end = content.index(b"end_header\n") + len(b"end_header\n")
    lines = content[:end].decode().split("\n")
    vertices = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    faces = next(int(line.split()[2]) for line in lines if line.startswith("element face"))
    double = any(line.startswith("property double x") for line in lines)
    real = "<f8" if double else "<f4"
    points = numpy.frombuffer(content, real, 3 * vertices, end).reshape(-1, 3).astype(float)
    face = numpy.dtype([("count", "u1"), ("corners", "<i4", 3)])
    corners = numpy.frombuffer(content, face, faces, end + points.shape[0] * 3 * numpy.dtype(real).itemsize)["corners"]
    a, b, c = (points[corners[:, i]] - points.mean(axis=0) for i in range(3))
    return float(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6)


main()
