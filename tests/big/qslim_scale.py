#!/usr/bin/env python3
"""A million tetrahedra exactly flat in 4D beside a million curved ones, and blobs to 1 % and 0.5 %: hyper-qslim as a whole.

usage: qslim_scale.py BIN_DIR WORK_DIR [--small]
Flat regions are what heaps and link tests choke on elsewhere: here a tetrahedron of one may cost at most twice the
processor time of a curved one. Prints what it measured; exits 1 where a bound is broken, 77 without numpy.
"""
import json
import pathlib
import subprocess
import sys

try:
    import numpy as np
except ImportError:
    print("skipped: no numpy")
    sys.exit(77)

BIN, WORK = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
SMALL = "--small" in sys.argv
WORK.mkdir(parents=True, exist_ok=True)


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def extract(name, side, frames, field):
    """field(x, y, z, t), the surface where it is 0, as WORK/name.t4h; its count of tetrahedra."""
    z, y, x = np.meshgrid(*[np.arange(side, dtype=np.float64)] * 3, indexing="ij")
    raw = WORK / f"{name}.raw"
    with raw.open("wb") as out:
        for t in range(frames):
            out.write(field(x, y, z, float(t)).astype("<f4").tobytes())
    run(BIN / "tet4d-mc", raw, "--size", f"{side},{side},{side}", "--type", "f32", "--iso", "0", "-q", "-f", "-o",
        WORK / f"{name}.t4h")
    raw.unlink()
    return json.loads(run(BIN / "tet4d-info", "--json", WORK / f"{name}.t4h"))["counts"]["tets"]


def slim(name, *options):
    """--stats of hyper-qslim on one thread, its result validated with links."""
    out, stats = WORK / f"{name}-slim.t4h", WORK / f"{name}.json"
    run(BIN / "hyper-qslim", WORK / f"{name}.t4h", *options, "-j", 1, "-q", "-f", "-o", out, "--stats", stats)
    info = json.loads(run(BIN / "tet4d-info", "--validate", "--links", "--json", out))
    assert info["valid"], info
    return json.loads(stats.read_text())


def blobs(count, side, frames):
    """Balls that orbit, meet and part."""
    seed = np.random.default_rng(4)
    middle, phase = seed.uniform(0.3, 0.7, (count, 3)) * side, seed.uniform(0, 6.28, (count, 3))
    reach, radius = seed.uniform(0.05, 0.2, (count, 3)) * side, seed.uniform(0.1, 0.17, count) * side

    def field(x, y, z, t):
        total = np.full(x.shape, -1.0)
        for m, p, a, r in zip(middle, phase, reach, radius):
            c = m + a * np.sin(p + t * 6.28 / frames)
            total += (r * r) / ((x - c[0]) ** 2 + (y - c[1]) ** 2 + (z - c[2]) ** 2 + 1e-3 * r * r)
        return total

    return field


def cost(name, tets, *options):
    stats = slim(name, *options)
    phase = next(p for p in stats["phases"] if p["name"] == "simplify")
    removed = tets - stats["counts"]["tets"]
    print(f"{name}: {tets} -> {stats['counts']['tets']} tets, {phase['seconds_cpu'] / removed * 1e6:.2f} us a tetrahedron")
    return phase["seconds_cpu"] / removed


side, frames = (28, 8) if SMALL else (72, 20)
tilted = lambda x, y, z, t: 0.3 * side + 0.25 * x - 0.125 * y + 0.5 * t - z  # exact in binary: flat to the last bit
flat_tets = extract("flat", side, frames, tilted)
curved_tets = extract("curved", side, frames, lambda x, y, z, t: 0.41 * side + 0.02 * t - np.sqrt(
    (x - side / 2 - 0.3 * t + 2) ** 2 + (y - side / 2) ** 2 + (z - side / 2.1) ** 2))
curved = cost("curved", curved_tets, "--ratio", 0.05, "--measure", 0)
flat = cost("flat", flat_tets, "--ratio", 0.05, "--measure", 0)
assert flat <= 2 * curved, f"a flat tetrahedron costs {flat / curved:.2f} times a curved one"

side, frames = (26, 10) if SMALL else (64, 32)
tets = extract("blobs", side, frames, blobs(6, side, frames))
for ratio in (0.01,) if SMALL else (0.01, 0.005):
    stats = slim("blobs", "--ratio", ratio, "--measure", 5)
    left, error = stats["counts"]["tets"], stats["error"]
    print(f"blobs: {tets} -> {left} tets ({left / tets:.2%}), slices rms {error['slice_rms_world']:.3f}, "
          f"largest {error['slice_max_world']:.3f} cells")
    assert left <= ratio * tets, f"{left} of {tets} tetrahedra are more than {ratio:.1%}"
    assert error["slice_rms_world"] < 1, error
