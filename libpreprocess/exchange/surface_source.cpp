#include "libpreprocess/exchange/surface_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "formats/surface_sequence.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/file_series.h"
#include "libpreprocess/exchange/frame_file.h"
#include "libpreprocess/exchange/frame_series.h"
#include "libpreprocess/exchange/surface_file.h"

namespace tet4d::exchange {
namespace {

namespace fs = std::filesystem;

// How far off, in extents, points may lie before the origin moves to them.
constexpr double kFar = 4;
// Bits of an origin's coordinate: short, so that subtracting it is exact.
constexpr int kOriginBits = 8;

class SequenceFrames final : public SurfaceSource {
 public:
  SequenceFrames(surface_sequence::File file, const std::vector<double>& times) : file_(std::move(file)) {
    const auto triangles = unwrap(file_.triangles());
    info_.vertices = file_.header().vertices;
    info_.triangles.assign(triangles.begin(), triangles.end());
    info_.index_to_world = file_.header().index_to_world;
    info_.times = times.empty() ? std::vector<double>(file_.times().begin(), file_.times().end()) : times;
  }
  void readFrame(std::size_t k, std::span<Vec3f> positions) override {
    const surface_sequence::Frame frame = unwrap(file_.loadFrame(k));
    std::copy(frame.positions.begin(), frame.positions.end(), positions.begin());
  }
  std::string frameName(std::size_t k) const override { return file_.reader().path() + " frame " + std::to_string(k); }

 private:
  surface_sequence::File file_;
};

bool isSequenceJson(const std::string& path) { return path.ends_with(".json"); }

bool isSurfaceName(const std::string& path) {
  return !surfaceFormatOf(path).empty() || path.ends_with(".t4q") || isSequenceJson(path);
}

}  // namespace

std::string surfaceSuffixes() { return ".obj, .off, .ply, .stl"; }

bool areSurfaces(const std::vector<std::string>& inputs) {
  if (inputs.empty()) return false;
  std::error_code ignored;
  std::string mesh, other;  // the first of each kind
  const auto take = [](std::string& first, const std::string& name) {
    if (first.empty() || naturalLess(name, first)) first = name;
  };
  const bool is_directory = inputs.size() == 1 && fs::is_directory(inputs.front(), ignored);
  if (is_directory) {
    for (const auto& entry : fs::directory_iterator(inputs.front(), ignored)) {
      const std::string name = entry.path().string();
      if (!surfaceFormatOf(name).empty()) take(mesh, name);
      if (!frameFormatOf(name).empty()) take(other, name);
    }
  } else {
    for (const std::string& input : inputs) take(isSurfaceName(input) ? mesh : other, input);
  }
  if (!mesh.empty() && !other.empty()) {
    throw Error(FaultCode::kBadInput, is_directory ? inputs.front() : "", "",
                std::string(is_directory ? "a directory" : "a list") + " of two kinds: " + mesh + " is a mesh, " +
                    other + (is_directory ? " a volume" : " is none"),
                "give those of one kind, by a pattern such as a_%04d" + fs::path(mesh).extension().string());
  }
  return !mesh.empty();
}

AffineMap mapNear(std::span<const std::array<double, 3>> points) {
  AffineMap map;
  std::array<double, 3> low = points.front(), high = low;
  for (const auto& p : points) {
    for (std::size_t c = 0; c < 3; ++c) low[c] = std::min(low[c], p[c]), high[c] = std::max(high[c], p[c]);
  }
  double extent = 0;
  for (std::size_t c = 0; c < 3; ++c) extent = std::max(extent, high[c] - low[c]);
  for (std::size_t c = 0; c < 3; ++c) {
    const double middle = low[c] + (high[c] - low[c]) / 2;
    if (!(std::abs(middle) > kFar * extent)) continue;
    // Short where that still lies among the points; else as long as it must be.
    for (int bits = kOriginBits; bits <= 52; bits += 4) {
      const double step = std::ldexp(1.0, std::ilogb(middle) - bits);
      map.origin[c] = std::round(middle / step) * step;
      if (std::abs(map.origin[c] - middle) <= extent) break;
    }
  }
  return map;
}

Vec3f placed(const std::array<double, 3>& point, const AffineMap& map, const std::string& frame, std::uint64_t vertex) {
  Vec3f p{static_cast<float>(point[0] - map.origin[0]), static_cast<float>(point[1] - map.origin[1]),
          static_cast<float>(point[2] - map.origin[2])};
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    throw Error(FaultCode::kBadInput, frame, "vertex " + std::to_string(vertex),
                "a coordinate is not finite, or beyond float32", "scale the mesh down, or make the file again");
  }
  return p;
}

std::unique_ptr<SurfaceSource> openSurfaces(const std::vector<std::string>& inputs,
                                            const SurfaceSourceOptions& options) {
  if (inputs.empty()) throw Error(FaultCode::kUsage, "", "", "no frames are given", "name the frames' files");
  for (const std::string& input : inputs) {
    if (inputs.size() > 1 && surfaceFormatOf(input) != surfaceFormatOf(inputs.front())) {
      throw Error(FaultCode::kBadInput, input, "", "is not of the format of " + inputs.front(),
                  "give frames of one format; a .t4q and a sequence.json stand alone");
    }
  }
  if (inputs.size() > 1 && surfaceFormatOf(inputs.front()).empty()) {
    throw Error(FaultCode::kUsage, inputs[1], "", "several inputs, but such a file holds a whole sequence",
                "give one at a time");
  }
  const std::string& input = inputs.front();
  std::error_code ignored;
  if (fs::is_directory(input, ignored)) {
    return openSurfaceFiles(filesOfDirectory(input, surfaceFormatOf, surfaceSuffixes()), options);
  }
  if (input.ends_with(".t4q")) {
    surface_sequence::File file = unwrap(surface_sequence::File::open(input));
    if (!options.times.empty()) checkGivenTimes(options.times, file.times().size());
    return std::make_unique<SequenceFrames>(std::move(file), options.times);
  }
  if (isSequenceJson(input)) return openSurfaceArrays(input, options);
  if (inputs.size() == 1 && !fs::exists(input, ignored) && input.find('%') != std::string::npos) {
    return openSurfaceFiles(filesOfPattern(input), options);
  }
  return openSurfaceFiles(inputs, options);
}

}  // namespace tet4d::exchange
