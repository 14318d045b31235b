#include "libpreprocess/exchange/vtk_array.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/byte_order.h"
#include "libpreprocess/exchange/header_text.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/vtk_bytes.h"

namespace tet4d::exchange {
namespace {

constexpr std::size_t kWindowBytes = std::size_t{1} << 16;
constexpr const char* kMakeAgain = "copy or make the file again";

constexpr std::array<std::pair<std::string_view, SampleType>, 10> kTypes{{
    {"UInt8", SampleType::kU8},
    {"Int8", SampleType::kI8},
    {"UInt16", SampleType::kU16},
    {"Int16", SampleType::kI16},
    {"UInt32", SampleType::kU32},
    {"Int32", SampleType::kI32},
    {"UInt64", SampleType::kU64},
    {"Int64", SampleType::kI64},
    {"Float32", SampleType::kF32},
    {"Float64", SampleType::kF64},
}};

// Calls `visit` with a value of the type's C++ type.
template <class Visit>
auto withType(SampleType type, Visit visit) {
  switch (type) {
    case SampleType::kU8:
      return visit(std::uint8_t{});
    case SampleType::kI8:
      return visit(std::int8_t{});
    case SampleType::kU16:
      return visit(std::uint16_t{});
    case SampleType::kI16:
      return visit(std::int16_t{});
    case SampleType::kU32:
      return visit(std::uint32_t{});
    case SampleType::kI32:
      return visit(std::int32_t{});
    case SampleType::kU64:
      return visit(std::uint64_t{});
    case SampleType::kI64:
      return visit(std::int64_t{});
    case SampleType::kF32:
      return visit(float{});
    default:
      return visit(double{});
  }
}

// Uncompressed values behind their size.
class PlainArray final : public VtkArray {
 public:
  PlainArray(std::unique_ptr<VtkBytes> bytes, bool swap) : bytes_(std::move(bytes)), swap_(swap) {}
  void read(std::uint64_t first, std::span<std::byte> samples) override {
    bytes_->read(first * sampleBytes(type_), samples);
    if (swap_) swapBytes(samples, sampleBytes(type_));
  }

 private:
  std::unique_ptr<VtkBytes> bytes_;
  bool swap_;
};

// The blocks of vtkZLibDataCompressor: each is a zlib stream of its own; all but the last decode to block_bytes.
class ZlibArray final : public VtkArray {
 public:
  struct Blocks {
    std::uint64_t block_bytes = 0;      // of a full block, decoded
    std::uint64_t bytes = 0;            // of all blocks, decoded
    std::vector<std::uint64_t> begins;  // of each block in the compressed data, and their end
  };

  ZlibArray(std::unique_ptr<VtkBytes> bytes, Blocks blocks, bool swap)
      : bytes_(std::move(bytes)), blocks_(std::move(blocks)), swap_(swap), window_(kWindowBytes / 4) {
    if (inflateInit(&z_) != Z_OK) throw Error(FaultCode::kOutOfMemory, "", "", "no memory for zlib", "close programs");
  }
  ~ZlibArray() override { inflateEnd(&z_); }
  ZlibArray(const ZlibArray&) = delete;
  ZlibArray& operator=(const ZlibArray&) = delete;

  void read(std::uint64_t first, std::span<std::byte> samples) override {
    std::uint64_t at = first * sampleBytes(type_);
    for (std::size_t done = 0; done < samples.size();) {
      const std::uint64_t block = at / blocks_.block_bytes, inside = at % blocks_.block_bytes;
      if (block != block_ || inside < decoded_) begin(block);
      skipTo(inside);
      const auto part =
          static_cast<std::size_t>(std::min<std::uint64_t>(samples.size() - done, blockBytes(block) - inside));
      decode(samples.subspan(done, part));
      done += part, at += part;
    }
    if (swap_) swapBytes(samples, sampleBytes(type_));
  }

 private:
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t blockBytes(std::uint64_t block) const {
    return std::min(blocks_.block_bytes, blocks_.bytes - block * blocks_.block_bytes);
  }
  void begin(std::uint64_t block) {
    inflateReset(&z_);
    block_ = block, decoded_ = 0;
    next_ = blocks_.begins[block];
    z_.avail_in = 0;
  }
  void skipTo(std::uint64_t inside) {
    std::array<std::byte, 4096> sink;
    while (decoded_ < inside) {
      decode(std::span(sink).first(static_cast<std::size_t>(std::min<std::uint64_t>(sink.size(), inside - decoded_))));
    }
  }
  [[noreturn]] void failBlock(const std::string& what) const { fail("block " + std::to_string(block_), what); }

