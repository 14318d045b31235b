#include "tests/formats/support/dump.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <type_traits>

#include "formats/core/slicer.h"
#include "formats/dynamic_triangles.h"
#include "formats/grid4.h"
#include "formats/hypermesh.h"
#include "formats/patch_dag.h"
#include "formats/surface_sequence.h"

namespace tet4d::test {
namespace {

template <class T>
std::string text(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) return "nan";
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, sizeof(T) == 4 ? "%.9g" : "%.17g", static_cast<double>(value));
    return buffer;
  } else {
    return std::to_string(value);
  }
}

// Collects words into lines.
class Lines {
 public:
  Lines& word(const std::string& w) {
    if (!all_.empty() && all_.back() != '\n') all_ += ' ';
    all_ += w;
    return *this;
  }
  template <class T>
  Lines& number(T value) {
    return word(text(value));
  }
  template <class Range>
  Lines& numbers(const Range& range) {
    for (const auto& value : range) number(value);
    return *this;
  }
  Lines& vec(const Vec4f& v) { return number(v.x).number(v.y).number(v.z).number(v.t); }
  Lines& map(const AffineMap& m) {
    word("index_to_world").numbers(m.origin);
    for (const auto& axis : m.axes) numbers(axis);
    return end();
  }
  Lines& page(std::size_t i, const paged::PageEntry& e) {
    word("page").number(i).word("kind").number(e.kind).word("min").vec(e.bounds.min).word("max").vec(e.bounds.max);
    word("errors").number(e.error_estimated).number(e.error_measured).word("counts").numbers(e.counts);
    return end();
  }
  Lines& end() {
    all_ += '\n';
    return *this;
  }
  std::string take() { return std::move(all_); }

 private:
  std::string all_;
};

template <class T>
void putSamples(Lines& lines, std::span<const std::byte> bytes) {
  for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + i, sizeof(T));
    lines.number(value);
  }
}

void putSamples(Lines& lines, SampleType type, std::span<const std::byte> bytes) {
  switch (type) {
    case SampleType::kU8:
      return putSamples<std::uint8_t>(lines, bytes);
    case SampleType::kI8:
      return putSamples<std::int8_t>(lines, bytes);
    case SampleType::kU16:
      return putSamples<std::uint16_t>(lines, bytes);
    case SampleType::kI16:
      return putSamples<std::int16_t>(lines, bytes);
    case SampleType::kU32:
      return putSamples<std::uint32_t>(lines, bytes);
    case SampleType::kI32:
      return putSamples<std::int32_t>(lines, bytes);
    case SampleType::kU64:
      return putSamples<std::uint64_t>(lines, bytes);
    case SampleType::kI64:
      return putSamples<std::int64_t>(lines, bytes);
    case SampleType::kF32:
      return putSamples<float>(lines, bytes);
    case SampleType::kF64:
      return putSamples<double>(lines, bytes);
  }
}

Result<std::string> dump(const grid4::File& file) {
  Lines lines;
  const auto& h = file.header();
  lines.word("grid4 dims").numbers(h.dims).word("frames").number(h.frames).word("type");
  lines.word(std::string(sampleName(static_cast<SampleType>(h.sample_type)))).end();
  lines.map(h.index_to_world).word("times").numbers(file.times()).end();
  for (std::size_t k = 0; k < file.pages().size(); ++k) {
    auto page = file.loadFrame(k);
    if (!page.ok()) return page.fault();
    lines.page(k, file.pages().entries()[k]).word("samples");
    putSamples(lines, static_cast<SampleType>(h.sample_type), page.value().bytes());
    lines.end();
  }
  return lines.take();
}

template <class File>
Status dumpColumns(const File& file, std::size_t k, std::size_t owned, Lines& lines) {
  for (std::size_t c = 0; c < file.columns().size(); ++c) {
    auto page = file.loadColumn(c, k);
    if (!page.ok()) return page.fault();
    const std::size_t number = k * (1 + file.columns().size()) + 1 + c, components = file.columns()[c].components;
    lines.page(number, file.pages().entries()[number]);
    for (std::size_t v = 0; v < owned; ++v) {
      lines.word("c");
      putSamples<float>(lines, page.value().bytes().subspan(v * components * 4, components * 4));
      lines.end();
    }
  }
  return {};
}

