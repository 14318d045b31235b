// grid4 (.t4g): frames of one 3D grid of scalar samples over time. One page is one frame, x fastest, little-endian.
//
// Sections: GHDR (one GridHeader), TIME (f64 per frame), PAGE/PTAB (page k = frame k; counts = {k, voxels, 0, 0};
// bounds = the grid's box at time k). docs/formats/grid4.md.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "formats/core/coordinates.h"
#include "formats/core/sample_type.h"
#include "formats/paged.h"

namespace tet4d::grid4 {

inline constexpr std::uint32_t kPayload = container::fourCc("GRD4");
inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::uint32_t kHeader = container::fourCc("GHDR");
inline constexpr std::uint32_t kTimes = container::fourCc("TIME");

struct GridHeader {
  std::uint64_t dims[3];       // @0   samples along x, y, z
  std::uint64_t frames;        // @24
  std::uint32_t sample_type;   // @32  SampleType
  std::uint32_t reserved0;     // @36  zero
  AffineMap index_to_world;    // @40  of sample positions
  std::uint64_t reserved1[7];  // @136 zero
};
static_assert(sizeof(GridHeader) == 192 && offsetof(GridHeader, index_to_world) == 40);

// An open grid4. Moves; spans stay valid as long as it lives.
class File {
 public:
  // Opens and proves header, times and page table (not the samples).
  static Result<File> open(const std::string& path);
  const container::Reader& reader() const { return *reader_; }
  const GridHeader& header() const { return *header_; }
  std::span<const double> times() const { return times_; }
  const paged::Pages& pages() const { return pages_; }
  std::uint64_t frameBytes() const {
    return header_->dims[0] * header_->dims[1] * header_->dims[2] *
           sampleBytes(static_cast<SampleType>(header_->sample_type));
  }
  // Checksum, size of page k. (Every sample value is legal.)
  Result<paged::PageBytes> loadFrame(std::size_t k) const { return pages_.load(k); }
  // Everything: sections, padding, all pages. O(file).
  Status verify() const;

 private:
  std::unique_ptr<container::Reader> reader_;
  const GridHeader* header_ = nullptr;
  std::span<const double> times_;
  paged::Pages pages_;
};

// Streams frames into a .t4g.
class Writer {
 public:
  // times: one per frame, or none: each then comes with its frame.
  static Result<Writer> create(const std::string& path, const GridHeader& header, std::span<const double> times,
                               paged::Codec codec, bool force);
  // Frame by frame, in order; exactly frameBytes each.
  Status addFrame(std::span<const std::byte> samples);
  // The same, of frames whose count is not known before; times grow.
  Status addFrame(std::span<const std::byte> samples, double time);
  Status close(const std::string& provenance_json);

 private:
  std::unique_ptr<container::Writer> file_;
  std::unique_ptr<paged::PageWriter> pages_;
  GridHeader header_{};
  std::vector<double> times_;
};

}  // namespace tet4d::grid4
