#include "formats/patch_dag.h"

#include <algorithm>

#include "formats/mesh_sections.h"
#include "formats/page_layout.h"

namespace tet4d::patch_dag {
namespace {

constexpr std::array kKnown{kHeader, kTimes, kNodes, kColumns, paged::kPages, paged::kPageTable};

bool anySet(std::span<const std::uint64_t> reserved) {
  return std::any_of(reserved.begin(), reserved.end(), [](auto r) { return r != 0; });
}

// What is wrong with a header, or null.
const char* checkHeader(const Header& h) {
  if (anySet(h.reserved)) return "reserved bytes are not zero";
  if ((h.flags & ~(kOnGrid | kInnerBoundary)) != 0) return "unknown flags";
  if (!isUsable(h.index_to_world)) return "the map to world coordinates is not usable";
  if (!page_layout::isProper(h.domain)) return "the domain is not finite or not ordered";
  if (!page_layout::isProper(h.bounds)) return "the bounds are not finite or not ordered";
  if (std::isinf(h.isovalue)) return "the isovalue is infinite";
  if (!std::isfinite(h.time_scale) || !(h.time_scale > 0)) return "the time scale is no number above 0";
  return nullptr;
}

bool isZero(const Bounds4f& box) {
  constexpr Vec4f kOrigin{0, 0, 0, 0};
  return box.min == kOrigin && box.max == kOrigin;
}

// Whether `outer` holds `inner`; both are proper.
bool holds(const Bounds4f& outer, const Bounds4f& inner) {
  Bounds4f both = outer;
  both.add(inner);
  return both.min == outer.min && both.max == outer.max;
}

bool errorOk(float error) { return std::isfinite(error) && error >= 0; }

// What is wrong with node i of n by itself, or null.
const char* checkNode(const NodeEntry& node, std::size_t i, std::size_t n, bool measured) {
  const bool is_sink = i + 1 == n;
  if ((node.flags & ~kStuck) != 0) return "has unknown flags";
  if (!errorOk(node.error_estimated)) return "has an error that is no finite number from 0";
  if (measured || is_sink ? !errorOk(node.error_measured) : node.error_measured != -1)
    return "has a measured error and others have none, or it is no finite number from 0";
  if (!page_layout::isProper(node.bounds)) return "has bounds that are not finite or not ordered";
  if (is_sink && (node.level != 0 || node.flags != 0 || node.error_estimated != 0 || node.error_measured != 0 ||
                  node.patches != 0 || !isZero(node.bounds)))
    return "is the sink and yet has patches, a level, an error or bounds";
  if (!is_sink && node.level == 0) return "has the sink's level";
  return nullptr;
}

// What is wrong with an arc, or null. The nodes are proved by themselves.
const char* checkArc(const paged::PageEntry& patch, std::span<const NodeEntry> nodes) {
  const std::uint64_t from = patch.counts[2], to = patch.counts[3];
  if (to >= nodes.size() || from >= to) return "does not lead from a node to a later one";
  const NodeEntry &upper = nodes[from], &lower = nodes[to];
  const bool ends_in_sink = to + 1 == nodes.size();
  if (lower.level >= upper.level) return "does not lead to a smaller level";
  if (lower.error_estimated > upper.error_estimated) return "leads to a node of a larger estimated error";
  if (!ends_in_sink && lower.error_measured > upper.error_measured) return "leads to a node of a larger measured error";
  if (patch.error_estimated != lower.error_estimated || patch.error_measured != lower.error_measured)
    return "has not the errors of the node it ends in";
  if (!holds(upper.bounds, patch.bounds)) return "lies outside the bounds of the node it comes from";
  if (ends_in_sink) return nullptr;
  if (!holds(upper.bounds, lower.bounds)) return "leads to a node whose bounds are not within its own node's";
  return holds(lower.bounds, patch.bounds) ? nullptr : "lies outside the bounds of the node it ends in";
}

struct Sums {
  std::uint64_t vertices = 0, tets = 0, leaf_tets = 0;
};

// Nodes, arcs and sums of a file or of what is to be one. fault(kind, what) makes the Fault.
template <class MakeFault>
Status checkGraph(std::span<const NodeEntry> nodes, std::span<const paged::PageEntry> pages, std::size_t stride,
                  Sums& sums, const MakeFault& fault) {
  const auto badNode = [&](std::size_t i, const char* what) {
    return fault(kNodes, "node " + std::to_string(i) + " " + what);
  };
  if (nodes.size() < 2) return fault(kNodes, "has no source and no sink");
  const bool measured = nodes.front().error_measured != -1;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (const char* what = checkNode(nodes[i], i, nodes.size(), measured)) return badNode(i, what);
  }
  const std::size_t patches = pages.size() / stride;
  std::vector<bool> is_reached(nodes.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].first_patch != next || nodes[i].patches > patches - next)
      return badNode(i, "does not continue the patches of the node in front of it");
    next += nodes[i].patches;
    if (nodes[i].patches == 0 && i + 1 < nodes.size() && patches != 0) return badNode(i, "has no patches");
    for (std::size_t p = nodes[i].first_patch; p < next; ++p) {
      const paged::PageEntry& entry = pages[p * stride];
      if (entry.counts[2] != i) return badNode(i, "has a patch that comes from another node");
      if (const char* what = checkArc(entry, nodes))
        return fault(paged::kPageTable, "page " + std::to_string(p * stride) + " " + what);
      is_reached[entry.counts[3]] = true;
      sums.vertices += entry.counts[0];
      sums.tets += entry.counts[1];
      sums.leaf_tets += entry.counts[3] + 1 == nodes.size() ? entry.counts[1] : 0;
    }
  }
  if (next != patches) return fault(kNodes, "leaves patches that come from no node");
  if (patches == 0 && nodes.size() != 2) return fault(kNodes, "has nodes without a patch");
  for (std::size_t i = 1; i < nodes.size() && patches != 0; ++i)
    if (!is_reached[i]) return badNode(i, "has no patch that ends in it");
  return {};
}

