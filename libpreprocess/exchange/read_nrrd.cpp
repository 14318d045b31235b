#include "libpreprocess/exchange/read_nrrd.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <optional>

namespace tet4d::exchange {
namespace {

template <std::size_t kBytes>
void reverseEach(std::span<std::byte> samples) {
  for (std::size_t i = 0; i + kBytes <= samples.size(); i += kBytes) {
    std::reverse(samples.begin() + static_cast<std::ptrdiff_t>(i),
                 samples.begin() + static_cast<std::ptrdiff_t>(i + kBytes));
  }
}

void swapBytes(std::span<std::byte> samples, std::size_t sample_bytes) {
  if (sample_bytes == 2) reverseEach<2>(samples);
  if (sample_bytes == 4) reverseEach<4>(samples);
  if (sample_bytes == 8) reverseEach<8>(samples);
}

}  // namespace

// The data file of the last read and, for gzip, how far it is decoded.
struct NrrdFile::OpenFile {
  OpenFile(const std::string& path, std::uint64_t file_index, const NrrdData& data)
      : index(file_index), file(path), begin(nrrdDataOffset(file, data)) {
    if (data.encoding != NrrdEncoding::kGzip) return;
    stream.emplace(file, begin);
    skipped = static_cast<std::uint64_t>(data.byte_skip);
    stream->skip(skipped);
  }
  std::uint64_t position() const { return stream->position() - skipped; }  // decoded bytes of samples

  std::uint64_t index;
  InputFile file;
  std::uint64_t begin;
  std::optional<GzipStream> stream;
  std::uint64_t skipped = 0;
};

NrrdFile::NrrdFile(const std::string& path) : header_(readNrrdHeader(path)) {}
NrrdFile::~NrrdFile() = default;

void NrrdFile::close() { open_.reset(); }

// The data file `file`, a gzip stream of it not decoded beyond `at`.
NrrdFile::OpenFile& NrrdFile::open(std::uint64_t file, std::uint64_t at) {
  const bool usable = open_ && open_->index == file && (!open_->stream || open_->position() <= at);
  if (!usable) {
    open_.reset();
    open_ = std::make_unique<OpenFile>(header_.data.fileName(header_.path, file), file, header_.data);
  }
  return *open_;
}

void NrrdFile::readLayers(std::uint64_t frame, std::uint64_t z_begin, [[maybe_unused]] std::uint64_t z_end,
                          std::span<std::byte> samples) {
  assert(frame < header_.frames && z_begin <= z_end && z_end <= header_.grid.dims[2]);
  assert(samples.size() == (z_end - z_begin) * header_.grid.layerBytes());
  const std::uint64_t file_bytes = header_.data.file_bytes;
  std::uint64_t at = frame * header_.frameBytes() + z_begin * header_.grid.layerBytes();
  for (auto rest = samples; !rest.empty();) {
    const std::uint64_t file = at / file_bytes, in_file = at % file_bytes;
    const auto part = rest.first(static_cast<std::size_t>(std::min<std::uint64_t>(rest.size(), file_bytes - in_file)));
    OpenFile& data = open(file, in_file);
    if (data.stream) {
      try {
        data.stream->skip(in_file - data.position());
        data.stream->read(part);
        if (in_file + part.size() == file_bytes) data.stream->finish();
      } catch (...) {
        open_.reset();  // the decoder's state is of no use after a fault
        throw;
      }
    } else {
      data.file.read(data.begin + in_file, part);
    }
    at += part.size();
    rest = rest.subspan(part.size());
  }
  if (header_.data.swap_bytes) swapBytes(samples, sampleBytes(header_.grid.type));
}

}  // namespace tet4d::exchange
