// What the user of hyper-qslim asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/hypermesh.h"
#include "libpreprocess/qslim4d/cells.h"
#include "libpreprocess/qslim4d/mesh_file.h"
#include "libpreprocess/qslim4d/simplify.h"
#include "tools/common/cli.h"

namespace tet4d::qslim {

inline constexpr std::uint64_t kChoices = 8, kTries = 8;

struct Options {
  std::string input, metric = "slice", order = "passes", codec = "raw", non_manifold = "refuse", columns = "all",
                     attributes = "none";
  std::optional<double> ratio, error, max_error, align_time;
  std::optional<std::uint64_t> tets, choices, tries;  // the last two as kChoices and kTries where not given
  std::uint64_t most_star = 80, measure_times = 7, cell_tets = qslim4d::kCellTets;
};

// Throws Error{kUsage} for what makes no sense.
void checkOptions(const Options& options);

qslim4d::Metric metricOf(const Options& options);

// Of a part that has `part_tets` of the file's `all_tets`: --ratio of its own, its share of --tets.
qslim4d::Options slimOptions(const Options& options, std::uint64_t seed, std::uint64_t part_tets,
                             std::uint64_t all_tets);

// The columns of --columns, then those that --attributes names besides. Throws Error{kUsage} for names that are not
// there and weights that are no numbers above 0.
std::vector<qslim4d::ColumnWish> columnWishes(const Options& options, const hypermesh::File& file);

}  // namespace tet4d::qslim
