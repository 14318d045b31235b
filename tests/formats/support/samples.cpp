#include "tests/formats/support/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>

#include "formats/core/tet_slice.h"

namespace tet4d::test {
namespace {

// Exact in float32, so that files do not depend on the mathematics library.
float rippled(std::size_t y, std::size_t z, std::size_t t) {
  return 0.5f + 0.125f * static_cast<float>((3 * y + 5 * z + 7 * t) % 4) -
         0.0625f * static_cast<float>((y * z + t) % 3);
}

// The sign of det(n, b-a, c-a, d-a) for n = +x: which of the two orders of a tetrahedron has its outside at larger x.
bool isPositive(const std::array<Vec4f, 4>& p) {
  const auto edge = [&](std::size_t i) {
    return std::array<double, 3>{double{p[i].y} - p[0].y, double{p[i].z} - p[0].z, double{p[i].t} - p[0].t};
  };
  const auto u = edge(1), v = edge(2), w = edge(3);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]) >
         0;
}

constexpr std::array<std::array<int, 3>, 6> kOrders{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

}  // namespace

Sheet makeSheet(std::size_t cells, std::size_t slabs) {
  Sheet sheet;
  const std::size_t row = cells + 1, layer = row * row;
  const auto extent = static_cast<float>(cells);
  sheet.header.flags = hypermesh::kOnGrid;
  sheet.header.index_to_world = {{-1, 2, 0.5}, {{{0.25, 0, 0}, {0, 0.5, 0}, {0, 0, -0.75}}}};
  sheet.header.domain = {{0, 0, 0, 0}, {2, extent, extent, static_cast<float>(slabs)}};
  sheet.header.isovalue = 0.5;
  for (std::size_t t = 0; t <= slabs; ++t) sheet.times.push_back(1e9 + 0.125 * static_cast<double>(t * t + t));

  for (std::size_t k = 0; k < slabs; ++k) {
    Sheet::Page page;
    const bool last = k + 1 == slabs;
    std::vector<Vec4f> positions;  // by local index: layer k, then layer k + 1
    for (std::size_t t = k; t <= k + 1; ++t) {
      for (std::size_t z = 0; z <= cells; ++z) {
        for (std::size_t y = 0; y <= cells; ++y) {
          positions.push_back({rippled(y, z, t), static_cast<float>(y), static_cast<float>(z), static_cast<float>(t)});
        }
      }
    }
    page.vertices.assign(positions.begin(), positions.begin() + static_cast<std::ptrdiff_t>(last ? 2 * layer : layer));
    if (!last) page.runs.push_back({(k + 1) * layer, layer});
    for (std::size_t cell = 0; cell < cells * cells; ++cell) {
      const std::array<std::size_t, 3> corner{cell % cells, cell / cells, 0};
      for (const auto& order : kOrders) {
        std::array<std::size_t, 3> at = corner;
        hypermesh::Tet tet{};
        for (std::size_t i = 0; i < 4; ++i) {
          tet[i] = static_cast<std::uint32_t>(at[2] * layer + at[1] * row + at[0]);
          if (i < 3) ++at[static_cast<std::size_t>(order[i])];
        }
        if (!isPositive({positions[tet[0]], positions[tet[1]], positions[tet[2]], positions[tet[3]]})) {
          std::swap(tet[2], tet[3]);
        }
        page.tets.push_back(tet);
      }
    }
    for (const Vec4f& p : positions) page.bounds.add(p);
    sheet.pages.push_back(std::move(page));
  }
  return sheet;
}

