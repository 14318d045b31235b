#include "formats/dynamic_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "formats/mesh_sections.h"
#include "formats/page_layout.h"

namespace tet4d::dyntri {
namespace {

constexpr std::array kOwned{kHeader, kTimes, kColumns, kParts, paged::kPageTable};  // copied when a file is opened
constexpr std::array kKnown{kHeader, kTimes, kColumns, kParts, paged::kPages, paged::kPageTable};

bool anySet(std::span<const std::uint64_t> reserved) {
  return std::any_of(reserved.begin(), reserved.end(), [](auto r) { return r != 0; });
}

// What is wrong with a header, or null.
const char* checkHeader(const Header& h) {
  if (anySet(h.reserved)) return "reserved bytes are not zero";
  if (!isUsable(h.index_to_world)) return "the map to world coordinates is not usable";
  if (!page_layout::isProper(h.bounds)) return "the bounds are not finite or not ordered";
  if (!std::isfinite(h.last_time)) return "the last time is not finite";
  return nullptr;
}

// Every geometry page, then its column pages; the header's sums against the page table's counts.
Status checkPages(const container::Reader& reader, const Header& h, std::span<const paged::PageEntry> pages,
                  std::span<const ColumnEntry> columns) {
  const auto bad = [&](std::size_t i, const char* what) {
    return reader.fault(paged::kPageTable, "page " + std::to_string(i) + " " + what);
  };
  constexpr std::array<std::size_t, 3> kBytes{sizeof(Vec4f), sizeof(Edge), sizeof(Triangle)};
  const std::size_t stride = 1 + columns.size();
  if (pages.size() % stride != 0) return bad(pages.size(), "is missing");
  std::array<std::uint64_t, 3> sums{};
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const paged::PageEntry& e = pages[i];
    if (e.kind != i % stride) return bad(i, "is not of the kind expected there");
    if (const std::size_t c = i % stride; c != 0) {
      const std::uint64_t bytes = pages[i - c].counts[0] * columns[c - 1].components * sizeof(float);
      if (e.raw_bytes != page_layout::columnBytes(bytes)) return bad(i, "has not the size of its column");
      continue;
    }
    if (e.counts[3] != 0) return bad(i, "has a fourth count that is not zero");
    for (std::size_t k = 0; k < 3; ++k) {
      if (e.counts[k] > e.raw_bytes / kBytes[k]) return bad(i, "has a count beyond its size");
      sums[k] += e.counts[k];
    }
  }
  if (sums != std::array{h.vertices, h.edges, h.triangles}) {
    return reader.fault(kHeader, "its counts are not the sums over the pages");
  }
  return {};
}

const char* checkEdges(const PageView& page) {
  for (const Edge& e : page.edges) {
    if (e.a >= page.vertices.size() || e.b >= page.vertices.size()) return "an edge's vertex is out of range";
    if (!(page.vertices[e.a].t < page.vertices[e.b].t)) return "an edge does not run forward in time";
  }
  return nullptr;
}

const char* checkTriangles(const PageView& page) {
  for (std::size_t i = 0; i < page.triangles.size(); ++i) {
    float begin = -std::numeric_limits<float>::infinity(), end = std::numeric_limits<float>::infinity();
    for (const std::uint32_t e : page.triangles[i]) {
      if (e >= page.edges.size()) return "a triangle's edge is out of range";
      begin = std::max(begin, page.vertices[page.edges[e].a].t);
      end = std::min(end, page.vertices[page.edges[e].b].t);
    }
    const auto& [p, q, r] = page.triangles[i];
    if (p == q || q == r || r == p) return "a triangle has an edge twice";
    const Lifespan& life = page.lifespans[i];
    if (life.begin != begin || life.end != end) return "a lifespan is not the intersection of its edges' intervals";
    if (!(begin < end)) return "a lifespan is empty";
    if (page.bands.empty() && i > 0 && life.begin < page.lifespans[i - 1].begin)
      return "triangles are not sorted by the begin of their lives";
  }
  return nullptr;
}

// Every triangle of a band against the band's index.
const char* checkAlive(const PageView& page, const Band& band) {
  const auto index = page.index.subspan(band.first_interval, band.intervals);
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i].first > index[i].last || index[i].last > band.count) return "an interval's run is out of range";
    if (i > 0 && (index[i].first < index[i - 1].first || index[i].last < index[i - 1].last))
      return "an interval's run begins or ends before that of the interval in front";
  }
  // Neither end of a run falls from one interval to the next, so a triangle's first and last interval decide.
  const Intervals intervals(page.interval, band.intervals);
  for (std::uint64_t k = 0; k < band.count; ++k) {
    const Lifespan& life = page.lifespans[band.first + k];
    if (k >= index[intervals.at(life.begin)].last || k < index[intervals.lastOf(life.end, page.interval)].first)
      return "a triangle lives in an interval whose run does not hold it";
  }
  return nullptr;
}

