// Surfaces of one file a frame as a sequence: the connectivity of the first, proved for all others; STL welded.
#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/file_series.h"
#include "libpreprocess/exchange/frame_series.h"
#include "libpreprocess/exchange/surface_file.h"
#include "libpreprocess/exchange/surface_source.h"

namespace tet4d::exchange {
namespace {

// What frames share: names, times, and the check that the vertices are as many as in the first.
class SurfaceFiles : public SurfaceSource {
 public:
  SurfaceFiles(const std::vector<std::string>& files, const SurfaceSourceOptions& options) : files_(files) {
    const auto numbers = fileNumbers(files);
    if (!options.times.empty()) {
      checkGivenTimes(options.times, files.size());
      info_.times = options.times;
      return;
    }
    if (numbers) checkNumbering(files, *numbers, options.allow_gaps);
    info_.times = countedTimes(files.size(), numbers);
  }
  std::string frameName(std::size_t k) const override { return files_[k]; }

 protected:
  void checkPoints(std::size_t k, const PolygonMesh& mesh, std::uint64_t wanted) const {
    if (mesh.points.size() == wanted) return;
    throw Error(FaultCode::kBadInput, files_[k], "",
                "has " + std::to_string(mesh.points.size()) + " vertices, but " + files_.front() + " has " +
                    std::to_string(wanted),
                "all frames must have the same connectivity");
  }
  std::vector<std::string> files_;
};

class PolygonFrames final : public SurfaceFiles {
 public:
  PolygonFrames(const std::vector<std::string>& files, const SurfaceSourceOptions& options)
      : SurfaceFiles(files, options), first_(readSurfaceFile(files.front())) {
    if (first_.ends.empty()) {
      throw Error(FaultCode::kBadInput, files.front(), "", "has no faces, and it is the first frame",
                  "the first frame must have the faces; the others may be vertices only");
    }
    info_.vertices = first_.points.size();
    info_.index_to_world = mapNear(first_.points);
    for (std::size_t f = 0; f < first_.ends.size(); ++f) {
      const auto face = first_.face(f);
      if (face.size() > 3) ++info_.polygons_cut;
      for (std::size_t i = 2; i < face.size(); ++i) info_.triangles.push_back({face[0], face[i - 1], face[i]});
    }
    first_.points = {};
  }
  void readFrame(std::size_t k, std::span<Vec3f> positions) override {
    const PolygonMesh mesh = readSurfaceFile(files_[k]);
    checkPoints(k, mesh, info_.vertices);
    if (!mesh.ends.empty()) checkFaces(k, mesh);
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i] = placed(mesh.points[i], info_.index_to_world, files_[k], i);
  }

 private:
  void checkFaces(std::size_t k, const PolygonMesh& mesh) const {
    const auto differ = [&](std::size_t f, const std::string& has, const std::string& wanted) {
      throw Error(FaultCode::kBadInput, files_[k], "face " + std::to_string(f),
                  "is " + has + ", but in " + files_.front() + " it is " + wanted,
                  "all frames must have the same faces in the same order, or only the first has any");
    };
    for (std::size_t f = 0; f < std::max(mesh.ends.size(), first_.ends.size()); ++f) {
      if (f >= mesh.ends.size()) differ(f, "missing", faceText(first_.face(f)));
      if (f >= first_.ends.size()) differ(f, faceText(mesh.face(f)), "missing");
      if (!std::ranges::equal(mesh.face(f), first_.face(f)))
        differ(f, faceText(mesh.face(f)), faceText(first_.face(f)));
    }
  }
  PolygonMesh first_;  // its faces
};

// Corners are parted into groups, finer with every frame: two stay together if they have coincided so far.
class Welding {
 public:
  explicit Welding(std::size_t corners) : group_(corners, 0), order_(corners) {
    std::iota(order_.begin(), order_.end(), 0u);
  }
  void refine(std::span<const std::array<double, 3>> points) {
    const auto bits = [&](std::uint32_t i) {
      std::array<std::uint64_t, 3> key;
      for (std::size_t c = 0; c < 3; ++c) key[c] = std::bit_cast<std::uint64_t>(points[i][c] + 0.0);  // -0 is 0
      return key;
    };
    const auto less = [&](std::uint32_t i, std::uint32_t j) {
      if (group_[i] != group_[j]) return group_[i] < group_[j];
      const auto a = bits(i), b = bits(j);
      return a != b ? a < b : i < j;
    };
    std::sort(order_.begin(), order_.end(), less);
    std::vector<std::uint32_t> finer(group_.size());
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const bool same = k > 0 && group_[order_[k]] == group_[order_[k - 1]] && bits(order_[k]) == bits(order_[k - 1]);
      finer[order_[k]] = same ? finer[order_[k - 1]] : order_[k];  // a group is called after its first corner
    }
    group_ = std::move(finer);
  }
  const std::vector<std::uint32_t>& groups() const { return group_; }

 private:
  std::vector<std::uint32_t> group_, order_;
};

class StlFrames final : public SurfaceFiles {
 public:
  StlFrames(const std::vector<std::string>& files, const SurfaceSourceOptions& options) : SurfaceFiles(files, options) {
    PolygonMesh mesh = readSurfaceFile(files.front());
    info_.index_to_world = mapNear(mesh.points);
    corners_ = mesh.points.size();
    Welding welding(corners_);
    welding.refine(mesh.points);
    for (std::size_t k = 1; k < files.size(); ++k) {
      mesh = readSurfaceFile(files[k]);
      checkPoints(k, mesh, corners_);
      welding.refine(mesh.points);
    }
    const auto& groups = welding.groups();
    std::vector<std::uint32_t> vertex(corners_);
    for (std::uint32_t i = 0; i < corners_; ++i) {
      if (groups[i] == i) {
        vertex[i] = static_cast<std::uint32_t>(corner_of_.size());
        corner_of_.push_back(i);
      } else {
        vertex[i] = vertex[groups[i]];
      }
    }
    info_.vertices = corner_of_.size();
    for (std::size_t i = 0; i < corners_; i += 3) {
      const std::array<std::uint32_t, 3> triangle{vertex[i], vertex[i + 1], vertex[i + 2]};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
        ++info_.collapsed;
      } else {
        info_.triangles.push_back(triangle);
      }
    }
  }
  void readFrame(std::size_t k, std::span<Vec3f> positions) override {
    const PolygonMesh mesh = readSurfaceFile(files_[k]);
    checkPoints(k, mesh, corners_);
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i] = placed(mesh.points[corner_of_[i]], info_.index_to_world, files_[k], i);
  }

 private:
  std::uint64_t corners_ = 0;
  std::vector<std::uint32_t> corner_of_;  // of each vertex, its first corner
};

}  // namespace

std::unique_ptr<SurfaceSource> openSurfaceFiles(const std::vector<std::string>& files,
                                                const SurfaceSourceOptions& options) {
  if (surfaceFormatOf(files.front()).empty()) {
    throw Error(FaultCode::kBadInput, files.front(), "", "is no surface: known are " + surfaceSuffixes(),
                "convert it to one of them");
  }
  if (surfaceFormatOf(files.front()) == "STL") return std::make_unique<StlFrames>(files, options);
  return std::make_unique<PolygonFrames>(files, options);
}

}  // namespace tet4d::exchange
