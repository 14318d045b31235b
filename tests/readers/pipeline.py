"""What the programs write, seen by the independent readers: frames of a moving sphere through tet4d-mc and dyntri-build. Every
triangle of the mesh is shared or on a wall, every slice winds outward by exact arithmetic, and the dynamic triangles alive at a
time are the slice.

usage: pipeline.py --readers FOLDER --mc PROGRAM --dyntri PROGRAM --work FOLDER [--codec raw|zstd]...
Exit 77: a Python package the readers need is missing.
"""
import argparse
import importlib
import pathlib
import shutil
import struct
import subprocess
import sys

SKIPPED = 77
SIZE, FRAMES = 7, 4
TIMES = [0, 0.25, 1, 1.37, 2, 2.999, 3]


def write_frames(folder):
    """Signed distances, some samples exactly on the surface: the ties that matter."""
    for k in range(FRAMES):
        values = [2.0 - ((x - 2.5 - 0.5 * k) ** 2 + (y - 3) ** 2 + (z - 3) ** 2) ** 0.5
                  for z in range(SIZE) for y in range(SIZE) for x in range(SIZE)]
        header = f"NRRD0004\ntype: float\ndimension: 3\nsizes: {SIZE} {SIZE} {SIZE}\nendian: little\nencoding: raw\n\n"
        (folder / f"s_{k}.nrrd").write_bytes(header.encode() + struct.pack(f"<{len(values)}f", *values))


def alive(triangles):
    """Triangles as corners, the smallest first, without those that have two equal corners; sorted."""
    kept = []
    for points in triangles:
        if len(set(points)) == 3:
            first = points.index(min(points))
            kept.append(tuple(points[first:] + points[:first]))
    return sorted(kept)


def check(options, t4, hypermesh, dyntri, codec):
    work = options.work / codec
    work.mkdir(parents=True)
    write_frames(work)
    mesh_path, triangle_path = work / "s.t4h", work / "s.t4d"
    frames = [str(work / f"s_{k}.nrrd") for k in range(FRAMES)]
    subprocess.run([options.mc, *frames, "--iso", "0", "-o", mesh_path, "--page-codec", codec, "-q"], check=True)
    subprocess.run([options.dyntri, mesh_path, "-o", triangle_path, "--page-codec", codec, "-q"], check=True)
    mesh, triangles = hypermesh.Hypermesh(str(mesh_path)), dyntri.DynamicTriangles(str(triangle_path))
    faces = mesh.check_faces()
    t4.require(mesh.tet_count > 500 and faces["inner"] > faces["boundary"] > 0, codec, f"{mesh.tet_count} tets, {faces}")
    t4.require(triangles.sums[2] + triangles.empty == 4 * mesh.tet_count, codec, "4 triangles a tetrahedron")
    drawn = 0
    for time in map(t4.f32, TIMES):
        slices = alive([tuple(points) for _, points in mesh.slice(time, check_winding=True)])
        played = alive([tuple(points) for _, _, points in triangles.slice(time)])
        t4.require(slices == played, f"{codec}, time {time}", f"{len(slices)} triangles sliced, {len(played)} played")
        drawn += len(slices)
    t4.require(drawn > 500, codec, f"only {drawn} triangles in all slices")
    print(f"{codec}: {mesh.tet_count} tets, {triangles.sums[2]} triangles, {drawn} drawn, faces {faces}")
    return list(mesh.dump()), list(triangles.dump())


def main():
    parser = argparse.ArgumentParser()
    for name in ("readers", "mc", "dyntri", "work"):
        parser.add_argument(f"--{name}", required=True, type=pathlib.Path)
    parser.add_argument("--codec", action="append", required=True)
    options = parser.parse_args()
    try:
        importlib.import_module("xxhash")
        importlib.import_module("zstandard")
    except ImportError as error:
        print(f"skipped: {error}; scripts/install-deps brings it")
        return SKIPPED
    sys.path.insert(0, str(options.readers))
    t4, hypermesh, dyntri = map(importlib.import_module, ("t4container", "read_hypermesh", "read_dynamic_triangles"))
    shutil.rmtree(options.work, ignore_errors=True)
    try:
        dumps = [check(options, t4, hypermesh, dyntri, codec) for codec in options.codec]
        t4.require(all(dump == dumps[0] for dump in dumps), "codecs", "the content depends on the codec")
    except t4.FormatError as error:
        print(f"pipeline: {error}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
