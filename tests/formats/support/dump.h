// The content of a file as lines of text, the same lines the slow readers print (docs/formats/README.md): what the C++
// reader understands, in a form that can be compared with an independent reader's.
#pragma once

#include <cstdint>
#include <string>

#include "formats/core/result.h"

namespace tet4d::test {

// All lines, each with a newline behind.
Result<std::string> dumpOf(const std::string& path, std::uint32_t payload);
// XXH3-64 of the dump, 16 hex digits.
Result<std::string> digestOf(const std::string& path, std::uint32_t payload);
// paged::Pages::contentDigest(), 16 hex digits.
Result<std::string> pageDigestOf(const std::string& path);
// A hypermesh's slice at t (frames), as `read_hypermesh.py --slice` prints it.
Result<std::string> dumpSlice(const std::string& path, float t);

}  // namespace tet4d::test
