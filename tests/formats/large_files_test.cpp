// Offsets above 4 GiB and numbers above 2^32, in sparse files that take no room and no time.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <type_traits>

#include "formats/page_layout.h"
#include "tests/formats/support/samples.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::test {
namespace {

// Counts and offsets are 64-bit wherever a file may outgrow 32.
static_assert(std::is_same_v<decltype(container::SectionEntry::offset), std::uint64_t>);
static_assert(std::is_same_v<decltype(container::SectionEntry::item_count), std::uint64_t>);
static_assert(std::is_same_v<decltype(paged::PageEntry::offset), std::uint64_t>);
static_assert(std::is_same_v<std::remove_extent_t<decltype(paged::PageEntry::counts)>, std::uint64_t>);
static_assert(std::is_same_v<decltype(hypermesh::MeshHeader::vertices), std::uint64_t>);
static_assert(std::is_same_v<decltype(hypermesh::MeshHeader::tets), std::uint64_t>);
static_assert(std::is_same_v<decltype(hypermesh::Run::first), std::uint64_t>);
static_assert(std::is_same_v<decltype(hypermesh::Run::count), std::uint64_t>);
static_assert(std::is_same_v<decltype(std::declval<hypermesh::PageView>().globalOf(0)), std::uint64_t>);
static_assert(std::is_same_v<decltype(dyntri::Header::triangles), std::uint64_t>);
static_assert(std::is_same_v<std::remove_extent_t<decltype(grid4::GridHeader::dims)>, std::uint64_t>);

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

// Writes parts of a file at their places; what lies between is a hole.
class SparseFile {
 public:
  explicit SparseFile(const std::string& path)
      : fd_(::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) {}
  ~SparseFile() { ::close(fd_); }
  SparseFile(const SparseFile&) = delete;
  SparseFile& operator=(const SparseFile&) = delete;

  bool put(std::uint64_t offset, std::span<const std::byte> bytes) {
    return ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset)) == static_cast<ssize_t>(bytes.size());
  }
  bool resize(std::uint64_t bytes) { return ::ftruncate(fd_, static_cast<off_t>(bytes)) == 0; }

 private:
  int fd_;
};

struct Part {
  std::uint32_t kind;
  std::uint32_t item_bytes;
  std::span<const std::byte> content;
};

// Header and table behind `end`, where the page section ends; the file's other sections after that.
bool finish(SparseFile& file, std::uint32_t payload, std::uint64_t end, std::span<const Part> parts) {
  std::vector<container::SectionEntry> table(1);
  table[0].kind = paged::kPages;
  table[0].flags = container::kSectionRequired | container::kSectionPaged;
  table[0].offset = container::kPageAlignment;
  table[0].bytes = table[0].item_count = end - table[0].offset;
  table[0].item_bytes = 1;
  std::uint64_t at = (end + 63) / 64 * 64;
  for (const Part& part : parts) {
    container::SectionEntry entry{};
    entry.kind = part.kind;
    entry.flags = container::kSectionRequired;
    entry.offset = at;
    entry.bytes = part.content.size();
    entry.item_bytes = part.item_bytes;
    entry.item_count = part.content.size() / part.item_bytes;
    entry.xxh3 = container::xxh3(part.content);
    table.push_back(entry);
    if (!file.put(at, part.content)) return false;
    at = (at + part.content.size() + 63) / 64 * 64;
  }
  const auto table_bytes = std::as_bytes(std::span(table));
  container::FileHeader header{};
  std::memcpy(header.magic, "T4D\r\n\x1a\n\0", 8);
  header.endian_mark = 0x01020304;
  header.container_version = header.payload_version = 1;
  header.payload = payload;
  header.section_count = static_cast<std::uint32_t>(table.size());
  header.table_offset = at;
  header.file_bytes = at + table_bytes.size();
  header.table_xxh3 = container::xxh3(table_bytes);
  const auto header_bytes = std::as_bytes(std::span(&header, 1));
  header.header_xxh3 = container::xxh3(header_bytes.first(56));
  return file.put(at, table_bytes) && file.put(0, header_bytes);
}

