"""Cases of tet4d-report."""

import csv
import html.parser
import json
import math
import re

VOID = {"meta"}


class Page(html.parser.HTMLParser):
    """Tags that close in order, and nothing fetched from elsewhere."""

    def __init__(self):
        super().__init__()
        self.open, self.headings, self.plots, self.rows = [], [], 0, 0

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            assert name not in ("src", "href"), f"<{tag} {name}={value}> is not inline"
        if tag not in VOID:
            self.open.append(tag)
        self.plots += tag == "svg"
        self.rows += tag == "tr"

    def handle_startendtag(self, tag, attributes):  # "<circle …/>", of the plots
        assert "svg" in self.open and all(name not in ("src", "href") for name, _ in attributes), tag

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, data):
        if self.open and self.open[-1] in ("h1", "h2"):
            self.headings.append(data)


def report(result, folder):
    """Rows of a report, after what holds for every one."""
    root = result.directory / folder
    rows = [json.loads(line) for line in (root / "runs.jsonl").read_text().splitlines()]
    with open(root / "runs.csv", newline="") as file:
        table = list(csv.DictReader(file))
    assert len(table) == len(rows)
    for row, line in zip(rows, table):
        assert row["sweep"] == line["sweep"] and row["arguments"] == line["arguments"]
        assert row["commit"] == "c0ffee" and row["machine"] and re.fullmatch("[0-9a-f]{16}", row["digest"]), row
        assert "/" not in row["arguments"].replace("pictures/", ""), row["arguments"]
    page = Page()
    text = (root / "index.html").read_text()
    page.feed(text)
    page.close()
    assert page.open == [], page.open
    assert page.plots >= 2 and page.rows > len(rows), (page.plots, page.rows)
    assert "http" not in text.replace("http://www.w3.org/2000/svg", ""), "the page asks a network"
    assert "nan" not in text and ">inf<" not in text
    assert not (root / "work").exists(), "the working folder is left"
    for svg in root.glob("*.svg"):
        png = svg.with_suffix(".png")
        assert not png.exists() or png.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    return rows


def check_mc(result):
    rows = report(result, "r")
    assert all(r["exit"] == 0 and r["fault"] == "" for r in rows)
    ours, peers = ([r for r in rows if (r["program"] == "tet4d-mc") == mine] for mine in (True, False))
    assert len(ours) == 12 and len(peers) == 4 and {r["program"] for r in peers} == {"vtkFlyingEdges3D"}
    for row in peers:  # as good as ours at frames; between them a surface stands still. Or absent, and says so.
        if "absent" in row:
            assert "python" in row["absent"] and "rms_at" not in row, row
            continue
        same = next(r for r in ours if (r["space_stride"], r["time_stride"]) == (row["space_stride"], 1))
        assert abs(row["rms_at"] / same["rms_at"] - 1) < 0.05 and row["rms_between"] > same["rms_between"], row
        assert row["triangles"] > 0 and row["seconds_wall"] > 0 and row["peer_version"]
    rows = ours
    by = {(r["space_stride"], r["time_stride"]): r for r in rows}
    for time in (1, 2, 4):
        for coarse, fine in ((8, 4), (4, 2), (2, 1)):
            order = math.log2(by[coarse, time]["rms_at_cells"] / by[fine, time]["rms_at_cells"])
            assert 1.8 < order < 2.2, f"order {order} from stride {coarse} to {fine}"
            assert by[coarse, time]["rms_between_cells"] > by[fine, time]["rms_between_cells"]
            assert by[coarse, time]["samples"] < by[fine, time]["samples"]
    finest = by[1, 1]
    assert finest["max_at_cells"] <= finest["max_bound_at_cells"] < 0.05
    assert finest["p99_at_cells"] <= finest["max_at_cells"] and finest["area_error_at"] < 2e-3
    assert by[1, 4]["rms_between_cells"] > 2 * finest["rms_between_cells"], "error in time"


def check_stiff(result):
    rows = report(result, "r")
    assert {r["case"] for r in rows} == {"aspect ratio", "far origin", "unit of time", "noise"}
    for row in rows:
        assert row["exit"] == 0, row["fault"]
        assert all(v is not None for v in row.values()), row
    exact = rows[0]["rms_between"]
    for row in rows:
        if row["case"] != "noise":
            assert abs(row["rms_between"] - exact) < 1e-5 and row["tets"] == rows[0]["tets"], row
    noise = {r["value"]: r["rms_between"] for r in rows if r["case"] == "noise"}
    assert noise[1] > 3 * noise[0.1] and noise[1] < 1


