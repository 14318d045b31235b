"""Cases of tet4d-convert."""

import struct

DAM = "tet4d-mc {data}/dambreak/alpha_00{08,09,10}.nrrd --iso 0.5 -q -o dam.t4h; "


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


CASES = [
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
        "shell": DAM + "tet4d-convert dam.t4h --at 0.17 -o x.obj",
        "exit": 2,
        "stderr": ["x.obj", ".ply"],
        "absent": ["x.obj"],
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
]
