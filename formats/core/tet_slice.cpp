#include "formats/core/tet_slice.h"

#include <utility>

namespace tet4d {

TimeOrder orderByTime(float t0, float t1, float t2, float t3) {
  const std::array<float, 4> t{t0, t1, t2, t3};
  TimeOrder order{{0, 1, 2, 3}, false};
  for (int pass = 0; pass < 3; ++pass) {
    for (std::size_t k = 0; k + 1 < 4; ++k) {
      if (t[order.at[k + 1]] < t[order.at[k]]) {
        std::swap(order.at[k], order.at[k + 1]);
        order.odd = !order.odd;
      }
    }
  }
  return order;
}

}  // namespace tet4d
