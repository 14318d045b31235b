#include "tests/exchange/nrrd_samples.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>

namespace tet4d::testing {

std::string gzipped(std::string_view text) {
  z_stream z{};
  EXPECT_EQ(deflateInit2(&z, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string input(text), output(deflateBound(&z, static_cast<uLong>(text.size())) + 64, '\0');
  z.next_in = reinterpret_cast<Bytef*>(input.data());
  z.avail_in = static_cast<uInt>(input.size());
  z.next_out = reinterpret_cast<Bytef*>(output.data());
  z.avail_out = static_cast<uInt>(output.size());
  EXPECT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  output.resize(z.total_out);
  deflateEnd(&z);
  return output;
}

namespace {

template <class T>
void append(std::string& text, std::uint64_t number, bool big_endian) {
  const T value = static_cast<T>(number);
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) text += bytes[big_endian ? sizeof(T) - 1 - i : i];
}

}  // namespace

std::string sampleText(SampleType type, std::size_t count, bool big_endian, std::uint64_t first) {
  std::string text;
  for (std::uint64_t i = first; i < first + count; ++i) {
    switch (type) {
      case SampleType::kU8:
        append<std::uint8_t>(text, i, big_endian);
        break;
      case SampleType::kI8:
        append<std::int8_t>(text, i, big_endian);
        break;
      case SampleType::kU16:
        append<std::uint16_t>(text, i * 257, big_endian);
        break;
      case SampleType::kI16:
        append<std::int16_t>(text, i * 259, big_endian);
        break;
      case SampleType::kU32:
        append<std::uint32_t>(text, i * 0x01020305, big_endian);
        break;
      case SampleType::kI32:
        append<std::int32_t>(text, i * 0x01020305, big_endian);
        break;
      case SampleType::kU64:
        append<std::uint64_t>(text, i * 0x0102030405060709, big_endian);
        break;
      case SampleType::kI64:
        append<std::int64_t>(text, i * 0x0102030405060709, big_endian);
        break;
      case SampleType::kF32:
        append<float>(text, i, big_endian);
        break;
      case SampleType::kF64:
        append<double>(text, i, big_endian);
        break;
    }
  }
  return text;
}

std::vector<std::byte> nativeSamples(SampleType type, std::size_t count, std::uint64_t first) {
  const std::string text = sampleText(type, count, false, first);
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

std::string smallHeader(const std::string& encoding) {
  return "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 3 2\nencoding: " + encoding + "\nendian: little\n";
}

std::string smallFile(const std::string& time_line, std::uint64_t first) {
  return smallHeader() + time_line + "\n" + sampleText(SampleType::kF32, kSmallVoxels, false, first);
}

std::vector<std::byte> frameOf(exchange::FrameSource& source, std::size_t k) {
  std::vector<std::byte> samples(static_cast<std::size_t>(source.grid().frameBytes()));
  source.readFrame(k, samples);
  return samples;
}

std::vector<std::byte> frameByLayers(exchange::FrameSource& source, std::size_t k) {
  const auto layer = static_cast<std::size_t>(source.grid().layerBytes());
  std::vector<std::byte> samples(static_cast<std::size_t>(source.grid().frameBytes()));
  for (std::uint64_t z = 0; z < source.grid().dims[2]; ++z)
    source.readLayers(k, z, z + 1, std::span(samples).subspan(static_cast<std::size_t>(z) * layer, layer));
  return samples;
}

}  // namespace tet4d::testing
