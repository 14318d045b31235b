"""hyper-qslim out of core: 2.8 million tetrahedra in cells, with a quarter of the memory that the whole takes as
its data limit: the same bytes as without a limit, at most twice the time, as near the input; then with a fraction of the
input's own size.

usage: cells.py PROGRAMS_DIR WORK_DIR
"""

import json
import pathlib
import resource
import shutil
import subprocess
import sys

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts" / "bench"))
import mc  # noqa: E402

SIZE, FRAMES = 64, 32
LITTLE_BYTES = 24 << 20


def run(*command, limit=None):
    """Seconds of CPU."""
    def bound():
        if limit:
            resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))

    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], check=True, preexec_fn=bound)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def with_columns(programs, work):
    """Two parts with columns, one in the metric, through a fraction of their size."""
    mesh, limit = work / "loaded.t4h", 2 * LITTLE_BYTES
    run(programs / "tet4d-mc", work / "blobs.nrrd", "--iso", "0.5,0.9", "--normals", "gradient", "--velocity", "-q", "-o", mesh)
    slim = [programs / "hyper-qslim", mesh, "--ratio", 0.1, "-q", "--attributes", "velocity", "--cell-tets", 100_000, "--measure", 0]
    run(*slim, "-j", 2, "-o", work / "loaded-free.t4h")
    run(*slim, "-j", 1, "-o", work / "loaded-little.t4h", "--memory", int(0.8 * limit), limit=limit)
    assert (work / "loaded-free.t4h").read_bytes() == (work / "loaded-little.t4h").read_bytes(), "other bytes with columns"
    size = mesh.stat().st_size
    assert size > 2 * limit, size
    verdict = subprocess.run([programs / "tet4d-info", "--validate", "--links", "--json", work / "loaded-free.t4h"], check=True,
                             capture_output=True)
    verdict = json.loads(verdict.stdout)
    assert verdict["valid"] is True and len(verdict["parts"]) == 2 and len(verdict["columns"]) == 2, verdict
    return f"{size} bytes with columns and two parts through {limit}"


def main():
    programs, work = map(pathlib.Path, sys.argv[1:])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    with open(work / "blobs.nrrd", "wb") as out:
        out.write(f"NRRD0004\ntype: float\ndimension: 4\nsizes: {SIZE} {SIZE} {SIZE} {FRAMES}\n"
                  "endian: little\nencoding: raw\n\n".encode())
        for k in range(FRAMES):
            out.write(numpy.ascontiguousarray(mc.blobs(SIZE, k / (FRAMES - 1)), dtype=numpy.float32).tobytes())
    mesh = work / "blobs.t4h"
    run(programs / "tet4d-mc", work / "blobs.nrrd", "--iso", 0.5, "-q", "-o", mesh)
    slim = [programs / "hyper-qslim", mesh, "--ratio", 0.1, "-q", "-j", 1]

    def stats(name):
        return json.loads((work / name).read_text())

    run(*slim, "-o", work / "whole.t4h", "--stats", work / "whole.json", "--measure", 3)
    whole = stats("whole.json")
    tets_in = json.loads(subprocess.run([programs / "tet4d-info", "--json", mesh], check=True, capture_output=True).stdout)["counts"]["tets"]
    cells = [*slim, "--cell-tets", tets_in // 8]
    run(*cells, "-o", work / "free.t4h", "--stats", work / "free.json", "--measure", 3)
    assert stats("free.json")["error"]["slice_rms_world"] <= 1.1 * whole["error"]["slice_rms_world"], (stats("free.json"), whole)

    limit = whole["anonymous_bytes"] // 4
    seconds_whole = run(*slim, "-f", "-o", work / "whole.t4h", "--measure", 0)
    seconds = run(*cells, "-o", work / "bound.t4h", "--measure", 0, "--memory", int(0.9 * limit), limit=limit)
    assert (work / "free.t4h").read_bytes() == (work / "bound.t4h").read_bytes(), "a data limit gives other bytes"
    assert seconds <= 2 * seconds_whole, (seconds, seconds_whole)

    assert mesh.stat().st_size > 2 * LITTLE_BYTES
    run(*slim, "--cell-tets", 100_000, "-o", work / "little.t4h", "--measure", 0, "--memory", int(0.8 * LITTLE_BYTES), limit=LITTLE_BYTES)
    for name in ("bound.t4h", "little.t4h"):
        verdict = subprocess.run([programs / "tet4d-info", "--validate", "--links", "--json", work / name], check=True,
                                 capture_output=True)
        verdict = json.loads(verdict.stdout)
        assert verdict["valid"] is True and 0.09 * tets_in < verdict["counts"]["tets"] <= 0.1 * tets_in, verdict
    loaded = with_columns(programs, work)
    print(f"{tets_in} tetrahedra, in core {whole['anonymous_bytes']} bytes and {seconds_whole:.1f} s of CPU, rms "
          f"{whole['error']['slice_rms_world']:.4f}; in cells with a data limit of {limit} bytes {seconds:.1f} s, rms "
          f"{stats('free.json')['error']['slice_rms_world']:.4f}; {mesh.stat().st_size} bytes of input through {LITTLE_BYTES}; {loaded}")
    shutil.rmtree(work)


main()
