#include <cstring>
#include <limits>

#include "formats/dynamic_triangles.h"
#include "formats/grid4.h"
#include "formats/hypermesh.h"
#include "formats/surface_sequence.h"
#include "tests/formats/support/bad_files.h"

namespace tet4d::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
constexpr double kNan64 = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();

std::vector<BadFile> badGrids() {
  const auto header = [](std::string name, std::string what, auto forge) {
    return BadFile{
        "grid_" + name + ".t4g", "grid_u8.t4g",   true,
        "section GHDR",          std::move(what), [=](Image& i) { forge(i.item<grid4::GridHeader>(grid4::kHeader)); }};
  };
  const auto time = [](std::string name, std::string what, auto forge) {
    return BadFile{"grid_" + name + ".t4g", "grid_u8.t4g",   true,
                   "section TIME",          std::move(what), [=](Image& i) { forge(i); }};
  };
  using H = grid4::GridHeader;
  return {
      header("dims_0", "size", [](H& h) { h.dims[2] = 0; }),
      header("dims_huge", "size", [](H& h) { h.dims[0] = kHuge; }),
      // 2^32 * 2^32 * 3 samples are none if the product may wrap.
      header("dims_wrap", "size", [](H& h) { h.dims[0] = h.dims[1] = std::uint64_t{1} << 32; }),
      header("type_0", "type", [](H& h) { h.sample_type = 0; }),
      header("type_11", "type", [](H& h) { h.sample_type = 11; }),
      header("reserved0", "reserved", [](H& h) { h.reserved0 = 1; }),
      header("reserved1", "reserved", [](H& h) { h.reserved1[6] = 1; }),
      header("map_nan", "map", [](H& h) { h.index_to_world.origin[1] = kNan64; }),
      header("map_flat", "map", [](H& h) { h.index_to_world.axes[0] = h.index_to_world.axes[1]; }),
      time("frames", "times for", [](Image& i) { i.item<H>(grid4::kHeader).frames = 3; }),
      time("times_nan", "finite", [](Image& i) { i.item<double>(grid4::kTimes, 1) = kNan64; }),
      time("times_equal", "after", [](Image& i) { i.item<double>(grid4::kTimes, 1) = i.item<double>(grid4::kTimes); }),
      time("times_none", "times for",
           [](Image& i) {
             i.sectionOf(grid4::kTimes).bytes = i.sectionOf(grid4::kTimes).item_count = 0;
             i.item<H>(grid4::kHeader).frames = 0;
           }),
      BadFile{"grid_page_missing.t4g", "grid_u8.t4g", true, "section PTAB", "one page a frame",
              [](Image& i) {
                i.sectionOf(paged::kPageTable).item_count -= 1;
                i.sectionOf(paged::kPageTable).bytes -= 128;
              }},
      BadFile{"grid_dims_other.t4g", "grid_u8.t4g", true, "section PTAB", "frame",
              [](Image& i) { i.item<H>(grid4::kHeader).dims[0] = 4; }},
  };
}

// Offsets inside page 0 of mesh.t4h: 9 vertices, 1 run, 24 tetrahedra, 9 foreign vertices (numbers 9 .. 17).
constexpr std::uint64_t kMeshVertices = 64, kMeshRuns = 64 + 9 * 16 + 48, kMeshTets = kMeshRuns + 64;

