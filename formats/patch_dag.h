// patch_dag (.t4p): a hypermesh at every resolution. Ponchio & Hormann 2008, sec. 6.
//
// Nodes are cells that were simplified; arcs are patches, pieces of mesh. A patch was left by its lower node `to` and
// is replaced with finer ones when that node is refined; its upper node `from` is the coarser cell it was merged into,
// and creates it when refined. Node 0, the source, is always refined; the last node, the sink, never: patches that end
// there are the finest. A set of refined nodes that holds with each node all those above it is legal; its cut, the
// patches from refined nodes to others, covers space-time once and is closed where the input is. Arcs go from smaller
// node numbers to larger ones; errors do not grow along them and bounds lie within each other, so that "refined where
// error(bounds) > limit" is legal for every measure of error that grows with both.
//
// A patch is a mesh of its own, with u16 local indices. A vertex on the border of patches is stored in each of them
// with the same bits, on every level; such vertices come first. A geometry page's bytes: PatchHeader (64 B) | vertices
// Vec4f[vertices] | tets u16[4][tets], each part padded with zeros to 64 bytes. entry.counts = {vertices, tets, from,
// to}; patches stand in the order of their upper nodes. Column pages follow as in a hypermesh. Sections: AHDR,
// TIME, NODE, COLS (optional), PAGE/PTAB. docs/formats/patch_dag.md.
//
// Orientation, slices, coordinates and time: as in a hypermesh.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/columns.h"
#include "formats/core/coordinates.h"
#include "formats/paged.h"

namespace tet4d::patch_dag {

inline constexpr std::uint32_t kPayload = container::fourCc("PDAG");
inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::uint32_t kHeader = container::fourCc("AHDR");
inline constexpr std::uint32_t kTimes = container::fourCc("TIME");
inline constexpr std::uint32_t kNodes = container::fourCc("NODE");
inline constexpr std::uint32_t kColumns = container::fourCc("COLS");

// Local indices are u16, and 0xffff stays free for those who mark what is dead.
inline constexpr std::uint64_t kMostVertices = 65535;

// Flags of the header: those of a hypermesh (hypermesh::kOnGrid, kInnerBoundary) with the same meaning.
inline constexpr std::uint32_t kOnGrid = 1u << 0;
inline constexpr std::uint32_t kInnerBoundary = 1u << 1;

struct Header {
  std::uint64_t vertices;     // @0   sum over the patches, copies counted
  std::uint64_t tets;         // @8   sum over the patches
  std::uint64_t frames;       // @16  entries of TIME
  std::uint32_t flags;        // @24  kOnGrid …
  std::uint32_t columns;      // @28  entries of COLS
  AffineMap index_to_world;   // @32
  Bounds4f domain;            // @128 as a hypermesh's
  Bounds4f bounds;            // @160 of all patches; all zero if there are none
  double isovalue;            // @192 NaN if there is none
  std::uint64_t nodes;        // @200 entries of NODE
  std::uint64_t patches;      // @208
  std::uint64_t leaf_tets;    // @216 sum over the patches that end in the sink
  double time_scale;          // @224 cells that a frame counts as where distances in space-time are measured
  std::uint64_t reserved[3];  // @232 zero
};
static_assert(sizeof(Header) == 256 && offsetof(Header, isovalue) == 192 && offsetof(Header, time_scale) == 224);

// Flags of a node.
inline constexpr std::uint32_t kStuck = 1u << 0;  // its simplification left more than nine of ten tetrahedra

struct NodeEntry {
  std::uint64_t first_patch;  // @0  the patches from this node are first_patch … first_patch + patches - 1
  std::uint64_t patches;      // @8  none of the sink
  std::uint32_t level;        // @16 of the sequence of partitions: the sink 0; smaller along every arc
  std::uint32_t flags;        // @20 kStuck
  float error_estimated;      // @24 world units: of the patches that end here, to the finest mesh; the sink's is 0
  float error_measured;       // @28 the same by a pass of its own, or -1 in every node but the sink
  Bounds4f bounds;  // @32 holds its patches, those that end here, and the bounds of all nodes below; the sink's
                    //     are all zero
};
static_assert(sizeof(NodeEntry) == 64 && offsetof(NodeEntry, bounds) == 32);

struct PatchHeader {
  std::uint64_t vertices;  // @0  1 .. kMostVertices
  std::uint64_t tets;      // @8  at least 1
  std::uint64_t shared;    // @16 vertices 0 .. shared - 1 may stand in other patches of a cut too; the others in none
  std::uint64_t from;      // @24 upper node
  std::uint64_t to;        // @32 lower node
  std::uint64_t reserved[3];  // @40 zero
};
static_assert(sizeof(PatchHeader) == 64);

using LocalTet = std::array<std::uint16_t, 4>;
static_assert(sizeof(LocalTet) == 8);

// One patch, as spans over its bytes. Valid while the bytes are.
struct PatchView {
  const PatchHeader* header = nullptr;
  std::span<const Vec4f> vertices;
  std::span<const LocalTet> tets;
};

// Spans over a page's bytes, proved: sizes, counts against `entry`, zero padding, finite vertices within the entry's
// bounds, every index in range, no tetrahedron with a vertex twice. O(page).
Result<PatchView> validatePage(std::span<const std::byte> bytes, const paged::PageEntry& entry, const std::string& file,
                               std::size_t page);

struct LoadedPatch {
  paged::PageBytes bytes;  // keeps the view alive
  PatchView view;
};

class File {
 public:
  // Proves header, times, columns, the page table and all that is promised of the graph: arcs go downwards, every node
  // but the ends has arcs in and out, errors and bounds are nested. O(nodes + patches).
  static Result<File> open(const std::string& path);
  const container::Reader& reader() const { return *reader_; }
  const Header& header() const { return *header_; }
  std::span<const double> times() const { return times_; }
  std::span<const NodeEntry> nodes() const { return nodes_; }
  std::span<const ColumnEntry> columns() const { return columns_; }
  const paged::Pages& pages() const { return pages_; }
  std::uint64_t sink() const { return nodes_.size() - 1; }
  std::size_t patches() const { return pages_.size() / stride(); }
  // Geometry page of patch p; its columns' pages follow.
  const paged::PageEntry& patchEntry(std::size_t p) const { return pages_.entries()[p * stride()]; }
  std::uint64_t fromOf(std::size_t p) const { return patchEntry(p).counts[2]; }
  std::uint64_t toOf(std::size_t p) const { return patchEntry(p).counts[3]; }
  // Loads and proves patch p. O(patch). Thread-safe.
  Result<LoadedPatch> loadPatch(std::size_t p) const;
  // Column c of patch p: components * vertices floats.
  Result<paged::PageBytes> loadColumn(std::size_t c, std::size_t p) const;
  // A digest of what the file says, the same for every codec and layout.
  Result<std::uint64_t> contentDigest() const;
  // Sections, padding, all pages and indices, exact bounds. O(file), memory of one page. That cuts are closed:
  // topology/check_patch_dag.h.
  Status verify() const;

