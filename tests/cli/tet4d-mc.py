"""Cases of tet4d-mc."""


def frame(top, time=None, sizes="3 2 2", samples=None):
    """A 3D NRRD of bytes whose values are the characters' codes: 0 and 1 stand for 48 and 49."""
    clock = "" if time is None else f"time:={time}\n"
    return f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sizes}\nencoding: raw\n{clock}\n" + (samples or f"01{top}" * 4)


TWO = {"a_0001.nrrd": frame("1", 0.5), "a_0002.nrrd": frame("0", 0.75)}
THREE = {**TWO, "a_0003.nrrd": frame("1", 1.0)}
GAP = {"a_0001.nrrd": frame("1"), "a_0002.nrrd": frame("0"), "a_0004.nrrd": frame("1")}

# 3 x 2 x 2 x 2 floats 0 1 1 0 1 1 …, the second replaced by NaN.
NAN_FILE = (
    "printf 'NRRD0004\\ntype: float\\ndimension: 4\\nsizes: 3 2 2 2\\nendian: little\\nencoding: raw\\n\\n' > n.nrrd; "
    "zero='\\0\\0\\0\\0' one='\\0\\0\\200\\077' nan='\\0\\0\\300\\177'; "
    "printf \"$zero$nan$one\" >> n.nrrd; for i in 1 2 3 4 5 6 7; do printf \"$zero$one$one\" >> n.nrrd; done; "
)

# A tetrahedron's surface, counter-clockwise from outside, that rises; the second file has vertices only.
FACES = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def tip(z, faces=FACES):
    return f"v 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nv 0.25 0.25 {z + 1}\n" + faces


MESHES = {"m_1.obj": tip(1), "m_2.obj": tip(2, ""), "m_3.obj": tip(3), "m_4.obj": tip(7)}

# The same as text STL, which needs no OpenMesh.

def stl(z):
    corner = [f"0 0 {z}", f"1 0 {z}", f"0 1 {z}", f"0.25 0.25 {z + 1}"]
    facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {corner[i]}\n" for i in face) +
                     "endloop\nendfacet\n" for face in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)))
    return "solid s\n" + facets + "endsolid s\n"


STLS = {"s_1.stl": stl(1), "s_2.stl": stl(2), "s_3.stl": stl(3), "s_4.stl": stl(7)}