std::vector<BadFile> badMeshHeaders() {
  const auto header = [](std::string name, std::string what, auto forge, std::string place = "section HHDR") {
    return BadFile{"mesh_" + name + ".t4h",
                   "mesh.t4h",
                   true,
                   std::move(place),
                   std::move(what),
                   [=](Image& i) { forge(i.item<hypermesh::MeshHeader>(hypermesh::kHeader)); }};
  };
  using H = hypermesh::MeshHeader;
  std::vector<BadFile> all{
      header("header_reserved", "reserved", [](H& h) { h.reserved[0] = 1; }),
      header("header_flags", "flags", [](H& h) { h.flags |= 8; }),
      header("header_map", "map", [](H& h) { h.index_to_world.axes = {}; }),
      header("header_domain", "domain", [](H& h) { std::swap(h.domain.min, h.domain.max); }),
      header("header_bounds_nan", "bounds", [](H& h) { h.bounds.min.x = kNan; }),
      header("header_isovalue", "isovalue", [](H& h) { h.isovalue = -std::numeric_limits<double>::infinity(); }),
      header("header_vertices", "sums", [](H& h) { h.vertices += 1; }),
      header("header_tets", "sums", [](H& h) { h.tets -= 1; }),
      header(
          "header_columns", "columns", [](H& h) { h.columns = 1; }, "section COLS"),
      header(
          "header_frames", "times for", [](H& h) { h.frames = kHuge; }, "section TIME"),
  };
  all.push_back({"mesh_header_box.t4h", "mesh.t4h", false, "section HHDR", "box of the vertices",
                 [](Image& i) { i.item<H>(hypermesh::kHeader).bounds.max.x += 1; }});
  const auto column = [&](std::string name, std::string what, auto forge) {
    all.push_back({"mesh_column_" + name + ".t4h", "mesh_columns.t4h", true, "section COLS", std::move(what),
                   [=](Image& i) { forge(i.item<hypermesh::ColumnEntry>(hypermesh::kColumns, 1)); }});
  };
  using C = hypermesh::ColumnEntry;
  column("no_name", "name", [](C& c) { std::memset(c.name, 0, sizeof c.name); });
  column("endless_name", "name", [](C& c) { std::memset(c.name, 'n', sizeof c.name); });
  column("name_and_more", "name", [](C& c) { c.name[40] = 'x'; });
  column("same_name", "same name", [](C& c) { std::strncpy(c.name, "pressure", sizeof c.name); });
  column("components_0", "components", [](C& c) { c.components = 0; });
  column("components_5", "components", [](C& c) { c.components = 5; });
  column("reserved", "reserved", [](C& c) { c.reserved = 1; });
  const auto part = [&](std::string name, std::string place, std::string what, auto forge) {
    all.push_back({"mesh_part_" + name + ".t4h", "mesh_parts.t4h", true, std::move(place), std::move(what), forge});
  };
  using P = hypermesh::PartEntry;
  part("infinite", "section PART", "infinite",
       [](Image& i) { i.item<P>(hypermesh::kParts, 0).isovalue = std::numeric_limits<double>::infinity(); });
  part("reserved", "section PART", "reserved", [](Image& i) { i.item<P>(hypermesh::kParts, 1).reserved[2] = 1; });
  part("count", "section PART", "the header says", [](Image& i) { i.item<H>(hypermesh::kHeader).parts = 3; });
  part("missing", "section PART", "the header says", [](Image& i) { i.item<H>(hypermesh::kHeader).parts = 0; });
  part("version", "section PART", "version 1", [](Image& i) { i.header().payload_version = 1; });
  all.push_back({"mesh_part_page.t4h", "mesh_parts.t4h", false, "page 0", "part that is not there",
                 [](Image& i) { i.inPage<hypermesh::PageHeader>(0, 0).part = 2; }});
  all.push_back({"mesh_column_size.t4h", "mesh_columns.t4h", true, "section PTAB", "size",
                 [](Image& i) { i.item<C>(hypermesh::kColumns, 1).components = 1; }});
  all.push_back(
      {"mesh_column_kind.t4h", "mesh_columns.t4h", true, "section PTAB", "kind", [](Image& i) { i.page(2).kind = 1; }});
  all.push_back({"mesh_column_padding.t4h", "mesh_columns.t4h", false, "page 1", "padding",
                 [](Image& i) { i.inPage<char>(1, 8 * 4) = 1; }});
  all.push_back({"mesh_column_page_missing.t4h", "mesh_columns.t4h", true, "section PTAB", "missing", [](Image& i) {
                   i.sectionOf(paged::kPageTable).item_count -= 1;
                   i.sectionOf(paged::kPageTable).bytes -= 128;
                 }});
  return all;
}

