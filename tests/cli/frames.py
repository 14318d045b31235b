"""Cases of the options with which programs take frames: raw files, MetaImages, standard input, parts of a sequence."""

# Four frames of the dam break as raw samples behind each other, without their headers; their size is 90 x 61 x 45.
DAM = "{data}/dambreak/alpha_00{08,09,10,11}.nrrd"


def describe(program="tet4d-convert"):
    return f"{program} {DAM} -q -o dam.nrrd; "


# header.py splits a NRRD with attached raw data: dam.raw, and the words of its header.
SPLIT = r"""
import re, sys
data = open("dam.nrrd", "rb").read()
end = data.index(b"\n\n") + 2
head = data[:end].decode()
sizes = re.search(r"sizes: (.*)", head).group(1).split()
types = {"float": "f32", "uint8": "u8", "uchar": "u8", "double": "f64"}
directions = re.findall(r"\(([^)]*)\)", re.search(r"space directions: (.*)", head).group(1))
open("dam.raw", "wb").write(data[end:])
open("size", "w").write(",".join(sizes[:3]))
open("type", "w").write(types[re.search(r"type: (.*)", head).group(1)])
open("spacing", "w").write(",".join(d.split(",")[i] for i, d in enumerate(directions)))
open("origin", "w").write(re.search(r"space origin: \((.*)\)", head).group(1))
open("times", "w").write(re.search(r"times:=(.*)", head).group(1))
frame = len(data[end:]) // int(sizes[3])
step = [d.split(",")[i] for i, d in enumerate(directions)]
for k in range(int(sizes[3])):
    part = data[end + k * frame : end + (k + 1) * frame]
    time = re.search(r"times:=(.*)", head).group(1).split()[k]
    open(f"f_{k}.raw", "wb").write(part)
    lines = [l for l in head.split("\n") if l and not re.match(r"dimension|sizes|kinds|spacings|axis mins|times|space directions", l)]
    open(f"n_{k}.nrrd", "wb").write("\n".join(
        lines + ["dimension: 3", "sizes: " + " ".join(sizes[:3]), "time:=" + time,
                 "space directions: " + " ".join(f"({d})" for d in directions[:3]), "", ""]).encode() + part)
    kind = {"float": "MET_FLOAT", "uint8": "MET_UCHAR", "double": "MET_DOUBLE"}[re.search(r"type: (.*)", head).group(1)]
    open(f"m_{k}.mhd", "w").write(
        "ObjectType = Image\nNDims = 3\nDimSize = " + " ".join(sizes[:3]) + "\nElementType = " + kind +
        "\nElementSpacing = " + " ".join(step) + "\nOffset = " + open("origin").read().replace(",", " ") +
        f"\nElementDataFile = f_{k}.raw\n")
"""
PREPARE = {"split.py": SPLIT}
MAKE = describe() + "python3 split.py; "
REFERENCE = MAKE + "tet4d-mc dam.nrrd --iso 0.5 -q -o want.t4h; "
RAW = "--size $(cat size) --type $(cat type) --spacing $(cat spacing) --origin $(cat origin) --times times "
EQUAL = "cmp want.t4h got.t4h"
SMALL = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 2 2\nencoding: raw\n\n"


def small(count):
    return "".join(SMALL + "01" + str(k % 2) + "01101101" + str(k % 2) for k in range(count))


