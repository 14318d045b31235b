// The largest estimate under which a simplification keeps a promise that is measured afterwards.
//
// A quadric error is an estimate of a mean; what is promised is a largest distance. So a mesh is simplified under an
// estimate, measured, and simplified again from the input under another one, until the measure says that the promise is
// kept and little would be gained by more.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

namespace tet4d::qslim4d {

struct Attempt {
  // Kept: a bound on what it measures. Not kept: something it does measure, above the promise, not always the largest.
  double measured = 0;
  bool kept = false;
  bool is_enough = false;  // it has got where it was to go (--ratio, --tets), or could not go on
};

struct PromiseOutcome {
  bool kept = false;
  // Kept: of the largest estimate that kept it, which is the last kept attempt. Not kept: of the least measured one.
  double estimate = 0, measured = std::numeric_limits<double>::infinity();
  std::uint64_t tries = 0;
};

// Calls attempt(estimate) at most `most_tries` times, in the promise's unit. The first estimate is the promise itself;
// later ones follow measured / promised where the bracket of kept and broken estimates allows, else its geometric
// mean; where nothing has been kept yet they fall by 2 to 32 times each. Ends when a kept attempt is enough, measures
// 85 % of the promise or more or what the last kept one did, or the bracket's ends are within 20 %. Each attempt that
// keeps it has a larger estimate than those before.
PromiseOutcome keepPromise(double promised, std::uint64_t most_tries,
                           const std::function<Attempt(double estimate)>& attempt);

}  // namespace tet4d::qslim4d