std::vector<BadFile> badMeshPages() {
  const auto table = [](std::string name, std::string what, std::string place, auto forge) {
    return BadFile{"mesh_" + name + ".t4h", "mesh.t4h", true, std::move(place), std::move(what), forge};
  };
  const auto page = [](std::string name, std::string what, auto forge) {
    return BadFile{"mesh_page_" + name + ".t4h", "mesh.t4h", false, "page 0", std::move(what), forge};
  };
  using hypermesh::PageHeader, hypermesh::Run, hypermesh::Tet;
  // Says `runs` runs with the same bytes of the page: the place of the tetrahedra after one run or up to four is the
  // same.
  const auto runs = [](Image& i, std::uint64_t first_count, std::uint64_t second, std::uint64_t second_count) {
    i.inPage<PageHeader>(0, 0).runs = 2;
    i.inPage<Run>(0, kMeshRuns) = {9, first_count};
    i.inPage<Run>(0, kMeshRuns + 16) = {second, second_count};
  };
  const auto foreign = [](Image& i, std::uint64_t n) { i.inPage<PageHeader>(0, 0).foreign = i.page(0).counts[3] = n; };
  return {
      table("pages_first", "vertex numbers", "section PTAB", [](Image& i) { i.page(1).counts[0] += 1; }),
      table("pages_owned", "count beyond", "section PTAB", [](Image& i) { i.page(0).counts[1] = kHuge; }),
      table("pages_tets", "count beyond", "section PTAB", [](Image& i) { i.page(0).counts[2] = kHuge / 2; }),
      table("pages_foreign", "count beyond", "section PTAB", [](Image& i) { i.page(0).counts[3] = 28; }),
      table("pages_kind", "kind", "section PTAB", [](Image& i) { i.page(1).kind = 1; }),
      table("pages_time_order", "begins before", "section PTAB",
            [](Image& i) { i.page(0).bounds.min.t = i.page(0).bounds.max.t = 5; }),
      page("reserved", "reserved", [](Image& i) { i.inPage<PageHeader>(0, 0).reserved[1] = 1; }),
      page("part", "part that is not there", [](Image& i) { i.inPage<PageHeader>(0, 0).part = 1; }),
      page("first", "counts differ", [](Image& i) { i.inPage<PageHeader>(0, 0).first_vertex = 1; }),
      page("owned", "counts differ", [](Image& i) { i.inPage<PageHeader>(0, 0).owned -= 1; }),
      page("tets", "counts differ", [](Image& i) { i.inPage<PageHeader>(0, 0).tets += 1; }),
      page("foreign", "counts differ", [](Image& i) { i.inPage<PageHeader>(0, 0).foreign += 1; }),
      page("runs_huge", "size or padding", [](Image& i) { i.inPage<PageHeader>(0, 0).runs = kHuge; }),
      page("runs_wrap", "size or padding", [](Image& i) { i.inPage<PageHeader>(0, 0).runs = (kHuge >> 4) + 2; }),
      page("runs_none", "size or padding", [](Image& i) { i.inPage<PageHeader>(0, 0).runs = 0; }),
      page("padding", "size or padding", [](Image& i) { i.inPage<char>(0, kMeshRuns - 1) = 1; }),
      page("vertex_nan", "finite", [](Image& i) { i.inPage<Vec4f>(0, kMeshVertices + 16).z = kNan; }),
      page("vertex_infinite", "finite", [](Image& i) { i.inPage<Vec4f>(0, kMeshVertices).t = kInf; }),
      page("vertex_outside", "bounds", [](Image& i) { i.inPage<Vec4f>(0, kMeshVertices).x = 100; }),
      page("run_empty", "empty or out", [=](Image& i) { runs(i, 9, 18, 0); }),
      page("run_beyond", "empty or out", [](Image& i) { i.inPage<Run>(0, kMeshRuns).first = 27 - 8; }),
      page("run_wraps", "empty or out", [](Image& i) { i.inPage<Run>(0, kMeshRuns).first = kHuge - 2; }),
      page("run_count_wraps", "empty or out", [](Image& i) { i.inPage<Run>(0, kMeshRuns).count = kHuge - 8; }),
      page("run_of_its_own", "holds its own", [](Image& i) { i.inPage<Run>(0, kMeshRuns).first = 8; }),
      page("run_sum", "sum", [=](Image& i) { runs(i, 9, 18, 1); }),
      page("run_overlaps", "overlaps",
           [=](Image& i) {
             runs(i, 9, 17, 1);
             foreign(i, 10);
           }),
      page("run_order", "order",
           [=](Image& i) {
             i.inPage<PageHeader>(0, 0).runs = 2;
             i.inPage<Run>(0, kMeshRuns) = {13, 5};
             i.inPage<Run>(0, kMeshRuns + 16) = {9, 4};
           }),
      page("tet_range", "range", [](Image& i) { i.inPage<Tet>(0, kMeshTets + 16)[2] = 18; }),
      page("tet_huge", "range", [](Image& i) { i.inPage<Tet>(0, kMeshTets)[0] = 0xffffffffu; }),
      page("tet_twice", "twice", [](Image& i) { i.inPage<Tet>(0, kMeshTets)[0] = i.inPage<Tet>(0, kMeshTets)[3]; }),
  };
}

