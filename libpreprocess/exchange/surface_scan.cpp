#include "libpreprocess/exchange/surface_scan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/input_file.h"

namespace tet4d::exchange {

bool TextLines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  ++number_;
  return true;
}

bool TextLines::nextFilled() {
  while (next()) {
    line_ = line_.substr(0, line_.find('#'));
    if (line_.find_first_not_of(" \t\r") != std::string_view::npos) return true;
  }
  return false;
}

std::string_view TextLines::word() {
  const std::size_t begin = std::min(line_.find_first_not_of(" \t\r"), line_.size());
  line_.remove_prefix(begin);
  const std::string_view found = line_.substr(0, line_.find_first_of(" \t\r"));
  line_.remove_prefix(found.size());
  return found;
}

double TextLines::real(std::string_view what) {
  const std::string_view found = word();
  std::string_view digits = found;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (found.empty()) fail(std::string(what) + " is missing");
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) {
    fail(std::string(what) + " is \"" + std::string(found) + "\", not a finite number");
  }
  return value;
}

std::uint64_t TextLines::count(std::string_view what) {
  const std::string_view found = word();
  const auto value = wholeNumberOf(found);
  if (!value || *value < 0) fail(std::string(what) + " is \"" + std::string(found) + "\", not a count");
  return static_cast<std::uint64_t>(*value);
}

std::uint32_t TextLines::index(std::uint64_t vertices) {
  const std::string_view found = word();
  const auto value = wholeNumberOf(found);
  if (!value || *value < 0 || static_cast<std::uint64_t>(*value) >= vertices) {
    fail("the face names vertex \"" + std::string(found) + "\", but there are " + std::to_string(vertices));
  }
  return static_cast<std::uint32_t>(*value);
}

void TextLines::fail(const std::string& what, const std::string& remedy) const {
  throw Error(FaultCode::kBadInput, *path_, "line " + std::to_string(number_), what, remedy);
}

std::optional<std::int64_t> wholeNumberOf(std::string_view word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

const char* endFace(PolygonMesh& mesh) {
  mesh.ends.push_back(mesh.corners.size());
  const auto face = mesh.face(mesh.ends.size() - 1);
  if (face.empty()) return "the face has no corners";
  if (face.size() < 3) return "the face has fewer than three corners";
  const auto sameTwice = [](std::span<const std::uint32_t> sorted) {
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  };
  std::vector<std::uint32_t> sorted(face.begin(), face.end());
  std::sort(sorted.begin(), sorted.end());
  return sameTwice(sorted) ? "the face has a vertex twice" : nullptr;
}

std::string faceText(std::span<const std::uint32_t> face) {
  constexpr std::size_t kMostCorners = 8;
  if (face.empty()) return "no corners";
  std::string text = std::to_string(face.front());
  for (std::size_t i = 1; i < std::min(face.size(), kMostCorners); ++i)
    text.append(" ").append(std::to_string(face[i]));
  if (face.size() > kMostCorners) text.append(" ... (").append(std::to_string(face.size())).append(" corners)");
  return text;
}

std::string surfaceFormatOf(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (const char* known : {".OBJ", ".OFF", ".PLY", ".STL"})
    if (suffix == known) return suffix.substr(1);
  return "";
}

PolygonMesh readSurfaceFile(const std::string& path) {
  const InputFile file(path);
  std::string bytes(file.size(), '\0');
  file.read(0, std::as_writable_bytes(std::span(bytes)));
  const std::string format = surfaceFormatOf(path);
  if (format == "STL") return scanStl(bytes, path);
  PolygonMesh mesh = format == "OBJ"   ? scanObj(bytes, path)
                     : format == "OFF" ? scanOff(bytes, path)
                                       : scanPly(bytes, path);
  if (!mesh.ends.empty()) compareWithOpenMesh(path, bytes, mesh);
  return mesh;
}

}  // namespace tet4d::exchange
