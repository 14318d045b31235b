"""Cases of tet4d-convert."""

import struct

DAM = "tet4d-mc {data}/dambreak/alpha_00{08,09,10}.nrrd --iso 0.5 -q -o dam.t4h; "

MESH = (
    "printf 'MeshVersionFormatted 1 Dimension 3 Vertices 5 0 0 0 1 1 0 0 1 0 1 0 1 0 0 1 1 1 1 1.5 1 "
    "Tetrahedra 2 1 2 3 4 0 2 3 4 5 0 End' > m.mesh; "
)


def check_hyper(result):
    points = (result.directory / "dam.hyper.pts4.f32").read_bytes()
    tets = (result.directory / "dam.hyper.tet.i32").read_bytes()
    assert len(points) % 16 == 0 and len(tets) % 16 == 0 and points and tets
    indices = struct.unpack(f"<{len(tets) // 4}i", tets)
    assert min(indices) == 0 and max(indices) == len(points) // 16 - 1, "indices do not span the points"
    times = struct.unpack(f"<{len(points) // 4}f", points)[3::4]
    assert min(times) == 0 and max(times) == 2, "t is not in frames"


def ply_header(path):
    return path.read_bytes().split(b"end_header")[0].decode()


def check_slices(result):
    names = sorted(path.name for path in (result.directory / "slices").iterdir())
    assert names == [f"{k:04d}.ply" for k in range(5)], names
    for name in names:
        header = ply_header(result.directory / "slices" / name)
        assert "element face 0" not in header and "property float nx" in header, header


def ply_values(path):
    """{property: values} of the first element."""
    header, data = path.read_bytes().split(b"end_header\n", 1)
    words = [line.split() for line in header.decode().splitlines()]
    count = next(int(w[2]) for w in words if w[:2] == ["element", "vertex"])
    properties = [w for w in words if w[0] == "property" and w[1] != "list"]
    layout = "<" + "".join({"float": "f", "double": "d"}[w[1]] for w in properties)
    rows = [struct.unpack_from(layout, data, k * struct.calcsize(layout)) for k in range(count)]
    return {w[2]: [row[i] for row in rows] for i, w in enumerate(properties)}


def check_columns(result):
    every = ply_values(result.directory / "all.ply")
    assert set(every) == {"x", "y", "z", "nx", "ny", "nz", "velocity_x", "velocity_y", "velocity_z", "heat"}, set(every)
    assert all(abs(n[0] ** 2 + n[1] ** 2 + n[2] ** 2 - 1) < 1e-6 for n in zip(every["nx"], every["ny"], every["nz"]))
    assert set(every["velocity_x"]) == {2.5} and all(1 <= h <= 4 for h in every["heat"])
    heat = ply_values(result.directory / "heat.ply")
    assert set(heat) == {"x", "y", "z", "heat"} and heat["heat"] == every["heat"], set(heat)
    both = ply_values(result.directory / "both.ply")
    assert "normal_x" in both and both["nx"] != every["nx"], "normals of the slice, and the column beside them"


def check_velocity(result):
    values = ply_values(result.directory / "v.ply")
    assert "velocity_x" in values and "nx" in values
    for k in range(0, len(values["x"]), 97):  # along the normal, within what averages over facets allow
        v, n = ([values[name + c][k] for c in "xyz"] for name in ("velocity_", "n"))
        speed = sum(x * x for x in v) ** 0.5
        along = abs(sum(x * y for x, y in zip(v, n)))
        assert along <= speed * (1 + 1e-5), (v, n)
    assert any(abs(x) > 0.01 for x in values["velocity_x"]), "a dam break that stands still"


def check_parts(result):
    header = {name: ply_header(result.directory / f"{name}.ply") for name in ("both", "p0", "p1", "lone")}
    faces = {name: int(text.split("element face ")[1].split()[0]) for name, text in header.items()}
    assert faces["both"] == faces["p0"] + faces["p1"] and faces["p0"] == faces["lone"] > faces["p1"] > 0, faces


# A build without Draco says how to get it; the case then holds too.
DRACO = "{ tet4d-convert %s -o %s 2> drc.txt || { grep -q 'TET4D_WITH_DRACO=ON' drc.txt && exit 0; cat drc.txt >&2; exit 9; }; }; "