// Offsets inside page 0 of triangles_one.t4d: 4 vertices, 6 edges, 4 lifespans and triangles.
constexpr std::uint64_t kTriVertices = 64, kTriEdges = 128, kTriLives = 192, kTriTriangles = 256, kTriBands = 320,
                        kTriIndex = 384;

std::vector<BadFile> badTriangles() {
  using dyntri::Header, dyntri::PageHeader, dyntri::Edge, dyntri::Lifespan, dyntri::Triangle, dyntri::Band,
      dyntri::Alive;
  const auto column = [](std::string name, std::string place, std::string what, bool at_open, auto forge) {
    return BadFile{"triangles_column_" + name + ".t4d",
                   "triangles_columns.t4d",
                   at_open,
                   std::move(place),
                   std::move(what),
                   forge};
  };
  const auto header = [](std::string name, std::string what, auto forge, std::string place = "section DHDR") {
    return BadFile{
        "triangles_" + name + ".t4d", "triangles_one.t4d", true, std::move(place), std::move(what), [=](Image& i) {
          forge(i.item<Header>(dyntri::kHeader));
        }};
  };
  const auto table = [](std::string name, std::string what, auto forge) {
    return BadFile{"triangles_" + name + ".t4d",       "triangles_one.t4d", true, "section PTAB", std::move(what),
                   [=](Image& i) { forge(i.page(0)); }};
  };
  const auto page = [](std::string name, std::string what, auto forge, std::string place = "page 0") {
    return BadFile{
        "triangles_page_" + name + ".t4d", "triangles_one.t4d", false, std::move(place), std::move(what), forge};
  };
  return {
      header("reserved", "reserved", [](Header& h) { h.reserved[7] = 1; }),
      header(
          "columns", "the header says", [](Header& h) { h.columns = 1; }, "section COLS"),
      header(
          "parts", "the header says", [](Header& h) { h.parts = 1; }, "section PART"),
      header("map", "map", [](Header& h) { h.index_to_world.axes[1][1] = kNan64; }),
      header("bounds", "bounds", [](Header& h) { h.bounds.max.z = kInf; }),
      header("last_time_nan", "last time", [](Header& h) { h.last_time = kNan; }),
      header("vertices", "sums", [](Header& h) { h.vertices += 1; }),
      header("edges", "sums", [](Header& h) { h.edges += 1; }),
      header("triangles", "sums", [](Header& h) { h.triangles += 1; }),
      header(
          "frames", "times for", [](Header& h) { h.frames = 0; }, "section TIME"),
      table("pages_kind", "kind", [](paged::PageEntry& p) { p.kind = 7; }),
      table("pages_count_huge", "count beyond", [](paged::PageEntry& p) { p.counts[1] = kHuge; }),
      table("pages_count_4", "fourth", [](paged::PageEntry& p) { p.counts[3] = 1; }),
      page("reserved", "reserved", [](Image& i) { i.inPage<PageHeader>(0, 0).reserved[1] = 1; }),
      page("counts", "counts differ", [](Image& i) { i.inPage<PageHeader>(0, 0).edges = 5; }),
      page("counts_both", "size or padding",
           [](Image& i) {
             i.inPage<PageHeader>(0, 0).edges = i.page(0).counts[1] = i.item<Header>(dyntri::kHeader).edges = 5;
           }),
      page("padding", "size or padding", [](Image& i) { i.inPage<char>(0, kTriEdges + 6 * 8) = 1; }),
      page("vertex_nan", "finite", [](Image& i) { i.inPage<Vec4f>(0, kTriVertices).x = kNan; }),
      page("vertex_outside", "bounds", [](Image& i) { i.inPage<Vec4f>(0, kTriVertices).y = -3; }),
      page("edge_range", "range", [](Image& i) { i.inPage<Edge>(0, kTriEdges + 8).b = 4; }),
      page("edge_backward", "forward",
           [](Image& i) { std::swap(i.inPage<Edge>(0, kTriEdges).a, i.inPage<Edge>(0, kTriEdges).b); }),
      page("edge_constant", "forward",
           [](Image& i) { i.inPage<Edge>(0, kTriEdges).a = i.inPage<Edge>(0, kTriEdges).b; }),
      page("triangle_range", "range", [](Image& i) { i.inPage<Triangle>(0, kTriTriangles)[1] = 6; }),
      page("triangle_twice", "twice",
           [](Image& i) { i.inPage<Triangle>(0, kTriTriangles)[1] = i.inPage<Triangle>(0, kTriTriangles)[0]; }),
      page("life_longer", "intersection", [](Image& i) { i.inPage<Lifespan>(0, kTriLives).end += 0.125f; }),
      page("life_nan", "intersection", [](Image& i) { i.inPage<Lifespan>(0, kTriLives + 8).begin = kNan; }),
      // Lives 0 .. 0.5, 0.5 .. 0.75 twice, 0.75 .. 1: one band of four, {0, 1}, {0, 3}, {1, 4}.
      page("part", "part that is not there", [](Image& i) { i.inPage<PageHeader>(0, 0).part = 1; }),
      page("bands_huge", "size or padding", [](Image& i) { i.inPage<PageHeader>(0, 0).bands = kHuge; }),
      page("intervals_huge", "size or padding", [](Image& i) { i.inPage<PageHeader>(0, 0).intervals = kHuge / 8; }),
      page("intervals_more", "all intervals", [](Image& i) { i.inPage<PageHeader>(0, 0).intervals = 4; }),
      page("band_gap", "follow", [](Image& i) { i.inPage<Band>(0, kTriBands).first = 1; }),
      page("band_index_gap", "follow", [](Image& i) { i.inPage<Band>(0, kTriBands).first_interval = 1; }),
      page("band_empty", "none or out of range", [](Image& i) { i.inPage<Band>(0, kTriBands).count = 0; }),
      page("band_short", "all triangles", [](Image& i) { i.inPage<Band>(0, kTriBands).count = 3; }),
      page("band_long", "triangles are none or out", [](Image& i) { i.inPage<Band>(0, kTriBands).count = 5; }),
      page("band_intervals_0", "intervals are none", [](Image& i) { i.inPage<Band>(0, kTriBands).intervals = 0; }),
      page("band_intervals_more", "intervals are none",
           [](Image& i) { i.inPage<Band>(0, kTriBands).intervals = kHuge; }),
      page("alive_beyond", "run is out of range", [](Image& i) { i.inPage<Alive>(0, kTriIndex + 16).last = 5; }),
      page("alive_backward", "run is out of range", [](Image& i) { i.inPage<Alive>(0, kTriIndex).first = 2; }),
      page("alive_falls", "interval in front", [](Image& i) { i.inPage<Alive>(0, kTriIndex).last = 4; }),
      page("alive_cut", "does not hold it", [](Image& i) { i.inPage<Alive>(0, kTriIndex + 8).last = 2; }),
      page("alive_late", "does not hold it", [](Image& i) { i.inPage<Alive>(0, kTriIndex + 16).first = 2; }),
      page("unbanded_order", "sorted",
           [](Image& i) {
             i.inPage<PageHeader>(0, 0).bands = i.inPage<PageHeader>(0, 0).intervals = 0;
             i.page(0).bytes = i.page(0).raw_bytes = kTriBands;
             std::memset(&i.inPage<char>(0, kTriBands), 0, 128);
             std::swap(i.inPage<Lifespan>(0, kTriLives), i.inPage<Lifespan>(0, kTriLives + 24));
             std::swap(i.inPage<Triangle>(0, kTriTriangles), i.inPage<Triangle>(0, kTriTriangles + 36));
           }),
      page("version_1", "version 1", [](Image& i) { i.header().payload_version = 1; }),
      page("life_order", "does not hold it",
           [](Image& i) {
             std::swap(i.inPage<Lifespan>(0, kTriLives), i.inPage<Lifespan>(0, kTriLives + 24));
             std::swap(i.inPage<Triangle>(0, kTriTriangles), i.inPage<Triangle>(0, kTriTriangles + 36));
           }),
      page("life_outside", "interval", [](Image& i) { i.page(0).bounds.max.t = 0.5f; }),
      column("same_name", "section COLS", "same name", true,
             [](Image& i) { i.item<ColumnEntry>(dyntri::kColumns, 1) = i.item<ColumnEntry>(dyntri::kColumns); }),
      column("size", "section PTAB", "size of its column", true,
             [](Image& i) { i.item<ColumnEntry>(dyntri::kColumns, 1).components = 1; }),
      column("kind", "section PTAB", "kind", true, [](Image& i) { i.page(2).kind = 1; }),
      column("missing", "section PTAB", "missing", true,
             [](Image& i) {
               i.sectionOf(paged::kPageTable).item_count -= 1;
               i.sectionOf(paged::kPageTable).bytes -= sizeof(paged::PageEntry);
             }),
      column("padding", "page 1", "padding", false, [](Image& i) { i.inPage<char>(1, 8 * 4) = 1; }),
      column("part_infinite", "section PART", "infinite", true,
             [](Image& i) { i.item<PartEntry>(dyntri::kParts).isovalue = std::numeric_limits<double>::infinity(); }),
      column("version", "section DHDR", "version 1", true, [](Image& i) { i.header().payload_version = 1; }),
      page("last_time", "last time", [](Image& i) { i.item<Header>(dyntri::kHeader).last_time = 0.5f; }),
      page(
          "box", "box of the vertices", [](Image& i) { i.item<Header>(dyntri::kHeader).bounds.min.x -= 1; },
          "section DHDR"),
  };
}

