#!/usr/bin/python3
"""The checks in scripts/ find the faults they are there for, and nothing in a clean tree.

usage: test_checks.py SCRIPTS_DIR
"""
import pathlib
import subprocess
import sys
import tempfile

FAULTS = {
    # file -> (text, check, words its message must hold)
    "formats/a.h": ('#include "libpreprocess/error.h"\n', "check_layers.py", "formats may not see libpreprocess"),
    "formats/b.h": ("#include <glm/vec3.hpp>\n", "check_layers.py", "formats/b.h:1"),
    "libpreprocess/dyntri/c.h": ('#include "libpreprocess/hypermesh/x.h"\n', "check_layers.py", "may not see"),
    "player/render/d.h": ("#include <GL/osmesa.h>\n", "check_layers.py", "player/host only"),
    "player/scene/e.h": ('#include "player/host/x.h"\n', "check_layers.py", "may not see player/host"),
    "tools/tet4d_mc.cpp": ('#include "player/host/x.h"\n', "check_layers.py", "tools may not see player/host"),
    "formats/f.h": ("#include <unheard_of/library.h>\n", "check_layers.py", "does not know"),
    "formats/g.cpp": ("//\n" * 1001, "check_files.py", "1001 lines"),
    "formats/README.md": ("line\n" * 41, "check_files.py", "at most 40"),
    "player/host/h.cpp": ("// TO" "DO\n", "check_files.py", "unfinished"),
    "tools/i.cpp": ('const char* path = "/ho' 'me/somebody";\n', "check_files.py", "one machine"),
    "libpreprocess/topology/j.h": ("\n", "check_files.py", "a room without README.md"),
    "docs/k.md": ("see [the other page](other.md)\n", "check_files.py", "leads nowhere"),
}
CLEAN = {
    "formats/README.md": "the files\n",
    "formats/core/vec.h": "#include <cmath>\n",
    "formats/x.h": '#include <zstd.h>\n#include "formats/core/vec.h"\n',
    "tools/README.md": "the programs\n",
    "tools/tet4d_play.cpp": '#include "player/host/x.h"\n',
    "player/host/README.md": "the screen\n",
    "player/host/x.h": "#include <GL/osmesa.h>\n",
}


def check(scripts, files, script):
    """Runs a check on a fresh tree: (exit code, what it printed)."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        subprocess.run(["git", "init", "-q", folder], check=True)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        done = subprocess.run(["/usr/bin/python3", str(scripts / script), "--root", folder], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr


def main():
    scripts = pathlib.Path(sys.argv[1])
    wrong = []
    for script in ("check_layers.py", "check_files.py"):
        code, out = check(scripts, CLEAN, script)
        if code != 0:
            wrong.append(f"{script} refuses a clean tree:\n{out}")
    for name, (text, script, words) in FAULTS.items():
        code, out = check(scripts, {**CLEAN, name: text}, script)
        if code != 1 or words not in out:
            wrong.append(f"{script} ends with {code} and does not say '{words}' about {name}:\n{out}")
    print("\n".join(wrong) or f"checks: {len(FAULTS)} faults found")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
