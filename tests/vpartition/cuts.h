// Cuts of a patch DAG for tests: random legal ones, and their slices, welded by the bits of vertices.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "formats/core/slicer.h"
#include "formats/patch_dag.h"
#include "libpreprocess/vpartition/dag_builder.h"
#include "tests/hypermesh/extracted_mesh.h"

namespace tet4d::vpartition::testing {

// A DAG in memory: every patch loaded, its vertices numbered so that equal bits have equal numbers.
struct LoadedDag {
  struct Patch {
    std::vector<Vec4f> vertices;
    std::vector<hypermesh::Tet> tets;
    std::vector<std::uint64_t> ids;  // by vertex
    std::uint64_t from, to, shared;
    float begin, end;  // its times
  };
  std::vector<Patch> patches;
  std::vector<std::vector<std::uint64_t>> uppers;  // by node: nodes with an arc to it
  std::vector<patch_dag::NodeEntry> nodes;
  Bounds4f domain;
};

// Opens and verifies the file first. Throws Error.
LoadedDag load(const std::string& path);

// By node: refined. Above a level drawn by chance all nodes are; from there on a node may be with the chance `chance`
// if all its upper nodes are.
std::vector<bool> randomCut(const LoadedDag& dag, std::mt19937& random, double chance);
// Refined where the estimated error is above a limit.
std::vector<bool> cutAt(const LoadedDag& dag, double error);

// Numbers of the patches of a cut.
std::vector<std::size_t> patchesOf(const LoadedDag& dag, const std::vector<bool>& refined);

SliceMesh sliceOf(const LoadedDag& dag, const std::vector<std::size_t>& patches, float t);
double volumeOf(const SliceMesh& slice);

struct BuildRun {
  Dag dag;
  std::string bytes;  // of the file
};

// Builds and writes a DAG of a hypermesh file.
BuildRun buildTo(const std::string& path, const std::string& mesh, const Options& options, std::size_t threads = 1);

}  // namespace tet4d::vpartition::testing
