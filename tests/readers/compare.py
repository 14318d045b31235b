"""The Python readers, written from the pages of docs/formats alone, against the C++ readers: the same content of every good
file, the same slices, and every forged file refused by both.

usage: compare.py --generator PROGRAM --readers FOLDER --golden FOLDER --work FOLDER
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
READERS = {".t4g": ("read_grid4", "Grid4"), ".t4h": ("read_hypermesh", "Hypermesh"),
           ".t4d": ("read_dynamic_triangles", "DynamicTriangles"),
           ".t4q": ("read_surface_sequence", "SurfaceSequence"),
           ".t4p": ("read_patch_dag", "PatchDag")}


class Comparison:
    def __init__(self, readers):
        sys.path.insert(0, str(readers))
        self.t4 = importlib.import_module("t4container")
        self.readers = {suffix: getattr(importlib.import_module(module), name)
                        for suffix, (module, name) in READERS.items()}
        self.faults, self.checked = [], 0

    def expect(self, condition, path, what):
        self.checked += 1
        if not condition:
            self.faults.append(f"{path.name}: {what}")

    def read(self, path):
        return self.readers[path.suffix](str(path))

    def good(self, path):
        try:
            payload = self.read(path)
        except self.t4.FormatError as error:
            return self.expect(False, path, f"refused: {error}")
        lines = list(payload.dump())
        expected = pathlib.Path(f"{path}.dump").read_text(encoding="utf-8")
        self.same_lines(path, "dump", lines, expected.splitlines())
        self.expect(self.t4.digest(lines) == self.t4.xxhash.xxh3_64_hexdigest(expected.encode()), path, "digest differs")
        pages = pathlib.Path(f"{path}.pages").read_text()
        self.expect(payload.pages.digest() == pages, path, f"page digest {payload.pages.digest()}, C++ {pages}")
        if path.suffix == ".t4h":
            try:
                self.slices(path, payload)
            except self.t4.FormatError as error:
                self.expect(False, path, f"slices or faces: {error}")
        return None

    def slices(self, path, mesh):
        """The C++ slices, triangle by triangle; winding against exact geometry; faces where the sample is a manifold."""
        expected = pathlib.Path(f"{path}.slices").read_text(encoding="utf-8").splitlines()
        lines = []
        for line in expected:
            if line.startswith("slice at "):
                time = struct.unpack("<f", struct.pack("<f", float(line.split()[2])))[0]
                lines.extend(mesh.dump_slice(time, check_winding=True))
        self.same_lines(path, "slices", lines, expected)
        if mesh.tet_count:
            self.expect(any(line.startswith("tri ") for line in lines), path, "no slice has a triangle")
        mesh.check_faces()

    def same_lines(self, path, name, ours, theirs):
        for number, (one, other) in enumerate(zip(ours, theirs), 1):
            if one != other:
                return self.expect(False, path, f"{name} line {number}: Python '{one}', C++ '{other}'")
        return self.expect(len(ours) == len(theirs), path, f"{name}: Python {len(ours)} lines, C++ {len(theirs)}")

    def bad(self, path):
        try:
            self.read(path)
        except self.t4.FormatError:
            return self.expect(True, path, "")
        except Exception as error:  # what is no FormatError is a fault of the reader
            return self.expect(False, path, f"{type(error).__name__}: {error}")
        return self.expect(False, path, "accepted")

    def golden(self, folder):
        for line in (folder / "golden" / "digests.txt").read_text().splitlines():
            name, digest = line.split("|")
            path = folder / "golden" / name
            try:
                self.expect(self.t4.digest(self.read(path).dump()) == digest, path, "digest differs")
            except self.t4.FormatError as error:
                self.expect(False, path, f"refused: {error}")
        for line in (folder / "golden_bad" / "faults.txt").read_text().splitlines():
            self.bad(folder / "golden_bad" / line.split("|")[0])

    def programs(self, readers, path):
        """The readers as programs: a summary, a dump, exit 3 for a bad file."""
        program = readers / (READERS[path.suffix][0] + ".py")
        run = lambda *arguments: subprocess.run([sys.executable, program, *arguments], capture_output=True, text=True)
        self.expect('"digest": "' in run(path).stdout, path, "no summary")
        dump = run(path, "--dump").stdout
        self.expect(dump == pathlib.Path(f"{path}.dump").read_text(encoding="utf-8"), path, "--dump differs")
        cut = path.with_name("cut" + path.suffix)
        cut.write_bytes(path.read_bytes()[:-1])
        result = run(cut)
        self.expect(result.returncode == 3 and "Traceback" not in result.stderr, cut, f"exit {result.returncode}")
        cut.unlink()


def main():
    parser = argparse.ArgumentParser()
    for name in ("generator", "readers", "golden", "work"):
        parser.add_argument(f"--{name}", required=True, type=pathlib.Path)
    options = parser.parse_args()
    try:
        importlib.import_module("xxhash")
        importlib.import_module("zstandard")
    except ImportError as error:
        print(f"skipped: {error}; scripts/install-deps brings it")
        return SKIPPED
    shutil.rmtree(options.work, ignore_errors=True)
    subprocess.run([options.generator, options.work], check=True)
    comparison = Comparison(options.readers)
    good = [p for p in sorted((options.work / "good").iterdir()) if p.suffix in READERS]
    bad = sorted((options.work / "bad").iterdir())
    for path in good:
        comparison.good(path)
    for path in bad:
        comparison.bad(path)
    comparison.golden(options.golden)
    for name in ("grid_u8.t4g", "mesh_columns.t4h", "triangles.t4d", "surface_columns.t4q", "dag.t4p"):
        comparison.programs(options.readers, options.work / "good" / name)
    print("\n".join(comparison.faults))
    print(f"{len(good)} good files, {len(bad)} forged ones, {comparison.checked} checks, {len(comparison.faults)} faults")
    return 1 if comparison.faults or len(good) < 30 or len(bad) < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
