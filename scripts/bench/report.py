#!/usr/bin/python3
"""Makes docs/benchmarks/report.md of the rows that tet4d-report wrote.

usage: scripts/bench/report.py FOLDER...  each has runs.jsonl; prints the page
"""
import argparse
import json
import pathlib

TABLES = [
    ("ball", "A ball that moves and grows",
     "`tet4d-mc` on {input}; distances to the sphere, in cells of the finest grid, at frames and halfway between two kept ones. "
     "VTK: a surface a frame by `vtkFlyingEdges3D`, seconds of the filter alone; between frames such a sequence shows the surface of the frame "
     "before.",
     ["program", "space_stride", "time_stride", "samples", "tets", "triangles", "seconds_wall", "seconds_cpu", "peak_bytes", "rms_at_cells", "max_at_cells",
      "rms_between_cells", "max_between_cells", "area_error_at", "volume_error_at"]),
    ("frames", "Frames of a volume",
     "`tet4d-mc` on {input}; distances to slices of all samples and frames, the worse of both directions. Surfaces end at the walls, and "
     "earlier where a stride leaves out the last samples: that is what the largest distances show.",
     ["space_stride", "time_stride", "samples", "tets", "seconds_wall", "seconds_cpu", "peak_bytes", "rms_at_cells", "p99_at_cells",
      "max_at_cells", "rms_between_cells", "p99_between_cells", "area_error_between"]),
    ("stiff", "Stiff cases", "`tet4d-mc` on {input}, placed in another world; errors in cells.",
     ["case", "value", "tets", "seconds_wall", "seconds_cpu", "rms_at", "max_at", "rms_between", "max_between"]),
    ("stiff-dyntri", "Stiff cases through to pictures",
     "`dyntri-build` and `tet4d-play` on {input}, placed in another world and drawn along z without lights or walls, against the pictures of unit cells; "
     "errors in 255ths of linear light.",
     ["case", "value", "tets", "seconds_wall", "seconds_cpu", "ms_p50", "rmse_255", "renderers_apart_255"]),
    ("play", "Pictures",
     "`tet4d-play` on {input}, from the faces and corners of a cube, against 16 samples a pixel; errors in 255ths of linear light.",
     ["varied", "views", "pictures", "ms_p50", "ms_p95", "rmse_255", "rmse_worst_view_255", "flicker_255", "processed_per_drawn", "touched_bytes", "peak_bytes"]),
]


def cell(name, value):
    if value is None:
        return ""
    if name.endswith("_bytes"):
        return f"{value / 1e6:.1f} MB"
    if isinstance(value, float):
        return f"{value:.3g}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def table(columns, rows):
    names = [name for name in columns if any(name in row for row in rows)]
    yield "| " + " | ".join(name.replace("_", " ") for name in names) + " |"
    yield "|" + "---|" * len(names)
    for row in rows:
        yield "| " + " | ".join(cell(name, row.get(name)) for name in names) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", type=pathlib.Path, nargs="+", metavar="FOLDER")
    rows = [json.loads(line) for folder in parser.parse_args().folders
            for line in (folder / "runs.jsonl").read_text(encoding="utf-8").splitlines() if line]
    loads = [row["load"] for row in rows if "load" in row]
    print("# Error against run time\n\nMade by `tet4d-report all out/demo.t4d --data tests/data/dambreak --camera "
          "scripts/demo-camera.json`, `tet4d-report stiff dyntri` and `scripts/bench/report.py` of their folders;\n[README.md](README.md) says how to measure. "
          f"Commit {rows[0]['commit']}, {rows[0]['machine']}; load of the machine while they ran: {min(loads):.1f} to {max(loads):.1f}, so "
          "wall seconds\nabove two say no more than their order of magnitude. Errors do not depend on it.")
    for sweep, heading, text, columns in TABLES:
        of_sweep = [row for row in rows if row["sweep"] == sweep and row["exit"] == 0]
        if not of_sweep:
            continue
        print(f"\n## {heading}\n\n{text.format(input=of_sweep[0]['input'])}\n")
        print("\n".join(table(columns, of_sweep)))


if __name__ == "__main__":
    main()
