#include "formats/hypermesh.h"

#include <algorithm>
#include <cstring>

#include "formats/page_layout.h"

namespace tet4d::hypermesh {
namespace {

constexpr std::array kKnown{kHeader, kTimes, kColumns, paged::kPages, paged::kPageTable};

bool anySet(std::span<const std::uint64_t> reserved) {
  return std::any_of(reserved.begin(), reserved.end(), [](auto r) { return r != 0; });
}

bool boxOk(const Bounds4f& box) {
  return page_layout::isFinite(box.min) && page_layout::isFinite(box.max) && !box.empty();
}

Status checkHeader(const container::Reader& reader, const MeshHeader& h) {
  if (anySet(h.reserved)) return reader.fault(kHeader, "reserved bytes are not zero");
  if ((h.flags & ~(kOnGrid | kInnerBoundary)) != 0) return reader.fault(kHeader, "unknown flags");
  if (!isUsable(h.index_to_world)) return reader.fault(kHeader, "the map to world coordinates is not usable");
  if (!boxOk(h.domain) || !boxOk(h.bounds))
    return reader.fault(kHeader, "domain or bounds are not finite or not ordered");
  if (std::isinf(h.isovalue)) return reader.fault(kHeader, "the isovalue is infinite");
  return {};
}

// A page is never empty, so that of a column without vertices is one part of zeros.
std::uint64_t columnBytes(std::uint64_t bytes) {
  return std::max<std::uint64_t>(page_layout::padded(bytes), page_layout::kPartAlignment);
}

Status checkColumns(const container::Reader& reader, const MeshHeader& h, std::span<const ColumnEntry> columns) {
  if (columns.size() != h.columns) return reader.fault(kColumns, "has another number of columns than the header");
  for (const ColumnEntry& c : columns) {
    const std::size_t length = strnlen(c.name, sizeof c.name);
    const bool padded = std::all_of(c.name + length, c.name + sizeof c.name, [](char ch) { return ch == 0; });
    if (length == 0 || length == sizeof c.name || !padded) return reader.fault(kColumns, "a column has no proper name");
    if (c.components < 1 || c.components > 4 || c.reserved != 0) return reader.fault(kColumns, "impossible components");
  }
  return {};
}

// Every geometry page, in the order of its vertices, then its column pages.
Status checkPages(const container::Reader& reader, const MeshHeader& h, std::span<const paged::PageEntry> pages,
                  std::span<const ColumnEntry> columns) {
  const auto bad = [&](std::size_t i, const char* what) {
    return reader.fault(paged::kPageTable, "page " + std::to_string(i) + " " + what);
  };
  const std::size_t stride = 1 + columns.size();
  if (pages.size() % stride != 0) return bad(pages.size(), "is missing");
  std::uint64_t vertices = 0, tets = 0;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    if (pages[i].kind != i % stride) return bad(i, "is not of the kind expected there");
    const auto& counts = pages[i - i % stride].counts;
    if (const std::size_t c = i % stride; c != 0) {
      const std::uint64_t bytes = counts[1] * columns[c - 1].components * sizeof(float);
      if (pages[i].raw_bytes != columnBytes(bytes)) return bad(i, "has not the size of its column");
      continue;
    }
    if (counts[0] != vertices) return bad(i, "does not continue the vertex numbers");
    if (counts[1] > pages[i].raw_bytes || counts[2] > pages[i].raw_bytes || counts[3] > h.vertices) {
      return bad(i, "has a count beyond its size");
    }
    if (counts[3] > (std::uint64_t{1} << 32) - std::min(counts[1], std::uint64_t{1} << 32)) {
      return bad(i, "has more vertices than local indices can name");
    }
    vertices += counts[1];
    tets += counts[2];
  }
  if (vertices != h.vertices || tets != h.tets)
    return reader.fault(kHeader, "its counts are not the sums over the pages");
  return {};
}

const char* checkRuns(const PageView& page, std::uint64_t total_vertices) {
  std::uint64_t foreign = 0;
  const std::uint64_t own_begin = page.header->first_vertex, own_end = own_begin + page.header->owned;
  for (const Run& run : page.runs) {
    if (run.count == 0 || run.first > total_vertices || run.count > total_vertices - run.first) {
      return "a run of foreign vertices is empty or out of range";
    }
    if (run.first < own_end && own_begin < run.first + run.count) return "a run of foreign vertices holds its own";
    foreign += run.count;
    if (foreign > total_vertices) return "its runs hold more vertices than there are";
  }
  return foreign == page.header->foreign ? nullptr : "its runs do not sum to its foreign vertices";
}

}  // namespace

