#include "formats/grid4.h"

#include <algorithm>
#include <array>

#include "formats/page_layout.h"

namespace tet4d::grid4 {
namespace {

constexpr std::array kKnown{kHeader, kTimes, paged::kPages, paged::kPageTable};

// Bytes of one frame, or 0 if the header's numbers make none that a page can hold.
std::uint64_t checkedFrameBytes(const GridHeader& h) {
  std::uint64_t bytes = sampleBytes(static_cast<SampleType>(h.sample_type));
  for (const std::uint64_t n : h.dims) {
    if (n == 0 || bytes == 0 || n > paged::kMaxPageBytes / bytes) return 0;
    bytes *= n;
  }
  return bytes;
}

Status checkHeader(const container::Reader& reader, const GridHeader& h) {
  if (h.reserved0 != 0 || std::any_of(std::begin(h.reserved1), std::end(h.reserved1), [](auto r) { return r != 0; })) {
    return reader.fault(kHeader, "reserved bytes are not zero");
  }
  if (checkedFrameBytes(h) == 0) return reader.fault(kHeader, "impossible grid size or sample type");
  if (!isUsable(h.index_to_world)) return reader.fault(kHeader, "the map to world coordinates is not usable");
  return {};
}

}  // namespace

Result<File> File::open(const std::string& path) {
  auto opened = container::Reader::open(path, kPayload, kVersion, kKnown);
  if (!opened.ok()) return opened.fault();
  File file;
  file.reader_ = std::make_unique<container::Reader>(std::move(opened).value());
  const container::Reader& reader = *file.reader_;
  auto header = reader.single<GridHeader>(kHeader);
  if (!header.ok()) return header.fault();
  file.header_ = header.value();
  auto times = reader.items<double>(kTimes);
  if (!times.ok()) return times.fault();
  file.times_ = times.value();
  for (const std::uint32_t kind : {kHeader, kTimes}) {
    if (Status status = reader.verifySection(*reader.find(kind)); !status.ok()) return status.fault();
  }
  if (Status status = checkHeader(reader, *file.header_); !status.ok()) return status.fault();
  if (Status s = page_layout::checkTimes(file.times_, file.header_->frames, path); !s.ok()) return s.fault();
  auto pages = paged::Pages::open(reader);
  if (!pages.ok()) return pages.fault();
  file.pages_ = pages.value();
  if (file.pages_.size() != file.header_->frames) return reader.fault(paged::kPageTable, "must have one page a frame");
  for (std::size_t k = 0; k < file.pages_.size(); ++k) {
    const paged::PageEntry& e = file.pages_.entries()[k];
    if (e.raw_bytes != file.frameBytes() || e.kind != 0 || e.counts[0] != k) {
      return reader.fault(paged::kPageTable, "page " + std::to_string(k) + " is not frame " + std::to_string(k));
    }
  }
  return file;
}

Status File::verify() const {
  if (Status status = reader_->verifyAll(); !status.ok()) return status;
  if (Status status = pages_.verifyPadding(); !status.ok()) return status;
  for (std::size_t k = 0; k < pages_.size(); ++k) {
    if (auto page = loadFrame(k); !page.ok()) return page.fault();
  }
  return {};
}

Result<Writer> Writer::create(const std::string& path, const GridHeader& header, std::span<const double> times,
                              paged::Codec codec, bool force) {
  auto file = container::Writer::create(path, kPayload, kVersion, force);
  if (!file.ok()) return file.fault();
  Writer writer;
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_ = header;
  writer.header_.frames = times.size();
  writer.times_.assign(times.begin(), times.end());
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::addFrame(std::span<const std::byte> samples) {
  assert(samples.size() == checkedFrameBytes(header_));
  paged::PageEntry entry{};
  entry.counts[0] = pages_->entries().size();
  entry.counts[1] = header_.dims[0] * header_.dims[1] * header_.dims[2];
  const auto t = static_cast<float>(entry.counts[0]);
  const auto last = [&](std::size_t axis) { return static_cast<float>(header_.dims[axis] - 1); };
  entry.bounds = {{0, 0, 0, t}, {last(0), last(1), last(2), t}};
  entry.error_estimated = 0;
  entry.error_measured = 0;
  return pages_->add(samples, entry);
}

Status Writer::close(const std::string& provenance_json) {
  assert(pages_->entries().size() == times_.size());
  if (Status status = pages_->end(); !status.ok()) return status;
  if (Status s = file_->add<GridHeader>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
  if (Status s = file_->add<double>(kTimes, container::kSectionRequired, times_); !s.ok()) return s;
  if (Status s = file_->add<char>(container::kProvenance, 0, provenance_json); !s.ok()) return s;
  return file_->close();
}

}  // namespace tet4d::grid4
