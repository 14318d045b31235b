"""Cases of hyper-qslim, between the frames and what is played."""

import json

DAM = "frames=\"$(ls {data}/dambreak/alpha_00{08,09,10,11}.nrrd)\"; tet4d-mc $frames --iso 0.5 -q -o dam.t4h; "

COLUMNS = "tet4d-mc {data}/dambreak/alpha_00{08,09,10}.nrrd --iso 0.5 --stride 2 --normals gradient --velocity -q -o dam.t4h; "


def stats(result, name):
    return json.loads((result.directory / name).read_text())


# A promise, judged by slices as every program makes them and by the distance of surfaces.
def check_promise(result):
    record = stats(result, "s.json")
    error, counts = record["error"], record["counts"]
    assert 0 < error["confirmed_bound_world"] <= error["promised_world"] == 0.02, error
    assert 1 <= counts["tries"] <= 8, counts
    assert counts["tets"] < stats(result, "fine.json")["counts"]["tets"], "a larger promise takes more"
    assert error["slice_max_world"] <= error["promised_world"]
    if not result.stdout:
        return  # a build without OpenMesh reads no PLY, and has said so
    apart = json.loads(result.stdout)
    assert 0 < apart["max"] <= error["confirmed_bound_world"] * (1 + 1e-6), (apart, error)


def check_columns(result):
    plain, weighed = stats(result, "plain.json")["error"], stats(result, "weighed.json")["error"]
    assert weighed["column_velocity_rms"] < plain["column_velocity_rms"], (plain, weighed)
    assert plain["column_normal_rms"] > 0 and plain["column_normal_max"] >= plain["column_normal_rms"]


def check_parts(result):
    one, three = (json.loads(line) for line in result.stdout.strip().splitlines())
    assert three["valid"] and [part["isovalue"] for part in three["parts"]] == [0.3, 0.7], three["parts"]
    assert three["counts"]["tets"] <= 0.2 * one["counts"]["tets"]


def check_cells_promise(result):
    record = stats(result, "s.json")
    error, counts = record["error"], record["counts"]
    assert 0 < error["confirmed_bound_world"] <= error["promised_world"] == 0.02, error
    assert counts["cells_of_sweep_1"] >= 4 and 1 <= counts["tries"] <= 4, counts
    assert error["slice_max_world"] <= error["promised_world"]


# A ball that stands still is equally far from its result everywhere: the search for the largest distance must end.
def check_still(result):
    record = stats(result, "s.json")
    error = record["error"]
    assert 0 < error["slice_rms_world"] <= error["slice_p99_world"] <= error["slice_max_world"] < 1, error
    seconds = {phase["name"]: phase["seconds_cpu"] for phase in record["phases"]}
    assert seconds["measure"] < 20, seconds


# A ball that moves, 24 frames of 48^3.
BALL = """python3 - <<'END'
import array
n, frames = 48, 24
with open("ball.nrrd", "wb") as out:
    out.write(f"NRRD0004\\ntype: float\\ndimension: 4\\nsizes: {n} {n} {n} {frames}\\nendian: little\\nencoding: raw\\n\\n".encode())
    for k in range(frames):
        x2 = [(x - 18 - 0.4 * k) ** 2 for x in range(n)]
        y2 = [(y - 23.3 + 0.1 * k) ** 2 for y in range(n)]
        z2 = [(z - 24.1) ** 2 for z in range(n)]
        out.write(array.array("f", [290 - a - b - c for c in z2 for b in y2 for a in x2]).tobytes())
END
tet4d-mc ball.nrrd --iso 0 -q -o ball.t4h; """
# Runs in the background, is told to end once a cell is finished, and must have been interrupted by that.
INTERRUPT = """hyper-qslim {} & shell=$!
until grep -q '^cell 0 ' x.t4h.cells/journal 2>/dev/null; do kill -0 $shell; sleep 0.01; done
kill -TERM $(cat /proc/$shell/task/$shell/children); code=0; wait $shell || code=$?; test $code = 1; test ! -e x.t4h; """
CELLS = "dam.t4h --ratio 0.2 --cell-tets 8000 --measure 0 -q"
# The same killed at once when the journal has so many lines, each run going on with what the one before left.
KILL = """for n in 2 5 9 14 20 27; do hyper-qslim {} --resume -o x.t4h & shell=$!
until test "$(cat x.t4h.cells/journal 2>/dev/null | wc -l)" -ge $n; do kill -0 $shell 2>/dev/null || break; sleep 0.005; done
kill -KILL $(cat /proc/$shell/task/$shell/children 2>/dev/null) 2>/dev/null || true; wait $shell || true; rm -f x.t4h.partial-*; done; """
TWO = "tet4d-mc {data}/dambreak/alpha_00{08,09,10}.nrrd --iso 0.3,0.7 --stride 2 --normals gradient --velocity -q -o two.t4h; "

