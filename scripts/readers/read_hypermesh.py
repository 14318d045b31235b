#!/usr/bin/python3
"""Slow, readable reader of hypermesh files (.t4h), written from docs/formats/hypermesh.md alone. See t4container.py.

Beside --dump: --slice T prints the slice at time T (frames), --faces checks every triangle of the mesh.
"""

import math
import struct
import sys

import t4container as t4
import t4slice

HEADER = struct.Struct("<QQQII12d8f8fd7Q")
PART = struct.Struct("<d3Q")
COLUMN = struct.Struct("<56sII")
PAGE_HEADER = struct.Struct("<8Q")
assert (HEADER.size, COLUMN.size, PAGE_HEADER.size) == (256, 64, 64)
ON_GRID, INNER_BOUNDARY = 1, 2


class Column:
    def __init__(self, raw):
        name, self.components, reserved = COLUMN.unpack(raw)
        place = "section COLS"
        stem = name.rstrip(b"\0")
        t4.require(0 < len(stem) < 56 and b"\0" not in stem, place, f"name {name!r}")
        self.name = stem.decode("utf-8")
        t4.require(1 <= self.components <= 4, place, f"{self.components} components")
        t4.require(reserved == 0, place, "reserved field is not zero")


class Page:
    """A geometry page: own vertices, runs, tetrahedra in global vertex numbers, and the columns' values."""


