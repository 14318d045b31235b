// A file written beside its final name and renamed when it is complete; standard output, pipes and devices are written
// directly.
#pragma once

#include <cstddef>
#include <cstdio>
#include <span>
#include <string>

#include "formats/core/result.h"

namespace tet4d::host {

// A Fault (kUsage) if `path` is a file that exists and `force` is false; kIo if it is a directory. A pipe or device may
// always be written.
Status checkMayWrite(const std::string& path, bool force);

// True for "-" and for a pipe or device that exists.
bool isStream(const std::string& path);

class OutputFile {
 public:
  // "-" is standard output. Makes the directory of `path` if it is missing.
  static Result<OutputFile> create(const std::string& path, bool force);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  // Without commit() the temporary file is removed.
  ~OutputFile();

  Status write(std::span<const std::byte> bytes);
  // Flushes and, for a file, renames.
  Status commit();

 private:
  OutputFile(std::string path, std::string temporary, std::FILE* file);
  Fault fault(const char* what) const;

  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
};

// The whole of a file at once.
Status writeFile(const std::string& path, std::span<const std::byte> bytes, bool force);

}  // namespace tet4d::host
