#include "player/scene/shot_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <vector>

namespace tet4d::scene {
namespace {

using Json = nlohmann::ordered_json;
using Keys = std::initializer_list<std::string_view>;

// Finds where a text stops being JSON. The library's own parser reports positions by throwing only.
struct ErrorFinder : nlohmann::json_sax<Json> {
  std::size_t position = 0;
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return true; }
  bool key(string_t&) override { return true; }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool parse_error(std::size_t at, const std::string&, const nlohmann::detail::exception&) override {
    position = at;
    return false;
  }
};

// Number of edits (insert, delete, replace) between two words.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

std::string_view nearest(std::string_view word, Keys keys) {
  return *std::min_element(keys.begin(), keys.end(), [&](std::string_view a, std::string_view b) {
    return editDistance(word, a) < editDistance(word, b);
  });
}

// Reads one JSON object key by key. The first fault is kept; later calls do nothing.
class ObjectReader {
 public:
  ObjectReader(const Json& object, std::string place, std::optional<Fault>& fault, const std::string& file)
      : object_(object), place_(std::move(place)), fault_(fault), file_(file) {}

  // The value must be an object with no keys but these.
  bool accepts(Keys keys) {
    if (!object_.is_object()) return fail("", "an object {…}", object_), false;
    for (const auto& [key, value] : object_.items()) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      return raise(key, "no such key", "did you mean \"" + std::string(nearest(key, keys)) + "\"?"), false;
    }
    return true;
  }
  const Json* find(const char* key) const {
    const auto at = object_.find(key);
    return at == object_.end() ? nullptr : &*at;
  }
  bool has(const char* key) const { return object_.contains(key); }

  // Leaves `out` alone if the key is missing.
  void number(const char* key, double& out, double low, double high, const char* expected) {
    const Json* value = find(key);
    if (value == nullptr) return;
    if (!value->is_number()) return fail(key, expected, *value);
    const double x = value->get<double>();
    if (!(x >= low && x <= high)) return fail(key, expected, *value);
    out = x;
  }
  void number(const char* key, std::optional<double>& out, double low, const char* expected) {
    if (!has(key)) return;
    double x = 0;
    number(key, x, low, kHuge, expected);
    out = x;
  }
  void vector(const char* key, glm::dvec3& out, double low, double high, const char* expected) {
    if (const Json* value = find(key)) vectorAt(*value, key, out, low, high, expected);
  }
  void vectorAt(const Json& value, const std::string& key, glm::dvec3& out, double low, double high,
                const char* expected) {
    if (!value.is_array() || value.size() != 3) return fail(key, expected, value);
    for (int i = 0; i < 3; ++i) {
      const Json& item = value[static_cast<std::size_t>(i)];
      if (!item.is_number()) return fail(key, expected, value);
      const double x = item.get<double>();
      if (!(x >= low && x <= high)) return fail(key, expected, value);
      out[i] = x;
    }
  }
  void position(const char* key, glm::dvec3& out) { vector(key, out, -kHuge, kHuge, "three finite numbers [x, y, z]"); }
  void direction(const char* key, glm::dvec3& out) {
    vector(key, out, -kHuge, kHuge, "three finite numbers [x, y, z]");
    if (glm::length(out) == 0) raise(key, "is [0, 0, 0], which is no direction", "give a vector that is not zero");
  }
  void linear(const char* key, glm::dvec3& out) { vector(key, out, 0, kHuge, "three numbers [r, g, b] >= 0"); }
  void srgb(const char* key, glm::dvec3& out) { vector(key, out, 0, 1, "three numbers [r, g, b] between 0 and 1"); }

  void fail(const std::string& key, const char* expected, const Json& found) {
    std::string text = found.dump();
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    raise(key, "found " + text + ", expected " + expected, "correct the value, or leave the key out for the default");
  }
  void raise(const std::string& key, std::string what, std::string remedy) {
    if (fault_) return;
    const std::string separator = place_.empty() || key.empty() ? "" : ".";
    fault_ = Fault{FaultCode::kBadInput, file_, place_ + separator + key, std::move(what), std::move(remedy)};
  }
  ObjectReader inner(const Json& object, const std::string& key) const { return {object, key, fault_, file_}; }