// What is wrong with the page table apart from the graph, or null.
Status checkPages(const container::Reader& reader, std::span<const paged::PageEntry> pages,
                  std::span<const ColumnEntry> columns) {
  const auto bad = [&](std::size_t i, const char* what) {
    return reader.fault(paged::kPageTable, "page " + std::to_string(i) + " " + what);
  };
  const std::size_t stride = 1 + columns.size();
  if (pages.size() % stride != 0) return bad(pages.size(), "is missing");
  for (std::size_t i = 0; i < pages.size(); ++i) {
    if (pages[i].kind != i % stride) return bad(i, "is not of the kind expected there");
    const auto& counts = pages[i - i % stride].counts;
    if (const std::size_t c = i % stride; c != 0) {
      const std::uint64_t bytes = counts[0] * columns[c - 1].components * sizeof(float);
      if (pages[i].raw_bytes != page_layout::columnBytes(bytes)) return bad(i, "has not the size of its column");
      continue;
    }
    if (counts[0] == 0 || counts[0] > kMostVertices) return bad(i, "has no vertex, or more than 65535");
    if (counts[1] == 0 || counts[1] > pages[i].raw_bytes / sizeof(LocalTet))
      return bad(i, "has a count beyond its size");
  }
  return {};
}

}  // namespace