std::uint64_t PageView::globalOf(std::uint32_t local) const {
  if (local < vertices.size()) return header->first_vertex + local;
  std::uint64_t rest = local - vertices.size();
  for (const Run& run : runs) {
    if (rest < run.count) return run.first + rest;
    rest -= run.count;
  }
  assert(false && "local index out of range");
  return 0;
}

Result<PageView> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry, const MeshHeader& mesh,
                              const std::string& file, std::size_t page) {
  const auto bad = [&](const char* what) {
    return Fault{FaultCode::kBadInput, file, "page " + std::to_string(page), what, "write the file again"};
  };
  page_layout::Parser parser(bytes);
  const auto header = parser.take<PageHeader>(1);
  if (header.empty()) return bad("is shorter than its header");
  PageView view;
  view.header = header.data();
  const PageHeader& h = header[0];
  if (anySet(h.reserved)) return bad("reserved bytes are not zero");
  if (h.first_vertex != entry.counts[0] || h.owned != entry.counts[1] || h.tets != entry.counts[2] ||
      h.foreign != entry.counts[3]) {
    return bad("counts differ from the page table's");
  }
  view.vertices = parser.take<Vec4f>(h.owned);
  view.runs = parser.take<Run>(h.runs);
  view.tets = parser.take<Tet>(h.tets);
  if (!parser.complete()) return bad("its size or padding does not fit its counts");
  if (const char* what = checkRuns(view, mesh.vertices)) return bad(what);
  for (const Vec4f& v : view.vertices) {
    if (!page_layout::isFinite(v)) return bad("a vertex is not finite");
  }
  const std::uint64_t locals = h.owned + h.foreign;
  for (const Tet& tet : view.tets) {
    for (const std::uint32_t i : tet) {
      if (i >= locals) return bad("a tetrahedron's vertex is out of range");
    }
  }
  return view;
}

Result<File> File::open(const std::string& path) {
  auto opened = container::Reader::open(path, kPayload, kVersion, kKnown);
  if (!opened.ok()) return opened.fault();
  File file;
  file.reader_ = std::make_unique<container::Reader>(std::move(opened).value());
  const container::Reader& reader = *file.reader_;
  auto header = reader.single<MeshHeader>(kHeader);
  if (!header.ok()) return header.fault();
  file.header_ = header.value();
  auto times = reader.items<double>(kTimes);
  if (!times.ok()) return times.fault();
  file.times_ = times.value();
  if (reader.find(kColumns) != nullptr) {
    auto columns = reader.items<ColumnEntry>(kColumns);
    if (!columns.ok()) return columns.fault();
    file.columns_ = columns.value();
    if (Status s = reader.verifySection(*reader.find(kColumns)); !s.ok()) return s.fault();
  }
  for (const std::uint32_t kind : {kHeader, kTimes}) {
    if (Status status = reader.verifySection(*reader.find(kind)); !status.ok()) return status.fault();
  }
  if (Status s = checkHeader(reader, *file.header_); !s.ok()) return s.fault();
  if (Status s = page_layout::checkTimes(file.times_, file.header_->frames, path); !s.ok()) return s.fault();
  if (Status s = checkColumns(reader, *file.header_, file.columns_); !s.ok()) return s.fault();
  auto pages = paged::Pages::open(reader);
  if (!pages.ok()) return pages.fault();
  file.pages_ = pages.value();
  if (Status s = checkPages(reader, *file.header_, file.pages_.entries(), file.columns_); !s.ok()) return s.fault();
  return file;
}

Result<paged::PageBytes> File::loadPage(std::size_t k, PageView& view) const {
  auto bytes = pages_.load(k * stride());
  if (!bytes.ok()) return bytes.fault();
  auto valid = validatePage(bytes.value().bytes(), geometryEntry(k), *header_, reader_->path(), k);
  if (!valid.ok()) return valid.fault();
  view = valid.value();
  return bytes;
}

Result<GatheredPage> File::gather(std::size_t k) const {
  GatheredPage page;
  auto bytes = loadPage(k, page.view);
  if (!bytes.ok()) return bytes.fault();
  page.bytes = std::move(bytes).value();
  page.positions.reserve(page.view.header->owned + page.view.header->foreign);
  page.positions.assign(page.view.vertices.begin(), page.view.vertices.end());
  // The geometry page that owns a global vertex: the last that begins at or before it and owns any.
  const auto ownerOf = [&](std::uint64_t vertex) {
    std::size_t low = 0, high = geometryPages();
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (geometryEntry(middle).counts[0] <= vertex ? low : high) = middle;
    }
    return low;
  };
  for (const Run& run : page.view.runs) {
    // A run may span several owners; the vertex numbers grow with the pages.
    for (std::uint64_t at = run.first; at < run.first + run.count;) {
      const std::size_t owner = ownerOf(at);
      PageView owner_view;
      auto owner_bytes = loadPage(owner, owner_view);
      if (!owner_bytes.ok()) return owner_bytes.fault();
      const std::uint64_t first = owner_view.header->first_vertex;
      const std::uint64_t end = std::min(run.first + run.count, first + owner_view.header->owned);
      const auto part = owner_view.vertices.subspan(at - first, end - at);
      page.positions.insert(page.positions.end(), part.begin(), part.end());
      at = end;
    }
  }
  return page;
}

