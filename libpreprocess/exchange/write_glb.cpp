// glTF 2.0 in its binary form: a header, a chunk of JSON, a chunk of data. Khronos, glTF 2.0
// specification, 3.6, 3.7, 4.4.
#include <algorithm>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/column_names.h"
#include "libpreprocess/exchange/write_mesh.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {
namespace {

using nlohmann::ordered_json;

constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kDataChunk = 0x004e4942;
constexpr int kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementBuffer = 34963;

// An array of the file: 32-bit values, `components` an element.
struct Accessor {
  std::span<const std::byte> bytes;
  std::uint64_t count;
  unsigned components;
  int type, target;
};

class Document {
 public:
  // Adds an array and returns its number.
  std::size_t add(const Accessor& accessor) {
    static constexpr std::array kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", accessor.bytes.size()}, {"target", accessor.target}});
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", accessor.type},
                          {"count", accessor.count},
                          {"type", kTypes[accessor.components - 1]}});
    bytes_ += accessor.bytes.size();
    data_.push_back(accessor.bytes);
    return accessors_.size() - 1;
  }
  // The smallest and largest value of each component, which positions must have.
  void bound(std::size_t accessor, std::span<const Vec3f> points) {
    constexpr float kMost = std::numeric_limits<float>::max();
    Vec3f low{kMost, kMost, kMost}, high{-kMost, -kMost, -kMost};
    for (const Vec3f& p : points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    accessors_[accessor]["min"] = ordered_json::array({low.x, low.y, low.z});
    accessors_[accessor]["max"] = ordered_json::array({high.x, high.y, high.z});
  }

  // root: the rest of the JSON; the arrays are added to it.
  void write(const std::string& path, ordered_json root, bool force) const {
    if (!data_.empty()) {
      root["buffers"] = ordered_json::array({ordered_json{{"byteLength", bytes_}}});
      root["bufferViews"] = views_;
      root["accessors"] = accessors_;
    }
    std::string text = root.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total = 12 + 8 + text.size() + (data_.empty() ? 0 : 8 + bytes_);
    if (total > std::numeric_limits<std::uint32_t>::max()) {
      throw Error(FaultCode::kBadInput, path, "",
                  "the slice needs " + std::to_string(total) + " bytes, a .glb holds fewer than 4 GiB",
                  "write .ply or .vtp");
    }
    outofcore::OutputFile file(path, force);
    const auto word = [&](std::uint64_t value) { file.writeValue(static_cast<std::uint32_t>(value)); };
    word(kMagic), word(2), word(total);
    word(text.size()), word(kJsonChunk);
    file.write(text);
    if (!data_.empty()) {
      word(bytes_), word(kDataChunk);
      for (const auto& bytes : data_) file.write(bytes);
    }
    file.commit();
  }

 private:
  ordered_json views_ = ordered_json::array(), accessors_ = ordered_json::array();
  std::vector<std::span<const std::byte>> data_;
  std::uint64_t bytes_ = 0;
};

std::string upperCase(std::string text) {
  for (char& c : text) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return text;
}

bool isZero(const Vec3f& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

}  // namespace

void writeGlb(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  const std::array<double, 3> origin = options.as_double ? options.origin : std::array<double, 3>{0, 0, 0};
  std::vector<Vec3f> points, normals;
  points.reserve(mesh.points.size());
  for (const auto& p : mesh.points) {
    points.push_back({static_cast<float>(p[0] - origin[0]), static_cast<float>(p[1] - origin[1]),
                      static_cast<float>(p[2] - origin[2])});
  }
  for (const Vec3f& n : mesh.normals) normals.push_back(isZero(n) ? Vec3f{0, 0, 1} : n);

  Document document;
  ordered_json root{{"asset", {{"version", "2.0"}, {"generator", "tet4d"}}}, {"scene", 0}};
  ordered_json scene{{"extras", {{"time", options.time}}}};
  // An array without elements may not be: a slice without triangles is a scene without nodes.
  if (!mesh.triangles.empty()) {
    const auto floats = [&](const auto& values, unsigned components) {
      return document.add({std::as_bytes(std::span(values)), points.size(), components, kFloat, kArrayBuffer});
    };
    ordered_json attributes{{"POSITION", floats(points, 3)}};
    document.bound(attributes["POSITION"], points);
    if (!normals.empty()) attributes["NORMAL"] = floats(normals, 3);
    UniqueNames names;
    for (const MeshColumn& column : mesh.columns) {
      attributes[names.unique(std::string(1, '_').append(upperCase(identifier(column.name))))] =
          floats(column.values, column.components);
    }
    const std::size_t indices = document.add(
        {std::as_bytes(std::span(mesh.triangles)), 3 * mesh.triangles.size(), 1, kUnsignedInt, kElementBuffer});
    ordered_json triangles{{"attributes", attributes}, {"indices", indices}, {"mode", 4}};
    ordered_json geometry{{"primitives", ordered_json::array({triangles})}};
    root["meshes"] = ordered_json::array({geometry});
    ordered_json node{{"mesh", 0}};
    if (options.as_double) node["translation"] = origin;
    root["nodes"] = ordered_json::array({node});
    scene["nodes"] = ordered_json::array({0});
  }
  root["scenes"] = ordered_json::array({scene});
  document.write(path, root, options.force);
}

}  // namespace tet4d::exchange
