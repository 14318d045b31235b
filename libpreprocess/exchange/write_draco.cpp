// Draco: quantized and entropy-coded meshes. What was lost is measured by decoding what was encoded.
#include "libpreprocess/exchange/write_mesh.h"

#ifdef TET4D_WITH_DRACO

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/column_names.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// What a decoded file says, as far as it is compared.
struct Decoded {
  std::unique_ptr<draco::Mesh> mesh;
  std::vector<std::uint32_t> vertex;  // by point: the vertex of ours that it is
};

class DracoMesh {
 public:
  DracoMesh(const WorldMesh& mesh, unsigned bits) : mesh_(mesh), bits_(static_cast<int>(bits)) {}

  // The bytes of the file by a method, and how its points are numbered; nothing if the method fails at this mesh.
  bool encode(int method, draco::EncoderBuffer& bytes, Decoded& decoded) const {
    if (!encodeOnce(method, false, bytes)) return false;
    decoded.mesh = decode(bytes);
    if (decoded.mesh == nullptr) return false;
    if (method == draco::MESH_SEQUENTIAL_ENCODING) {
      decoded.vertex.resize(decoded.mesh->num_points());
      std::iota(decoded.vertex.begin(), decoded.vertex.end(), 0u);
    } else {
      // The method numbers points anew, by the triangles alone: a second encoding that carries our numbers tells how.
      draco::EncoderBuffer numbered;
      if (!encodeOnce(method, true, numbered)) return false;
      const auto other = decode(numbered);
      if (other == nullptr || other->num_points() != decoded.mesh->num_points()) return false;
      decoded.vertex = numbersOf(*other);
    }
    return hasOurTriangles(decoded);
  }

