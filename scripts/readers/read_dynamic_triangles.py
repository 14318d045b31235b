#!/usr/bin/python3
"""Slow, readable reader of dynamic triangle files (.t4d), written from docs/formats/dynamic_triangles.md alone. See
t4container.py. Beside --dump: --slice T prints the triangles alive at T (frames).
"""

import math
import struct
import sys

import t4container as t4
import t4slice

HEADER = struct.Struct("<6Q12d8ffIQ8Q")
COLUMN = struct.Struct("<56sII")
PART = struct.Struct("<d3Q")
PAGE_HEADER = struct.Struct("<8Q")
assert (HEADER.size, PAGE_HEADER.size) == (256, 64)


class Page:
    """Vertices (x, y, z, t), edges (a, b), lifespans (begin, end), triangles (three edges), bands (first, count, index)."""


def interval_at(entry, count, t):
    """Which of `count` equal intervals of the page's time holds t."""
    begin, end = entry.min[3], entry.max[3]
    return max(0, min(count - 1, int((t - begin) * (count / (end - begin)))))


def float_below(value):
    """The float32 before one that is no infinity."""
    bits, = struct.unpack("<i", struct.pack("<f", value))
    if bits == 0 or value == 0:
        return struct.unpack("<f", struct.pack("<I", 0x80000001))[0]
    return struct.unpack("<f", struct.pack("<i", bits - 1 if value > 0 else bits + 1))[0]


