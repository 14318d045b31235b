#include "formats/hypermesh.h"

#include <algorithm>

#include "formats/mesh_sections.h"
#include "formats/page_layout.h"

namespace tet4d::hypermesh {
namespace {

constexpr std::array kKnown{kHeader, kTimes, kColumns, kParts, paged::kPages, paged::kPageTable};

bool anySet(std::span<const std::uint64_t> reserved) {
  return std::any_of(reserved.begin(), reserved.end(), [](auto r) { return r != 0; });
}

// What is wrong with a header, or null.
const char* checkHeader(const MeshHeader& h) {
  if (anySet(h.reserved)) return "reserved bytes are not zero";
  if ((h.flags & ~(kOnGrid | kInnerBoundary)) != 0) return "unknown flags";
  if (!isUsable(h.index_to_world)) return "the map to world coordinates is not usable";
  if (!page_layout::isProper(h.domain)) return "the domain is not finite or not ordered";
  if (!page_layout::isProper(h.bounds)) return "the bounds are not finite or not ordered";
  if (std::isinf(h.isovalue)) return "the isovalue is infinite";
  return nullptr;
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
  float begin = -std::numeric_limits<float>::infinity();  // of the slab before
  for (std::size_t i = 0; i < pages.size(); ++i) {
    if (pages[i].kind != i % stride) return bad(i, "is not of the kind expected there");
    const auto& counts = pages[i - i % stride].counts;
    if (const std::size_t c = i % stride; c != 0) {
      const std::uint64_t bytes = counts[1] * columns[c - 1].components * sizeof(float);
      if (pages[i].raw_bytes != page_layout::columnBytes(bytes)) return bad(i, "has not the size of its column");
      continue;
    }
    if (counts[0] != vertices) return bad(i, "does not continue the vertex numbers");
    if (counts[1] > pages[i].raw_bytes / sizeof(Vec4f) || counts[2] > pages[i].raw_bytes / sizeof(Tet) ||
        counts[3] > h.vertices) {
      return bad(i, "has a count beyond its size");
    }
    if (counts[3] > (std::uint64_t{1} << 32) - std::min(counts[1], std::uint64_t{1} << 32)) {
      return bad(i, "has more vertices than local indices can name");
    }
    if (counts[2] != 0 && pages[i].bounds.min.t < begin) return bad(i, "begins before the slab in front of it");
    if (counts[2] != 0) begin = pages[i].bounds.min.t;
    vertices += counts[1];
    tets += counts[2];
  }
  if (vertices != h.vertices || tets != h.tets)
    return reader.fault(kHeader, "its counts are not the sums over the pages");
  return {};
}

const char* checkRuns(const PageView& page, std::uint64_t total_vertices) {
  std::uint64_t foreign = 0, end = 0;
  const std::uint64_t own_begin = page.header->first_vertex, own_end = own_begin + page.header->owned;
  for (const Run& run : page.runs) {
    if (run.count == 0 || run.first > total_vertices || run.count > total_vertices - run.first) {
      return "a run of foreign vertices is empty or out of range";
    }
    if (run.first < own_end && own_begin < run.first + run.count) return "a run of foreign vertices holds its own";
    // In order, so that an owner's page is loaded once however many runs there are.
    if (run.first < end) return "a run of foreign vertices overlaps the one before or stands out of order";
    end = run.first + run.count;
    foreign += run.count;
  }
  return foreign == page.header->foreign ? nullptr : "its runs do not sum to its foreign vertices";
}

// Memory that a loaded page takes; a raw one is mapped.
std::uint64_t decodedBytes(const paged::PageEntry& entry) {
  return entry.codec == static_cast<std::uint32_t>(paged::Codec::kRaw) ? 0 : entry.raw_bytes;
}

// A part of a run of foreign vertices that one page owns.
struct OwnedPart {
  std::size_t owner;           // geometry page
  std::uint64_t first, count;  // among its own vertices
};

// Runs, in order, cut where their owners change. O(parts log pages). Every vertex has an owner: checkRuns and
// checkPages.
std::vector<OwnedPart> ownedParts(const File& file, std::span<const Run> runs) {
  std::vector<OwnedPart> parts;
  for (const Run& run : runs) {
    for (std::uint64_t at = run.first; at < run.first + run.count;) {
      // The last page that begins at or before the vertex; the vertex numbers grow with the pages.
      std::size_t low = 0, high = file.geometryPages();
      while (high - low > 1) {
        const std::size_t middle = low + (high - low) / 2;
        (file.geometryEntry(middle).counts[0] <= at ? low : high) = middle;
      }
      const std::uint64_t first = file.geometryEntry(low).counts[0], owned = file.geometryEntry(low).counts[1];
      const std::uint64_t end = std::min(run.first + run.count, first + owned);
      parts.push_back({low, at - first, end - at});
      at = end;
    }
  }
  return parts;
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
  if (h.part != 0 && h.part >= mesh.parts) return bad("belongs to a part that is not there");
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
    const auto& [a, b, c, d] = tet;
    if (a == b || a == c || a == d || b == c || b == d || c == d) return bad("a tetrahedron has a vertex twice");
  }
  return view;
}

Result<File> File::open(const std::string& path) {
  auto opened = container::Reader::open(path, kPayload, kVersion, kKnown);
  if (!opened.ok()) return opened.fault();
  File file;
  file.reader_ = std::make_unique<container::Reader>(std::move(opened).value());
  const container::Reader& reader = *file.reader_;
  auto sections = mesh_sections::open<MeshHeader>(reader, {kHeader, kTimes, kColumns, kParts}, checkHeader);
  if (!sections.ok()) return sections.fault();
  file.header_ = sections.value().header;
  file.times_ = sections.value().times;
  file.columns_ = sections.value().columns;
  file.parts_ = sections.value().parts;
  if (file.header_->parts != 0 && reader.header().payload_version < 2) {
    return reader.fault(kParts, "has parts, which version 1 does not know");
  }
  auto pages = paged::Pages::open(reader);
  if (!pages.ok()) return pages.fault();
  file.pages_ = pages.value();
  if (Status s = checkPages(reader, *file.header_, file.pages_.entries(), file.columns_); !s.ok()) return s.fault();
  for (std::size_t k = 0; k < file.geometryPages(); ++k) {
    file.largest_decoded_ = std::max(file.largest_decoded_, decodedBytes(file.geometryEntry(k)));
  }
  return file;
}

Result<paged::PageBytes> File::loadPage(std::size_t k, PageView& view) const {
  auto bytes = pages_.load(k * stride());
  if (!bytes.ok()) return bytes.fault();
  auto valid = validatePage(bytes.value().bytes(), geometryEntry(k), *header_, reader_->path(), k * stride());
  if (!valid.ok()) return valid.fault();
  view = valid.value();
  return bytes;
}

Result<GatheredPage> File::gather(std::size_t k) const {
  GatheredPage page;
  auto bytes = loadPage(k, page.view);
  if (!bytes.ok()) return bytes.fault();
  page.bytes = std::move(bytes).value();
  page.positions.assign(page.view.vertices.begin(), page.view.vertices.end());
  std::size_t owner = geometryPages();  // whose page owner_bytes is
  paged::PageBytes owner_bytes;
  PageView owner_view;
  for (const OwnedPart& part : ownedParts(*this, page.view.runs)) {
    if (part.owner != owner) {
      auto loaded = loadPage(part.owner, owner_view);
      if (!loaded.ok()) return loaded.fault();
      owner_bytes = std::move(loaded).value();
      owner = part.owner;
    }
    const auto positions = owner_view.vertices.subspan(part.first, part.count);
    page.positions.insert(page.positions.end(), positions.begin(), positions.end());
  }
  return page;
}

Result<std::uint64_t> File::partOf(std::size_t k) const {
  PageView view;
  const auto bytes = loadPage(k, view);
  if (!bytes.ok()) return bytes.fault();
  return view.header->part;
}

std::uint64_t File::gatherBytes(std::size_t k) const {
  const auto& counts = geometryEntry(k).counts;
  return decodedBytes(geometryEntry(k)) + (counts[3] == 0 ? 0 : largest_decoded_) +
         (counts[1] + counts[3]) * sizeof(Vec4f);
}

Result<std::vector<float>> File::gatherColumn(std::size_t c, std::size_t k, const PageView& page) const {
  const std::size_t components = columns_[c].components;
  std::vector<float> values;
  values.reserve((page.header->owned + page.header->foreign) * components);
  paged::PageBytes bytes;
  std::size_t loaded_owner = geometryPages();  // whose column `bytes` is
  const auto append = [&](const OwnedPart& part) -> Status {
    if (part.owner != loaded_owner) {
      auto loaded = loadColumn(c, part.owner);
      if (!loaded.ok()) return loaded.fault();
      bytes = std::move(loaded).value();
      loaded_owner = part.owner;
    }
    const auto* floats = reinterpret_cast<const float*>(bytes.bytes().data());
    values.insert(values.end(), floats + part.first * components, floats + (part.first + part.count) * components);
    return {};
  };
  if (Status own = append({k, 0, page.header->owned}); !own.ok()) return own.fault();
  for (const OwnedPart& part : ownedParts(*this, page.runs)) {
    if (Status status = append(part); !status.ok()) return status.fault();
  }
  return values;
}

Result<std::uint64_t> File::contentDigest() const {
  auto pages = pages_.contentDigest();
  if (!pages.ok()) return pages.fault();
  std::vector<std::uint64_t> digests{container::xxh3(std::as_bytes(std::span(header_, 1))),
                                     container::xxh3(std::as_bytes(times_)), container::xxh3(std::as_bytes(columns_)),
                                     pages.value()};
  if (!parts_.empty()) digests.push_back(container::xxh3(std::as_bytes(parts_)));
  return container::xxh3(std::as_bytes(std::span(digests)));
}

Result<paged::PageBytes> File::loadColumn(std::size_t c, std::size_t k) const {
  return pages_.load(k * stride() + 1 + c);
}

Status File::verify() const {
  if (Status status = reader_->verifyAll(); !status.ok()) return status;
  if (Status status = pages_.verifyPadding(); !status.ok()) return status;
  Bounds4f all;
  for (std::size_t k = 0; k < geometryPages(); ++k) {
    auto page = gather(k);
    if (!page.ok()) return page.fault();
    for (const Vec4f& v : page.value().view.vertices) all.add(v);
    const Bounds4f& box = geometryEntry(k).bounds;
    for (const Tet& tet : page.value().view.tets) {
      for (const std::uint32_t i : tet) {
        Bounds4f with = box;
        with.add(page.value().positions[i]);
        if (with.min != box.min || with.max != box.max) {
          return Fault{FaultCode::kBadInput, reader_->path(), "page " + std::to_string(k * stride()),
                       "a vertex lies outside the page's bounds", "write the file again"};
        }
      }
    }
  }
  for (std::size_t i = 0; i < pages_.size(); ++i) {
    if (i % stride() == 0) continue;
    auto page = pages_.load(i);
    if (!page.ok()) return page.fault();
    const auto& entry = pages_.entries()[i - i % stride()];
    const std::uint64_t used = entry.counts[1] * columns_[i % stride() - 1].components * sizeof(float);
    Status zero = mesh_sections::checkColumnPadding(*reader_, page.value().bytes(), used, i);
    if (!zero.ok()) return zero;
  }
  if (const Bounds4f box = page_layout::stored(all); box.min != header_->bounds.min || box.max != header_->bounds.max) {
    return reader_->fault(kHeader, "its bounds are not the box of the vertices");
  }
  return {};
}

Result<Writer> Writer::create(const std::string& path, const MeshHeader& header, std::span<const double> times,
                              std::span<const Column> columns, paged::Codec codec, bool force,
                              std::span<const double> part_isovalues) {
  MeshHeader checked = header;
  checked.bounds = page_layout::stored({});
  if (const char* what = checkHeader(checked)) return Fault{FaultCode::kUsage, path, "section HHDR", what, ""};
  if (Status s = page_layout::checkTimes(times, times.size(), path); !s.ok()) return s.fault();
  std::vector<ColumnEntry> entries = columnEntries(columns);
  if (const char* what = checkColumns(entries)) return Fault{FaultCode::kUsage, path, "section COLS", what, ""};
  std::vector<PartEntry> parts;
  for (const double isovalue : part_isovalues) parts.push_back({isovalue, {}});
  if (const char* what = checkParts(parts)) return Fault{FaultCode::kUsage, path, "section PART", what, ""};
  auto file = container::Writer::create(path, kPayload, parts.empty() ? 1 : 2, force);
  if (!file.ok()) return file.fault();
  Writer writer;
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_ = header;
  writer.header_.frames = times.size();
  writer.header_.columns = static_cast<std::uint32_t>(columns.size());
  writer.header_.parts = parts.size();
  writer.parts_ = std::move(parts);
  writer.times_.assign(times.begin(), times.end());
  writer.columns_ = std::move(entries);
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::setTimes(std::span<const double> times, float last_t) {
  if (Status s = page_layout::checkTimes(times, times.size(), file_->path()); !s.ok()) return s;
  times_.assign(times.begin(), times.end());
  header_.frames = times.size();
  header_.domain.max.t = last_t;
  return {};
}

Status Writer::addPage(std::span<const Vec4f> vertices, std::span<const Run> runs, std::span<const Tet> tets,
                       const Bounds4f& bounds, std::span<const std::span<const float>> columns, std::uint64_t part) {
  const auto bad = [&](const char* what) {
    return Fault{FaultCode::kUsage, file_->path(), "page " + std::to_string(pages_->entries().size()), what, ""};
  };
  if (part >= std::max<std::size_t>(1, parts_.size())) return bad("belongs to a part that is not there");
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns.size() != columns_.size() || columns[c].size() != vertices.size() * columns_[c].components) {
      return bad("the columns do not fit the vertices");
    }
  }
  PageHeader head{};
  head.first_vertex = next_vertex_;
  head.owned = vertices.size();
  head.tets = tets.size();
  head.runs = runs.size();
  for (const Run& run : runs) head.foreign += run.count;
  head.part = part;
  paged::PageEntry entry{};
  entry.bounds = bounds;
  entry.counts[0] = head.first_vertex;
  entry.counts[1] = head.owned;
  entry.counts[2] = head.tets;
  entry.counts[3] = head.foreign;
  entry.error_estimated = error_estimated_;
  entry.error_measured = error_measured_;
  error_estimated_ = 0;
  error_measured_ = -1;
  for (const Vec4f& v : vertices) bounds_.add(v);
  next_vertex_ += head.owned;
  tets_ += head.tets;
  const std::array parts{std::as_bytes(std::span(&head, 1)), std::as_bytes(vertices), std::as_bytes(runs),
                         std::as_bytes(tets)};
  if (Status status = pages_->addParts(parts, entry); !status.ok()) return status;
  static constexpr std::array<std::byte, page_layout::kPartAlignment> kNothing{};
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto values = columns[c].empty() ? std::span<const std::byte>(kNothing) : std::as_bytes(columns[c]);
    entry.kind = static_cast<std::uint32_t>(1 + c);
    if (Status status = pages_->addParts({&values, 1}, entry); !status.ok()) return status;
  }
  return {};
}

Status Writer::close(const std::string& provenance_json) {
  if (Status status = pages_->end(); !status.ok()) return status;
  header_.vertices = next_vertex_;
  header_.tets = tets_;
  header_.bounds = page_layout::stored(bounds_);
  if (const char* what = checkHeader(header_)) return Fault{FaultCode::kUsage, file_->path(), "section HHDR", what, ""};
  if (Status s = file_->add<MeshHeader>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
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

}  // namespace tet4d::hypermesh
