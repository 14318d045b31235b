#!/usr/bin/python3
"""Slow, readable reader of patch DAG files (.t4p), written from docs/formats/patch_dag.md alone. See t4container.py.

Beside --dump: --cut E prints the tetrahedra, by their corners, of the cut that refines nodes of an error above E.
"""

import math
import struct
import sys

import t4container as t4
from read_hypermesh import COLUMN, Column

HEADER = struct.Struct("<QQQII12d8f8fd3Qd3Q")
NODE = struct.Struct("<QQII2f8f")
PATCH_HEADER = struct.Struct("<8Q")
assert (HEADER.size, NODE.size, PATCH_HEADER.size) == (256, 64, 64)
ON_GRID, INNER_BOUNDARY, STUCK = 1, 2, 1
MOST_VERTICES = 65535


def holds(outer, inner):
    """Whether one box (min, max) lies within another."""
    return all(a <= b for a, b in zip(outer[0], inner[0])) and all(a >= b for a, b in zip(outer[1], inner[1]))


class Node:
    """An item of NODE."""

    def __init__(self, raw):
        self.first, self.patches, self.level, self.flags, self.estimated, self.measured, *box = NODE.unpack(raw)
        self.box = (tuple(box[:4]), tuple(box[4:]))


class Patch:
    """A patch page: vertices, local tetrahedra, the columns' values."""


