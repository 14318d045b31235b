#include "libpreprocess/qslim4d/promise.h"

#include <algorithm>
#include <cmath>

namespace tet4d::qslim4d {
namespace {

constexpr double kNearPromise = 0.85;  // a kept attempt that measures so much of the promise is good
constexpr double kNearBracket = 1.2;   // a bracket as narrow as this is done
constexpr double kAim = 0.9;           // of the promise: what the next attempt is to measure

// Estimates known to keep the promise and known to break it.
struct Bracket {
  double kept = 0, broken = std::numeric_limits<double>::infinity();
  bool isDone() const { return kept > 0 && broken <= kNearBracket * kept; }

  double next(double estimate, double promised, double measured) const {
    const double ratio = measured > 0 ? kAim * promised / measured : std::numeric_limits<double>::infinity();
    if (kept > 0) {
      double wish = estimate * std::clamp(ratio, 1.0 / 8, 8.0);
      // Not so near a known end that nothing can be learnt.
      if (!(wish > kept * 1.05 && wish < broken / 1.05)) wish = std::sqrt(kept * broken);
      return std::isfinite(wish) ? wish : 4 * kept;
    }
    return broken * std::clamp(ratio, 1.0 / 32, 0.5);
  }
};

}  // namespace

PromiseOutcome keepPromise(double promised, std::uint64_t most_tries,
                           const std::function<Attempt(double estimate)>& attempt) {
  PromiseOutcome outcome;
  Bracket bracket;
  double estimate = promised;
  while (outcome.tries < most_tries) {
    const Attempt tried = attempt(estimate);
    ++outcome.tries;
    if (tried.kept) {
      // Nothing was held back by the estimate, or by so little that nothing came of it.
      const bool is_all = outcome.kept && tried.measured == outcome.measured;
      bracket.kept = estimate;
      outcome.kept = true, outcome.estimate = estimate, outcome.measured = tried.measured;
      if (is_all || tried.is_enough || tried.measured >= kNearPromise * promised) break;
    } else {
      bracket.broken = estimate;
      if (!outcome.kept && tried.measured < outcome.measured)
        outcome.estimate = estimate, outcome.measured = tried.measured;
    }
    if (bracket.isDone()) break;
    estimate = bracket.next(estimate, promised, tried.measured);
  }
  return outcome;
}

}  // namespace tet4d::qslim4d