 private:
  std::size_t stride() const { return 1 + columns_.size(); }
  std::unique_ptr<container::Reader> reader_;
  const Header* header_ = nullptr;
  std::span<const double> times_;
  std::span<const NodeEntry> nodes_;
  std::span<const ColumnEntry> columns_;
  paged::Pages pages_;
};

// A patch as it is written.
struct Patch {
  std::uint64_t from = 0, to = 0;
  std::uint64_t shared = 0;
  std::span<const Vec4f> vertices;
  std::span<const LocalTet> tets;
  std::span<const std::span<const float>> columns;  // one a declared column, components * vertices floats
};

// Streams a DAG patch by patch, in the order of their upper nodes.
class Writer {
 public:
  // header: flags, index_to_world, domain, isovalue, time_scale. nodes: level, flags, errors and bounds; which patches
  // are theirs is filled in, as are the header's counts. No nodes but source and sink: a mesh without tetrahedra, or
  // one that is its own coarsest form.
  static Result<Writer> create(const std::string& path, const Header& header, std::span<const double> times,
                               std::span<const NodeEntry> nodes, std::span<const Column> columns, paged::Codec codec,
                               bool force);
  // Bounds are the vertices'; errors those of its lower node.
  Status addPatch(const Patch& patch);
  // Fault{kUsage} if what the file would say of its graph is not what open() asks for.
  Status close(const std::string& provenance_json);

 private:
  std::unique_ptr<container::Writer> file_;
  std::unique_ptr<paged::PageWriter> pages_;
  Header header_{};
  std::vector<double> times_;
  std::vector<NodeEntry> nodes_;
  std::vector<ColumnEntry> columns_;
  Bounds4f bounds_;
  std::uint64_t from_ = 0;  // of the last patch
};

}  // namespace tet4d::patch_dag