  // The next bytes of the block; with its last ones its checksum is proved.
  void decode(std::span<std::byte> out) {
    for (std::size_t done = 0; done < out.size();) {
      const std::size_t room = std::min<std::size_t>(out.size() - done, std::size_t{1} << 30);
      const std::size_t got = inflateSome(out.subspan(done, room));
      if (got == 0)
        failBlock("decodes to " + std::to_string(decoded_) + " bytes, expected " + std::to_string(blockBytes(block_)));
      done += got, decoded_ += got;
    }
    if (decoded_ < blockBytes(block_)) return;
    std::byte extra;
    if (inflateSome(std::span(&extra, 1)) != 0) {
      failBlock("decodes to more than the expected " + std::to_string(blockBytes(block_)) + " bytes");
    }
  }

  // Decodes up to out.size() bytes; none only where the stream has ended.
  std::size_t inflateSome(std::span<std::byte> out) {
    z_.next_out = reinterpret_cast<Bytef*>(out.data());
    z_.avail_out = static_cast<uInt>(out.size());
    for (;;) {
      const std::uint64_t end = blocks_.begins[block_ + 1];
      if (z_.avail_in == 0 && next_ < end) {
        const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(window_.size(), end - next_));
        bytes_->read(next_, std::span(window_).first(part));
        next_ += part;
        z_.next_in = reinterpret_cast<Bytef*>(window_.data());
        z_.avail_in = static_cast<uInt>(part);
      }
      const bool had_input = z_.avail_in > 0;
      const int outcome = inflate(&z_, Z_NO_FLUSH);
      const std::size_t got = out.size() - z_.avail_out;
      if (outcome == Z_STREAM_END || (got > 0 && outcome == Z_OK)) return got;
      if (outcome == Z_MEM_ERROR) {
        throw Error(FaultCode::kOutOfMemory, path_, "", "no memory for zlib", "close other programs");
      }
      if (outcome != Z_OK && outcome != Z_BUF_ERROR) {
        failBlock(std::string("is broken: ") + (z_.msg != nullptr ? z_.msg : "it asks for a dictionary"));
      }
      if (!had_input && next_ >= end) failBlock("is cut off after " + std::to_string(decoded_ + got) + " bytes");
    }
  }

  std::unique_ptr<VtkBytes> bytes_;
  Blocks blocks_;
  bool swap_;
  z_stream z_{};
  std::vector<std::byte> window_;
  std::uint64_t block_ = kNone;  // the open one
  std::uint64_t decoded_ = 0;    // its bytes so far
  std::uint64_t next_ = 0;       // the next compressed byte
};

// Numbers as text.
class TextArray final : public VtkArray {
 public:
  TextArray(std::shared_ptr<const InputFile> file, std::uint64_t begin, std::uint64_t end)
      : file_(std::move(file)), begin_(begin), end_(end), window_(kWindowBytes) {
    restart();
  }

  void read(std::uint64_t first, std::span<std::byte> samples) override {
    if (first < position_) restart();
    for (; position_ < first; ++position_) word();
    withType(type_, [&](auto zero) {
      using T = decltype(zero);
      for (std::size_t at = 0; at < samples.size(); at += sizeof(T), ++position_) {
        const T value = valueOf<T>(word());
        std::memcpy(samples.data() + at, &value, sizeof value);
      }
    });
  }

 private:
  static constexpr std::size_t kMaxWordBytes = 1024;
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  void restart() { window_begin_ = begin_, used_ = filled_ = 0, position_ = 0; }

  // Keeps what is not used yet and reads on behind it.
  void refill() {
    std::memmove(window_.data(), window_.data() + used_, filled_ - used_);
    window_begin_ += used_, filled_ -= used_, used_ = 0;
    const std::uint64_t at = window_begin_ + filled_;
    const auto room = static_cast<std::size_t>(std::min<std::uint64_t>(window_.size() - filled_, end_ - at));
    filled_ += file_->readSome(at, std::as_writable_bytes(std::span(window_)).subspan(filled_, room));
  }