namespace {

// The triangles from `first` on, sorted by begin, as a band of three intervals. Its index by brute force.
void addBand(TrianglePage& page, std::size_t first, const dyntri::Lifespan& whole) {
  constexpr std::uint64_t kIntervals = 3;
  const std::uint64_t count = page.lifespans.size() - first;
  if (count == 0) return;
  page.bands.push_back({first, count, page.index.size(), kIntervals});
  const dyntri::Intervals intervals(whole, kIntervals);
  for (std::uint64_t i = 0; i < kIntervals; ++i) {
    dyntri::Alive run{static_cast<std::uint32_t>(count), 0};
    for (std::uint32_t k = 0; k < count; ++k) {
      const dyntri::Lifespan& life = page.lifespans[first + k];
      if (intervals.lastOf(life.end, whole) >= i) run.first = std::min(run.first, k);
      if (intervals.at(life.begin) <= i) run.last = k + 1;
    }
    page.index.push_back({std::min(run.first, run.last), run.last});
  }
}

}  // namespace

TrianglePage trianglesOf(const std::vector<Vec4f>& positions, const std::vector<hypermesh::Tet>& tets) {
  TrianglePage page;
  page.vertices = positions;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  const auto edgeOf = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = edges.try_emplace({a, b}, static_cast<std::uint32_t>(page.edges.size()));
    if (is_new) page.edges.push_back({a, b});
    return found->second;
  };
  std::vector<std::pair<dyntri::Lifespan, dyntri::Triangle>> built;
  for (const auto& tet : tets) {
    const auto t = [&](std::uint32_t v) { return positions[v].t; };
    const TimeOrder order = orderByTime(t(tet[0]), t(tet[1]), t(tet[2]), t(tet[3]));
    const auto v = [&](std::size_t k) { return tet[order.at[k]]; };
    for (const DynTriRule& rule : kDynTriRules) {
      const float begin = t(v(rule.begin)), end = t(v(rule.end));
      if (!(begin < end)) {
        ++page.empty;
        continue;
      }
      dyntri::Triangle triangle{};
      for (std::size_t i = 0; i < 3; ++i) {
        triangle[i] = edgeOf(v(kTetEdges[rule.edges[i]][0]), v(kTetEdges[rule.edges[i]][1]));
      }
      if (order.odd) std::swap(triangle[1], triangle[2]);
      built.push_back({{begin, end}, triangle});
    }
  }
  std::stable_sort(built.begin(), built.end(),
                   [](const auto& a, const auto& b) { return a.first.begin < b.first.begin; });
  std::vector<dyntri::Lifespan> lives;
  for (const auto& [life, triangle] : built) lives.push_back(life);
  const dyntri::Lifespan whole = dyntri::unionOf(lives);
  for (const bool is_long : {true, false}) {
    const std::size_t first = page.lifespans.size();
    for (const auto& [life, triangle] : built) {
      if ((2 * (life.end - life.begin) > whole.end - whole.begin) != is_long) continue;
      page.lifespans.push_back(life);
      page.triangles.push_back(triangle);
    }
    addBand(page, first, whole);
  }
  return page;
}

