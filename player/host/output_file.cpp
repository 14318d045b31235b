#include "player/host/output_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace tet4d::host {

Status checkMayWrite(const std::string& path, bool force) {
  struct stat info {};
  if (path == "-" || ::stat(path.c_str(), &info) != 0) return {};
  if (S_ISDIR(info.st_mode)) return Fault{FaultCode::kIo, path, "", "is a directory", "give a file's name"};
  if (force || !S_ISREG(info.st_mode)) return {};
  return Fault{FaultCode::kUsage, path, "", "exists already and is kept", "give --force to replace it"};
}

bool isStream(const std::string& path) {
  struct stat info {};
  return path == "-" || (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode));
}

OutputFile::OutputFile(std::string path, std::string temporary, std::FILE* file)
    : path_(std::move(path)), temporary_(std::move(temporary)), file_(file) {}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)),
      file_(std::exchange(other.file_, nullptr)) {}

Result<OutputFile> OutputFile::create(const std::string& path, bool force) {
  if (path == "-") return OutputFile(path, "", stdout);
  if (Status status = checkMayWrite(path, force); !status.ok()) return status.fault();
  std::error_code error;
  // A pipe or device is written itself: a file renamed over it would never reach its reader.
  const bool is_stream = isStream(path);
  const std::filesystem::path directory = std::filesystem::path(path).parent_path();
  if (!directory.empty()) std::filesystem::create_directories(directory, error);
  // The process number keeps two runs apart; it is gone once the file has its name.
  const std::string temporary = is_stream ? "" : path + "." + std::to_string(::getpid()) + ".part";
  std::FILE* file = error ? nullptr : std::fopen(is_stream ? path.c_str() : temporary.c_str(), "wb");
  if (file == nullptr) {
    const std::string reason = error ? error.message() : std::strerror(errno);
    return Fault{FaultCode::kIo, path, "", "cannot be created: " + reason,
                 "give another output or check its directory"};
  }
  return OutputFile(path, temporary, file);
}

OutputFile::~OutputFile() {
  if (file_ == nullptr || file_ == stdout) return;
  std::fclose(file_);
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

Fault OutputFile::fault(const char* what) const {
  const bool full = errno == ENOSPC || errno == EDQUOT;
  return {full ? FaultCode::kNoSpace : FaultCode::kIo, path_ == "-" ? "standard output" : path_, "",
          std::string(what) + ": " + std::strerror(errno), full ? "free space or give another output" : ""};
}

Status OutputFile::write(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) return fault("cannot be written");
  return {};
}

Status OutputFile::commit() {
  if (std::fflush(file_) != 0) return fault("cannot be written");
  if (file_ == stdout) return {};
  const bool closed = std::fclose(std::exchange(file_, nullptr)) == 0;
  if (closed && temporary_.empty()) return {};
  if (closed && std::rename(temporary_.c_str(), path_.c_str()) == 0) return {};
  const Fault why = fault(closed ? "cannot be renamed" : "cannot be written");
  if (!temporary_.empty()) std::remove(temporary_.c_str());
  return why;
}

Status writeFile(const std::string& path, std::span<const std::byte> bytes, bool force) {
  auto file = OutputFile::create(path, force);
  if (!file.ok()) return file.fault();
  if (Status status = file.value().write(bytes); !status.ok()) return status;
  return file.value().commit();
}

}  // namespace tet4d::host