// Page 1 of mesh_gaps_zstd.t4h holds the mesh, compressed.
std::vector<BadFile> badFrames() {
  if (!paged::hasCodec(paged::Codec::kZstd)) return {};
  const auto page = [](std::string name, std::string what, auto forge) {
    return BadFile{"zstd_" + name + ".t4h", "mesh_gaps_zstd.t4h", false, "page 1", std::move(what), [=](Image& i) {
                     forge(i, i.page(1));
                   }};
  };
  using P = paged::PageEntry;
  // Behind the frame, where the gap to the next page has room.
  const auto append = [](Image& i, P& p, std::initializer_list<int> bytes) {
    for (const int b : bytes) i.bytes[p.offset + p.bytes++] = static_cast<std::byte>(b);
  };
  return {
      page("larger", "another size", [](Image&, P& p) { p.raw_bytes += 64; }),
      page("smaller", "another size", [](Image&, P& p) { p.raw_bytes -= 64; }),
      page("magic", "compressed frame", [](Image& i, P& p) { i.bytes[p.offset] ^= std::byte{1}; }),
      page("cut", "exactly one", [](Image& i, P& p) { i.bytes[p.offset + --p.bytes] = std::byte{0}; }),
      page("byte_more", "exactly one", [=](Image& i, P& p) { append(i, p, {0}); }),
      page("skippable_frame", "exactly one",
           [=](Image& i, P& p) {
             append(i, p, {0x50, 0x2a, 0x4d, 0x18, 4, 0, 0, 0, 'o', 'd', 'd', '!'});
           }),
      // A whole second frame, of no bytes: the decoder alone would take it.
      page("empty_frame", "exactly one",
           [=](Image& i, P& p) {
             append(i, p, {0x28, 0xb5, 0x2f, 0xfd, 0x20, 0, 1, 0, 0});
           }),
      page("damaged", "damaged",
           [](Image& i, P& p) {
             for (std::uint64_t at = p.bytes / 2; at < p.bytes / 2 + 16; ++at) i.bytes[p.offset + at] = std::byte{0xa5};
           }),
  };
}