TEST(LargeFiles, GridBeyondFourGiB) {
  Scratch scratch;
  const std::string path = scratch.path("g.t4g");
  SparseFile file(path);
  grid4::GridHeader header{};
  header.dims[0] = header.dims[1] = header.dims[2] = 2;
  header.frames = 7;
  header.sample_type = 1;
  const std::vector<double> times{0, 1, 2, 3, 4, 5, 6};
  std::vector<paged::PageEntry> entries(7);
  for (std::size_t k = 0; k < 7; ++k) {
    std::vector<std::byte> samples(8, static_cast<std::byte>(k + 1));
    entries[k].offset = k * kGiB + container::kPageAlignment;
    entries[k].bytes = entries[k].raw_bytes = 8;
    entries[k].xxh3 = container::xxh3(samples);
    entries[k].counts[0] = k;
    entries[k].counts[1] = 8;
    entries[k].bounds = {{0, 0, 0, static_cast<float>(k)}, {1, 1, 1, static_cast<float>(k)}};
    if (!file.put(entries[k].offset, samples)) GTEST_SKIP() << "no sparse files here: " << std::strerror(errno);
  }
  const std::array<Part, 3> parts{{{grid4::kHeader, 192, std::as_bytes(std::span(&header, 1))},
                                   {grid4::kTimes, 8, std::as_bytes(std::span(times))},
                                   {paged::kPageTable, 128, std::as_bytes(std::span(entries))}}};
  ASSERT_TRUE(finish(file, grid4::kPayload, entries[6].offset + 8, parts));
  auto grid = grid4::File::open(path);
  ASSERT_TRUE(grid.ok()) << grid.fault().place << ": " << grid.fault().what;
  EXPECT_GT(grid.value().reader().header().file_bytes, 6 * kGiB);
  auto last = grid.value().loadFrame(6);
  ASSERT_TRUE(last.ok()) << last.fault().what;
  EXPECT_EQ(last.value().bytes()[7], std::byte{7});
}

// Two pages of 2^31 vertices each stand as holes; the pages behind them are real and their vertices are numbered beyond
// 2^32.
TEST(LargeFiles, HypermeshWithVerticesBeyondTwoToThe32) {
  Scratch scratch;
  const std::string path = scratch.path("m.t4h");
  SparseFile file(path);
  constexpr std::uint64_t kMany = (std::uint64_t{1} << 31) + 5;
  const std::array<Vec4f, 3> third{{{0, 0, 0, 3}, {1, 0, 0, 3}, {0, 1, 0, 3}}};
  const std::array<Vec4f, 1> fourth{{{0, 0, 1, 4}}};
  std::vector<paged::PageEntry> entries(4);
  std::uint64_t at = container::kPageAlignment, vertices = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    entries[k].offset = at;
    entries[k].bytes = entries[k].raw_bytes = 64 + page_layout::padded(kMany * sizeof(Vec4f));
    entries[k].counts[0] = vertices;
    entries[k].counts[1] = kMany;
    entries[k].bounds = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    vertices += kMany;
    at = (at + entries[k].bytes + 4095) / 4096 * 4096;
  }
  const hypermesh::Run run{vertices, 3};
  const hypermesh::Tet tet{0, 1, 2, 3};
  for (std::size_t k = 2; k < 4; ++k) {
    const std::span<const Vec4f> own = k == 2 ? std::span<const Vec4f>(third) : std::span<const Vec4f>(fourth);
    hypermesh::PageHeader head{vertices, own.size(), k - 2, k - 2, (k - 2) * 3, 0, {}};
    page_layout::Builder builder;
    builder.add<hypermesh::PageHeader>({&head, 1});
    builder.add(own);
    builder.add(std::span(&run, k - 2));
    builder.add(std::span(&tet, k - 2));
    entries[k].offset = at;
    entries[k].bytes = entries[k].raw_bytes = builder.bytes().size();
    entries[k].xxh3 = container::xxh3(builder.bytes());
    entries[k].counts[0] = vertices;
    entries[k].counts[1] = own.size();
    entries[k].counts[2] = k - 2;
    entries[k].counts[3] = (k - 2) * 3;
    entries[k].bounds = {{0, 0, 0, 3}, {1, 1, 1, 4}};
    if (!file.put(at, builder.bytes())) GTEST_SKIP() << "no sparse files here: " << std::strerror(errno);
    vertices += own.size();
    at += container::kPageAlignment;
  }
  hypermesh::MeshHeader header{};
  header.vertices = vertices;
  header.tets = 1;
  header.frames = 5;
  header.domain = {{0, 0, 0, 0}, {1, 1, 1, 4}};
  header.bounds = header.domain;
  const std::vector<double> times{0, 1, 2, 3, 4};
  const std::array<Part, 3> parts{{{hypermesh::kHeader, 256, std::as_bytes(std::span(&header, 1))},
                                   {hypermesh::kTimes, 8, std::as_bytes(std::span(times))},
                                   {paged::kPageTable, 128, std::as_bytes(std::span(entries))}}};
  ASSERT_TRUE(finish(file, hypermesh::kPayload, entries[3].offset + entries[3].bytes, parts));

  auto mesh = hypermesh::File::open(path);
  ASSERT_TRUE(mesh.ok()) << mesh.fault().place << ": " << mesh.fault().what;
  EXPECT_GT(mesh.value().header().vertices, std::uint64_t{1} << 32);
  auto page = mesh.value().gather(3);
  ASSERT_TRUE(page.ok()) << page.fault().place << ": " << page.fault().what;
  EXPECT_EQ(page.value().view.globalOf(0), 2 * kMany + 3);
  EXPECT_EQ(page.value().view.globalOf(3), 2 * kMany + 2);
  EXPECT_EQ(page.value().positions[2], third[1]);
}