  static constexpr double kHuge = 1e300;  // sums and products of two stay finite or are caught by checkView()

 private:
  const Json& object_;
  std::string place_;
  std::optional<Fault>& fault_;
  const std::string& file_;
};

void readView(ObjectReader& reader, View& view) {
  if (reader.has("eye") != reader.has("target")) {
    return reader.raise(reader.has("eye") ? "eye" : "target", "stands alone", "give \"eye\" and \"target\" together");
  }
  if (reader.has("fov_y_degrees") && reader.has("ortho_height")) {
    return reader.raise("ortho_height", "stands beside \"fov_y_degrees\"", "give one of the two");
  }
  reader.position("eye", view.eye);
  reader.position("target", view.target);
  reader.direction("up", view.up);
  if (reader.has("fov_y_degrees")) view.ortho_height.reset();
  reader.number("fov_y_degrees", view.fov_y_degrees, 0.01, 179, "an angle between 0.01 and 179");
  reader.number("ortho_height", view.ortho_height, std::numeric_limits<double>::min(), "a height > 0");
  const double nearest_near = view.ortho_height ? -ObjectReader::kHuge : std::numeric_limits<double>::min();
  reader.number("near", view.near_distance, nearest_near, "a distance > 0 (any, if orthographic)");
  reader.number("far", view.far_distance, nearest_near, "a distance > 0 (any, if orthographic)");
  if (view.near_distance && view.far_distance && !(*view.near_distance < *view.far_distance)) {
    reader.raise("far", "is not beyond \"near\"", "give far > near");
  }
  const glm::dvec3 forward = view.target - view.eye;
  const double sine = glm::length(glm::cross(glm::normalize(forward), glm::normalize(view.up)));
  if (!(glm::length(forward) > 0)) reader.raise("target", "equals \"eye\"", "look at a point beside the eye");
  if (!(sine > 1e-9)) reader.raise("up", "is along the line of sight", "give an up direction beside it");
}

void readLights(ObjectReader& reader, std::vector<Light>& lights) {
  const Json* list = reader.find("lights");
  if (list == nullptr) return;
  if (!list->is_array() || list->size() > kMaxLights)
    return reader.fail("lights", "an array of at most 8 lights", *list);
  lights.assign(list->size(), {});
  for (std::size_t i = 0; i < list->size(); ++i) {
    ObjectReader light = reader.inner((*list)[i], "lights[" + std::to_string(i) + "]");
    if (!light.accepts({"direction", "color"})) return;
    light.direction("direction", lights[i].direction);
    light.linear("color", lights[i].color);
  }
}

void readMaterial(ObjectReader& reader, Material& material) {
  const Json* object = reader.find("material");
  if (object == nullptr) return;
  ObjectReader inner = reader.inner(*object, "material");
  if (!inner.accepts({"color", "back_color", "specular", "shininess", "refraction", "tint", "depth"})) return;
  inner.srgb("color", material.color);
  // One colour given means one colour on both sides.
  if (inner.has("color")) material.back_color = material.color;
  inner.srgb("back_color", material.back_color);
  inner.number("specular", material.specular, 0, 1000, "a number >= 0");
  inner.number("shininess", material.shininess, 1, 10000, "an exponent between 1 and 10000");
  inner.number("refraction", material.refraction, 0, 3, "0 for opaque, or an index between 1 and 3");
  if (material.refraction > 0 && material.refraction < 1)
    inner.raise("refraction", "lies between 0 and 1", "give 0 for opaque, or an index between 1 and 3: water has 1.33");
  inner.number("tint", material.tint, 0, 1, "a number between 0 and 1");
  inner.number("depth", material.depth, 0, 4, "a number of the box's radii between 0 and 4");
}

