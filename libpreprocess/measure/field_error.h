// How far two fields are apart, over all samples: fed run by run, so that a whole sequence never is in memory.
#pragma once

#include <cstdint>
#include <span>

#include "libpreprocess/measure/compensated_sum.h"

namespace tet4d::measure {

class FieldError {
 public:
  // As many samples on both sides, in the same order. Samples of which one is NaN or infinite and the other is not the
  // same are counted apart; two NaN are alike.
  void add(std::span<const float> samples, std::span<const float> reference);
  void add(std::span<const double> samples, std::span<const double> reference);

  std::uint64_t samples() const { return samples_; }
  double max() const { return max_; }               // |difference|, of those that are finite
  std::uint64_t worst() const { return worst_; }    // the first sample that has it, counted over all runs
  double rms() const;                               // of those that are finite; 0 if there are none
  std::uint64_t unlike() const { return unlike_; }  // finite on one side only, or different infinities

 private:
  template <class T>
  void addAny(std::span<const T> samples, std::span<const T> reference);

  std::uint64_t samples_ = 0, finite_ = 0, unlike_ = 0, worst_ = 0;
  double max_ = 0;
  CompensatedSum squares_;
};

}  // namespace tet4d::measure
