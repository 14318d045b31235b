"""Sixty frames of 374 x 374 x 374 floats, 12.6 GB, from a pipe through tet4d-mc with two gigabytes as its data limit: bounded memory
for any number of frames, and the slices of the moving ball that is in the frames.

usage: pipe_stream.py PROGRAMS_DIR WORK_DIR
"""

import json
import math
import pathlib
import resource
import shutil
import subprocess
import sys

import numpy

SIZE, FRAMES, RADIUS, STEP = 374, 60, 60.0, 2.5
FRAME_BYTES = SIZE**3 * 4
LIMIT_BYTES = 2 << 30
# Two frames, two and a half bytes a sample, and 64 MiB.
BOUND_BYTES = 2 * FRAME_BYTES + SIZE**3 * 5 // 2 + (64 << 20)


def frames():
    """Only a slab around the ball changes from frame to frame; the rest is far outside."""
    axis = numpy.arange(SIZE, dtype=numpy.float32)
    square = (axis[None, :, None] - 187.3) ** 2 + (axis[None, None, :] - 180.4) ** 2
    for k in range(FRAMES):
        centre = 100.2 + STEP * k
        yield RADIUS - numpy.sqrt((axis[:, None, None] - centre) ** 2 + square, dtype=numpy.float32)


def main():
    programs, work = map(pathlib.Path, sys.argv[1:])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    command = [programs / "tet4d-mc", "-", "--size", f"{SIZE},{SIZE},{SIZE}", "--type", "f32", "--iso", "0", "-j", "2", "-q",
               "-o", work / "pipe.t4h", "--stats", work / "s.json"]
    child = subprocess.Popen([str(word) for word in command], stdin=subprocess.PIPE,
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_DATA, (LIMIT_BYTES, LIMIT_BYTES)))
    for frame in frames():
        child.stdin.write(memoryview(frame).cast("B"))
    child.stdin.close()
    assert child.wait() == 0, f"exit {child.returncode}"

    stats = json.loads((work / "s.json").read_text())
    assert stats["counts"]["frames"] == FRAMES, stats["counts"]
    assert stats["anonymous_bytes"] <= BOUND_BYTES, f"{stats['anonymous_bytes']} bytes, {BOUND_BYTES} allowed"
    info = subprocess.run([str(programs / "tet4d-info"), "--validate", "--json", str(work / "pipe.t4h")], check=True,
                          capture_output=True, text=True)
    assert json.loads(info.stdout)["valid"] is True
    for at in ("0f", "31.5f", "59f"):
        subprocess.run([str(programs / "tet4d-convert"), str(work / "pipe.t4h"), "--at", at, "-f", "-q", "-o",
                        str(work / "slice.ply")], check=True)
        volume = volume_of(work / "slice.ply")
        exact = 4 / 3 * math.pi * RADIUS**3
        assert abs(volume / exact - 1) < 1e-3, f"slice at {at}: {volume}, exact {exact}"
    shutil.rmtree(work)
    print(f"anonymous {stats['anonymous_bytes'] / 1e6:.0f} MB of {BOUND_BYTES / 1e6:.0f} MB, {stats['seconds_wall']:.1f} s")


def volume_of(path):
    """Enclosed volume of a binary PLY of float positions and triangles."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    words = data[:end].decode().split()
    vertices, faces = (int(words[words.index(name) + 1]) for name in ("vertex", "face"))
    points = numpy.frombuffer(data, "<f4", 3 * vertices, end).reshape(-1, 3).astype(float)
    face = numpy.dtype([("n", "u1"), ("v", "<i4", 3)])
    a, b, c = (points[numpy.frombuffer(data, face, faces, end + 12 * vertices)["v"][:, i]] - 187 for i in range(3))
    return float(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6)


if __name__ == "__main__":
    main()
