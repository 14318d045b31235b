"""tet4d-play --renderer: OpenGL beside plain C++. In builds with off-screen OpenGL. The fields of a case: tests/cli/README.md."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from png_pixels import pixels  # noqa: E402


def picture(result, name):
    return (result.directory / f"{name}.png").read_bytes()


def rms(result, one, two):
    a, b = (pixels(result.directory / f"{name}.png")[0] for name in (one, two))
    return (sum((x - y) ** 2 for x, y in zip(a, b)) / len(a)) ** 0.5


def check_auto(result):
    """The driver's copies of pages tell OpenGL from plain C++; the pictures agree."""
    told = {name: json.loads((result.directory / f"{name}.json").read_text())["counts"]["gpu_bytes"] for name in "acg"}
    assert told["a"] == told["c"] == 0 < told["g"], told
    for k in range(3):
        assert picture(result, f"a{k}") == picture(result, f"b{k}") == picture(result, f"c{k}"), f"picture {k} differs"
        assert rms(result, f"g{k}", f"c{k}") < 0.5, f"picture {k}: {rms(result, f'g{k}', f'c{k}'):.2f} of 255 between the renderers"


def check_kept(result):
    kept = sorted(p.name for p in result.directory.iterdir())
    assert kept == [f"f{k}.png" for k in range(4)], kept


def check_baseline(result):
    for k in range(4):
        assert rms(result, f"t{k}", f"g{k}") == 0, f"picture {k}: {rms(result, f't{k}', f'g{k}'):.3f} of 255 between tetrahedra and triangles"
    assert rms(result, "t0", "t1") > 1, "nothing moves"
    tets, gl = (json.loads((result.directory / f"{name}.json").read_text()) for name in "tg")
    assert [f["drawn"] for f in tets["frames"]] == [f["drawn"] for f in gl["frames"]], (tets["frames"], gl["frames"])
    assert tets["counts"]["tets"] == 400 and tets["counts"]["gpu_bytes"] > 0, tets["counts"]


def check_same_legend(result):
    gl, cpu = (pixels(result.directory / f"{name}.png") for name in ("gl", "cpu"))
    assert gl[1:] == cpu[1:] == (320, 240), (gl[1:], cpu[1:])
    at = [3 * (320 * y + x) + c for y in range(240) for x in range(240, 320) for c in range(3)]
    worst = max(abs(gl[0][i] - cpu[0][i]) for i in at)
    assert worst <= 2, f"the renderers' legends differ by {worst}"


DRAW = "tet4d-play {files}/sphere.t4d --offscreen --size 300x200 --samples 1 --times 0f:2f:1f"
LEGEND = "tet4d-play {files}/columns.t4d --offscreen --size 320x240 --samples 1 --at 1.5f --color velocity --legend"
SOUP = " --size 300x200 --samples 1 --times 0.2f:2.6f:0.8f "

CASES = [
    {"name": "off-screen pictures are drawn in plain C++ unless OpenGL is asked for",
     "shell": "; ".join(f"{DRAW} {words} -o {name}%d.png --stats {name}.json" for name, words in [
         ("a", ""), ("b", "--renderer auto"), ("c", "--renderer cpu"), ("g", "--renderer gl")]),
     "check": check_auto},
    *[{"name": f"what was drawn before a damaged page is kept, {renderer}", "exit": 3, "stderr": ["page 4: checksum mismatch"],
       "run": ["tet4d-play", "{files}/damaged.t4d", "--offscreen", "--size", "64x48", "--renderer", renderer, "-o", "f%d.png"],
       "check": check_kept} for renderer in ("cpu", "gl")],
    {"name": "the baseline draws of tetrahedra what OpenGL draws of their triangles",
     "shell": "tet4d-play {files}/soup.t4h --offscreen --renderer tets" + SOUP + "-o t%d.png --stats t.json; "
              "tet4d-play {files}/soup.t4d --offscreen --renderer gl --flat" + SOUP + "-o g%d.png --stats g.json", "check": check_baseline},
    {"name": "the legend is the same with both renderers",
     "shell": f"{LEGEND} --renderer gl -o gl.png; {LEGEND} --renderer cpu -o cpu.png", "check": check_same_legend},
]
