#!/usr/bin/python3
"""Slow, readable reader of the tet4d container and of pages, written from docs/formats/{container,paged}.md alone.

As a program: `t4container.py FILE` proves structure, checksums and padding, and prints a JSON summary.
As a module: Container proves and hands out sections; Pages proves and hands out decoded pages. Needs python3-xxhash, and
python3-zstandard for compressed pages.
"""

import json
import math
import struct
import sys

import xxhash

MAGIC = b"T4D\r\n\x1a\n\0"
ENDIAN_MARK = 0x01020304
CONTAINER_VERSION = 1
ALIGNMENT = 64
PAGE_ALIGNMENT = 4096
REQUIRED, PAGED = 1, 2
RAW, ZSTD = 0, 1
MAX_PAGE_BYTES = 1 << 36
MAX_ZSTD_RATIO = 1 << 15  # a block of at least 4 bytes decodes to at most 128 KiB

HEADER = struct.Struct("<8sIHHIIQQQQQ")
SECTION = struct.Struct("<IIQQQIIQQQ")
PAGE_ENTRY = struct.Struct("<QQQQII4f4fff4Q2Q")
assert (HEADER.size, SECTION.size, PAGE_ENTRY.size) == (64, 64, 128)


class FormatError(Exception):
    """A file breaks a rule of docs/formats: where, and what."""

    def __init__(self, place, what):
        super().__init__(f"{place}: {what}")
        self.place, self.what = place, what


def require(condition, place, what):
    if not condition:
        raise FormatError(place, what)


def fourcc(text):
    return struct.unpack("<I", text.encode("latin-1"))[0]


def fourcc_text(code):
    return struct.pack("<I", code).decode("latin-1")


def xxh3(data):
    return xxhash.xxh3_64_intdigest(data)