class Hypermesh:
    """A hypermesh, everything in it proved but the faces."""

    def __init__(self, path):
        self.container = t4.Container(path, "HYPM", 2, ("HHDR", "TIME", "COLS", "PART", "PAGE", "PTAB"))
        self._read_header()
        self.pages = t4.Pages(self.container)
        self.container.verify()
        self.pages.verify()
        stride = 1 + len(self.columns)
        t4.require(len(self.pages.entries) % stride == 0, "section PTAB", "a page is missing")
        self.geometry = [self._read_page(first) for first in range(0, len(self.pages.entries), stride)]
        self._join()

    def _read_header(self):
        place = "section HHDR"
        fields = HEADER.unpack(self.container.single("HHDR", HEADER.size))
        self.vertex_count, self.tet_count, self.frames, self.flags, column_count = fields[:5]
        self.index_to_world, self.domain, self.bounds = fields[5:17], fields[17:25], fields[25:33]
        self.isovalue, part_count, reserved = fields[33], fields[34], fields[35:]
        t4.require(not any(reserved), place, "reserved field is not zero")
        t4.require(self.flags & ~(ON_GRID | INNER_BOUNDARY) == 0, place, f"unknown flags {self.flags:#x}")
        t4.require(not math.isinf(self.isovalue), place, "isovalue is infinite")
        t4.check_map(self.index_to_world, place)
        t4.check_bounds(self.domain[:4], self.domain[4:], place)
        t4.check_bounds(self.bounds[:4], self.bounds[4:], place)
        self.times = t4.check_timeline(self.container.content("TIME", 8))
        t4.require(1 <= self.frames == len(self.times), "section TIME", f"{len(self.times)} for {self.frames} frames")
        raw = self.container.content("COLS", COLUMN.size) if self.container.find("COLS") else b""
        self.columns = [Column(raw[at:at + COLUMN.size]) for at in range(0, len(raw), COLUMN.size)]
        t4.require(len(self.columns) == column_count, "section COLS", f"not the header's {column_count} columns")
        names = [column.name for column in self.columns]
        t4.require(len(set(names)) == len(names), "section COLS", "two columns have the same name")
        self._read_parts(part_count)

    def _read_parts(self, count):
        """The isovalues of the parts; none for a mesh of one part."""
        place = "section PART"
        raw = self.container.content("PART", PART.size) if self.container.find("PART") else b""
        parts = [PART.unpack_from(raw, at) for at in range(0, len(raw), PART.size)]
        t4.require(len(parts) == count, place, f"not the header's {count} parts")
        t4.require(not any(any(reserved) for _, *reserved in parts), place, "reserved field is not zero")
        t4.require(not any(math.isinf(isovalue) for isovalue, *_ in parts), place, "isovalue is infinite")
        t4.require(not parts or self.container.payload_version >= 2, place, "version 1 knows no parts")
        self.parts = [isovalue for isovalue, *_ in parts]

    def _read_page(self, number):
        place, entry, page = f"page {number}", self.pages.entries[number], Page()
        t4.require(entry.kind == 0, place, f"kind {entry.kind}, expected a geometry page")
        data = self.pages.load(number)
        t4.require(len(data) >= PAGE_HEADER.size, place, "shorter than its header")
        page.number, page.entry = number, entry
        page.first, page.owned, tets, runs, foreign, page.part, *reserved = PAGE_HEADER.unpack_from(data)
        t4.require(not any(reserved), place, "reserved field is not zero")
        t4.require(page.part < max(1, len(self.parts)), place, f"part {page.part} is not there")
        counts = (page.first, page.owned, tets, foreign)
        t4.require(entry.counts == counts, place, "counts differ from the page table's")
        t4.require(page.owned + foreign <= 1 << 32, place, "more vertices than local indices can name")
        _, vertices, run_bytes, tet_bytes = t4.cut_parts(data, place, [64, 16 * page.owned, 16 * runs, 16 * tets])
        page.vertices = t4.groups("f", vertices, 4)
        t4.require(all(map(math.isfinite, sum(page.vertices, ()))), place, "a vertex is not finite")
        page.runs = t4.groups("Q", run_bytes, 2)
        self._check_runs(page, foreign)
        local = list(range(page.first, page.first + page.owned))
        for first, count in page.runs:
            local.extend(range(first, first + count))
        page.local_tets = t4.groups("I", tet_bytes, 4)
        for tet in page.local_tets:
            t4.require(max(tet) < len(local), place, f"tetrahedron {tet} is out of range")
            t4.require(len(set(tet)) == 4, place, f"tetrahedron {tet} has a vertex twice")
        page.tets = [tuple(local[i] for i in tet) for tet in page.local_tets]
        page.values = [self._read_column(page, c, column) for c, column in enumerate(self.columns)]
        return page

    def _check_runs(self, page, foreign):
        place, end = f"page {page.number}", 0
        for first, count in page.runs:
            t4.require(count >= 1 and first + count <= self.vertex_count, place, f"run {first}+{count} out of range")
            t4.require(first + count <= page.first or page.first + page.owned <= first, place, "a run of own vertices")
            t4.require(first >= end, place, "runs overlap or are out of order")
            end = first + count
        t4.require(sum(count for _, count in page.runs) == foreign, place, "runs do not sum to the foreign vertices")

    def _read_column(self, page, c, column):
        number = page.number + 1 + c
        place, entry, used = f"page {number}", self.pages.entries[number], 4 * column.components * page.owned
        t4.require(entry.kind == 1 + c, place, f"kind {entry.kind}, expected {1 + c}")
        data = self.pages.load(number)
        t4.require(len(data) == max(64, t4.align_up(used, 64)), place, f"{len(data)} bytes for {page.owned} vertices")
        t4.require(not any(data[used:]), place, "padding is not zero")
        return t4.groups("f", data[:used], column.components)

    def _join(self):
        """All pages together: vertex numbers, sums, bounds, order in time."""
        self.positions, box, begin = [], t4.BoxOf(), -math.inf
        for page in self.geometry:
            t4.require(page.first == len(self.positions), f"page {page.number}", "does not continue the vertex numbers")
            self.positions.extend(page.vertices)
        t4.require(len(self.positions) == self.vertex_count, "section HHDR", "wrong number of vertices")
        tets = sum(len(page.tets) for page in self.geometry)
        t4.require(tets == self.tet_count, "section HHDR", f"{self.tet_count} tets, the pages have {tets}")
        for point in self.positions:
            box.add(point)
        t4.require((self.bounds[:4], self.bounds[4:]) == box.get(), "section HHDR", "bounds are not the vertices' box")
        for page in self.geometry:
            for vertex in (v for tet in page.tets for v in tet):
                for low, value, high in zip(page.entry.min, self.positions[vertex], page.entry.max):
                    t4.require(low <= value <= high, f"page {page.number}", f"vertex {vertex} is outside the bounds")
            if page.tets:
                t4.require(page.entry.min[3] >= begin, f"page {page.number}", "begins before the slab in front of it")
                begin = page.entry.min[3]

    def tets(self):
        for page in self.geometry:
            yield from page.tets

    def slice(self, t, check_winding=False):
        """Triangles (keys, points) of the slice at t (frames), in the order of the tetrahedra."""
        for tet in self.tets():
            yield from t4slice.slice_tet(tet, self.positions, t, self.domain[7], check_winding)

    def check_faces(self):
        """Every triangle is in two tetrahedra, from opposite sides, or in one and on a wall. Returns counts."""
        sides = {}
        for tet in self.tets():
            for left_out in range(4):
                face = [v for i, v in enumerate(tet) if i != left_out]
                swaps = sum(face[i] > face[j] for j in range(3) for i in range(j))
                sides.setdefault(tuple(sorted(face)), []).append((left_out + swaps) % 2)
        inner = sum(len(uses) == 2 for uses in sides.values())
        for face, uses in sides.items():
            t4.require(len(uses) <= 2, f"triangle {face}", f"in {len(uses)} tetrahedra")
            if len(uses) == 2:
                t4.require(uses[0] != uses[1], f"triangle {face}", "its two tetrahedra are oriented against each other")
            elif self.flags & (ON_GRID | INNER_BOUNDARY) == ON_GRID:
                t4.require(self.on_wall(face), f"triangle {face}", "in one tetrahedron, and not on a wall")
        return {"inner": inner, "boundary": len(sides) - inner}

    def on_wall(self, vertices):
        points = [self.positions[v] for v in vertices]
        return any(all(point[axis] == self.domain[side + axis] for point in points)
                   for axis in range(4) for side in (0, 4))

    def dump(self):
        yield (f"hypermesh vertices {self.vertex_count} tets {self.tet_count} frames {self.frames} flags {self.flags} "
               f"columns {len(self.columns)}")
        yield t4.row("index_to_world", self.index_to_world, t4.text64)
        yield t4.row("domain", self.domain, t4.text32)
        yield t4.row("bounds", self.bounds, t4.text32)
        yield t4.row("isovalue", [self.isovalue], t4.text64)
        yield t4.row("times", self.times, t4.text64)
        for column in self.columns:
            yield f"column {column.components} {column.name}"
        for isovalue in self.parts:
            yield t4.row("part", [isovalue], t4.text64)
        for page in self.geometry:
            yield t4.entry_line(page.number, page.entry)
            if self.parts:
                yield f"of_part {page.part}"
            for vertex in page.vertices:
                yield t4.row("v", vertex, t4.text32)
            for run in page.runs:
                yield t4.row("run", run)
            for tet in page.local_tets:
                yield t4.row("tet", tet)
            for c, values in enumerate(page.values):
                yield t4.entry_line(page.number + 1 + c, self.pages.entries[page.number + 1 + c])
                for value in values:
                    yield t4.row("c", value, t4.text32)

    def dump_slice(self, t, check_winding=False):
        yield f"slice at {t4.text32(t)}"
        for keys, points in self.slice(t, check_winding):
            corners = list(zip(keys, points))
            first = keys.index(min(keys))
            corners = corners[first:] + corners[:first]
            yield " ".join(["tri"] + [f"{a}-{b} {x} {y} {z}" for (a, b), point in corners
                                      for x, y, z in [map(t4.text32, point)]])

    def summary(self):
        return {"payload": "HYPM", "version": self.container.payload_version,
                "counts": {"vertices": self.vertex_count, "tets": self.tet_count, "frames": self.frames,
                           "pages": len(self.geometry)},
                "columns": [column.name for column in self.columns],
                "bounds": {"min": self.bounds[:4], "max": self.bounds[4:]}, "bytes": len(self.container.data),
                "provenance": self.container.provenance(), "page_digest": self.pages.digest(),
                "digest": t4.digest(self.dump())}


class More:
    """The options beyond --dump."""

    @staticmethod
    def declare(parser):
        parser.add_argument("--slice", type=float, metavar="T", help="print the slice at T frames")
        parser.add_argument("--winding", action="store_true", help="with --slice: check the winding exactly")
        parser.add_argument("--faces", action="store_true", help="check that the mesh is an oriented manifold")

    @staticmethod
    def run(mesh, options):
        if options.faces:
            print(mesh.check_faces())
        elif options.slice is not None:
            for line in mesh.dump_slice(t4.f32(options.slice), options.winding):
                print(line)
        else:
            return False
        return True


if __name__ == "__main__":
    sys.exit(t4.main_of(Hypermesh, "Proves a hypermesh file.", More))
