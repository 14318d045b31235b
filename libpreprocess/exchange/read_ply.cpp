// Vertices and faces of PLY, text and binary of both byte orders, whatever other elements and properties it has.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_scan.h"

namespace tet4d::exchange {
namespace {

enum class Type { kI8, kU8, kI16, kU16, kI32, kU32, kF32, kF64 };
constexpr std::array<std::size_t, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
  std::string name;
  Type type = Type::kF32;
  bool is_list = false;
  Type count = Type::kU8;
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  bool is_text = false, swaps = false;
  std::vector<Element> elements;
};

Type typeOf(std::string_view word, const TextLines& lines) {
  constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                   {"uchar", "uint8"},
                                                                   {"short", "int16"},
                                                                   {"ushort", "uint16"},
                                                                   {"int", "int32"},
                                                                   {"uint", "uint32"},
                                                                   {"float", "float32"},
                                                                   {"double", "float64"}}};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (word == kNames[i][0] || word == kNames[i][1]) return static_cast<Type>(i);
  lines.fail("unknown type \"" + std::string(word) + "\"");
}

Property propertyOf(TextLines& lines) {
  Property property;
  std::string_view word = lines.word();
  if (word == "list") {
    property.is_list = true;
    property.count = typeOf(lines.word(), lines);
    if (property.count >= Type::kF32) lines.fail("a list's count is not a whole number");
    word = lines.word();
  }
  property.type = typeOf(word, lines);
  property.name = lines.word();
  return property;
}

Header headerOf(TextLines& lines) {
  Header header;
  bool has_format = false;
  if (!lines.next() || lines.word() != "ply") lines.fail("the first line is not \"ply\"");
  while (lines.next()) {
    const std::string_view key = lines.word();
    if (key == "end_header") {
      if (!has_format || header.elements.empty()) lines.fail("the header tells no format or no element");
      return header;
    }
    if (key == "format") {
      const std::string_view format = lines.word();
      has_format = header.is_text = format == "ascii";
      for (const auto& [name, order] :
           {std::pair{"binary_little_endian", std::endian::little}, std::pair{"binary_big_endian", std::endian::big}}) {
        if (format != name) continue;
        has_format = true;
        header.swaps = order != std::endian::native;
      }
      if (!has_format) lines.fail("unknown format \"" + std::string(format) + "\"");
      if (lines.word() != "1.0") lines.fail("the format's version is not 1.0");
    } else if (key == "element") {
      header.elements.push_back({std::string(lines.word()), 0, {}});
      header.elements.back().count = lines.count("the element's count");
    } else if (key == "property") {
      if (header.elements.empty()) lines.fail("a property stands in front of every element");
      header.elements.back().properties.push_back(propertyOf(lines));
    } else if (key != "comment" && key != "obj_info") {
      // OpenMesh waits for ever on headers it does not understand.
      lines.fail("the header has no such word as \"" + std::string(key) + "\"");
    }
    if (key != "comment" && key != "obj_info" && !lines.word().empty()) lines.fail("the line goes on behind its end");
  }
  lines.fail("the file ends in its header");
}

// The values behind the header, one after the other, as doubles: every type but 64-bit integers fits.
class Values {
 public:
  Values(const Header& header, std::string_view bytes, std::size_t begin, const std::string& path)
      : header_(header), bytes_(bytes), at_(begin), path_(path) {}

  void enter(const Element& element, std::uint64_t item) {
    element_ = &element;
    item_ = item;
  }
  double next(Type type) { return header_.is_text ? nextWord() : nextBinary(type); }
  // A list's count; what it promises is there: at least a byte a value in text, its size in binary.
  std::uint64_t nextCount(const Property& list) {
    const double value = next(list.count);
    const std::uint64_t size = header_.is_text ? 1 : kBytes[static_cast<std::size_t>(list.type)];
    if (!(value >= 0) || value != std::floor(value) ||
        value * static_cast<double>(size) > static_cast<double>(left())) {
      fail("a list of " + std::to_string(value) + " values does not fit in the file");
    }
    return static_cast<std::uint64_t>(value);
  }
  std::uint64_t left() const { return bytes_.size() - at_; }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(FaultCode::kBadInput, path_, element_->name + " " + std::to_string(item_), what, "make the file again");
  }

 private:
  double nextWord() {
    const auto isSpace = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (at_ < bytes_.size() && isSpace(bytes_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !isSpace(bytes_[at_])) ++at_;
    std::string_view word = bytes_.substr(begin, at_ - begin);
    if (word.empty()) fail("the file ends here");
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) fail(std::string(word) + " is no number");
    return value;
  }
  template <class T>
  double read() {
    std::array<char, sizeof(T)> raw;
    if (left() < sizeof(T)) fail("the file ends here");
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if (header_.swaps) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return static_cast<double>(std::bit_cast<T>(raw));
  }
  double nextBinary(Type type) {
    switch (type) {
      case Type::kI8:
        return read<std::int8_t>();
      case Type::kU8:
        return read<std::uint8_t>();
      case Type::kI16:
        return read<std::int16_t>();
      case Type::kU16:
        return read<std::uint16_t>();
      case Type::kI32:
        return read<std::int32_t>();
      case Type::kU32:
        return read<std::uint32_t>();
      case Type::kF32:
        return read<float>();
      case Type::kF64:
        return read<double>();
    }
    fail("a type is unknown");
  }

  const Header& header_;
  std::string_view bytes_;
  std::size_t at_;
  const std::string& path_;
  const Element* element_ = nullptr;
  std::uint64_t item_ = 0;
};

