"""The whole dam break, if its 76 frames are at hand beside the project: mesh, links, triangles,
pictures. Skipped (77) where the frames are not there.

usage: dam_break.py PROGRAMS_DIR FOLDER_OF_SHARED WORK_DIR
"""

import json
import pathlib
import shutil
import subprocess
import sys


def main():
    programs, beside, work = map(pathlib.Path, sys.argv[1:])
    frames = beside / "shared" / "data" / "vof-dambreak"
    if not (frames / "alpha_0075.nrrd").exists():
        print("the whole dam break is not here: skipped")
        sys.exit(77)
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)

    def run(program, *words):
        done = subprocess.run([str(programs / program), *map(str, words)], check=True, capture_output=True)
        return done.stdout

    run("tet4d-mc", frames, "--iso", 0.5, "-q", "-o", work / "dam.t4h")
    told = json.loads(run("tet4d-info", "--validate", "--links", "--json", work / "dam.t4h"))
    assert told["valid"] is True and told["counts"]["frames"] == 76, told
    assert told["counts"]["tets"] > 3_000_000, told["counts"]
    run("dyntri-build", work / "dam.t4h", "-q", "-o", work / "dam.t4d")
    triangles = json.loads(run("tet4d-info", "--validate", "--json", work / "dam.t4d"))
    assert triangles["valid"] is True
    # Every triangle that does not live at all was left out, and none else.
    assert triangles["counts"]["triangles"] + triangles["counts"]["empty"] == 4 * told["counts"]["tets"]
    run("tet4d-play", work / "dam.t4d", "--offscreen", "--renderer", "cpu", "--size", "64x36", "--times", "0f:75f:15f", "-q",
        "-o", work / "p/%02d.png")
    assert len(list((work / "p").iterdir())) == 6
    print(f"{told['counts']['tets']} tetrahedra, {triangles['counts']['triangles']} triangles")
    shutil.rmtree(work)


main()