def align_up(value, step):
    return -(-value // step) * step


class Section:
    def __init__(self, raw):
        (kind, self.flags, self.offset, self.bytes, self.item_count, self.item_bytes, self.reserved0, self.xxh3,
         *self.reserved1) = SECTION.unpack(raw)
        self.kind = fourcc_text(kind)

    @property
    def end(self):
        return self.offset + self.bytes


class Container:
    """A whole file in memory, its structure proved."""

    def __init__(self, path, payload=None, max_payload_version=None, known=None):
        """known: the section kinds (four letters) the caller understands; None: takes every file as it is."""
        with open(path, "rb") as file:
            self.data = file.read()
        self.path = path
        self._read_header(payload, max_payload_version)
        self._read_table(known)

    def _read_header(self, payload, max_payload_version):
        place = "header"
        require(len(self.data) >= HEADER.size, place, f"file has {len(self.data)} bytes, the header takes 64")
        (magic, endian, version, self.payload_version, payload_code, self.section_count, file_bytes, self.table_offset,
         self.table_xxh3, reserved, header_xxh3) = HEADER.unpack_from(self.data)
        self.payload = fourcc_text(payload_code)
        require(magic == MAGIC, place, "not a tet4d file")
        require(endian == ENDIAN_MARK, place, f"endian mark {endian:#x}")
        require(version == CONTAINER_VERSION, place, f"container version {version}")
        require(xxh3(self.data[:56]) == header_xxh3, place, "checksum differs")
        require(reserved == 0, place, "reserved field is not zero")
        require(file_bytes == len(self.data), place, f"says {file_bytes} bytes, file has {len(self.data)}")
        if payload is not None:
            require(self.payload == payload, place, f"payload {self.payload!r}, expected {payload!r}")
        require(self.payload_version >= 1, place, "payload version 0")
        if max_payload_version is not None:
            require(self.payload_version <= max_payload_version, place, f"payload version {self.payload_version}")

    def _read_table(self, known):
        place = "section table"
        end = self.table_offset + self.section_count * SECTION.size
        require(self.table_offset % ALIGNMENT == 0, place, f"offset {self.table_offset} is not a multiple of 64")
        require(self.table_offset >= HEADER.size and end <= len(self.data), place, "outside the file")
        table = self.data[self.table_offset:end]
        require(xxh3(table) == self.table_xxh3, place, "checksum differs")
        self.sections = [Section(table[at:at + SECTION.size]) for at in range(0, len(table), SECTION.size)]
        for section in self.sections:
            self._prove_section(section, known)
        kinds = [section.kind for section in self.sections]
        require(len(set(kinds)) == len(kinds), place, "a kind stands twice")
        # Ranges in use, in order; their complement is padding.
        self.used = sorted([(0, HEADER.size), (self.table_offset, end)] +
                           [(s.offset, s.end) for s in self.sections if s.bytes > 0])
        for (_, before_end), (after, _) in zip(self.used, self.used[1:]):
            require(before_end <= after, place, f"two ranges overlap at byte {after}")

    def _prove_section(self, section, known):
        place = f"section {section.kind}"
        require(section.flags & ~(REQUIRED | PAGED) == 0, place, f"unknown flags {section.flags:#x}")
        require(section.reserved0 == 0 and not any(section.reserved1), place, "reserved field is not zero")
        require(section.item_bytes >= 1, place, "item_bytes is 0")
        require(section.bytes == section.item_bytes * section.item_count, place, "bytes is not items times item size")
        step = PAGE_ALIGNMENT if section.flags & PAGED else ALIGNMENT
        require(section.offset % step == 0, place, f"offset {section.offset} is not a multiple of {step}")
        require(section.offset >= HEADER.size and section.end <= len(self.data), place, "outside the file")
        if section.flags & PAGED:
            require(section.xxh3 == 0, place, "a page section has a checksum")
        if known is not None and section.flags & REQUIRED:
            require(section.kind in known or section.kind == "PROV", place, "required, and not known to this reader")

    def find(self, kind):
        return next((section for section in self.sections if section.kind == kind), None)

    def content(self, kind, item_bytes):
        """The checked bytes of a section that must be there."""
        section = self.find(kind)
        require(section is not None, f"section {kind}", "missing")
        require(section.item_bytes == item_bytes, f"section {kind}", f"items of {section.item_bytes} bytes")
        require(not section.flags & PAGED, f"section {kind}", "is marked as paged, which leaves it without a checksum")
        self.verify_section(section)
        return self.data[section.offset:section.end]

    def single(self, kind, item_bytes):
        content = self.content(kind, item_bytes)
        require(len(content) == item_bytes, f"section {kind}", "must hold exactly one item")
        return content

    def verify_section(self, section):
        if not section.flags & PAGED:
            content = self.data[section.offset:section.end]
            require(xxh3(content) == section.xxh3, f"section {section.kind}", "checksum differs")

    def verify(self):
        """Checksums of all sections, and zeros in every byte that belongs to none."""
        for section in self.sections:
            self.verify_section(section)
        ends = [end for _, end in self.used]
        for start, stop in zip(ends, [start for start, _ in self.used[1:]] + [len(self.data)]):
            require(not any(self.data[start:stop]), f"byte {start}", "padding is not zero")

    def provenance(self):
        section = self.find("PROV")
        if section is None:
            return {}
        return json.loads(self.content("PROV", 1).decode("utf-8") or "{}")


class PageEntry:
    def __init__(self, raw):
        fields = PAGE_ENTRY.unpack(raw)
        self.offset, self.bytes, self.raw_bytes, self.xxh3, self.codec, self.kind = fields[:6]
        self.min, self.max = fields[6:10], fields[10:14]
        self.error_estimated, self.error_measured = fields[14:16]
        self.counts, self.reserved = fields[16:20], fields[20:22]


class Pages:
    """The page table of a container, proved, and its pages, decoded."""

    def __init__(self, container):
        self.container = container
        section = container.find("PAGE")
        require(section is not None, "section PAGE", "missing")
        require(section.flags & PAGED, "section PAGE", "is not marked as paged")
        require(section.item_bytes == 1, "section PAGE", f"items of {section.item_bytes} bytes")
        self.section = section
        table = container.content("PTAB", PAGE_ENTRY.size)
        self.entries = [PageEntry(table[at:at + PAGE_ENTRY.size]) for at in range(0, len(table), PAGE_ENTRY.size)]
        end = section.offset
        for number, entry in enumerate(self.entries):
            self._prove(entry, f"page {number}", end)
            end = entry.offset + entry.bytes

    def _prove(self, entry, place, previous_end):
        require(not any(entry.reserved), place, "reserved field is not zero")
        require(entry.codec in (RAW, ZSTD), place, f"codec {entry.codec}")
        require(entry.offset % PAGE_ALIGNMENT == 0, place, f"offset {entry.offset} is not a multiple of 4096")
        require(entry.offset >= previous_end, place, "overlaps the page before, or stands out of order")
        require(entry.offset + entry.bytes <= self.section.end, place, "outside section PAGE")
        for size in (entry.bytes, entry.raw_bytes):
            require(1 <= size <= MAX_PAGE_BYTES, place, f"size {size} is not in 1 .. 2^36")
        if entry.codec == RAW:
            require(entry.raw_bytes == entry.bytes, place, "a raw page with two sizes")
        else:
            require(entry.raw_bytes // MAX_ZSTD_RATIO <= entry.bytes, place, "claims more than zstd can decode to")
        for low, high in zip(entry.min, entry.max):
            require(math.isfinite(low) and math.isfinite(high) and low <= high, place, f"bounds {low} .. {high}")
        for error in (entry.error_estimated, entry.error_measured):
            require(math.isfinite(error) and (error >= 0 or error == -1), place, f"error {error}")

    def load(self, number):
        entry, place = self.entries[number], f"page {number}"
        stored = self.container.data[entry.offset:entry.offset + entry.bytes]
        require(xxh3(stored) == entry.xxh3, place, "checksum differs")
        if entry.codec == RAW:
            return stored
        import zstandard
        try:
            size = zstandard.frame_content_size(stored)
            require(size == entry.raw_bytes, place, f"zstd says {size} bytes, expected {entry.raw_bytes}")
            decoder = zstandard.ZstdDecompressor().decompressobj()
            raw = decoder.decompress(stored)
        except zstandard.ZstdError as error:
            raise FormatError(place, str(error)) from error
        require(decoder.eof and not decoder.unused_data, place, "not exactly one zstd frame")
        require(len(raw) == entry.raw_bytes, place, f"decodes to {len(raw)} bytes, expected {entry.raw_bytes}")
        return raw

    def verify(self):
        """All checksums, and zeros between pages."""
        end = self.section.offset
        for number, entry in enumerate(self.entries):
            self.load(number)
            require(not any(self.container.data[end:entry.offset]), f"page {number}", "padding before it is not zero")
            end = entry.offset + entry.bytes
        require(not any(self.container.data[end:self.section.end]), "section PAGE", "padding at its end is not zero")

    def digest(self):
        """Of the decoded pages in order: the checksum of their checksums."""
        sums = [xxh3(self.load(number)) for number in range(len(self.entries))]
        return "%016x" % xxh3(struct.pack(f"<{len(sums)}Q", *sums))


def cut_parts(data, place, sizes):
    """A page's parts, one behind the other, each padded with zeros to 64 bytes; nothing may follow the last."""
    parts, at = [], 0
    for size in sizes:
        end = align_up(at + size, ALIGNMENT)
        require(end <= len(data), place, f"has {len(data)} bytes, its parts need more")
        require(not any(data[at + size:end]), place, "padding of a part is not zero")
        parts.append(data[at:at + size])
        at = end
    require(at == len(data), place, f"has {len(data)} bytes, its parts take {at}")
    return parts


def groups(kind, data, width):
    """Items of `width` numbers of struct code `kind`, as tuples."""
    return list(struct.iter_unpack(f"<{width}{kind}", data))


def f32(value):
    """Rounds to float32. One operation on float32 values in float64 and then this is exactly the float32 operation."""
    try:
        return struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)


def text32(value):
    return "nan" if math.isnan(value) else "%.9g" % value


def text64(value):
    return "nan" if math.isnan(value) else "%.17g" % value


def row(name, values, text=str):
    return " ".join([name] + [text(value) for value in values])


def entry_line(number, entry):
    """What a page entry says apart from where and how the page is stored."""
    return " ".join([row(f"page {number} kind {entry.kind} min", entry.min, text32), row("max", entry.max, text32),
                     row("errors", (entry.error_estimated, entry.error_measured), text32),
                     row("counts", entry.counts)])


def digest(lines):
    """XXH3-64 of the dump: every line as UTF-8 with a newline behind."""
    state = xxhash.xxh3_64()
    for line in lines:
        state.update((line + "\n").encode("utf-8"))
    return "%016x" % state.intdigest()


def check_timeline(content):
    times = [time for (time,) in groups("d", content, 1)]
    require(all(math.isfinite(time) for time in times), "section TIME", "a time is not finite")
    require(all(a < b for a, b in zip(times, times[1:])), "section TIME", "times do not increase strictly")
    return times


def check_map(values, place):
    """Twelve f64: origin, then the world vectors of one step along x, y, z. Returns the determinant of the axes."""
    require(all(math.isfinite(value) for value in values), place, "index_to_world is not finite")
    a, b, c = values[3:6], values[6:9], values[9:12]
    volume = (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
              a[2] * (b[0] * c[1] - b[1] * c[0]))
    require(math.isfinite(volume) and volume != 0, place, "index_to_world is degenerate")
    return volume


def check_bounds(low, high, place):
    for a, b in zip(low, high):
        require(math.isfinite(a) and math.isfinite(b) and a <= b, place, f"bounds {a} .. {b}")


class BoxOf:
    """The box of the points added; all zero if there are none."""

    def __init__(self):
        self.low = self.high = None

    def add(self, point):
        self.low = point if self.low is None else tuple(map(min, self.low, point))
        self.high = point if self.high is None else tuple(map(max, self.high, point))

    def get(self):
        zero = (0.0,) * 4
        return (zero, zero) if self.low is None else (self.low, self.high)


def main_of(read, description, more=None):
    """The command line all readers share: FILE, --dump, and what `more` adds. Exit 3 for a bad file."""
    import argparse
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("file")
    parser.add_argument("--dump", action="store_true", help="print the decoded content as lines of text")
    if more:
        more.declare(parser)
    options = parser.parse_args()
    try:
        payload = read(options.file)
        if more and more.run(payload, options):
            return 0
        if options.dump:
            for line in payload.dump():
                print(line)
        else:
            print(json.dumps(payload.summary(), indent=1))
    except FormatError as error:
        print(f"{parser.prog}: {options.file}: {error}", file=sys.stderr)
        return 3
    except OSError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    return 0


class AnyFile:
    """A file of any payload, with all that container and pages alone can prove."""

    def __init__(self, path):
        self.container = Container(path)
        self.container.verify()
        self.pages = Pages(self.container) if self.container.find("PTAB") else None
        if self.pages:
            self.pages.verify()

    def summary(self):
        box = self.container
        return {"payload": box.payload, "version": box.payload_version, "bytes": len(box.data),
                "sections": [{"kind": s.kind, "bytes": s.bytes} for s in box.sections],
                "pages": len(self.pages.entries) if self.pages else 0, "provenance": box.provenance(),
                "digest": digest(self.dump())}

    def dump(self):
        for section in self.container.sections:
            yield f"section {section.kind} flags {section.flags} items {section.item_count} of {section.item_bytes}"
        for number, entry in enumerate(self.pages.entries if self.pages else []):
            yield entry_line(number, entry)


if __name__ == "__main__":
    sys.exit(main_of(AnyFile, "Proves the container and pages of a tet4d file."))