class PatchDag:
    """A patch DAG, everything in it proved but that cuts are closed."""

    def __init__(self, path):
        self.container = t4.Container(path, "PDAG", 1, ("AHDR", "TIME", "NODE", "COLS", "PAGE", "PTAB"))
        self._read_header()
        self.pages = t4.Pages(self.container)
        self.container.verify()
        self.pages.verify()
        stride = 1 + len(self.columns)
        t4.require(len(self.pages.entries) % stride == 0, "section PTAB", "a page is missing")
        self.patches = [self._read_patch(first) for first in range(0, len(self.pages.entries), stride)]
        self._check_nodes()
        self._check_arcs()
        self._check_sums()

    def _read_header(self):
        place = "section AHDR"
        fields = HEADER.unpack(self.container.single("AHDR", HEADER.size))
        self.vertex_count, self.tet_count, self.frames, self.flags, column_count = fields[:5]
        self.index_to_world, self.domain, self.bounds = fields[5:17], fields[17:25], fields[25:33]
        self.isovalue, node_count, self.patch_count, self.leaf_tets, self.time_scale = fields[33:38]
        t4.require(not any(fields[38:]), place, "reserved field is not zero")
        t4.require(self.flags & ~(ON_GRID | INNER_BOUNDARY) == 0, place, f"unknown flags {self.flags:#x}")
        t4.require(not math.isinf(self.isovalue), place, "isovalue is infinite")
        t4.require(math.isfinite(self.time_scale) and self.time_scale > 0, place, f"time scale {self.time_scale}")
        t4.check_map(self.index_to_world, place)
        t4.check_bounds(self.domain[:4], self.domain[4:], place)
        t4.check_bounds(self.bounds[:4], self.bounds[4:], place)
        self.times = t4.check_timeline(self.container.content("TIME", 8))
        t4.require(1 <= self.frames == len(self.times), "section TIME", f"{len(self.times)} for {self.frames} frames")
        raw = self.container.content("NODE", NODE.size)
        self.nodes = [Node(raw[at:at + NODE.size]) for at in range(0, len(raw), NODE.size)]
        t4.require(len(self.nodes) == node_count, "section NODE", f"not the header's {node_count} nodes")
        t4.require(len(self.nodes) >= 2, "section NODE", "no source and no sink")
        raw = self.container.content("COLS", COLUMN.size) if self.container.find("COLS") else b""
        self.columns = [Column(raw[at:at + COLUMN.size]) for at in range(0, len(raw), COLUMN.size)]
        t4.require(len(self.columns) == column_count, "section COLS", f"not the header's {column_count} columns")
        names = [column.name for column in self.columns]
        t4.require(len(set(names)) == len(names), "section COLS", "two columns have the same name")

    def _read_patch(self, number):
        place, entry, patch = f"page {number}", self.pages.entries[number], Patch()
        t4.require(entry.kind == 0, place, f"kind {entry.kind}, expected a patch")
        data = self.pages.load(number)
        t4.require(len(data) >= PATCH_HEADER.size, place, "shorter than its header")
        patch.number, patch.entry = number, entry
        count, tets, patch.shared, patch.source, patch.target, *reserved = PATCH_HEADER.unpack_from(data)
        t4.require(not any(reserved), place, "reserved field is not zero")
        t4.require(entry.counts == (count, tets, patch.source, patch.target), place, "counts differ from the page table's")
        t4.require(1 <= count <= MOST_VERTICES and tets >= 1, place, f"{count} vertices, {tets} tetrahedra")
        t4.require(patch.shared <= count, place, "shares more vertices than it has")
        _, vertices, tet_bytes = t4.cut_parts(data, place, [64, 16 * count, 8 * tets])
        patch.vertices = t4.groups("f", vertices, 4)
        t4.require(all(map(math.isfinite, sum(patch.vertices, ()))), place, "a vertex is not finite")
        patch.tets = t4.groups("H", tet_bytes, 4)
        for tet in patch.tets:
            t4.require(max(tet) < count, place, f"tetrahedron {tet} is out of range")
            t4.require(len(set(tet)) == 4, place, f"tetrahedron {tet} has a vertex twice")
        box = t4.BoxOf()
        for point in patch.vertices:
            box.add(point)
        t4.require((tuple(entry.min), tuple(entry.max)) == box.get(), place, "bounds are not the vertices' box")
        patch.values = [self._read_column(patch, c, column) for c, column in enumerate(self.columns)]
        return patch

    def _read_column(self, patch, c, column):
        number = patch.number + 1 + c
        place, entry, used = f"page {number}", self.pages.entries[number], 4 * column.components * len(patch.vertices)
        t4.require(entry.kind == 1 + c, place, f"kind {entry.kind}, expected {1 + c}")
        data = self.pages.load(number)
        t4.require(len(data) == max(64, t4.align_up(used, 64)), place, f"{len(data)} bytes for a column")
        t4.require(not any(data[used:]), place, "padding is not zero")
        return t4.groups("f", data[:used], column.components)

    def _check_nodes(self):
        first, measured = 0, self.nodes[0].measured != -1
        for i, node in enumerate(self.nodes):
            place, is_sink = f"section NODE: node {i}", i + 1 == len(self.nodes)
            t4.require(node.flags & ~STUCK == 0, place, f"unknown flags {node.flags:#x}")
            t4.require(math.isfinite(node.estimated) and node.estimated >= 0, place, f"error {node.estimated}")
            if measured or is_sink:
                t4.require(math.isfinite(node.measured) and node.measured >= 0, place, f"measured {node.measured}")
            else:
                t4.require(node.measured == -1, place, f"measured {node.measured}, where others are not")
            t4.check_bounds(node.box[0], node.box[1], place)
            if is_sink:
                t4.require(not any((node.level, node.flags, node.estimated, node.measured, node.patches)), place,
                           "a sink with a level, flags, errors or patches")
                t4.require(not any(node.box[0] + node.box[1]), place, "a sink with bounds")
            else:
                t4.require(node.level >= 1, place, "the sink's level")
                t4.require(node.patches >= 1 or not self.patches, place, "no patches")
            t4.require(node.first == first, place, f"first patch {node.first}, expected {first}")
            first += node.patches
        t4.require(first == len(self.patches) == self.patch_count, "section NODE", "not as many patches as there are")
        t4.require(self.patches or len(self.nodes) == 2, "section NODE", "nodes without a patch")

    def _check_arcs(self):
        sink = len(self.nodes) - 1
        for p, patch in enumerate(self.patches):
            place = f"page {patch.number}"
            t4.require(patch.source < patch.target <= sink, place, f"arc {patch.source} to {patch.target}")
            upper, lower, box = self.nodes[patch.source], self.nodes[patch.target], (patch.entry.min, patch.entry.max)
            t4.require(upper.first <= p < upper.first + upper.patches, place, f"not among the patches of {patch.source}")
            t4.require(lower.level < upper.level, place, "levels do not go down")
            t4.require(lower.estimated <= upper.estimated, place, "the estimated error grows downwards")
            errors = (patch.entry.error_estimated, patch.entry.error_measured)
            t4.require(errors == (lower.estimated, lower.measured), place, "errors are not its lower node's")
            t4.require(holds(upper.box, box), place, "outside the upper node's bounds")
            if patch.target != sink:
                t4.require(lower.measured <= upper.measured, place, "the measured error grows downwards")
                t4.require(holds(upper.box, lower.box) and holds(lower.box, box), place, "bounds are not nested")
        reached = {patch.target for patch in self.patches}
        t4.require(not self.patches or len(reached) == sink, "section NODE", "a node that no patch ends in")

    def _check_sums(self):
        place, sink, box = "section AHDR", len(self.nodes) - 1, t4.BoxOf()
        t4.require(self.vertex_count == sum(len(p.vertices) for p in self.patches), place, "vertices are not the sum")
        t4.require(self.tet_count == sum(len(p.tets) for p in self.patches), place, "tetrahedra are not the sum")
        leaves = sum(len(p.tets) for p in self.patches if p.target == sink)
        t4.require(self.leaf_tets == leaves, place, f"leaf_tets {self.leaf_tets}, the patches have {leaves}")
        for patch in self.patches:
            for point in patch.vertices:
                box.add(point)
        t4.require((self.bounds[:4], self.bounds[4:]) == box.get(), place, "bounds are not the vertices' box")

    def cut(self, error):
        """The patches of the cut that refines what has a larger estimated error."""
        sink = len(self.nodes) - 1
        refined = [i == 0 or (i != sink and node.estimated > error) for i, node in enumerate(self.nodes)]
        return [patch for patch in self.patches if refined[patch.source] and not refined[patch.target]]

    def dump(self):
        yield (f"patch_dag vertices {self.vertex_count} tets {self.tet_count} frames {self.frames} flags {self.flags} "
               f"columns {len(self.columns)} nodes {len(self.nodes)} patches {len(self.patches)} "
               f"leaf_tets {self.leaf_tets}")
        yield t4.row("index_to_world", self.index_to_world, t4.text64)
        yield t4.row("domain", self.domain, t4.text32)
        yield t4.row("bounds", self.bounds, t4.text32)
        yield t4.row("isovalue", [self.isovalue], t4.text64)
        yield t4.row("time_scale", [self.time_scale], t4.text64)
        yield t4.row("times", self.times, t4.text64)
        for column in self.columns:
            yield f"column {column.components} {column.name}"
        for i, node in enumerate(self.nodes):
            yield (f"node {i} patches {node.first} {node.patches} level {node.level} flags {node.flags} "
                   + t4.row("errors", (node.estimated, node.measured), t4.text32) + " "
                   + t4.row("min", node.box[0], t4.text32) + " " + t4.row("max", node.box[1], t4.text32))
        for patch in self.patches:
            yield t4.entry_line(patch.number, patch.entry)
            yield f"shared {patch.shared}"
            for vertex in patch.vertices:
                yield t4.row("v", vertex, t4.text32)
            for tet in patch.tets:
                yield t4.row("tet", tet)
            for c, values in enumerate(patch.values):
                yield t4.entry_line(patch.number + 1 + c, self.pages.entries[patch.number + 1 + c])
                for value in values:
                    yield t4.row("c", value, t4.text32)

    def summary(self):
        return {"payload": "PDAG", "version": self.container.payload_version,
                "counts": {"vertices": self.vertex_count, "tets": self.tet_count, "frames": self.frames,
                           "nodes": len(self.nodes), "patches": len(self.patches), "leaf_tets": self.leaf_tets},
                "columns": [column.name for column in self.columns],
                "bounds": {"min": self.bounds[:4], "max": self.bounds[4:]}, "bytes": len(self.container.data),
                "provenance": self.container.provenance(), "page_digest": self.pages.digest(),
                "digest": t4.digest(self.dump())}


class More:
    """The options beyond --dump."""

    @staticmethod
    def declare(parser):
        parser.add_argument("--cut", type=float, metavar="E", help="print the cut that refines errors above E")

    @staticmethod
    def run(dag, options):
        if options.cut is None:
            return False
        for patch in dag.cut(options.cut):
            for tet in patch.tets:
                print("tet", *(t4.text32(number) for i in tet for number in patch.vertices[i]))
        return True


if __name__ == "__main__":
    sys.exit(t4.main_of(PatchDag, "Proves a patch DAG file.", More))
