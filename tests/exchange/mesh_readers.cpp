#include "tests/exchange/mesh_readers.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
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

template <class T>
std::array<T, 3> threeOf(std::istream& in) {
  std::array<T, 3> values{};
  for (T& value : values) {
    std::string word;
    in >> word;
    require(!word.empty(), "the text ends early");
    value = static_cast<T>(std::stod(word));
  }
  return values;
}

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
    for (const auto& [name, value] : values) {
      if (name.size() != 1 && (name.size() != 2 || name[0] != 'n')) mesh.columns[name].push_back(value);
    }
    if (values.contains("nx")) mesh.normals.push_back({values.at("nx"), values.at("ny"), values.at("nz")});
  }
  for (std::size_t i = 0; i < faces; ++i) {
    require(bytes.take<std::uint8_t>() == 3, "a face that is no triangle");
    mesh.triangles.push_back(bytes.take<std::array<std::int32_t, 3>>());
  }
  require(bytes.atEnd(), "bytes are left over");
  return mesh;
}

ReadMesh readOff(const std::string& text) {
  std::istringstream in(text);
  std::string magic;
  std::size_t points = 0, faces = 0, edges = 0;
  in >> magic >> points >> faces >> edges;
  require(magic == "OFF" || magic == "NOFF", "magic");
  ReadMesh mesh;
  for (std::size_t i = 0; i < points; ++i) {
    mesh.points.push_back(threeOf<double>(in));
    if (magic == "NOFF") mesh.normals.push_back(threeOf<double>(in));
  }
  for (std::size_t i = 0; i < faces; ++i) {
    int corners = 0;
    in >> corners;
    require(corners == 3, "a face that is no triangle");
    mesh.triangles.push_back(threeOf<std::int32_t>(in));
  }
  require((in >> std::ws).eof(), "text is left over");
  return mesh;
}

ReadMesh readObj(const std::string& text) {
  std::istringstream in(text);
  ReadMesh mesh;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      mesh.points.push_back(threeOf<double>(words));
    } else if (kind == "vn") {
      mesh.normals.push_back(threeOf<double>(words));
    } else {
      require(kind == "f", line);
      std::array<std::int32_t, 3> face;
      for (std::int32_t& corner : face) {
        std::string word;
        words >> word;
        corner = std::stoi(word) - 1;
        if (const std::size_t slashes = word.find("//"); slashes != std::string::npos) {
          require(std::stoi(word.substr(slashes + 2)) == corner + 1, "a normal of another vertex");
        }
      }
      mesh.triangles.push_back(face);
    }
    require((words >> std::ws).eof(), line);
  }
  return mesh;
}

ReadMesh readStl(const std::string& text) {
  require(text.size() >= 84 && text.substr(0, 5) != "solid", "header");
  Bytes bytes(text.substr(80));
  ReadMesh mesh;
  const auto floats = [&] {
    const auto v = bytes.take<std::array<float, 3>>();
    return std::array<double, 3>{double{v[0]}, double{v[1]}, double{v[2]}};
  };
  const auto triangles = bytes.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < triangles; ++i) {
    mesh.normals.push_back(floats());
    const auto first = static_cast<std::int32_t>(mesh.points.size());
    for (int c = 0; c < 3; ++c) mesh.points.push_back(floats());
    mesh.triangles.push_back({first, first + 1, first + 2});
    require(bytes.take<std::uint16_t>() == 0, "attribute bytes");
  }
  require(bytes.atEnd(), "bytes are left over");
  return mesh;
}

ReadMesh readGlb(const std::string& text) {
  using nlohmann::json;
  Bytes bytes(text);
  require(bytes.take<std::uint32_t>() == 0x46546c67 && bytes.take<std::uint32_t>() == 2, "magic");
  require(bytes.take<std::uint32_t>() == text.size(), "length");
  const auto json_bytes = bytes.take<std::uint32_t>();
  require(json_bytes % 4 == 0 && bytes.take<std::uint32_t>() == 0x4e4f534a, "chunk of JSON");
  const json root = json::parse(text.substr(20, json_bytes));
  require(root.at("asset").at("version") == "2.0", "version");
  ReadMesh mesh;
  const json& scene = root.at("scenes").at(root.at("scene").get<std::size_t>());
  if (!scene.contains("nodes")) {
    require(text.size() == 20 + json_bytes, "data without a node");
    return mesh;
  }
  Bytes chunk(text.substr(20 + json_bytes));
  const auto data_bytes = chunk.take<std::uint32_t>();
  require(chunk.take<std::uint32_t>() == 0x004e4942, "chunk of data");
  const std::string data = chunk.rest();
  require(data.size() == data_bytes && root.at("buffers").at(0).at("byteLength") == data_bytes, "data's length");
  const auto numbers = [&](const json& number) {
    static const std::map<std::string, std::size_t> kComponents{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    const json& accessor = root.at("accessors").at(number.get<std::size_t>());
    const json& view = root.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const std::size_t offset = view.at("byteOffset"), size = view.at("byteLength"), count = accessor.at("count");
    const std::size_t n = count * kComponents.at(accessor.at("type"));
    require(offset % 4 == 0 && offset + size <= data.size() && size == 4 * n && count > 0, "a view");
    Bytes part(data.substr(offset, size));
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) {
      values.push_back(accessor.at("componentType") == 5126 ? double{part.take<float>()} : part.take<std::uint32_t>());
    }
    return values;
  };
  const json& node = root.at("nodes").at(scene.at("nodes").at(0).get<std::size_t>());
  const auto move = node.value("translation", std::array<double, 3>{0, 0, 0});
  const json& geometry = root.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives").at(0);
  require(geometry.at("mode") == 4, "mode");
  for (const auto& [name, accessor] : geometry.at("attributes").items()) {
    const std::vector<double> values = numbers(accessor);
    if (name == "POSITION") {
      const json& about = root.at("accessors").at(accessor.get<std::size_t>());
      for (std::size_t c = 0; c < 3; ++c) {
        double low = values[c], high = values[c];
        for (std::size_t i = c; i < values.size(); i += 3)
          low = std::min(low, values[i]), high = std::max(high, values[i]);
        require(about.at("min").at(c) == low && about.at("max").at(c) == high, "bounds");
      }
      for (std::size_t i = 0; i < values.size(); i += 3) {
        mesh.points.push_back({values[i] + move[0], values[i + 1] + move[1], values[i + 2] + move[2]});
      }
    } else if (name == "NORMAL") {
      for (std::size_t i = 0; i < values.size(); i += 3)
        mesh.normals.push_back({values[i], values[i + 1], values[i + 2]});
    } else {
      require(name.front() == '_', "an attribute without underscore: " + name);
      mesh.columns[name] = values;
    }
  }
  const std::vector<double> corners = numbers(geometry.at("indices"));
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::array<std::int32_t, 3> face;
    for (std::size_t c = 0; c < 3; ++c) face[c] = static_cast<std::int32_t>(corners[i + c]);
    mesh.triangles.push_back(face);
  }
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
  if (std::regex_search(header, match, std::regex(" Normals=\"([^\"]*)\""))) file.normals = match[1];
  if (std::regex_search(header, match, std::regex(" Vectors=\"([^\"]*)\""))) file.vectors = match[1];
  Bytes bytes(text.substr(text.find('_', data_at) + 1));
  const std::regex array(
      "<DataArray type=\"(\\w+)\" Name=\"([^\"]*)\" NumberOfComponents=\"(\\d+)\" format=\"appended\" "
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
