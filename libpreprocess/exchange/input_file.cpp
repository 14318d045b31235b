#include "libpreprocess/exchange/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "libpreprocess/error.h"

namespace tet4d::exchange {

InputFile::InputFile(const std::string& path) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) {
    throw Error(FaultCode::kIo, path, "", std::string("cannot be opened: ") + std::strerror(errno),
                "check the name and the permission to read");
  }
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor_);
    throw Error(FaultCode::kIo, path, "", "is no regular file",
                "give a file on disk; pipes and folders cannot be sought in");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() { ::close(descriptor_); }

std::size_t InputFile::readSome(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size() && offset + done < size_) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      throw Error(FaultCode::kIo, path_, "byte " + std::to_string(offset + done),
                  std::string("cannot be read: ") + std::strerror(errno), "check the disk");
    }
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

void InputFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  const std::size_t got = readSome(offset, bytes);
  if (got == bytes.size()) return;
  throw Error(FaultCode::kBadInput, path_, "byte " + std::to_string(offset + got),
              "the file ends, but " + std::to_string(bytes.size() - got) + " more bytes are needed",
              "copy or make the file again");
}

}  // namespace tet4d::exchange
