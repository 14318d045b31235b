// Files that must be refused: a forger changed one thing in a good file and made every checksum right again.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/formats/support/forge.h"

namespace tet4d::test {

struct BadFile {
  std::string name;    // of the case; ends with the payload's suffix
  std::string sample;  // the good file
  bool at_open;        // open() must refuse; else verify() must
  std::string place;   // the fault's
  std::string what;    // part of the fault's text
  std::function<void(Image&)> forge;
};

// Containers and page tables.
std::vector<BadFile> badTables();
// Headers, timelines, columns and pages of the payloads.
std::vector<BadFile> badContents();

// The part of them that are patch DAGs.
std::vector<BadFile> badDags();

// The bytes of a bad file, made in a folder of its own.
std::vector<std::byte> bytesOf(const BadFile& bad);

}  // namespace tet4d::test
