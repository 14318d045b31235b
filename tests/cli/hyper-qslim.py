"""Cases of hyper-qslim, between the frames and what is played."""

DAM = "frames=\"$(ls {data}/dambreak/alpha_00{08,09,10,11}.nrrd)\"; tet4d-mc $frames --iso 0.5 -q -o dam.t4h; "

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
        "name": "cells: a quarter of the memory that the whole takes, as a hard limit, gives the same bytes",
        "shell": BALL + "q='ball.t4h --ratio 0.1 --measure 0 -j 1 -q'; hyper-qslim $q --cell-tets 60000 -o free.t4h; "
        "(ulimit -d 20000; hyper-qslim $q --cell-tets 60000 --memory 17M -o bound.t4h); cmp free.t4h bound.t4h; "
        "hyper-qslim $q -o whole.t4h --stats s.json; code=0; (ulimit -d 60000; hyper-qslim $q -o never.t4h) || code=$?; test $code = 4",
        "json_file": {"s.json": {"anonymous_bytes": {"at_least": 80e6}}},
        "absent": ["never.t4h"],
        "needs": ["tet4d-mc"],
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
]
