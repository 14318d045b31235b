// The bytes of an array of samples in files, whatever header describes them: one file or many, plain or compressed.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libpreprocess/exchange/input_file.h"

namespace tet4d::exchange {

enum class Packing { kNone, kGzip, kGzipOrZlib };

// Where the bytes are. All files together are the array, in order, with equal parts.
struct SampleFiles {
  std::string header_path;  // names are beside it
  Packing packing = Packing::kNone;
  bool swap_bytes = false;       // stored in the other byte order than this machine's
  std::uint64_t files = 1;       // how many files the samples are divided on
  std::uint64_t file_bytes = 0;  // of samples in each, decoded
  bool attached = true;          // in the header's own file, and they must end with it
  std::uint64_t begin = 0;       // offset of the data in each file
  std::uint64_t line_skip = 0;   // lines before the data, before any decoding
  std::int64_t byte_skip = 0;    // bytes before the data, after decoding; -1: the data are the end of the file (plain)
  std::vector<std::string> names;  // paths of single or listed files
  std::string pattern;             // or a name beside the header with one %d …
  std::int64_t pattern_min = 0, pattern_step = 1;

  // Path of file k.
  std::string fileName(std::uint64_t k) const;
  // Where the samples' bytes begin in a file; for compressed data, where the stream begins. Throws if lines to skip are
  // missing.
  std::uint64_t beginIn(const InputFile& file) const;
};

// The path of a file that a header calls `name`.
std::string besideHeader(const std::string& header_path, const std::string& name);

// True if bytes stored in this order must be turned round.
bool isOtherByteOrder(bool big_endian);

// Proves that the file's bytes are there: exactly for plain data; compressed data are not provably too short. Throws
// Error{kBadInput} naming file and byte.
void checkSampleFile(const SampleFiles& files, std::uint64_t k);

// Reads the array. Plain data are read where they stand. Compressed data are decoded from front to back: reads in
// growing order cost one pass, a read before the last one costs a new start. Holds one descriptor and a fixed buffer.
class SampleReader {
 public:
  explicit SampleReader(SampleFiles files);
  ~SampleReader();

  const SampleFiles& files() const { return files_; }
  // The samples' bytes from `at` (decoded bytes from the array's beginning) on, in native byte order. Throws Error
  // naming the data file and the byte. A stream's checksum is seen with its last byte.
  void read(std::uint64_t at, std::span<std::byte> samples, std::size_t sample_bytes);
  // Closes the file that read() keeps open.
  void close();

 private:
  struct OpenFile;
  OpenFile& open(std::uint64_t file, std::uint64_t at);
  SampleFiles files_;
  std::unique_ptr<OpenFile> open_;
};

// Turns the byte order of each sample round.
void swapSampleBytes(std::span<std::byte> samples, std::size_t sample_bytes);

}  // namespace tet4d::exchange