void readBackground(ObjectReader& reader, Background& background) {
  const Json* value = reader.find("background");
  if (value == nullptr) return;
  if (value->is_array()) {
    reader.srgb("background", background.top);
    background.bottom = background.top;
    background.room.reset();
    return;
  }
  ObjectReader inner = reader.inner(*value, "background");
  if (!inner.accepts({"top", "bottom", "room", "checker"})) return;
  inner.srgb("top", background.top);
  inner.srgb("bottom", background.bottom);
  double checker = background.checker;
  inner.number("checker", checker, 0, 1000, "a number of squares between 0 and 1000");
  background.checker = static_cast<unsigned>(checker);
  if (const Json* room = inner.find("room")) {
    if (*room == false) return background.room.reset();
    glm::dvec3 color(0);
    inner.vectorAt(*room, "room", color, 0, 1, "three numbers [r, g, b] between 0 and 1, or false");
    background.room = color;
  }
}

Json toJson(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

std::string placeOf(std::string_view text, std::size_t position) {
  const std::string_view before = text.substr(0, position > 0 ? position - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t column = before.size() - (newline == std::string_view::npos ? 0 : newline + 1) + 1;
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

}  // namespace

Result<Shot> parseShot(std::string_view text, const std::string& name, const Shot& defaults) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    ErrorFinder finder;
    Json::sax_parse(text, &finder);
    return Fault{FaultCode::kBadInput, name, placeOf(text, finder.position), "is not JSON from here on",
                 "mend it, or start from a file written by --write-camera"};
  }
  std::optional<Fault> fault;
  ObjectReader reader(json, "", fault, name);
  Shot shot = defaults;
  if (reader.accepts({"eye", "target", "up", "fov_y_degrees", "ortho_height", "near", "far", "lights", "ambient",
                      "material", "background"})) {
    readView(reader, shot.view);
    readLights(reader, shot.lights);
    reader.linear("ambient", shot.ambient);
    readMaterial(reader, shot.material);
    readBackground(reader, shot.background);
  }
  if (fault) return *fault;
  return shot;
}

Result<Shot> readShot(const std::string& path, const Shot& defaults) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return Fault{FaultCode::kIo, path, "", "cannot be opened", "check the path given to --camera"};
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad()) return Fault{FaultCode::kIo, path, "", "cannot be read", "check the path given to --camera"};
  return parseShot(text, path, defaults);
}

std::string formatShot(const Shot& shot) {
  Json json;
  json["eye"] = toJson(shot.view.eye);
  json["target"] = toJson(shot.view.target);
  json["up"] = toJson(shot.view.up);
  if (shot.view.ortho_height) {
    json["ortho_height"] = *shot.view.ortho_height;
  } else {
    json["fov_y_degrees"] = shot.view.fov_y_degrees;
  }
  if (shot.view.near_distance) json["near"] = *shot.view.near_distance;
  if (shot.view.far_distance) json["far"] = *shot.view.far_distance;
  json["lights"] = Json::array();
  for (const Light& light : shot.lights) {
    json["lights"].push_back({{"direction", toJson(light.direction)}, {"color", toJson(light.color)}});
  }
  json["ambient"] = toJson(shot.ambient);
  json["material"] = {{"color", toJson(shot.material.color)},
                      {"back_color", toJson(shot.material.back_color)},
                      {"specular", shot.material.specular},
                      {"shininess", shot.material.shininess},
                      {"refraction", shot.material.refraction},
                      {"tint", shot.material.tint},
                      {"depth", shot.material.depth}};
  json["background"] = {{"top", toJson(shot.background.top)}, {"bottom", toJson(shot.background.bottom)}};
  json["background"]["checker"] = shot.background.checker;
  json["background"]["room"] = shot.background.room ? toJson(*shot.background.room) : Json(false);
  return json.dump(2) + "\n";
}

}  // namespace tet4d::scene
