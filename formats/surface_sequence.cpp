#include "formats/surface_sequence.h"

#include <algorithm>

#include "formats/page_layout.h"

namespace tet4d::surface_sequence {
namespace {

constexpr std::array kKnown{kHeader, kTimes, kTriangles, kColumns, paged::kPages, paged::kPageTable};

// What is wrong with a header, or null.
const char* checkHeader(const Header& h) {
  if (h.reserved0 != 0 || std::any_of(std::begin(h.reserved1), std::end(h.reserved1), [](auto r) { return r != 0; })) {
    return "reserved bytes are not zero";
  }
  if (h.vertices == 0 || h.vertices > std::uint64_t{1} << 32) return "impossible count of vertices";
  if (!isUsable(h.index_to_world)) return "the map to world coordinates is not usable";
  if (!page_layout::isProper(h.bounds)) return "the bounds are not finite or not ordered";
  return nullptr;
}

// What is wrong with the triangles, or null.
const char* checkTriangles(std::span<const Triangle> triangles, std::uint64_t vertices) {
  for (const auto& [a, b, c] : triangles) {
    if (a >= vertices || b >= vertices || c >= vertices) return "a triangle's vertex is out of range";
    if (a == b || b == c || c == a) return "a triangle has a vertex twice";
  }
  return nullptr;
}

// Every frame in order, then its columns.
Status checkPages(const container::Reader& reader, const Header& h, std::span<const paged::PageEntry> pages,
                  std::span<const ColumnEntry> columns) {
  const std::size_t stride = 1 + columns.size();
  if (pages.size() % stride != 0 || pages.size() / stride != h.frames) {
    return reader.fault(paged::kPageTable, "must have one page a frame, and one more for each column of it");
  }
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const std::size_t c = i % stride, k = i / stride;
    const std::uint64_t bytes = h.vertices * (c == 0 ? sizeof(Vec3f) : columns[c - 1].components * sizeof(float));
    const auto& counts = pages[i].counts;
    const auto t = static_cast<float>(k);
    if (pages[i].kind != c || pages[i].raw_bytes != bytes || counts[0] != k || counts[1] != h.vertices ||
        counts[2] != 0 || counts[3] != 0 || pages[i].bounds.min.t != t || pages[i].bounds.max.t != t) {
      return reader.fault(paged::kPageTable, "page " + std::to_string(i) + " is not " +
                                                 (c == 0 ? "" : "column " + std::to_string(c - 1) + " of ") + "frame " +
                                                 std::to_string(k));
    }
  }
  return {};
}

}  // namespace

Result<std::span<const Vec3f>> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry,
                                            const Header& header, const std::string& file, std::size_t page) {
  const auto bad = [&](const char* what) {
    return Fault{FaultCode::kBadInput, file, "page " + std::to_string(page), what, "write the file again"};
  };
  if (entry.counts[1] != header.vertices || bytes.size() % sizeof(Vec3f) != 0 ||
      bytes.size() / sizeof(Vec3f) != header.vertices) {
    return bad("its size does not fit the vertices");
  }
  const std::span<const Vec3f> positions(reinterpret_cast<const Vec3f*>(bytes.data()), header.vertices);
  const Bounds4f& box = entry.bounds;
  for (const Vec3f& p : positions) {
    if (!page_layout::isFinite({p.x, p.y, p.z, 0})) return bad("a vertex is not finite");
    if (p.x < box.min.x || p.y < box.min.y || p.z < box.min.z || p.x > box.max.x || p.y > box.max.y ||
        p.z > box.max.z) {
      return bad("a vertex lies outside the page's bounds");
    }
  }
  return positions;
}

