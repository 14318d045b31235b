#include "tools/play/coloring.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "libpreprocess/error.h"

namespace tet4d::play {
namespace {

std::vector<std::string> namesOf(const dyntri::File& file) {
  std::vector<std::string> names;
  for (const ColumnEntry& column : file.columns())
    names.emplace_back(column.name, strnlen(column.name, sizeof column.name));
  return names;
}

// The column called `name`.
std::size_t columnAt(const std::string& name, const std::string& path, const dyntri::File& file) {
  const std::vector<std::string> names = namesOf(file);
  std::string list;
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (names[c] == name) return c;
    list += (list.empty() ? "" : ", ") + names[c];
  }
  const std::string near = cli::nearest(name, names);
  const std::string remedy = names.empty() ? "build the hypermesh with columns: tet4d-mc --normals, --velocity, --field"
                             : near.empty() ? "its columns are: " + list
                                            : "did you mean " + near + "? Its columns are: " + list;
  throw Error(FaultCode::kUsage, path, "", "has no column \"" + name + "\"", remedy);
}

// The component after the colon; without one the first of one, the length of more.
int componentOf(const std::string& word, const std::string& name, std::uint32_t components) {
  if (word.empty()) return components == 1 ? 0 : scene::kMagnitude;
  if (word == "magnitude") return scene::kMagnitude;
  int component = -1;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), component);
  if (error != std::errc{} || end != word.data() + word.size() || component < 0 ||
      component >= static_cast<int>(components)) {
    throw Error(FaultCode::kUsage, "", "--color",
                "found component \"" + word + "\" of " + name + ", expected 0 to " + std::to_string(components - 1) +
                    " or magnitude",
                "give --color " + name + ":0 or --color " + name + ":magnitude");
  }
  return component;
}

float numberOf(std::string_view text) {
  float number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) {
    throw Error(FaultCode::kUsage, "", "--range", "found \"" + std::string(text) + "\", expected a finite number",
                "give --range LO:HI, as --range 0:2.5");
  }
  return number;
}

// Where a column's finite values lie: all of them, and without a hundredth at either end, for a few odd ones must not
// take all colours.
struct ValueSpread {
  float low = 0, high = 1, least = 0, most = 1;
};

// Of every value in small files, of evenly taken ones in large ones. O(the column), memory of a page of it.
ValueSpread spreadOf(const std::string& name, const dyntri::File& file, const scene::DrawColumn& column) {
  constexpr std::uint64_t kMostSamples = std::uint64_t{1} << 20;
  const std::uint64_t stride = 1 + file.header().vertices / kMostSamples;
  std::vector<float> samples;
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    const paged::PageBytes page = unwrap(file.loadColumn(column.column, k));
    std::vector<float> rows(file.geometryEntry(k).counts[0] * column.components);
    if (page.bytes().size() < rows.size() * sizeof(float))
      throw Error(FaultCode::kBadInput, file.reader().path(), "page " + std::to_string(k),
                  "has too few values of " + name, "make the file again");
    if (!rows.empty()) std::memcpy(rows.data(), page.bytes().data(), rows.size() * sizeof(float));
    scene::extendRange(rows, column, least, most);
    for (std::uint64_t v = 0; v < file.geometryEntry(k).counts[0]; v += stride) {
      const float value = scene::columnValue(column, std::span(rows).subspan(v * column.components, column.components));
      if (std::isfinite(value)) samples.push_back(value);
    }
  }
  if (samples.empty()) return {};
  const auto rank = [&](double share) {
    const auto at = samples.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(samples.size() - 1));
    std::nth_element(samples.begin(), at, samples.end());
    return *at;
  };
  return {rank(0.01), rank(0.99), least, most};
}

void setRange(cli::Session& session, const Coloring& coloring, const dyntri::File& file, scene::DrawColumn& column) {
  if (!coloring.range.empty()) {
    const std::size_t colon = coloring.range.find(':');
    column.low = numberOf(std::string_view(coloring.range).substr(0, colon));
    column.high =
        numberOf(colon == std::string::npos ? std::string_view{} : std::string_view(coloring.range).substr(colon + 1));
    if (column.low > column.high) std::swap(column.low, column.high);
    return;
  }
  const ValueSpread spread = spreadOf(coloring.color, file, column);
  column.low = spread.low, column.high = spread.high;
  session.note(coloring.color + " from " + std::to_string(column.low) + " to " + std::to_string(column.high) +
               ": 98 % of its values; all lie in " + std::to_string(spread.least) + " to " +
               std::to_string(spread.most) + " (--range LO:HI)");
}

}  // namespace

void applyColoring(cli::Session& session, const Coloring& coloring, const std::string& path, scene::SceneFile& file) {
  if (coloring.shading == "file") {
    const std::size_t normal = columnAt("normal", path, *file.file);
    if (file.file->columns()[normal].components != 3)
      throw Error(FaultCode::kUsage, path, "normal", "has not three components", "give --shading slice");
    file.normal_column = normal;
  }
  if (coloring.color.empty()) {
    if (coloring.range.empty()) return;
    throw Error(FaultCode::kUsage, "", "--range", "colours nothing without --color", "give --color NAME too");
  }
  const std::vector<std::string> names = namesOf(*file.file);
  // A name may hold a colon itself: the whole word first.
  const bool whole = std::find(names.begin(), names.end(), coloring.color) != names.end();
  const std::size_t colon = whole ? std::string::npos : coloring.color.rfind(':');
  const std::string name = coloring.color.substr(0, colon);
  const std::size_t number = columnAt(name, path, *file.file);
  const std::uint32_t components = file.file->columns()[number].components;
  const int component =
      componentOf(colon == std::string::npos ? "" : coloring.color.substr(colon + 1), name, components);
  scene::DrawColumn column = scene::makeDrawColumn(number, components, component, 0, 1, *findColorMap(coloring.map));
  setRange(session, coloring, *file.file, column);
  file.column = column;
}

}  // namespace tet4d::play
