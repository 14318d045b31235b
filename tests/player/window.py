"""tet4d-play with its window, under Xvfb. The fields of a case: tests/cli/README.md."""
import struct
import zlib

# Programs' names are functions of the shell in a case, and xvfb-run and env start files: PLAY is the file's name.
PLAY = """$(declare -f tet4d-play | grep -o "/[^']*tet4d-play")"""
XVFB = "xvfb-run -a -s '-screen 0 1400x900x24' "


def pixels(path):
    """The channels of an 8-bit RGB picture, row by row; its width and height."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at:at + 4]), data[at + 4:at + 8]
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            assert (depth, color) == (8, 2), (depth, color)
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    raw, stride, out = zlib.decompress(packed), 3 * width, bytearray()
    before = bytearray(stride)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            a = line[x - 3] if x >= 3 else 0
            b = before[x]
            c = before[x - 3] if x >= 3 else 0
            if kind == 1:
                line[x] = (line[x] + a) & 255
            elif kind == 2:
                line[x] = (line[x] + b) & 255
            elif kind == 3:
                line[x] = (line[x] + (a + b) // 2) & 255
            elif kind == 4:
                p = a + b - c
                nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                line[x] = (line[x] + nearest) & 255
        out += line
        before = line
    return bytes(out), width, height


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
SIZE = " --size 700x400 --at 1.5f "

CASES = [
    {"name": "the window shows what --panels draws off-screen", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE}{SIZE}--quit-after 6 --screenshot window.png;"
                     f" tet4d-play {SPHERE}{SIZE}--offscreen --panels -o offscreen.png", "check": check_window},
    {"name": "without panels it shows the picture of its camera file", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE}{SIZE}--type '\t3w\x1b' --quit-after 8 --screenshot window.png;"
                     f" tet4d-play {SPHERE}{SIZE}--offscreen --camera camera-0001.json -o offscreen.png", "check": check_bare},
    {"name": "it plays", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE} --size 500x300 --type '] ' --quit-after 25"},
    {"name": "in plain C++ too", "timeout": 240,
     "shell": XVFB + f"{PLAY} {SPHERE} --size 500x300 --renderer cpu --type ' ' --quit-after 8"},
    {"name": "a key quits", "timeout": 240, "shell": XVFB + f"{PLAY} {SPHERE} --size 500x300 --type q"},
    {"name": "the first interrupt closes it", "timeout": 240, "exit": 1, "stderr": ["interrupted"],
     "shell": XVFB + f"timeout --preserve-status -s TERM 8 {PLAY} {SPHERE} --size 500x300"},
    {"name": "what a window does not know is refused", "run": ["tet4d-play", SPHERE, "--color", "speed"], "exit": 2,
     "stderr": ["--color", "--offscreen"]},
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
