// The sample types a grid may hold, spelled as in files and on the command line (u8 … f64).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tet4d {

enum class SampleType : std::uint32_t {
  kU8 = 1,
  kI8 = 2,
  kU16 = 3,
  kI16 = 4,
  kU32 = 5,
  kI32 = 6,
  kU64 = 7,
  kI64 = 8,
  kF32 = 9,
  kF64 = 10,
};

// Bytes of one sample; 0 for a value that is no SampleType.
std::size_t sampleBytes(SampleType type);
// "u8" … "f64"; "?" for a value that is no SampleType.
std::string_view sampleName(SampleType type);
std::optional<SampleType> sampleTypeOfName(std::string_view name);

}  // namespace tet4d
