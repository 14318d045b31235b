#include "libpreprocess/dyntri/lifespan_bands.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace tet4d::dyntri {
namespace {

// Classes of length: quarter octaves below the whole interval, the last one without end.
constexpr std::size_t kClasses = 64;
constexpr std::uint32_t kShift = 21;  // leaves a float's exponent and the first two bits of its mantissa
// Intervals to the longest life of a band: what is processed beyond need is about one part in so many.
constexpr double kIntervalsALife = 64;
constexpr std::uint64_t kMostIntervals = std::uint64_t{1} << 20;

double lengthOf(const Lifespan& life) { return double{life.end} - double{life.begin}; }

std::size_t classOf(const Lifespan& life, double whole) {
  constexpr std::uint32_t kWhole = std::bit_cast<std::uint32_t>(1.0F) >> kShift;
  const auto part = static_cast<float>(lengthOf(life) / whole);
  const std::uint32_t below = kWhole - std::min(kWhole, std::bit_cast<std::uint32_t>(part) >> kShift);
  return std::min<std::size_t>(below, kClasses - 1);
}

struct Histogram {
  std::array<std::uint64_t, kClasses> count{};
  std::array<double, kClasses> longest{};
};

// The band of each class: runs of classes that make the sum of count * longest least.
std::array<std::size_t, kClasses> groupClasses(const Histogram& lengths, std::size_t bands) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // cost[b][c]: of the classes 0 .. c - 1 in b bands; from[b][c]: the first class of the last of them.
  std::vector<std::array<double, kClasses + 1>> cost(bands + 1);
  std::vector<std::array<std::size_t, kClasses + 1>> from(bands + 1);
  cost[0].fill(kInfinity);
  cost[0][0] = 0;
  for (std::size_t b = 1; b <= bands; ++b) {
    cost[b] = cost[b - 1];
    from[b].fill(kClasses + 1);  // none: one band less does as well
    for (std::size_t end = 1; end <= kClasses; ++end) {
      double count = 0, longest = 0;
      for (std::size_t first = end; first-- > 0;) {
        count += static_cast<double>(lengths.count[first]);
        longest = std::max(longest, lengths.longest[first]);
        const double total = cost[b - 1][first] + count * longest;
        if (total < cost[b][end]) cost[b][end] = total, from[b][end] = first;
      }
    }
  }
  std::array<std::size_t, kClasses> group{};
  std::size_t end = kClasses;
  for (std::size_t b = bands; end > 0; --b) {
    if (from[b][end] > kClasses) continue;
    std::fill(group.begin() + static_cast<std::ptrdiff_t>(from[b][end]),
              group.begin() + static_cast<std::ptrdiff_t>(end), b);
    end = from[b][end];
  }
  return group;
}

// How finely each band's time is cut, so that all fit into `most` intervals.
void cutTime(std::span<Band> bands, std::span<const double> longest, double whole, std::uint64_t most) {
  std::vector<double> wanted;
  double sum = 0;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const double parts = kIntervalsALife * whole / longest[b];
    wanted.push_back(std::min({parts, static_cast<double>(bands[b].count), static_cast<double>(kMostIntervals)}));
    sum += wanted.back();
  }
  const double room = static_cast<double>(most) - static_cast<double>(bands.size());  // an interval each is due
  const double fit = std::min(1.0, std::max(0.0, room) / sum);
  std::uint64_t first = 0;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    bands[b].first_interval = first;
    bands[b].intervals = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(wanted[b] * fit));
    first += bands[b].intervals;
  }
}

}  // namespace

BandPlan planBands(std::span<const Lifespan> lives, const Lifespan& whole, std::uint32_t bands, std::uint64_t bytes) {
  BandPlan plan;
  if (lives.empty()) return plan;
  Histogram lengths;
  const double span = lengthOf(whole);
  for (const Lifespan& life : lives) {
    const std::size_t c = classOf(life, span);
    ++lengths.count[c];
    lengths.longest[c] = std::max(lengths.longest[c], lengthOf(life));
  }
  // A quarter of the bytes for the bands themselves.
  const std::uint64_t most = std::clamp<std::uint64_t>(bytes / (4 * sizeof(Band)), 1, bands);
  const auto group = groupClasses(lengths, most);
  std::array<std::size_t, kClasses> band_of{};
  std::vector<double> longest;
  std::size_t last_group = 0;  // they count from 1
  for (std::size_t c = 0; c < kClasses; ++c) {
    if (lengths.count[c] == 0) continue;
    if (group[c] != last_group) {
      plan.bands.push_back({});
      longest.push_back(0);
      last_group = group[c];
    }
    plan.bands.back().count += lengths.count[c];
    longest.back() = std::max(longest.back(), lengths.longest[c]);
    band_of[c] = plan.bands.size() - 1;
  }
  for (std::size_t b = 1; b < plan.bands.size(); ++b)
    plan.bands[b].first = plan.bands[b - 1].first + plan.bands[b - 1].count;
  const std::uint64_t taken = plan.bands.size() * sizeof(Band);
  cutTime(plan.bands, longest, span, bytes > taken ? (bytes - taken) / sizeof(Alive) : 0);

  std::vector<Intervals> intervals;
  for (const Band& band : plan.bands) intervals.emplace_back(whole, band.intervals);
  plan.bucket.reserve(lives.size());
  for (const Lifespan& life : lives) {
    const std::size_t b = band_of[classOf(life, span)];
    // Two buckets an interval: those alive from the page's begin stand in front, by their end, so that the dead among
    // them are left behind too.
    const std::uint64_t place = life.begin == whole.begin ? intervals[b].lastOf(life.end, whole)
                                                          : plan.bands[b].intervals + intervals[b].at(life.begin);
    plan.bucket.push_back(static_cast<std::uint32_t>(2 * plan.bands[b].first_interval + place));
  }
  plan.buckets = 2 * (plan.bands.back().first_interval + plan.bands.back().intervals);
  return plan;
}

std::vector<Alive> indexBands(std::span<const Band> bands, std::span<const Lifespan> lives, const Lifespan& whole) {
  std::vector<Alive> index;
  for (const Band& band : bands) {
    const Intervals intervals(whole, band.intervals);
    const std::size_t base = index.size();
    index.resize(base + band.intervals, {static_cast<std::uint32_t>(band.count), 0});
    std::uint64_t open = 0;  // intervals that no triangle so far lives to see
    for (std::uint32_t k = 0; k < band.count; ++k) {
      const Lifespan& life = lives[band.first + k];
      for (const std::uint64_t last = intervals.lastOf(life.end, whole); open <= last; ++open)
        index[base + open].first = k;
      index[base + intervals.at(life.begin)].last = k + 1;
    }
    std::uint32_t begun = 0;
    for (Alive& run : std::span(index).subspan(base)) {
      begun = std::max(begun, run.last);
      run = {std::min(run.first, begun), begun};
    }
  }
  return index;
}

}  // namespace tet4d::dyntri
