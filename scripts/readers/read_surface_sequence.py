#!/usr/bin/python3
"""Slow, readable reader of surface sequences (.t4q), written from docs/formats/surface_sequence.md alone. See t4container.py."""

import math
import struct
import sys

import t4container as t4
from read_hypermesh import COLUMN, Column

HEADER = struct.Struct("<QQQII12d8f4Q")
assert HEADER.size == 192


class SurfaceSequence:
    """A surface sequence, everything in it proved."""

    def __init__(self, path):
        self.container = t4.Container(path, "SSEQ", 1, ("QHDR", "TIME", "TRIS", "COLS", "PAGE", "PTAB"))
        self._read_header()
        self._read_triangles()
        self.pages = t4.Pages(self.container)
        self.container.verify()
        self.pages.verify()
        stride = 1 + len(self.columns)
        t4.require(len(self.pages.entries) == self.frames * stride, "section PTAB", "not one page a frame and column")
        for number, entry in enumerate(self.pages.entries):
            self._check_entry(number, entry, stride)
        box = t4.BoxOf()
        for k in range(self.frames):
            for point in self.frame(k):
                box.add((*point, float(k)))
        t4.require(box.get() == (self.bounds[:4], self.bounds[4:]), "section QHDR", "bounds are not the vertices' box")

    def _read_header(self):
        place = "section QHDR"
        fields = HEADER.unpack(self.container.single("QHDR", HEADER.size))
        self.vertex_count, self.triangle_count, self.frames, column_count, reserved = fields[:5]
        self.index_to_world, self.bounds = fields[5:17], fields[17:25]
        t4.require(reserved == 0 and not any(fields[25:]), place, "reserved field is not zero")
        t4.require(1 <= self.vertex_count <= 1 << 32, place, f"{self.vertex_count} vertices")
        t4.check_map(self.index_to_world, place)
        t4.check_bounds(self.bounds[:4], self.bounds[4:], place)
        self.times = t4.check_timeline(self.container.content("TIME", 8))
        t4.require(1 <= self.frames == len(self.times), "section TIME", f"{len(self.times)} for {self.frames} frames")
        raw = self.container.content("COLS", COLUMN.size) if self.container.find("COLS") else b""
        self.columns = [Column(raw[at:at + COLUMN.size]) for at in range(0, len(raw), COLUMN.size)]
        t4.require(len(self.columns) == column_count, "section COLS", f"not the header's {column_count} columns")
        names = [column.name for column in self.columns]
        t4.require(len(set(names)) == len(names), "section COLS", "two columns have the same name")

    def _read_triangles(self):
        place = "section TRIS"
        self.triangles = t4.groups("I", self.container.content("TRIS", 12), 3)
        t4.require(len(self.triangles) == self.triangle_count, place, f"not the header's {self.triangle_count}")
        for number, triangle in enumerate(self.triangles):
            t4.require(max(triangle) < self.vertex_count, place, f"triangle {number} is out of range")
            t4.require(len(set(triangle)) == 3, place, f"triangle {number} has a vertex twice")

    def _check_entry(self, number, entry, stride):
        place, k, c = f"page {number}", number // stride, number % stride
        components = 3 if c == 0 else self.columns[c - 1].components
        t4.require(entry.kind == c, place, f"kind {entry.kind}, expected {c}")
        t4.require(entry.raw_bytes == 4 * components * self.vertex_count, place, f"{entry.raw_bytes} bytes")
        t4.require(entry.counts == (k, self.vertex_count, 0, 0), place, f"counts {entry.counts}")
        t4.require(entry.min[3] == entry.max[3] == t4.f32(k), place, "bounds are not at the frame's time")

    def frame(self, k):
        """Positions at frame k, proved to be finite and in the page's box."""
        number = k * (1 + len(self.columns))
        entry, place = self.pages.entries[number], f"page {number}"
        points = t4.groups("f", self.pages.load(number), 3)
        for point in points:
            t4.require(all(map(math.isfinite, point)), place, "a vertex is not finite")
            inside = all(a <= x <= b for a, x, b in zip(entry.min, point, entry.max))
            t4.require(inside, place, "a vertex lies outside the page's bounds")
        return points

    def dump(self):
        yield (f"surface_sequence vertices {self.vertex_count} triangles {self.triangle_count} "
               f"frames {self.frames} columns {len(self.columns)}")
        yield t4.row("index_to_world", self.index_to_world, t4.text64)
        yield t4.row("bounds", self.bounds, t4.text32)
        yield t4.row("times", self.times, t4.text64)
        for column in self.columns:
            yield f"column {column.components} {column.name}"
        for triangle in self.triangles:
            yield t4.row("tri", triangle)
        for number, entry in enumerate(self.pages.entries):
            k, c = divmod(number, 1 + len(self.columns))
            yield t4.entry_line(number, entry)
            if c == 0:
                yield from (t4.row("v", point, t4.text32) for point in self.frame(k))
            else:
                values = t4.groups("f", self.pages.load(number), self.columns[c - 1].components)
                yield from (t4.row("c", value, t4.text32) for value in values)

    def summary(self):
        return {"payload": "SSEQ", "version": self.container.payload_version,
                "counts": {"frames": self.frames, "vertices": self.vertex_count, "triangles": self.triangle_count},
                "bounds": {"min": self.bounds[:4], "max": self.bounds[4:]}, "bytes": len(self.container.data),
                "columns": [column.name for column in self.columns],
                "provenance": self.container.provenance(), "page_digest": self.pages.digest(),
                "digest": t4.digest(self.dump())}


if __name__ == "__main__":
    sys.exit(t4.main_of(SurfaceSequence, "Proves a surface sequence."))
