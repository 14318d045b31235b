"""Cases of dyntri-build, and of the way from frames to what is played."""

DAM = "frames=\"$(ls {data}/dambreak/alpha_00{08,09,10,11}.nrrd)\"; tet4d-mc $frames --iso 0.5 -q -o dam.t4h; "


CASES = [
    {
        "name": "a dam break, validated",
        "shell": DAM + "dyntri-build dam.t4h -q -o dam.t4d --stats s.json && tet4d-info --validate --json dam.t4d",
        "json": {
            "valid": True,
            "payload": "dynamic_triangles",
            "counts.triangles": {"at_least": 100000},
            "counts.empty": {"at_least": 100000},
            "provenance.program": "dyntri-build",
        },
        "json_file": {"s.json": {"program": "dyntri-build", "counts.pages": 3, "counts.frames": 4, "phases.0.name": "build"}},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "the same bytes for any thread count, memory budget, and codec and name of the input",
        "shell": DAM + "tet4d-mc $frames --iso 0.5 -q --page-codec zstd -o packed.t4h 2> refused || "
        # A build without zstd says so; there the input's codec cannot differ.
        "{ grep -q 'rebuild with TET4D_WITH_ZSTD' refused; cp dam.t4h packed.t4h; }; "
        "dyntri-build dam.t4h -j 1 -q -o one.t4d; dyntri-build dam.t4h -j 3 -q -o three.t4d; cmp one.t4d three.t4d; "
        "dyntri-build dam.t4h -j 3 --memory 64M -q -o small.t4d; cmp one.t4d small.t4d; "
        "dyntri-build packed.t4h -q -o packed.t4d; cmp one.t4d packed.t4d",
        "needs": ["tet4d-mc"],
    },
    {
        "name": "too little memory says how much is needed",
        "shell": DAM + "dyntri-build dam.t4h -j 1 --memory 1M -o x.t4d",
        "exit": 4,
        "stderr": ["largest pages", "--memory"],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a dry run plans and writes nothing",
        "shell": DAM + "dyntri-build dam.t4h -n -o x.t4d",
        "stdout": ["passes 1\n", "peak_memory_bytes ", "temporary_bytes 0\n", "output_bytes_at_most "],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "dynamic triangles are no hypermesh",
        "shell": DAM + "dyntri-build dam.t4h -q -o dam.t4d; dyntri-build dam.t4d -o x.t4d",
        "exit": 3,
        "stderr": ["dam.t4d", "DYNT", "HYPM"],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a hypermesh cut short",
        "shell": DAM + "head -c 100000 dam.t4h > cut.t4h; dyntri-build cut.t4h -o x.t4d",
        "exit": 3,
        "stderr": ["cut.t4h", "header"],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a damaged page is named",
        "shell": DAM + "printf '\\377' | dd of=dam.t4h bs=1 seek=5000 conv=notrunc status=none; dyntri-build dam.t4h -o x.t4d",
        "exit": 3,
        "stderr": ["dam.t4h", "page 0", "checksum"],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a full disk leaves nothing behind",
        "shell": DAM + "ulimit -f 256; dyntri-build dam.t4h -o x.t4d",
        "exit": 4,
        "stderr": ["x.t4d"],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "no surface, no triangles, a valid file",
        "shell": "tet4d-mc {data}/dambreak --iso 7 -q -o e.t4h 2> /dev/null; dyntri-build e.t4h -q -o e.t4d; "
        "tet4d-info --validate --json e.t4d",
        "json": {"valid": True, "counts.triangles": 0, "counts.frames": 33},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "an output that is the input is refused, whatever its name",
        "shell": DAM + "cp dam.t4h kept; ln -s dam.t4h link.t4d; code=0; dyntri-build dam.t4h -o ./link.t4d -f || code=$?; "
        "cmp dam.t4h kept; exit $code",
        "exit": 2,
        "stderr": ["--output: './link.t4d' is the same file as the input FILE 'dam.t4h'"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a wrong suffix is refused",
        "run": ["dyntri-build", "dam.t4h", "-o", "x.ply"],
        "exit": 2,
        "stderr": ["'x.ply' does not end in .t4d"],
        "absent": ["x.ply"],
    },
    {
        "name": "columns are carried, chosen, left out; a name that is not there is refused",
        "shell": "frames=\"$(ls {data}/dambreak/alpha_00{08,09,10}.nrrd)\"; tet4d-mc $frames --iso 0.5 --normals gradient -q -o n.t4h; "
        "dyntri-build n.t4h -q -o all.t4d; dyntri-build n.t4h --columns none -q -o none.t4d; "
        "dyntri-build n.t4h --columns normal -q -o named.t4d; test $(stat -c %s all.t4d) -eq $(stat -c %s named.t4d); "
        "test $(stat -c %s all.t4d) -gt $(stat -c %s none.t4d); tet4d-info --validate none.t4d > /dev/null; "
        "tet4d-info --validate --json all.t4d; code=0; dyntri-build n.t4h --columns norml -q -o x.t4d || code=$?; test $code = 2",
        "json": {"valid": True, "version": 2, "columns.0.name": "normal", "columns.0.components": 3},
        "stderr": ["there is no column \"norml\"", "it has normal"],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "pictures by a column, its component, a range and the file's normals, the same from compressed pages",
        "shell": "frames=\"$(ls {data}/dambreak/alpha_00{08,09,10}.nrrd)\"; "
        "tet4d-mc $frames --iso 0.5 --normals gradient --velocity -q -o n.t4h; dyntri-build n.t4h -q -o n.t4d; "
        "dyntri-build n.t4h --page-codec zstd -q -o z.t4d 2> refused || "
        "{ grep -q 'rebuild with TET4D_WITH_ZSTD' refused; cp n.t4d z.t4d; }; "
        "draw='--offscreen --renderer cpu --size 96x64 --samples 1 --at 1.5f -q'; "
        "tet4d-play n.t4d $draw -o plain.png; tet4d-play n.t4d $draw --color velocity -o speed.png; "
        "tet4d-play z.t4d $draw --color velocity:magnitude -o packed.png; cmp speed.png packed.png; "
        "tet4d-play n.t4d $draw --color velocity:2 --range -1:1 --map cool-warm -o z.png; "
        "tet4d-play n.t4d $draw --shading file -o file.png; "
        "for a in plain speed z file; do for b in plain speed z file; do test $a = $b || ! cmp -s $a.png $b.png; done; done; "
        "code=0; tet4d-play n.t4d $draw --color velocty -o x.png || code=$?; test $code = 2; "
        "code=0; tet4d-play n.t4d $draw --color velocity:3 -o x.png || code=$?; test $code = 2",
        "stderr": ["has no column \"velocty\"", "did you mean velocity?", "expected 0 to 2 or magnitude"],
        "absent": ["x.png"],
        "needs": ["tet4d-mc", "tet4d-play"],
    },
    {
        "name": "bands from 1 to 16",
        "shell": DAM + "dyntri-build dam.t4h --bands 16 -q -o many.t4d; dyntri-build dam.t4h --bands 1 -q -o one.t4d; "
        "tet4d-info --validate one.t4d > /dev/null; tet4d-info --validate --json many.t4d; "
        "code=0; dyntri-build dam.t4h --bands 17 -q -o x.t4d || code=$?; test $code = 2",
        "json": {"valid": True},
        "stderr": ["--bands", "17 is not 1 to 16"],
        "absent": ["x.t4d"],
        "needs": ["tet4d-mc", "tet4d-info"],
    },
]
