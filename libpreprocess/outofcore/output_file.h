// A foreign output file that appears whole or not at all: written beside its final name and renamed at commit.
//
// Our own containers have the same promise in formats/container.h (Writer); this one serves exchange's writers, reports
// and films. Every call throws Error: kIo when the system refuses, kNoSpace when the disk or the quota is full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>

namespace tet4d::outofcore {

class OutputFile {
 public:
  // Opens a temporary file beside `path`. Throws if `path` exists and `force` is false, naming --force. "-" is standard
  // output; standard output, devices and pipes are written directly, with nothing to rename.
  OutputFile(std::string path, bool force);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  OutputFile& operator=(OutputFile&&) = delete;
  // Without commit() the temporary file is removed and the final name stays as it was.
  ~OutputFile();

  // Appends bytes or text (buffered).
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  // Appends text formatted as printf does, in the C locale. For shortest exact floats format with fmt and write().
  void print(const char* format, ...) __attribute__((format(printf, 2, 3)));
  // The bytes of one trivially copyable value, in the machine's order.
  template <class T>
  void writeValue(const T& value) {
    write(std::as_bytes(std::span<const T>(&value, 1)));
  }

  // For libraries that write to a FILE themselves (libspng, …). commit() notices their failed writes too.
  std::FILE* stream() { return file_; }
  const std::string& path() const { return path_; }
  bool isStream() const { return temporary_.empty(); }   // standard output, device or pipe: cannot seek
  std::uint64_t bytesWritten() const { return bytes_; }  // through write() and print()

  // Flushes, closes and renames to the final name. Call it once, last.
  void commit();

 private:
  [[noreturn]] void fail(int error_number, const char* doing) const;

  std::string path_;
  std::string temporary_;  // empty when written directly
  std::FILE* file_ = nullptr;
  std::uint64_t bytes_ = 0;
  bool force_ = false;
};

// Throws Error{kIo} as OutputFile would if `path` is an existing regular file and `force` is false. Programs call it
// before long work; a name made from a pattern is checked when it is opened.
void refuseExisting(const std::string& path, bool force);

}  // namespace tet4d::outofcore
