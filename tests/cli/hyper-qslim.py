"""Cases of hyper-qslim, between the frames and what is played."""

DAM = "frames=\"$(ls {data}/dambreak/alpha_00{08,09,10,11}.nrrd)\"; tet4d-mc $frames --iso 0.5 -q -o dam.t4h; "


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
]
