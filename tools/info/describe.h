// What tet4d-info says about a file, as JSON; the text form is made from the same.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "formats/dynamic_triangles.h"
#include "formats/grid4.h"
#include "formats/hypermesh.h"
#include "formats/patch_dag.h"
#include "formats/surface_sequence.h"

namespace tet4d::info {

using AnyFile = std::variant<grid4::File, hypermesh::File, dyntri::File, surface_sequence::File, patch_dag::File>;

// Opens a file of any known payload. Fault as the payload's open(); an unknown payload is kBadInput.
Result<AnyFile> open(const std::string& path);

// "grid4", "hypermesh", "dynamic_triangles", "surface_sequence", "patch_dag".
const char* payloadName(const AnyFile& file);

// {"payload", "version", "counts", "bounds" (world units, the fourth number is time), "bytes", "sections",
// "provenance"} and what else the payload has to tell. O(pages) for the sums over the page table.
nlohmann::ordered_json describe(const AnyFile& file);

// The lines of the text form, for a description with or without the results of a validation.
std::string textOf(const nlohmann::ordered_json& description);

}  // namespace tet4d::info
