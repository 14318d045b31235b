// Sums of many doubles that keep their last digits (Neumaier's variant of Kahan's sum).
#pragma once

#include <cmath>

namespace tet4d::measure {

class CompensatedSum {
 public:
  void add(double term) {
    const double next = sum_ + term;
    // Whichever of the two is larger kept its bits; what the other lost is exact.
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
    sum_ = next;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0, lost_ = 0;
};

}  // namespace tet4d::measure
