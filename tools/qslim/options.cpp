#include "tools/qslim/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libpreprocess/column_list.h"
#include "libpreprocess/error.h"

namespace tet4d::qslim {
namespace {

// "NAME:WEIGHT,NAME": the names as a list, and the weights.
struct Weighted {
  std::string names;
  std::vector<std::optional<double>> weights;
};

// A name may have a colon in it: the part behind the last one counts as a weight only if it is a number.
Weighted splitWeights(const std::string& list) {
  Weighted weighted;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    std::string name = list.substr(begin, end - begin);
    begin = end + 1;
    std::optional<double> weight;
    if (const std::size_t colon = name.rfind(':'); colon != std::string::npos) {
      double number = 0;
      const char* last = name.data() + name.size();
      const auto [stop, fault] = std::from_chars(name.data() + colon + 1, last, number);
      if (fault == std::errc() && stop == last) {
        if (!(number > 0 && std::isfinite(number))) {
          throw Error(FaultCode::kUsage, "", "--attributes", "the weight of \"" + name + "\" is no length above 0",
                      "give world units that a change by one counts as, or leave the weight out");
        }
        weight = number;
        name.resize(colon);
      }
    }
    weighted.names += (weighted.weights.empty() ? "" : ",") + name;
    weighted.weights.push_back(weight);
  }
  return weighted;
}

std::vector<std::size_t> attributeColumns(const hypermesh::File& file, const std::string& names,
                                          const std::string& input) {
  try {
    return namedColumns(file.columns(), names, input);
  } catch (const Error& error) {
    Fault fault = error.fault();
    fault.place = "--attributes";
    throw Error(fault);
  }
}

}  // namespace

void checkOptions(const Options& options) {
  const auto refuse = [](const std::string& place, const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kUsage, "", place, what, remedy);
  };
  if (!options.ratio && !options.tets && !options.error && !options.max_error)
    refuse("", "no stop is given", "give --ratio 0.1, --tets 100000, --error 0.5 or --max-error 0.5");
  if (options.ratio && options.tets) refuse("", "--ratio and --tets are both given", "give one of the two");
  if (options.ratio && !(*options.ratio > 0 && *options.ratio <= 1))
    refuse("--ratio", "expected a number above 0 and at most 1", "give --ratio 0.1");
  if (options.error && !(*options.error >= 0)) refuse("--error", "expected a length of 0 or more", "give --error 0.5");
  if (options.max_error && !(*options.max_error > 0))
    refuse("--max-error", "expected a length above 0", "give --max-error 0.5");
  if (options.tries && (*options.tries < 1 || *options.tries > 100))
    refuse("--tries", "expected 1 to 100", "give --tries 8");
  if (options.tries && !options.max_error)
    refuse("--tries", "counts only under --max-error", "give --max-error too, or leave it out");
  if (options.align_time && !(*options.align_time >= 0))
    refuse("--align-time", "expected a number of 0 or more", "give --align-time 0.25");
  if (options.cell_tets < 1000) refuse("--cell-tets", "expected at least 1000", "leave it at its default");
  if (options.choices && *options.choices == 0) refuse("--choices", "expected at least 1", "give --choices 8");
  if (options.choices && options.order != "multichoice")
    refuse("--choices", "counts only with --order multichoice", "give --order multichoice too, or leave it out");
  if (options.most_star < 8 || options.most_star > 100'000)
    refuse("--max-star", "expected 8 to 100000", "give --max-star 80");
}

qslim4d::Metric metricOf(const Options& options) {
  return options.metric == "paper" ? qslim4d::Metric::kPaper : qslim4d::Metric::kSlice;
}

qslim4d::Options slimOptions(const Options& options, std::uint64_t seed, std::uint64_t part_tets,
                             std::uint64_t all_tets) {
  qslim4d::Options slim;
  slim.order = options.order == "heap"          ? qslim4d::Order::kHeap
               : options.order == "multichoice" ? qslim4d::Order::kMultichoice
                                                : qslim4d::Order::kPasses;
  const auto part = static_cast<double>(part_tets);
  if (options.tets && all_tets > 0) {
    slim.target_tets = part_tets == all_tets
                           ? *options.tets
                           : static_cast<std::uint64_t>(std::floor(static_cast<double>(*options.tets) *
                                                                   (part / static_cast<double>(all_tets))));
  }
  if (options.ratio) slim.target_tets = static_cast<std::uint64_t>(std::floor(*options.ratio * part));
  if (options.error) slim.most_error = *options.error;
  slim.choices = options.choices.value_or(kChoices);
  slim.seed = seed;
  if (options.align_time) slim.rules.align = *options.align_time;
  slim.rules.most_star = static_cast<std::uint32_t>(options.most_star);
  return slim;
}

std::vector<qslim4d::ColumnWish> columnWishes(const Options& options, const hypermesh::File& file) {
  std::vector<qslim4d::ColumnWish> wishes;
  for (const std::size_t column : namedColumns(file.columns(), options.columns, options.input))
    wishes.push_back({column, false, {}});
  const Weighted weighted = splitWeights(options.attributes);
  const std::vector<std::size_t> named = attributeColumns(file, weighted.names, options.input);
  for (std::size_t i = 0; i < named.size(); ++i) {
    auto wish = wishes.begin();
    while (wish != wishes.end() && wish->column != named[i]) ++wish;
    if (wish == wishes.end()) wish = wishes.insert(wishes.end(), {named[i], false, {}});
    wish->in_metric = true;
    wish->weight = weighted.weights[weighted.names == "all" ? 0 : i];
  }
  return wishes;
}

}  // namespace tet4d::qslim
