// measure_hypermesh [--check] FILE.t4h: prints the measures of a hypermesh, and the face test's counts, as one JSON
// line.
//
// A program of the benchmarks (scripts/bench), not installed.
#include <cmath>
#include <cstdio>
#include <string>

#include "libpreprocess/error.h"
#include "libpreprocess/measure/hypermesh_measures.h"
#include "libpreprocess/topology/check_hypermesh.h"

namespace {

using namespace tet4d;

std::string number(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", *value);
  return text;
}

void print(const char* name, std::uint64_t value) {
  std::printf(", \"%s\": %llu", name, static_cast<unsigned long long>(value));
}

int run(const char* path, bool with_check) {
  const auto file = unwrap(hypermesh::File::open(path));
  outofcore::Progress progress;
  const measure::HypermeshMeasures m = measure::measureHypermesh(file, progress);
  std::printf("{\"volume3\": %s, \"volume4\": %s, \"volume4_world\": %s, \"swept_area\": %s, \"closure\": %s",
              number(m.volume3).c_str(), number(m.volume4).c_str(), number(m.volume4_world).c_str(),
              number(m.swept_area).c_str(), number(m.closure).c_str());
  print("tets", m.tets);
  print("vertices", file.header().vertices);
  print("frames", file.header().frames);
  print("active_cells", m.active_cells);
  if (with_check) {
    const topology::HypermeshCheck check = topology::checkHypermesh(file, progress);
    print("inner_faces", check.inner_faces);
    print("wall_faces", check.wall_faces);
    print("inner_boundary_faces", check.inner_boundary_faces);
    print("faces_over_two", check.faces_over_two);
    print("misoriented_faces", check.misoriented_faces);
    print("degenerate_tets", check.degenerate_tets);
    print("unused_vertices", check.unused_vertices);
    print("most_open_faces", check.most_open_faces);
    print("faults", check.faults.size());
  }
  std::printf("}\n");
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  const bool with_check = count == 3 && std::string(arguments[1]) == "--check";
  if (count != (with_check ? 3 : 2)) {
    std::fprintf(stderr, "usage: measure_hypermesh [--check] FILE.t4h\n");
    return 2;
  }
  try {
    return run(arguments[count - 1], with_check);
  } catch (const tet4d::Error& error) {
    const tet4d::Fault& fault = error.fault();
    std::fprintf(stderr, "measure_hypermesh: %s: %s: %s\n", fault.file.c_str(), fault.place.c_str(),
                 fault.what.c_str());
    return 1;
  }
}