Result<PatchView> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry, const std::string& file,
                               std::size_t page) {
  const auto bad = [&](std::string what) {
    return Fault{FaultCode::kBadInput, file, "page " + std::to_string(page), std::move(what), "write the file again"};
  };
  page_layout::Parser parser(bytes);
  const auto header = parser.take<PatchHeader>(1);
  if (header.empty()) return bad("is shorter than its header");
  const PatchHeader& h = header[0];
  if (anySet(h.reserved)) return bad("reserved bytes are not zero");
  if (h.vertices != entry.counts[0] || h.tets != entry.counts[1] || h.from != entry.counts[2] ||
      h.to != entry.counts[3]) {
    return bad("counts differ from the page table's");
  }
  if (h.vertices == 0 || h.vertices > kMostVertices) return bad("has no vertex, or more than 65535");
  if (h.shared > h.vertices) return bad("shares more vertices than it has");
  PatchView view;
  view.header = header.data();
  view.vertices = parser.take<Vec4f>(h.vertices);
  view.tets = parser.take<LocalTet>(h.tets);
  if (!parser.complete()) return bad("its size or padding does not fit its counts");
  Bounds4f box;
  for (const Vec4f& v : view.vertices) {
    if (!page_layout::isFinite(v)) return bad("a vertex is not finite");
    box.add(v);
  }
  if (!holds(entry.bounds, box)) return bad("a vertex lies outside the page's bounds");
  for (const LocalTet& tet : view.tets) {
    const auto& [a, b, c, d] = tet;
    if (std::max({a, b, c, d}) >= h.vertices) return bad("a tetrahedron's vertex is out of range");
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
  auto header = reader.single<Header>(kHeader);
  if (!header.ok()) return header.fault();
  auto times = reader.items<double>(kTimes);
  if (!times.ok()) return times.fault();
  auto nodes = reader.items<NodeEntry>(kNodes);
  if (!nodes.ok()) return nodes.fault();
  auto columns = mesh_sections::optional<ColumnEntry>(reader, kColumns);
  if (!columns.ok()) return columns.fault();
  for (const std::uint32_t kind : {kHeader, kTimes, kNodes}) {
    if (Status status = reader.verifySection(*reader.find(kind)); !status.ok()) return status.fault();
  }
  file.header_ = header.value();
  file.times_ = times.value();
  file.nodes_ = nodes.value();
  file.columns_ = columns.value();
  const Header& h = *file.header_;
  if (const char* what = checkHeader(h)) return reader.fault(kHeader, what);
  if (Status s = page_layout::checkTimes(file.times_, h.frames, path); !s.ok()) return s.fault();
  if (Status s = mesh_sections::checkCount(reader, kNodes, file.nodes_, h.nodes, "nodes"); !s.ok()) return s.fault();
  if (Status s = mesh_sections::checkCount(reader, kColumns, file.columns_, h.columns, "columns"); !s.ok())
    return s.fault();
  if (const char* what = checkColumns(file.columns_)) return reader.fault(kColumns, what);
  auto pages = paged::Pages::open(reader);
  if (!pages.ok()) return pages.fault();
  file.pages_ = pages.value();
  if (Status s = checkPages(reader, file.pages_.entries(), file.columns_); !s.ok()) return s.fault();
  if (file.patches() != h.patches) {
    return reader.fault(paged::kPageTable, "has " + std::to_string(file.patches()) + " patches, the header says " +
                                               std::to_string(h.patches));
  }
  Sums sums;
  const auto fault = [&](std::uint32_t kind, std::string what) { return reader.fault(kind, std::move(what)); };
  if (Status s = checkGraph(file.nodes_, file.pages_.entries(), file.stride(), sums, fault); !s.ok()) return s.fault();
  if (sums.vertices != h.vertices || sums.tets != h.tets || sums.leaf_tets != h.leaf_tets)
    return reader.fault(kHeader, "its counts are not the sums over the patches");
  return file;
}

Result<LoadedPatch> File::loadPatch(std::size_t p) const {
  auto bytes = pages_.load(p * stride());
  if (!bytes.ok()) return bytes.fault();
  auto view = validatePage(bytes.value().bytes(), patchEntry(p), reader_->path(), p * stride());
  if (!view.ok()) return view.fault();
  return LoadedPatch{std::move(bytes).value(), view.value()};
}

Result<paged::PageBytes> File::loadColumn(std::size_t c, std::size_t p) const {
  return pages_.load(p * stride() + 1 + c);
}

Result<std::uint64_t> File::contentDigest() const {
  auto pages = pages_.contentDigest();
  if (!pages.ok()) return pages.fault();
  const std::array digests{container::xxh3(std::as_bytes(std::span(header_, 1))),
                           container::xxh3(std::as_bytes(times_)), container::xxh3(std::as_bytes(nodes_)),
                           container::xxh3(std::as_bytes(columns_)), pages.value()};
  return container::xxh3(std::as_bytes(std::span(digests)));
}

Status File::verify() const {
  if (Status status = reader_->verifyAll(); !status.ok()) return status;
  if (Status status = pages_.verifyPadding(); !status.ok()) return status;
  Bounds4f all;
  for (std::size_t p = 0; p < patches(); ++p) {
    auto patch = loadPatch(p);
    if (!patch.ok()) return patch.fault();
    Bounds4f box;
    for (const Vec4f& v : patch.value().view.vertices) box.add(v);
    if (box.min != patchEntry(p).bounds.min || box.max != patchEntry(p).bounds.max) {
      return Fault{FaultCode::kBadInput, reader_->path(), "page " + std::to_string(p * stride()),
                   "its bounds are not the box of its vertices", "write the file again"};
    }
    all.add(box);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      auto column = loadColumn(c, p);
      if (!column.ok()) return column.fault();
      const std::uint64_t used = patchEntry(p).counts[0] * columns_[c].components * sizeof(float);
      Status zero = mesh_sections::checkColumnPadding(*reader_, column.value().bytes(), used, p * stride() + 1 + c);
      if (!zero.ok()) return zero;
    }
  }
  if (const Bounds4f box = page_layout::stored(all); box.min != header_->bounds.min || box.max != header_->bounds.max)
    return reader_->fault(kHeader, "its bounds are not the box of the vertices");
  return {};
}

