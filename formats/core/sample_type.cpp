#include "formats/core/sample_type.h"

#include <array>
#include <utility>

namespace tet4d {
namespace {

struct Row {
  SampleType type;
  std::size_t bytes;
  std::string_view name;
};
constexpr std::array<Row, 10> kRows{{{SampleType::kU8, 1, "u8"},
                                     {SampleType::kI8, 1, "i8"},
                                     {SampleType::kU16, 2, "u16"},
                                     {SampleType::kI16, 2, "i16"},
                                     {SampleType::kU32, 4, "u32"},
                                     {SampleType::kI32, 4, "i32"},
                                     {SampleType::kU64, 8, "u64"},
                                     {SampleType::kI64, 8, "i64"},
                                     {SampleType::kF32, 4, "f32"},
                                     {SampleType::kF64, 8, "f64"}}};

}  // namespace

std::size_t sampleBytes(SampleType type) {
  for (const Row& row : kRows) {
    if (row.type == type) return row.bytes;
  }
  return 0;
}

std::string_view sampleName(SampleType type) {
  for (const Row& row : kRows) {
    if (row.type == type) return row.name;
  }
  return "?";
}

std::optional<SampleType> sampleTypeOfName(std::string_view name) {
  for (const Row& row : kRows) {
    if (row.name == name) return row.type;
  }
  return std::nullopt;
}

}  // namespace tet4d
