#include "libpreprocess/measure/field_error.h"

#include <cmath>

namespace tet4d::measure {

template <class T>
void FieldError::addAny(std::span<const T> samples, std::span<const T> reference) {
  for (std::size_t i = 0; i < samples.size() && i < reference.size(); ++i, ++samples_) {
    const auto a = static_cast<double>(samples[i]), b = static_cast<double>(reference[i]);
    if (!std::isfinite(a) || !std::isfinite(b)) {
      if (!(a == b || (std::isnan(a) && std::isnan(b)))) ++unlike_;
      continue;
    }
    const double difference = std::abs(a - b);
    if (difference > max_) max_ = difference, worst_ = samples_;
    squares_.add(difference * difference);
    ++finite_;
  }
}

void FieldError::add(std::span<const float> samples, std::span<const float> reference) { addAny(samples, reference); }
void FieldError::add(std::span<const double> samples, std::span<const double> reference) { addAny(samples, reference); }

double FieldError::rms() const { return finite_ == 0 ? 0 : std::sqrt(squares_.value() / static_cast<double>(finite_)); }

}  // namespace tet4d::measure