// The bands' own numbers, before any is used.
const char* checkBands(const PageView& page) {
  std::uint64_t triangles = 0, intervals = 0;
  for (const Band& band : page.bands) {
    if (band.first != triangles || band.first_interval != intervals) return "a band does not follow the one before";
    if (band.count == 0 || band.count > page.triangles.size() - triangles ||
        band.count > std::numeric_limits<std::uint32_t>::max()) {
      return "a band's triangles are none or out of range";
    }
    if (band.intervals == 0 || band.intervals > page.index.size() - intervals)
      return "a band's intervals are none or out of range";
    triangles += band.count;
    intervals += band.intervals;
  }
  if (!page.bands.empty() && triangles != page.triangles.size()) return "its bands do not hold all triangles";
  if (intervals != page.index.size()) return "its bands do not hold all intervals";
  return nullptr;
}

const char* checkBounds(const PageView& page, const Bounds4f& box) {
  for (const Vec4f& v : page.vertices) {
    if (!page_layout::isFinite(v)) return "a vertex is not finite";
    if (v.x < box.min.x || v.y < box.min.y || v.z < box.min.z || v.x > box.max.x || v.y > box.max.y ||
        v.z > box.max.z) {
      return "a vertex lies outside the page's bounds";
    }
  }
  for (const Lifespan& l : page.lifespans) {
    if (l.begin < box.min.t || l.end > box.max.t) return "a lifespan lies outside the page's time interval";
  }
  return nullptr;
}

}  // namespace

Lifespan unionOf(std::span<const Lifespan> lives) {
  Lifespan whole{};
  if (!lives.empty()) whole = lives[0];
  for (const Lifespan& life : lives) whole = {std::min(whole.begin, life.begin), std::max(whole.end, life.end)};
  return whole;
}

Result<PageView> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry, const std::string& file,
                              std::size_t page) {
  const auto bad = [&](const char* what) {
    return Fault{FaultCode::kBadInput, file, "page " + std::to_string(page), what, "write the file again"};
  };
  page_layout::Parser parser(bytes);
  const auto header = parser.take<PageHeader>(1);
  if (header.empty()) return bad("is shorter than its header");
  const PageHeader& h = header[0];
  if (anySet(h.reserved)) return bad("reserved bytes are not zero");
  if (h.vertices != entry.counts[0] || h.edges != entry.counts[1] || h.triangles != entry.counts[2]) {
    return bad("counts differ from the page table's");
  }
  PageView view;
  view.vertices = parser.take<Vec4f>(h.vertices);
  view.edges = parser.take<Edge>(h.edges);
  view.lifespans = parser.take<Lifespan>(h.triangles);
  view.triangles = parser.take<Triangle>(h.triangles);
  view.bands = parser.take<Band>(h.bands);
  view.index = parser.take<Alive>(h.intervals);
  view.part = h.part;
  if (h.triangles != 0) view.interval = {entry.bounds.min.t, entry.bounds.max.t};
  if (!parser.complete()) return bad("its size or padding does not fit its counts");
  for (const char* what : {checkBounds(view, entry.bounds), checkEdges(view)}) {
    if (what != nullptr) return bad(what);
  }
  for (const char* what : {checkTriangles(view), checkBands(view)}) {
    if (what != nullptr) return bad(what);
  }
  for (const Band& band : view.bands) {
    if (const char* what = checkAlive(view, band)) return bad(what);
  }
  return view;
}

