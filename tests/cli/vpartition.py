"""Cases of vpartition: a mesh in, a sound DAG out, and what is refused."""

import json

BALL = """python3 - <<'END'
import array
n, frames = 32, 10
with open("ball.nrrd", "wb") as out:
    out.write(f"NRRD0004\\ntype: float\\ndimension: 4\\nsizes: {n} {n} {n} {frames}\\nendian: little\\nencoding: raw\\n\\n".encode())
    for k in range(frames):
        x2 = [(x - 14 - 0.4 * k) ** 2 for x in range(n)]
        y2 = [(y - 15.3 + 0.1 * k) ** 2 for y in range(n)]
        z2 = [(z - 16.1) ** 2 for z in range(n)]
        out.write(array.array("f", [110 - a - b - c for c in z2 for b in y2 for a in x2]).tobytes())
END
tet4d-mc ball.nrrd --iso 0 -q -o ball.t4h; """
SMALL = "--cell-tets 9000 --patch-tets 1200"


def check_dag(result):
    info = json.loads(result.stdout)
    assert info["payload"] == "patch_dag" and info["valid"] and info["faults"] == [], info["faults"]
    record = json.loads((result.directory / "s.json").read_text())
    counts, told = record["counts"], info["counts"]
    for name in ("tets", "nodes", "patches"):
        assert counts[name] == told[name], name
    assert told["leaf_tets"] == counts["tets_in"], "nothing of a moving ball is without error"
    assert counts["root_patches"] == 1 and counts["root_tets"] <= 1200 and counts["largest_patch"] <= 1200
    assert counts["levels"] == len(info["levels"]) - 1 >= 4, "the sink's level is listed too"
    assert info["cuts"]["cracked_nodes"] == 0 == info["cuts"]["open_faces"] and info["cuts"]["nodes"] == told["nodes"] - 2
    assert 0 < counts["locked_vertices"] < counts["cell_vertices"]
    assert record["error"]["estimated_world"] > 0
    names = [phase["name"] for phase in record["phases"]]
    assert names == ["read", "partition", "simplify", "write"], names
    options = info["provenance"]["options"]
    assert options["time-scale"] == 2 and options["partition"] == "voronoi" and "threads" not in options, options


def check_plan(result):
    plan = dict(line.split() for line in result.stdout.strip().splitlines())
    assert int(plan["peak_memory_bytes"]) > 0 and int(plan["temporary_bytes"]) == 0
    record = json.loads((result.directory / "s.json").read_text())
    assert record["anonymous_bytes"] <= int(plan["peak_memory_bytes"]) + (32 << 20), (record["anonymous_bytes"], plan)
    assert (result.directory / "a.t4p").stat().st_size <= int(plan["output_bytes_at_most"])


CASES = [
    {
        "name": "a ball becomes levels down to one patch",
        "shell": BALL + f"vpartition ball.t4h -o ball.t4p {SMALL} --time-scale 2 --stats s.json -q; tet4d-info --json --validate ball.t4p",
        "check": check_dag,
        "needs": ["tet4d-mc", "vpartition", "tet4d-info"],
    },
    {
        "name": "the same bytes for any threads, and kd is sound too",
        "shell": BALL + f"vpartition ball.t4h -o a.t4p {SMALL} -q -j 1; vpartition ball.t4h -o b.t4p {SMALL} -q -j 3; cmp a.t4p b.t4p; "
                 f"vpartition ball.t4h -o c.t4p {SMALL} --partition kd --page-codec raw --progress none -v 2>&1 | grep -c 'level [0-9]*: '; "
                 "tet4d-info --validate c.t4p > c.txt; grep -q '^valid *true' c.txt",
        "needs": ["tet4d-mc", "vpartition", "tet4d-info"],
    },
    {
        "name": "a dry run bounds memory and bytes",
        "shell": BALL + f"vpartition ball.t4h -o a.t4p {SMALL} -q --stats s.json; vpartition ball.t4h -o b.t4p {SMALL} -n; test ! -e b.t4p",
        "check": check_plan,
        "measures_memory": True,
        "needs": ["tet4d-mc", "vpartition"],
    },
    {
        "name": "one resolution is no DAG",
        "shell": BALL + "vpartition ball.t4h -o a.t4p --cell-tets 60 --patch-tets 60",
        "exit": 3,
        "stderr": ["cannot be made coarser", "% of the vertices locked", "raise --cell-tets"],
        "absent": ["a.t4p"],
        "needs": ["tet4d-mc", "vpartition"],
    },
]