CASES = [
    {
        "name": "several isovalues are parts",
        "shell": "tet4d-mc {data}/dambreak --frames 5:9 --iso 0.2,0.5,0.9 -o dam.t4h --stats s.json 2>err && "
        "grep -q 'part 2, isovalue 0.9: ' err && tet4d-info --validate --links --json dam.t4h",
        "json": {"valid": True, "parts.0.isovalue": 0.2, "parts.2.isovalue": 0.9, "isovalue": None},
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "a cap closes the surface at the walls",
        "shell": "tet4d-mc {data}/dambreak --frames 5:9 --iso 0.5 --cap -q -o dam.t4h && "
        "tet4d-info --validate --json dam.t4h",
        "json": {"valid": True, "provenance.options.cap": True, "faces.inner_boundary": 0},
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "normals, velocity and a field are columns",
        "shell": "tet4d-mc {data}/dambreak --frames 5:9 --iso 0.5 --normals gradient --velocity "
        "--field again={data}/dambreak -q -o dam.t4h && tet4d-info --validate --json dam.t4h",
        "json": {
            "valid": True,
            "columns.0.name": "normal",
            "columns.1.name": "velocity",
            "columns.1.components": 3,
            "columns.2.name": "again",
            "provenance.inputs.1.name": "again",
        },
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "what --field needs is said",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "--field", "heat", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--field", "NAME=FRAMES"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a field may not come from standard input, nor leave its folder in the file",
        "shell": "mkdir deep; cp a_*.nrrd deep; tet4d-mc a_0001.nrrd a_0002.nrrd --iso 48.5 --field heat=deep -q -o x.t4h; "
        "! grep -q deep x.t4h; cat a_*.nrrd | tet4d-mc - --iso 48.5 --field heat=- -o y.t4h",
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--field", "standard input"],
        "absent": ["y.t4h"],
    },
    {
        "name": "a field that ends before a stream is refused",
        "shell": "cat a_*.nrrd | tet4d-mc - --iso 48.5 --field heat=short.nrrd -o y.t4h",
        "prepare": {**THREE, "short.nrrd": frame("1", 0.5)},
        "exit": 3,
        "stderr": ["field heat", "ends after 1 frames"],
        "absent": ["y.t4h"],
    },
    {
        "name": "a field may not take the name of a column",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "--field", "velocity=.", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--field", "already"],
    },
    {
        "name": "an isovalue twice is refused",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5,50,48.5", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--iso", "twice"],
        "absent": ["x.t4h"],
    },
    {
        "name": "the portable loops give the same bytes",
        "shell": "tet4d-mc {data}/dambreak --frames 5:9 --iso 0.5 -q -o best.t4h && "
        "TET4D_SIMD=portable tet4d-mc {data}/dambreak --frames 5:9 --iso 0.5 -q -o portable.t4h && "
        "cmp best.t4h portable.t4h",
        "needs": ["tet4d-mc"],
        "timeout": 300,
    },
    {
        "name": "a dam break, validated",
        "shell": "tet4d-mc {data}/dambreak --iso 0.5 -o dam.t4h -q && tet4d-info --validate --json dam.t4h",
        "json": {
            "valid": True,
            "counts.frames": 33,
            "counts.tets": {"at_least": 1000000},
            "provenance.options.iso": [0.5],
            "provenance.options.split": "hull",
        },
        "needs": ["tet4d-mc", "tet4d-info"],
        "timeout": 300,
    },
    {
        "name": "statistics count what they name",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "a_0003.nrrd", "--iso", "48.5", "-o", "x.t4h", "--stats", "s.json"],
        "prepare": THREE,
        "json_file": {
            "s.json": {
                "program": "tet4d-mc",
                "counts.frames": 3,
                "counts.voxels": 36,
                # The step from 48 to 49 crosses the left cell of both slabs, the flickering end the right one.
                "counts.active_cells": 4,
                "counts.vertices": {"at_least": 1},
                "counts.tets": {"at_least": 1},
                "counts.masked_cells": 0,
                "phases.0.name": "read",
                "phases.1.name": "extract",
                "phases.2.name": "write",
            }
        },
        "stderr": ["3 frames -> "],
    },
    {
        "name": "the same bytes for any thread count and way to name the frames",
        "shell": "tet4d-mc a_0001.nrrd a_0002.nrrd a_0003.nrrd --iso 48.5 -j 1 -q -o one.t4h && "
        "tet4d-mc . --iso 48.5 -j 3 -q -o three.t4h && cmp one.t4h three.t4h && "
        "tet4d-mc a_%04d.nrrd --iso 48.5 -q -o pattern.t4h && cmp one.t4h pattern.t4h",
        "prepare": THREE,
        "needs": ["tet4d-mc"],
    },
    {
        "name": "kuhn is the same surface in more pieces",
        "shell": "frames='{data}/dambreak/alpha_0008.nrrd {data}/dambreak/alpha_0009.nrrd'; "
        "tet4d-mc $frames --iso 0.5 --split kuhn -q -o kuhn.t4h; tet4d-mc $frames --iso 0.5 -q -o hull.t4h; "
        "test $(stat -c %s kuhn.t4h) -ge $((4 * $(stat -c %s hull.t4h))); tet4d-info --validate --json kuhn.t4h",
        "json": {"valid": True, "provenance.options.split": "kuhn"},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "one frame is not enough",
        "run": ["tet4d-mc", "a_0001.nrrd", "--iso", "48.5", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 3,
        "stderr": ["a_0001.nrrd", "two"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a flat grid is refused",
        "run": ["tet4d-mc", "f1.nrrd", "f2.nrrd", "--iso", "48.5", "-o", "x.t4h"],
        "prepare": {"f1.nrrd": frame("1", sizes="3 4 1"), "f2.nrrd": frame("0", sizes="3 4 1")},
        "exit": 3,
        "stderr": ["axis z", "1 sample"],
        "absent": ["x.t4h"],
    },
    {
        "name": "an isovalue outside the range gives a valid empty file and says so",
        "shell": "tet4d-mc a_%04d.nrrd --iso 200 -o x.t4h && tet4d-info --validate --json x.t4h",
        "prepare": TWO,
        "stderr": ["the hypermesh is empty: isovalue 200, samples from 48 to 49"],
        "json": {"valid": True, "counts.tets": 0, "counts.vertices": 0},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "the isovalue must be given",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--iso"],
        "absent": ["x.t4h"],
    },
    {
        "name": "an isovalue that is no number",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "nan", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--iso"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a misspelt split names the nearest",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "1", "--split", "hul", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["hul", "hull"],
    },
    {
        "name": "a dry run plans and writes nothing",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "-o", "x.t4h", "--dry-run"],
        "prepare": TWO,
        "stdout": ["passes 1\n", "peak_memory_bytes ", "temporary_bytes 0\n", "output_bytes_at_least ", "output_bytes_at_most "],
        "absent": ["x.t4h"],
    },
    {
        "name": "an existing file is kept",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "-o", "x.t4h"],
        "prepare": {**TWO, "x.t4h": "mine"},
        "exit": 1,
        "stderr": ["x.t4h", "--force"],
        "file": {"x.t4h": "mine"},
    },
    {
        "name": "a hypermesh cannot go to a pipe",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "-o", "-"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["pipe"],
        "absent": ["-"],
    },
    {
        "name": "too little memory says how much is needed",
        "run": ["tet4d-mc", "{data}/dambreak", "--iso", "0.5", "-o", "x.t4h", "--memory", "1M"],
        "exit": 4,
        "stderr": ["--memory"],
        "absent": ["x.t4h"],
    },
    {
        "name": "runs inside the memory it was given",
        "run": ["tet4d-mc", "{data}/dambreak", "--iso", "0.5", "-o", "x.t4h", "--memory", "6M", "-j", "1", "-q"],
        # 2 MiB for the program's own data and the allocator.
        "limits": {"data": 8 << 20},
    },
    {
        "name": "a full disk leaves nothing behind",
        "run": ["tet4d-mc", "{data}/dambreak", "--iso", "0.5", "-o", "x.t4h"],
        "limits": {"fsize": 1 << 20},
        "exit": 4,
        "stderr": ["x.t4h"],
        "absent": ["x.t4h"],
    },
    {
        "name": "an interrupt leaves nothing behind",
        "run": ["tet4d-mc", "{data}/dambreak", "--iso", "0.5", "--split", "kuhn", "-j", "1", "-o", "x.t4h", "--progress", "json"],
        "interrupt": {"when": "extract", "signal": "INT"},
        "exit": 1,
        "stderr": ["nterrupt"],
        "absent": ["x.t4h"],
    },
    {
        "name": "nan outside",
        "shell": NAN_FILE + "tet4d-mc n.nrrd --iso 0.5 -o x.t4h --stats s.json && tet4d-info --validate --json x.t4h",
        "stderr": ["1 samples are NaN: taken as outside"],
        "json": {"valid": True, "inner_boundary": False},
        "json_file": {"s.json": {"counts.nan_samples": 1, "counts.masked_cells": 0}},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "nan mask",
        "shell": NAN_FILE + "tet4d-mc n.nrrd --iso 0.5 --nan mask -o x.t4h --stats s.json && tet4d-info --validate --json x.t4h",
        "stderr": ["2 hypercubes that touch one left out"],
        "json": {"valid": True, "inner_boundary": True, "counts.tets": 0},
        "json_file": {"s.json": {"counts.nan_samples": 1, "counts.masked_cells": 2}},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "nan error",
        "shell": NAN_FILE + "tet4d-mc n.nrrd --iso 0.5 --nan error -o x.t4h",
        "exit": 3,
        "stderr": ["n.nrrd", "frame 0, sample 1 0 0", "is NaN", "--nan mask"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "times from a list and from a file are the same",
        "shell": "tet4d-mc a_%04d.nrrd --iso 48.5 --times 10,12.5 -q -o list.t4h && "
        "tet4d-mc a_%04d.nrrd --iso 48.5 --times times.txt -q -o file.t4h && cmp list.t4h file.t4h && "
        "tet4d-info --json file.t4h",
        "prepare": {**TWO, "times.txt": "10\n12.5\n"},
        "json": {"times.first": 10, "times.last": 12.5},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "too few times",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "--times", "3", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["1", "2"],
        "absent": ["x.t4h"],
    },
    {
        "name": "times that are no numbers",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "--times", "1,soon", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--times", "soon"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a hole in the numbering is refused",
        "run": ["tet4d-mc", "a_%04d.nrrd", "--iso", "48.5", "-o", "x.t4h"],
        "prepare": GAP,
        "exit": 3,
        "stderr": ["number 3 is missing", "--allow-gaps"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a hole in the numbering is accepted on request",
        "run": ["tet4d-mc", "a_%04d.nrrd", "--iso", "48.5", "-o", "x.t4h", "--allow-gaps", "--depfile", "x.d"],
        "prepare": GAP,
        "file": {"x.d": ["x.t4h:", "a_0001.nrrd", "a_0002.nrrd", "a_0004.nrrd"]},
    },
    {
        "name": "an output that is an input is refused and the input kept",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "-o", "./a_0001.nrrd", "-f"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--output: './a_0001.nrrd' is the same file as the input FRAMES 'a_0001.nrrd'"],
        "file": TWO,
    },
    {
        "name": "so are statistics",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "-o", "x.t4h", "--stats", "a_0002.nrrd"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--stats: ", "FRAMES 'a_0002.nrrd'"],
        "file": TWO,
        "absent": ["x.t4h"],
    },
    {
        "name": "and dependencies that are the file of times",
        "run": ["tet4d-mc", "a_%04d.nrrd", "--iso", "48.5", "-o", "x.t4h", "--times", "t.txt", "--depfile", "t.txt"],
        "prepare": {**TWO, "t.txt": "1 2"},
        "exit": 2,
        "stderr": ["--depfile: ", "--times 't.txt'"],
        "file": {"t.txt": "1 2"},
    },
    {
        "name": "statistics are not written over a frame of a pattern",
        "run": ["tet4d-mc", "a_%04d.nrrd", "--iso", "48.5", "-o", "x.t4h", "--stats", "a_0002.nrrd"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--stats: 'a_0002.nrrd' may be one of the inputs FRAMES 'a_%04d.nrrd'"],
        "file": TWO,
    },
    {
        "name": "nor over a frame in a directory",
        "run": ["tet4d-mc", ".", "--iso", "48.5", "-o", "x.t4h", "--stats", "a_0002.nrrd"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--stats: 'a_0002.nrrd' exists in the directory of inputs FRAMES '.'"],
        "file": TWO,
    },
    {
        "name": "nothing is replaced in a directory of inputs",
        "run": ["tet4d-mc", "in", "--iso", "48.5", "-o", "in/x.t4h", "-f"],
        "prepare": {"in/x.t4h": "mine"},
        "exit": 2,
        "stderr": ["'in/x.t4h' exists in the directory of inputs FRAMES 'in'"],
        "file": {"in/x.t4h": "mine"},
    },
    {
        "name": "a device is not replaced by a file",
        "shell": "mkfifo x.t4h; code=0; tet4d-mc a_%04d.nrrd --iso 48.5 -o x.t4h -f || code=$?; test -p x.t4h; exit $code",
        "prepare": TWO,
        "exit": 2,
        "stderr": ["x.t4h: is a directory, device or pipe"],
    },
    {
        "name": "a wrong suffix is refused",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "-o", "out.vtu"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--output: 'out.vtu' does not end in .t4h, which is what tet4d-mc writes", "tet4d-convert"],
        "absent": ["out.vtu"],
    },
    {
        "name": "meshes: what moves straight is not expanded, and the result is a closed manifold",
        "shell": "tet4d-mc s_%d.stl -o x.t4h --stats s.json && tet4d-info --validate --links --json x.t4h",
        "prepare": STLS,
        "stderr": ["4 frames of 4 triangles -> 24 tetrahedra, 12 vertices; 36 if every frame were kept"],
        "json": {"valid": True, "counts.tets": 24, "faces.inner_boundary": 0, "links.faulty_vertices": 0},
        "json_file": {"s.json": {"counts.triangles": 4, "counts.tets": 24, "counts.tets_expanded": 36,
                                 "error.linear_measured": {"about": 0, "within": 1e-6}}},
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "meshes: every frame kept, and the same hypermesh from files, a .t4q and any threads",
        "shell": "tet4d-mc s_*.stl --linear-window 1 -q -j 1 -o a.t4h && tet4d-convert . -q -o s.t4q && "
        "tet4d-mc s.t4q --linear-window 1 -q -j 3 -o b.t4h && cmp a.t4h b.t4h && tet4d-info --validate --json s.t4q",
        "prepare": STLS,
        "json": {"valid": True, "payload": "surface_sequence", "counts.frames": 4, "counts.triangles": 4},
        "needs": ["tet4d-mc", "tet4d-convert", "tet4d-info"],
    },
    {
        "name": "meshes: an isovalue is for volumes",
        "run": ["tet4d-mc", "s_1.stl", "s_2.stl", "--iso", "0.5", "-o", "x.t4h"],
        "prepare": STLS,
        "exit": 2,
        "stderr": ["--iso", "volumes"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a tolerance is for meshes",
        "run": ["tet4d-mc", "a_0001.nrrd", "a_0002.nrrd", "--iso", "48.5", "--linear-tolerance", "1%", "-o", "x.t4h"],
        "prepare": TWO,
        "exit": 2,
        "stderr": ["--linear-tolerance", "mesh"],
        "absent": ["x.t4h"],
    },
    {
        "name": "meshes: with a tolerance what it saved is told, even if that is nothing",
        "run": ["tet4d-mc", "s_3.stl", "s_4.stl", "--linear-tolerance", "0.25", "-o", "x.t4h"],
        "prepare": STLS,
        "stderr": ["12 tetrahedra", "; 12 if every frame were kept; tolerance 0.25, error at frames 0 (measured)"],
    },
    {
        "name": "a directory of volumes and meshes names one of each",
        "run": ["tet4d-mc", "in", "--iso", "48.5", "-o", "x.t4h"],
        "prepare": {"in/" + name: text for name, text in {**TWO, **STLS}.items()},
        "exit": 3,
        "stderr": ["a directory of two kinds", "s_1.stl is a mesh", "a_0001.nrrd a volume"],
        "not_stderr": ["--iso"],
        "absent": ["x.t4h"],
    },
    {
        "name": "so does a list, in any order",
        "run": ["tet4d-mc", "a_0001.nrrd", "s_1.stl", "-o", "x.t4h"],
        "prepare": {**TWO, **STLS},
        "exit": 3,
        "stderr": ["a list of two kinds", "s_1.stl is a mesh", "a_0001.nrrd is none"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a tolerance that is no length",
        "run": ["tet4d-mc", "s_1.stl", "s_2.stl", "--linear-tolerance", "much", "-o", "x.t4h"],
        "prepare": STLS,
        "exit": 2,
        "stderr": ["--linear-tolerance", "much"],
        "absent": ["x.t4h"],
    },
    {
        "name": "one mesh is not enough",
        "run": ["tet4d-mc", "s_1.stl", "-o", "x.t4h"],
        "prepare": STLS,
        "exit": 3,
        "stderr": ["s_1.stl", "two"],
        "absent": ["x.t4h"],
    },
    {
        "name": "meshes: a dry run plans and writes nothing",
        "run": ["tet4d-mc", "s_%d.stl", "-n", "-o", "x.t4h"],
        "prepare": STLS,
        "stdout": ["passes 1", "fixed_memory_bytes", "output_bytes_at_most"],
        "absent": ["x.t4h"],
    },
    {
        "name": "OBJ with vertices only in a later frame, or the build says what it lacks",
        "shell": "tet4d-mc m_%d.obj -q -o x.t4h 2> said || grep -q TET4D_WITH_OPENMESH said",
        "prepare": MESHES,
        "needs": ["tet4d-mc"],
    },
]