// A patch of more than 2^32 tetrahedra stands as a hole; the one behind it is real, and the sums count both.
TEST(LargeFiles, PatchDagOfMoreThanTwoToThe32Tetrahedra) {
  Scratch scratch;
  const std::string path = scratch.path("d.t4p");
  SparseFile file(path);
  constexpr std::uint64_t kMany = (std::uint64_t{1} << 32) + 5;
  const std::array<Vec4f, 4> vertices{{{0, 0, 0, 0}, {1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}};
  const patch_dag::LocalTet tet{0, 1, 2, 3};
  patch_dag::PatchHeader head{};
  head.vertices = 4, head.tets = 1, head.to = 1;
  page_layout::Builder builder;
  builder.add<patch_dag::PatchHeader>({&head, 1});
  builder.add(std::span<const Vec4f>(vertices));
  builder.add(std::span(&tet, 1));
  std::vector<paged::PageEntry> entries(2);
  entries[0].offset = container::kPageAlignment;
  entries[0].bytes = entries[0].raw_bytes = 128 + page_layout::padded(kMany * sizeof(patch_dag::LocalTet));
  entries[1].offset = (entries[0].offset + entries[0].bytes + 4095) / 4096 * 4096;
  entries[1].bytes = entries[1].raw_bytes = builder.bytes().size();
  entries[1].xxh3 = container::xxh3(builder.bytes());
  for (std::uint64_t p = 0; p < 2; ++p) {
    entries[p].counts[0] = 4;
    entries[p].counts[1] = p == 0 ? kMany : 1;
    entries[p].counts[3] = 1;
    entries[p].bounds = {{0, 0, 0, 0}, {1, 1, 1, 1}};
  }
  if (!file.put(entries[1].offset, builder.bytes())) GTEST_SKIP() << "no sparse files here: " << std::strerror(errno);
  patch_dag::Header header{};
  header.vertices = 8, header.tets = header.leaf_tets = kMany + 1, header.frames = 2;
  header.domain = header.bounds = {{0, 0, 0, 0}, {1, 1, 1, 1}};
  header.nodes = header.patches = 2;
  header.time_scale = 1;
  std::array<patch_dag::NodeEntry, 2> nodes{};
  nodes[0].patches = 2, nodes[0].level = 1, nodes[0].error_measured = -1, nodes[0].bounds = header.domain;
  nodes[1].first_patch = 2;
  nodes[1].bounds = page_layout::stored({});
  const std::vector<double> times{0, 1};
  const std::array<Part, 4> parts{{{patch_dag::kHeader, 256, std::as_bytes(std::span(&header, 1))},
                                   {patch_dag::kTimes, 8, std::as_bytes(std::span(times))},
                                   {patch_dag::kNodes, 64, std::as_bytes(std::span(nodes))},
                                   {paged::kPageTable, 128, std::as_bytes(std::span(entries))}}};
  ASSERT_TRUE(finish(file, patch_dag::kPayload, entries[1].offset + entries[1].bytes, parts));
  auto dag = patch_dag::File::open(path);
  ASSERT_TRUE(dag.ok()) << dag.fault().place << ": " << dag.fault().what;
  EXPECT_GT(dag.value().header().leaf_tets, std::uint64_t{1} << 32);
  auto patch = dag.value().loadPatch(1);
  ASSERT_TRUE(patch.ok()) << patch.fault().place << ": " << patch.fault().what;
  EXPECT_EQ(patch.value().view.vertices[3], vertices[3]);
}

}  // namespace
}  // namespace tet4d::test