def check_stiff_triangles(result):
    rows = report(result, "r")
    assert {r["case"] for r in rows} == {"aspect ratio", "far origin", "unit of time", "noise"}
    for row in rows:
        assert row["exit"] == 0, row["fault"]
        assert row["tets"] > 0 and row["ms_p50"] > 0
        if row["case"] != "noise":
            assert row["rmse_255"] < 0.2, row
        if "renderers_apart_255" in row:  # of light on black at full contrast
            assert row["renderers_apart_255"] < 1, row
    noise = {r["value"]: r["rmse_255"] for r in rows if r["case"] == "noise"}
    assert noise[1] > noise[0.1] > 0.5, noise


def check_slim(result):
    rows = report(result, "r")
    ours = [r for r in rows if r["program"] == "hyper-qslim"]
    assert {r["order"] for r in ours} == {"passes", "multichoice", "heap"} and {r["metric"] for r in ours} == {"slice", "paper"}
    for row in ours:
        assert row["exit"] == 0, row["fault"]
        assert row["unit"] == "cells" and 0 < row["tets"] <= max(1.001 * row["ratio"], 0.05) * row["tets_in"], row  # random choices stall early
        for kind in ("at", "between"):
            assert 0 < row["rms_" + kind] <= row["p99_" + kind] <= row["max_" + kind] < 16, row
            assert row.get("volume_error_" + kind, 0) < 0.5, row
        assert 1 <= row["closed_slices"] <= 4, row
        assert row["peak_bytes"] > 0 and row["seconds_work"] >= row["seconds_simplify"] > 0
    assert {r["choices"] for r in ours if r["order"] == "multichoice" and r["ratio"] == 0.1} == {2, 8, 32}
    for order in ("passes", "heap"):
        by = {r["ratio"]: r for r in ours if r["order"] == order and r["metric"] == "slice"}
        assert by[0.5]["rms_between"] < by[0.1]["rms_between"] < by[0.02]["rms_between"], order
    peers = [r for r in rows if r["program"] != "hyper-qslim"]
    assert {r["ratio"] for r in peers} == {r["ratio"] for r in ours} and all(r["exit"] == 0 for r in peers), peers
    for row in rows:  # what ends early says so
        if "absent" not in row:
            assert row["reached"] == row["tets"] / row["tets_in"], row
            assert ("stall" in row) == (row["reached"] > 1.01 * row["ratio"]), row
    assert any("stall" in r for r in ours), "random choices stall at 2 %"
    for row in peers:
        if "absent" in row:
            assert "python" in row["absent"] and "rms_at" not in row, row
        else:
            assert 0 < row["tets"] < row["tets_in"] and 0 < row["rms_between"] < 16 and row["seconds_work"] > 0, row


def check_stiff_slim(result):
    rows = report(result, "r")
    named = {}
    for row in rows:
        assert row["exit"] == 0, row["fault"]
        named.setdefault(row["series"], {})[row["value"]] = row
    assert set(named) == {"aspect ratio", "far origin", "unit of time", "noise", "cells a frame", "flat piece", "curved piece"}
    # Units of time do not matter at all; origins only to rounding.
    units = named["unit of time"]
    assert len({r["tets"] for r in units.values()}) == 1, units
    for row in [*units.values(), *named["far origin"].values()]:
        assert abs(row["rms_between"] / units[1]["rms_between"] - 1) < 0.02, row
    for row in named["flat piece"].values():
        assert row["max_at"] < 1e-4 and row["max_between"] < 1e-4, row
    assert named["cells a frame"][0]["rms_at"] < 0.5


def check_kept(result):
    rows = [json.loads(line) for line in (result.directory / "r/runs.jsonl").read_text().splitlines() if line]
    assert len(rows) == 12 and len({(r["case"], r["value"]) for r in rows}) == 12