Result<std::string> dump(const hypermesh::File& file) {
  Lines lines;
  const auto& h = file.header();
  lines.word("hypermesh vertices").number(h.vertices).word("tets").number(h.tets).word("frames").number(h.frames);
  lines.word("flags").number(h.flags).word("columns").number(h.columns).end().map(h.index_to_world);
  lines.word("domain").vec(h.domain.min).vec(h.domain.max).end();
  lines.word("bounds").vec(h.bounds.min).vec(h.bounds.max).end();
  lines.word("isovalue").number(h.isovalue).end().word("times").numbers(file.times()).end();
  for (const auto& c : file.columns()) lines.word("column").number(c.components).word(c.name).end();
  for (const auto& part : file.parts()) lines.word("part").number(part.isovalue).end();
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    auto page = file.gather(k);
    if (!page.ok()) return page.fault();
    const auto& view = page.value().view;
    lines.page(k * (1 + file.columns().size()), file.geometryEntry(k));
    if (h.parts != 0) lines.word("of_part").number(view.header->part).end();
    for (const Vec4f& v : view.vertices) lines.word("v").vec(v).end();
    for (const auto& run : view.runs) lines.word("run").number(run.first).number(run.count).end();
    for (const auto& tet : view.tets) lines.word("tet").numbers(tet).end();
    if (Status s = dumpColumns(file, k, view.vertices.size(), lines); !s.ok()) return s.fault();
  }
  return lines.take();
}

Result<std::string> dump(const patch_dag::File& file) {
  Lines lines;
  const auto& h = file.header();
  lines.word("patch_dag vertices").number(h.vertices).word("tets").number(h.tets).word("frames").number(h.frames);
  lines.word("flags").number(h.flags).word("columns").number(h.columns).word("nodes").number(h.nodes);
  lines.word("patches").number(h.patches).word("leaf_tets").number(h.leaf_tets).end().map(h.index_to_world);
  lines.word("domain").vec(h.domain.min).vec(h.domain.max).end();
  lines.word("bounds").vec(h.bounds.min).vec(h.bounds.max).end();
  lines.word("isovalue").number(h.isovalue).end().word("time_scale").number(h.time_scale).end();
  lines.word("times").numbers(file.times()).end();
  for (const auto& c : file.columns()) lines.word("column").number(c.components).word(c.name).end();
  for (std::size_t i = 0; i < file.nodes().size(); ++i) {
    const patch_dag::NodeEntry& node = file.nodes()[i];
    lines.word("node").number(i).word("patches").number(node.first_patch).number(node.patches);
    lines.word("level").number(node.level).word("flags").number(node.flags);
    lines.word("errors").number(node.error_estimated).number(node.error_measured);
    lines.word("min").vec(node.bounds.min).word("max").vec(node.bounds.max).end();
  }
  const std::size_t stride = 1 + file.columns().size();
  for (std::size_t p = 0; p < file.patches(); ++p) {
    auto patch = file.loadPatch(p);
    if (!patch.ok()) return patch.fault();
    const patch_dag::PatchView& view = patch.value().view;
    lines.page(p * stride, file.patchEntry(p)).word("shared").number(view.header->shared).end();
    for (const Vec4f& v : view.vertices) lines.word("v").vec(v).end();
    for (const auto& tet : view.tets) lines.word("tet").numbers(tet).end();
    for (std::size_t c = 0; c < file.columns().size(); ++c) {
      auto column = file.loadColumn(c, p);
      if (!column.ok()) return column.fault();
      lines.page(p * stride + 1 + c, file.pages().entries()[p * stride + 1 + c]);
      const std::size_t bytes = file.columns()[c].components * sizeof(float);
      for (std::size_t v = 0; v < view.vertices.size(); ++v) {
        lines.word("c");
        putSamples<float>(lines, column.value().bytes().subspan(v * bytes, bytes));
        lines.end();
      }
    }
  }
  return lines.take();
}

Result<std::string> dump(const dyntri::File& file) {
  Lines lines;
  const auto& h = file.header();
  lines.word("dynamic_triangles vertices edges triangles").number(h.vertices).number(h.edges).number(h.triangles);
  lines.word("tets").number(h.tets).word("frames").number(h.frames).word("empty").number(h.empty);
  lines.word("last_time").number(h.last_time).end().map(h.index_to_world);
  lines.word("bounds").vec(h.bounds.min).vec(h.bounds.max).end().word("times").numbers(file.times()).end();
  for (const auto& c : file.columns()) lines.word("column").number(c.components).word(c.name).end();
  for (const auto& p : file.parts()) lines.word("part").number(p.isovalue).end();
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const std::size_t number = k * (1 + file.columns().size());
    auto page = file.loadGeometry(k);
    if (!page.ok()) return page.fault();
    auto loaded = dyntri::validatePage(page.value().bytes(), file.geometryEntry(k), file.reader().path(), number);
    if (!loaded.ok()) return loaded.fault();
    const dyntri::PageView& view = loaded.value();
    lines.page(number, file.geometryEntry(k));
    if (h.parts != 0) lines.word("of_part").number(view.part).end();
    for (const Vec4f& v : view.vertices) lines.word("v").vec(v).end();
    for (const auto& e : view.edges) lines.word("e").number(e.a).number(e.b).end();
    for (std::size_t i = 0; i < view.triangles.size(); ++i) {
      const auto& life = view.lifespans[i];
      lines.word("tri").numbers(view.triangles[i]).word("life").number(life.begin).number(life.end).end();
    }
    for (const auto& b : view.bands) {
      lines.word("band").number(b.first).number(b.count).word("intervals").number(b.intervals).end();
      for (const auto& run : view.index.subspan(b.first_interval, b.intervals))
        lines.word("alive").number(run.first).number(run.last).end();
    }
    if (Status s = dumpColumns(file, k, view.vertices.size(), lines); !s.ok()) return s.fault();
  }
  return lines.take();
}