CASES = [
    {
        "name": "Draco: smaller, the same bytes each time, its loss in words and in the record",
        "shell": DAM + DRACO % ("dam.t4h --at 0.17 --normals --velocity --stats s.json", "a.drc")
        + "grep -q 'quantized: positions within .* world units, normals within .* degrees, velocity within ' drc.txt; "
        "grep -q '\"column_velocity\"' s.json; "
        "tet4d-convert dam.t4h --at 0.17 --normals --velocity -q -o b.drc; cmp a.drc b.drc; "
        "tet4d-convert dam.t4h --at 0.17 --normals --velocity --draco-bits 6 -q -o c.drc; "
        "test $(stat -c %s c.drc) -lt $(stat -c %s a.drc)",
        "needs": ["tet4d-mc"],
    },
    {
        "name": "bits that Draco does not have",
        "shell": "tet4d-convert {files}/columns.t4h --at 0.8 --draco-bits 31 -o x.drc",
        "exit": 2,
        "stderr": ["--draco-bits", "31", "1 to 30"],
        "absent": ["x.drc"],
    },
    {
        "name": "bits where there is no Draco",
        "shell": "for o in '--at 0.8 -o x.ply' '--times 0f:1f:1f -o x.pvd' '-o x.vtu'; do code=0; "
        "tet4d-convert {files}/columns.t4h --draco-bits 12 $o || code=$?; test $code = 2; done",
        "stderr": ["--draco-bits is for slices written as .drc", "--draco-bits is for slices"],
        "absent": ["x.ply", "x.pvd", "x.vtu"],
    },
    {
        "name": "a whole hypermesh leaves columns and parts behind, and says so",
        "shell": "tet4d-convert {files}/columns.t4h -o c.vtu; tet4d-convert {files}/parts.t4h -o p.vtu; "
        "tet4d-convert {files}/mesh.t4h -o m.vtu 2> plain; ! grep 'not written' plain",
        "stderr": ["columns normal, velocity, heat are not written to .vtu: they are in slices",
                   "parts are not written to .vtu"],
    },
    {
        "name": "one part of a hypermesh of two isovalues",
        "shell": "for p in 0 1; do tet4d-convert {files}/parts.t4h --at 0.8 --part $p -q -o p$p.ply; done; "
        "tet4d-convert {files}/parts.t4h --at 0.8 -q -o both.ply; tet4d-convert {files}/mesh.t4h --at 0.8 --part 0 -q -o lone.ply",
        "check": check_parts,
    },
    {
        "name": "columns that tet4d-mc made reach a slice",
        "shell": "tet4d-mc {data}/dambreak/alpha_00{08,09,10}.nrrd --iso 0.5 --normals tets --velocity -q -o n.t4h; "
        "tet4d-convert n.t4h --at 0.17 --normals-from column --velocity -q -o v.ply",
        "check": check_velocity,
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a part that is not there",
        "shell": "tet4d-convert {files}/mesh.t4h --at 0.8 --part 1 -o x.ply",
        "exit": 2,
        "stderr": ["--part", "there is no part 1"],
    },
    {
        "name": "every format of slices is written, the same bytes each time",
        "shell": DAM + "for s in ply vtp off obj stl glb; do tet4d-convert dam.t4h --at 0.17 -q -o a.$s; "
        "tet4d-convert dam.t4h --at 0.17 -q -o b.$s; cmp a.$s b.$s; test -s a.$s; done",
        "needs": ["tet4d-mc"],
    },
    {
        "name": "columns: all, one, and normals of the slice beside them",
        "shell": "tet4d-convert {files}/columns.t4h --at 0.8 --columns all -q -o all.ply; "
        "tet4d-convert {files}/columns.t4h --at 0.8 --columns heat -q -o heat.ply; "
        "tet4d-convert {files}/columns.t4h --at 0.8 --columns normal --normals -q -o both.ply; "
        "tet4d-convert {files}/columns.t4h --at 0.8 --velocity --normals-from column -q -o v.vtp; "
        "grep -q 'Normals=\"Normals\" Vectors=\"velocity\"' v.vtp",
        "check": check_columns,
    },
    {
        "name": "velocity of a mesh without such a column",
        "shell": DAM + "tet4d-convert dam.t4h --at 0.17 --velocity --normals -q -o v.ply",
        "check": check_velocity,
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a column that is not there lists those that are",
        "shell": "tet4d-convert {files}/columns.t4h --at 0.8 --columns heat,cold -o x.ply",
        "exit": 2,
        "stderr": ["columns.t4h", "--columns", '"cold"', "it has normal, velocity, heat"],
        "absent": ["x.ply"],
    },
    {
        "name": "a column named twice",
        "shell": "tet4d-convert {files}/columns.t4h --at 0.8 --columns heat,heat -o x.ply",
        "exit": 2,
        "stderr": ["--columns", '"heat" is named twice'],
    },
    {
        "name": "a velocity asked for as a column that is not there",
        "shell": "tet4d-convert {files}/mesh.t4h --at 0.8 --columns velocity -o x.ply",
        "exit": 2,
        "stderr": ["it has no columns", "--velocity computes it"],
    },
    {
        "name": "normals from a column that is not there",
        "shell": "tet4d-convert {files}/mesh.t4h --at 0.8 --normals-from column -o x.ply",
        "exit": 2,
        "stderr": ["--normals-from", 'no column "normal"'],
    },
    {
        "name": "formats refuse what they cannot hold",
        "shell": "for s in off obj stl; do code=0; tet4d-convert {files}/columns.t4h --at 0.8 --columns heat -o x.$s || code=$?; "
        "test $code = 2; test ! -e x.$s; done; tet4d-convert {files}/columns.t4h --at 0.8 --normals -o x.stl",
        "exit": 2,
        "stderr": [".off holds no columns", ".obj holds no columns", ".stl holds no columns", ".stl holds no normals at vertices"],
        "absent": ["x.stl"],
    },
    {
        "name": "float32 formats far from the origin say what is lost",
        "shell": "tet4d-convert {files}/columns.t4h --at 0.8 -q -o far.stl --stats s.json; "
        "tet4d-convert {files}/columns.t4h --at 0.8 -q -o far.glb --stats g.json; "
        "tet4d-convert {files}/columns.t4h --at 0.8 -q -o far.obj --stats o.json",
        "stderr": ["far.stl", "float32", "off by up to", "world units"],
        "not_stderr": ["far.obj"],
        "json_file": {"s.json": {"error.position_world": {"at_least": 0.01}},
                      "g.json": {"error.position_world": {"about": 0, "within": 1e-6}},
                      "o.json": {"error.position_world": 0}},
    },
    {
        "name": "what only slices have is refused without a time",
        "shell": "for o in --normals --velocity '--columns all' '--normals-from column'; do code=0; "
        "tet4d-convert {files}/columns.t4h $o -o x.vtu || code=$?; test $code = 2; done; "
        "tet4d-convert {files}/grid.t4g --velocity -o x.nrrd",
        "exit": 2,
        "stderr": ["--normals is for slices", "--velocity is for slices", "--columns is for slices",
                   "--normals-from is for slices", "--velocity is for slices of a hypermesh"],
    },
    {
        "name": "one slice as PLY, at a world time and at a frame",
        "shell": DAM + "tet4d-convert dam.t4h --at 0.17 -q -o a.ply; tet4d-convert dam.t4h --at 0.5f -q -o b.ply; cmp a.ply b.ply",
        "file": {"a.ply": ["ply", "binary_little_endian", "element vertex ", "element face "]},
        "needs": ["tet4d-mc"],
    },
    {
        "name": "numbered slices with normals",
        "shell": DAM + "tet4d-convert dam.t4h --times 0f:2f:0.5f --normals -q -o slices/%04d.ply",
        "check": check_slices,
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a series for ParaView names its files and times",
        "shell": DAM + "tet4d-convert dam.t4h --times 0f:2f:1f -q -o s.pvd --stats s.json; test -s s_0000.vtp; test -s s_0002.vtp",
        "file": {"s.pvd": ['timestep="0.16"', "s_0000.vtp", "s_0001.vtp", 'timestep="0.2"', "s_0002.vtp"]},
        "json_file": {"s.json": {"counts.triangles": {"at_least": 10000}, "counts.vertices": {"at_least": 5000}}},
        "needs": ["tet4d-mc"],
    },
    {
        "name": "the whole hypermesh as VTU",
        "shell": DAM + "tet4d-convert dam.t4h -q -o dam.vtu && head -c 1500 dam.vtu | tr -d '\\000'",
        "stdout": ["UnstructuredGrid", 'Name="t"'],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "the whole hypermesh as the raw pair",
        "shell": DAM + "tet4d-convert dam.t4h -q -o dam.hyper",
        "check": check_hyper,
        "needs": ["tet4d-mc"],
    },
    {
        "name": "frames into one file and the same hypermesh from it",
        "shell": DAM + "tet4d-convert {data}/dambreak/alpha_00{08,09,10}.nrrd -q -o f.t4g; tet4d-info --validate f.t4g > /dev/null; "
        "tet4d-mc f.t4g --iso 0.5 -q -o g.t4h; cmp dam.t4h g.t4h; "
        "tet4d-convert f.t4g -q -o f.nrrd; tet4d-mc f.nrrd --iso 0.5 -q -o n.t4h; cmp dam.t4h n.t4h",
        "needs": ["tet4d-mc", "tet4d-info"],
    },
    {
        "name": "a time outside the range gives the range",
        "shell": DAM + "tet4d-convert dam.t4h --at 3 -o x.ply",
        "exit": 2,
        "stderr": ["0.16", "0.2"],
        "absent": ["x.ply"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a format it does not write lists those it does",
        "shell": DAM + "tet4d-convert dam.t4h --at 0.17 -o x.3ds",
        "exit": 2,
        "stderr": ["x.3ds", ".ply"],
        "absent": ["x.3ds"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a full disk leaves nothing behind",
        "shell": DAM + "ulimit -f 64; tet4d-convert dam.t4h -o x.vtu",
        "exit": 4,
        "stderr": ["x.vtu"],
        "absent": ["x.vtu"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "an output that is an input is refused and the input kept",
        "shell": "cp {data}/dambreak/alpha_00{08,09}.nrrd .; code=0; "
        "tet4d-convert alpha_0008.nrrd alpha_0009.nrrd -o alpha_0008.nrrd -f || code=$?; "
        "cmp alpha_0008.nrrd {data}/dambreak/alpha_0008.nrrd; exit $code",
        "exit": 2,
        "stderr": ["--output: 'alpha_0008.nrrd' is the same file as the input FILE 'alpha_0008.nrrd'"],
    },
    {
        "name": "frames called otherwise make the same file",
        "shell": "cp {data}/dambreak/alpha_00{08,09}.nrrd .; tet4d-convert alpha_%04d.nrrd -q -o one.t4g; "
        "mv alpha_0008.nrrd b_1.nrrd; mv alpha_0009.nrrd b_2.nrrd; tet4d-convert b_1.nrrd b_2.nrrd -q -o two.t4g; "
        "cmp one.t4g two.t4g",
    },
    {
        "name": "a scalar of a mesh as time: sound, sliced at its values, drawn",
        "shell": MESH + "tet4d-convert m.mesh --scalar-as-time z --sweep-frames 3 -q -o m.t4h --stats s.json; "
        "tet4d-info --validate m.t4h > /dev/null; tet4d-convert m.t4h --at 0.75 -q -o m.ply; "
        "dyntri-build m.t4h -q -o m.t4d; tet4d-info --validate m.t4d > /dev/null",
        "file": {"m.ply": ["element vertex 5", "element face 3"]},
        "json_file": {"s.json": {"counts.tets": 2, "counts.vertices": 5, "counts.frames": 3}},
        "needs": ["tet4d-info", "dyntri-build"],
    },
    {
        "name": "a mesh called otherwise makes the same file",
        "shell": MESH + "cp m.mesh n.mesh; tet4d-convert m.mesh --scalar-as-time z -q -o m.t4h; "
        "tet4d-convert n.mesh --scalar-as-time z -q -o n.t4h; cmp m.t4h n.t4h",
    },
    {
        "name": "a scalar that is not there names the nearest",
        "shell": DAM + "tet4d-convert dam.t4h -q -o dam.vtu; tet4d-convert dam.vtu --scalar-as-time tt -o x.t4h",
        "exit": 3,
        "stderr": ["dam.vtu", 'has no array "tt"', "did you mean t?"],
        "absent": ["x.t4h"],
        "needs": ["tet4d-mc"],
    },
    {
        "name": "a mesh needs a scalar",
        "shell": MESH + "tet4d-convert m.mesh -o m.t4h",
        "exit": 2,
        "stderr": ["m.mesh", "--scalar-as-time"],
    },
    {
        "name": "a VTK image is frames too",
        "shell": "printf '<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0 1\"><Piece Extent=\"0 1 0 1 0 1\">"
        "<PointData><DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray></PointData>"
        "</Piece></ImageData></VTKFile>' > a.vti; tet4d-convert a.vti -q -o a.nrrd; tail -c 8 a.nrrd | od -An -tu1; "
        "tet4d-convert a.vti --array b -o b.nrrd",
        "exit": 3,
        "stdout": ["1   2   3   4   5   6   7   8"],
        "stderr": ["a.vti", 'no array "b"', "did you mean a? The file holds: a"],
        "absent": ["b.nrrd"],
    },
]
