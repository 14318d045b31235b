#include <cstring>
#include <limits>

#include "formats/patch_dag.h"
#include "tests/formats/support/bad_files.h"

namespace tet4d::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();

using patch_dag::Header, patch_dag::NodeEntry, patch_dag::PatchHeader, patch_dag::LocalTet;

// Offsets inside page 0 of dag.t4p: 8 vertices, 6 tetrahedra.
constexpr std::uint64_t kVertices = 64, kTets = 64 + 8 * 16;

// dag.t4p: page 0 from node 0 to 1, pages 1 and 2 from node 1 to node 2, the sink.
std::vector<BadFile> badHeaders() {
  const auto header = [](std::string name, std::string what, auto forge, std::string place = "section AHDR") {
    return BadFile{"dag_header_" + name + ".t4p", "dag.t4p", true, std::move(place), std::move(what), [=](Image& i) {
                     forge(i.item<Header>(patch_dag::kHeader));
                   }};
  };
  std::vector<BadFile> all{
      header("reserved", "reserved", [](Header& h) { h.reserved[2] = 1; }),
      header("flags", "flags", [](Header& h) { h.flags |= 8; }),
      header("map", "map", [](Header& h) { h.index_to_world.axes = {}; }),
      header("domain", "domain", [](Header& h) { std::swap(h.domain.min, h.domain.max); }),
      header("bounds", "bounds", [](Header& h) { h.bounds.min.x = kNan; }),
      header("isovalue", "isovalue", [](Header& h) { h.isovalue = -std::numeric_limits<double>::infinity(); }),
      header("time_scale", "time scale", [](Header& h) { h.time_scale = 0; }),
      header("time_scale_nan", "time scale", [](Header& h) { h.time_scale = kNan; }),
      header("vertices", "sums", [](Header& h) { h.vertices += std::uint64_t{1} << 32; }),
      header("tets", "sums", [](Header& h) { h.tets -= 1; }),
      header("leaf_tets", "sums", [](Header& h) { h.leaf_tets += 1; }),
      header(
          "columns", "the header says", [](Header& h) { h.columns = 1; }, "section COLS"),
      header(
          "nodes", "the header says", [](Header& h) { h.nodes = kHuge; }, "section NODE"),
      header(
          "patches", "the header says", [](Header& h) { h.patches = (std::uint64_t{1} << 32) + 3; }, "section PTAB"),
      header(
          "frames", "times for", [](Header& h) { h.frames = kHuge; }, "section TIME"),
  };
  all.push_back({"dag_header_box.t4p", "dag.t4p", false, "section AHDR", "box of the vertices",
                 [](Image& i) { i.item<Header>(patch_dag::kHeader).bounds.max.x += 1; }});
  all.push_back({"dag_column_same_name.t4p", "dag_columns.t4p", true, "section COLS", "same name",
                 [](Image& i) { std::strncpy(i.item<ColumnEntry>(patch_dag::kColumns, 1).name, "pressure", 56); }});
  all.push_back({"dag_column_size.t4p", "dag_columns.t4p", true, "section PTAB", "size",
                 [](Image& i) { i.item<ColumnEntry>(patch_dag::kColumns, 1).components = 1; }});
  all.push_back(
      {"dag_column_kind.t4p", "dag_columns.t4p", true, "section PTAB", "kind", [](Image& i) { i.page(2).kind = 1; }});
  all.push_back({"dag_column_padding.t4p", "dag_columns.t4p", false, "page 1", "padding",
                 [](Image& i) { i.inPage<char>(1, 8 * 4) = 1; }});
  all.push_back({"dag_column_page_missing.t4p", "dag_columns.t4p", true, "section PTAB", "missing", [](Image& i) {
                   i.sectionOf(paged::kPageTable).item_count -= 1;
                   i.sectionOf(paged::kPageTable).bytes -= 128;
                 }});
  return all;
}

