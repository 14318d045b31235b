#include "libpreprocess/outofcore/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::outofcore {

namespace {

[[noreturn]] void failExisting(const std::string& path) {
  throw Error(FaultCode::kIo, path, {}, "exists already and was kept",
              "give --force to replace it, or another --output");
}

bool exists(const std::string& path, struct stat& info) { return ::stat(path.c_str(), &info) == 0; }

std::string remedyFor(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space, or write to another disk";
    case ENOENT:
    case ENOTDIR:
      return "make its directory first";
    case EACCES:
    case EPERM:
    case EROFS:
      return "write to a directory you may write to";
    default:
      return {};
  }
}

// The permissions an ordinary new file would get; mkstemp makes it private.
void givePermissions(int descriptor) {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  (void)::fchmod(descriptor, 0666 & ~mask);
}

}  // namespace

void refuseExisting(const std::string& path, bool force) {
  struct stat info {};
  if (!force && path != "-" && exists(path, info) && S_ISREG(info.st_mode)) failExisting(path);
}

OutputFile::OutputFile(std::string path, bool force) : path_(std::move(path)), force_(force) {
  struct stat info {};
  if (path_ == "-") {
    // A copy of the descriptor, so that closing it here tells of failed writes and leaves stdout usable.
    const int descriptor = ::dup(STDOUT_FILENO);
    file_ = descriptor < 0 ? nullptr : ::fdopen(descriptor, "wb");
  } else if (exists(path_, info) && !S_ISREG(info.st_mode)) {
    if (S_ISDIR(info.st_mode)) fail(EISDIR, "cannot be written");
    file_ = std::fopen(path_.c_str(), "wb");
  } else {
    refuseExisting(path_, force_);
    temporary_ = path_ + ".XXXXXX.part";
    const int descriptor = ::mkostemps(temporary_.data(), 5, O_CLOEXEC);
    if (descriptor < 0) {
      const int error_number = errno;
      temporary_.clear();
      fail(error_number, "cannot be created");
    }
    givePermissions(descriptor);
    file_ = ::fdopen(descriptor, "wb");
  }
  if (file_ == nullptr) fail(errno, "cannot be opened for writing");
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})),
      file_(std::exchange(other.file_, nullptr)),
      bytes_(other.bytes_),
      force_(other.force_) {}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;  // nothing may stand at a null pointer, which fwrite does not take
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail(errno, "cannot be written");
  bytes_ += bytes.size();
}

void OutputFile::write(std::string_view text) { write(std::as_bytes(std::span<const char>(text))); }

void OutputFile::print(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  const int written = std::vfprintf(file_, format, arguments);
  va_end(arguments);
  if (written < 0) fail(errno, "cannot be written");
  bytes_ += static_cast<std::uint64_t>(written);
}

void OutputFile::commit() {
  const bool failed_before = std::ferror(file_) != 0;
  errno = 0;
  const bool flushed = std::fflush(file_) == 0;
  int error_number = flushed ? 0 : errno;
  if (std::fclose(std::exchange(file_, nullptr)) != 0 && error_number == 0) error_number = errno;
  if (failed_before || !flushed || error_number != 0) fail(error_number != 0 ? error_number : EIO, "cannot be written");
  if (temporary_.empty()) return;

  // Without --force the rename must not replace a file that appeared meanwhile; file systems that cannot promise that
  // refuse the flag, and then the check is repeated as late as possible.
  const unsigned flags = force_ ? 0u : RENAME_NOREPLACE;
  int renamed = ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), flags);
  if (renamed != 0 && !force_ && errno == EEXIST) failExisting(path_);
  if (renamed != 0 && (errno == EINVAL || errno == ENOSYS)) {
    refuseExisting(path_, force_);
    renamed = std::rename(temporary_.c_str(), path_.c_str());
  }
  if (renamed != 0) fail(errno, "cannot be renamed to its final name");
  temporary_.clear();
}

void OutputFile::fail(int error_number, const char* doing) const {
  const bool full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
  const std::string place = bytes_ == 0 ? std::string() : "byte " + std::to_string(bytes_);
  throw Error(full ? FaultCode::kNoSpace : FaultCode::kIo, path_ == "-" ? "standard output" : path_, place,
              std::string(doing) + ": " + std::strerror(error_number), remedyFor(error_number));
}

}  // namespace tet4d::outofcore
