// Tetrahedra as text: Medit .mesh, Gmsh .msh 2.2 and 4.1, TetGen .node and .ele. Word by word through a fixed buffer;
// counts are proved against the bytes that are left before anything is allocated.
#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/header_text.h"
#include "libpreprocess/exchange/input_file.h"
#include "libpreprocess/exchange/tet_mesh_formats.h"

namespace tet4d::exchange {
namespace {

constexpr const char* kMakeAgain = "write the file again, as text";

// The words of a file between blanks; '#' begins a comment that goes to the end of the line.
class Words {
 public:
  explicit Words(const std::string& path) : file_(path), buffer_(std::size_t{1} << 16) {}

  [[noreturn]] void fail(const std::string& what, const std::string& remedy = kMakeAgain) const {
    throw Error(FaultCode::kBadInput, file_.path(), "line " + std::to_string(line_), what, remedy);
  }

  // The next word, valid until the next call; empty at the end of the file.
  std::string_view next() {
    word_.clear();
    for (;;) {
      const int c = get();
      if (c < 0) return word_;
      if (c == '#' && word_.empty()) {
        skipLine();
      } else if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
        if (!word_.empty()) {
          unget();
          return word_;
        }
        if (c == '\n') ++line_;
      } else {
        word_ += static_cast<char>(c);
        if (word_.size() > 1024) fail("a word is longer than 1024 bytes");
      }
    }
  }
  std::string_view need() {
    const std::string_view word = next();
    if (word.empty()) fail("the file ends, but more is expected", "copy or make the file again");
    return word;
  }
  void skipLine() {
    for (int c = get(); c >= 0; c = get()) {
      if (c == '\n') {
        ++line_;
        return;
      }
    }
  }
  double number() {
    const std::string_view word = need();
    if (const auto value = exchange::numberOf(word)) return *value;
    fail("expected a number, found " + inQuotes(word));
  }
  std::uint64_t count() {
    const std::string_view word = need();
    if (const auto value = exchange::countOf(word)) return *value;
    fail("expected a whole number from 0 on, found " + inQuotes(word));
  }
  void skip(std::uint64_t words) {
    for (std::uint64_t i = 0; i < words; ++i) need();
  }
  // A count of items of so many words each, which the rest of the file must be able to hold.
  std::uint64_t countOf(std::uint64_t words_each) {
    const std::uint64_t items = count(), rest = file_.size() - std::min(file_.size(), begin_ + used_);
    if (items > rest / (2 * words_each) + 1) {
      fail(std::to_string(items) + " items are told, but the file ends in " + std::to_string(rest) + " bytes");
    }
    return items;
  }

 private:
  int get() {
    if (used_ == filled_) {
      begin_ += filled_;
      used_ = 0;
      filled_ = file_.readSome(begin_, std::as_writable_bytes(std::span(buffer_)));
      if (filled_ == 0) return -1;
    }
    return static_cast<unsigned char>(buffer_[used_++]);
  }
  void unget() { --used_; }

  InputFile file_;
  std::vector<char> buffer_;
  std::uint64_t begin_ = 0;
  std::size_t used_ = 0, filled_ = 0;
  std::uint64_t line_ = 1;
  std::string word_;
};

// A mesh that grows by points and tetrahedra whose vertices may come before the points do.
class Builder {
 public:
  Builder(const std::string& path, const TetMeshOptions& options) : options_(options) {
    mesh_.path = path;
    if (options.scalar.empty() || isCoordinate(options.scalar)) return;
    throw Error(FaultCode::kBadInput, path, "", "has no array " + inQuotes(options.scalar),
                "of this format the coordinates x, y and z can be taken; for arrays give a .vtu");
  }
  void point(Words& words) {
    std::array<double, 3> p{};
    for (double& c : p) c = words.number();
    if (mesh_.points.size() == std::numeric_limits<std::uint32_t>::max()) words.fail("2^32 points", "cut the mesh");
    mesh_.points.push_back(p);
    checkPoint(mesh_, mesh_.points.size() - 1);
  }
  void tet(const std::array<std::uint64_t, 4>& corners, const Words& words) {
    std::array<std::uint32_t, 4> tet{};
    for (std::size_t c = 0; c < 4; ++c) {
      if (corners[c] > std::numeric_limits<std::uint32_t>::max()) {
        words.fail("vertex " + std::to_string(corners[c]) + " is out of range");
      }
      tet[c] = static_cast<std::uint32_t>(corners[c]);
    }
    mesh_.tets.push_back(tet);
  }
  void otherCell(const Words& words, const std::string& what) {
    if (!options_.tets_only) {
      words.fail("a " + what + ", not a tetrahedron",
                 "cut other cells into tetrahedra, or leave them out with --tets-only");
    }
    ++mesh_.other_cells;
  }
  TetMesh finish() {
    for (std::size_t i = 0; i < mesh_.tets.size(); ++i) {
      for (const std::uint32_t corner : mesh_.tets[i]) {
        if (corner < mesh_.points.size()) continue;
        throw Error(FaultCode::kBadInput, mesh_.path, "tetrahedron " + std::to_string(i),
                    "vertex id " + std::to_string(corner) + " counted from 0, but there are " +
                        std::to_string(mesh_.points.size()) + " points",
                    kMakeAgain);
      }
    }
    if (mesh_.tets.empty()) {
      throw Error(FaultCode::kBadInput, mesh_.path, "", "the mesh has no tetrahedra", "give a mesh of tetrahedra");
    }
    if (!options_.scalar.empty()) takeCoordinate(mesh_, options_.scalar);
    return std::move(mesh_);
  }
  TetMesh& mesh() { return mesh_; }