namespace {

constexpr const char* kProvenanceText = R"({"program":"samples","version":"1"})";

Status writeGrid(const std::string& path, SampleType type, std::array<std::uint64_t, 3> dims, std::size_t frames,
                 paged::Codec codec) {
  grid4::GridHeader header{};
  std::copy(dims.begin(), dims.end(), header.dims);
  header.sample_type = static_cast<std::uint32_t>(type);
  header.index_to_world = {{100, -200, 0.5}, {{{2, 0, 0}, {0, 2, 0.5}, {0, 0, 3}}}};
  std::vector<double> times;
  for (std::size_t k = 0; k < frames; ++k) times.push_back(1.7e9 + 0.1 * static_cast<double>(k));
  auto writer = grid4::Writer::create(path, header, times, codec, true);
  if (!writer.ok()) return writer.fault();
  const std::uint64_t bytes = dims[0] * dims[1] * dims[2] * sampleBytes(type);
  for (std::size_t k = 0; k < frames; ++k) {
    std::vector<std::byte> samples(bytes);
    // Any bits are a legal sample; f32 and f64 get NaN, infinity and negative zero among them.
    for (std::size_t i = 0; i < bytes; ++i) samples[i] = static_cast<std::byte>((i * 37 + k * 11) & 0xff);
    if (type == SampleType::kF32 && bytes >= 16) {
      const std::array<float, 4> special{std::numeric_limits<float>::quiet_NaN(),
                                         -std::numeric_limits<float>::infinity(), -0.0f, 0.1f};
      std::memcpy(samples.data(), special.data(), 16);
    }
    if (Status s = writer.value().addFrame(samples); !s.ok()) return s;
  }
  return writer.value().close(kProvenanceText);
}

// `columns`: with a scalar and a vector per vertex; `gaps`: with empty slabs in front, between and behind.
// Its pages belong to as many `parts` in turn; the last has no isovalue.
Status writeMesh(const std::string& path, const Sheet& sheet, paged::Codec codec, bool columns, bool gaps,
                 std::size_t parts = 0) {
  std::vector<hypermesh::Writer::Column> declared;
  if (columns) declared = {{"pressure", 1}, {"velocity \xc3\xbc", 3}};
  std::vector<double> isovalues(parts, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t p = 0; p + 1 < parts; ++p) isovalues[p] = 0.25 + static_cast<double>(p);
  auto writer = hypermesh::Writer::create(path, sheet.header, sheet.times, declared, codec, true, isovalues);
  if (!writer.ok()) return writer.fault();
  std::size_t pages = 0;
  const auto add = [&](const Sheet::Page& page) {
    std::vector<float> pressure, velocity;
    for (const Vec4f& v : page.vertices) {
      pressure.push_back(v.x * 2);
      velocity.insert(velocity.end(), {v.x, -v.y, std::numeric_limits<float>::infinity()});
    }
    const std::array<std::span<const float>, 2> values{pressure, velocity};
    return writer.value().addPage(page.vertices, page.runs, page.tets, page.bounds,
                                  std::span(values).first(declared.size()), parts == 0 ? 0 : pages++ % parts);
  };
  for (const Sheet::Page& page : sheet.pages) {
    if (gaps) {
      if (Status s = add({}); !s.ok()) return s;
    }
    if (Status s = add(page); !s.ok()) return s;
  }
  if (gaps) {
    if (Status s = add({}); !s.ok()) return s;
  }
  return writer.value().close(kProvenanceText);
}

// `columns`: with a scalar and a vector per vertex. `parts`: its pages belong to two parts in turn.
Status writeTriangles(const std::string& path, const Sheet& sheet, paged::Codec codec, bool gaps, bool columns = false,
                      bool parts = false) {
  dyntri::Header header{};
  header.index_to_world = sheet.header.index_to_world;
  header.last_time = sheet.header.domain.max.t;
  std::vector<Column> declared;
  if (columns) declared = {{"pressure", 1}, {"velocity \xc3\xbc", 3}};
  std::vector<double> isovalues;
  if (parts) isovalues = {0.25, std::numeric_limits<double>::quiet_NaN()};
  auto writer = dyntri::Writer::create(path, header, sheet.times, codec, true, declared, isovalues);
  if (!writer.ok()) return writer.fault();
  std::size_t written = 0;
  const auto add = [&](TrianglePage page, std::uint64_t tets) {
    std::vector<float> pressure, velocity;
    for (const Vec4f& v : page.vertices) {
      pressure.push_back(v.x * 2);
      velocity.insert(velocity.end(), {v.x, -v.y, std::numeric_limits<float>::infinity()});
    }
    page.part = parts ? written++ % 2 : 0;
    const std::array<std::span<const float>, 2> values{pressure, velocity};
    return writer.value().addPage(page.view(), tets, page.empty, std::span(values).first(declared.size()));
  };
  const std::size_t pages = sheet.pages.size();
  for (std::size_t k = 0; k < pages; ++k) {
    std::vector<Vec4f> positions = sheet.pages[k].vertices;
    for (const auto& run : sheet.pages[k].runs) {  // the sheet's runs begin at the next page
      const auto& next = sheet.pages[k + 1].vertices;
      positions.insert(positions.end(), next.begin(), next.begin() + static_cast<std::ptrdiff_t>(run.count));
    }
    if (gaps) {
      if (Status s = add({}, 0); !s.ok()) return s;
    }
    if (Status s = add(trianglesOf(positions, sheet.pages[k].tets), sheet.pages[k].tets.size()); !s.ok()) return s;
  }
  return writer.value().close(kProvenanceText);
}

// A strip of triangles that ripples, its last vertex in none of them, far from the origin.
Status writeSurfaces(const std::string& path, std::size_t triangles, std::size_t frames, paged::Codec codec,
                     bool columns) {
  surface_sequence::Header header{};
  header.vertices = triangles + 3;
  header.index_to_world = {{1e7, -2e7, 0.125}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  std::vector<double> times;
  for (std::size_t k = 0; k < frames; ++k) times.push_back(1.7e9 + 0.1 * static_cast<double>(k));
  std::vector<surface_sequence::Triangle> strip;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    strip.push_back(i % 2 == 0 ? surface_sequence::Triangle{i, i + 1, i + 2}
                               : surface_sequence::Triangle{i + 1, i, i + 2});
  }
  std::vector<Column> declared;
  if (columns) declared = {{"heat", 1}, {"wind \xc3\xbc", 2}};
  auto writer = surface_sequence::Writer::create(path, header, times, strip, declared, codec, true);
  if (!writer.ok()) return writer.fault();
  for (std::size_t k = 0; k < frames; ++k) {
    std::vector<Vec3f> positions;
    std::vector<float> heat, wind;
    for (std::size_t i = 0; i < header.vertices; ++i) {
      positions.push_back({static_cast<float>(i / 2), static_cast<float>(i % 2), rippled(i, 0, k)});
      heat.push_back(static_cast<float>(i + k));
      wind.insert(wind.end(), {-heat.back(), std::numeric_limits<float>::quiet_NaN()});
    }
    const std::array<std::span<const float>, 2> values{heat, wind};
    if (Status s = writer.value().addFrame(positions, std::span(values).first(declared.size())); !s.ok()) return s;
  }
  return writer.value().close(kProvenanceText);
}

// A sheet without pages, and one of a single tetrahedron with four times all different.
Sheet withoutPages() {
  Sheet sheet = makeSheet(1, 1);
  sheet.pages.clear();
  return sheet;
}
Sheet oneTet() {
  Sheet sheet = withoutPages();
  sheet.header.flags = 0;
  sheet.header.isovalue = std::numeric_limits<double>::quiet_NaN();
  Sheet::Page page;
  page.vertices = {{0.25f, 1, 0, 0.5f}, {0.5f, 0, 0, 0}, {0.75f, 0, 1, 1}, {0, 1, 1, 0.75f}};
  page.tets = {{0, 1, 2, 3}};
  for (const Vec4f& v : page.vertices) page.bounds.add(v);
  sheet.pages = {page};
  return sheet;
}

// Tetrahedra of a page as a patch, its vertices in order of use.
struct SmallPatch {
  std::vector<Vec4f> vertices;
  std::vector<patch_dag::LocalTet> tets;
};
SmallPatch patchOf(const Sheet::Page& page, std::size_t first, std::size_t count) {
  SmallPatch patch;
  std::map<std::uint32_t, std::uint16_t> local;
  for (const hypermesh::Tet& tet : std::span(page.tets).subspan(first, count)) {
    auto& named = patch.tets.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [found, is_new] = local.try_emplace(tet[i], static_cast<std::uint16_t>(patch.vertices.size()));
      if (is_new) patch.vertices.push_back(page.vertices[tet[i]]);
      named[i] = found->second;
    }
  }
  return patch;
}

