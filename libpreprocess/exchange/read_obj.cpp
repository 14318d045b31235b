// Vertices and faces of Wavefront OBJ and of OFF, both text.
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_scan.h"

namespace tet4d::exchange {
namespace {

constexpr std::uint64_t kMostVertices = std::uint64_t{1} << 31;  // OpenMesh counts in int

std::array<double, 3> point(TextLines& lines) {
  const double x = lines.real("x"), y = lines.real("y"), z = lines.real("z");
  return {x, y, z};
}

// The vertex of a corner "v", "v/vt", "v//vn" or "v/vt/vn"; 1 is the first, -1 the last one so far.
std::uint32_t objCorner(std::string_view word, std::uint64_t vertices, const TextLines& lines) {
  const auto number = wholeNumberOf(word.substr(0, word.find('/')));
  const auto last = static_cast<std::int64_t>(vertices);
  if (!number || *number == 0 || *number > last || *number < -last) {
    lines.fail("the face names vertex \"" + std::string(word) + "\", but there are " + std::to_string(vertices) +
               " in front of it");
  }
  return static_cast<std::uint32_t>(*number > 0 ? *number - 1 : last + *number);
}

}  // namespace

PolygonMesh scanObj(std::string_view text, const std::string& path) {
  PolygonMesh mesh;
  TextLines lines(text, path);
  while (lines.nextFilled()) {
    const std::string_view key = lines.word();
    if (key == "v") {
      mesh.points.push_back(point(lines));
      if (mesh.points.size() == kMostVertices) lines.fail("has more than 2^31 - 1 vertices", "cut the mesh into parts");
    } else if (key == "f") {
      for (std::string_view word = lines.word(); !word.empty(); word = lines.word())
        mesh.corners.push_back(objCorner(word, mesh.points.size(), lines));
      if (const char* what = endFace(mesh)) lines.fail(what, "leave such faces out, in all frames alike");
    }
  }
  if (mesh.points.empty()) lines.fail("the file ends without a vertex (a line \"v x y z\")");
  return mesh;
}

PolygonMesh scanOff(std::string_view text, const std::string& path) {
  TextLines lines(text, path);
  if (!lines.nextFilled()) lines.fail("the file is empty");
  std::string_view word = lines.word();
  if (!word.ends_with("OFF")) lines.fail("the first word is not OFF");
  if (const std::string_view prefix = word.substr(0, word.size() - 3); prefix.find_first_of("4n") != prefix.npos) {
    lines.fail("the vertices are not in three dimensions (\"" + std::string(word) + "\")", "write x y z only");
  }
  const TextLines header = lines;
  if (word = lines.word(); word == "BINARY") lines.fail("binary OFF is not read", "write it as text, or as PLY");
  lines = header;
  if (word.empty() && !lines.nextFilled()) lines.fail("the counts are missing");
  const std::uint64_t vertices = lines.count("the count of vertices"), faces = lines.count("the count of faces");
  // A vertex takes six bytes, a face two: what the counts promise must be there.
  if (vertices > text.size() / 6 || vertices >= kMostVertices || faces > text.size() / 2) {
    lines.fail(std::to_string(vertices) + " vertices and " + std::to_string(faces) + " faces do not fit in " +
               std::to_string(text.size()) + " bytes");
  }
  PolygonMesh mesh;
  const auto missing = [&](const char* kind, std::uint64_t found, std::uint64_t promised) {
    lines.fail("the file ends after " + std::to_string(found) + " of " + std::to_string(promised) + " " + kind);
  };
  while (mesh.points.size() < vertices) {
    if (!lines.nextFilled()) missing("vertices", mesh.points.size(), vertices);
    mesh.points.push_back(point(lines));
  }
  while (mesh.ends.size() < faces) {
    if (!lines.nextFilled()) missing("faces", mesh.ends.size(), faces);
    for (std::uint64_t left = lines.count("the face's count of corners"); left > 0; --left)
      mesh.corners.push_back(lines.index(vertices));
    if (const char* what = endFace(mesh)) lines.fail(what, "leave such faces out, in all frames alike");
  }
  if (mesh.points.empty()) lines.fail("the file has no vertices");
  return mesh;
}

}  // namespace tet4d::exchange
