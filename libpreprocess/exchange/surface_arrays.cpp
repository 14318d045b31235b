// Raw arrays with a sequence.json beside them: triangles once, vertices frame by frame.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/frame_series.h"
#include "libpreprocess/exchange/gzip_stream.h"
#include "libpreprocess/exchange/input_file.h"
#include "libpreprocess/exchange/surface_source.h"

namespace tet4d::exchange {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostJsonBytes = std::uint64_t{64} << 20;

// A file of numbers, raw or gzip, read from front to back; going back begins anew.
class ArrayFile {
 public:
  explicit ArrayFile(const std::string& path) : file_(path) {
    std::array<std::byte, 2> magic{};
    is_gzip_ = file_.readSome(0, magic) == 2 && magic[0] == std::byte{0x1f} && magic[1] == std::byte{0x8b};
  }
  const std::string& path() const { return file_.path(); }
  // Proves the size of a raw file, or what a gzip stream may hold: it packs a byte into a thousand at most.
  void expect(std::uint64_t bytes) {
    expected_ = bytes;
    if (is_gzip_ ? bytes / 1100 <= file_.size() : bytes == file_.size()) return;
    throw Error(FaultCode::kBadInput, path(), "",
                "has " + std::to_string(file_.size()) + " bytes, but the counts make " + std::to_string(bytes),
                "correct the counts in the .json");
  }
  void read(std::uint64_t offset, std::span<std::byte> bytes) {
    if (!is_gzip_) return file_.read(offset, bytes);
    if (!stream_ || stream_->position() > offset) stream_.emplace(file_, 0);
    stream_->skip(offset - stream_->position());
    stream_->read(bytes);
    if (stream_->position() == expected_) stream_->finish();  // the checksum stands there
  }

 private:
  InputFile file_;
  bool is_gzip_ = false;
  std::uint64_t expected_ = 0;  // bytes, decoded
  std::optional<GzipStream> stream_;
};

constexpr const char* kKeys =
    "needed are the counts vertices, triangles, frames and the names triangles_file (X.i32), vertices_file (X.f32, "
    "X.f64 "
    "or X.i16); scale and times may be left out";

struct Description {
  std::uint64_t vertices = 0, triangles = 0, frames = 0;
  std::string triangles_file, vertices_file;
  double scale = 1;
  std::vector<double> times;
};

// The keys of a description, each checked for what it must be.
class Keys {
 public:
  explicit Keys(const std::string& path) : path_(path) {
    const InputFile file(path);
    if (file.size() > kMostJsonBytes) fail("", "is too large for a description of arrays");
    std::string text(file.size(), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)));
    try {
      json_ = nlohmann::json::parse(text);
    } catch (const nlohmann::json::parse_error& error) {
      fail("byte " + std::to_string(error.byte), "is no JSON from here on");
    } catch (const nlohmann::json::exception&) {
      fail("", "is no JSON: a number in it is beyond float64");
    }
    if (!json_.is_object()) fail("", "holds " + found(json_) + ", not an object of keys");
  }
  std::uint64_t count(const char* key, std::uint64_t least, std::uint64_t most) const {
    const nlohmann::json& value = needed(key);
    const std::uint64_t number = value.is_number_unsigned() ? value.get<std::uint64_t>() : 0;
    if (!value.is_number_unsigned() || number < least || number > most) {
      fail(key, "is " + found(value) + ", not a count from " + std::to_string(least) + " to " + std::to_string(most));
    }
    return number;
  }
  std::string name(const char* key) const {
    const nlohmann::json& value = needed(key);
    if (!value.is_string() || value.get_ref<const std::string&>().empty())
      fail(key, "is " + found(value) + ", not a file's name");
    return value.get<std::string>();
  }
  double scale() const {
    const auto at = json_.find("scale");
    if (at == json_.end()) return 1;
    if (!at->is_number() || at->get<double>() == 0) fail("scale", "is " + found(*at) + ", not a number other than 0");
    return at->get<double>();
  }
  std::vector<double> times(std::uint64_t frames) const {
    std::vector<double> times;
    const auto at = json_.find("times");
    if (at == json_.end()) return times;
    if (!at->is_array()) fail("times", "is " + found(*at) + ", not an array of numbers");
    if (at->size() != frames) {
      fail("times", "has " + std::to_string(at->size()) + " times, but frames is " + std::to_string(frames));
    }
    for (const nlohmann::json& value : *at) {
      const std::string place = "times " + std::to_string(times.size());
      if (!value.is_number()) fail(place, "is " + found(value) + ", not a number");
      if (!times.empty() && value.get<double>() <= times.back())
        fail(place, "is " + found(value) + ", not later than the one before");
      times.push_back(value.get<double>());
    }
    return times;
  }

 private:
  // A value for messages: "-1", "a text", "an array", ….
  static std::string found(const nlohmann::json& value) {
    if (value.is_number() || value.is_boolean()) return value.dump();
    if (value.is_string()) return value.get_ref<const std::string&>().empty() ? "an empty text" : "a text";
    return value.is_null() ? "null" : value.is_array() ? "an array" : "an object";
  }
  const nlohmann::json& needed(const char* key) const {
    const auto at = json_.find(key);
    if (at == json_.end()) fail(key, "is missing");
    return *at;
  }
  // `key` may also be a place of another kind, or empty.
  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    const std::string place = key.empty() || key.starts_with("byte ") ? key : "key " + key;
    throw Error(FaultCode::kBadInput, path_, place, what, kKeys);
  }

  std::string path_;
  nlohmann::json json_;
};

