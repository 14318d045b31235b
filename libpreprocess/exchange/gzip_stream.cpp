#include "libpreprocess/exchange/gzip_stream.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <optional>

#include "libpreprocess/error.h"

namespace tet4d::exchange {

struct GzipStream::State {
  std::optional<ByteStream> own;  // of a file
  ByteStream& in;
  bool many_members;
  z_stream z{};
  std::string name;  // "gzip", "compressed"
  bool member_ended = false;

  State(const InputFile& file, std::uint64_t offset) : own(std::in_place, file, offset), in(*own), many_members(true) {}
  explicit State(ByteStream& bytes) : in(bytes), many_members(false) {}
};

GzipStream::GzipStream(const InputFile& file, std::uint64_t offset, Wrapper wrapper) : state_(new State(file, offset)) {
  start(wrapper);
}

GzipStream::GzipStream(ByteStream& bytes) : state_(new State(bytes)) { start(Wrapper::kGzip); }

GzipStream::~GzipStream() { inflateEnd(&state_->z); }

void GzipStream::start(Wrapper wrapper) {
  state_->name = wrapper == Wrapper::kGzip ? "gzip" : "compressed";
  constexpr int kGzipOnly = 16 + MAX_WBITS, kEither = 32 + MAX_WBITS;
  if (inflateInit2(&state_->z, wrapper == Wrapper::kGzip ? kGzipOnly : kEither) != Z_OK) {
    throw Error(FaultCode::kOutOfMemory, state_->in.name(), "", "no memory for the gzip decoder",
                "close other programs");
  }
}

void GzipStream::fail(const std::string& what, const std::string& remedy) const {
  throw Error(FaultCode::kBadInput, state_->in.name(), "byte " + std::to_string(state_->in.position()),
              "the " + state_->name + " stream " + what, remedy);
}

// Decodes until `bytes` is full or the last member has ended; returns the count.
std::size_t GzipStream::readSome(std::span<std::byte> bytes) {
  State& s = *state_;
  std::size_t done = 0;
  while (done < bytes.size()) {
    if (s.member_ended && !s.many_members) break;  // without waiting for what a pipe brings next
    const std::span<const std::byte> coded = s.in.peek();
    if (coded.empty()) {
      if (s.member_ended) break;
      fail("is truncated: the input ends after " + std::to_string(position_ + done) + " decoded bytes",
           "copy or make the file again");
    }
    if (s.member_ended) {  // another member follows
      inflateReset(&s.z);
      s.member_ended = false;
    }
    const std::size_t room = std::min<std::size_t>(bytes.size() - done, std::size_t{1} << 30);
    s.z.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(coded.data()));
    s.z.avail_in = static_cast<uInt>(coded.size());
    s.z.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    s.z.avail_out = static_cast<uInt>(room);
    const int outcome = inflate(&s.z, Z_NO_FLUSH);
    s.in.consume(coded.size() - s.z.avail_in);
    done += room - s.z.avail_out;
    if (outcome == Z_STREAM_END) {
      s.member_ended = true;
    } else if (outcome == Z_MEM_ERROR) {
      throw Error(FaultCode::kOutOfMemory, s.in.name(), "", "no memory for the gzip decoder", "close other programs");
    } else if (outcome != Z_OK && outcome != Z_BUF_ERROR) {
      fail(std::string("is broken: ") + (s.z.msg != nullptr ? s.z.msg : "a dictionary is asked for"),
           "copy or make the file again");
    }
  }
  position_ += done;
  return done;
}

void GzipStream::read(std::span<std::byte> bytes) {
  const std::uint64_t begin = position_;
  if (readSome(bytes) == bytes.size()) return;
  fail("holds " + std::to_string(position_) + " decoded bytes, but at least " + std::to_string(begin + bytes.size()) +
           " are needed",
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
    fail("goes on after the " + std::to_string(held) + " decoded bytes that the header tells of",
         "correct the sizes in the header");
  }
}

}  // namespace tet4d::exchange
