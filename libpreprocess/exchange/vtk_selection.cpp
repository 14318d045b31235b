#include "libpreprocess/exchange/vtk_selection.h"

#include <algorithm>
#include <array>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/header_text.h"
#include "libpreprocess/exchange/vtk_array.h"
#include "libpreprocess/nearest.h"

namespace tet4d::exchange {
namespace {

constexpr std::array<const char*, 2> kData{"PointData", "CellData"};

struct Candidate {
  std::string name;
  std::uint64_t components;
  bool of_cells, is_active;
};

// Numeric arrays with names, those of points first.
std::vector<Candidate> candidatesOf(const VtkDocument& document, const XmlElement& piece) {
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < kData.size(); ++i) {
    const XmlElement* data = piece.child(kData[i]);
    if (data == nullptr) continue;
    const std::string* active = data->attribute("Scalars");
    for (const XmlElement& array : data->children) {
      const std::string* name = array.attribute("Name");
      if (array.name != "DataArray" || name == nullptr || !vtkTypeOf(array)) continue;
      found.push_back({*name, vtkComponentsOf(document, array), i == 1, active != nullptr && *active == *name});
    }
  }
  return found;
}

[[noreturn]] void failSelection(const VtkDocument& document, const std::string& what, const std::string& remedy) {
  throw Error(FaultCode::kBadInput, document.path, "", what, remedy);
}

// What to do about it: the names there are, the nearest first.
std::string remedyOf(const VtkDocument& document, const XmlElement& piece, const std::string& wanted) {
  std::vector<std::string> names;
  for (const Candidate& c : candidatesOf(document, piece)) names.push_back(c.name);
  if (names.empty()) return "the file holds no numeric array of points or cells";
  const std::string near = wanted.empty() ? "" : nearestWord(splitComponent(wanted).first, names);
  return (near.empty() ? "choose one of: " : "did you mean " + near + "? The file holds: ") +
         listVtkArrays(document, piece);
}

VtkSelection selectDefault(const VtkDocument& document, const XmlElement& piece,
                           const std::vector<Candidate>& candidates) {
  std::vector<Candidate> fitting;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(fitting),
               [](const Candidate& c) { return c.is_active && c.components == 1; });
  if (fitting.empty()) {
    std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(fitting),
                 [](const Candidate& c) { return c.components == 1; });
    if (fitting.size() != 1) {
      failSelection(document, std::to_string(fitting.size()) + " scalar arrays, none of them the active one",
                    remedyOf(document, piece, ""));
    }
  }
  return {fitting.front().name, 0, fitting.front().of_cells};
}

}  // namespace

std::pair<std::string, std::optional<std::uint64_t>> splitComponent(const std::string& name) {
  const std::size_t colon = name.rfind(':');
  if (colon == std::string::npos || colon == 0) return {name, std::nullopt};
  const auto component = countOf(std::string_view(name).substr(colon + 1));
  if (!component) return {name, std::nullopt};
  return {name.substr(0, colon), component};
}

std::string listVtkArrays(const VtkDocument& document, const XmlElement& piece) {
  constexpr std::size_t kMost = 20;
  std::string list;
  const auto candidates = candidatesOf(document, piece);
  for (std::size_t i = 0; i < std::min(candidates.size(), kMost); ++i) {
    const Candidate& c = candidates[i];
    list += (i == 0 ? "" : ", ") + c.name;
    if (c.components != 1) list += " (" + std::to_string(c.components) + " components)";
    if (c.of_cells) list += " (of cells)";
  }
  return candidates.size() > kMost ? list + " …" : list;
}

VtkSelection selectVtkScalar(const VtkDocument& document, const XmlElement& piece, const std::string& wanted) {
  const auto candidates = candidatesOf(document, piece);
  if (wanted.empty()) return selectDefault(document, piece, candidates);
  const auto named = [&](const std::string& name) {
    return std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) { return c.name == name; });
  };
  if (const auto whole = named(wanted); whole != candidates.end()) {
    if (whole->components == 1) return {wanted, 0, whole->of_cells};
    failSelection(
        document,
        "the array " + inQuotes(wanted) + " has " + std::to_string(whole->components) + " components, one is needed",
        "choose one of them: " + wanted + ":0 is the first; for a magnitude, write it as an array");
  }
  const auto [name, component] = splitComponent(wanted);
  const auto array = named(name);
  if (!component || array == candidates.end()) {
    failSelection(document, "has no array " + inQuotes(wanted), remedyOf(document, piece, wanted));
  }
  if (*component >= array->components) {
    failSelection(document,
                  "the array " + inQuotes(name) + " has " + std::to_string(array->components) + " components, not " +
                      std::to_string(*component) + " and more",
                  "count them from 0: " + name + ":0 is the first");
  }
  return {name, *component, array->of_cells};
}

const XmlElement& selectedArray(const VtkDocument& document, const XmlElement& piece, const VtkSelection& selection) {
  if (const XmlElement* data = piece.child(kData[selection.of_cells ? 1 : 0])) {
    for (const XmlElement& array : data->children) {
      const std::string* name = array.attribute("Name");
      if (array.name == "DataArray" && name != nullptr && *name == selection.name) return array;
    }
  }
  document.fail(piece, "the piece has no array " + inQuotes(selection.name) + ", but the first piece has",
                "write the file again");
}

}  // namespace tet4d::exchange