CASES = [
    {
        "name": "raw frames in one file leave the same bytes as a NRRD",
        "shell": REFERENCE + f"tet4d-mc dam.raw {RAW} --iso 0.5 -q -o got.t4h; " + EQUAL,
        "prepare": PREPARE,
        "needs": ["tet4d-convert"],
    },
    {
        "name": "one raw file a frame, by pattern and with bytes to skip",
        "shell": REFERENCE + f"tet4d-mc f_%d.raw {RAW} --iso 0.5 -q -o got.t4h; {EQUAL}; "
        "for k in 0 1 2 3; do (printf header; cat f_$k.raw) > g_$k.bin; done; "
        f"tet4d-mc g_?.bin {RAW} --skip 6 --iso 0.5 -q -f -o got.t4h; " + EQUAL,
        "prepare": PREPARE,
        "needs": ["tet4d-convert"],
    },
    {
        "name": "MetaImages leave the same bytes as a NRRD",
        "shell": REFERENCE + "tet4d-mc m_?.mhd --times times --iso 0.5 -q -o got.t4h; " + EQUAL,
        "prepare": PREPARE,
        "needs": ["tet4d-convert"],
    },
    {
        "name": "NRRDs from standard input leave the same bytes as files, in pieces of any size",
        "shell": REFERENCE + "cat n_?.nrrd | tet4d-mc - --iso 0.5 -q -o got.t4h; " + EQUAL + "; "
        "cat n_?.nrrd | dd bs=777 status=none | tet4d-mc - --iso 0.5 -q -f -o got.t4h; " + EQUAL,
        "prepare": PREPARE,
        "needs": ["tet4d-convert"],
    },
    {
        "name": "raw frames from standard input leave the same bytes as files",
        "shell": REFERENCE + f"cat dam.raw | tet4d-mc - {RAW} --iso 0.5 -q -o got.t4h; " + EQUAL,
        "prepare": PREPARE,
        "needs": ["tet4d-convert"],
    },
    {
        "name": "a 4D NRRD through a pipe, from one program to the other",
        "shell": REFERENCE + f"tet4d-convert {DAM} -q -o - > p.nrrd; cmp p.nrrd dam.nrrd; "
        f"tet4d-convert {DAM} -q -o - | tet4d-mc - --iso 0.5 -q -o got.t4h; " + EQUAL,
        "prepare": PREPARE,
        "needs": ["tet4d-convert"],
    },
    {
        "name": "a stream into a .t4g is the same as files into a .t4g",
        "shell": MAKE + "tet4d-convert dam.nrrd -q -o want.t4g; cat n_?.nrrd | tet4d-convert - -q -o got.t4g; "
        "cmp want.t4g got.t4g; tet4d-info --validate got.t4g > info; grep -q sound info || cat info",
        "prepare": PREPARE,
        "needs": ["tet4d-convert", "tet4d-info"],
    },
    {
        "name": "a stream into a NRRD is refused and says what to do",
        "run": ["tet4d-convert", "-", "-o", "x.nrrd"],
        "stdin": small(2),
        "exit": 2,
        "stderr": ["x.nrrd", "count of its frames", ".t4g first"],
        "absent": ["x.nrrd"],
    },
    {
        "name": "parts of a sequence are the same whichever way they are taken",
        "shell": MAKE + "V='--crop 3:60,:,5:40 --stride 2,1,3 --frames 1:3 --time-stride 2'; "
        "tet4d-convert dam.nrrd $V -q -o a.nrrd; (cat n_?.nrrd || true) | tet4d-convert - $V -q -o b.t4g; "  # which does not wait for the rest
        "tet4d-convert b.t4g -q -o b.nrrd; cmp a.nrrd b.nrrd; "
        "tet4d-convert dam.nrrd --crop 3:,0:,5: --frames 1: -q -o c.nrrd; "
        "tet4d-convert c.nrrd --crop :57,:,:35 --stride 2,1,3 --frames :2:2 -q -o d.nrrd; cmp a.nrrd d.nrrd",
        "prepare": PREPARE,
        "needs": ["tet4d-convert"],
    },
    {
        "name": "a crop beyond the grid names both ranges",
        "run": ["tet4d-mc", "-", "--iso", "48.5", "--crop", "0:2,0:2,0:1", "-o", "x.t4h"],
        "stdin": small(2),
        "exit": 2,
        "stderr": ["--crop", "0:2", "along y", "0:1"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a crop that is no crop",
        "run": ["tet4d-mc", "a.nrrd", "--iso", "1", "--crop", "0:2,0:2", "-o", "x.t4h"],
        "exit": 2,
        "stderr": ["--crop", "'0:2,0:2'", "X0:X1,Y0:Y1,Z0:Z1"],
    },
    {
        "name": "frames that are no frames",
        "run": ["tet4d-mc", "a.nrrd", "--iso", "1", "--frames", "0:2:0", "-o", "x.t4h"],
        "exit": 2,
        "stderr": ["--frames", "'0:2:0'", "A:B:STEP"],
    },
    {
        "name": "a size without a type",
        "run": ["tet4d-mc", "a.raw", "--iso", "1", "--size", "3,2,2", "-o", "x.t4h"],
        "exit": 2,
        "stderr": ["--size", "type of the samples is not given", "--type f32"],
    },
    {
        "name": "a type without a size",
        "run": ["tet4d-mc", "a.raw", "--iso", "1", "--type", "u8", "-o", "x.t4h"],
        "exit": 2,
        "stderr": ["--type", "describes raw files", "--size"],
    },
    {
        "name": "a raw file without a description says what is missing",
        "run": ["tet4d-mc", "a.raw", "--iso", "1", "-o", "x.t4h"],
        "prepare": {"a.raw": "0" * 24},
        "exit": 3,
        "stderr": ["a.raw", ".nrrd, .nhdr, .vti, .mha, .mhd", "--size X,Y,Z and --type"],
    },
    {
        "name": "a raw file of another size names the bytes",
        "run": ["tet4d-mc", "a.raw", "--iso", "1", "--size", "3,2,2", "--type", "u8", "-o", "x.t4h"],
        "prepare": {"a.raw": "0" * 29},
        "exit": 3,
        "stderr": ["a.raw", "3 x 2 x 2", "12 bytes", "29", "2 frames and 5 bytes more"],
    },
    {
        "name": "an empty stream",
        "run": ["tet4d-mc", "-", "--iso", "48.5", "-o", "x.t4h"],
        "exit": 3,
        "stderr": ["standard input: frame 0: the stream is empty"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a truncated stream names the frame and its bytes and leaves no file",
        "run": ["tet4d-mc", "-", "--iso", "48.5", "-o", "x.t4h"],
        "stdin": small(3)[:-5],
        "exit": 3,
        "stderr": ["standard input: frame 2: the stream ends after 7 of the frame's 12 bytes"],
        "absent": ["x.t4h"],
    },
    {
        "name": "one frame in a stream is too few",
        "run": ["tet4d-mc", "-", "--iso", "48.5", "-o", "x.t4h"],
        "stdin": small(1),
        "exit": 3,
        "stderr": ["standard input frame 0", "two at least"],
        "absent": ["x.t4h"],
    },
    {
        "name": "standard input beside files",
        "run": ["tet4d-mc", "a.nrrd", "-", "--iso", "48.5", "-o", "x.t4h"],
        "exit": 2,
        "stderr": ["standard input brings all frames or none"],
    },
    {
        "name": "a stream cannot be planned",
        "run": ["tet4d-mc", "-", "--iso", "48.5", "-n", "-o", "x.t4h"],
        "stdin": small(2),
        "exit": 2,
        "stderr": ["--dry-run", "known at its end"],
    },
    {
        "name": "times for a stream are counted at its end",
        "run": ["tet4d-mc", "-", "--iso", "48.5", "--times", "1,2,3", "-o", "x.t4h"],
        "stdin": small(2),
        "exit": 2,
        "stderr": ["3 times are given for 2 frames"],
        "absent": ["x.t4h"],
    },
    {
        "name": "a directory of two formats names two files",
        "run": ["tet4d-mc", "d", "--iso", "48.5", "-o", "x.t4h"],
        "prepare": {"d/a.nrrd": small(1), "d/b.mha": "x"},
        "exit": 3,
        "stderr": ["d: holds files of two kinds, d/a.nrrd and d/b.mha"],
    },
]
