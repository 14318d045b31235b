#include "libpreprocess/exchange/nrrd_axes.h"

#include <cmath>
#include <limits>
#include <optional>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/number_text.h"

namespace tet4d::exchange {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Axis {
  std::uint64_t size = 0;
  double spacing = kUnknown, min = kUnknown, max = kUnknown;
  bool cell = false;
  bool tells_centering = false;
  std::string kind;
  std::optional<std::vector<double>> direction;  // space directions; none if the header has none for this axis
};

// The words of a per-axis field, one an axis; empty if the field is not there.
std::vector<std::string> axisWords(const NrrdFields& fields, const std::string& name, std::size_t dimension) {
  const NrrdField* field = fields.find(name);
  if (field == nullptr) return {};
  auto words = wordsOf(field->text);
  if (words.size() != dimension) {
    fields.fail(*field,
                "\"" + name + "\" has " + std::to_string(words.size()) + " entries, but there are " +
                    std::to_string(dimension) + " axes",
                "give one entry an axis");
  }
  return words;
}

void readNumbers(const NrrdFields& fields, const std::string& name, std::vector<Axis>& axes, double Axis::*member) {
  const auto words = axisWords(fields, name, axes.size());
  for (std::size_t a = 0; a < words.size(); ++a) {
    const auto number = numberOf(words[a]);
    if (!number) {
      fields.fail(*fields.find(name), inQuotes(words[a]) + " is no number", "correct \"" + name + "\"");
    }
    axes[a].*member = *number;
  }
}

std::vector<Axis> readSizes(const NrrdFields& fields) {
  const NrrdField& field = fields.need("dimension");
  const auto dimension = countOf(field.text);
  if (!dimension || *dimension < 3 || *dimension > 5) {
    fields.fail(field,
                "dimension is " + inQuotes(field.text) + ", expected 3 (a frame) or 4 (frames along the last axis)",
                "give one 3D file a frame, or one 4D file");
  }
  std::vector<Axis> axes(*dimension);
  const NrrdField& sizes = fields.need("sizes");
  const auto words = axisWords(fields, "sizes", axes.size());
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const auto size = countOf(words[a]);
    if (!size || *size == 0) {
      fields.fail(sizes, "the size " + inQuotes(words[a]) + " is no number from 1 on", "correct \"sizes\"");
    }
    axes[a].size = *size;
  }
  return axes;
}

void readCenterings(const NrrdFields& fields, std::vector<Axis>& axes) {
  const auto words = axisWords(fields, "centerings", axes.size());
  for (std::size_t a = 0; a < words.size(); ++a) {
    axes[a].cell = words[a] == "cell";
    axes[a].tells_centering = axes[a].cell || words[a] == "node";
    if (!axes[a].tells_centering && words[a] != "none" && words[a] != "???") {
      fields.fail(*fields.find("centerings"), inQuotes(words[a]) + " is no centering", "write cell, node or none");
    }
  }
}

void readDirections(const NrrdFields& fields, std::vector<Axis>& axes) {
  const auto words = axisWords(fields, "space directions", axes.size());
  for (std::size_t a = 0; a < words.size(); ++a) {
    if (words[a] == "none" || words[a] == "???") continue;
    axes[a].direction = nrrdVector(words[a]);
    if (axes[a].direction->empty()) {
      fields.fail(*fields.find("space directions"), inQuotes(words[a]) + " is no vector", "write (x,y,z) or none");
    }
  }
}

std::vector<Axis> readAxes(const NrrdFields& fields) {
  std::vector<Axis> axes = readSizes(fields);
  readNumbers(fields, "spacings", axes, &Axis::spacing);
  readNumbers(fields, "axis mins", axes, &Axis::min);
  readNumbers(fields, "axis maxs", axes, &Axis::max);
  readCenterings(fields, axes);
  const auto kinds = axisWords(fields, "kinds", axes.size());
  for (std::size_t a = 0; a < kinds.size(); ++a) axes[a].kind = kinds[a];
  readDirections(fields, axes);
  return axes;
}

// How many axes stand before x: a scalar axis of size 1, or none. Anything else in front of space is refused.
std::size_t leadingAxes(const NrrdFields& fields, const std::vector<Axis>& axes) {
  if (axes.size() == 3) return 0;
  const bool spatial_kind = axes[0].kind == "domain" || axes[0].kind == "space";
  const bool other_kind = !axes[0].kind.empty() && axes[0].kind != "???" && !spatial_kind;
  const bool rest_directed = axes[1].direction && axes[2].direction && axes[3].direction;
  const bool outside_space = other_kind || (!axes[0].direction && rest_directed) || axes.size() == 5;
  if (!outside_space) return 0;
  if (axes[0].size == 1) return 1;
  fields.fail(
      fields.need("sizes"),
      "axis 0 is not in space and has size " + std::to_string(axes[0].size) + "; expected x, y, z and then frames",
      "choose one value a sample, or permute the axes so that frames are last (unu permute)");
}

