// The peer beside our rows: VTK's filters, run by scripts/peers/vtk_peer.py where VTK for python is installed.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libpreprocess/measure/triangle_tree.h"
#include "tools/report/child.h"
#include "tools/report/rows.h"

namespace tet4d::report {

struct PeerRun {
  ChildRun child;
  nlohmann::json line;  // what the script printed
  std::string absent;   // why the peer is not there; empty if it is
  double number(const char* name) const { return line.value(name, 0.0); }
};

// Never throws for what the peer does, as Programs::run(). The script is share/tet4d/peers/vtk_peer.py beside bin/.
PeerRun runPeer(const Programs& programs, const std::vector<std::string>& arguments);

// Exit, fault, seconds of the filter alone and memory; "absent" and nothing else if the peer is not there, which is no
// failure.
void addPeer(Row& row, const PeerRun& run);

// A file of float32 triples and one of uint32 triples that a peer wrote, points times `step`. Throws Error kIo.
struct PeerSurface {
  std::vector<measure::Point3> points;
  std::vector<measure::Triangle> triangles;
};
PeerSurface readPeerSurface(const std::string& base, double step);

// A file of numbers that a peer wrote, whole. Throws Error kIo if it is missing or no whole number of values.
template <class T>
std::vector<T> readValues(const std::string& path);

}  // namespace tet4d::report