Result<paged::PageBytes> File::loadColumn(std::size_t c, std::size_t k) const {
  return pages_.load(k * stride() + 1 + c);
}

Status File::verify() const {
  if (Status status = reader_->verifyAll(); !status.ok()) return status;
  if (Status status = pages_.verifyPadding(); !status.ok()) return status;
  for (std::size_t k = 0; k < geometryPages(); ++k) {
    auto page = gather(k);
    if (!page.ok()) return page.fault();
    const Bounds4f& box = geometryEntry(k).bounds;
    for (const Tet& tet : page.value().view.tets) {
      for (const std::uint32_t i : tet) {
        Bounds4f with = box;
        with.add(page.value().positions[i]);
        if (with.min != box.min || with.max != box.max) {
          return Fault{FaultCode::kBadInput, reader_->path(), "page " + std::to_string(k),
                       "a vertex lies outside the page's bounds", "write the file again"};
        }
      }
    }
  }
  for (std::size_t i = 0; i < pages_.size(); ++i) {
    if (i % stride() == 0) continue;
    if (auto page = pages_.load(i); !page.ok()) return page.fault();
  }
  return {};
}

Result<Writer> Writer::create(const std::string& path, const MeshHeader& header, std::span<const double> times,
                              std::span<const Column> columns, paged::Codec codec, bool force) {
  auto file = container::Writer::create(path, kPayload, kVersion, force);
  if (!file.ok()) return file.fault();
  Writer writer;
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_ = header;
  writer.header_.frames = times.size();
  writer.header_.columns = static_cast<std::uint32_t>(columns.size());
  writer.times_.assign(times.begin(), times.end());
  writer.columns_.assign(columns.begin(), columns.end());
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::addPage(std::span<const Vec4f> vertices, std::span<const Run> runs, std::span<const Tet> tets,
                       const Bounds4f& bounds, std::span<const std::span<const float>> columns) {
  assert(columns.size() == columns_.size());
  PageHeader head{};
  head.first_vertex = next_vertex_;
  head.owned = vertices.size();
  head.tets = tets.size();
  head.runs = runs.size();
  for (const Run& run : runs) head.foreign += run.count;
  page_layout::Builder builder;
  builder.add<PageHeader>({&head, 1});
  builder.add(vertices);
  builder.add(runs);
  builder.add(tets);
  paged::PageEntry entry{};
  entry.bounds = bounds;
  entry.counts[0] = head.first_vertex;
  entry.counts[1] = head.owned;
  entry.counts[2] = head.tets;
  entry.counts[3] = head.foreign;
  entry.error_measured = -1;
  for (const Vec4f& v : vertices) bounds_.add(v);
  next_vertex_ += head.owned;
  tets_ += head.tets;
  if (Status status = pages_->add(builder.bytes(), entry); !status.ok()) return status;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    assert(columns[c].size() == vertices.size() * columns_[c].components);
    std::vector<std::byte> bytes(columnBytes(columns[c].size_bytes()));
    std::memcpy(bytes.data(), columns[c].data(), columns[c].size_bytes());
    entry.kind = static_cast<std::uint32_t>(1 + c);
    if (Status status = pages_->add(bytes, entry); !status.ok()) return status;
  }
  return {};
}

Status Writer::close(const std::string& provenance_json) {
  if (Status status = pages_->end(); !status.ok()) return status;
  header_.vertices = next_vertex_;
  header_.tets = tets_;
  header_.bounds = bounds_.empty() ? Bounds4f{{0, 0, 0, 0}, {0, 0, 0, 0}} : bounds_;
  if (Status s = file_->add<MeshHeader>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
  if (Status s = file_->add<double>(kTimes, container::kSectionRequired, times_); !s.ok()) return s;
  if (!columns_.empty()) {
    std::vector<ColumnEntry> entries(columns_.size());
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      columns_[c].name.copy(entries[c].name, sizeof entries[c].name - 1);
      entries[c].components = columns_[c].components;
    }
    if (Status s = file_->add<ColumnEntry>(kColumns, 0, entries); !s.ok()) return s;
  }
  if (Status s = file_->add<char>(container::kProvenance, 0, provenance_json); !s.ok()) return s;
  return file_->close();
}

}  // namespace tet4d::hypermesh
