// Temporary files of fixed-width records: written through a buffer, read whole or in pieces, scattered to many at once.
//
// For a builder whose data is larger than memory. Files are private to one run on one machine: plain structs, no
// header, no checksum. Every call throws Error: kIo when the system refuses, kNoSpace when the disk or the quota is
// full.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tet4d::outofcore {

// Bytes of the file at `path`.
std::uint64_t fileBytes(const std::string& path);
// Removes it; one that is not there is none.
void removeFile(const std::string& path);
// Copies bytes of the file from `offset` on; fewer than asked for is an Error.
void readAt(const std::string& path, std::uint64_t offset, std::span<std::byte> out);
// Makes the file anew, or appends to it. An empty `bytes` makes an empty file.
void writeFile(const std::string& path, std::span<const std::byte> bytes);
void appendFile(const std::string& path, std::span<const std::byte> bytes);
// Cuts the file off after `bytes`; a shorter one is left alone.
void cutFile(const std::string& path, std::uint64_t bytes);

// All records of a file.
template <class T>
std::vector<T> readRecords(const std::string& path) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> records(fileBytes(path) / sizeof(T));
  readAt(path, 0, std::as_writable_bytes(std::span(records)));
  return records;
}

// A file's records one after the other, `buffer_bytes` of them in memory.
template <class T>
class RecordReader {
 public:
  RecordReader(std::string path, std::uint64_t first, std::uint64_t count, std::size_t buffer_bytes)
      : path_(std::move(path)),
        next_(first),
        end_(first + count),
        capacity_(std::max<std::size_t>(1, buffer_bytes / sizeof(T))) {}
  RecordReader(const std::string& path, std::size_t buffer_bytes)
      : RecordReader(path, 0, fileBytes(path) / sizeof(T), buffer_bytes) {}

  // False at the end.
  bool next(T& record) {
    if (at_ == buffer_.size() && !fill()) return false;
    record = buffer_[at_++];
    return true;
  }

 private:
  bool fill() {
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(capacity_, end_ - next_));
    buffer_.resize(count);
    at_ = 0;
    if (count == 0) return false;
    readAt(path_, next_ * sizeof(T), std::as_writable_bytes(std::span(buffer_)));
    next_ += count;
    return true;
  }

  std::string path_;
  std::uint64_t next_, end_;
  std::size_t capacity_, at_ = 0;
  std::vector<T> buffer_;
};

// A file's bytes, mapped read-only: not counted as memory.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();
  template <class T>
  std::span<const T> records() const {
    static_assert(std::is_trivially_copyable_v<T>);
    return {static_cast<const T*>(data_), bytes_ / sizeof(T)};
  }

 private:
  const void* data_ = nullptr;
  std::size_t bytes_ = 0;
};

// Files PREFIX.0, PREFIX.1, … that records are scattered to. Each has a share of the buffer, so that the disk sees long
// writes however many files there are; no file is held open.
class BucketFiles {
 public:
  // Makes the files, empty.
  BucketFiles(std::string prefix, std::size_t buckets, std::size_t buffer_bytes);

  template <class T>
  void add(std::size_t bucket, const T& record) {
    static_assert(std::is_trivially_copyable_v<T>);
    addBytes(bucket, std::as_bytes(std::span(&record, 1)));
  }
  // A record whose size only the run knows: as many bytes as each time before, for whoever reads it.
  template <class T>
  void addRun(std::size_t bucket, std::span<const T> run) {
    static_assert(std::is_trivially_copyable_v<T>);
    addBytes(bucket, std::as_bytes(run));
  }
  // Writes what is still in the buffers and frees them.
  void finish();

  std::size_t size() const { return buffers_.size(); }
  std::uint64_t bytes(std::size_t bucket) const { return bytes_[bucket]; }
  std::string path(std::size_t bucket) const { return pathOf(prefix_, bucket); }
  static std::string pathOf(const std::string& prefix, std::size_t bucket) {
    return prefix + "." + std::to_string(bucket);
  }

 private:
  void addBytes(std::size_t bucket, std::span<const std::byte> record);

  std::string prefix_;
  std::size_t share_;
  std::vector<std::vector<std::byte>> buffers_;
  std::vector<std::uint64_t> bytes_;  // given so far
};

}  // namespace tet4d::outofcore
