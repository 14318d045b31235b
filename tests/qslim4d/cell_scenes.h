// Files that are simplified in cells, and how. For tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "libpreprocess/column_list.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/mesh_pages.h"
#include "libpreprocess/qslim4d/cells.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/links.h"
#include "tests/hypermesh/extracted_mesh.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::qslim4d::testing {

inline hypermesh::File open(const std::string& path) { return unwrap(hypermesh::File::open(path)); }

inline std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct NamedField {
  std::string name;
  std::function<float(const Vec4f&)> at;
};

// A writer for a file like `file`, with its parts and these columns.
inline hypermesh::Writer writerFor(const std::string& path, const hypermesh::File& file,
                                   std::span<const Column> columns = {}) {
  hypermesh::MeshHeader header{};
  header.flags = file.header().flags;
  header.index_to_world = file.header().index_to_world;
  header.domain = file.header().domain;
  header.isovalue = file.header().isovalue;
  std::vector<double> isovalues;
  for (const PartEntry& part : file.parts()) isovalues.push_back(part.isovalue);
  return unwrap(hypermesh::Writer::create(path, header, file.times(), columns, paged::Codec::kRaw, true, isovalues));
}

// Two balls that move, one in the other with `parts`, each a part; with columns of one component.
inline void balls(const std::string& path, bool parts, const std::vector<NamedField>& fields = {}) {
  namespace marching = hypermesh::testing;
  marching::MemoryFrames<float> frames({20, 19, 19}, 8, [](auto x, auto y, auto z, auto k) {
    const auto f = [](auto i) { return static_cast<double>(i); };
    return static_cast<float>(-std::hypot(f(x) - 8.3 - 0.3 * f(k), f(y) - 9 + 0.1 * f(k), f(z) - 9.2));
  });
  hypermesh::Options extraction;
  extraction.iso = -6.1;
  if (parts) extraction.more_isos = {-3.9, -40};  // the last one has no surface
  const std::string plain = path + ".plain";
  marching::extractTo(fields.empty() ? path : plain, frames, extraction);
  if (fields.empty()) return;
  {
    const hypermesh::File file = open(plain);
    std::vector<Column> columns;
    for (const NamedField& field : fields) columns.push_back({field.name, 1});
    hypermesh::Writer writer = writerFor(path, file, columns);
    std::size_t k = 0;
    exchange::forEachPage(file, [&](const hypermesh::GatheredPage& page) {
      std::vector<std::vector<float>> values(fields.size());
      for (std::size_t c = 0; c < fields.size(); ++c)
        for (const Vec4f& v : page.view.vertices) values[c].push_back(fields[c].at(v));
      const std::vector<std::span<const float>> spans(values.begin(), values.end());
      unwrap(writer.addPage(page.view.vertices, page.view.runs, page.view.tets, file.geometryEntry(k++).bounds, spans,
                            page.view.header->part));
    });
    unwrap(writer.close("{}"));
  }
  std::filesystem::remove(plain);
}

inline const std::vector<NamedField>& fields() {
  static const std::vector<NamedField> all{
      {"wave", [](const Vec4f& v) { return std::sin(0.7F * v.x) + 0.3F * v.t; }},
      {"label", [](const Vec4f& v) { return v.y < 9 ? 3.0F : 12.0F; }},
      {"holes", [](const Vec4f& v) { return v.z > 12 ? std::nanf("") : v.z; }},
  };
  return all;
}
inline std::vector<std::uint64_t> targetsOf(const hypermesh::File& file, std::uint64_t part_of) {
  std::vector<std::uint64_t> targets = tetsByPart(file);
  for (std::uint64_t& target : targets) target /= part_of;
  return targets;
}

inline void expectSound(const hypermesh::File& file) {
  EXPECT_TRUE(file.verify().ok()) << file.verify().fault().what;
  outofcore::Progress progress;
  const topology::HypermeshCheck faces = topology::checkHypermesh(file, progress);
  EXPECT_TRUE(faces.ok()) << (faces.faults.empty() ? "" : faces.faults[0]);
  EXPECT_EQ(faces.unused_vertices, 0u);
  outofcore::MemoryBudget memory;
  const topology::LinkCheck links = topology::checkLinks(file, memory, progress);
  EXPECT_TRUE(links.ok()) << (links.faults.empty() ? "" : links.faults[0]);
}

struct CellMeans {
  std::size_t threads = 1;
  std::uint64_t memory = 0;
  outofcore::Progress* progress = nullptr;
  Order order = Order::kPasses;
};

// All columns are carried, those of `metric` in the metric. The folder is gone afterwards.
inline CellReport simplifyTo(const std::string& out, const hypermesh::File& file, Options options, CellOptions cells,
                             const CellMeans& means = {}, std::span<const std::string> metric = {}) {
  outofcore::ThreadExecutor executor(means.threads);
  outofcore::Progress silent;
  outofcore::MemoryBudget memory(means.memory);
  options.order = means.order;
  cells.folder = out + ".cells", cells.run_name = "test";
  std::vector<ColumnWish> wishes;
  std::vector<Column> columns;
  for (std::size_t c = 0; c < file.columns().size(); ++c) {
    columns.push_back({columnName(file.columns()[c]), file.columns()[c].components});
    wishes.push_back({c, std::find(metric.begin(), metric.end(), columns.back().name) != metric.end(), {}});
  }
  cells.columns = planColumns(file, wishes, silent);
  hypermesh::Writer writer = writerFor(out, file, columns);
  const CellReport report = simplifyInCells(file, Metric::kSlice, options, cells, writer, executor, memory,
                                            means.progress != nullptr ? *means.progress : silent);
  if (report.is_kept) unwrap(writer.close("{}"));
  EXPECT_FALSE(std::filesystem::exists(cells.folder));
  return report;
}

inline CellOptions inCells(std::uint64_t cell_tets) {
  CellOptions cells;
  cells.cell_tets = cell_tets;
  return cells;
}

// Interrupts after a number of steps.
class Interrupting final : public outofcore::Progress {
 public:
  explicit Interrupting(int steps) : left_(steps) {}
  void step(std::uint64_t) override {
    if (--left_ < 0) throw Error(FaultCode::kInterrupted, "", "", "interrupted", "");
  }

 private:
  int left_;
};

}  // namespace tet4d::qslim4d::testing
