"""tet4d-play as its users meet it. The fields of a case: tests/cli/README.md."""

SMALL = ["--offscreen", "--size", "64x48", "--renderer", "cpu", "--samples", "1"]
PNG = b"\x89PNG\r\n\x1a\n"


def play(*words, file="{files}/sphere.t4d", options=SMALL):
    return ["tet4d-play", file, *options, *words]


def is_png(result, name, width, height):
    head = (result.directory / name).read_bytes()[:24]
    assert head[:8] == PNG, f"{name} is no PNG"
    size = int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big")
    assert size == (width, height), f"{name} is {size}, expected {(width, height)}"


def names(result):
    return sorted(str(p.relative_to(result.directory)) for p in result.directory.rglob("*") if p.is_file())


def check_frames(result):
    assert names(result) == [f"frames/{i:05d}.png" for i in range(5)], names(result)
    for i in range(5):
        is_png(result, f"frames/{i:05d}.png", 64, 48)


def check_same(result):
    one, two = ((result.directory / name).read_bytes() for name in ("a.png", "b.png"))
    assert one == two, "a.png and b.png differ"


def check_other(result):
    one, two = ((result.directory / name).read_bytes() for name in ("a.png", "b.png"))
    assert one != two, "a.png and b.png are the same"


def check_y4m(result):
    film = (result.directory / "film.y4m").read_bytes()
    header, rest = film.split(b"\n", 1)
    assert header == b"YUV4MPEG2 W64 H48 F12:1 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED", header
    assert len(rest) == 3 * (6 + 64 * 48 * 3 // 2), len(rest)


CASES = [
    {"name": "frames between frames", "run": play("--times", "0f:2f:0.5f", "-o", "frames/%05d.png"), "check": check_frames},
    {"name": "without times every frame of the file", "run": play("-o", "f%d.png"),
     "check": lambda r: names(r) == ["f0.png", "f1.png", "f2.png"] or (_ for _ in ()).throw(AssertionError(names(r)))},
    {"name": "world time and frame number mean the same",
     "shell": "tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 11.25 -o a.png;"
              " tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1.5f -o b.png",
     "check": check_same},
    {"name": "threads do not change the picture",
     "shell": "tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1.5f -j 1 -o a.png;"
              " tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1.5f -j 3 -o b.png",
     "check": check_same},
    {"name": "flat differs from smooth",
     "shell": "tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1.5f -o a.png;"
              " tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1.5f --flat -o b.png",
     "check": check_other},
    {"name": "the written camera gives the same picture",
     "shell": "tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1f --write-camera c.json -o a.png;"
              " tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1f --camera c.json -o b.png",
     "check": check_same, "json_file": {"c.json": {"eye.0": "*", "lights.0.direction.0": "*", "material.shininess": "*"}}},
    {"name": "a camera alone draws nothing", "run": play("--write-camera", "c.json"),
     "check": lambda r: names(r) == ["c.json"] or (_ for _ in ()).throw(AssertionError(names(r)))},
    {"name": "film to a file", "run": play("--fps", "12", "-o", "film.y4m"), "check": check_y4m},
    {"name": "film to standard output",
     "shell": "tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --samples 1 --fps 12 --format y4m -o - > film.y4m",
     "check": check_y4m},
    {"name": "contact sheet", "run": play("--contact-sheet", "sheet.png", "--columns", "2"),
     "check": lambda r: is_png(r, "sheet.png", 2 * 64 + 3 * 6, 2 * 48 + 3 * 6)},
    {"name": "statistics of every frame", "run": play("--times", "0f:2f:1f", "-o", "f%d.png", "--stats", "s.json"),
     "json_file": {"s.json": {"program": "tet4d-play", "counts.frames": 3, "frames.0.time": 10, "frames.1.time": 10.5,
                              "frames.2.time": 12, "frames.0.drawn": {"at_least": 320},
                              "frames.2.drawn": {"at_least": 320}, "frames.0.processed": {"at_least": 320},
                              "frames.0.bytes_touched": {"at_least": 1000}, "frames.2.bytes_touched": 0,
                              "frames.1.ms": {"at_least": 0}}}},
    {"name": "a file without triangles plays its background", "run": play("--at", "0.5", "-o", "f.png", file="{files}/empty.t4d"),
     "stderr": ["empty.t4d", "no triangles"], "check": lambda r: is_png(r, "f.png", 64, 48)},
    {"name": "a hypermesh is refused with the way on", "run": play("-o", "f.png", file="{files}/mesh.t4h"), "exit": 3,
     "stderr": ["mesh.t4h: is a hypermesh", "dyntri-build", "mesh.t4d"]},
    {"name": "a missing file", "run": play("-o", "f.png", file="gone.t4d"), "exit": 1, "stderr": ["gone.t4d"]},
    {"name": "another file", "run": play("-o", "f.png", file="note.txt"), "prepare": {"note.txt": "hello\n" * 30}, "exit": 3,
     "stderr": ["note.txt"]},
    {"name": "an existing frame is kept", "run": play("-o", "f%d.png"), "prepare": {"f1.png": "precious"}, "exit": 2,
     "stderr": ["f1.png: exists already", "--force"], "file": {"f1.png": "precious"}, "absent": ["f0.png"]},
    {"name": "unless forced", "run": play("-o", "f%d.png", "--force"), "prepare": {"f1.png": "old"},
     "check": lambda r: is_png(r, "f1.png", 64, 48)},
    {"name": "an existing contact sheet is kept", "run": play("--contact-sheet", "s.png"), "prepare": {"s.png": "precious"},
     "exit": 2, "stderr": ["s.png: exists already"], "file": {"s.png": "precious"}},
    {"name": "no window yet", "run": ["tet4d-play", "{files}/sphere.t4d", "-o", "f.png"], "exit": 1,
     "stderr": ["window", "--offscreen"]},
    {"name": "no output", "run": play(), "exit": 2, "stderr": ["no output", "--contact-sheet"]},
    {"name": "a time outside the file", "run": play("--at", "9", "-o", "f.png"), "exit": 2, "stderr": ["9"], "absent": ["f.png"]},
    {"name": "both kinds of time", "run": play("--at", "11", "--times", "10:11:1", "-o", "f.png"), "exit": 2,
     "stderr": ["--at and --times"]},
    {"name": "several frames need a number", "run": play("-o", "f.png"), "exit": 2, "stderr": ["%05d"]},
    {"name": "png cannot be streamed", "run": play("--format", "png", "-o", "-"), "exit": 2, "stderr": ["--format y4m"]},
    {"name": "samples", "run": play("--samples", "5", "-o", "f%d.png", options=["--offscreen"]), "exit": 2, "stderr": ["samples", "1, 4, 9 or 16"]},
    {"name": "a picture too large", "run": play("--size", "20000x10", "-o", "f%d.png", options=["--offscreen"]), "exit": 2, "stderr": ["size", "20000x10"]},
    {"name": "a broken camera names the key", "run": play("--camera", "c.json", "-o", "f%d.png"),
     "prepare": {"c.json": "{\"fov_y_degree\": 30}"}, "exit": 3, "stderr": ["c.json: fov_y_degree", "fov_y_degrees"],
     "absent": ["f0.png"]},
    {"name": "disk full", "run": play("-o", "film.y4m"), "limits": {"fsize": 5000}, "exit": 1, "stderr": ["film.y4m"],
     "absent": ["film.y4m"]},
]
