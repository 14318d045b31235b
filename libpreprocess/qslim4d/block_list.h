// A list that grows without being copied: never more than a block of room beside what it holds. Private to qslim4d.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace tet4d::qslim4d {

template <class T>
class BlockList {
 public:
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return blocks_[i / kBlock][i % kBlock]; }
  const T& operator[](std::size_t i) const { return blocks_[i / kBlock][i % kBlock]; }

  void push_back(const T& item) {  // NOLINT(readability-identifier-naming): as lists name it
    if (size_ == blocks_.size() * kBlock) blocks_.push_back(std::make_unique<T[]>(kBlock));
    (*this)[size_++] = item;
  }
  // Keeps the others in their order. O(size).
  template <class Is>
  void eraseIf(const Is& is) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i)
      if (!is((*this)[i])) (*this)[kept++] = (*this)[i];
    size_ = kept;
    blocks_.resize((size_ + kBlock - 1) / kBlock);
  }
  void clear() { size_ = 0, blocks_.clear(); }

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << 14;
  std::vector<std::unique_ptr<T[]>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace tet4d::qslim4d
