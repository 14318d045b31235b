#include "libpreprocess/exchange/vtk_bytes.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

[[noreturn]] void failByte(const InputFile& file, std::uint64_t at, const std::string& what) {
  throw Error(FaultCode::kBadInput, file.path(), "byte " + std::to_string(at), what, "copy or make the file again");
}

class RawBytes final : public VtkBytes {
 public:
  RawBytes(std::shared_ptr<const InputFile> file, std::uint64_t begin, std::uint64_t end)
      : file_(std::move(file)), begin_(begin), end_(std::max(begin, end)) {}
  void read(std::uint64_t offset, std::span<std::byte> bytes) override {
    if (offset > most() || bytes.size() > most() - offset) {
      failByte(*file_, end_, "the data end, but " + std::to_string(bytes.size()) + " bytes are needed");
    }
    file_->read(begin_ + offset, bytes);
  }
  std::uint64_t most() const override { return end_ - begin_; }
  std::unique_ptr<VtkBytes> from(std::uint64_t offset) override {
    return rawBytes(file_, begin_ + std::min(offset, most()), end_);
  }

 private:
  std::shared_ptr<const InputFile> file_;
  std::uint64_t begin_, end_;
};

constexpr std::uint8_t kNoDigit = 0xff, kBlank = 0xfe, kPadding = 0xfd;

constexpr std::array<std::uint8_t, 256> makeDigits() {
  std::array<std::uint8_t, 256> digits{};
  digits.fill(kNoDigit);
  constexpr const char* kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::uint8_t i = 0; i < 64; ++i) digits[static_cast<unsigned char>(kAlphabet[i])] = i;
  for (const char c : {' ', '\t', '\r', '\n'}) digits[static_cast<unsigned char>(c)] = kBlank;
  digits['='] = kPadding;
  return digits;
}
constexpr std::array<std::uint8_t, 256> kDigits = makeDigits();

class Base64Bytes final : public VtkBytes {
 public:
  Base64Bytes(std::shared_ptr<const InputFile> file, std::uint64_t begin, std::uint64_t end)
      : file_(std::move(file)), begin_(begin), end_(std::max(begin, end)), window_(std::size_t{1} << 14) {
    restart();
  }

  void read(std::uint64_t offset, std::span<std::byte> bytes) override {
    if (offset < position_) restart();
    while (position_ < offset) {
      const auto part = std::min<std::uint64_t>(offset - position_, pending_ - taken_);
      taken_ += static_cast<std::size_t>(part), position_ += part;
      if (position_ < offset) decodeGroup();
    }
    for (std::size_t done = 0; done < bytes.size();) {
      if (taken_ == pending_) decodeGroup();
      const std::size_t part = std::min(bytes.size() - done, pending_ - taken_);
      std::memcpy(bytes.data() + done, group_.data() + taken_, part);
      done += part, taken_ += part, position_ += part;
    }
  }

  std::uint64_t most() const override { return (end_ - begin_ + 3) / 4 * 3; }

  std::unique_ptr<VtkBytes> from(std::uint64_t offset) override {
    if (offset > 0) {
      std::byte last;
      read(offset - 1, std::span(&last, 1));
    }
    // A group that ends with padding, or exactly here, ends a text; otherwise the text runs on through the offset.
    if (taken_ == pending_) return base64Bytes(file_, next_, end_);
    auto rest = std::make_unique<Base64Bytes>(file_, group_begin_, end_);
    rest->skipped_ = taken_;
    rest->restart();
    return rest;
  }

 private:
  void restart() {
    next_ = begin_, group_begin_ = begin_;
    window_begin_ = begin_, window_size_ = 0;
    position_ = 0, pending_ = taken_ = 0;
    padded_ = false;
    if (skipped_ == 0) return;
    decodeGroup();
    taken_ = skipped_;
  }

  // The next character's digit, blanks left out.
  std::uint8_t digit() {
    for (;;) {
      if (next_ - window_begin_ >= window_size_) {
        window_begin_ = next_;
        const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(window_.size(), end_ - next_));
        window_size_ = file_->readSome(next_, std::span(window_).first(part));
        if (window_size_ == 0) failEnd();
      }
      const auto c = static_cast<unsigned char>(window_[static_cast<std::size_t>(next_ - window_begin_)]);
      if (c == '<') failEnd();
      const std::uint8_t value = kDigits[c];
      if (value == kNoDigit) failByte(*file_, next_, "is no base64");
      ++next_;
      if (value != kBlank) return value;
    }
  }

  [[noreturn]] void failEnd() const {
    failByte(
        *file_, next_,
        "the base64 data end after " + std::to_string(position_ + (pending_ - taken_)) + " bytes, but more are needed");
  }

  // Decodes the next four digits to one to three bytes.
  void decodeGroup() {
    if (padded_) failEnd();
    group_begin_ = next_;
    std::array<std::uint8_t, 4> digits{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      digits[i] = digit();
      const bool pads = digits[i] == kPadding;
      if (pads ? i < 2 : count != i) failByte(*file_, next_ - 1, "base64 padding stands where a digit must");
      if (!pads) ++count;
    }
    const std::uint32_t bits = std::uint32_t{digits[0]} << 18 | std::uint32_t{digits[1]} << 12 |
                               (count > 2 ? std::uint32_t{digits[2]} << 6 : 0U) | (count > 3 ? digits[3] : 0U);
    group_ = {static_cast<std::byte>(bits >> 16), static_cast<std::byte>(bits >> 8), static_cast<std::byte>(bits)};
    pending_ = count - 1;
    taken_ = 0;
    padded_ = count < 4;
  }

  std::shared_ptr<const InputFile> file_;
  std::uint64_t begin_, end_;  // of the text in the file
  std::vector<std::byte> window_;
  std::uint64_t window_begin_ = 0, next_ = 0, group_begin_ = 0;  // places in the file
  std::size_t window_size_ = 0;
  std::array<std::byte, 3> group_{};
  std::size_t pending_ = 0, taken_ = 0;  // bytes of the group, and those read
  std::size_t skipped_ = 0;              // bytes of the first group that belong to what stands before
  std::uint64_t position_ = 0;           // bytes read
  bool padded_ = false;                  // the text ended with this group
};

}  // namespace

std::unique_ptr<VtkBytes> rawBytes(std::shared_ptr<const InputFile> file, std::uint64_t begin, std::uint64_t end) {
  return std::make_unique<RawBytes>(std::move(file), begin, end);
}

std::unique_ptr<VtkBytes> base64Bytes(std::shared_ptr<const InputFile> file, std::uint64_t begin, std::uint64_t end) {
  return std::make_unique<Base64Bytes>(std::move(file), begin, end);
}

}  // namespace tet4d::exchange
