// tet4d-info: what a file holds, and whether it holds what it promises.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <type_traits>

#include "libpreprocess/error.h"
#include "libpreprocess/topology/check_hypermesh.h"
#include "libpreprocess/topology/check_patch_dag.h"
#include "libpreprocess/topology/links.h"
#include "tools/common/cli.h"
#include "tools/common/exit_codes.h"
#include "tools/info/describe.h"

namespace {

using namespace tet4d;
using nlohmann::ordered_json;

struct Options {
  std::string file;
  bool json = false, validate = false, links = false;
};

std::string faultText(const Fault& fault) { return fault.place.empty() ? fault.what : fault.place + ": " + fault.what; }

void addFaults(ordered_json& out, const std::vector<std::string>& faults) {
  for (const std::string& fault : faults) out["faults"].push_back(fault);
}

// The mesh as a manifold: every inner triangle in exactly two tetrahedra, wound oppositely in them.
void checkFaces(const hypermesh::File& file, ordered_json& out, cli::Session& session) {
  const topology::HypermeshCheck check = topology::checkHypermesh(file, session.progress(), &session.memory());
  out["faces"] = {{"inner", check.inner_faces},
                  {"wall", check.wall_faces},
                  {"inner_boundary", check.inner_boundary_faces},
                  {"over_two", check.faces_over_two},
                  {"misoriented", check.misoriented_faces},
                  {"degenerate_tets", check.degenerate_tets},
                  {"flat_time_tets", check.flat_time_tets},
                  {"unused_vertices", check.unused_vertices}};
  addFaults(out, check.faults);
}

void checkLinks(const hypermesh::File& file, ordered_json& out, cli::Session& session) {
  const topology::LinkCheck check = topology::checkLinks(file, session.memory(), session.progress());
  out["links"] = {{"sphere_vertices", check.sphere_links},    {"disc_vertices", check.disc_links},
                  {"faulty_vertices", check.faulty_vertices}, {"cycle_edges", check.cycle_edges},
                  {"path_edges", check.path_edges},           {"faulty_edges", check.faulty_edges},
                  {"largest_star", check.largest_star}};
  addFaults(out, check.faults);
}

// Every cut as a closed mesh.
void checkCuts(const patch_dag::File& file, ordered_json& out, cli::Session& session) {
  const topology::PatchDagCheck check = topology::checkPatchDag(file, session.memory(), session.progress());
  out["cuts"] = {{"nodes", check.nodes},
                 {"cracked_nodes", check.cracked_nodes},
                 {"crack_faces", check.crack_faces},
                 {"open_faces", check.open_faces}};
  addFaults(out, check.faults);
}

// What proving one page after the other may hold at once: a page decoded, and of a hypermesh the positions gathered for
// it, its own vertices and those of earlier pages.
template <class File>
std::uint64_t largestPage(const File& file) {
  std::uint64_t most = 0;
  for (const paged::PageEntry& entry : file.pages().entries()) {
    const bool decoded = entry.codec != static_cast<std::uint32_t>(paged::Codec::kRaw);
    most = std::max(most, decoded ? entry.raw_bytes : 0);
  }
  if constexpr (std::is_same_v<File, hypermesh::File>) {
    for (std::size_t k = 0; k < file.geometryPages(); ++k) most = std::max(most, file.gatherBytes(k));
  }
  return most;
}

// Structure first; what stands on a damaged file is not worth checking.
void validate(const info::AnyFile& any, const Options& options, ordered_json& out, cli::Session& session) {
  session.progress().phase("verify", 1);
  const Status status = std::visit(
      [&](const auto& file) {
        const auto held =
            session.memory().reserve(largestPage(file), "the largest page, decoded and with its neighbours' vertices,");
        return file.verify();
      },
      any);
  session.progress().step(1);
  if (!status.ok()) {
    if (status.fault().code != FaultCode::kBadInput) throw Error(status.fault());
    out["faults"].push_back(faultText(status.fault()));
    return;
  }
  if (!out["provenance"].is_object()) out["faults"].push_back("section PROV: is not a JSON object");
  if (const auto* mesh = std::get_if<hypermesh::File>(&any)) {
    checkFaces(*mesh, out, session);
    if (options.links) checkLinks(*mesh, out, session);
  }
  if (const auto* dag = std::get_if<patch_dag::File>(&any)) checkCuts(*dag, out, session);
}

int body(const Options& options, cli::Session& session) {
  const bool wants_validation = options.validate || options.links;
  const Result<info::AnyFile> file = info::open(options.file);
  ordered_json out = ordered_json::object();
  if (file.ok()) {
    out = info::describe(file.value());
    for (const auto& [name, value] : out["counts"].items()) session.stats().count(name, value.get<std::uint64_t>());
  } else if (!wants_validation || file.fault().code != FaultCode::kBadInput) {
    throw Error(file.fault());
  } else {
    out = {{"payload", nullptr}, {"version", nullptr}, {"counts", ordered_json::object()}};
  }
  bool valid = true;
  if (wants_validation) {
    out["valid"] = false;
    out["faults"] = ordered_json::array();
    if (file.ok()) {
      validate(file.value(), options, out, session);
    } else {
      out["faults"].push_back(faultText(file.fault()));
    }
    out["valid"] = valid = out["faults"].empty();
  }
  session.stopProgress();
  const std::string text =
      options.json ? out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n" : info::textOf(out);
  std::fputs(text.c_str(), stdout);
  if (valid) return cli::kExitDone;
  const std::size_t count = out["faults"].size();
  session.warn(options.file + ": " + (count == 1 ? "a fault was" : std::to_string(count) + " faults were") + " found");
  return cli::kExitFaultsFound;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  cli::Command command("tet4d-info", "Tells what a tet4d file holds and proves that it is sound.");
  command.example("tet4d-info drop.t4h", "payload, counts, bounds, sections, and how the file was made")
      .example("tet4d-info --json drop.t4h", "the same for scripts")
      .example("tet4d-info --validate drop.t4h && echo sound",
               "checksums, indices, every inner triangle in two tetrahedra")
      .positional("FILE",
                  "a grid4 (.t4g), hypermesh (.t4h), dynamic triangles (.t4d), surface sequence (.t4q) or patch DAG "
                  "(.t4p) file",
                  &options.file)
      .flag("--json", "print JSON", &options.json)
      .flag("--validate",
            "prove structure, checksums, indices, of a hypermesh faces and orientation, of a patch DAG that every cut "
            "is closed; "
            "exit 5 on faults",
            &options.validate)
      .flag("--links", "validate, and check that every vertex and edge link is that of a manifold", &options.links)
      .common({cli::kMemory, cli::kStats})
      .note("Exit: 0 sound, 1 failure, 2 usage, 3 bad input, 4 out of memory or disk, 5 faults found.");
  return cli::run(argc, argv, command, [&](cli::Session& session) { return body(options, session); });
}