Result<Writer> Writer::create(const std::string& path, const Header& header, std::span<const double> times,
                              std::span<const NodeEntry> nodes, std::span<const Column> columns, paged::Codec codec,
                              bool force) {
  Header checked = header;
  checked.bounds = page_layout::stored({});
  if (const char* what = checkHeader(checked)) return Fault{FaultCode::kUsage, path, "section AHDR", what, ""};
  if (Status s = page_layout::checkTimes(times, times.size(), path); !s.ok()) return s.fault();
  std::vector<ColumnEntry> entries = columnEntries(columns);
  if (const char* what = checkColumns(entries)) return Fault{FaultCode::kUsage, path, "section COLS", what, ""};
  auto file = container::Writer::create(path, kPayload, kVersion, force);
  if (!file.ok()) return file.fault();
  Writer writer;
  writer.file_ = std::make_unique<container::Writer>(std::move(file).value());
  writer.pages_ = std::make_unique<paged::PageWriter>(*writer.file_, codec);
  writer.header_ = checked;
  writer.header_.frames = times.size();
  writer.header_.columns = static_cast<std::uint32_t>(columns.size());
  writer.header_.nodes = nodes.size();
  writer.header_.vertices = writer.header_.tets = writer.header_.patches = writer.header_.leaf_tets = 0;
  writer.times_.assign(times.begin(), times.end());
  writer.nodes_.assign(nodes.begin(), nodes.end());
  for (NodeEntry& node : writer.nodes_) {
    node.first_patch = node.patches = 0;
    node.bounds = page_layout::stored(node.bounds);
  }
  writer.columns_ = std::move(entries);
  if (Status status = writer.pages_->begin(); !status.ok()) return status.fault();
  return writer;
}

Status Writer::addPatch(const Patch& patch) {
  const auto bad = [&](const char* what) {
    return Fault{FaultCode::kUsage, file_->path(), "page " + std::to_string(pages_->entries().size()), what, ""};
  };
  if (patch.from < from_ || patch.from >= patch.to || patch.to >= nodes_.size())
    return bad("leads from no node to a later one, or comes out of order");
  if (patch.vertices.empty() || patch.vertices.size() > kMostVertices || patch.tets.empty())
    return bad("has no vertex or tetrahedron, or more vertices than 65535");
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (patch.columns.size() != columns_.size() ||
        patch.columns[c].size() != patch.vertices.size() * columns_[c].components) {
      return bad("the columns do not fit the vertices");
    }
  }
  from_ = patch.from;
  PatchHeader head{};
  head.vertices = patch.vertices.size();
  head.tets = patch.tets.size();
  head.shared = patch.shared;
  head.from = patch.from;
  head.to = patch.to;
  paged::PageEntry entry{};
  for (const Vec4f& v : patch.vertices) entry.bounds.add(v);
  entry.counts[0] = head.vertices;
  entry.counts[1] = head.tets;
  entry.counts[2] = head.from;
  entry.counts[3] = head.to;
  entry.error_estimated = nodes_[patch.to].error_estimated;
  entry.error_measured = nodes_[patch.to].error_measured;
  bounds_.add(entry.bounds);
  ++nodes_[patch.from].patches;
  ++header_.patches;
  header_.vertices += head.vertices;
  header_.tets += head.tets;
  header_.leaf_tets += patch.to + 1 == nodes_.size() ? head.tets : 0;
  const std::array parts{std::as_bytes(std::span(&head, 1)), std::as_bytes(patch.vertices), std::as_bytes(patch.tets)};
  if (Status status = pages_->addParts(parts, entry); !status.ok()) return status;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto values = std::as_bytes(patch.columns[c]);
    entry.kind = static_cast<std::uint32_t>(1 + c);
    if (Status status = pages_->addParts({&values, 1}, entry); !status.ok()) return status;
  }
  return {};
}

Status Writer::close(const std::string& provenance_json) {
  std::uint64_t first = 0;
  for (NodeEntry& node : nodes_) {
    node.first_patch = first;
    first += node.patches;
  }
  Sums sums;
  const auto fault = [&](std::uint32_t kind, std::string what) {
    return Fault{FaultCode::kUsage, file_->path(), "section " + container::fourCcText(kind), std::move(what), ""};
  };
  if (Status s = checkGraph(nodes_, pages_->entries(), 1 + columns_.size(), sums, fault); !s.ok()) return s;
  if (Status status = pages_->end(); !status.ok()) return status;
  header_.bounds = page_layout::stored(bounds_);
  if (Status s = file_->add<Header>(kHeader, container::kSectionRequired, {&header_, 1}); !s.ok()) return s;
  if (Status s = file_->add<double>(kTimes, container::kSectionRequired, times_); !s.ok()) return s;
  if (Status s = file_->add<NodeEntry>(kNodes, container::kSectionRequired, nodes_); !s.ok()) return s;
  if (!columns_.empty()) {
    if (Status s = file_->add<ColumnEntry>(kColumns, container::kSectionRequired, columns_); !s.ok()) return s;
  }
  if (Status s = file_->add<char>(container::kProvenance, 0, provenance_json); !s.ok()) return s;
  return file_->close();
}

}  // namespace tet4d::patch_dag
