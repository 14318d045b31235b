#!/usr/bin/python3
"""Checks that every test named in docs/parts.md exists in a build, and that a part which is there names one.

usage: scripts/check_parts.py BUILD_DIR
"""
import json
import pathlib
import re
import subprocess
import sys


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip().splitlines()[-1])
    root = pathlib.Path(__file__).resolve().parent.parent
    listed = subprocess.run(["ctest", "--test-dir", sys.argv[1], "--show-only=json-v1"], check=True, capture_output=True)
    tests = [test["name"] for test in json.loads(listed.stdout)["tests"]]
    faults, parts = [], 0
    for line in (root / "docs/parts.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) != 5 or not re.fullmatch(r"[A-Z]\d+", cells[0]):
            continue
        parts += 1
        named = re.findall(r"`([^`]+)`", cells[4])
        if cells[2] != "not yet" and not named:
            faults.append(f"docs/parts.md: {cells[0]} is said to be there, but names no test")
        faults += [f"docs/parts.md: {cells[0]} names {name}, and no test is called so" for name in named
                   if not any(re.search(name, test) for test in tests)]
    if parts == 0:
        faults.append("docs/parts.md: no rows were understood")
    print("\n".join(faults + [f"parts: {parts} parts, {len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