// Position of the first sample and distance of samples along an axis without directions.
struct Line {
  double first = 0, spacing = 1;
};

Line lineOf(const Axis& axis) {
  Line line;
  const double intervals = static_cast<double>(axis.cell ? axis.size : axis.size - 1);
  if (!std::isnan(axis.spacing)) {
    line.spacing = axis.spacing;
  } else if (!std::isnan(axis.min) && !std::isnan(axis.max) && intervals > 0) {
    line.spacing = (axis.max - axis.min) / intervals;
  }
  if (!std::isnan(axis.min)) {
    line.first = axis.min;
  } else if (!std::isnan(axis.max)) {
    line.first = axis.max - intervals * line.spacing;
  }
  if (axis.cell) line.first += line.spacing / 2;
  return line;
}

void checkFinite(const NrrdFields& fields, const std::string& name, std::size_t axis, double value, bool zero_allowed) {
  if (std::isfinite(value) && (zero_allowed || value != 0)) return;
  fields.fail(*fields.find(name),
              "\"" + name + "\" of axis " + std::to_string(axis) + " is " + numberText(value) +
                  ", expected a finite number" + (zero_allowed ? "" : " that is not 0"),
              "correct \"" + name + "\"");
}

AffineMap mapOfLines(const NrrdFields& fields, const std::vector<Axis>& axes, std::size_t first) {
  AffineMap map;
  for (std::size_t c = 0; c < 3; ++c) {
    const Axis& axis = axes[first + c];
    if (fields.find("spacings") != nullptr) checkFinite(fields, "spacings", first + c, axis.spacing, false);
    if (fields.find("axis mins") != nullptr) checkFinite(fields, "axis mins", first + c, axis.min, true);
    if (fields.find("axis maxs") != nullptr) checkFinite(fields, "axis maxs", first + c, axis.max, true);
    const Line line = lineOf(axis);
    map.origin[c] = line.first;
    map.axes[c] = {0, 0, 0};
    map.axes[c][c] = line.spacing;
  }
  return map;
}

// The space origin, as many components as the directions; zero if there is none.
std::vector<double> spaceOrigin(const NrrdFields& fields, std::size_t components) {
  const NrrdField* field = fields.find("space origin");
  if (field == nullptr) return std::vector<double>(components, 0.0);
  const auto words = wordsOf(field->text);
  auto origin = words.size() == 1 ? nrrdVector(words[0]) : std::vector<double>{};
  if (origin.size() != components) {
    fields.fail(*field,
                "expected a vector of " + std::to_string(components) + " numbers, found " + inQuotes(field->text),
                "write as many numbers as \"space directions\" has in a vector");
  }
  return origin;
}

AffineMap mapOfDirections(const NrrdFields& fields, const std::vector<Axis>& axes, std::size_t first) {
  const NrrdField& field = fields.need("space directions");
  std::size_t components = 0;
  for (std::size_t a = first; a < axes.size(); ++a) {
    const bool in_space = a < first + 3;
    if (in_space && !axes[a].direction) {
      fields.fail(field, "axis " + std::to_string(a) + " is in space but has no direction", "write a vector for it");
    }
    if (!axes[a].direction) continue;
    const auto& direction = *axes[a].direction;
    if (components == 0) components = direction.size();
    if (direction.size() != components || components < 3 || components > 4) {
      fields.fail(field,
                  "a vector of " + std::to_string(direction.size()) + " numbers; expected 3, or 4 with time, in all",
                  "correct \"space directions\"");
    }
    const bool mixed = in_space ? components == 4 && direction[3] != 0
                                : components != 4 || direction[0] != 0 || direction[1] != 0 || direction[2] != 0;
    if (mixed) {
      fields.fail(field, "axis " + std::to_string(a) + " runs through space and time at once",
                  "space axes must have no time and the frame axis no space in their vectors");
    }
    if (in_space && !std::isnan(axes[a].spacing)) {
      fields.fail(field, "axis " + std::to_string(a) + " has a direction and a spacing", "leave one of them out");
    }
  }
  const auto origin = spaceOrigin(fields, components);
  AffineMap map;
  for (std::size_t c = 0; c < 3; ++c) {
    map.origin[c] = origin[c];
    for (std::size_t i = 0; i < 3; ++i) map.axes[c][i] = (*axes[first + c].direction)[i];
  }
  return map;
}

}  // namespace

