// Tetrahedra without any order, and what is known of their slices without the rules of the builder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "tests/player/swept_mesh.h"

namespace tet4d::test {

struct Soup {
  std::vector<Vec4f> vertices;
  std::vector<hypermesh::Tet> tets;
};

// Any tetrahedra, with many equal times among them, some of one time altogether.
Soup soup(unsigned seed, std::size_t tets, int frames);

// As a file of one page; its path.
std::string writeHypermesh(const std::string& name, const Soup& soup, const std::vector<double>& times);

// Its dynamic triangles, from the rules; one run, without bands.
Page trianglesOf(const Soup& soup);

// How many triangles its slice at t has: one where the plane parts a vertex from three, two where it parts two from
// two. What lies at t is past it, but for the last time, which still belongs to what ends there.
std::uint64_t trianglesAlive(const Soup& soup, float t, float last_t);

}  // namespace tet4d::test