Description describe(const std::string& path) {
  const Keys keys(path);
  Description d;
  d.vertices = keys.count("vertices", 1, std::uint64_t{1} << 32);
  d.triangles = keys.count("triangles", 1, std::uint64_t{1} << 40);
  d.frames = keys.count("frames", 1, kMaxFrames);
  d.triangles_file = keys.name("triangles_file");
  d.vertices_file = keys.name("vertices_file");
  d.scale = keys.scale();
  d.times = keys.times(d.frames);
  return d;
}

enum class Number { kI16, kF32, kF64 };

// By the name: "vertices.i16", "vertices.f32.gz".
Number numberOf(const std::string& name) {
  const fs::path stem = name.ends_with(".gz") ? fs::path(name).stem() : fs::path(name);
  if (stem.extension() == ".i16") return Number::kI16;
  if (stem.extension() == ".f32") return Number::kF32;
  if (stem.extension() == ".f64") return Number::kF64;
  throw Error(FaultCode::kBadInput, name, "", "its numbers are not told by its name",
              "call it X.f32, X.f64 or X.i16, with .gz behind if it is packed");
}

class ArrayFrames final : public SurfaceSource {
 public:
  ArrayFrames(const std::string& json, const SurfaceSourceOptions& options)
      : description_(describe(json)),
        vertices_((fs::path(json).parent_path() / description_.vertices_file).string()),
        number_(numberOf(description_.vertices_file)) {
    const std::uint64_t frame = description_.vertices * 3 * numberBytes();
    vertices_.expect(frame * description_.frames);
    info_.vertices = description_.vertices;
    info_.times = !options.times.empty()       ? options.times
                  : description_.times.empty() ? countedTimes(description_.frames, std::nullopt)
                                               : description_.times;
    checkGivenTimes(info_.times, description_.frames);
    readTriangles((fs::path(json).parent_path() / description_.triangles_file).string());
    info_.index_to_world = mapNear(readPoints(0));
  }
  void readFrame(std::size_t k, std::span<Vec3f> positions) override {
    const auto points = readPoints(k);
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i] = placed(points[i], info_.index_to_world, frameName(k), i);
  }
  std::string frameName(std::size_t k) const override { return vertices_.path() + " frame " + std::to_string(k); }

 private:
  std::uint64_t numberBytes() const { return number_ == Number::kI16 ? 2 : number_ == Number::kF32 ? 4 : 8; }

  template <class T>
  std::vector<std::array<double, 3>> readPointsAs(std::size_t k) {
    std::vector<std::array<T, 3>> raw(info_.vertices);
    vertices_.read(k * info_.vertices * sizeof(std::array<T, 3>), std::as_writable_bytes(std::span(raw)));
    std::vector<std::array<double, 3>> points(raw.size());
    for (std::size_t i = 0; i < raw.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) points[i][c] = static_cast<double>(raw[i][c]) * description_.scale;
    return points;
  }
  std::vector<std::array<double, 3>> readPoints(std::size_t k) {
    if (number_ == Number::kI16) return readPointsAs<std::int16_t>(k);
    return number_ == Number::kF32 ? readPointsAs<float>(k) : readPointsAs<double>(k);
  }
  void readTriangles(const std::string& path) {
    ArrayFile file(path);
    file.expect(description_.triangles * sizeof(info_.triangles[0]));
    info_.triangles.resize(description_.triangles);
    file.read(0, std::as_writable_bytes(std::span(info_.triangles)));
    for (std::size_t i = 0; i < info_.triangles.size(); ++i) {
      const auto& [a, b, c] = info_.triangles[i];
      const auto fail = [&](const char* what) {
        throw Error(FaultCode::kBadInput, path, "triangle " + std::to_string(i), what, "make the file again");
      };
      if (a >= info_.vertices || b >= info_.vertices || c >= info_.vertices) fail("names a vertex that is not there");
      if (a == b || b == c || c == a) fail("has a vertex twice");
    }
  }

  Description description_;
  ArrayFile vertices_;
  Number number_;
};

}  // namespace

std::unique_ptr<SurfaceSource> openSurfaceArrays(const std::string& json, const SurfaceSourceOptions& options) {
  return std::make_unique<ArrayFrames>(json, options);
}

}  // namespace tet4d::exchange
