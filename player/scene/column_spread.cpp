#include "player/scene/column_spread.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "player/scene/draw_column.h"
#include "player/stream/column_page.h"

namespace tet4d::scene {
namespace {

constexpr std::uint64_t kMostSamples = std::uint64_t{1} << 20;

class Gathering {
 public:
  Gathering(const DrawColumn& column, std::uint64_t stride) : column_(column), stride_(stride) {}

  void add(std::span<const float> rows) {
    for (std::size_t i = 0; i + column_.components <= rows.size(); i += column_.components, ++row_) {
      const float value = columnValue(column_, rows.subspan(i, column_.components));
      if (!std::isfinite(value)) {
        ++spread_.unknown;
        continue;
      }
      ++spread_.values;
      least_ = std::min(least_, value);
      most_ = std::max(most_, value);
      if (value > 0) least_above_zero_ = std::min(least_above_zero_, value);
      if (row_ % stride_ == 0) samples_.push_back(value);
    }
  }
  ColumnSpread finish() {
    if (spread_.values == 0) return spread_;
    spread_.least = least_, spread_.most = most_;
    if (std::isfinite(least_above_zero_)) spread_.least_above_zero = least_above_zero_;
    spread_.low = samples_.empty() ? least_ : rank(0.01);
    spread_.high = samples_.empty() ? most_ : rank(0.99);
    return spread_;
  }

 private:
  float rank(double share) {
    const auto at = samples_.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(samples_.size() - 1));
    std::nth_element(samples_.begin(), at, samples_.end());
    return *at;
  }

  const DrawColumn& column_;
  std::uint64_t stride_, row_ = 0;
  float least_ = std::numeric_limits<float>::infinity(), most_ = -least_, least_above_zero_ = least_;
  std::vector<float> samples_;
  ColumnSpread spread_;
};

}  // namespace

Result<ColumnSpread> spreadOf(const dyntri::File& file, std::size_t column, int component,
                              const std::function<bool(std::size_t, std::size_t)>& go_on) {
  DrawColumn which;
  which.column = column;
  which.components = file.columns()[column].components;
  which.component = component;
  Gathering gathering(which, 1 + file.header().vertices / kMostSamples);
  const std::size_t pages = file.geometryPages();
  for (std::size_t page = 0; page < pages; ++page) {
    const auto read = stream::readColumnPage(file, column, page);
    if (!read.ok()) return read.fault();
    gathering.add(read.value().rows);
    if (!go_on(page + 1, pages))
      return Fault{FaultCode::kUsage, file.reader().path(), "", "was not read to the end", ""};
  }
  return gathering.finish();
}

}  // namespace tet4d::scene