  // The next word; valid until the next one is asked for.
  std::string_view word() {
    while (used_ < filled_ && isBlank(window_[used_])) ++used_;
    if (filled_ - used_ <= kMaxWordBytes) refill();
    while (used_ < filled_ && isBlank(window_[used_])) {
      if (++used_ == filled_) refill();
    }
    if (used_ == filled_) {
      fail("byte " + std::to_string(window_begin_ + used_),
           "the text ends after " + std::to_string(position_) + " values, expected " + std::to_string(values_));
    }
    std::size_t end = used_;
    while (end < filled_ && !isBlank(window_[end])) ++end;
    if (end - used_ > kMaxWordBytes) failWord({window_.data() + used_, 60});
    const std::string_view word(window_.data() + used_, end - used_);
    used_ = end;
    return word;
  }

  [[noreturn]] void failWord(std::string_view word) const {
    fail("value " + std::to_string(position_),
         inQuotes(word) + " is no number of the type " + std::string(sampleName(type_)));
  }

  template <class T>
  T valueOf(std::string_view word) const {
    std::string_view digits = word;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    T value{};
    auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if constexpr (std::is_floating_point_v<T>) {
      if (error == std::errc::result_out_of_range) {  // too small, which is 0, or too large, which is refused
        double wide = 0;
        const auto again = std::from_chars(digits.data(), digits.data() + digits.size(), wide);
        const bool is_small = again.ec == std::errc{} ? std::abs(wide) < 1 : digits.find("e-") != digits.npos;
        if (is_small) value = static_cast<T>(wide), error = {};
      }
    }
    if (error != std::errc{} || end != digits.data() + digits.size()) failWord(word);
    return value;
  }

  std::shared_ptr<const InputFile> file_;
  std::uint64_t begin_, end_;
  std::vector<char> window_;
  std::uint64_t window_begin_ = 0;
  std::size_t used_ = 0, filled_ = 0;
  std::uint64_t position_ = 0;  // values read
};

// No value: nothing of the file is read.
class EmptyArray final : public VtkArray {
 public:
  void read(std::uint64_t /*first*/, std::span<std::byte> /*samples*/) override {}
};

// Opens one array: what the document says of it, proved.
class Opener {
 public:
  Opener(const VtkDocument& document, const XmlElement& array, std::shared_ptr<const InputFile> file,
         std::uint64_t bytes)
      : document_(document), array_(array), file_(std::move(file)), bytes_(bytes) {}

  std::unique_ptr<VtkArray> open(std::uint64_t values) {
    const std::string& format = document_.need(array_, "format");
    if (format == "ascii") return openText(values);
    if (format != "binary" && format != "appended") {
      fail("its format is " + inQuotes(format) + ", expected ascii, binary or appended");
    }
    std::unique_ptr<VtkBytes> data = format == "appended" ? appended() : inlined();
    return document_.compressor.empty() ? openPlain(std::move(data)) : openBlocks(std::move(data));
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = kMakeAgain) const {
    document_.fail(array_, what, remedy);
  }

  std::unique_ptr<VtkArray> openText(std::uint64_t values) const {
    const std::uint64_t bytes = array_.text_end - array_.text_begin;
    if (values > bytes / 2 + 1) {
      fail("its text of " + std::to_string(bytes) + " bytes cannot hold " + std::to_string(values) + " values");
    }
    return std::make_unique<TextArray>(file_, array_.text_begin, array_.text_end);
  }

  std::unique_ptr<VtkBytes> inlined() const { return base64Bytes(file_, array_.text_begin, array_.text_end); }

  std::unique_ptr<VtkBytes> appended() const {
    if (!document_.appended) fail("its data are appended, but the file has no <AppendedData>");
    const std::uint64_t offset = document_.needCount(array_, "offset");
    const std::uint64_t begin = document_.appended->begin, end = file_->size();
    if (begin > end || offset > end - begin) {
      fail("its offset is " + std::to_string(offset) + ", but " + std::to_string(end - std::min(begin, end)) +
           " bytes are appended");
    }
    return document_.appended->base64 ? base64Bytes(file_, begin + offset, end) : rawBytes(file_, begin + offset, end);
  }

  std::uint64_t wordBytes() const { return document_.wide_headers ? 8 : 4; }