Result<File> File::open(const std::string& path) {
  auto opened = container::Reader::open(path, kPayload, kVersion, kKnown);
  if (!opened.ok()) return opened.fault();
  File file;
  file.reader_ = std::make_unique<container::Reader>(std::move(opened).value());
  const container::Reader& reader = *file.reader_;
  auto header = reader.single<Header>(kHeader);
  if (!header.ok()) return header.fault();
  file.header_ = header.value();
  auto times = reader.items<double>(kTimes);
  if (!times.ok()) return times.fault();
  file.times_ = times.value();
  auto triangles = reader.items<Triangle>(kTriangles);
  if (!triangles.ok()) return triangles.fault();
  file.triangles_ = triangles.value();
  std::vector<std::uint32_t> small{kHeader, kTimes};
  if (reader.find(kColumns) != nullptr) {
    auto columns = reader.items<ColumnEntry>(kColumns);
    if (!columns.ok()) return columns.fault();
    file.columns_ = columns.value();
    small.push_back(kColumns);
  }
  for (const std::uint32_t kind : small) {
    if (Status status = reader.verifySection(*reader.find(kind)); !status.ok()) return status.fault();
  }
  if (const char* what = checkHeader(*file.header_)) return reader.fault(kHeader, what);
  if (Status s = page_layout::checkTimes(file.times_, file.header_->frames, path); !s.ok()) return s.fault();
  if (file.triangles_.size() != file.header_->triangles) {
    return reader.fault(kTriangles, "has " + std::to_string(file.triangles_.size()) + " triangles, the header says " +
                                        std::to_string(file.header_->triangles));
  }
  if (file.columns_.size() != file.header_->columns) {
    return reader.fault(kColumns, "has " + std::to_string(file.columns_.size()) + " columns, the header says " +
                                      std::to_string(file.header_->columns));
  }
  if (const char* what = checkColumns(file.columns_)) return reader.fault(kColumns, what);
  auto pages = paged::Pages::open(reader);
  if (!pages.ok()) return pages.fault();
  file.pages_ = pages.value();
  if (Status s = checkPages(reader, *file.header_, file.pages_.entries(), file.columns_); !s.ok()) return s.fault();
  return file;
}

Result<std::span<const Triangle>> File::triangles() const {
  if (Status s = reader_->verifySection(*reader_->find(kTriangles)); !s.ok()) return s.fault();
  if (const char* what = checkTriangles(triangles_, header_->vertices)) return reader_->fault(kTriangles, what);
  return triangles_;
}

Result<Frame> File::loadFrame(std::size_t k) const {
  auto bytes = pages_.load(k * stride());
  if (!bytes.ok()) return bytes.fault();
  Frame frame{std::move(bytes).value(), {}};
  auto positions = validatePage(frame.bytes.bytes(), frameEntry(k), *header_, reader_->path(), k * stride());
  if (!positions.ok()) return positions.fault();
  frame.positions = positions.value();
  return frame;
}

Result<std::uint64_t> File::contentDigest() const {
  auto pages = pages_.contentDigest();
  if (!pages.ok()) return pages.fault();
  const std::array<std::uint64_t, 5> parts{
      container::xxh3(std::as_bytes(std::span(header_, 1))), container::xxh3(std::as_bytes(times_)),
      container::xxh3(std::as_bytes(triangles_)), container::xxh3(std::as_bytes(columns_)), pages.value()};
  return container::xxh3(std::as_bytes(std::span(parts)));
}

Status File::verify() const {
  if (Status status = reader_->verifyAll(); !status.ok()) return status;
  if (Status status = pages_.verifyPadding(); !status.ok()) return status;
  if (auto all = triangles(); !all.ok()) return all.fault();
  Bounds4f all;
  for (std::size_t k = 0; k < times_.size(); ++k) {
    auto frame = loadFrame(k);
    if (!frame.ok()) return frame.fault();
    for (const Vec3f& p : frame.value().positions) all.add(Vec4f{p.x, p.y, p.z, static_cast<float>(k)});
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (auto column = loadColumn(c, k); !column.ok()) return column.fault();
    }
  }
  if (all.min != header_->bounds.min || all.max != header_->bounds.max) {
    return reader_->fault(kHeader, "its bounds are not the box of the vertices");
  }
  return {};
}