std::uint64_t Intervals::lastOf(float end, const Lifespan& whole) const {
  // The page's end may be the file's, at which lives are closed.
  return end < whole.end ? at(std::nextafter(end, whole.begin)) : last_;
}

Result<File> File::open(const std::string& path) {
  auto opened = container::Reader::open(path, kPayload, kVersion, kKnown);
  if (!opened.ok()) return opened.fault();
  File file;
  file.reader_ = std::make_unique<container::Reader>(std::move(opened).value());
  // A player keeps it open for long: only its pages stay in the mapping.
  if (Status status = file.reader_->ownSections(kOwned); !status.ok()) return status.fault();
  const container::Reader& reader = *file.reader_;
  auto sections = mesh_sections::open<Header>(reader, {kHeader, kTimes, kColumns, kParts}, checkHeader);
  if (!sections.ok()) return sections.fault();
  file.header_ = sections.value().header;
  file.times_ = sections.value().times;
  file.columns_ = sections.value().columns;
  file.parts_ = sections.value().parts;
  if (reader.header().payload_version < 2 && (file.header_->columns != 0 || file.header_->parts != 0)) {
    return reader.fault(kHeader, "has columns or parts, which version 1 does not know");
  }
  auto pages = paged::Pages::open(reader);
  if (!pages.ok()) return pages.fault();
  file.pages_ = pages.value();
  const auto entries = file.pages_.entries();
  if (Status s = checkPages(reader, *file.header_, entries, file.columns_); !s.ok()) return s.fault();
  for (std::size_t i = 0; !file.columns_.empty() && i < entries.size(); i += file.tablePage(1))
    file.geometry_.push_back(entries[i]);
  return file;
}

Status File::verify() const {
  if (Status status = reader_->verifyAll(); !status.ok()) return status;
  if (Status status = pages_.verifyPadding(); !status.ok()) return status;
  Bounds4f all;
  for (std::size_t k = 0; k < geometryPages(); ++k) {
    const auto bad = [&](std::size_t i, const char* what) {
      return Fault{FaultCode::kBadInput, reader_->path(), "page " + std::to_string(i), what, "write the file again"};
    };
    auto page = loadGeometry(k);
    if (!page.ok()) return page.fault();
    auto view = validatePage(page.value().bytes(), geometryEntry(k), reader_->path(), tablePage(k));
    if (!view.ok()) return view.fault();
    for (const Vec4f& v : view.value().vertices) all.add(v);
    for (const Lifespan& l : view.value().lifespans) {
      if (l.end > header_->last_time) return bad(tablePage(k), "a lifespan ends after the file's last time");
    }
    if (view.value().part >= std::max<std::uint64_t>(1, header_->parts))
      return bad(tablePage(k), "belongs to a part that is not there");
    if (reader_->header().payload_version < 2 && !view.value().bands.empty())
      return bad(tablePage(k), "has bands, which version 1 does not know");
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      auto column = loadColumn(c, k);
      if (!column.ok()) return column.fault();
      const std::uint64_t used = geometryEntry(k).counts[0] * columns_[c].components * sizeof(float);
      Status zero = mesh_sections::checkColumnPadding(*reader_, column.value().bytes(), used, tablePage(k) + 1 + c);
      if (!zero.ok()) return zero;
    }
  }
  if (const Bounds4f box = page_layout::stored(all); box.min != header_->bounds.min || box.max != header_->bounds.max) {
    return reader_->fault(kHeader, "its bounds are not the box of the vertices");
  }
  return {};
}

