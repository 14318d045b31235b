#!/usr/bin/python3
"""Checks that the rooms of the project include each other only along the allowed arrows.

The two tables below are the rule; everything under them only reads files. A room is a folder; a file belongs to the
longest prefix listed. An arrow that is missing here is either a mistake or a decision: decide, then add it.
usage: scripts/check_layers.py [--root DIR]
"""
import argparse
import pathlib
import re
import sys

FORMATS = ["formats", "formats/core"]
BASE = FORMATS + ["libpreprocess", "libpreprocess/outofcore"]

# room -> rooms it may include. The systems of libpreprocess (hypermesh, dyntri, ...) do not see each other: they meet
# through payload views, that is, through formats.
ALLOWED = {
    "formats/core": [],
    "formats": ["formats/core"],
    "libpreprocess": FORMATS,
    "libpreprocess/outofcore": FORMATS + ["libpreprocess"],
    "libpreprocess/exchange": BASE,
    "libpreprocess/topology": BASE,
    "libpreprocess/measure": BASE + ["libpreprocess/topology", "libpreprocess/exchange"],
    "libpreprocess/hypermesh": BASE + ["libpreprocess/topology", "libpreprocess/exchange"],
    "libpreprocess/prisms": BASE + ["libpreprocess/topology", "libpreprocess/exchange"],
    "libpreprocess/qslim4d": BASE + ["libpreprocess/topology", "libpreprocess/exchange"],
    # Simplifies its cells with qslim4d's kernel.
    "libpreprocess/vpartition": BASE + ["libpreprocess/exchange", "libpreprocess/qslim4d"],
    "libpreprocess/dyntri": BASE + ["libpreprocess/topology"],
    "player/stream": FORMATS,
    "player/scene": FORMATS + ["player/stream"],
    "player/render": FORMATS + ["player/stream", "player/scene"],
    "player/host": FORMATS + ["player/stream", "player/scene", "player/render"],
    "tools/common": BASE,
    "tools": BASE + ["libpreprocess/exchange", "libpreprocess/topology", "libpreprocess/measure",
                     "libpreprocess/hypermesh", "libpreprocess/prisms", "libpreprocess/dyntri", "libpreprocess/qslim4d",
                     "libpreprocess/vpartition",
                     "player/scene", "tools/common"],
    "tools/tet4d-play": FORMATS + ["libpreprocess", "player/stream", "player/scene", "player/render", "player/host",
                                   "tools/common", "tools/play"],
    "tools/play": FORMATS + ["libpreprocess", "player/stream", "player/scene", "player/render", "player/host", "tools/common",
                             "tools"],
    "tests": None,  # sees all
}

# Headers of other libraries -> the only rooms that may include them (tests may include all of them).
FOREIGN = {
    r"zstd\.h": ["formats", "libpreprocess/exchange"],
    r"xxhash\.h": ["formats", "libpreprocess/exchange"],
    r"zlib\.h": ["libpreprocess/exchange"],
    r"(expat|bzlib|nifti1_io|exodusII|tiny_gltf)\.h|draco/.*|OpenMesh/.*": ["libpreprocess/exchange"],
    r"spng\.h": ["libpreprocess/exchange", "player/host"],
    r"GL/osmesa\.h|GLFW/.*": ["player/host"],
    r"imgui(_stdlib)?\.h": ["player/render", "player/host"],
    r"glad/.*": ["player/render", "player/host"],
    r"glm/.*": ["libpreprocess", "libpreprocess/*", "player/*", "tools", "tools/tet4d-play"],
    r"CLI/.*": ["tools/common", "tools", "tools/tet4d-play"],
    r"nlohmann/.*": ["libpreprocess/exchange", "libpreprocess/measure", "player/scene", "player/host", "tools/common",
                     "tools", "tools/tet4d-play"],
    r"fmt/.*": ["libpreprocess", "libpreprocess/*", "player/host", "tools/common", "tools", "tools/tet4d-play"],
    r"cairo\.h": ["tools"],
    r"CGAL/.*|gtest/.*|gmock/.*|benchmark/.*": [],
}

SYSTEM = re.compile(r"[a-z_0-9]+|(sys|linux)/[a-z_]+\.h|(dlfcn|fcntl|unistd|dirent|poll|pthread|sched|signal|spawn|termios)\.h"
                    r"|(errno|stdint|stddef|string|stdio|stdlib|time|immintrin|emmintrin|getopt|malloc)\.h")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
SUFFIXES = {".h", ".cpp", ".inc", ".hpp", ".cc"}
TOPS = ["formats", "libpreprocess", "player", "tools", "tests"]


def roomOf(path):
    """The room of a file given relative to the root, or None for a file in no room."""
    parts = path.split("/")
    if parts[0] == "tests":
        return "tests"
    if parts[0] == "tools" and re.match(r"(tet4d[-_])?play([-_.]|$)", parts[1]):
        return "tools/tet4d-play"
    for length in range(len(parts) - 1, 0, -1):
        room = "/".join(parts[:length])
        if room in ALLOWED:
            return room
    return None


def mayUse(room, rooms):
    return any(room == r or (r.endswith("/*") and room.startswith(r[:-1])) for r in rooms)


def checkInclude(root, path, room, bracket, header):
    """What is wrong with one include, or None."""
    if ALLOWED[room] is None:
        return None
    local = (root / path).parent / header
    if bracket == '"' and local.exists():
        header = local.resolve().relative_to(root).as_posix()
    if header.split("/")[0] in TOPS:
        target = roomOf(header)
        if target is None:
            return f"includes {header}, which is in no room that scripts/check_layers.py knows"
        if target == room or target in ALLOWED[room]:
            return None
        return f"includes {header}: {room} may not see {target}"
    for pattern, rooms in FOREIGN.items():
        if re.fullmatch(pattern, header):
            return None if mayUse(room, rooms) else f"includes <{header}>: allowed in {', '.join(rooms) or 'tests'} only"
    if bracket == '"' and "/" not in header:
        return None  # generated into the room's own build folder
    if bracket == "<" and SYSTEM.fullmatch(header):
        return None
    return f"includes {header}, which scripts/check_layers.py does not know; add the library to its table"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parent.parent, type=pathlib.Path)
    root = parser.parse_args().root.resolve()
    faults, files = [], 0
    for top in TOPS:
        for file in sorted((root / top).rglob("*")):
            if file.suffix not in SUFFIXES or not file.is_file():
                continue
            path = file.relative_to(root).as_posix()
            room = roomOf(path)
            files += 1
            if room is None:
                faults.append(f"{path}: in no room that scripts/check_layers.py knows; add it to the table")
                continue
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                fault = match and checkInclude(root, path, room, *match.groups())
                if fault:
                    faults.append(f"{path}:{number}: {fault}")
    print("\n".join(faults + [f"layers: {files} files, {len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
