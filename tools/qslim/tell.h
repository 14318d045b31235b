// What was done, for --stats and the user.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "tools/common/cli.h"
#include "tools/qslim/options.h"
#include "tools/qslim/simplify_parts.h"

namespace tet4d::qslim {

// Over all parts.
struct Sum {
  qslim4d::Stats stats;
  std::uint64_t tets = 0, vertices = 0, tets_in = 0, tries = 0, stalled_tets = 0;
  qslim4d::NonManifold non_manifold;
  double bound = 0, estimate = std::numeric_limits<double>::infinity();
};

Sum sumOf(const std::vector<SimplifiedPart>& parts);

void tell(cli::Session& session, const Options& options, const Sum& sum);

// What --max-error came to where it could not be kept; nothing has been written. Returns the exit code.
int tellFailure(cli::Session& session, const Options& options, std::uint64_t tries, double measured, double estimate);

// Bytes of the largest slice of `mesh` at one of `frames`, with what measures it, as the table of its pages tells: a
// slice has a triangle for two of the tetrahedra in the pages it is cut from.
std::uint64_t sliceBytes(const hypermesh::File& mesh, const std::vector<double>& frames);

// What the slices of the output and their columns really lost, by passes that know nothing of quadrics; the largest to
// a hundredth of a cell, or what a bounded search finds. Without memory for that a warning: the result stays.
void measure(cli::Session& session, const hypermesh::File& reference, std::uint64_t times);

}  // namespace tet4d::qslim
