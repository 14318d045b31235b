// A triangle mesh whose vertices move, whatever it comes from: the input of the prisms (Ponchio & Hormann 2008, sec.
// 4.2). Triangles and times are known before the first frame is read; frames are then read one at a time.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/core/coordinates.h"
#include "formats/core/vec.h"

namespace tet4d::exchange {

struct SurfaceInfo {
  std::uint64_t vertices = 0;                           // at most 2^32
  std::vector<std::array<std::uint32_t, 3>> triangles;  // three different vertices each, all in range
  AffineMap index_to_world;        // of the positions; its origin is near the first frame where that is far off
  std::vector<double> times;       // world, strictly increasing, one a frame
  std::uint64_t polygons_cut = 0;  // faces of four corners and more, cut into fans from their first corner
  std::uint64_t collapsed = 0;     // STL facets two of whose corners coincide in every frame: left out
};

class SurfaceSource {
 public:
  virtual ~SurfaceSource() = default;
  const SurfaceInfo& info() const { return info_; }
  // Reads frame k's vertices, index space: info().vertices of them, all finite. Frames in any order, growing is cheap.
  // Throws Error naming file and place: a damaged file, faces or a count of vertices that differ from the first
  // frame's, by name of the first difference.
  virtual void readFrame(std::size_t k, std::span<Vec3f> positions) = 0;
  // What to call frame k in a message: its file, or "FILE frame k".
  virtual std::string frameName(std::size_t k) const = 0;

 protected:
  SurfaceInfo info_;
};

struct SurfaceSourceOptions {
  bool allow_gaps = false;    // accept a hole in the files' numbering
  std::vector<double> times;  // overrides those of the input, if not empty
};

// Whether inputs given on a command line are surfaces, by their names and, of a directory, by what it holds. Throws
// Error naming one file of each kind where meshes and volumes are mixed.
bool areSurfaces(const std::vector<std::string>& inputs);
// ".obj, .off, …", for messages.
std::string surfaceSuffixes();

// Opens surfaces given on a command line:
// - files of one frame each (OBJ, OFF, PLY, STL), a directory of them, or a printf pattern. The first has the faces; of
//   OBJ, OFF and PLY the others have the same faces, or none. STL corners weld where they coincide, bit by bit, in
//   every frame: all files are read for that here;
// - sequence.json beside raw arrays: {"vertices", "triangles", "frames", "triangles_file" (.i32), "vertices_file"
//   (.f32, .f64 or .i16), and, where wanted, "scale", "times"}, little-endian, as they are or gzip;
// - a .t4q.
// Throws Error naming file and place. Reads the first frame, of STL all.
std::unique_ptr<SurfaceSource> openSurfaces(const std::vector<std::string>& inputs,
                                            const SurfaceSourceOptions& options = {});

// What the sources share. An origin for positions that lie around `points`: zero along an axis, or, where their middle
// is farther off than four times their extent, a short number near it. So what differences the points have stays exact.
AffineMap mapNear(std::span<const std::array<double, 3>> points);
// A world position relative to the map's origin. Throws Error where it is beyond float32.
Vec3f placed(const std::array<double, 3>& point, const AffineMap& map, const std::string& frame, std::uint64_t vertex);

std::unique_ptr<SurfaceSource> openSurfaceFiles(const std::vector<std::string>& files,
                                                const SurfaceSourceOptions& options);
std::unique_ptr<SurfaceSource> openSurfaceArrays(const std::string& json, const SurfaceSourceOptions& options);

}  // namespace tet4d::exchange