CASES = [
    {
        "name": "a fifth of the dam break, measured and validated",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.2 --measure 3 -q -o small.t4h --stats s.json && "
        "tet4d-info --validate --links --json small.t4h",
        "json": {"valid": True, "payload": "hypermesh", "counts.tets": {"at_least": 20000}, "provenance.program": "hyper-qslim"},
        "json_file": {"s.json": {"program": "hyper-qslim", "counts.collapses": {"at_least": 10000},
                                 "error.slice_rms_world": {"at_least": 1e-9}, "phases.0.name": "read"}},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "the same bytes for any thread count and codec of the input; what is measured changes nothing",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.3 --measure 0 -j 1 -q -o one.t4h; "
        "hyper-qslim dam.t4h --ratio 0.3 --measure 1 -j 3 -q -o three.t4h; cmp one.t4h three.t4h",
        "needs": ["tet4d-mc"],
    },
    {
        "name": "too little memory says how much is needed",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.1 --memory 1M -o x.t4h",
        "exit": 4,
        "stderr": ["simplified in core", "--memory"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a stop must be given",
        "shell": DAM + "hyper-qslim dam.t4h -o x.t4h",
        "exit": 2,
        "stderr": ["no stop is given", "--ratio"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a ratio above one is a usage error",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 2 -o x.t4h",
        "exit": 2,
        "stderr": ["--ratio"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a dry run plans and writes nothing",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.5 -n -o x.t4h",
        "stdout": ["peak_memory_bytes"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a promise is kept, confirmed by slices at a time it covers, and a larger one takes more",
        "shell": COLUMNS + "hyper-qslim dam.t4h --max-error 0.005 --measure 0 -q -o fine.t4h --stats fine.json; "
        "hyper-qslim dam.t4h --max-error 0.02 --measure 3 -q -o small.t4h --stats s.json; "
        "tet4d-convert dam.t4h --at 1f --columns none -q -o a.ply; tet4d-convert small.t4h --at 1f --columns none -q -o b.ply; "
        "tet4d-report distance a.ply b.ply --json -q 2> said || grep -q TET4D_WITH_OPENMESH said",
        "check": check_promise,
        "needs": ["tet4d-mc", "tet4d-convert", "tet4d-report"],
        "timeout": 300,
    },
    {
        "name": "a promise that cannot be kept fails, says how far it came and writes nothing",
        "shell": COLUMNS + "hyper-qslim dam.t4h --max-error 1e-4 --tries 2 -o x.t4h --stats s.json",
        "exit": 1,
        "stderr": ["2 tries did not come to 0.0001", "the least that was measured is", "nothing is written", "--tries"],
        "absent": ["x.t4h"],
        "json_file": {"s.json": {"counts.tries": 2, "error.least_measured_world": {"at_least": 1e-9}}},
        "needs": ["tet4d-mc"],
        "timeout": 300,
    },
    {
        "name": "cells: a valid mesh of as many tetrahedra as asked for",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.2 --cell-tets 20000 --measure 3 -j 2 -q -o small.t4h --stats s.json && "
        "tet4d-info --validate --links --json small.t4h",
        "json": {"valid": True, "counts.tets": {"at_least": 20000}},
        "json_file": {"s.json": {"counts.cells_of_sweep_1": {"at_least": 5}, "counts.cells_of_sweep_2": {"at_least": 2},
                                 "error.slice_rms_world": {"at_least": 1e-9}, "phases.1.name": "scatter"}},
        "absent": ["small.t4h.cells"],
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "cells: the same bytes for any threads and memory, and temporary files where they are wanted",
        "shell": DAM + f"mkdir tmp; hyper-qslim {CELLS} -j 1 -o one.t4h; hyper-qslim {CELLS} -j 3 --temp-dir tmp -o three.t4h; "
        f"hyper-qslim {CELLS} -j 2 --memory 18M -o little.t4h; cmp one.t4h three.t4h; cmp one.t4h little.t4h; rmdir tmp",
        "needs": ["tet4d-mc"],
    },
    {
        "name": "cells: a third of the memory that the whole takes, as a hard limit, gives the same bytes",
        "shell": BALL + "q='ball.t4h --ratio 0.1 --measure 0 -j 1 -q'; hyper-qslim $q --cell-tets 40000 -o free.t4h; "
        "(ulimit -d 16500; hyper-qslim $q --cell-tets 40000 --memory 13500K -o bound.t4h); cmp free.t4h bound.t4h; "
        "hyper-qslim $q -o whole.t4h --stats s.json; code=0; (ulimit -d 40000; hyper-qslim $q -o never.t4h) || code=$?; test $code = 4",
        "json_file": {"s.json": {"anonymous_bytes": {"at_least": 49.5e6}}},
        "absent": ["never.t4h"],
        "needs": ["tet4d-mc"],
        "timeout": 300,
    },
    {
        "name": "columns are carried, their error is measured, and in the metric it is smaller",
        "shell": COLUMNS + "hyper-qslim dam.t4h --ratio 0.1 --measure 3 -q -o plain.t4h --stats plain.json; "
        "hyper-qslim dam.t4h --ratio 0.1 --attributes velocity --measure 3 -q -o weighed.t4h --stats weighed.json; "
        "tet4d-info --validate --json weighed.t4h > info.json",
        "json_file": {"info.json": {"valid": True, "columns.0.name": "normal", "columns.1.name": "velocity"}},
        "check": check_columns,
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "columns that are not asked for are left out",
        "shell": COLUMNS + "hyper-qslim dam.t4h --ratio 0.1 --columns normal --measure 0 -q -o x.t4h; tet4d-info --json x.t4h",
        "json": {"columns.0.name": "normal"},
        "not_stdout": ["velocity\""],
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "an attribute that is not there is named, with those that are",
        "shell": COLUMNS + "hyper-qslim dam.t4h --ratio 0.1 --attributes presure:2 -o x.t4h",
        "exit": 2,
        "stderr": ["--attributes", "presure", "normal"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a weight of nothing is a usage error",
        "shell": COLUMNS + "hyper-qslim dam.t4h --ratio 0.1 --attributes velocity:0 -o x.t4h",
        "exit": 2,
        "stderr": ["--attributes", "no length above 0"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "parts are simplified one by one and keep their isovalues",
        "shell": "tet4d-mc {data}/dambreak/alpha_00{08,09,10}.nrrd --iso 0.3,0.7 --stride 2 -q -o two.t4h; "
        "hyper-qslim two.t4h --ratio 0.2 --measure 3 -q -o small.t4h; tet4d-info --json two.t4h | tr -d '\n'; echo; "
        "tet4d-info --validate --links --json small.t4h | tr -d '\n'",
        "check": check_parts,
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "cells: an interrupt leaves what --resume goes on with, to the same bytes",
        "shell": DAM + f"hyper-qslim {CELLS} -j 1 -o whole.t4h; " + INTERRUPT.format(CELLS + " -j 1 -o x.t4h")
        + f"grep -c '^cell' x.t4h.cells/journal; hyper-qslim {CELLS} -j 2 --resume -o x.t4h; cmp whole.t4h x.t4h",
        "stderr": ["interrupt", "--resume"],
        "absent": ["x.t4h.cells"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "cells: what a run left is not taken for another's, and goes when one begins anew",
        "shell": DAM + INTERRUPT.format(CELLS + " -j 1 -o x.t4h")
        + "code=0; hyper-qslim dam.t4h --ratio 0.3 --cell-tets 8000 -q --resume -o x.t4h || code=$?; test $code = 2; "
        "hyper-qslim dam.t4h --ratio 0.3 --cell-tets 8000 --measure 0 -q -o x.t4h",
        "stderr": ["--resume", "other options or another input"],
        "absent": ["x.t4h.cells"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "cells: a full disk leaves what --resume goes on with",
        "shell": DAM + f"hyper-qslim {CELLS} -o whole.t4h; code=0; (ulimit -f 300; hyper-qslim {CELLS} -o x.t4h) || code=$?; "
        f"test $code = 4; test ! -e x.t4h; hyper-qslim {CELLS} --resume -o x.t4h; cmp whole.t4h x.t4h",
        "stderr": ["--resume"],
        "absent": ["x.t4h.cells"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "cells: too little memory names what would do",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.1 --cell-tets 20000 --memory 1M -o x.t4h",
        "exit": 4,
        "stderr": ["--memory"],
        "absent": ["x.t4h", "x.t4h.cells"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "in core no more is held than planned, as a hard limit, whatever the order and however little is taken away",
        "shell": DAM + "for r in 0.9 0.1; do for o in passes heap multichoice; do q=\"dam.t4h --ratio $r --order $o --measure 0 -j 1 -q\"; "
        "plan=$(hyper-qslim $q -n -o x.t4h | awk '/^peak_memory_bytes/ { print $2 }'); "
        "(ulimit -d $((plan / 1024 + 16384)); hyper-qslim $q -f -o x.t4h); done; done",
        "needs": ["tet4d-mc"],
        "timeout": 300,
    },
    {
        "name": "--choices without --order multichoice is a usage error",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.5 --choices 3 -o x.t4h",
        "exit": 2,
        "stderr": ["--choices", "--order multichoice"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "--tries without --max-error is a usage error",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.5 --tries 3 -o x.t4h",
        "exit": 2,
        "stderr": ["--tries", "--max-error"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "in core --resume and --temp-dir say that they do nothing",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.5 --resume --temp-dir . --measure 0 -o x.t4h",
        "stderr": ["--resume: what is simplified in core", "--temp-dir: what is simplified in core"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "cells: parts, columns and the metric's, the same bytes for any threads and with little memory as a hard limit",
        "shell": TWO + "q='two.t4h --ratio 0.2 --attributes velocity --cell-tets 4000 --measure 0 -q'; hyper-qslim $q -j 1 -o one.t4h; "
        "plan=$(hyper-qslim $q -n -o x.t4h | awk '/^peak_memory_bytes/ { print $2 }'); hyper-qslim $q -j 3 -o three.t4h; cmp one.t4h three.t4h; "
        "(ulimit -d $((plan / 1024 + 4096)); hyper-qslim $q -j 1 --memory $plan -o little.t4h); cmp one.t4h little.t4h; "
        "tet4d-info --validate --links --json one.t4h",
        "json": {"valid": True, "columns.0.name": "normal", "columns.1.name": "velocity", "parts.1.isovalue": 0.7},
        "absent": ["one.t4h.cells"],
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "cells: a promise is kept, measured from files page by page",
        "shell": COLUMNS + "hyper-qslim dam.t4h --max-error 0.02 --tries 4 --cell-tets 3000 --measure 3 -q -o x.t4h --stats s.json; "
        "tet4d-info --validate --links --json x.t4h",
        "json": {"valid": True},
        "check": check_cells_promise,
        "absent": ["x.t4h.cells"],
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "cells: a promise that cannot be kept fails and writes nothing",
        "shell": COLUMNS + "hyper-qslim dam.t4h --max-error 1e-4 --tries 2 --cell-tets 9000 -o x.t4h --stats s.json",
        "exit": 1,
        "stderr": ["2 tries did not come to 0.0001", "nothing is written"],
        "absent": ["x.t4h", "x.t4h.cells"],
        "needs": ["tet4d-mc"],
        "timeout": 300,
    },
    {
        "name": "cells: --non-manifold keep looks for such places in cells",
        "shell": DAM + f"hyper-qslim {CELLS.replace(' -q', '')} --non-manifold keep -o x.t4h",
        "stderr": ["cells to", "left as they are: 0 triangles"],
        "not_stderr": ["in core"],
        "absent": ["x.t4h.cells"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "the heap is in core whatever --cell-tets, and says so",
        "shell": DAM + "hyper-qslim dam.t4h --ratio 0.8 --order heap --cell-tets 8000 --measure 0 -o x.t4h",
        "stderr": ["more than --cell-tets, and yet in core", "the heap has one order"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "cells: killed at any point, --resume goes on to the same bytes",
        "shell": DAM + f"hyper-qslim {CELLS} -j 1 -o whole.t4h; " + KILL.format(CELLS + " -j 1")
        + f"test -e x.t4h || hyper-qslim {CELLS} -j 2 --resume -o x.t4h; cmp whole.t4h x.t4h",
        "absent": ["x.t4h.cells"],
        "needs": ["tet4d-mc"],
        "timeout": 300,
    },
    {
        "name": "cells: --resume where nothing was left begins anew and says so",
        "shell": DAM + f"hyper-qslim {CELLS.replace(' -q', '')} --resume -o x.t4h",
        "stderr": ["--resume: nothing was left of an interrupted run"],
        "absent": ["x.t4h.cells"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a ball that stands still is measured in bounded time",
        "shell": BALL.replace("0.4 * k", "0").replace("0.1 * k", "0") + "hyper-qslim ball.t4h --ratio 0.02 --measure 3 -q -o x.t4h --stats s.json",
        "check": check_still,
        "needs": ["tet4d-mc"],
        "timeout": 300,
    },
    {
        "name": "a measurement that does not fit into memory is a warning: the result is there",
        "shell": DAM + "q='dam.t4h --ratio 0.2 -j 1'; plan=$(hyper-qslim $q -n -o x.t4h | awk '/^peak_memory_bytes/ { print $2 }'); "
        "hyper-qslim $q --memory $plan -o x.t4h; tet4d-info --validate --json x.t4h",
        "json": {"valid": True},
        "stderr": ["the result is written, but not measured", "--memory", "--measure 0 leaves that out"],
        "needs": ["tet4d-mc", "tet4d-info"],
    },
]