  // Largest differences to what was to be written.
  WriteLoss lossOf(const Decoded& decoded) const {
    WriteLoss loss;
    const auto* positions = decoded.mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION);
    const auto* normals = decoded.mesh->GetNamedAttribute(draco::GeometryAttribute::NORMAL);
    for (const MeshColumn& column : mesh_.columns) loss.columns.emplace_back(column.name, 0.0);
    std::array<float, 4> value{};
    for (std::uint32_t p = 0; p < decoded.vertex.size(); ++p) {
      const std::uint32_t v = decoded.vertex[p];
      positions->GetMappedValue(draco::PointIndex(p), value.data());
      for (std::size_t c = 0; c < 3; ++c) {
        loss.position_world = std::max(loss.position_world, std::abs(double{value[c]} - mesh_.points[v][c]));
      }
      if (normals != nullptr) {
        normals->GetMappedValue(draco::PointIndex(p), value.data());
        loss.normal_degrees = std::max(loss.normal_degrees, angleTo(mesh_.normals[v], value));
      }
      for (std::size_t k = 0; k < mesh_.columns.size(); ++k) {
        const MeshColumn& column = mesh_.columns[k];
        decoded.mesh->attribute(static_cast<int>(firstColumn() + k))
            ->GetMappedValue(draco::PointIndex(p), value.data());
        for (std::size_t c = 0; c < column.components; ++c) {
          const float exact = column.values[v * column.components + c];
          if (exact == value[c] || std::isnan(exact)) continue;
          loss.columns[k].second = std::max(loss.columns[k].second, std::abs(double{value[c]} - exact));
        }
      }
    }
    return loss;
  }

 private:
  std::size_t firstColumn() const { return mesh_.normals.empty() ? 1 : 2; }

  static double angleTo(const Vec3f& n, const std::array<float, 4>& m) {
    const double length =
        std::hypot(double{n.x}, double{n.y}, double{n.z}) * std::hypot(double{m[0]}, double{m[1]}, double{m[2]});
    if (!(length > 0)) return 0;
    const double cosine = (double{n.x} * m[0] + double{n.y} * m[1] + double{n.z} * m[2]) / length;
    return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
  }

  template <class T>
  static int addAttribute(draco::Mesh& out, draco::GeometryAttribute::Type kind, draco::DataType type,
                          unsigned components, std::span<const T> values) {
    const auto stride = static_cast<std::int64_t>(components * sizeof(T));
    draco::GeometryAttribute attribute;
    attribute.Init(kind, nullptr, static_cast<std::uint8_t>(components), type, false, stride, 0);
    const int id = out.AddAttribute(attribute, true, out.num_points());
    draco::PointAttribute* stored = out.attribute(id);
    for (std::uint32_t i = 0; i < out.num_points(); ++i) {
      stored->SetAttributeValue(draco::AttributeValueIndex(i), values.data() + std::size_t{i} * components);
    }
    return id;
  }

  bool encodeOnce(int method, bool with_numbers, draco::EncoderBuffer& bytes) const {
    draco::Mesh out;
    out.set_num_points(static_cast<std::uint32_t>(mesh_.points.size()));
    out.SetNumFaces(mesh_.triangles.size());
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      const auto& [a, b, c] = mesh_.triangles[i];
      out.SetFace(draco::FaceIndex(i), {draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    }
    std::vector<std::pair<int, int>> quantized;  // attribute, bits
    std::vector<float> floats;
    for (const auto& p : mesh_.points) {
      for (const double x : p) floats.push_back(static_cast<float>(x));
    }
    using draco::GeometryAttribute;
    quantized.emplace_back(addAttribute<float>(out, GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, floats), bits_);
    if (!mesh_.normals.empty()) {
      floats.clear();
      for (const Vec3f& n : mesh_.normals) floats.insert(floats.end(), {n.x, n.y, n.z});
      // Two numbers stand for a direction: fewer bits do.
      quantized.emplace_back(addAttribute<float>(out, GeometryAttribute::NORMAL, draco::DT_FLOAT32, 3, floats),
                             std::max(2, bits_ - 4));
    }
    UniqueNames names;
    for (const MeshColumn& column : mesh_.columns) {
      const int id =
          addAttribute<float>(out, GeometryAttribute::GENERIC, draco::DT_FLOAT32, column.components, column.values);
      auto about = std::make_unique<draco::AttributeMetadata>();
      about->AddEntryString("name", names.unique(printableName(column.name)));
      out.AddAttributeMetadata(id, std::move(about));
      // Numbers that a range cannot hold are kept as they are.
      if (std::all_of(column.values.begin(), column.values.end(), [](float x) { return std::abs(x) < 1e37f; })) {
        quantized.emplace_back(id, bits_);
      }
    }
    if (with_numbers) {
      std::vector<std::uint32_t> numbers(mesh_.points.size());
      std::iota(numbers.begin(), numbers.end(), 0u);
      addAttribute<std::uint32_t>(out, GeometryAttribute::GENERIC, draco::DT_UINT32, 1, numbers);
    }
    draco::ExpertEncoder encoder(out);
    encoder.SetEncodingMethod(method);
    encoder.SetSpeedOptions(3, 3);
    if (!mesh_.triangles.empty()) {  // nothing has no range
      for (const auto& [id, bits] : quantized) encoder.SetAttributeQuantization(id, bits);
    }
    return encoder.EncodeToBuffer(&bytes).ok();
  }

  static std::unique_ptr<draco::Mesh> decode(const draco::EncoderBuffer& bytes) {
    draco::DecoderBuffer in;
    in.Init(bytes.data(), bytes.size());
    auto mesh = draco::Decoder().DecodeMeshFromBuffer(&in);
    return mesh.ok() ? std::move(mesh).value() : nullptr;
  }

  // By point: the number that the last attribute gives it.
  static std::vector<std::uint32_t> numbersOf(const draco::Mesh& mesh) {
    std::vector<std::uint32_t> numbers(mesh.num_points());
    const draco::PointAttribute* last = mesh.attribute(mesh.num_attributes() - 1);
    for (std::uint32_t p = 0; p < numbers.size(); ++p) last->GetMappedValue(draco::PointIndex(p), &numbers[p]);
    return numbers;
  }

  // Every triangle of ours, wound as it was, and no other.
  bool hasOurTriangles(const Decoded& decoded) const {
    const auto rotated = [](std::array<std::uint32_t, 3> t) {
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      return t;
    };
    Triangles theirs, ours;
    for (std::uint32_t f = 0; f < decoded.mesh->num_faces(); ++f) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t c = 0; c < 3; ++c) {
        triangle[c] = decoded.vertex[decoded.mesh->face(draco::FaceIndex(f))[c].value()];
      }
      theirs.push_back(rotated(triangle));
    }
    for (const auto& triangle : mesh_.triangles) ours.push_back(rotated(triangle));
    std::sort(theirs.begin(), theirs.end());
    std::sort(ours.begin(), ours.end());
    return theirs == ours;
  }

  const WorldMesh& mesh_;
  int bits_;
};

}  // namespace

WriteLoss writeDraco(const std::string& path, const WorldMesh& mesh, const MeshFileOptions& options) {
  outofcore::OutputFile file(path, options.force);
  const DracoMesh draco_mesh(mesh, options.draco_bits);
  // The first is the smaller, but not for every mesh; the second takes any.
  for (const int method : {int{draco::MESH_EDGEBREAKER_ENCODING}, int{draco::MESH_SEQUENTIAL_ENCODING}}) {
    draco::EncoderBuffer bytes;
    Decoded decoded;
    if (!draco_mesh.encode(method, bytes, decoded)) continue;
    file.write(std::as_bytes(std::span(bytes.data(), bytes.size())));
    file.commit();
    return draco_mesh.lossOf(decoded);
  }
  throw Error(FaultCode::kBadInput, path, "", "the Draco library cannot encode this slice", "write .ply or .glb");
}

}  // namespace tet4d::exchange

#else

#include "libpreprocess/error.h"

namespace tet4d::exchange {

WriteLoss writeDraco(const std::string& path, const WorldMesh&, const MeshFileOptions&) {
  throw Error(FaultCode::kUsage, path, "", "this build writes no Draco files",
              "build with libdraco-dev and -DTET4D_WITH_DRACO=ON, or write .glb");
}

}  // namespace tet4d::exchange

#endif
