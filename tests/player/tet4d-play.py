"""tet4d-play as its users meet it. The fields of a case: tests/cli/README.md."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from png_pixels import pixels  # noqa: E402

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


def check_twin(result):
    check_same(result)
    frame = json.loads((result.directory / "s.json").read_text())["frames"][0]
    assert frame["drawn"] % 2 == 0 and frame["drawn"] > 0, frame


def check_y4m(result):
    film = (result.directory / "film.y4m").read_bytes()
    header, rest = film.split(b"\n", 1)
    assert header == b"YUV4MPEG2 W64 H48 F12:1 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED", header
    assert len(rest) == 3 * (6 + 64 * 48 * 3 // 2), len(rest)


def check_films(result):
    films = sorted(result.directory.glob("*.y4m"))
    assert len(films) > 1 and len({film.read_bytes() for film in films}) == 1, [film.name for film in films]
    for stats in result.directory.glob("*.json"):
        told = json.loads(stats.read_text())
        assert sum(f["absent"] for f in told["frames"]) == 0
        touched = sum(f["bytes_touched"] for f in told["frames"])
        assert touched + told["counts"]["page_bytes_unused"] == told["counts"]["page_bytes_read"], told["counts"]


def check_skipped(result):
    frames = json.loads((result.directory / "s.json").read_text())["frames"]
    assert [f["absent"] for f in frames] == [1 if 4 <= k < 5 else 0 for k in range(11)], frames


def check_drawn(result):
    frames = json.loads((result.directory / "s.json").read_text())["frames"]
    assert frames[-1]["absent"] == 0 and frames[-1]["drawn"] > 0, frames[-1]


def check_budget(result):
    samples = [f["samples"] for f in json.loads((result.directory / "s.json").read_text())["frames"]]
    assert samples[0] == 9 and samples[-2:] == [9, 9] and all(s < 0.1 for s in samples[1:-2]), samples
    for k in range(11):
        is_png(result, f"f{k}.png", 63, 47)


def rows(path):
    """Rows of a picture as lists of triples."""
    data, width, height = pixels(path)
    return [[tuple(data[3 * (y * width + x):3 * (y * width + x) + 3]) for x in range(width)] for y in range(height)]


def check_legend(result):
    with_it, without = rows(result.directory / "a.png"), rows(result.directory / "b.png")
    changed = [(x, y) for y in range(240) for x in range(320) if with_it[y][x] != without[y][x]]
    assert changed, "no legend"
    assert min(x for x, _ in changed) > 200, "the legend is not at the right"
    colors = {with_it[y][x] for x, y in changed}
    assert any(r > 240 and g > 220 and b < 60 for r, g, b in colors), "the map's upper end is not there"
    assert any(60 < r < 76 and g < 14 and 70 < b < 100 for r, g, b in colors), "the map's lower end is not there"


def check_parts(result):
    seen = {}
    for row in rows(result.directory / "a.png"):
        for pixel in row:
            seen[pixel] = seen.get(pixel, 0) + 1
    for color in [(0x3a, 0x7f, 0xb8), (0xe9, 0xa1, 0x3b), (0x3f, 0x9a, 0x63)]:
        count = sum(n for pixel, n in seen.items() if max(abs(a - b) for a, b in zip(pixel, color)) <= 2)
        assert count > 300, f"{color} is {count} times in the picture"


BIG = ["--offscreen", "--size", "320x240", "--renderer", "cpu", "--samples", "1", "--at", "1.5f"]
LEGEND = "tet4d-play {files}/columns.t4d --offscreen --size 320x240 --samples 1 --at 1.5f --color velocity"
FILM = " --offscreen --size 64x48 --renderer cpu --samples 1 --format y4m"
JUMPS = " --times 0f:40f:0.5f,40f:0f:-1f,7f,22.5f,39f,1f,15f,0f,40f,3f,27f,11f"

CASES = [
    {"name": "no budget, thread or codec changes a film that runs forward, backward and jumps",
     "shell": f"tet4d-play {{files}}/many.t4d{FILM}{JUMPS} -o a.y4m --stats a.json;"
              f" tet4d-play {{files}}/many.t4d{FILM}{JUMPS} -o b.y4m --stats b.json --memory 2300K -j 1;"
              f" tet4d-play {{files}}/many.t4d{FILM}{JUMPS} -o c.y4m --stats c.json --memory 4M --io-threads 3 -j 4;"
              f" tet4d-play {{files}}/packed.t4d{FILM}{JUMPS} -o d.y4m --stats d.json --memory 2300K",
     "check": check_films},
    {"name": "a damaged page ends a film by name", "run": play("-o", "f%d.png", file="{files}/damaged.t4d"), "exit": 3,
     "stderr": ["damaged.t4d: page 4: checksum mismatch"], "absent": ["f4.png"]},
    {"name": "or is named once and left out",
     "run": play("-o", "f%d.png", "--on-damage", "skip", "--stats", "s.json", file="{files}/damaged.t4d"),
     "stderr": ["damaged.t4d: page 4: checksum mismatch: left out"], "check": check_skipped},
    {"name": "films whose damage lies elsewhere play", "run": play("--times", "0f:3f:1f,6f:10f:1f", "-o", "f%d.png", file="{files}/damaged.t4d"),
     "check": lambda r: is_png(r, "f8.png", 64, 48)},
    {"name": "what has come is drawn at the film's pace",
     "run": play("--arrival", "draw", "--fps", "50", "--times", "0f:10f:1f,10f:0f:-2f,4f,4f,4f,4f,4f,4f,4f,4f,4f,4f,4f,4f,4f,4f,4f,4f",
                 "-o", "f%d.png", "--stats", "s.json", file="{files}/many.t4d"),
     "check": check_drawn},
    {"name": "a budget lowers moving pictures and gives them back at rest",
     "run": play("--arrival", "draw", "--fps", "200", "--budget-ms", "0", "--times", "1f:9f:1f,9f,9f", "--stats", "s.json",
                 "-o", "f%d.png", file="{files}/many.t4d", options=["--offscreen", "--renderer", "cpu", "--size", "63x47", "--samples", "9"]),
     "check": check_budget},
    {"name": "a budget needs a film that does not wait", "run": play("--budget-ms", "10", "-o", "f%d.png"), "exit": 2,
     "stderr": ["--budget-ms", "--arrival draw"]},
    {"name": "a negative budget", "run": play("--budget-ms", "-1", "--arrival", "draw", "-o", "f%d.png"), "exit": 2, "stderr": ["--budget-ms"]},
    {"name": "io threads", "run": play("--io-threads", "0", "-o", "f%d.png"), "exit": 2, "stderr": ["--io-threads"]},
    {"name": "a backward range without a sign", "run": play("--times", "2f:0f:1f", "-o", "f%d.png"), "exit": 2, "stderr": ["STEP < 0"]},
    {"name": "the baseline draws one hypermesh and no more",
     "run": play("--contact-sheet", "s.png", "-o", "f.png", file="{files}/mesh.t4h", options=["--offscreen", "--renderer", "tets"]),
     "exit": 2, "stderr": ["--renderer tets", "FILE.t4h"], "absent": ["f.png"]},
    {"name": "a picture of one pixel", "run": play("--at", "1f", "--size", "1x1", "-o", "f.png", options=["--offscreen", "--renderer", "cpu"]),
     "check": lambda r: is_png(r, "f.png", 1, 1)},
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
    {"name": "a file drawn twice in one scene is the same picture",
     "shell": "tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 11.25 -o a.png;"
              " cp {files}/sphere.t4d twin.t4d;"
              " tet4d-play {files}/sphere.t4d twin.t4d --offscreen --size 64x48 --renderer cpu --at 11.25 -o b.png --stats s.json",
     "check": check_twin},
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
    {"name": "-o belongs to --offscreen", "run": ["tet4d-play", "{files}/sphere.t4d", "-o", "f.png"], "exit": 2,
     "stderr": ["--output", "--offscreen"], "absent": ["f.png"]},
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
    {"name": "a name that promises another content", "run": play("--at", "1f", "-o", "q.jpg"), "exit": 2,
     "stderr": ["q.jpg", ".png", ".y4m"], "absent": ["q.jpg"]},
    {"name": "png is not written under y4m's name", "run": play("--at", "1f", "--format", "png", "-o", "q.y4m"), "exit": 2,
     "stderr": ["q.y4m", ".png"], "absent": ["q.y4m"]},
    {"name": "y4m is not written under png's name", "run": play("--format", "y4m", "-o", "q%d.png"), "exit": 2,
     "stderr": ["q%d.png", ".y4m"], "absent": ["q0.png"]},
    {"name": "a contact sheet is a PNG", "run": play("--contact-sheet", "s.jpg"), "exit": 2, "stderr": ["s.jpg", ".png"],
     "absent": ["s.jpg"]},
    {"name": "a film through a pipe stays a pipe",
     "shell": "mkfifo pipe; cat pipe > film.y4m & tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu"
              " --samples 1 --fps 12 -o pipe --force; wait; test -p pipe; rm pipe",
     "check": check_y4m},
    {"name": "a picture through a pipe too, without force",
     "shell": "mkfifo pipe; cat pipe > f.png & tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu"
              " --at 1f --format png -o pipe; wait; test -p pipe; rm pipe",
     "check": lambda r: is_png(r, "f.png", 64, 48)},
    *[{"name": f"never its own {what}",
       "shell": "cp {files}/sphere.t4d d.png; cp d.png kept; ln d.png link.png; ln -s d.png soft.png;"
                " echo '{}' > c.png; code=0; tet4d-play d.png --offscreen --size 64x48 --renderer cpu --samples 1"
                f" --at 1f --camera c.png {words} --force || code=$?; cmp d.png kept; echo '{{}}' | cmp - c.png; exit $code",
       "exit": 2, "stderr": ["is the same file as", role]}
      for what, words, role in [
          ("input", "-o d.png", "the input"), ("input by another way", "-o ./d.png", "the input"),
          ("input by a hard link", "-o link.png", "the input"), ("input by a soft link", "-o soft.png", "the input"),
          ("input as a contact sheet", "--contact-sheet d.png", "the input"),
          ("input as a written camera", "-o f.png --write-camera d.png", "the input"),
          ("camera", "-o c.png", "--camera"), ("camera as statistics", "-o f.png --stats c.png", "--camera"),
          ("frame as a contact sheet", "-o f%d.png --contact-sheet ./f0.png", "--contact-sheet"),
          ("written camera as statistics", "-o f.png --stats x.png --write-camera x.png", "--write-camera")]],
    {"name": "a frame equal to the contact sheet is refused before the first", "run": play("-o", "f%d.png", "--contact-sheet", "f2.png"),
     "exit": 2, "stderr": ["f2.png", "--contact-sheet"], "absent": ["f0.png", "f2.png"]},
    {"name": "several outputs to a device", "run": play("-o", "/dev/null", "--format", "y4m", "--write-camera", "/dev/null")},
    {"name": "too little memory for a picture", "run": play("-o", "f%d.png", "--memory", "1M", options=SMALL[:1] + ["--renderer", "cpu"]),
     "exit": 4, "stderr": ["a picture with its samples", "--size", "are allowed", "--memory"], "absent": ["f0.png"]},
    {"name": "too little memory for the contact sheet",
     "run": play("--contact-sheet", "s.png", "--memory", "1M", "--times", "0f:2f:0.02f", options=SMALL[:1] + ["--renderer", "cpu", "--size", "128x96", "--samples", "1"]),
     "exit": 4, "stderr": ["the contact sheet", "are allowed"], "absent": ["s.png"]},
    {"name": "too little memory for the pages", "run": play("-o", "f%d.png", "--memory", "124K"), "exit": 4,
     "stderr": ["the pages of one picture", "are allowed"], "absent": ["f0.png"]},
    {"name": "too little memory for the triangles", "run": play("-o", "f%d.png", "--memory", "1M"), "exit": 4,
     "stderr": ["triangles of a picture need", "--memory"], "absent": ["f0.png"]},
    {"name": "enough memory gives the same picture",
     "shell": "tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1.5f --memory 4M -o a.png;"
              " tet4d-play {files}/sphere.t4d --offscreen --size 64x48 --renderer cpu --at 1.5f -o b.png",
     "check": check_same},
    {"name": "--legend draws the map's colours at the right of the picture",
     "shell": LEGEND + " --renderer cpu --legend -o a.png; " + LEGEND + " --renderer cpu -o b.png", "check": check_legend},
    {"name": "reversed, logarithmic and unlit pictures are others",
     "shell": "; ".join(f"{LEGEND.replace('1.5f', '0.7f')} --renderer cpu {words} -o {name}.png" for name, words in [
         ("a", ""), ("b", "--reverse-map"), ("c", "--scale log"), ("d", "--shading none"), ("e", "--shading file")]),
     "check": lambda r: len({(r.directory / f"{n}.png").read_bytes() for n in "abcde"}) == 5
     or (_ for _ in ()).throw(AssertionError("two pictures are the same"))},
    {"name": "each part has its colour", "run": play("--color-by", "part", "--shading", "none", "--legend", "-o", "a.png",
                                                     file="{files}/parts.t4d", options=["--offscreen", "--size", "480x320", "--renderer", "cpu",
                                                                                        "--samples", "1", "--at", "0.5f"]),
     "check": check_parts},
    {"name": "what the values are is told", "run": play("--color", "speed [m/s]", "-o", "a.png", file="{files}/columns.t4d", options=BIG),
     "stderr": ["98 % of its values", "--range LO:HI"]},
    {"name": "a column that is not there", "run": play("--color", "sped [m/s]", "-o", "a.png", file="{files}/columns.t4d", options=BIG), "exit": 2,
     "stderr": ["did you mean speed [m/s]"]},
    {"name": "a legend of nothing", "run": play("--legend", "-o", "f%d.png"), "exit": 2, "stderr": ["--legend", "--color NAME"]},
    {"name": "parts and a column", "run": play("--color-by", "part", "--color", "velocity", "-o", "a.png", file="{files}/columns.t4d", options=BIG),
     "exit": 2, "stderr": ["--color-by part", "--color"]},
    {"name": "a logarithmic range from zero", "run": play("--color", "velocity", "--scale", "log", "--range", "0:1", "-o", "a.png",
                                                          file="{files}/columns.t4d", options=BIG), "exit": 2, "stderr": ["--scale log", "above 0"]},
    {"name": "the size of panels that are not there", "run": play("--ui-scale", "2", "-o", "f%d.png"), "exit": 2, "stderr": ["--ui-scale", "--panels"]},
    {"name": "no file", "run": ["tet4d-play", "--offscreen", "-o", "f.png"], "exit": 2, "stderr": ["no file is named", "FILE.t4d"]},
    *[{"name": f"{option} {value}", "run": play(option, value, "-o", "f%d.png"), "exit": 2, "stderr": [option.strip("-")],
       "absent": ["f0.png"]} for option, value in [("--orbit", "nan"), ("--orbit", "inf"), ("--fps", "nan"), ("--fps", "0"),
                                                   ("--fps", "inf")]],
]
