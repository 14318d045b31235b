#include "libpreprocess/exchange/sample_files.h"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/gzip_stream.h"
#include "libpreprocess/exchange/printf_pattern.h"

namespace tet4d::exchange {
namespace {

template <std::size_t kBytes>
void reverseEach(std::span<std::byte> samples) {
  for (std::size_t i = 0; i + kBytes <= samples.size(); i += kBytes) {
    std::reverse(samples.begin() + static_cast<std::ptrdiff_t>(i),
                 samples.begin() + static_cast<std::ptrdiff_t>(i + kBytes));
  }
}

}  // namespace

std::string besideHeader(const std::string& header_path, const std::string& name) {
  const std::filesystem::path path(name);
  return path.is_absolute() ? name : (std::filesystem::path(header_path).parent_path() / path).string();
}

bool isOtherByteOrder(bool big_endian) { return big_endian != (std::endian::native == std::endian::big); }

void swapSampleBytes(std::span<std::byte> samples, std::size_t sample_bytes) {
  if (sample_bytes == 2) reverseEach<2>(samples);
  if (sample_bytes == 4) reverseEach<4>(samples);
  if (sample_bytes == 8) reverseEach<8>(samples);
}

std::string SampleFiles::fileName(std::uint64_t k) const {
  if (attached) return header_path;
  if (pattern.empty()) return names[static_cast<std::size_t>(k)];
  return besideHeader(header_path,
                      NumberPattern::parse(pattern)->name(pattern_min + static_cast<std::int64_t>(k) * pattern_step));
}

std::uint64_t SampleFiles::beginIn(const InputFile& file) const {
  if (byte_skip == -1) return file.size() - std::min(file.size(), file_bytes);
  std::uint64_t at = begin;
  std::vector<char> buffer(std::size_t{1} << 16);
  for (std::uint64_t lines = 0; lines < line_skip;) {
    const std::size_t got = file.readSome(at, std::as_writable_bytes(std::span(buffer)));
    if (got == 0) {
      throw Error(
          FaultCode::kBadInput, file.path(), "byte " + std::to_string(file.size()),
          "the file ends after " + std::to_string(lines) + " lines, but \"line skip\" is " + std::to_string(line_skip),
          "correct \"line skip\" in the header");
    }
    const std::string_view text(buffer.data(), got);
    std::size_t used = 0;
    for (; lines < line_skip; ++lines) {
      const std::size_t end = text.find('\n', used);
      if (end == std::string_view::npos) break;
      used = end + 1;
    }
    at += lines < line_skip ? got : used;
  }
  // In compressed data bytes are skipped after decoding.
  return packing == Packing::kNone ? at + static_cast<std::uint64_t>(byte_skip) : at;
}

void checkSampleFile(const SampleFiles& data, std::uint64_t k) {
  const InputFile file(data.fileName(k));
  const std::uint64_t begin = data.beginIn(file);
  const std::uint64_t held = file.size() - std::min(begin, file.size());
  const bool packed = data.packing != Packing::kNone;
  constexpr std::uint64_t kMostOfOneByte = 1032;  // that deflate makes
  if (packed ? data.file_bytes / kMostOfOneByte > held : data.file_bytes > held) {
    throw Error(FaultCode::kBadInput, file.path(), "byte " + std::to_string(file.size()),
                "the file is short: it holds " + std::to_string(held) + (packed ? " compressed" : "") +
                    " bytes of samples, but the header's sizes ask for " + std::to_string(data.file_bytes),
                "copy or make the file again, or correct the sizes");
  }
  if (!packed && data.attached && data.byte_skip != -1 && held > data.file_bytes) {
    throw Error(FaultCode::kBadInput, file.path(), "byte " + std::to_string(begin + data.file_bytes),
                "the file goes on for " + std::to_string(held - data.file_bytes) +
                    " bytes after the samples that the header's sizes ask for",
                "correct \"sizes\" or \"type\" in the header");
  }
}

// The data file of the last read and, if it is compressed, how far it is decoded.
struct SampleReader::OpenFile {
  OpenFile(const std::string& path, std::uint64_t file_index, const SampleFiles& data)
      : index(file_index), file(path), begin(data.beginIn(file)) {
    if (data.packing == Packing::kNone) return;
    stream.emplace(file, begin,
                   data.packing == Packing::kGzip ? GzipStream::Wrapper::kGzip : GzipStream::Wrapper::kGzipOrZlib);
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

SampleReader::SampleReader(SampleFiles files) : files_(std::move(files)) {}
SampleReader::~SampleReader() = default;

void SampleReader::close() { open_.reset(); }

// The data file `file`, a stream of it not decoded beyond `at`.
SampleReader::OpenFile& SampleReader::open(std::uint64_t file, std::uint64_t at) {
  const bool usable = open_ && open_->index == file && (!open_->stream || open_->position() <= at);
  if (!usable) {
    open_.reset();
    open_ = std::make_unique<OpenFile>(files_.fileName(file), file, files_);
  }
  return *open_;
}

void SampleReader::read(std::uint64_t at, std::span<std::byte> samples, std::size_t sample_bytes) {
  const std::uint64_t file_bytes = files_.file_bytes;
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
  if (files_.swap_bytes) swapSampleBytes(samples, sample_bytes);
}

}  // namespace tet4d::exchange
