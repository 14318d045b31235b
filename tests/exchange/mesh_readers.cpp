#include "tests/exchange/mesh_readers.h"

#include <cstring>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace tet4d::testing {
namespace {

void require(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error(what);
}

// Takes values off the front of binary text.
class Bytes {
 public:
  explicit Bytes(std::string text) : text_(std::move(text)) {}
  template <class T>
  T take() {
    require(at_ + sizeof(T) <= text_.size(), "the data end early");
    T value;
    std::memcpy(&value, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  double takeAs(const std::string& type) {
    if (type == "float" || type == "Float32") return double{take<float>()};
    if (type == "double" || type == "Float64") return take<double>();
    if (type == "Int64") return static_cast<double>(take<std::int64_t>());
    if (type == "UInt64") return static_cast<double>(take<std::uint64_t>());
    if (type == "UInt8") return take<std::uint8_t>();
    throw std::runtime_error("type " + type);
  }
  std::size_t at() const { return at_; }
  bool atEnd() const { return at_ == text_.size(); }
  std::string rest() const { return text_.substr(at_); }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

}  // namespace

PlyMesh readPly(const std::string& text) {
  const std::string end = "end_header\n";
  const std::size_t header_end = text.find(end);
  require(header_end != std::string::npos, "no end_header");
  std::istringstream header(text.substr(0, header_end));
  std::string line, word;
  std::getline(header, line);
  require(line == "ply", "magic");
  std::getline(header, line);
  require(line == "format binary_little_endian 1.0", "format");
  std::vector<std::pair<std::string, std::string>> properties;  // type, name of a vertex
  std::size_t vertices = 0, faces = 0;
  while (std::getline(header, line)) {
    std::istringstream words(line);
    std::string kind, type, name;
    words >> kind >> type >> name;
    if (kind == "element") (type == "vertex" ? vertices : faces) = std::stoull(name);
    if (kind == "property" && type != "list") properties.emplace_back(type, name);
    if (kind == "property" && type == "list") require(line == "property list uchar int vertex_indices", line);
  }
  Bytes bytes(text.substr(header_end + end.size()));
  PlyMesh mesh;
  for (std::size_t i = 0; i < vertices; ++i) {
    std::map<std::string, double> values;
    for (const auto& [type, name] : properties) {
      values[name] = bytes.takeAs(type);
      mesh.has_doubles |= type == "double";
    }
    mesh.points.push_back({values.at("x"), values.at("y"), values.at("z")});
    if (values.contains("nx")) mesh.normals.push_back({values.at("nx"), values.at("ny"), values.at("nz")});
  }
  for (std::size_t i = 0; i < faces; ++i) {
    require(bytes.take<std::uint8_t>() == 3, "a face that is no triangle");
    mesh.triangles.push_back(bytes.take<std::array<std::int32_t, 3>>());
  }
  require(bytes.atEnd(), "bytes are left over");
  return mesh;
}

VtkFile readVtk(const std::string& text) {
  const std::size_t data_at = text.find("<AppendedData encoding=\"raw\">");
  require(data_at != std::string::npos, "no appended data");
  const std::string header = text.substr(0, data_at);
  require(header.find("header_type=\"UInt64\"") != std::string::npos, "header_type");
  require(header.find("byte_order=\"LittleEndian\"") != std::string::npos, "byte_order");
  VtkFile file;
  std::smatch match;
  require(std::regex_search(header, match, std::regex("<VTKFile type=\"(\\w+)\"")), "type");
  file.kind = match[1];
  const std::regex count("(NumberOf(?:Points|Cells|Polys))=\"(\\d+)\"");
  for (std::sregex_iterator it(header.begin(), header.end(), count), last; it != last; ++it) {
    file.piece[(*it)[1]] = std::stoull((*it)[2]);
  }
  Bytes bytes(text.substr(text.find('_', data_at) + 1));
  const std::regex array(
      "<DataArray type=\"(\\w+)\" Name=\"(\\w+)\" NumberOfComponents=\"(\\d+)\" format=\"appended\" "
      "offset=\"(\\d+)\"/>");
  for (std::sregex_iterator it(header.begin(), header.end(), array), last; it != last; ++it) {
    require(bytes.at() == std::stoull((*it)[4]), "the offset of " + (*it)[2].str());
    const auto size = bytes.take<std::uint64_t>();
    const std::size_t begin = bytes.at();
    VtkArray values{(*it)[1], static_cast<unsigned>(std::stoul((*it)[3])), {}};
    while (bytes.at() < begin + size) values.values.push_back(bytes.takeAs(values.type));
    require(bytes.at() == begin + size, "the size of " + (*it)[2].str());
    file.arrays[(*it)[2]] = std::move(values);
  }
  require(bytes.rest() == "\n  </AppendedData>\n</VTKFile>\n", "the end of the file");
  return file;
}

}  // namespace tet4d::testing