 private:
  const TetMeshOptions& options_;
  TetMesh mesh_;
};

// Numbers that count from 1.
std::uint64_t fromOne(Words& words) {
  const std::uint64_t number = words.count();
  if (number == 0) words.fail("a vertex is numbered 0, but numbers begin with 1");
  return number - 1;
}

struct Section {
  std::string_view name;
  std::uint64_t words;  // of an item
};
constexpr std::array<Section, 14> kMeditSections{{{"Edges", 3},
                                                  {"Triangles", 4},
                                                  {"Quadrilaterals", 5},
                                                  {"Corners", 1},
                                                  {"Ridges", 1},
                                                  {"RequiredVertices", 1},
                                                  {"RequiredEdges", 1},
                                                  {"RequiredTriangles", 1},
                                                  {"Normals", 3},
                                                  {"Tangents", 3},
                                                  {"NormalAtVertices", 2},
                                                  {"TangentAtVertices", 2},
                                                  {"Hexahedra", 9},
                                                  {"Prisms", 7}}};

void readMeditSection(Words& words, const std::string& name, Builder& builder) {
  if (name == "Vertices") {
    for (std::uint64_t left = words.countOf(4); left > 0; --left) {
      builder.point(words);
      words.skip(1);
    }
    return;
  }
  if (name == "Tetrahedra") {
    for (std::uint64_t left = words.countOf(5); left > 0; --left) {
      std::array<std::uint64_t, 4> tet{};
      for (std::uint64_t& corner : tet) corner = fromOne(words);
      builder.tet(tet, words);
      words.skip(1);
    }
    return;
  }
  const auto* const section =
      std::find_if(kMeditSections.begin(), kMeditSections.end(), [&](const Section& s) { return s.name == name; });
  if (section == kMeditSections.end()) words.fail("the section " + inQuotes(name) + " is not known", "remove it");
  for (std::uint64_t left = words.countOf(section->words); left > 0; --left) {
    if (name == "Hexahedra" || name == "Prisms") builder.otherCell(words, name == "Prisms" ? "prism" : "hexahedron");
    words.skip(section->words);
  }
}

// Nodes of a Gmsh element, by type; 0: not known. Types of three dimensions are those but lines, faces and points.
struct GmshType {
  std::uint64_t nodes;
  bool is_solid;
};
GmshType gmshType(std::uint64_t type) {
  constexpr std::array<GmshType, 32> kTypes{
      {{0, false},  {2, false},  {3, false}, {4, false}, {4, true},  {8, true},   {6, true},   {5, true},
       {3, false},  {6, false},  {9, false}, {10, true}, {27, true}, {18, true},  {14, true},  {1, false},
       {8, false},  {20, true},  {15, true}, {13, true}, {9, false}, {10, false}, {12, false}, {15, false},
       {15, false}, {21, false}, {4, false}, {5, false}, {6, false}, {20, true},  {35, true},  {56, true}}};
  return type < kTypes.size() ? kTypes[static_cast<std::size_t>(type)] : GmshType{0, false};
}

class GmshReader {
 public:
  GmshReader(const std::string& path, const TetMeshOptions& options) : words_(path), builder_(path, options) {}

  TetMesh read() {
    if (words_.need() != "$MeshFormat") words_.fail("expected $MeshFormat", "give a Gmsh file (.msh)");
    const std::string version(words_.need());
    if (version != "2.2" && version != "4.1") {
      words_.fail("version " + inQuotes(version) + ", expected 2.2 or 4.1", "save the mesh again: gmsh -format msh41");
    }
    is_new_ = version == "4.1";
    if (words_.need() != "0") words_.fail("the file is binary, which is not read", "save it as text");
    while (!words_.need().starts_with("$End")) {
    }
    for (std::string name(words_.next()); !name.empty(); name = words_.next()) section(name);
    TetMesh& mesh = builder_.mesh();
    for (auto& tet : mesh.tets) {
      for (std::uint32_t& corner : tet) corner = numberOf(corner);
    }
    return builder_.finish();
  }