void skip(Values& values, const Property& property) {
  for (std::uint64_t left = property.is_list ? values.nextCount(property) : 1; left > 0; --left)
    values.next(property.type);
}

void readVertex(Values& values, const Element& element, PolygonMesh& mesh) {
  std::array<double, 3> point{};
  for (const Property& property : element.properties) {
    const std::size_t axis = std::string_view("xyz").find(property.name);
    if (property.name.size() != 1 || axis > 2 || property.is_list) {
      skip(values, property);
    } else if (point[axis] = values.next(property.type); !std::isfinite(point[axis])) {
      values.fail(property.name + " is not finite");
    }
  }
  mesh.points.push_back(point);
}

bool namesVertices(const Property& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

void readFace(Values& values, const Element& element, std::uint64_t vertices, PolygonMesh& mesh) {
  for (const Property& property : element.properties) {
    if (!namesVertices(property)) {
      skip(values, property);
      continue;
    }
    for (std::uint64_t left = values.nextCount(property); left > 0; --left) {
      const double corner = values.next(property.type);
      if (!(corner >= 0) || corner != std::floor(corner) || corner >= static_cast<double>(vertices))
        values.fail("the face names vertex " + std::to_string(corner) + ", but there are " + std::to_string(vertices));
      mesh.corners.push_back(static_cast<std::uint32_t>(corner));
    }
    if (const char* what = endFace(mesh)) values.fail(what);
  }
}

// What an item takes at least: a value two bytes in text, its size in binary.
std::uint64_t leastBytes(const Element& element, bool is_text) {
  std::uint64_t bytes = 0;
  for (const Property& p : element.properties)
    bytes += is_text ? 2 : kBytes[static_cast<std::size_t>(p.is_list ? p.count : p.type)];
  return bytes;
}

void checkElement(const Element& element, const TextLines& lines) {
  const auto has = [&](auto&& wanted) {
    return std::count_if(element.properties.begin(), element.properties.end(), wanted);
  };
  if (element.name == "vertex") {
    for (const char* axis : {"x", "y", "z"}) {
      if (has([&](const Property& p) { return p.name == axis && !p.is_list; }) != 1)
        lines.fail(std::string("the vertices must have one property ") + axis);
    }
    if (element.count >= std::uint64_t{1} << 31) lines.fail("has more than 2^31 - 1 vertices");
  }
  if (element.name == "face" && element.count > 0 && has(namesVertices) != 1)
    lines.fail("the faces must have one list vertex_indices");
  if (element.name == "face" && element.count > 0 && !namesVertices(element.properties.front())) {
    lines.fail(
        "the faces have " + element.properties.front().name + " in front of vertex_indices, which OpenMesh misreads",
        "write vertex_indices as the faces' first property");
  }
}

}  // namespace

PolygonMesh scanPly(std::string_view bytes, const std::string& path) {
  TextLines lines(bytes, path);
  const Header header = headerOf(lines);
  for (const Element& element : header.elements) checkElement(element, lines);
  PolygonMesh mesh;
  Values values(header, bytes, bytes.size() - lines.rest().size(), path);
  std::uint64_t vertices = 0;
  for (const Element& element : header.elements)
    if (element.name == "vertex") vertices = element.count;
  for (const Element& element : header.elements) {
    const std::uint64_t least = leastBytes(element, header.is_text);
    values.enter(element, 0);
    // The last value of a text need not be followed by a blank.
    if (least != 0 && element.count > (values.left() + 1) / least) {
      values.fail(std::to_string(element.count) + " of them do not fit in the file");
    }
    for (std::uint64_t i = 0; least != 0 && i < element.count; ++i) {
      values.enter(element, i);
      if (element.name == "vertex") {
        readVertex(values, element, mesh);
      } else if (element.name == "face") {
        readFace(values, element, vertices, mesh);
      } else {
        for (const Property& property : element.properties) skip(values, property);
      }
    }
  }
  if (mesh.points.empty()) lines.fail("the file has no vertices");
  return mesh;
}

}  // namespace tet4d::exchange
