// Build-time program: writes the hull table to the file named on its command line. See hull_facets.h.
#include <cstdio>
#include <fstream>

#include "libpreprocess/hypermesh/hull_facets.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: hull_table_gen OUTPUT\n", stderr);
    return 2;
  }
  const std::vector<std::uint8_t> bytes = tet4d::hypermesh::serializeHullTable();
  std::ofstream out(argv[1], std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (out) return 0;
  std::fprintf(stderr, "hull_table_gen: %s: cannot be written\n", argv[1]);
  return 1;
}
