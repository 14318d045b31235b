#include "formats/core/tet_slice.h"

namespace tet4d {

// By rank, without a branch: the pairs that stand the wrong way round tell the ranks and the permutation's parity.
TimeOrder orderByTime(float t0, float t1, float t2, float t3) {
  const unsigned w01 = t1 < t0, w02 = t2 < t0, w03 = t3 < t0, w12 = t2 < t1, w13 = t3 < t1, w23 = t3 < t2;
  TimeOrder order{};
  order.at[w01 + w02 + w03] = 0;
  order.at[1 - w01 + w12 + w13] = 1;
  order.at[2 - w02 - w12 + w23] = 2;
  order.at[3 - w03 - w13 - w23] = 3;
  order.odd = ((w01 ^ w02 ^ w03 ^ w12 ^ w13 ^ w23) & 1) != 0;
  return order;
}

}  // namespace tet4d