// A sheet of one page as a DAG: whole above a node whose two halves end in the sink; without `split` as one patch from
// source to sink. The coarse patch is as fine as the others: nothing is simplified here.
Status writeDag(const std::string& path, const Sheet& sheet, paged::Codec codec, bool split, bool columns) {
  patch_dag::Header header{};
  header.flags = sheet.header.flags;
  header.index_to_world = sheet.header.index_to_world;
  header.domain = sheet.header.domain;
  header.isovalue = sheet.header.isovalue;
  header.time_scale = 1;
  std::vector<patch_dag::NodeEntry> nodes(split ? 3 : 2);
  nodes[0].level = split ? 2 : 1;
  nodes[0].bounds = sheet.header.domain;
  nodes[0].error_measured = columns ? 0.5f : -1.0f;
  if (split) {
    nodes[0].error_estimated = nodes[1].error_estimated = 0.25f;
    nodes[1].error_measured = -1;
    nodes[1].level = 1;
    nodes[1].flags = patch_dag::kStuck;
    nodes[1].bounds = sheet.header.domain;
  }
  std::vector<Column> declared;
  if (columns) declared = {{"pressure", 1}, {"velocity \xc3\xbc", 3}};
  auto writer = patch_dag::Writer::create(path, header, sheet.times, nodes, declared, codec, true);
  if (!writer.ok()) return writer.fault();
  const auto add = [&](std::uint64_t from, std::uint64_t to, const SmallPatch& patch) {
    std::vector<float> pressure, velocity;
    for (const Vec4f& v : patch.vertices) {
      pressure.push_back(v.x * 2);
      velocity.insert(velocity.end(), {v.x, -v.y, std::numeric_limits<float>::infinity()});
    }
    const std::array<std::span<const float>, 2> values{pressure, velocity};
    return writer.value().addPatch({from, to, split ? patch.vertices.size() : 0, patch.vertices, patch.tets,
                                    std::span(values).first(declared.size())});
  };
  for (const Sheet::Page& page : sheet.pages) {
    const std::size_t half = page.tets.size() / 2;
    if (Status s = add(0, 1, patchOf(page, 0, page.tets.size())); !s.ok()) return s;
    if (!split) continue;
    if (Status s = add(1, 2, patchOf(page, 0, half)); !s.ok()) return s;
    if (Status s = add(1, 2, patchOf(page, half, half)); !s.ok()) return s;
  }
  return writer.value().close(kProvenanceText);
}

