// The scans behind surface_file.h, one a format: strict, every index and count proved against the file, nothing
// changed. Private to exchange.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "libpreprocess/exchange/surface_file.h"

namespace tet4d::exchange {

// Lines of a text, without their ends, and the words of a line. Numbers lines from 1.
class TextLines {
 public:
  TextLines(std::string_view text, const std::string& path) : rest_(text), path_(&path) {}

  // The next line; false at the end of the text.
  bool next();
  // As next(), skipping lines that are empty but for a comment (#…), which is cut off.
  bool nextFilled();
  std::string_view rest() const { return rest_; }  // behind the line in hand
  std::uint64_t number() const { return number_; }

  // The line's next word, empty at its end.
  std::string_view word();
  // The next word as a number; anything else, infinities and NaN are an error that names `what`.
  double real(std::string_view what);
  std::uint64_t count(std::string_view what);
  // The next word as a vertex number below `vertices`.
  std::uint32_t index(std::uint64_t vertices);
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = "make the file again") const;

 private:
  std::string_view rest_, line_;
  const std::string* path_;
  std::uint64_t number_ = 0;
};

// A word as a whole number, or nothing.
std::optional<std::int64_t> wholeNumberOf(std::string_view word);

// Ends the face whose corners were appended to mesh.corners last. Returns what is wrong with it, or null.
const char* endFace(PolygonMesh& mesh);

PolygonMesh scanObj(std::string_view text, const std::string& path);
PolygonMesh scanOff(std::string_view text, const std::string& path);
PolygonMesh scanPly(std::string_view bytes, const std::string& path);
PolygonMesh scanStl(std::string_view bytes, const std::string& path);

// Has OpenMesh read the file, whose bytes these are, and compares face by face with what a scan found. Throws Error as
// readSurfaceFile().
void compareWithOpenMesh(const std::string& path, std::string_view bytes, const PolygonMesh& scanned);

}  // namespace tet4d::exchange
