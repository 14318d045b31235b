#include "libpreprocess/hypermesh/hull_table.h"

#include <algorithm>

// The assembler puts the generated file into read-only data; compiling 3.4 MB of initializers would take a minute.
asm(".pushsection .rodata\n"
    ".balign 64\n"
    ".globl tet4d_hull_table_begin\n"
    "tet4d_hull_table_begin:\n"
    ".incbin \"hull_table.bin\"\n"
    ".globl tet4d_hull_table_end\n"
    "tet4d_hull_table_end:\n"
    ".popsection\n");

extern "C" {
extern const std::uint32_t tet4d_hull_table_begin[];
extern const std::uint8_t tet4d_hull_table_end[];
}

namespace tet4d::hypermesh {
namespace {

struct HullTable {
  std::vector<CellEdge> edges;
  std::vector<EdgeDirection> directions;
  CellTable table;

  HullTable() {
    directions = numberEdges(std::array<std::uint8_t, 4>{1, 2, 4, 8}, edges);
    const auto* tets = reinterpret_cast<const CellTet*>(tet4d_hull_table_begin + kConfigurations + 1);
    const auto* end = reinterpret_cast<const CellTet*>(tet4d_hull_table_end);
    table = {directions, edges, {tet4d_hull_table_begin, kConfigurations + 1}, {tets, end}, 0};
    for (unsigned c = 0; c < kConfigurations; ++c) table.max_tets = std::max(table.max_tets, table.count(c));
  }
};

}  // namespace

const CellTable& hullTable() {
  static const HullTable instance;
  return instance.table;
}

}  // namespace tet4d::hypermesh