def check_play(result):
    rows = report(result, "r")
    assert len(rows) == 3, len(rows)
    by = {r["option samples"]: r for r in rows}
    assert by["1"]["exit"] == by["4"]["exit"] == 0
    assert by["1"]["rmse_255"] > by["4"]["rmse_255"] > 0 and by["1"]["flicker_255"] > 0
    assert by["1"]["pictures"] == 3 and by["1"]["ms_p95"] >= by["1"]["ms_p50"] > 0 and by["1"]["processed_per_drawn"] >= 1
    assert by["1"]["views"] == 1 and by["1"]["rmse_worst_view_255"] == by["1"]["rmse_255"]
    assert by["5"]["exit"] == 2 and "tet4d-play" in by["5"]["fault"], by["5"]
    assert "1 of these runs failed" in (result.directory / "r/index.html").read_text()


def check_views(result):
    rows = report(result, "r")
    (row,) = rows
    assert row["views"] == 14 and row["pictures"] == 14 and row["case"] == "14 views, camera fitted", row
    assert row["rmse_worst_view_255"] > row["rmse_255"] > 0


def check_distance(result):
    same, apart = documents(result.stdout)
    assert same["max"] < 1e-12 and same["max_bound"] >= same["max"]
    assert 0 < apart["rms"] < apart["p99"] <= apart["max"] <= apart["max_bound"]


def documents(text):
    decoder, found = json.JSONDecoder(), []
    while text := text.lstrip():
        value, end = decoder.raw_decode(text)
        found.append(value)
        text = text[end:]
    return found


DAM = "tet4d-mc {data}/dambreak/alpha_00{08,09,10}.nrrd --iso 0.5 --stride 2 -q -o dam.t4h; "

