#include "tools/qslim/tell.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <new>
#include <string>

#include "libpreprocess/error.h"
#include "libpreprocess/measure/column_distance.h"
#include "libpreprocess/measure/slice_distance.h"
#include "libpreprocess/qslim4d/space.h"
#include "tools/common/exit_codes.h"

namespace tet4d::qslim {
namespace {

constexpr double kToleranceInCells = 0.01;  // of the largest distance
constexpr std::uint64_t kMostPieces = 200'000;

void measureColumns(cli::Session& session, const hypermesh::File& result, const hypermesh::File& reference,
                    const std::vector<double>& frames) {
  for (const tet4d::measure::ColumnDistance& column :
       tet4d::measure::compareColumns(result, reference, frames, session.progress())) {
    session.stats().error("column_" + column.name + "_rms", column.rms);
    session.stats().error("column_" + column.name + "_max", column.max);
    char text[120];
    std::snprintf(text, sizeof text, "column %s: rms %.3g, largest %.3g of its unit", column.name.c_str(), column.rms,
                  column.max);
    session.note(text);
  }
}

// Close enough to judge a simplification by, and found at once: where all of a slice is about equally far, the exact
// maximum would be looked for in millions of pieces.
tet4d::measure::DistanceOptions distanceOptions(const AffineMap& map) {
  tet4d::measure::DistanceOptions options;
  options.tolerance = kToleranceInCells * qslim4d::spaceOf(map).cell;
  options.max_pieces = kMostPieces;
  return options;
}

// Bytes that comparing slices holds: those of both, their trees, and the pieces of the search.
std::uint64_t measureBytes(const hypermesh::File& a, const hypermesh::File& b, const std::vector<double>& frames) {
  constexpr std::uint64_t kPieceBytes = 200;
  return sliceBytes(a, frames) + sliceBytes(b, frames) + kMostPieces * kPieceBytes;
}

void compare(cli::Session& session, const hypermesh::File& reference, std::uint64_t times) {
  const hypermesh::File result = unwrap(hypermesh::File::open(session.options().output));
  const auto frames = tet4d::measure::sampleFrames(reference, times);
  const auto reserved =
      session.memory().reserve(measureBytes(reference, result, frames), "the slices that are compared");
  const tet4d::measure::DistanceOptions options = distanceOptions(reference.header().index_to_world);
  const tet4d::measure::SliceDistance distance =
      tet4d::measure::compareSlices(result, reference, frames, options, session.executor(), session.progress());
  session.stats().error("slice_rms_world", distance.rms);
  session.stats().error("slice_p99_world", distance.p99);
  session.stats().error("slice_max_world", distance.max);
  session.stats().error("slice_volume_relative", distance.volume_error);
  char text[160];
  std::snprintf(text, sizeof text, "measured at %zu times: rms %.3g, 99 %% within %.3g, largest %.3g world units",
                frames.size(), distance.rms, distance.p99, distance.max);
  session.note(text);
  measureColumns(session, result, reference, frames);
}

}  // namespace

std::uint64_t sliceBytes(const hypermesh::File& mesh, const std::vector<double>& frames) {
  constexpr std::uint64_t kTriangleBytes = 400;
  std::uint64_t most = 0;
  for (const double frame : frames) {
    std::uint64_t tets = 0;
    for (std::size_t k = 0; k < mesh.geometryPages(); ++k) {
      const paged::PageEntry& page = mesh.geometryEntry(k);
      if (page.bounds.min.t <= frame && frame <= page.bounds.max.t) tets += page.counts[2];
    }
    most = std::max(most, tets);
  }
  return most / 2 * kTriangleBytes;
}

void measure(cli::Session& session, const hypermesh::File& reference, std::uint64_t times) {
  const auto warn = [&](const std::string& why) {
    session.warn("the result is written, but not measured: " + why + "; --measure 0 leaves that out");
  };
  try {
    compare(session, reference, times);
  } catch (const Error& error) {
    if (error.fault().code != FaultCode::kOutOfMemory) throw;
    warn(error.fault().what + (error.fault().remedy.empty() ? "" : ": " + error.fault().remedy));
  } catch (const std::bad_alloc&) {
    warn("the machine has no more memory to give");
  }
}

Sum sumOf(const std::vector<SimplifiedPart>& parts) {
  Sum sum;
  for (const SimplifiedPart& part : parts) {
    sum.stats.collapses += part.stats.collapses;
    sum.stats.aligned += part.stats.aligned;
    sum.stats.rounds += part.stats.rounds;
    sum.stats.largest_error = std::max(sum.stats.largest_error, part.stats.largest_error);
    for (std::size_t i = 0; i < sum.stats.verdicts.size(); ++i) sum.stats.verdicts[i] += part.stats.verdicts[i];
    sum.tets += part.mesh.tets.size();
    sum.vertices += part.mesh.vertices.size();
    sum.tets_in += part.tets_in;
    sum.tries += part.tries;
    if (part.stats.stalled) sum.stalled_tets += part.mesh.tets.size();
    sum.non_manifold.triangles += part.non_manifold.triangles;
    sum.non_manifold.vertices += part.non_manifold.vertices;
    sum.bound = std::max(sum.bound, part.measured);
    sum.estimate = std::min(sum.estimate, part.estimate);
  }
  return sum;
}

void tell(cli::Session& session, const Options& options, const Sum& sum) {
  cli::Stats& record = session.stats();
  const qslim4d::Stats& stats = sum.stats;
  record.count("tets", sum.tets);
  record.count("vertices", sum.vertices);
  record.count("collapses", stats.collapses);
  record.count("aligned_collapses", stats.aligned);
  static constexpr std::array<const char*, 6> kVerdicts{"allowed",       "refused_walls",     "refused_links",
                                                        "refused_flips", "refused_flat_time", "refused_stars"};
  for (std::size_t i = 1; i < kVerdicts.size(); ++i) record.count(kVerdicts[i], stats.verdicts[i]);
  record.count("rounds", stats.rounds);
  record.error("quadric_world", stats.largest_error);
  char text[200];
  std::snprintf(
      text, sizeof text, "%llu -> %llu tets, %llu collapses (%.0f %% aligned in time), quadric error %.3g",
      static_cast<unsigned long long>(sum.tets_in), static_cast<unsigned long long>(sum.tets),
      static_cast<unsigned long long>(stats.collapses),
      stats.collapses == 0 ? 0.0 : 100.0 * static_cast<double>(stats.aligned) / static_cast<double>(stats.collapses),
      stats.largest_error);
  session.note(text);
  if (options.non_manifold == "keep") {
    record.count("non_manifold_triangles", sum.non_manifold.triangles);
    record.count("non_manifold_vertices", sum.non_manifold.vertices);
    std::snprintf(text, sizeof text,
                  "left as they are: %llu triangles in more than two tetrahedra, %llu vertices that are no manifold",
                  static_cast<unsigned long long>(sum.non_manifold.triangles),
                  static_cast<unsigned long long>(sum.non_manifold.vertices));
    session.note(text);
  }
  if (options.max_error) {
    record.count("tries", sum.tries);
    record.error("promised_world", *options.max_error);
    record.error("confirmed_bound_world", sum.bound);
    record.error("estimate_world", sum.estimate);
    std::snprintf(text, sizeof text,
                  "promised %.3g world units: slices at every frame and between stay within %.3g; %llu tries, "
                  "estimate %.3g",
                  *options.max_error, sum.bound, static_cast<unsigned long long>(sum.tries), sum.estimate);
    session.note(text);
  }
}

int tellFailure(cli::Session& session, const Options& options, std::uint64_t tries, double measured, double estimate) {
  session.stats().count("tries", tries);
  session.stats().error("promised_world", *options.max_error);
  session.stats().error("least_measured_world", measured);
  session.stats().error("estimate_world", estimate);
  char text[200];
  std::snprintf(text, sizeof text,
                "--max-error: %llu tries did not come to %.3g world units: the least that was measured is %.3g, "
                "under an estimate of %.3g",
                static_cast<unsigned long long>(tries), *options.max_error, measured, estimate);
  session.warn(text);
  session.warn("nothing is written; promise more, or give more --tries");
  return cli::kExitFailure;
}

}  // namespace tet4d::qslim