std::vector<Sample> allSamples() {
  using enum SampleType;
  const auto raw = paged::Codec::kRaw, zstd = paged::Codec::kZstd;
  std::vector<Sample> all{
      {"grid_u8.t4g", grid4::kPayload, true,
       [=](auto& p) {
         return writeGrid(p, kU8, {3, 2, 2}, 2, raw);
       }},
      {"grid_f32.t4g", grid4::kPayload, true,
       [=](auto& p) {
         return writeGrid(p, kF32, {4, 3, 2}, 2, raw);
       }},
      {"grid_one.t4g", grid4::kPayload, true,
       [=](auto& p) {
         return writeGrid(p, kF64, {1, 1, 1}, 1, raw);
       }},
      {"grid_i16_zstd.t4g", grid4::kPayload, false,
       [=](auto& p) {
         return writeGrid(p, kI16, {8, 4, 4}, 2, zstd);
       }},
      {"mesh.t4h", hypermesh::kPayload, true,
       [=](auto& p) { return writeMesh(p, makeSheet(2, 2), raw, false, false); }},
      {"mesh_one.t4h", hypermesh::kPayload, true, [=](auto& p) { return writeMesh(p, oneTet(), raw, false, false); }},
      {"mesh_empty.t4h", hypermesh::kPayload, true,
       [=](auto& p) { return writeMesh(p, withoutPages(), raw, false, false); }},
      {"mesh_columns.t4h", hypermesh::kPayload, true,
       [=](auto& p) { return writeMesh(p, makeSheet(1, 1), raw, true, false); }},
      {"mesh_parts.t4h", hypermesh::kPayload, true,
       [=](auto& p) { return writeMesh(p, makeSheet(1, 1), raw, false, true, 2); }},
      {"mesh_gaps_zstd.t4h", hypermesh::kPayload, false,
       [=](auto& p) { return writeMesh(p, makeSheet(2, 1), zstd, false, true); }},
      {"mesh_columns_zstd.t4h", hypermesh::kPayload, false,
       [=](auto& p) { return writeMesh(p, makeSheet(3, 1), zstd, true, false); }},
      {"triangles.t4d", dyntri::kPayload, true,
       [=](auto& p) { return writeTriangles(p, makeSheet(2, 1), raw, false); }},
      {"triangles_one.t4d", dyntri::kPayload, true, [=](auto& p) { return writeTriangles(p, oneTet(), raw, false); }},
      {"triangles_empty.t4d", dyntri::kPayload, true,
       [=](auto& p) { return writeTriangles(p, withoutPages(), raw, false); }},
      {"triangles_columns.t4d", dyntri::kPayload, true,
       [=](auto& p) { return writeTriangles(p, makeSheet(1, 1), raw, false, true, true); }},
      {"triangles_columns_zstd.t4d", dyntri::kPayload, false,
       [=](auto& p) { return writeTriangles(p, makeSheet(3, 1), zstd, false, true, false); }},
      {"triangles_gaps_zstd.t4d", dyntri::kPayload, false,
       [=](auto& p) { return writeTriangles(p, makeSheet(2, 1), zstd, true); }},
      {"surface.t4q", surface_sequence::kPayload, true, [=](auto& p) { return writeSurfaces(p, 4, 3, raw, false); }},
      {"surface_one.t4q", surface_sequence::kPayload, true,
       [=](auto& p) { return writeSurfaces(p, 1, 1, raw, false); }},
      {"surface_points.t4q", surface_sequence::kPayload, true,
       [=](auto& p) { return writeSurfaces(p, 0, 2, raw, false); }},
      {"surface_columns.t4q", surface_sequence::kPayload, true,
       [=](auto& p) { return writeSurfaces(p, 2, 1, raw, true); }},
      {"surface_columns_zstd.t4q", surface_sequence::kPayload, false,
       [=](auto& p) { return writeSurfaces(p, 30, 1, zstd, true); }},
      {"dag.t4p", patch_dag::kPayload, true, [=](auto& p) { return writeDag(p, makeSheet(1, 1), raw, true, false); }},
      {"dag_one.t4p", patch_dag::kPayload, true, [=](auto& p) { return writeDag(p, oneTet(), raw, false, false); }},
      {"dag_empty.t4p", patch_dag::kPayload, true,
       [=](auto& p) { return writeDag(p, withoutPages(), raw, false, false); }},
      {"dag_columns.t4p", patch_dag::kPayload, true,
       [=](auto& p) { return writeDag(p, makeSheet(1, 1), raw, false, true); }},
      {"dag_columns_zstd.t4p", patch_dag::kPayload, false,
       [=](auto& p) { return writeDag(p, makeSheet(3, 1), zstd, false, true); }},
  };
  if (!paged::hasCodec(zstd)) std::erase_if(all, [](const Sample& s) { return !s.exact; });
  return all;
}

template <class File>
Status openAndVerifyAs(const std::string& path, bool* opened) {
  auto file = File::open(path);
  if (opened != nullptr) *opened = file.ok();
  if (!file.ok()) return file.fault();
  return file.value().verify();
}

}  // namespace

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = allSamples();
  return all;
}

const Sample& sampleNamed(const std::string& name) {
  const auto found = std::find_if(samples().begin(), samples().end(), [&](const Sample& s) { return s.name == name; });
  if (found != samples().end()) return *found;
  std::fprintf(stderr, "test set-up: no sample %s\n", name.c_str());
  std::abort();
}

Status openAndVerify(const std::string& path, std::uint32_t payload, bool* opened) {
  if (payload == grid4::kPayload) return openAndVerifyAs<grid4::File>(path, opened);
  if (payload == hypermesh::kPayload) return openAndVerifyAs<hypermesh::File>(path, opened);
  if (payload == surface_sequence::kPayload) return openAndVerifyAs<surface_sequence::File>(path, opened);
  if (payload == patch_dag::kPayload) return openAndVerifyAs<patch_dag::File>(path, opened);
  return openAndVerifyAs<dyntri::File>(path, opened);
}

}  // namespace tet4d::test
