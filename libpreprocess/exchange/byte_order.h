// Bytes of samples in the other order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace tet4d::exchange {

namespace byte_order {
template <std::size_t kBytes>
void reverseEach(std::span<std::byte> samples) {
  for (std::size_t i = 0; i + kBytes <= samples.size(); i += kBytes) {
    std::reverse(samples.begin() + static_cast<std::ptrdiff_t>(i),
                 samples.begin() + static_cast<std::ptrdiff_t>(i + kBytes));
  }
}
}  // namespace byte_order

// Reverses the bytes of every sample of 1, 2, 4 or 8 bytes.
inline void swapBytes(std::span<std::byte> samples, std::size_t sample_bytes) {
  if (sample_bytes == 2) byte_order::reverseEach<2>(samples);
  if (sample_bytes == 4) byte_order::reverseEach<4>(samples);
  if (sample_bytes == 8) byte_order::reverseEach<8>(samples);
}

}  // namespace tet4d::exchange
