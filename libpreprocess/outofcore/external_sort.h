// Sorts more records than memory holds: runs are sorted in memory, put aside, and merged.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libpreprocess/outofcore/record_files.h"

namespace tet4d::outofcore {

// `Less` must be a total order up to records that are the same in every byte: the result then does not depend on
// `memory_bytes`. T is trivially copyable. Not thread-safe.
template <class T, class Less>
class ExternalSort {
 public:
  // The runs stand in the file `path`, which is made if they are more than one and removed when done.
  ExternalSort(std::string path, std::size_t memory_bytes, Less less = {})
      : path_(std::move(path)), capacity_(std::max<std::size_t>(2, memory_bytes / sizeof(T))), less_(less) {}
  ExternalSort(const ExternalSort&) = delete;
  ExternalSort& operator=(const ExternalSort&) = delete;
  ~ExternalSort() {
    if (runs_.empty()) return;
    try {
      removeFile(path_);
    } catch (...) {  // the folder goes with its files
    }
  }

  void add(const T& record) {
    if (records_.size() == capacity_) putAside();
    if (records_.capacity() == records_.size())
      records_.reserve(std::min(capacity_, std::max<std::size_t>(1024, 2 * records_.size())));
    records_.push_back(record);
  }

  // Calls visit(record) for all in order. Call it once. O(n log n).
  template <class Visit>
  void finish(const Visit& visit) {
    if (runs_.empty()) {
      std::sort(records_.begin(), records_.end(), less_);
      for (const T& record : records_) visit(record);
      records_ = {};
      return;
    }
    putAside();
    records_ = {};
    struct Head {
      T record;
      std::size_t run;
    };
    const std::size_t share = capacity_ * sizeof(T) / runs_.size();
    std::vector<RecordReader<T>> readers;
    std::vector<Head> heap;  // the least in front
    const auto later = [&](const Head& a, const Head& b) {
      if (less_(a.record, b.record)) return false;
      return less_(b.record, a.record) || a.run > b.run;
    };
    std::uint64_t first = 0;
    for (std::size_t run = 0; run < runs_.size(); first += runs_[run++]) {
      readers.emplace_back(path_, first, runs_[run], share);
      Head head{{}, run};
      if (readers.back().next(head.record)) heap.push_back(head);
    }
    std::make_heap(heap.begin(), heap.end(), later);
    while (!heap.empty()) {
      std::pop_heap(heap.begin(), heap.end(), later);
      visit(heap.back().record);
      if (readers[heap.back().run].next(heap.back().record)) {
        std::push_heap(heap.begin(), heap.end(), later);
      } else {
        heap.pop_back();
      }
    }
  }

 private:
  void putAside() {
    std::sort(records_.begin(), records_.end(), less_);
    if (runs_.empty()) writeFile(path_, {});
    appendFile(path_, std::as_bytes(std::span<const T>(records_)));
    runs_.push_back(records_.size());
    records_.clear();
  }

  std::string path_;
  std::size_t capacity_;
  Less less_;
  std::vector<T> records_;
  std::vector<std::uint64_t> runs_;  // records each
};

}  // namespace tet4d::outofcore
