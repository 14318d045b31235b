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

// What is wrong with a header, or null.
const char* checkHeader(const GridHeader& h) {
  if (h.reserved0 != 0 || std::any_of(std::begin(h.reserved1), std::end(h.reserved1), [](auto r) { return r != 0; })) {
    return "reserved bytes are not zero";
  }
  if (checkedFrameBytes(h) == 0) return "impossible grid size or sample type";
  if (!isUsable(h.index_to_world)) return "the map to world coordinates is not usable";
  return nullptr;
}

// What the page table must say of frame k, apart from where its bytes are.
paged::PageEntry entryOf(const GridHeader& h, std::uint64_t k) {
  paged::PageEntry entry{};
  entry.counts[0] = k;
  entry.counts[1] = h.dims[0] * h.dims[1] * h.dims[2];
  const auto t = static_cast<float>(k);
  const auto last = [&](std::size_t axis) { return static_cast<float>(h.dims[axis] - 1); };
  entry.bounds = {{0, 0, 0, t}, {last(0), last(1), last(2), t}};
  return entry;
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
  if (const char* what = checkHeader(*file.header_)) return reader.fault(kHeader, what);
  if (Status s = page_layout::checkTimes(file.times_, file.header_->frames, path); !s.ok()) return s.fault();
  auto pages = paged::Pages::open(reader);
  if (!pages.ok()) return pages.fault();
  file.pages_ = pages.value();
  if (file.pages_.size() != file.header_->frames) return reader.fault(paged::kPageTable, "must have one page a frame");
  for (std::size_t k = 0; k < file.pages_.size(); ++k) {
    const paged::PageEntry& e = file.pages_.entries()[k];
    const paged::PageEntry expected = entryOf(*file.header_, k);
    if (e.raw_bytes != file.frameBytes() || e.kind != 0 || !std::ranges::equal(e.counts, expected.counts) ||
        e.bounds.min != expected.bounds.min || e.bounds.max != expected.bounds.max) {
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
  const auto unfit = [&](const char* what) { return Fault{FaultCode::kUsage, path, "section GHDR", what, ""}; };
  if (const char* what = checkHeader(header)) return unfit(what);
  if (Status s = page_layout::checkTimes(times, times.size(), path); !times.empty() && !s.ok()) return s.fault();
  auto file = container::Writer::create(path, kPayload, kVersion, force);
  if (!file.ok()) return file.fault();
  Writer writer;
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_ = header;
  writer.times_.assign(times.begin(), times.end());
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::addFrame(std::span<const std::byte> samples) {
  const std::size_t k = pages_->entries().size();
  if (k == times_.size() || samples.size() != checkedFrameBytes(header_)) {
    return Fault{FaultCode::kUsage, file_->path(), "frame " + std::to_string(k),
                 std::to_string(samples.size()) + " bytes, expected " + std::to_string(checkedFrameBytes(header_)) +
                     " for each of " + std::to_string(times_.size()) + " frames",
                 ""};
  }
  return pages_->add(samples, entryOf(header_, k));
}

Status Writer::addFrame(std::span<const std::byte> samples, double time) {
  times_.push_back(time);
  return addFrame(samples);
}

Status Writer::close(const std::string& provenance_json) {
  if (Status s = page_layout::checkTimes(times_, times_.size(), file_->path()); !s.ok()) return s;
  if (pages_->entries().size() != times_.size()) {
    return Fault{FaultCode::kUsage, file_->path(), "section TIME",
                 std::to_string(pages_->entries().size()) + " frames for " + std::to_string(times_.size()) + " times",
                 "give one time a frame"};
  }
  if (Status status = pages_->end(); !status.ok()) return status;
  header_.frames = times_.size();
  if (Status s = file_->add<GridHeader>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
  if (Status s = file_->add<double>(kTimes, container::kSectionRequired, times_); !s.ok()) return s;
  if (Status s = file_->add<char>(container::kProvenance, 0, provenance_json); !s.ok()) return s;
  return file_->close();
}

}  // namespace tet4d::grid4
