"""tet4d-play with its window, under Xvfb. The fields of a case: tests/cli/README.md."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from png_pixels import pixels  # noqa: E402

# Programs' names are functions of the shell in a case, and xvfb-run and env start files: PLAY is the file's name.
PLAY = """$(declare -f tet4d-play | grep -o "/[^']*tet4d-play")"""
XVFB = "xvfb-run -a -s '-screen 0 1400x900x24' "
# A display of 192 dots an inch; what follows stands within double quotes.
DENSE = f"xvfb-run -a -s '-screen 0 1600x1000x24 -noreset' sh -c \"/usr/bin/python3 {HERE}/set_dpi.py 192 && exec "

# A window, and another program's hands on it (hands.py), which close it in the end; the window's exit code counts.
HANDS = XVFB + f"sh -c \"{PLAY} %s & /usr/bin/python3 {HERE}/hands.py %s || kill \\$!; wait \\$!\"; "


def alike(result, one, two, most_rms):
    a, b = pixels(result.directory / one), pixels(result.directory / two)
    assert a[1:] == b[1:], f"{one} is {a[1:]}, {two} is {b[1:]}"
    rms = (sum((x - y) ** 2 for x, y in zip(a[0], b[0])) / len(a[0])) ** 0.5
    assert rms <= most_rms, f"RMS {rms:.2f} of 255 between {one} and {two}, expected at most {most_rms}"
    assert len(set(a[0])) > 20, f"{one} is empty"


def check_window(result):
    alike(result, "window.png", "offscreen.png", 4)  # the milliseconds shown differ


def check_bare(result):
    alike(result, "window.png", "offscreen.png", 0.5)


SPHERE = "{files}/sphere.t4d"
COLUMNS = "{files}/columns.t4d"
SIZE = " --size 700x400 --at 1.5f "

CASES = [
    {"name": "the window shows what --panels draws off-screen", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE}{SIZE}--quit-after 6 --screenshot window.png;"
                     f" tet4d-play {SPHERE}{SIZE}--offscreen --renderer gl --panels -o offscreen.png", "check": check_window},
    {"name": "without panels it shows the picture of its camera file", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE}{SIZE}--type '\t3w\x1b' --quit-after 8 --screenshot window.png;"
                     f" tet4d-play {SPHERE}{SIZE}--offscreen --renderer gl --camera camera-0001.json -o offscreen.png", "check": check_bare},
    {"name": "it plays", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE} --size 500x300 --type '] ' --quit-after 25"},
    {"name": "in plain C++ too", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE} --size 500x300 --renderer cpu --type ' ' --quit-after 8"},
    {"name": "a key quits", "timeout": 240, "shell": XVFB + f"{PLAY} {SPHERE} --size 500x300 --type q"},
    {"name": "the first interrupt closes it", "timeout": 240, "exit": 1, "stderr": ["interrupted"],
     "shell": XVFB + f"sh -c \"{PLAY} {SPHERE} --size 500x300 & /usr/bin/python3 {HERE}/hands.py move=5,5; kill \\$!; wait \\$!\""},
    {"name": "what a window does not know is refused", "run": ["tet4d-play", SPHERE, "--orbit", "90"], "exit": 2,
     "stderr": ["--orbit", "--offscreen"]},
    {"name": "a column that is not there is refused before it opens", "run": ["tet4d-play", SPHERE, "--color", "speed"], "exit": 2,
     "stderr": ["has no column"]},
    {"name": "it opens with the colours asked for, and their legend", "timeout": 240,
     "shell": XVFB + f"{PLAY} {COLUMNS}{SIZE}--color velocity:0 --map magma --quit-after 30 --screenshot window.png;"
                     f" tet4d-play {COLUMNS}{SIZE}--color velocity:0 --map magma --offscreen --renderer gl --panels -o offscreen.png", "check": check_window},
    {"name": "on a dense display panels are as large as --ui-scale 2 makes them", "timeout": 240,
     "shell": DENSE + f"{PLAY} {SPHERE}{SIZE}--quit-after 8 --screenshot window.png\";"
              f" tet4d-play {SPHERE} --size 1400x800 --at 1.5f --ui-scale 2 --offscreen --renderer gl --panels -o offscreen.png", "check": check_window},
    {"name": "unless a scale is given", "timeout": 240,
     "shell": DENSE + f"{PLAY} {SPHERE}{SIZE}--ui-scale 1 --quit-after 8 --screenshot window.png\";"
              f" tet4d-play {SPHERE}{SIZE}--ui-scale 1 --offscreen --renderer gl --panels -o offscreen.png", "check": check_window},
    {"name": "a scale out of reason", "run": ["tet4d-play", SPHERE, "--ui-scale", "20"], "exit": 2, "stderr": ["--ui-scale", "0.5 and 8"]},
    {"name": "an empty window says what to do", "timeout": 240,
     "shell": XVFB + f"{PLAY} --size 700x400 --quit-after 5 --screenshot window.png;"
                     " tet4d-play --size 700x400 --offscreen --renderer gl --panels -o offscreen.png", "check": check_window},
    {"name": "files that another program drops are opened, and its keys obeyed", "timeout": 240,
     "shell": "cp {files}/parts.t4d 'drei Bälle.t4d'; "
              + HANDS % ("--size 700x400", "'drop=drei Bälle.t4d|{files}/columns.t4d' 'title=tet4d - {files}/columns.t4d and 1 more' key=Right key=Tab key=w key=s key=q")
              + "tet4d-play 'drei Bälle.t4d' {files}/columns.t4d --size 700x400 --at 1 --offscreen --renderer gl --camera camera-0001.json -o offscreen.png;"
              " mv picture-0001.png window.png", "check": check_bare},
    {"name": "with the mouse alone: scrub to the end, colour by the first column, turn, zoom, save", "timeout": 240,
     "shell": HANDS % (f"{COLUMNS} --size 1000x640", "click=975,540 click=60,329 move=700,150 press=1 move=760,190 release=1 wheel=2 click=60,145 key=w key=q")
              + f"tet4d-play {COLUMNS} --size 1000x640 --at 3 --color 'speed [m/s]' --legend --offscreen --renderer gl --camera camera-0001.json -o offscreen.png;"
              " mv picture-0001.png window.png", "check": check_bare},
    {"name": "one pixel", "timeout": 240, "shell": XVFB + f"{PLAY} {SPHERE} --size 1x1 --type ' ' --quit-after 4"},
    {"name": "--panels without --offscreen", "run": ["tet4d-play", SPHERE, "--panels", "-o", "a.png"], "exit": 2,
     "stderr": ["--panels", "--offscreen"], "absent": ["a.png"]},
    {"name": "no display",
     "shell": f"env -u DISPLAY {PLAY} {SPHERE}", "exit": 1, "stderr": ["DISPLAY", "--offscreen"]},
    {"name": "a display that is not there",
     "shell": f"DISPLAY=:4242 tet4d-play {SPHERE}", "exit": 1, "stderr": ["DISPLAY is :4242", "--offscreen"]},
    {"name": "OpenGL below 3.3", "timeout": 240,
     "shell": XVFB + f"env MESA_GL_VERSION_OVERRIDE=2.1 {PLAY} {SPHERE}", "exit": 1,
     "stderr": ["OpenGL 3.3", "2.1", "--renderer cpu --offscreen"]},
    {"name": "a broken file at the start", "timeout": 240,
     "shell": "head -c 700 {files}/sphere.t4d > broken.t4d; " + XVFB + PLAY + " broken.t4d", "exit": 3, "stderr": ["broken.t4d"]},
    {"name": "-o without --offscreen", "run": ["tet4d-play", SPHERE, "-o", "a.png"], "exit": 2,
     "stderr": ["--output", "--offscreen"]},
]
