#include "tools/play/coloring.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
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

// Both ends of --range.
scene::ColorRange rangeOf(const std::string& text) {
  const std::size_t colon = text.find(':');
  const float low = numberOf(std::string_view(text).substr(0, colon));
  const float high =
      numberOf(colon == std::string::npos ? std::string_view{} : std::string_view(text).substr(colon + 1));
  return {std::min(low, high), std::max(low, high)};
}

void checkCombination(const ColoringOptions& options) {
  if (options.by == "part" && !options.color.empty())
    throw Error(FaultCode::kUsage, "", "--color-by part", "stands beside --color", "give one of the two");
  if (!options.color.empty()) return;
  for (const auto& [name, is_given] : {std::pair{"--range", !options.range.empty()},
                                       {"--scale log", options.scale == "log"},
                                       {"--reverse-map", options.reverse_map}}) {
    if (is_given) throw Error(FaultCode::kUsage, "", name, "colours nothing without --color", "give --color NAME too");
  }
  if (options.legend && options.by != "part")
    throw Error(FaultCode::kUsage, "", "--legend", "explains no colours: there are only those of the material",
                "give --color NAME or --color-by part too");
}

void setRange(const ColoringOptions& options, scene::Coloring& coloring) {
  coloring.logarithmic = options.scale == "log";
  if (options.range.empty()) return;
  const scene::ColorRange range = rangeOf(options.range);
  coloring.range = scene::RangeOf::kGiven;
  coloring.low = range.low, coloring.high = range.high;
  if (coloring.logarithmic && !(coloring.low > 0))
    throw Error(FaultCode::kUsage, "", "--scale log", "expected a --range above 0, found " + options.range,
                "give --range LO:HI with LO above 0, or leave --range out");
}

}  // namespace

scene::Coloring coloringOf(const ColoringOptions& options, const std::string& path, const dyntri::File& file) {
  checkCombination(options);
  scene::Coloring coloring;
  coloring.map = findColorMap(options.map);
  coloring.reversed = options.reverse_map;
  coloring.lit = options.shading != "none";
  if (options.shading == "file") {
    const std::size_t normal = columnAt("normal", path, file);
    if (file.columns()[normal].components != 3)
      throw Error(FaultCode::kUsage, path, "normal", "has not three components", "give --shading slice");
    coloring.normal_column = normal;
  }
  if (options.by == "part") coloring.by = scene::ColorBy::kPart;
  if (options.color.empty()) return coloring;
  const std::vector<std::string> names = namesOf(file);
  // A name may hold a colon itself: the whole word first.
  const bool whole = std::find(names.begin(), names.end(), options.color) != names.end();
  const std::size_t colon = whole ? std::string::npos : options.color.rfind(':');
  const std::string name = options.color.substr(0, colon);
  coloring.by = scene::ColorBy::kColumn;
  coloring.column = columnAt(name, path, file);
  coloring.component = componentOf(colon == std::string::npos ? "" : options.color.substr(colon + 1), name,
                                   file.columns()[coloring.column].components);
  setRange(options, coloring);
  return coloring;
}

void applyColoring(cli::Session& session, const ColoringOptions& options, const std::string& path,
                   scene::SceneFile& file) {
  const scene::Coloring coloring = coloringOf(options, path, *file.file);
  std::optional<scene::ColumnSpread> spread;
  if (coloring.needsSpread()) {
    session.progress().phase("values", file.file->geometryPages());
    spread =
        unwrap(scene::spreadOf(*file.file, coloring.column, coloring.component, [&](std::size_t done, std::size_t) {
          session.progress().step(done);  // throws after an interrupt
          return true;
        }));
    if (coloring.logarithmic && spread->least_above_zero == 0)
      throw Error(FaultCode::kUsage, path, "--scale log", "no value of " + options.color + " lies above 0",
                  "give --scale linear");
  }
  scene::apply(coloring, spread ? &*spread : nullptr, file);
  if (!spread || coloring.range == scene::RangeOf::kGiven) return;
  session.note(options.color + " from " + std::to_string(file.column->low) + " to " +
               std::to_string(file.column->high) + ": 98 % of its values; all lie in " + std::to_string(spread->least) +
               " to " + std::to_string(spread->most) + " (--range LO:HI)");
}

}  // namespace tet4d::play
