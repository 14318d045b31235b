#include "formats/dynamic_triangles.h"

#include <algorithm>
#include <array>

#include "formats/page_layout.h"

namespace tet4d::dyntri {
namespace {

constexpr std::array kOwned{kHeader, kTimes, paged::kPageTable};  // copied when a file is opened
constexpr std::array kKnown{kHeader, kTimes, paged::kPages, paged::kPageTable};

bool anySet(std::span<const std::uint64_t> reserved) {
  return std::any_of(reserved.begin(), reserved.end(), [](auto r) { return r != 0; });
}

// What is wrong with a header, or null.
const char* checkHeader(const Header& h) {
  if (h.reserved0 != 0 || anySet(h.reserved1)) return "reserved bytes are not zero";
  if (!isUsable(h.index_to_world)) return "the map to world coordinates is not usable";
  if (!page_layout::isProper(h.bounds)) return "the bounds are not finite or not ordered";
  if (!std::isfinite(h.last_time)) return "the last time is not finite";
  return nullptr;
}

// The header's sums against the page table's counts.
Status checkSums(const container::Reader& reader, const Header& h, const paged::Pages& pages) {
  constexpr std::array<std::size_t, 3> kBytes{sizeof(Vec4f), sizeof(Edge), sizeof(Triangle)};
  std::array<std::uint64_t, 3> sums{};
  for (const paged::PageEntry& e : pages.entries()) {
    if (e.kind != 0) return reader.fault(paged::kPageTable, "has a page of unknown kind");
    if (e.counts[3] != 0) return reader.fault(paged::kPageTable, "has a fourth count that is not zero");
    for (std::size_t i = 0; i < 3; ++i) {
      if (e.counts[i] > e.raw_bytes / kBytes[i])
        return reader.fault(paged::kPageTable, "has a count beyond its page's size");
      sums[i] += e.counts[i];
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
    if (i > 0 && life.begin < page.lifespans[i - 1].begin)
      return "triangles are not sorted by the begin of their lives";
  }
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
  if (!parser.complete()) return bad("its size or padding does not fit its counts");
  for (const char* what : {checkBounds(view, entry.bounds), checkEdges(view)}) {
    if (what != nullptr) return bad(what);
  }
  if (const char* what = checkTriangles(view)) return bad(what);
  return view;
}

Result<File> File::open(const std::string& path) {
  auto opened = container::Reader::open(path, kPayload, kVersion, kKnown);
  if (!opened.ok()) return opened.fault();
  File file;
  file.reader_ = std::make_unique<container::Reader>(std::move(opened).value());
  // A player keeps it open for long: only its pages stay in the mapping.
  if (Status status = file.reader_->ownSections(kOwned); !status.ok()) return status.fault();
  const container::Reader& reader = *file.reader_;
  auto header = reader.single<Header>(kHeader);
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
  if (Status status = checkSums(reader, *file.header_, file.pages_); !status.ok()) return status.fault();
  return file;
}

Status File::verify() const {
  if (Status status = reader_->verifyAll(); !status.ok()) return status;
  if (Status status = pages_.verifyPadding(); !status.ok()) return status;
  Bounds4f all;
  for (std::size_t k = 0; k < pages_.size(); ++k) {
    auto page = pages_.load(k);
    if (!page.ok()) return page.fault();
    auto view = validatePage(page.value().bytes(), pages_.entries()[k], reader_->path(), k);
    if (!view.ok()) return view.fault();
    for (const Vec4f& v : view.value().vertices) all.add(v);
    for (const Lifespan& l : view.value().lifespans) {
      if (l.end > header_->last_time) {
        return Fault{FaultCode::kBadInput, reader_->path(), "page " + std::to_string(k),
                     "a lifespan ends after the file's last time", "write the file again"};
      }
    }
  }
  if (const Bounds4f box = page_layout::stored(all); box.min != header_->bounds.min || box.max != header_->bounds.max) {
    return reader_->fault(kHeader, "its bounds are not the box of the vertices");
  }
  return {};
}

Result<Writer> Writer::create(const std::string& path, const Header& header, std::span<const double> times,
                              paged::Codec codec, bool force) {
  Header checked = header;
  checked.bounds = page_layout::stored({});
  if (const char* what = checkHeader(checked)) return Fault{FaultCode::kUsage, path, "section DHDR", what, ""};
  if (Status s = page_layout::checkTimes(times, times.size(), path); !s.ok()) return s.fault();
  auto file = container::Writer::create(path, kPayload, kVersion, force);
  if (!file.ok()) return file.fault();
  Writer writer;
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_.index_to_world = header.index_to_world;
  writer.header_.last_time = header.last_time;
  writer.header_.frames = times.size();
  writer.times_.assign(times.begin(), times.end());
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::addPage(const PageView& page, std::uint64_t tets, std::uint64_t empty) {
  if (page.lifespans.size() != page.triangles.size()) {
    return Fault{FaultCode::kUsage, file_->path(), "page " + std::to_string(pages_->entries().size()),
                 "there must be one lifespan a triangle", ""};
  }
  const PageHeader head{page.vertices.size(), page.edges.size(), page.triangles.size(), {}};
  using page_layout::padded;
  page_layout::Builder builder(padded(sizeof head) + padded(page.vertices.size_bytes()) +
                               padded(page.edges.size_bytes()) + padded(page.lifespans.size_bytes()) +
                               padded(page.triangles.size_bytes()));
  builder.add<PageHeader>({&head, 1});
  builder.add(page.vertices);
  builder.add(page.edges);
  builder.add(page.lifespans);
  builder.add(page.triangles);
  paged::PageEntry entry{};
  for (const Vec4f& v : page.vertices) entry.bounds.add(v);
  bounds_.add(entry.bounds);
  if (!page.lifespans.empty()) {  // the page's interval is when something is alive, not where its vertices lie
    entry.bounds.min.t = page.lifespans.front().begin;
    entry.bounds.max.t = entry.bounds.min.t;
    for (const Lifespan& l : page.lifespans) entry.bounds.max.t = std::max(entry.bounds.max.t, l.end);
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
  return pages_->add(builder.bytes(), entry);
}

Status Writer::close(const std::string& provenance_json) {
  header_.bounds = page_layout::stored(bounds_);
  if (Status status = pages_->end(); !status.ok()) return status;
  if (Status s = file_->add<Header>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
  if (Status s = file_->add<double>(kTimes, container::kSectionRequired, times_); !s.ok()) return s;
  if (Status s = file_->add<char>(container::kProvenance, 0, provenance_json); !s.ok()) return s;
  return file_->close();
}

}  // namespace tet4d::dyntri
