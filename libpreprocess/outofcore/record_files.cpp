#include "libpreprocess/outofcore/record_files.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {
namespace {

constexpr std::size_t kLeastShare = 4096;  // bytes of a bucket's buffer

[[noreturn]] void fail(const std::string& path, const char* doing, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
  throw Error(full ? FaultCode::kNoSpace : FaultCode::kIo, path, "",
              std::string(doing) + ": " + std::strerror(error_number),
              full ? "free some space, or name another --temp-dir" : "");
}

class OpenFile {
 public:
  OpenFile(const std::string& path, int flags) : path_(path), fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (fd_ < 0) fail(path, "cannot be opened", errno);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { ::close(fd_); }

  int descriptor() const { return fd_; }
  void write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path_, "cannot be written", errno);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }
  void readAt(std::uint64_t offset, std::span<std::byte> out) const {
    while (!out.empty()) {
      const ssize_t got = ::pread(fd_, out.data(), out.size(), static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail(path_, "cannot be read", errno);
      if (got == 0) throw Error(FaultCode::kIo, path_, "byte " + std::to_string(offset), "the file ends here", "");
      offset += static_cast<std::uint64_t>(got);
      out = out.subspan(static_cast<std::size_t>(got));
    }
  }

 private:
  const std::string& path_;
  int fd_;
};

}  // namespace

std::uint64_t fileBytes(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) fail(path, "cannot be read", errno);
  return static_cast<std::uint64_t>(info.st_size);
}

void removeFile(const std::string& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) fail(path, "cannot be removed", errno);
}

void readAt(const std::string& path, std::uint64_t offset, std::span<std::byte> out) {
  if (!out.empty()) OpenFile(path, O_RDONLY).readAt(offset, out);
}

void writeFile(const std::string& path, std::span<const std::byte> bytes) {
  OpenFile(path, O_WRONLY | O_CREAT | O_TRUNC).write(bytes);
}

void appendFile(const std::string& path, std::span<const std::byte> bytes) {
  OpenFile(path, O_WRONLY | O_CREAT | O_APPEND).write(bytes);
}

void cutFile(const std::string& path, std::uint64_t bytes) {
  if (fileBytes(path) > bytes && ::truncate(path.c_str(), static_cast<off_t>(bytes)) != 0)
    fail(path, "cannot be cut off", errno);
}

MappedFile::MappedFile(const std::string& path) : bytes_(fileBytes(path)) {
  if (bytes_ == 0) return;
  const OpenFile file(path, O_RDONLY);
  void* data = ::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, file.descriptor(), 0);
  if (data == MAP_FAILED) fail(path, "cannot be mapped", errno);
  data_ = data;
}

MappedFile::~MappedFile() {
  if (bytes_ != 0) ::munmap(const_cast<void*>(data_), bytes_);
}

BucketFiles::BucketFiles(std::string prefix, std::size_t buckets, std::size_t buffer_bytes)
    : prefix_(std::move(prefix)),
      share_(std::max(kLeastShare, buffer_bytes / std::max<std::size_t>(1, buckets))),
      buffers_(buckets),
      bytes_(buckets, 0) {
  for (std::size_t i = 0; i < buckets; ++i) writeFile(path(i), {});
}

void BucketFiles::addBytes(std::size_t bucket, std::span<const std::byte> record) {
  std::vector<std::byte>& buffer = buffers_[bucket];
  if (buffer.capacity() == 0) buffer.reserve(share_);
  if (buffer.size() + record.size() > share_) {
    appendFile(path(bucket), buffer);
    buffer.clear();
  }
  buffer.insert(buffer.end(), record.begin(), record.end());
  bytes_[bucket] += record.size();
}

void BucketFiles::finish() {
  for (std::size_t i = 0; i < buffers_.size(); ++i) {
    if (!buffers_[i].empty()) appendFile(path(i), buffers_[i]);
    buffers_[i] = {};
  }
}

}  // namespace tet4d::outofcore
