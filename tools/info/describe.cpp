#include "tools/info/describe.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <span>

#include "formats/core/coordinates.h"
#include "libpreprocess/outofcore/memory_budget.h"

namespace tet4d::info {

namespace {

using nlohmann::ordered_json;

template <class File>
Result<AnyFile> opened(Result<File> file) {
  if (!file.ok()) return file.fault();
  return AnyFile(std::move(file).value());
}

// The world box around a box of index space; time through the table of frame times.
ordered_json worldBounds(const Bounds4f& box, const AffineMap& map, std::span<const double> times) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low, high;
  low.fill(kInfinity), high.fill(-kInfinity);
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto point =
        toWorld(map, {(corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                      (corner & 4) != 0 ? box.max.z : box.min.z});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  }
  return {{"min", {low[0], low[1], low[2], timeOfFrame(times, box.min.t)}},
          {"max", {high[0], high[1], high[2], timeOfFrame(times, box.max.t)}}};
}

ordered_json mapJson(const AffineMap& map) { return {{"origin", map.origin}, {"axes", map.axes}}; }

ordered_json timesJson(std::span<const double> times) {
  if (times.empty()) return nullptr;
  return {{"first", times.front()}, {"last", times.back()}};
}

ordered_json pagesJson(const paged::Pages& pages) {
  std::uint64_t stored = 0, raw = 0, compressed = 0;
  for (const paged::PageEntry& entry : pages.entries()) {
    stored += entry.bytes;
    raw += entry.raw_bytes;
    if (entry.codec != static_cast<std::uint32_t>(paged::Codec::kRaw)) ++compressed;
  }
  return {{"count", pages.size()}, {"compressed", compressed}, {"stored_bytes", stored}, {"raw_bytes", raw}};
}

ordered_json provenanceJson(const container::Reader& reader) {
  const std::string_view text = reader.provenance();
  ordered_json parsed = ordered_json::parse(text, nullptr, false);
  return parsed.is_discarded() ? ordered_json(std::string(text)) : parsed;
}

ordered_json columnsJson(std::span<const ColumnEntry> columns) {
  ordered_json out = ordered_json::array();
  for (const ColumnEntry& column : columns) {
    const std::string_view name(column.name, sizeof(column.name));
    out.push_back({{"name", name.substr(0, name.find('\0'))}, {"components", column.components}});
  }
  return out;
}

// By number: what is at place i is part i.
ordered_json partsJson(std::span<const PartEntry> parts) {
  ordered_json out = ordered_json::array();
  for (const PartEntry& part : parts)
    out.push_back({{"isovalue", std::isnan(part.isovalue) ? ordered_json(nullptr) : ordered_json(part.isovalue)}});
  return out;
}

void addPayload(ordered_json& out, const grid4::File& file) {
  const grid4::GridHeader& header = file.header();
  const std::uint64_t voxels = header.dims[0] * header.dims[1] * header.dims[2];
  out["counts"] = {{"frames", header.frames}, {"voxels", voxels * header.frames}};
  const auto last = [](std::uint64_t count) { return static_cast<float>(count - 1); };
  const Bounds4f box{{0, 0, 0, 0},
                     {last(header.dims[0]), last(header.dims[1]), last(header.dims[2]), last(header.frames)}};
  out["bounds"] = worldBounds(box, header.index_to_world, file.times());
  out["dims"] = header.dims;
  out["sample_type"] = sampleName(static_cast<SampleType>(header.sample_type));
  out["index_to_world"] = mapJson(header.index_to_world);
}

void addPayload(ordered_json& out, const hypermesh::File& file) {
  const hypermesh::MeshHeader& header = file.header();
  out["counts"] = {{"vertices", header.vertices}, {"tets", header.tets}, {"frames", header.frames}};
  out["bounds"] = worldBounds(header.bounds, header.index_to_world, file.times());
  out["domain"] = worldBounds(header.domain, header.index_to_world, file.times());
  out["isovalue"] = std::isnan(header.isovalue) ? ordered_json(nullptr) : ordered_json(header.isovalue);
  out["on_grid"] = (header.flags & hypermesh::kOnGrid) != 0;
  out["inner_boundary"] = (header.flags & hypermesh::kInnerBoundary) != 0;
  out["columns"] = columnsJson(file.columns());
  if (!file.parts().empty()) out["parts"] = partsJson(file.parts());
  out["index_to_world"] = mapJson(header.index_to_world);
}

void addPayload(ordered_json& out, const dyntri::File& file) {
  const dyntri::Header& header = file.header();
  out["counts"] = {{"vertices", header.vertices}, {"edges", header.edges}, {"triangles", header.triangles},
                   {"tets", header.tets},         {"empty", header.empty}, {"frames", header.frames}};
  out["bounds"] = worldBounds(header.bounds, header.index_to_world, file.times());
  out["columns"] = columnsJson(file.columns());
  if (!file.parts().empty()) out["parts"] = partsJson(file.parts());
  out["index_to_world"] = mapJson(header.index_to_world);
}

void addPayload(ordered_json& out, const surface_sequence::File& file) {
  const surface_sequence::Header& header = file.header();
  out["counts"] = {{"frames", header.frames}, {"vertices", header.vertices}, {"triangles", header.triangles}};
  out["bounds"] = worldBounds(header.bounds, header.index_to_world, file.times());
  out["columns"] = columnsJson(file.columns());
  out["index_to_world"] = mapJson(header.index_to_world);
}

// By level, the coarsest first: nodes, those that are stuck, and the patches that end in them.
ordered_json levelsJson(const patch_dag::File& file) {
  std::map<std::uint32_t, std::array<std::uint64_t, 4>, std::greater<>> levels;
  for (const patch_dag::NodeEntry& node : file.nodes()) {
    ++levels[node.level][0];
    levels[node.level][1] += node.flags & patch_dag::kStuck;
  }
  for (std::size_t p = 0; p < file.patches(); ++p) {
    auto& level = levels[file.nodes()[file.toOf(p)].level];
    ++level[2], level[3] += file.patchEntry(p).counts[1];
  }
  ordered_json out = ordered_json::array();
  for (const auto& [level, sums] : levels) {
    if (level == file.nodes().front().level) continue;  // the source
    out.push_back({{"level", level}, {"nodes", sums[0]}, {"stuck", sums[1]}, {"patches", sums[2]}, {"tets", sums[3]}});
  }
  return out;
}

void addPayload(ordered_json& out, const patch_dag::File& file) {
  const patch_dag::Header& header = file.header();
  out["counts"] = {{"vertices", header.vertices}, {"tets", header.tets},       {"frames", header.frames},
                   {"nodes", header.nodes},       {"patches", header.patches}, {"leaf_tets", header.leaf_tets}};
  out["bounds"] = worldBounds(header.bounds, header.index_to_world, file.times());
  out["domain"] = worldBounds(header.domain, header.index_to_world, file.times());
  out["isovalue"] = std::isnan(header.isovalue) ? ordered_json(nullptr) : ordered_json(header.isovalue);
  out["time_scale"] = header.time_scale;
  out["levels"] = levelsJson(file);
  out["columns"] = columnsJson(file.columns());
  out["index_to_world"] = mapJson(header.index_to_world);
}

std::string scalarText(const ordered_json& value) {
  return value.is_string() ? value.get<std::string>()
                           : value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

Result<AnyFile> open(const std::string& path) {
  const auto header = container::peek(path);
  if (!header.ok()) return header.fault();
  switch (header.value().payload) {
    case grid4::kPayload:
      return opened(grid4::File::open(path));
    case hypermesh::kPayload:
      return opened(hypermesh::File::open(path));
    case dyntri::kPayload:
      return opened(dyntri::File::open(path));
    case surface_sequence::kPayload:
      return opened(surface_sequence::File::open(path));
    case patch_dag::kPayload:
      return opened(patch_dag::File::open(path));
    default:
      return Fault{
          FaultCode::kBadInput, path, "header",
          fmt::format(
              "payload '{}' is unknown; known are grid4, hypermesh, dynamic_triangles, surface_sequence and patch_dag",
              container::fourCcText(header.value().payload)),
          "use a version of tet4d that knows it"};
  }
}

const char* payloadName(const AnyFile& file) {
  static constexpr std::array kNames{"grid4", "hypermesh", "dynamic_triangles", "surface_sequence", "patch_dag"};
  static_assert(kNames.size() == std::variant_size_v<AnyFile>);
  return kNames[file.index()];
}

nlohmann::ordered_json describe(const AnyFile& any) {
  return std::visit(
      [&](const auto& file) {
        const container::Reader& reader = file.reader();
        ordered_json out{{"payload", payloadName(any)}, {"version", reader.header().payload_version}};
        addPayload(out, file);
        out["times"] = timesJson(file.times());
        out["pages"] = pagesJson(file.pages());
        out["bytes"] = reader.header().file_bytes;
        out["sections"] = ordered_json::array();
        for (const container::SectionEntry& section : reader.sections()) {
          out["sections"].push_back({{"kind", container::fourCcText(section.kind)},
                                     {"bytes", section.bytes},
                                     {"items", section.item_count},
                                     {"offset", section.offset}});
        }
        out["provenance"] = provenanceJson(reader);
        return out;
      },
      any);
}

std::string textOf(const nlohmann::ordered_json& description) {
  std::string text;
  for (const auto& [key, value] : description.items()) {
    if (key == "sections") {
      text += "sections\n";
      for (const auto& section : value) {
        text += fmt::format("  {:<12} {} ({} items)\n", section["kind"].get<std::string>(),
                            outofcore::bytesText(section["bytes"].get<std::uint64_t>()),
                            section["items"].get<std::uint64_t>());
      }
    } else if (key == "faults") {
      for (const auto& fault : value) text += fmt::format("fault          {}\n", scalarText(fault));
    } else if (key == "bytes") {
      text += fmt::format("{:<14} {} ({})\n", key, value.dump(), outofcore::bytesText(value.get<std::uint64_t>()));
    } else if (value.is_object()) {
      text += key + "\n";
      for (const auto& [name, inner] : value.items()) text += fmt::format("  {:<12} {}\n", name, scalarText(inner));
    } else {
      text += fmt::format("{:<14} {}\n", key, scalarText(value));
    }
  }
  return text;
}

}  // namespace tet4d::info
