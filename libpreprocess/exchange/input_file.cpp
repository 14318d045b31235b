#include "libpreprocess/exchange/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

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

struct GzipStream::State {
  const InputFile& file;
  std::uint64_t next;  // file offset of the byte after those given to zlib
  z_stream z{};
  bool member_ended = false;
  std::vector<unsigned char> buffer = std::vector<unsigned char>(std::size_t{1} << 16);
};

GzipStream::GzipStream(const InputFile& file, std::uint64_t offset) : state_(new State{file, offset}) {
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  if (inflateInit2(&state_->z, kGzipOnly) != Z_OK) {
    throw Error(FaultCode::kOutOfMemory, file.path(), "", "no memory for the gzip decoder", "close other programs");
  }
}

GzipStream::~GzipStream() { inflateEnd(&state_->z); }

void GzipStream::fail(const std::string& what, const std::string& remedy) const {
  throw Error(FaultCode::kBadInput, state_->file.path(), "byte " + std::to_string(state_->next - state_->z.avail_in),
              what, remedy);
}

// Decodes until `bytes` is full or the last member has ended; returns the count.
std::size_t GzipStream::readSome(std::span<std::byte> bytes) {
  State& s = *state_;
  std::size_t done = 0;
  while (done < bytes.size()) {
    if (s.z.avail_in == 0) {
      const std::size_t got = s.file.readSome(s.next, std::as_writable_bytes(std::span(s.buffer)));
      s.next += got;
      s.z.next_in = s.buffer.data();
      s.z.avail_in = static_cast<uInt>(got);
      if (got == 0) {
        if (s.member_ended) break;
        fail("the gzip stream is truncated: the file ends after " + std::to_string(position_ + done) + " decoded bytes",
             "copy or make the file again");
      }
    }
    if (s.member_ended) {  // another member follows
      inflateReset(&s.z);
      s.member_ended = false;
    }
    const std::size_t room = std::min<std::size_t>(bytes.size() - done, std::size_t{1} << 30);
    s.z.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    s.z.avail_out = static_cast<uInt>(room);
    const int outcome = inflate(&s.z, Z_NO_FLUSH);
    done += room - s.z.avail_out;
    if (outcome == Z_STREAM_END) {
      s.member_ended = true;
    } else if (outcome == Z_MEM_ERROR) {
      throw Error(FaultCode::kOutOfMemory, s.file.path(), "", "no memory for the gzip decoder", "close other programs");
    } else if (outcome != Z_OK && outcome != Z_BUF_ERROR) {
      fail(std::string("the gzip stream is broken: ") + (s.z.msg != nullptr ? s.z.msg : "a dictionary is asked for"),
           "copy or make the file again");
    }
  }
  position_ += done;
  return done;
}

void GzipStream::read(std::span<std::byte> bytes) {
  const std::uint64_t begin = position_;
  if (readSome(bytes) == bytes.size()) return;
  fail("the gzip stream holds " + std::to_string(position_) + " decoded bytes, but at least " +
           std::to_string(begin + bytes.size()) + " are needed",
       "correct the sizes in the header, or make the file again");
}

void GzipStream::skip(std::uint64_t bytes) {
  std::array<std::byte, 4096> sink;
  while (bytes > 0) {
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, sink.size()));
    read(std::span(sink).first(part));
    bytes -= part;
  }
}

void GzipStream::finish() {
  std::byte extra;
  const std::uint64_t held = position_;
  if (readSome(std::span(&extra, 1)) != 0) {
    fail("the gzip stream goes on after the " + std::to_string(held) + " decoded bytes that the header tells of",
         "correct the sizes in the header");
  }
}

}  // namespace tet4d::exchange
