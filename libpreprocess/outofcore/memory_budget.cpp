#include "libpreprocess/outofcore/memory_budget.h"

#include <array>
#include <cstdio>
#include <limits>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {

std::string bytesText(std::uint64_t bytes) {
  static constexpr std::array kUnits{"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  if (bytes < 1024) return std::to_string(bytes) + " B";
  double value = static_cast<double>(bytes) / 1024;
  std::size_t unit = 0;
  for (; value >= 1024 && unit + 1 < kUnits.size(); ++unit) value /= 1024;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f %s", value, kUnits[unit]);
  return text.data();
}

MemoryBudget::Reservation MemoryBudget::reserve(std::uint64_t bytes, std::string_view what) {
  std::uint64_t used = used_;
  std::uint64_t wanted = 0;
  do {
    wanted = bytes > std::numeric_limits<std::uint64_t>::max() - used ? std::numeric_limits<std::uint64_t>::max()
                                                                      : used + bytes;
    if (limit_ != 0 && wanted > limit_) {
      constexpr std::uint64_t kMiB = 1024 * 1024;
      throw Error(FaultCode::kOutOfMemory, {}, {},
                  std::string(what) + " needs " + bytesText(bytes) + " while " + bytesText(used) + " are in use, but " +
                      bytesText(limit_) + " are allowed",
                  "give --memory " + std::to_string(wanted / kMiB + 1) + "M or more");
    }
  } while (!used_.compare_exchange_weak(used, wanted));
  std::uint64_t peak = peak_;
  while (peak < wanted && !peak_.compare_exchange_weak(peak, wanted)) {
  }
  return Reservation(this, bytes);
}

std::uint64_t MemoryBudget::available() const {
  if (limit_ == 0) return std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t used = used_;
  return used < limit_ ? limit_ - used : 0;
}

}  // namespace tet4d::outofcore