  // The sizes that stand before the data.
  void readWords(VtkBytes& data, std::uint64_t first, std::span<std::uint64_t> words) const {
    std::array<std::byte, 4096> raw;
    const std::size_t most = raw.size() / wordBytes();
    for (std::size_t done = 0; done < words.size();) {
      const std::size_t part = std::min(most, words.size() - done);
      const auto bytes = std::span(raw).first(part * wordBytes());
      data.read((first + done) * wordBytes(), bytes);
      if (document_.big_endian) swapBytes(bytes, wordBytes());
      for (std::size_t i = 0; i < part; ++i) {
        std::uint32_t narrow = 0;
        if (document_.wide_headers) {
          std::memcpy(&words[done + i], bytes.data() + i * 8, 8);
        } else {
          std::memcpy(&narrow, bytes.data() + i * 4, 4);
          words[done + i] = narrow;
        }
      }
      done += part;
    }
  }

  void expectRoom(const VtkBytes& data, std::uint64_t bytes, const std::string& what) const {
    if (bytes <= data.most()) return;
    fail("the file is short: " + std::to_string(bytes) + " bytes of " + what + " are needed, at most " +
         std::to_string(data.most()) + " are there");
  }

  std::unique_ptr<VtkArray> openPlain(std::unique_ptr<VtkBytes> data) const {
    expectRoom(*data, wordBytes(), "its size");
    std::uint64_t size = 0;
    readWords(*data, 0, std::span(&size, 1));
    if (size != bytes_) {
      fail("its data are " + std::to_string(size) + " bytes, but " + std::to_string(bytes_) + " are expected",
           document_.wide_headers || bytes_ <= std::numeric_limits<std::uint32_t>::max()
               ? kMakeAgain
               : "write the file with header_type=\"UInt64\": it is too large for 32-bit sizes");
    }
    auto values = data->from(wordBytes());
    expectRoom(*values, bytes_, "data");
    return std::make_unique<PlainArray>(std::move(values), document_.big_endian);
  }

  std::unique_ptr<VtkArray> openBlocks(std::unique_ptr<VtkBytes> data) const {
    if (document_.compressor != "vtkZLibDataCompressor") {
      throw Error(FaultCode::kBadInput, document_.path, "line " + std::to_string(document_.root.line),
                  "the data are compressed by " + inQuotes(document_.compressor) + ", which is not read",
                  "write the file uncompressed or with vtkZLibDataCompressor");
    }
    expectRoom(*data, 3 * wordBytes(), "its table of blocks");
    std::array<std::uint64_t, 3> head{};  // blocks, bytes of a block, bytes of a partial last block or 0
    readWords(*data, 0, head);
    const auto [count, block_bytes, last_bytes] = head;
    if (count == 0 || count > data->most() / wordBytes() - 3 || block_bytes == 0 || last_bytes > block_bytes) {
      fail("its table of blocks is impossible: " + std::to_string(count) + " blocks of " + std::to_string(block_bytes) +
           " bytes, the last of " + std::to_string(last_bytes));
    }
    const std::uint64_t full = last_bytes == 0 ? count : count - 1;
    if (full > (std::numeric_limits<std::uint64_t>::max() - last_bytes) / block_bytes ||
        full * block_bytes + last_bytes != bytes_) {
      fail("its blocks decode to " + std::to_string(full) + " x " + std::to_string(block_bytes) + " + " +
           std::to_string(last_bytes) + " bytes, but " + std::to_string(bytes_) + " are expected");
    }
    ZlibArray::Blocks blocks{block_bytes, bytes_, {}};
    blocks.begins.resize(static_cast<std::size_t>(count) + 1);
    readWords(*data, 3, std::span(blocks.begins).subspan(1));
    auto compressed = data->from((3 + count) * wordBytes());
    sumBlocks(blocks, compressed->most());
    return std::make_unique<ZlibArray>(std::move(compressed), std::move(blocks), document_.big_endian);
  }

  // Sizes of compressed blocks to places, each proved to be there and large enough for what it is to decode to.
  void sumBlocks(ZlibArray::Blocks& blocks, std::uint64_t most) const {
    constexpr std::uint64_t kMostRatio = 1040;  // zlib's is 1032
    std::uint64_t end = 0;
    for (std::size_t i = 1; i < blocks.begins.size(); ++i) {
      const std::uint64_t size = blocks.begins[i];
      const std::uint64_t decoded = std::min(blocks.block_bytes, blocks.bytes - (i - 1) * blocks.block_bytes);
      if (size > most - end) {
        fail("the file is short: block " + std::to_string(i - 1) + " of " + std::to_string(size) +
             " bytes ends behind the data");
      }
      if (decoded / kMostRatio > size) {
        fail("block " + std::to_string(i - 1) + " of " + std::to_string(size) + " bytes cannot decode to " +
             std::to_string(decoded));
      }
      end += size;
      blocks.begins[i] = end;
    }
  }