class DynamicTriangles:
    """A file of dynamic triangles, everything in it proved."""

    def __init__(self, path):
        self.container = t4.Container(path, "DYNT", 2, ("DHDR", "TIME", "COLS", "PART", "PAGE", "PTAB"))
        place = "section DHDR"
        fields = HEADER.unpack(self.container.single("DHDR", HEADER.size))
        self.sums, self.tets, self.frames, self.empty = fields[:3], fields[3], fields[4], fields[5]
        self.index_to_world, self.bounds, self.last_time = fields[6:18], fields[18:26], fields[26]
        t4.require(not any(fields[29:]), place, "reserved field is not zero")
        self._read_columns(*fields[27:29])
        t4.check_map(self.index_to_world, place)
        t4.check_bounds(self.bounds[:4], self.bounds[4:], place)
        t4.require(math.isfinite(self.last_time), place, f"last time {self.last_time}")
        self.times = t4.check_timeline(self.container.content("TIME", 8))
        t4.require(1 <= self.frames == len(self.times), "section TIME", f"{len(self.times)} for {self.frames} frames")
        self.pages = t4.Pages(self.container)
        self.container.verify()
        self.pages.verify()
        stride = 1 + len(self.columns)
        t4.require(len(self.pages.entries) % stride == 0, "section PTAB", "a page is missing")
        self.content = [self._read_page(number) for number in range(0, len(self.pages.entries), stride)]
        self._join()

    def _read_columns(self, column_count, part_count):
        raw = self.container.content("COLS", COLUMN.size) if self.container.find("COLS") else b""
        self.columns = []
        for at in range(0, len(raw), COLUMN.size):
            name, components, reserved = COLUMN.unpack_from(raw, at)
            stem = name.rstrip(b"\0")
            t4.require(0 < len(stem) < 56 and b"\0" not in stem, "section COLS", f"name {name!r}")
            t4.require(1 <= components <= 4 and reserved == 0, "section COLS", f"{components} components, {reserved}")
            self.columns.append((stem.decode("utf-8"), components))
        t4.require(len(self.columns) == column_count, "section COLS", f"not the header's {column_count} columns")
        t4.require(len({name for name, _ in self.columns}) == column_count, "section COLS", "two have the same name")
        raw = self.container.content("PART", PART.size) if self.container.find("PART") else b""
        parts = [PART.unpack_from(raw, at) for at in range(0, len(raw), PART.size)]
        t4.require(len(parts) == part_count, "section PART", f"not the header's {part_count} parts")
        t4.require(not any(any(reserved) for _, *reserved in parts), "section PART", "reserved field is not zero")
        self.parts = [isovalue for isovalue, *_ in parts]
        t4.require(not any(map(math.isinf, self.parts)), "section PART", "isovalue is infinite")
        t4.require(self.container.payload_version >= 2 or not (self.columns or self.parts), "section DHDR",
                   "version 1 knows neither columns nor parts")

    def _read_page(self, number):
        place, entry, page = f"page {number}", self.pages.entries[number], Page()
        t4.require(entry.kind == 0, place, f"kind {entry.kind}")
        data = self.pages.load(number)
        t4.require(len(data) >= PAGE_HEADER.size, place, "shorter than its header")
        vertices, edges, triangles, bands, intervals, page.part, *reserved = PAGE_HEADER.unpack_from(data)
        t4.require(not any(reserved), place, "reserved field is not zero")
        t4.require(entry.counts == (vertices, edges, triangles, 0), place, "counts differ from the page table's")
        t4.require(page.part < max(1, len(self.parts)), place, f"part {page.part} is not there")
        t4.require(self.container.payload_version >= 2 or bands == 0, place, "version 1 knows no bands")
        parts = t4.cut_parts(data, place, [64, 16 * vertices, 8 * edges, 8 * triangles, 12 * triangles, 32 * bands,
                                           8 * intervals])
        page.number, page.entry = number, entry
        page.vertices, page.edges = t4.groups("f", parts[1], 4), t4.groups("I", parts[2], 2)
        page.lifespans, page.triangles = t4.groups("f", parts[3], 2), t4.groups("I", parts[4], 3)
        self._check_vertices(page, place)
        for a, b in page.edges:
            t4.require(max(a, b) < vertices, place, f"edge {a} {b} is out of range")
            t4.require(page.vertices[a][3] < page.vertices[b][3], place, f"edge {a} {b} does not run forward in time")
        page.bands = self._read_bands(page, place, t4.groups("Q", parts[5], 4), t4.groups("I", parts[6], 2))
        self._check_lifespans(page, place)
        for band in page.bands:
            self._check_index(page, place, *band)
        page.values = [self._read_column(page, c, components) for c, (_, components) in enumerate(self.columns)]
        return page

    @staticmethod
    def _read_bands(page, place, bands, index):
        read, triangles, intervals = [], 0, 0
        for first, count, first_interval, interval_count in bands:
            t4.require((first, first_interval) == (triangles, intervals), place, "a band does not follow the one before")
            t4.require(1 <= count < 1 << 32 and interval_count >= 1, place, f"a band of {count}, {interval_count}")
            triangles, intervals = triangles + count, intervals + interval_count
            t4.require(intervals <= len(index), place, "a band's intervals are out of range")
            read.append((first, count, index[first_interval:intervals]))
        t4.require(intervals == len(index), place, "the bands do not hold all intervals")
        t4.require(not bands or triangles == len(page.triangles), place, "the bands do not hold all triangles")
        return read

    @staticmethod
    def _check_index(page, place, first, count, index):
        for i, (low, high) in enumerate(index):
            t4.require(low <= high <= count, place, f"interval {i} has the run {low} {high}")
            t4.require(i == 0 or (index[i - 1][0] <= low and index[i - 1][1] <= high), place, f"interval {i} falls back")
        for k, (begin, end) in enumerate(page.lifespans[first:first + count]):
            last = interval_at(page.entry, len(index), float_below(end)) if end < page.entry.max[3] else len(index) - 1
            for i in range(interval_at(page.entry, len(index), begin), last + 1):
                t4.require(index[i][0] <= k < index[i][1], place, f"triangle {first + k} lives in interval {i}")

    def _read_column(self, page, c, components):
        number = page.number + 1 + c
        place, entry, used = f"page {number}", self.pages.entries[number], 4 * components * len(page.vertices)
        t4.require(entry.kind == 1 + c, place, f"kind {entry.kind}, expected {1 + c}")
        data = self.pages.load(number)
        t4.require(len(data) == max(64, t4.align_up(used, 64)), place, f"{len(data)} bytes")
        t4.require(not any(data[used:]), place, "padding is not zero")
        return t4.groups("f", data[:used], components)

    @staticmethod
    def _check_vertices(page, place):
        for vertex in page.vertices:
            t4.require(all(map(math.isfinite, vertex)), place, "a vertex is not finite")
            for axis in range(3):
                low, high = page.entry.min[axis], page.entry.max[axis]
                t4.require(low <= vertex[axis] <= high, place, "a vertex is out of bounds")

    def _check_lifespans(self, page, place):
        previous = -math.inf
        for triangle, (begin, end) in zip(page.triangles, page.lifespans):
            t4.require(max(triangle) < len(page.edges), place, f"triangle {triangle} is out of range")
            t4.require(len(set(triangle)) == 3, place, f"triangle {triangle} has an edge twice")
            ends = [page.edges[edge] for edge in triangle]
            expected = (max(page.vertices[a][3] for a, _ in ends), min(page.vertices[b][3] for _, b in ends))
            t4.require((begin, end) == expected, place, f"lifespan {begin} {end}, from the edges {expected}")
            t4.require(begin < end, place, f"lifespan {begin} {end} is empty")
            t4.require(page.bands or begin >= previous, place, "triangles are not sorted by the begin of their lives")
            t4.require(page.entry.min[3] <= begin and end <= page.entry.max[3], place, "a lifespan is out of bounds")
            t4.require(end <= self.last_time, place, "a lifespan ends after the last time")
            previous = begin

    def _join(self):
        sums, box = [0, 0, 0], t4.BoxOf()
        for page in self.content:
            for i, items in enumerate((page.vertices, page.edges, page.triangles)):
                sums[i] += len(items)
            for vertex in page.vertices:
                box.add(vertex)
        t4.require(tuple(sums) == self.sums, "section DHDR", f"counts {self.sums}, the pages have {sums}")
        t4.require((self.bounds[:4], self.bounds[4:]) == box.get(), "section DHDR", "bounds are not the vertices' box")

    def slice(self, t):
        """Yields (page, triangle, points) of what is alive at t (frames). Degenerate triangles are kept."""
        for page in self.content:
            for number, (triangle, (begin, end)) in enumerate(zip(page.triangles, page.lifespans)):
                if begin <= t and (t < end or t == end == self.last_time):
                    ends = [page.edges[edge] for edge in triangle]
                    yield page, number, [t4slice.crossing(page.vertices[a], page.vertices[b], t) for a, b in ends]

    def dump(self):
        yield (t4.row("dynamic_triangles vertices edges triangles", self.sums) +
               f" tets {self.tets} frames {self.frames} empty {self.empty} last_time {t4.text32(self.last_time)}")
        yield t4.row("index_to_world", self.index_to_world, t4.text64)
        yield t4.row("bounds", self.bounds, t4.text32)
        yield t4.row("times", self.times, t4.text64)
        for name, components in self.columns:
            yield f"column {components} {name}"
        for isovalue in self.parts:
            yield "part " + t4.text64(isovalue)
        for page in self.content:
            yield t4.entry_line(page.number, page.entry)
            if self.parts:
                yield f"of_part {page.part}"
            for vertex in page.vertices:
                yield t4.row("v", vertex, t4.text32)
            for edge in page.edges:
                yield t4.row("e", edge)
            for triangle, life in zip(page.triangles, page.lifespans):
                yield t4.row("tri", triangle) + " " + t4.row("life", life, t4.text32)
            for first, count, index in page.bands:
                yield f"band {first} {count} intervals {len(index)}"
                for run in index:
                    yield t4.row("alive", run)
            for c, rows in enumerate(page.values):
                yield t4.entry_line(page.number + 1 + c, self.pages.entries[page.number + 1 + c])
                for row in rows:
                    yield t4.row("c", row, t4.text32)

    def dump_slice(self, t):
        yield f"slice at {t4.text32(t)}"
        for page, number, points in self.slice(t):
            yield f"tri {page.number} {number} " + " ".join(t4.text32(c) for point in points for c in point)

    def summary(self):
        names = ("vertices", "edges", "triangles")
        return {"payload": "DYNT", "version": self.container.payload_version,
                "counts": dict(zip(names, self.sums), tets=self.tets, frames=self.frames, empty=self.empty,
                               pages=len(self.content)),
                "bounds": {"min": self.bounds[:4], "max": self.bounds[4:]}, "bytes": len(self.container.data),
                "provenance": self.container.provenance(), "page_digest": self.pages.digest(),
                "digest": t4.digest(self.dump())}


class More:
    """The options beyond --dump."""

    @staticmethod
    def declare(parser):
        parser.add_argument("--slice", type=float, metavar="T", help="print the triangles alive at T frames")

    @staticmethod
    def run(triangles, options):
        if options.slice is None:
            return False
        for line in triangles.dump_slice(t4.f32(options.slice)):
            print(line)
        return True


if __name__ == "__main__":
    sys.exit(t4.main_of(DynamicTriangles, "Proves a dynamic triangles file.", More))