CASES = [
    {
        "name": "help lists the commands",
        "run": ["tet4d-report", "--help"],
        "stdout": ["Examples:", "usage: tet4d-report COMMAND", "mc ", "stiff", "play", "all", "distance", "pictures"],
    },
    {
        "name": "each command has a help of its own",
        "run": ["tet4d-report", "play", "--help"],
        "stdout": ["tet4d-report play - ", "usage: tet4d-report play FILE...", "--vary", "--folder", "--threads"],
    },
    {"name": "version", "run": ["tet4d-report", "--version"], "stdout": ["tet4d-report "]},
    {
        "name": "a misspelt command",
        "run": ["tet4d-report", "plya"],
        "exit": 2,
        "stderr": ["tet4d-report: 'plya': is no command; there are mc, stiff, qslim, play", "did you mean play?"],
    },
    {"name": "no command", "run": ["tet4d-report"], "exit": 2, "stderr": ["no command is given"]},
    {
        "name": "a ball at strides: second order, well-formed page",
        "run": ["tet4d-report", "mc", "--folder", "r", "--commit", "c0ffee", "-q"],
        "check": check_mc,
        "needs": ["tet4d-mc"],
        "timeout": 280,
    },
    {
        "name": "stiff cases have figures, and the same ones",
        "run": ["tet4d-report", "stiff", "mc", "--folder", "r", "--commit", "c0ffee", "-q"],
        "check": check_stiff,
        "needs": ["tet4d-mc"],
        "timeout": 280,
    },
    {
        "name": "no other program has stiff cases",
        "run": ["tet4d-report", "stiff", "play"],
        "exit": 2,
        "stderr": ["'play': has no sweep of stiff cases; mc, dyntri and qslim have"],
    },
    {
        "name": "pictures over options, a run that fails is a row",
        "shell": DAM + "dyntri-build dam.t4h -q -o dam.t4d; tet4d-report play dam.t4d --vary renderer=cpu "
                 "--vary samples=1,4,5 --size 64x48 --times 0f:1f:0.5f --views one --folder r --commit c0ffee -q",
        "check": check_play,
        "stderr": ["1 of 3 runs failed"],
        "needs": ["tet4d-mc", "dyntri-build", "tet4d-play"],
        "timeout": 280,
    },
    {
        "name": "pictures from the faces and corners of a cube",
        "shell": DAM + "dyntri-build dam.t4h -q -o dam.t4d; tet4d-report play dam.t4d --vary renderer=cpu "
                 "--size 64x48 --times 0.5f:0.5f:1f --folder r --commit c0ffee -q",
        "check": check_views,
        "needs": ["tet4d-mc", "dyntri-build", "tet4d-play"],
        "timeout": 280,
    },
    {
        "name": "stiff cases through to pictures",
        "long_sweep": True,
        "run": ["tet4d-report", "stiff", "dyntri", "--folder", "r", "--commit", "c0ffee", "-q"],
        "check": check_stiff_triangles,
        "needs": ["tet4d-mc", "dyntri-build", "tet4d-play"],
        "timeout": 280,
    },
    {
        "name": "orders, metrics and ratios of simplification, and the peer or its absence",
        "long_sweep": True,
        "run": ["tet4d-report", "qslim", "--folder", "r", "--commit", "c0ffee", "-q"],
        "check": check_slim,
        "needs": ["tet4d-mc", "hyper-qslim", "tet4d-convert"],
        "timeout": 280,
    },
    {
        "name": "stiff cases of simplification",
        "long_sweep": True,
        "run": ["tet4d-report", "stiff", "qslim", "--folder", "r", "--commit", "c0ffee", "-q"],
        "check": check_stiff_slim,
        "needs": ["tet4d-mc", "hyper-qslim"],
        "timeout": 280,
    },
    {
        "name": "what simplification is given must become a hypermesh",
        "run": ["tet4d-report", "qslim", "no-such-folder", "--folder", "r", "-q"],
        "exit": 3,
        "stderr": ["no-such-folder: ", "becomes no hypermesh"],
        "needs": ["tet4d-mc"],
    },
    {
        # The first of twelve runs is missing and its program never ends: killed there, the other eleven were not yet reached.
        "name": "a resumed sweep that is killed keeps the rows it had not reached",
        "shell": "mkdir slow; printf '#!/bin/sh\\necho $PPID >\"$PID_FILE\"\\nexec sleep 5\\n' >slow/tet4d-mc; chmod +x slow/tet4d-mc; "
                 "export PID_FILE=$PWD/pid; tet4d-report stiff mc --folder r --commit c0ffee -q; sed -i 1d r/runs.jsonl; "
                 "cp r/runs.jsonl eleven; for signal in KILL TERM; do rm -f pid; "
                 "tet4d-report stiff mc --folder r --commit c0ffee -q --resume --bin slow & "
                 "while [ ! -s pid ]; do sleep 0.05; done; kill -$signal $(cat pid); wait $! || true; "
                 "cmp eleven r/runs.jsonl && echo \"kept after $signal\"; done; "
                 "tet4d-report stiff mc --folder r --commit c0ffee -q --resume",
        "stdout": ["kept after KILL", "kept after TERM"],
        "check": check_kept,
        "needs": ["tet4d-mc"],
        "timeout": 280,
    },
    {
        "name": "an option without values",
        "run": ["tet4d-report", "play", "{files}/triangles.t4d", "--vary", "samples"],
        "exit": 2,
        "stderr": ["--vary 'samples': is not OPTION=V,V,V"],
    },
    {
        "name": "programs that are not there are rows, and rows are kept",
        "shell": "tet4d-report stiff mc --folder r --commit c0ffee -q --bin nowhere; grep -c '\"exit\":127' r/runs.jsonl; "
                 "tet4d-report stiff mc --folder r --commit c0ffee -q; cp r/runs.jsonl first; "
                 "tet4d-report stiff mc --folder r --commit c0ffee -q --resume; cmp first r/runs.jsonl && echo kept",
        "stdout": ["12", "kept"],
        "stderr": ["12 of 12 runs failed"],
        "needs": ["tet4d-mc"],
        "timeout": 280,
    },
    {
        "name": "distances of slices",
        "shell": DAM + "tet4d-convert dam.t4h --at 0f -q -o a.stl; tet4d-convert dam.t4h --at 1f -q -o b.stl; "
                 "tet4d-report distance a.stl a.stl --json -q; tet4d-report distance a.stl b.stl --json -q; ",
        "check": check_distance,
        "needs": ["tet4d-mc", "tet4d-convert"],
        "timeout": 200,
    },
    {
        "name": "distances as text",
        "shell": DAM + "tet4d-convert dam.t4h --at 0f -q -o a.stl; tet4d-report distance a.stl a.stl -q",
        "stdout": ["A to B  max ", "B to A  max "],
        "needs": ["tet4d-mc", "tet4d-convert"],
        "timeout": 200,
    },
    {
        "name": "what is no picture",
        "run": ["tet4d-report", "pictures", "a.png", "a.png"],
        "prepare": {"a.png": "not a picture"},
        "exit": 3,
        "stderr": ["tet4d-report: a.png: is no PNG"],
    },
    {
        "name": "a picture that is missing",
        "run": ["tet4d-report", "pictures", "a.png", "b.png"],
        "exit": 1,
        "stderr": ["tet4d-report: a.png: cannot be read"],
    },
]