std::vector<BadFile> badSurfaces() {
  namespace sq = surface_sequence;
  using H = sq::Header;
  std::vector<BadFile> all;
  const auto header = [&](std::string name, std::string what, auto forge, std::string place = "section QHDR") {
    all.push_back({"surface_" + name + ".t4q", "surface.t4q", true, std::move(place), std::move(what),
                   [=](Image& i) { forge(i.item<H>(sq::kHeader)); }});
  };
  header("vertices_0", "vertices", [](H& h) { h.vertices = 0; });
  header("vertices_huge", "vertices", [](H& h) { h.vertices = (std::uint64_t{1} << 32) + 1; });
  // 7 vertices take 84 bytes; so do 7 + 2^62 / 3 if the product may wrap.
  header(
      "vertices_other", "frame 0", [](H& h) { h.vertices = std::uint64_t{1} << 32; }, "section PTAB");
  header("reserved0", "reserved", [](H& h) { h.reserved0 = 1; });
  header("reserved1", "reserved", [](H& h) { h.reserved1[3] = 1; });
  header("map_nan", "map", [](H& h) { h.index_to_world.axes[1][1] = kNan64; });
  header("bounds_nan", "bounds", [](H& h) { h.bounds.max.z = kNan; });
  header(
      "columns", "columns", [](H& h) { h.columns = 1; }, "section COLS");
  header(
      "triangles", "triangles", [](H& h) { h.triangles = kHuge; }, "section TRIS");
  header(
      "frames", "times for", [](H& h) { h.frames = 4; }, "section TIME");
  const auto add = [&](std::string name, bool at_open, std::string place, std::string what, auto forge) {
    const std::string sample = name.starts_with("column") ? "surface_columns.t4q" : "surface.t4q";
    all.push_back(
        {"surface_" + name + ".t4q", sample, at_open, std::move(place), std::move(what), [=](Image& i) { forge(i); }});
  };
  add("bounds_box", false, "section QHDR", "box of the vertices",
      [](Image& i) { i.item<H>(sq::kHeader).bounds.min.x -= 1; });
  add("times_equal", true, "section TIME", "after",
      [](Image& i) { i.item<double>(sq::kTimes, 2) = i.item<double>(sq::kTimes, 1); });
  add("triangle_range", false, "section TRIS", "range",
      [](Image& i) { i.item<sq::Triangle>(sq::kTriangles, 3)[2] = 7; });
  add("triangle_twice", false, "section TRIS", "twice",
      [](Image& i) { i.item<sq::Triangle>(sq::kTriangles, 1)[1] = i.item<sq::Triangle>(sq::kTriangles, 1)[0]; });
  add("page_missing", true, "section PTAB", "one page a frame", [](Image& i) {
    i.sectionOf(paged::kPageTable).item_count -= 1;
    i.sectionOf(paged::kPageTable).bytes -= sizeof(paged::PageEntry);
  });
  add("page_frame", true, "section PTAB", "frame 1", [](Image& i) { i.page(1).counts[0] = 2; });
  add("page_vertices", true, "section PTAB", "frame 2", [](Image& i) { i.page(2).counts[1] = 8; });
  add("page_third", true, "section PTAB", "frame 0", [](Image& i) { i.page(0).counts[2] = 1; });
  add("page_time", true, "section PTAB", "frame 1", [](Image& i) { i.page(1).bounds.max.t = 2; });
  add("page_kind", true, "section PTAB", "frame 0", [](Image& i) { i.page(0).kind = 1; });
  add("page_outside", false, "page 1", "outside", [](Image& i) { i.inPage<float>(1, 0) = -1; });
  add("page_nan", false, "page 0", "finite", [](Image& i) { i.inPage<float>(0, 12) = kNan; });
  add("column_same_name", true, "section COLS", "same name",
      [](Image& i) { i.item<ColumnEntry>(sq::kColumns, 1) = i.item<ColumnEntry>(sq::kColumns); });
  add("column_kind", true, "section PTAB", "column 1 of frame 0", [](Image& i) { i.page(2).kind = 1; });
  add("column_size", true, "section PTAB", "column 0 of frame 0",
      [](Image& i) { i.page(1).bytes = i.page(1).raw_bytes -= 4; });
  return all;
}

}  // namespace

std::vector<BadFile> badContents() {
  std::vector<BadFile> all = badGrids();
  for (auto part : {badMeshHeaders(), badMeshPages(), badTriangles(), badSurfaces(), badFrames(), badDags()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace tet4d::test
