#!/usr/bin/python3
"""Checks what holds for every text file: its length, the READMEs of rooms, words that mark unfinished work, paths of one
machine, links that lead nowhere.

usage: scripts/check_files.py [--root DIR]
"""
import argparse
import pathlib
import re
import subprocess
import sys

MAX_LINES = 1000
MAX_README_LINES = 40
MAX_BYTES = 4 << 20
ROOMS = ["formats", "libpreprocess", "player", "tools"]
ROOMS_WITHOUT_README = {"libpreprocess", "player", "formats/core"}  # containers of rooms; their rooms have one each
CODE = {".h", ".cpp", ".cc", ".inc", ".glsl", ".vert", ".frag", ".py", ".sh", ".mk", ".cmake", ".txt", ""}
TEXT = CODE | {".md", ".json", ".in", ".yml"}
# Spelled in pieces, so that this file does not find itself.
UNFINISHED = re.compile(r"\b(TO" + r"DO|FIX" + r"ME|X" + r"XX|HA" + r"CK|st" + r"ub|not\s+yet\s+imple" + r"mented)\b")
LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")
MACHINE_PATH = re.compile(r"(?<![\w.}$])/(home|root|work|Users|mnt)/")


def textFiles(root):
    """Tracked files and new ones that are not ignored."""
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-co", "--exclude-standard", "-z"], check=True,
                            capture_output=True).stdout.decode()
    for name in sorted(set(listed.split("\0")) - {""}):
        path = root / name
        if path.is_file() and not path.is_symlink():
            yield name, path


def checkText(name, path):
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    if len(lines) > MAX_LINES:
        yield f"{name}: {len(lines)} lines, at most {MAX_LINES}; split it by what it does"
    if path.name == "README.md" and name.split("/")[0] in ROOMS and len(lines) > MAX_README_LINES:
        yield f"{name}: {len(lines)} lines, a room's README has at most {MAX_README_LINES}"
    for number, line in enumerate(lines, 1):
        if path.suffix in CODE and (found := UNFINISHED.search(line)):
            yield f"{name}:{number}: '{found.group()}' marks unfinished work"
        if path.suffix == ".md":
            for link in LINK.findall(line):
                if not (path.parent / link).exists():
                    yield f"{name}:{number}: the link to {link} leads nowhere"
        if found := MACHINE_PATH.search(line):
            yield f"{name}:{number}: '{found.group()}...' is a path of one machine"


def checkRooms(names):
    """Every folder with sources is a room, and every room says what it is for."""
    folders = {str(pathlib.PurePosixPath(n).parent) for n in names if n.split("/")[0] in ROOMS and n.endswith((".h", ".cpp"))}
    for folder in sorted(folders - ROOMS_WITHOUT_README):
        if f"{folder}/README.md" not in names and str(pathlib.PurePosixPath(folder).parent / "README.md") not in names:
            yield f"{folder}: a room without README.md"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parent.parent, type=pathlib.Path)
    root = parser.parse_args().root.resolve()
    faults, names = [], set()
    for name, path in textFiles(root):
        names.add(name)
        if path.stat().st_size > MAX_BYTES:
            faults.append(f"{name}: {path.stat().st_size} bytes, at most {MAX_BYTES}")
        elif path.suffix in TEXT and b"\0" not in path.read_bytes():
            faults.extend(checkText(name, path))
    faults.extend(checkRooms(names))
    print("\n".join(faults + [f"files: {len(names)} files, {len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