Result<std::string> dump(const surface_sequence::File& file) {
  Lines lines;
  const auto& h = file.header();
  lines.word("surface_sequence vertices").number(h.vertices).word("triangles").number(h.triangles);
  lines.word("frames").number(h.frames).word("columns").number(h.columns).end().map(h.index_to_world);
  lines.word("bounds").vec(h.bounds.min).vec(h.bounds.max).end().word("times").numbers(file.times()).end();
  for (const auto& c : file.columns()) lines.word("column").number(c.components).word(c.name).end();
  auto triangles = file.triangles();
  if (!triangles.ok()) return triangles.fault();
  for (const auto& triangle : triangles.value()) lines.word("tri").numbers(triangle).end();
  const std::size_t stride = 1 + file.columns().size();
  for (std::size_t k = 0; k < h.frames; ++k) {
    auto frame = file.loadFrame(k);
    if (!frame.ok()) return frame.fault();
    lines.page(k * stride, file.frameEntry(k));
    for (const Vec3f& p : frame.value().positions) lines.word("v").number(p.x).number(p.y).number(p.z).end();
    for (std::size_t c = 0; c < file.columns().size(); ++c) {
      auto page = file.loadColumn(c, k);
      if (!page.ok()) return page.fault();
      lines.page(k * stride + 1 + c, file.pages().entries()[k * stride + 1 + c]);
      const std::size_t bytes = file.columns()[c].components * sizeof(float);
      for (std::size_t v = 0; v < h.vertices; ++v) {
        lines.word("c");
        putSamples<float>(lines, page.value().bytes().subspan(v * bytes, bytes));
        lines.end();
      }
    }
  }
  return lines.take();
}

template <class File>
Result<std::string> dumpAs(const std::string& path) {
  auto file = File::open(path);
  if (!file.ok()) return file.fault();
  if (Status s = file.value().verify(); !s.ok()) return s.fault();
  return dump(file.value());
}

std::string hex(std::uint64_t value) {
  char buffer[20];
  std::snprintf(buffer, sizeof buffer, "%016llx", static_cast<unsigned long long>(value));
  return buffer;
}

}  // namespace

Result<std::string> dumpOf(const std::string& path, std::uint32_t payload) {
  if (payload == grid4::kPayload) return dumpAs<grid4::File>(path);
  if (payload == hypermesh::kPayload) return dumpAs<hypermesh::File>(path);
  if (payload == surface_sequence::kPayload) return dumpAs<surface_sequence::File>(path);
  if (payload == patch_dag::kPayload) return dumpAs<patch_dag::File>(path);
  return dumpAs<dyntri::File>(path);
}

Result<std::string> digestOf(const std::string& path, std::uint32_t payload) {
  auto all = dumpOf(path, payload);
  if (!all.ok()) return all.fault();
  return hex(container::xxh3(std::as_bytes(std::span(all.value()))));
}

Result<std::string> pageDigestOf(const std::string& path) {
  auto reader = container::Reader::open(path, 0, 0, {});
  if (!reader.ok()) return reader.fault();
  auto pages = paged::Pages::open(reader.value());
  if (!pages.ok()) return pages.fault();
  auto digest = pages.value().contentDigest();
  if (!digest.ok()) return digest.fault();
  return hex(digest.value());
}

Result<std::string> dumpSlice(const std::string& path, float t) {
  auto opened = hypermesh::File::open(path);
  if (!opened.ok()) return opened.fault();
  const hypermesh::File& file = opened.value();
  Lines lines;
  lines.word("slice at").number(t).end();
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    auto page = file.gather(k);
    if (!page.ok()) return page.fault();
    const auto& view = page.value().view;
    std::vector<std::uint64_t> ids;
    for (std::uint32_t i = 0; i < page.value().positions.size(); ++i) ids.push_back(view.globalOf(i));
    SliceMesh mesh;
    sliceTets(view.tets, page.value().positions, ids, t, file.header().domain.max.t, mesh);
    for (auto triangle : mesh.triangles) {
      // The smallest key first, the winding kept.
      const auto less = [&](std::uint32_t i, std::uint32_t j) { return mesh.keys[i] < mesh.keys[j]; };
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end(), less), triangle.end());
      lines.word("tri");
      for (const std::uint32_t v : triangle) {
        const Vec3f& p = mesh.positions[v];
        lines.word(std::to_string(mesh.keys[v].a) + "-" + std::to_string(mesh.keys[v].b));
        lines.number(p.x).number(p.y).number(p.z);
      }
      lines.end();
    }
  }
  return lines.take();
}

}  // namespace tet4d::test