NrrdAxes readNrrdAxes(const NrrdFields& fields, Centering centering) {
  std::vector<Axis> axes = readAxes(fields);
  NrrdAxes result;
  result.first_space_axis = leadingAxes(fields, axes);
  const std::size_t first = result.first_space_axis;
  result.has_frame_axis = axes.size() == first + 4;
  if (axes.size() != first + 3 && !result.has_frame_axis) {
    fields.fail(fields.need("dimension"),
                "there are " + std::to_string(axes.size()) + " axes, expected x, y, z and frames",
                "give one 3D file a frame, or one 4D file");
  }
  for (std::size_t a = first; a < first + 3; ++a) {
    if (!axes[a].tells_centering) axes[a].cell = centering == Centering::kCell;
  }
  for (const Axis& axis : axes) result.sizes.push_back(axis.size);
  for (std::size_t c = 0; c < 3; ++c) result.dims[c] = axes[first + c].size;
  if (result.has_frame_axis) result.frames = axes[first + 3].size;
  if (result.frames > kMaxFrames) {
    fields.fail(fields.need("sizes"),
                std::to_string(result.frames) + " frames, at most " + std::to_string(kMaxFrames) +
                    " can be told apart in float32",
                "divide the sequence");
  }
  const bool directed = fields.find("space directions") != nullptr;
  result.index_to_world = directed ? mapOfDirections(fields, axes, first) : mapOfLines(fields, axes, first);
  if (!isUsable(result.index_to_world)) {
    throw Error(FaultCode::kBadInput, fields.path, "header", "the axes of the grid are not finite, or lie in a plane",
                "correct \"space directions\", \"space origin\" or \"spacings\"");
  }
  return result;
}

namespace {

// Times of a list "T T T", from the key `times`.
std::vector<double> listedTimes(const NrrdFields& fields, const std::string& text, std::uint64_t frames) {
  std::vector<double> times;
  for (const std::string& word : wordsOf(text)) {
    const auto time = numberOf(word);
    if (!time || !std::isfinite(*time)) {
      throw Error(FaultCode::kBadInput, fields.path, "key times", inQuotes(word) + " is no time",
                  "write one finite number a frame");
    }
    times.push_back(*time);
  }
  if (times.size() != frames) {
    throw Error(FaultCode::kBadInput, fields.path, "key times",
                std::to_string(times.size()) + " times, but there are " + std::to_string(frames) + " frames",
                "write one number a frame");
  }
  return times;
}

std::vector<double> singleTime(const NrrdFields& fields) {
  const auto key = fields.key_values.find("time");
  if (key == fields.key_values.end()) return {};
  const auto words = wordsOf(key->second);
  const auto time = words.size() == 1 ? numberOf(words[0]) : std::nullopt;
  if (!time || !std::isfinite(*time)) {
    throw Error(FaultCode::kBadInput, fields.path, "key time", inQuotes(key->second) + " is no time",
                "write one finite number: time:=0.5");
  }
  return {*time};
}

// First time and step of the frame axis, if the header tells them.
std::optional<Line> timeLine(const NrrdFields& fields, const NrrdAxes& axes) {
  const Axis axis = readAxes(fields)[axes.first_space_axis + 3];
  if (axis.direction) return Line{spaceOrigin(fields, 4)[3], (*axis.direction)[3]};
  const bool known = !std::isnan(axis.spacing) || (!std::isnan(axis.min) && !std::isnan(axis.max) && axis.size > 1);
  return known ? std::optional(lineOf(axis)) : std::nullopt;
}

}  // namespace

std::vector<double> readNrrdTimes(const NrrdFields& fields, const NrrdAxes& axes) {
  const auto key = fields.key_values.find("times");
  std::vector<double> times;
  if (key != fields.key_values.end()) {
    times = listedTimes(fields, key->second, axes.frames);
  } else if (axes.frames == 1 && fields.key_values.contains("time")) {
    times = singleTime(fields);
  } else if (axes.has_frame_axis) {
    const auto line = timeLine(fields, axes);
    for (std::uint64_t k = 0; line && k < axes.frames; ++k) {
      times.push_back(line->first + static_cast<double>(k) * line->spacing);
    }
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::isfinite(times[k]) && (k == 0 || times[k] > times[k - 1])) continue;
    throw Error(FaultCode::kBadInput, fields.path, "frame " + std::to_string(k),
                "its time " + numberText(times[k]) + " does not come after the time of the frame before",
                "correct the times, or the spacing of the frame axis");
  }
  return times;
}

}  // namespace tet4d::exchange