  const VtkDocument& document_;
  const XmlElement& array_;
  std::shared_ptr<const InputFile> file_;
  std::uint64_t bytes_;  // of all values
};

}  // namespace

void VtkArray::fail(const std::string& place, const std::string& what) const {
  throw Error(FaultCode::kBadInput, path_, "array " + inQuotes(name_) + ", " + place, what, kMakeAgain);
}

// Calls visit(bytes, place) for values in parts that fit a fixed buffer.
template <class Visit>
void VtkArray::forEachPart(std::uint64_t first, std::uint64_t count, Visit visit) {
  const std::size_t bytes = sampleBytes(type_);
  buffer_.resize(kWindowBytes);
  for (std::uint64_t done = 0; done < count;) {
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(count - done, buffer_.size() / bytes));
    const auto samples = std::span(buffer_).first(part * bytes);
    read(first + done, samples);
    withType(type_, [&](auto zero) {
      for (std::size_t i = 0; i < part; ++i) {
        decltype(zero) value;
        std::memcpy(&value, samples.data() + i * sizeof value, sizeof value);
        visit(static_cast<std::size_t>(done) + i, value);
      }
    });
    done += part;
  }
}

void VtkArray::readNumbers(std::uint64_t first, std::span<double> numbers) {
  forEachPart(first, numbers.size(), [&](std::size_t i, auto value) { numbers[i] = static_cast<double>(value); });
}

void VtkArray::readCounts(std::uint64_t first, std::span<std::uint64_t> counts) {
  forEachPart(first, counts.size(), [&](std::size_t i, auto value) {
    bool is_count = true;
    if constexpr (std::is_floating_point_v<decltype(value)>) {
      is_count = value >= 0 && value < 0x1p63 && std::floor(value) == value;
    } else if constexpr (std::is_signed_v<decltype(value)>) {
      is_count = value >= 0;
    }
    if (!is_count) {
      fail("value " + std::to_string(first + i), "is " + numberText(value) + ", expected a whole number from 0 on");
    }
    if constexpr (std::is_floating_point_v<decltype(value)>) {
      counts[i] = static_cast<std::uint64_t>(value);
    } else {
      counts[i] = static_cast<std::make_unsigned_t<decltype(value)>>(value);
    }
  });
}

std::optional<SampleType> vtkTypeOf(const XmlElement& array) {
  const std::string* type = array.attribute("type");
  const auto* const it =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return type != nullptr && t.first == *type; });
  return it == kTypes.end() ? std::nullopt : std::optional(it->second);
}

std::uint64_t vtkComponentsOf(const VtkDocument& document, const XmlElement& array) {
  return array.attribute("NumberOfComponents") == nullptr ? 1 : document.needCount(array, "NumberOfComponents");
}

std::unique_ptr<VtkArray> openVtkArray(const VtkDocument& document, const XmlElement& array,
                                       std::shared_ptr<const InputFile> file, std::uint64_t tuples) {
  const auto type = vtkTypeOf(array);
  if (!type) {
    document.fail(array, "its type is " + inQuotes(document.need(array, "type")) + ", which is not read",
                  "write it as Float32, Float64 or an integer of 8 to 64 bits");
  }
  const std::uint64_t components = vtkComponentsOf(document, array), bytes = sampleBytes(*type);
  if (components == 0 || tuples > std::numeric_limits<std::int64_t>::max() / bytes / components) {
    document.fail(array, std::to_string(tuples) + " tuples of " + std::to_string(components) + " components",
                  kMakeAgain);
  }
  const std::uint64_t values = tuples * components;
  std::unique_ptr<VtkArray> opened;
  if (values == 0) {
    opened = std::make_unique<EmptyArray>();
  } else {
    opened = Opener(document, array, std::move(file), values * bytes).open(values);
  }
  opened->type_ = *type;
  opened->components_ = components;
  opened->values_ = values;
  opened->path_ = document.path;
  const std::string* name = array.attribute("Name");
  opened->name_ = name != nullptr ? *name : "";
  return opened;
}

}  // namespace tet4d::exchange
