#include "libpreprocess/exchange/byte_stream.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;

}  // namespace

ByteStream::ByteStream(const InputFile& file, std::uint64_t offset)
    : file_(&file), name_(file.path()), position_(offset), buffer_(kBufferBytes) {}

ByteStream::ByteStream(int descriptor, std::string name)
    : descriptor_(descriptor), name_(std::move(name)), buffer_(kBufferBytes) {}

std::size_t ByteStream::fetch(std::span<std::byte> bytes) {
  if (file_ != nullptr) return file_->readSome(position_, bytes);
  for (;;) {
    const ssize_t got = ::read(descriptor_, bytes.data(), bytes.size());
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno == EINTR) continue;
    throw Error(FaultCode::kIo, name_, "byte " + std::to_string(position_),
                std::string("cannot be read: ") + std::strerror(errno), "check what writes into it");
  }
}

std::span<const std::byte> ByteStream::peek() {
  if (used_ == filled_) {
    used_ = filled_ = 0;
    filled_ = fetch(buffer_);
  }
  return std::span<const std::byte>(buffer_).subspan(used_, filled_ - used_);
}

void ByteStream::consume(std::size_t bytes) {
  used_ += bytes;
  position_ += bytes;
}

std::size_t ByteStream::read(std::span<std::byte> bytes) {
  std::size_t done = std::min(bytes.size(), filled_ - used_);
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(used_), done, bytes.begin());
  consume(done);
  while (done < bytes.size()) {  // past the buffer, straight into the caller's
    const std::size_t got = fetch(bytes.subspan(done));
    if (got == 0) break;
    done += got;
    position_ += got;
  }
  return done;
}

std::uint64_t ByteStream::skip(std::uint64_t bytes) {
  std::uint64_t done = 0;
  while (done < bytes) {
    const std::size_t here = peek().size();
    if (here == 0) break;
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(here, bytes - done));
    consume(part);
    done += part;
  }
  return done;
}

}  // namespace tet4d::exchange