std::vector<BadFile> badNodes() {
  const auto node = [](std::string name, std::size_t which, std::string what, auto forge,
                       std::string place = "section NODE") {
    return BadFile{"dag_node_" + name + ".t4p", "dag.t4p", true, std::move(place), std::move(what), [=](Image& i) {
                     forge(i.item<NodeEntry>(patch_dag::kNodes, which));
                   }};
  };
  std::vector<BadFile> all{
      node("flags", 1, "flags", [](NodeEntry& n) { n.flags = 2; }),
      node("error_nan", 1, "error", [](NodeEntry& n) { n.error_estimated = kNan; }),
      node("error_negative", 1, "error", [](NodeEntry& n) { n.error_estimated = -1; }),
      node(
          "error_grows", 1, "larger estimated", [](NodeEntry& n) { n.error_estimated = 0.5f; }, "section PTAB"),
      node(
          "error_other", 1, "errors of the node", [](NodeEntry& n) { n.error_estimated = 0.125f; }, "section PTAB"),
      node("measured_one", 1, "measured", [](NodeEntry& n) { n.error_measured = 0; }),
      node("measured_source", 0, "measured", [](NodeEntry& n) { n.error_measured = kInf; }),
      node("sink_error", 2, "sink", [](NodeEntry& n) { n.error_estimated = 1; }),
      node("sink_bounds", 2, "sink", [](NodeEntry& n) { n.bounds.max.x = 1; }),
      node("sink_level", 2, "sink", [](NodeEntry& n) { n.level = 1; }),
      node("level_0", 1, "sink's level", [](NodeEntry& n) { n.level = 0; }),
      node(
          "level_equal", 1, "smaller level", [](NodeEntry& n) { n.level = 2; }, "section PTAB"),
      node("bounds_nan", 1, "bounds", [](NodeEntry& n) { n.bounds.min.t = kNan; }),
      node(
          "bounds_apart", 1, "not within", [](NodeEntry& n) { n.bounds.max.z += 1; }, "section PTAB"),
      node(
          "bounds_small", 1, "node it ends in", [](NodeEntry& n) { n.bounds.max.t = 0.5f; }, "section PTAB"),
      node(
          "bounds_source", 0, "node it comes from", [](NodeEntry& n) { n.bounds.max.t = 0.5f; }, "section PTAB"),
      node("first", 1, "continue", [](NodeEntry& n) { n.first_patch = 0; }),
      node("patches_huge", 1, "continue", [](NodeEntry& n) { n.patches = kHuge; }),
      node("patches_few", 1, "continue", [](NodeEntry& n) { n.patches = 1; }),
      node("patches_none", 0, "no patches", [](NodeEntry& n) { n.patches = 0; }),
  };
  const auto arc = [&](std::string name, std::string place, std::string what, std::size_t page, auto forge) {
    all.push_back({"dag_arc_" + name + ".t4p", "dag.t4p", true, std::move(place), std::move(what),
                   [=](Image& i) { forge(i.page(page)); }});
  };
  using E = paged::PageEntry;
  arc("upwards", "section PTAB", "to a later one", 1, [](E& e) { e.counts[3] = 0; });
  arc("to_itself", "section PTAB", "to a later one", 1, [](E& e) { e.counts[3] = 1; });
  arc("beyond", "section PTAB", "to a later one", 1, [](E& e) { e.counts[3] = std::uint64_t{1} << 32; });
  arc("not_its_own", "section NODE", "another node", 1, [](E& e) { e.counts[2] = 0; });
  arc("unreached", "section NODE", "ends in it", 0, [](E& e) {
    e.counts[3] = 2;
    e.error_estimated = e.error_measured = 0;
  });
  arc("errors", "section PTAB", "errors of the node", 2, [](E& e) { e.error_measured = 1; });
  arc("vertices_none", "section PTAB", "no vertex", 0, [](E& e) { e.counts[0] = 0; });
  arc("vertices_many", "section PTAB", "no vertex", 0, [](E& e) { e.counts[0] = 65536; });
  arc("tets_huge", "section PTAB", "count beyond", 0, [](E& e) { e.counts[1] = kHuge / 4; });
  arc("kind", "section PTAB", "kind", 1, [](E& e) { e.kind = 1; });
  all.push_back({"dag_nodes_leave_patches.t4p", "dag.t4p", true, "section NODE", "come from no node", [](Image& i) {
                   i.item<NodeEntry>(patch_dag::kNodes, 1).patches = 1;
                   i.item<NodeEntry>(patch_dag::kNodes, 2).first_patch = 2;
                 }});
  all.push_back({"dag_nodes_one.t4p", "dag_empty.t4p", true, "section NODE", "no source and no sink", [](Image& i) {
                   i.sectionOf(patch_dag::kNodes).item_count = 1;
                   i.sectionOf(patch_dag::kNodes).bytes = 64;
                   i.item<Header>(patch_dag::kHeader).nodes = 1;
                 }});
  return all;
}

std::vector<BadFile> badPatches() {
  const auto page = [](std::string name, std::string what, auto forge) {
    return BadFile{"dag_page_" + name + ".t4p", "dag.t4p", false, "page 0", std::move(what), forge};
  };
  return {
      page("reserved", "reserved", [](Image& i) { i.inPage<PatchHeader>(0, 0).reserved[2] = 1; }),
      page("vertices", "counts differ", [](Image& i) { i.inPage<PatchHeader>(0, 0).vertices = 7; }),
      page("tets", "counts differ", [](Image& i) { i.inPage<PatchHeader>(0, 0).tets = kHuge; }),
      page("from", "counts differ", [](Image& i) { i.inPage<PatchHeader>(0, 0).from = 1; }),
      page("to", "counts differ", [](Image& i) { i.inPage<PatchHeader>(0, 0).to = 2; }),
      page("shared", "shares more", [](Image& i) { i.inPage<PatchHeader>(0, 0).shared = 9; }),
      page("size", "size or padding",
           [](Image& i) {
             i.inPage<PatchHeader>(0, 0).tets = i.page(0).counts[1] = 9;
             i.item<Header>(patch_dag::kHeader).tets += 3;
           }),
      page("padding", "size or padding", [](Image& i) { i.inPage<char>(0, kTets + 6 * 8) = 1; }),
      page("vertex_nan", "finite", [](Image& i) { i.inPage<Vec4f>(0, kVertices + 16).z = kNan; }),
      page("vertex_infinite", "finite", [](Image& i) { i.inPage<Vec4f>(0, kVertices).t = kInf; }),
      page("vertex_outside", "outside the page's bounds", [](Image& i) { i.inPage<Vec4f>(0, kVertices).x = 100; }),
      page("box", "box of its vertices", [](Image& i) { i.page(0).bounds.max.x = 1.5f; }),
      page("tet_range", "range", [](Image& i) { i.inPage<LocalTet>(0, kTets + 8)[2] = 8; }),
      page("tet_twice", "twice", [](Image& i) { i.inPage<LocalTet>(0, kTets)[0] = i.inPage<LocalTet>(0, kTets)[3]; }),
  };
}

}  // namespace

std::vector<BadFile> badDags() {
  std::vector<BadFile> all = badHeaders();
  for (auto part : {badNodes(), badPatches()}) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace tet4d::test