 private:
  void section(const std::string& name) {
    if (!name.starts_with("$")) words_.fail("expected a section, found " + inQuotes(name));
    if (name == "$Nodes") {
      is_new_ ? newNodes() : oldNodes();
    } else if (name == "$Elements") {
      is_new_ ? newElements() : oldElements();
    }
    const std::string end = "$End" + name.substr(1);
    for (std::string_view word = words_.need(); word != end; word = words_.need()) {
      if (name == "$Nodes" || name == "$Elements") words_.fail("expected " + end + ", found " + inQuotes(word));
    }
  }
  void addTag(std::uint64_t tag) {
    if (tag > std::numeric_limits<std::uint32_t>::max()) words_.fail("node number " + std::to_string(tag), "renumber");
    if (!numbers_.emplace(static_cast<std::uint32_t>(tag), static_cast<std::uint32_t>(numbers_.size())).second) {
      words_.fail("node " + std::to_string(tag) + " is there twice");
    }
  }
  void oldNodes() {
    for (std::uint64_t left = words_.countOf(4); left > 0; --left) {
      addTag(words_.count());
      builder_.point(words_);
    }
  }
  void newNodes() {
    const std::uint64_t blocks = words_.countOf(4);
    words_.skip(3);
    for (std::uint64_t block = 0; block < blocks; ++block) {
      const std::uint64_t dimension = words_.count();
      words_.skip(1);
      const std::uint64_t parameters = words_.count() == 0 ? 0 : dimension;
      const std::uint64_t nodes = words_.countOf(4);
      for (std::uint64_t i = 0; i < nodes; ++i) addTag(words_.count());
      for (std::uint64_t i = 0; i < nodes; ++i) {
        builder_.point(words_);
        words_.skip(parameters);
      }
    }
  }
  void element(std::uint64_t type) {
    const GmshType known = gmshType(type);
    if (known.nodes == 0) words_.fail("elements of type " + std::to_string(type) + " are not known");
    if (type == 4) {
      std::array<std::uint64_t, 4> tet{};
      for (std::uint64_t& corner : tet) corner = words_.count();
      builder_.tet(tet, words_);
      return;
    }
    if (known.is_solid) builder_.otherCell(words_, "solid of " + std::to_string(known.nodes) + " nodes");
    words_.skip(known.nodes);
  }
  void oldElements() {
    for (std::uint64_t left = words_.countOf(4); left > 0; --left) {
      words_.skip(1);
      const std::uint64_t type = words_.count();
      words_.skip(words_.countOf(1));
      element(type);
    }
  }
  void newElements() {
    const std::uint64_t blocks = words_.countOf(4);
    words_.skip(3);
    for (std::uint64_t block = 0; block < blocks; ++block) {
      words_.skip(2);
      const std::uint64_t type = words_.count();
      for (std::uint64_t left = words_.countOf(2); left > 0; --left) {
        words_.skip(1);
        element(type);
      }
    }
  }
  std::uint32_t numberOf(std::uint32_t tag) const {
    const auto it = numbers_.find(tag);
    if (it == numbers_.end()) words_.fail("an element names node " + std::to_string(tag) + ", which is not there");
    return it->second;
  }

  Words words_;
  Builder builder_;
  bool is_new_ = false;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;  // node → place
};

}  // namespace

TetMesh readMedit(const std::string& path, const TetMeshOptions& options) {
  Words words(path);
  Builder builder(path, options);
  if (words.need() != "MeshVersionFormatted") {
    words.fail("expected MeshVersionFormatted", "give a Medit mesh as text (.mesh)");
  }
  words.skip(1);
  for (std::string name(words.next()); !name.empty() && name != "End"; name = words.next()) {
    if (name != "Dimension") {
      readMeditSection(words, name, builder);
    } else if (words.count() != 3) {
      words.fail("the mesh is not of dimension 3", "give a mesh of tetrahedra");
    }
  }
  return builder.finish();
}

TetMesh readGmsh(const std::string& path, const TetMeshOptions& options) { return GmshReader(path, options).read(); }

TetMesh readTetgen(const std::string& path, const TetMeshOptions& options) {
  const std::filesystem::path stem = std::filesystem::path(path).replace_extension();
  Builder builder(path, options);
  Words nodes(stem.string() + ".node"), elements(stem.string() + ".ele");
  const std::uint64_t points = nodes.countOf(4);
  if (nodes.count() != 3) nodes.fail("the points are not of dimension 3", "give a mesh of tetrahedra");
  std::uint64_t more = nodes.count();
  more += nodes.count();
  std::uint64_t first = 0;
  for (std::uint64_t i = 0; i < points; ++i) {
    const std::uint64_t number = nodes.count();
    if (i == 0) first = number;
    if (number != first + i || first > 1) nodes.fail("point " + std::to_string(number) + " is out of order");
    builder.point(nodes);
    nodes.skip(more);
  }
  const std::uint64_t tets = elements.countOf(5), corners = elements.count(), attributes = elements.count();
  if (corners != 4) elements.fail("elements of " + std::to_string(corners) + " nodes, expected 4", "use linear ones");
  for (std::uint64_t i = 0; i < tets; ++i) {
    elements.skip(1);
    std::array<std::uint64_t, 4> tet{};
    for (std::uint64_t& corner : tet) {
      corner = elements.count();
      if (corner < first) elements.fail("vertex " + std::to_string(corner) + " is out of range");
      corner -= first;
    }
    builder.tet(tet, elements);
    elements.skip(attributes);
  }
  return builder.finish();
}

}  // namespace tet4d::exchange
