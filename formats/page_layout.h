// How a page's parts follow one another: each starts at a multiple of 64, zeros between. Used by the payloads of
// formats/.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "formats/core/result.h"
#include "formats/core/vec.h"

namespace tet4d::page_layout {

inline constexpr std::size_t kPartAlignment = 64;

constexpr std::uint64_t padded(std::uint64_t bytes) {
  return (bytes + kPartAlignment - 1) / kPartAlignment * kPartAlignment;
}

// A page is never empty, so that of a column without vertices is one part of zeros.
constexpr std::uint64_t columnBytes(std::uint64_t bytes) {
  return std::max<std::uint64_t>(padded(bytes), kPartAlignment);
}

inline bool allZero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

// Appends the parts of a page to one buffer.
class Builder {
 public:
  // `bytes`: what the parts will need with their padding, so that the buffer is allocated once.
  explicit Builder(std::uint64_t bytes = 0) { bytes_.reserve(bytes); }
  template <class T>
  void add(std::span<const T> items) {
    const auto bytes = std::as_bytes(items);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    bytes_.resize(padded(bytes_.size()));
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

// Hands out the parts of a page in order; every size is checked before a span exists.
class Parser {
 public:
  explicit Parser(std::span<const std::byte> bytes) : bytes_(bytes) {}

  // `count` items of T, then zero padding. Empty and !ok() if they do not fit or the padding is not zero.
  template <class T>
  std::span<const T> take(std::uint64_t count) {
    const std::uint64_t left = bytes_.size() - at_;
    if (!ok_ || count > left / sizeof(T) || padded(count * sizeof(T)) > left) return fail<T>();
    const std::span<const T> items(reinterpret_cast<const T*>(bytes_.data() + at_), count);
    const auto gap = bytes_.subspan(at_ + count * sizeof(T), padded(count * sizeof(T)) - count * sizeof(T));
    if (!allZero(gap)) return fail<T>();
    at_ += padded(count * sizeof(T));
    return items;
  }
  // All parts fitted and nothing is left over.
  bool complete() const { return ok_ && at_ == bytes_.size(); }

 private:
  template <class T>
  std::span<const T> fail() {
    ok_ = false;
    return {};
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

inline bool isFinite(const Vec4f& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.t);
}

// A box as files may hold it.
inline bool isProper(const Bounds4f& box) { return isFinite(box.min) && isFinite(box.max) && !box.empty(); }

// A box as files hold it: all zero if it is empty.
inline Bounds4f stored(const Bounds4f& box) { return box.empty() ? Bounds4f{{0, 0, 0, 0}, {0, 0, 0, 0}} : box; }

// The timeline every payload has: at least one time, finite, strictly increasing.
inline Status checkTimes(std::span<const double> times, std::uint64_t frames, const std::string& file) {
  const auto bad = [&](std::string what) {
    return Fault{FaultCode::kBadInput, file, "section TIME", std::move(what), "write the file again"};
  };
  if (times.empty() || times.size() != frames) {
    return bad("has " + std::to_string(times.size()) + " times for " + std::to_string(frames) + " frames");
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!std::isfinite(times[k])) return bad("time " + std::to_string(k) + " is not finite");
    if (k > 0 && times[k] <= times[k - 1])
      return bad("time " + std::to_string(k) + " does not come after the one before");
  }
  return {};
}

}  // namespace tet4d::page_layout