Result<Writer> Writer::create(const std::string& path, const Header& header, std::span<const double> times,
                              paged::Codec codec, bool force, std::span<const Column> columns,
                              std::span<const double> part_isovalues) {
  const auto refused = [&](const char* place, const char* what) {
    return Fault{FaultCode::kUsage, path, place, what, ""};
  };
  Header checked = header;
  checked.bounds = page_layout::stored({});
  if (const char* what = checkHeader(checked)) return refused("section DHDR", what);
  if (Status s = page_layout::checkTimes(times, times.size(), path); !s.ok()) return s.fault();
  Writer writer;
  writer.columns_ = columnEntries(columns);
  if (const char* what = checkColumns(writer.columns_)) return refused("section COLS", what);
  for (const double isovalue : part_isovalues) writer.parts_.push_back({isovalue, {}});
  if (const char* what = checkParts(writer.parts_)) return refused("section PART", what);
  auto file = container::Writer::create(path, kPayload, kVersion, force);
  if (!file.ok()) return file.fault();
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_.index_to_world = header.index_to_world;
  writer.header_.last_time = header.last_time;
  writer.header_.frames = times.size();
  writer.header_.columns = static_cast<std::uint32_t>(columns.size());
  writer.header_.parts = part_isovalues.size();
  writer.times_.assign(times.begin(), times.end());
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::addPage(const PageView& page, std::uint64_t tets, std::uint64_t empty,
                       std::span<const std::span<const float>> columns) {
  const auto bad = [&](const char* what) {
    return Fault{FaultCode::kUsage, file_->path(), "page " + std::to_string(pages_->entries().size()), what, ""};
  };
  if (page.lifespans.size() != page.triangles.size()) return bad("there must be one lifespan a triangle");
  if (page.part >= std::max<std::size_t>(1, parts_.size())) return bad("belongs to a part that is not there");
  if (columns.size() != columns_.size()) return bad("the columns are not those declared");
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].size() != page.vertices.size() * columns_[c].components)
      return bad("the columns do not fit the vertices");
  }
  const PageHeader head{page.vertices.size(),
                        page.edges.size(),
                        page.triangles.size(),
                        page.bands.size(),
                        page.index.size(),
                        page.part,
                        {}};
  paged::PageEntry entry{};
  for (const Vec4f& v : page.vertices) entry.bounds.add(v);
  bounds_.add(entry.bounds);
  if (!page.lifespans.empty()) {  // the page's interval is when something is alive, not where its vertices lie
    const Lifespan whole = unionOf(page.lifespans);
    entry.bounds.min.t = whole.begin;
    entry.bounds.max.t = whole.end;
  }
  entry.counts[0] = head.vertices;
  entry.counts[1] = head.edges;
  entry.counts[2] = head.triangles;
  entry.error_measured = -1;
  header_.vertices += head.vertices;
  header_.edges += head.edges;
  header_.triangles += head.triangles;
  header_.tets += tets;
  header_.empty += empty;
  const std::array parts{std::as_bytes(std::span(&head, 1)), std::as_bytes(page.vertices),  std::as_bytes(page.edges),
                         std::as_bytes(page.lifespans),      std::as_bytes(page.triangles), std::as_bytes(page.bands),
                         std::as_bytes(page.index)};
  if (Status status = pages_->addParts(parts, entry); !status.ok()) return status;
  static constexpr std::array<std::byte, page_layout::kPartAlignment> kNothing{};
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto values = columns[c].empty() ? std::span<const std::byte>(kNothing) : std::as_bytes(columns[c]);
    entry.kind = static_cast<std::uint32_t>(1 + c);
    if (Status status = pages_->addParts({&values, 1}, entry); !status.ok()) return status;
  }
  return {};
}

Status Writer::close(const std::string& provenance_json) {
  header_.bounds = page_layout::stored(bounds_);
  if (Status status = pages_->end(); !status.ok()) return status;
  if (Status s = file_->add<Header>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
  if (Status s = file_->add<double>(kTimes, container::kSectionRequired, times_); !s.ok()) return s;
  if (!columns_.empty()) {
    if (Status s = file_->add<ColumnEntry>(kColumns, container::kSectionRequired, columns_); !s.ok()) return s;
  }
  if (!parts_.empty()) {
    if (Status s = file_->add<PartEntry>(kParts, container::kSectionRequired, parts_); !s.ok()) return s;
  }
  if (Status s = file_->add<char>(container::kProvenance, 0, provenance_json); !s.ok()) return s;
  return file_->close();
}

}  // namespace tet4d::dyntri
