#!/usr/bin/python3
"""Slow, readable reader of grid4 files (.t4g), written from docs/formats/grid4.md alone. See t4container.py."""

import struct
import sys

import t4container as t4

HEADER = struct.Struct("<4QII12d7Q")
assert HEADER.size == 192
# sample type → name, struct code
SAMPLES = {1: ("u8", "B"), 2: ("i8", "b"), 3: ("u16", "H"), 4: ("i16", "h"), 5: ("u32", "I"), 6: ("i32", "i"),
           7: ("u64", "Q"), 8: ("i64", "q"), 9: ("f32", "f"), 10: ("f64", "d")}
SAMPLE_TEXT = {"f32": t4.text32, "f64": t4.text64}


class Grid4:
    """A grid4 file, everything in it proved."""

    def __init__(self, path):
        self.container = t4.Container(path, "GRD4", 1, ("GHDR", "TIME", "PAGE", "PTAB"))
        fields = HEADER.unpack(self.container.single("GHDR", HEADER.size))
        self.dims, self.frames = fields[0:3], fields[3]
        sample_type, reserved, self.index_to_world = fields[4], fields[5:6] + fields[18:], fields[6:18]
        place = "section GHDR"
        t4.require(not any(reserved), place, "reserved field is not zero")
        t4.require(sample_type in SAMPLES, place, f"sample type {sample_type}")
        self.sample_type, self.code = SAMPLES[sample_type]
        t4.require(all(n >= 1 for n in self.dims), place, f"dims {self.dims}")
        self.voxels = self.dims[0] * self.dims[1] * self.dims[2]
        self.frame_bytes = self.voxels * struct.calcsize(self.code)
        t4.require(self.frame_bytes <= t4.MAX_PAGE_BYTES, place, "a frame has more than 2^36 bytes")
        t4.check_map(self.index_to_world, place)
        self.times = t4.check_timeline(self.container.content("TIME", 8))
        t4.require(1 <= self.frames == len(self.times), "section TIME", f"{len(self.times)} for {self.frames} frames")
        self.pages = t4.Pages(self.container)
        t4.require(len(self.pages.entries) == self.frames, "section PTAB", "not one page a frame")
        for k, entry in enumerate(self.pages.entries):
            place = f"page {k}"
            t4.require(entry.kind == 0 and entry.raw_bytes == self.frame_bytes, place, "not a frame")
            t4.require(entry.counts == (k, self.voxels, 0, 0), place, f"counts {entry.counts}")
            low = (0.0, 0.0, 0.0, t4.f32(k))
            high = tuple(t4.f32(n - 1) for n in self.dims) + (t4.f32(k),)
            t4.require((entry.min, entry.max) == (low, high), place, "bounds are not the grid's box")
        self.container.verify()
        self.pages.verify()

    def frame(self, k):
        """Samples of frame k, x fastest."""
        return [value for (value,) in t4.groups(self.code, self.pages.load(k), 1)]

    def dump(self):
        yield t4.row("grid4 dims", self.dims) + f" frames {self.frames} type {self.sample_type}"
        yield t4.row("index_to_world", self.index_to_world, t4.text64)
        yield t4.row("times", self.times, t4.text64)
        for k, entry in enumerate(self.pages.entries):
            yield t4.entry_line(k, entry)
            yield t4.row("samples", self.frame(k), SAMPLE_TEXT.get(self.sample_type, str))

    def summary(self):
        last = [n - 1 for n in self.dims] + [self.frames - 1]
        return {"payload": "GRD4", "version": self.container.payload_version,
                "counts": {"frames": self.frames, "voxels": self.voxels}, "sample_type": self.sample_type,
                "bounds": {"min": [0, 0, 0, 0], "max": last}, "bytes": len(self.container.data),
                "provenance": self.container.provenance(), "page_digest": self.pages.digest(),
                "digest": t4.digest(self.dump())}


if __name__ == "__main__":
    sys.exit(t4.main_of(Grid4, "Proves a grid4 file."))