Result<Writer> Writer::create(const std::string& path, const Header& header, std::span<const double> times,
                              std::span<const Triangle> triangles, std::span<const Column> columns, paged::Codec codec,
                              bool force) {
  const auto unfit = [&](const char* section, const char* what) {
    return Fault{FaultCode::kUsage, path, section, what, ""};
  };
  Header checked = header;
  checked.bounds = page_layout::stored({});
  if (const char* what = checkHeader(checked)) return unfit("section QHDR", what);
  if (Status s = page_layout::checkTimes(times, times.size(), path); !s.ok()) return s.fault();
  if (const char* what = checkTriangles(triangles, header.vertices)) return unfit("section TRIS", what);
  std::vector<ColumnEntry> entries = columnEntries(columns);
  if (const char* what = checkColumns(entries)) return unfit("section COLS", what);
  auto file = container::Writer::create(path, kPayload, kVersion, force);
  if (!file.ok()) return file.fault();
  Writer writer;
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_ = checked;
  writer.header_.frames = times.size();
  writer.header_.triangles = triangles.size();
  writer.header_.columns = static_cast<std::uint32_t>(columns.size());
  writer.times_.assign(times.begin(), times.end());
  writer.columns_ = std::move(entries);
  if (Status s = writer.file_->add<Triangle>(kTriangles, container::kSectionRequired, triangles); !s.ok())
    return s.fault();
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::unfit(const std::string& what) const {
  return Fault{FaultCode::kUsage, file_->path(), "frame " + std::to_string(next_), what, ""};
}

Status Writer::addFrame(std::span<const Vec3f> positions, std::span<const std::span<const float>> columns) {
  if (next_ == times_.size()) return unfit("but there are times for " + std::to_string(times_.size()) + " frames only");
  if (positions.size() != header_.vertices) {
    return unfit(std::to_string(positions.size()) + " vertices, expected " + std::to_string(header_.vertices));
  }
  bool fit = columns.size() == columns_.size();
  for (std::size_t c = 0; fit && c < columns_.size(); ++c)
    fit = columns[c].size() == positions.size() * columns_[c].components;
  if (!fit) return unfit("the columns do not fit the vertices");
  paged::PageEntry entry{};
  entry.counts[0] = next_;
  entry.counts[1] = header_.vertices;
  entry.error_measured = -1;
  for (const Vec3f& p : positions) {
    const Vec4f v{p.x, p.y, p.z, static_cast<float>(next_)};
    if (!page_layout::isFinite(v)) return unfit("a vertex is not finite");
    entry.bounds.add(v);
  }
  bounds_.add(entry.bounds);
  ++next_;
  if (Status status = pages_->add(std::as_bytes(positions), entry); !status.ok()) return status;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    entry.kind = static_cast<std::uint32_t>(1 + c);
    if (Status status = pages_->add(std::as_bytes(columns[c]), entry); !status.ok()) return status;
  }
  return {};
}

Status Writer::close(const std::string& provenance_json) {
  if (next_ != times_.size()) {
    return Fault{FaultCode::kUsage, file_->path(), "section TIME",
                 std::to_string(next_) + " frames for " + std::to_string(times_.size()) + " times",
                 "give one time a frame"};
  }
  if (Status status = pages_->end(); !status.ok()) return status;
  header_.bounds = page_layout::stored(bounds_);
  if (Status s = file_->add<Header>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
  if (Status s = file_->add<double>(kTimes, container::kSectionRequired, times_); !s.ok()) return s;
  if (!columns_.empty()) {
    if (Status s = file_->add<ColumnEntry>(kColumns, container::kSectionRequired, columns_); !s.ok()) return s;
  }
  if (Status s = file_->add<char>(container::kProvenance, 0, provenance_json); !s.ok()) return s;
  return file_->close();
}

}  // namespace tet4d::surface_sequence
