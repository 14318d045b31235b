#include "libpreprocess/exchange/metaimage_header.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/metaimage_fields.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/printf_pattern.h"

namespace tet4d::exchange {
namespace {

struct TypeName {
  std::string_view name;
  SampleType type;
};
// MET_LONG has 4 bytes in a file, whatever a C long has.
constexpr std::array<TypeName, 12> kTypeNames{{
    {"MET_CHAR", SampleType::kI8},
    {"MET_UCHAR", SampleType::kU8},
    {"MET_SHORT", SampleType::kI16},
    {"MET_USHORT", SampleType::kU16},
    {"MET_INT", SampleType::kI32},
    {"MET_UINT", SampleType::kU32},
    {"MET_LONG", SampleType::kI32},
    {"MET_ULONG", SampleType::kU32},
    {"MET_LONG_LONG", SampleType::kI64},
    {"MET_ULONG_LONG", SampleType::kU64},
    {"MET_FLOAT", SampleType::kF32},
    {"MET_DOUBLE", SampleType::kF64},
}};

SampleType readType(const MetaImageFields& fields) {
  const MetaImageField& field = fields.need("ElementType");
  if (const MetaImageField* channels = fields.find("ElementNumberOfChannels"); channels && channels->text != "1") {
    fields.fail(*channels, inQuotes(channels->text) + " values a sample, expected 1", "choose one channel");
  }
  for (const TypeName& row : kTypeNames) {
    if (row.name == field.text) return row.type;
  }
  fields.fail(field, "samples of type " + inQuotes(field.text) + " are not read",
              "convert to an integer or floating point type such as MET_FLOAT");
}

std::size_t readDimension(const MetaImageFields& fields) {
  if (const MetaImageField* kind = fields.find("ObjectType"); kind && kind->text != "Image") {
    fields.fail(*kind, "the object is " + inQuotes(kind->text) + ", expected Image", "give a MetaImage");
  }
  const MetaImageField& field = fields.need("NDims");
  if (field.text == "3") return 3;
  if (field.text == "4") return 4;
  fields.fail(field, "NDims is " + inQuotes(field.text) + ", expected 3 (a frame) or 4 (frames along the last axis)",
              "give one 3D file a frame, or one 4D file");
}

// DimSize, and that the array fits; its bytes.
std::uint64_t readSizes(const MetaImageFields& fields, std::size_t dimension, MetaImageHeader& header) {
  const MetaImageField& field = fields.need("DimSize");
  const auto words = wordsOf(field.text);
  if (words.size() != dimension) {
    fields.fail(field,
                "DimSize has " + std::to_string(words.size()) + " sizes, but NDims is " + std::to_string(dimension),
                "give one size an axis");
  }
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  std::uint64_t bytes = sampleBytes(header.grid.type);
  for (std::size_t a = 0; a < dimension; ++a) {
    const auto size = countOf(words[a]);
    if (!size || *size == 0) {
      fields.fail(field, "the size " + inQuotes(words[a]) + " is no number from 1 on", "correct \"DimSize\"");
    }
    if (bytes > kMost / *size) {
      fields.fail(field, "the product of the sizes is over 2^63 bytes", "correct \"DimSize\"");
    }
    bytes *= *size;
    (a < 3 ? header.grid.dims[a] : header.frames) = *size;
  }
  if (header.frames > kMaxFrames) {
    fields.fail(field,
                std::to_string(header.frames) + " frames, at most " + std::to_string(kMaxFrames) +
                    " can be told apart in float32",
                "divide the sequence");
  }
  return bytes;
}

// Positions along every axis, time's too.
struct Positions {
  std::vector<double> offset, spacing, matrix;  // matrix: row i is the direction of axis i
  bool tells_time = false;
};

Positions readPositions(const MetaImageFields& fields, std::size_t dimension) {
  Positions at;
  const auto read = [&](const std::vector<std::string>& keys, std::size_t count, double otherwise) {
    const MetaImageField* field = fields.findAny(keys);
    return field != nullptr ? fields.numbers(*field, count) : std::vector<double>(count, otherwise);
  };
  at.offset = read({"Offset", "Position", "Origin", "ImagePosition"}, dimension, 0);
  at.spacing = read({"ElementSpacing", "ElementSize"}, dimension, 1);
  at.tells_time = dimension == 4 && fields.findAny({"ElementSpacing", "ElementSize", "Offset", "Position", "Origin"});
  at.matrix = read({"TransformMatrix", "Rotation", "Orientation"}, dimension * dimension, 0);
  const MetaImageField* matrix = fields.findAny({"TransformMatrix", "Rotation", "Orientation"});
  for (std::size_t i = 0; i < dimension; ++i) {
    if (matrix == nullptr) at.matrix[i * dimension + i] = 1;
    if (at.spacing[i] == 0) {
      const MetaImageField& field = *fields.findAny({"ElementSpacing", "ElementSize"});
      fields.fail(field, field.key + " of axis " + std::to_string(i) + " is 0", "correct \"" + field.key + "\"");
    }
    if (dimension == 4 && i < 3 && (at.matrix[4 * i + 3] != 0 || at.matrix[12 + i] != 0)) {
      fields.fail(*matrix, "axis " + std::to_string(i) + " runs through space and time at once",
                  "the last row and column of the matrix must be 0 0 0 1");
    }
  }
  return at;
}

AffineMap mapOf(const MetaImageFields& fields, const Positions& at, std::size_t dimension) {
  AffineMap map;
  for (std::size_t c = 0; c < 3; ++c) {
    map.origin[c] = at.offset[c];
    for (std::size_t i = 0; i < 3; ++i) map.axes[c][i] = at.matrix[c * dimension + i] * at.spacing[c];
  }
  if (!isUsable(map)) {
    throw Error(FaultCode::kBadInput, fields.path, "header", "the axes of the grid are not finite, or lie in a plane",
                "correct \"TransformMatrix\", \"Offset\" or \"ElementSpacing\"");
  }
  return map;
}

std::vector<double> timesOf(const MetaImageFields& fields, const Positions& at, std::uint64_t frames) {
  std::vector<double> times;
  if (!at.tells_time) return times;
  for (std::uint64_t k = 0; k < frames; ++k) {
    times.push_back(at.offset[3] + static_cast<double>(k) * (at.spacing[3] * at.matrix[15]));
    if (std::isfinite(times[k]) && (k == 0 || times[k] > times[k - 1])) continue;
    throw Error(FaultCode::kBadInput, fields.path, "frame " + std::to_string(k),
                "its time " + numberText(times[k]) + " does not come after the time of the frame before",
                "correct the last entry of \"ElementSpacing\" or \"Offset\"");
  }
  return times;
}

// "PATTERN [MIN [MAX [STEP]]]": numbers of files, one a slice of the last axis.
void readPattern(const MetaImageFields& fields, const MetaImageField& field, const std::vector<std::string>& words,
                 std::uint64_t slices, SampleFiles& data) {
  constexpr std::int64_t kMost = std::int64_t{1} << 50;  // far from any overflow below
  const auto bad = [&](const std::string& what) {
    fields.fail(field, what + ", found " + inQuotes(field.text), "correct \"ElementDataFile\"");
  };
  std::array<std::int64_t, 3> numbers{1, 0, 1};  // min, max, step
  for (std::size_t i = 1; i < words.size() && i < 4; ++i) {
    const auto number = integerOf(words[i]);
    if (!number || *number <= -kMost || *number >= kMost) bad("expected \"PATTERN MIN MAX STEP\"");
    numbers[i - 1] = *number;
  }
  const auto count = static_cast<std::int64_t>(slices);
  if (words.size() < 3) numbers[1] = numbers[0] + (count - 1);
  if (words.size() == 3 && count > 1) numbers[2] = (numbers[1] - numbers[0]) / (count - 1);
  const auto [min, max, step] = numbers;
  if (words.size() > 4 || !NumberPattern::parse(words[0]) || step <= 0) {
    bad("expected \"PATTERN MIN MAX STEP\" with one %d in the pattern and a step above 0");
  }
  if (max < min || (max - min) / step + 1 != count) {
    bad("expected numbers for " + std::to_string(slices) + " files, one a slice of the last axis");
  }
  data.pattern = words[0];
  data.pattern_min = min;
  data.pattern_step = step;
  data.files = slices;
}

// The files after LIST; "LIST 2D" says how many axes one of them has.
void readList(const MetaImageFields& fields, const MetaImageField& field, const std::vector<std::string>& words,
              const std::vector<std::uint64_t>& sizes, SampleFiles& data) {
  std::uint64_t axes = sizes.size() - 1;
  if (words.size() > 1) {
    const std::string& word = words[1];
    const auto given = countOf(word.ends_with("D") ? word.substr(0, word.size() - 1) : word);
    if (!given || *given == 0 || words.size() > 2) {
      fields.fail(field, "expected \"LIST\" or \"LIST 2D\", found " + inQuotes(field.text),
                  "correct \"ElementDataFile\"");
    }
    if (*given <= sizes.size()) axes = *given;
  }
  std::uint64_t expected = 1;
  for (std::size_t a = static_cast<std::size_t>(axes); a < sizes.size(); ++a) expected *= sizes[a];
  if (fields.listed_files.size() != expected) {
    fields.fail(field,
                std::to_string(fields.listed_files.size()) + " files are listed, but DimSize asks for " +
                    std::to_string(expected),
                "correct the list or \"DimSize\"");
  }
  for (const std::string& name : fields.listed_files) data.names.push_back(besideHeader(fields.path, name));
  data.files = expected;
}

void readDataFiles(const MetaImageFields& fields, const std::vector<std::uint64_t>& sizes, SampleFiles& data) {
  const MetaImageField& field = fields.need("ElementDataFile");
  const auto words = wordsOf(field.text);
  if (words.empty()) fields.fail(field, "no file is named", "write LOCAL or the data file's name");
  if (field.text == "LOCAL" || field.text == "Local" || field.text == "local") {
    data.begin = fields.header_bytes;
    return;
  }
  data.attached = false;
  if (words[0] == "LIST") {
    readList(fields, field, words, sizes, data);
  } else if (words[0].find('%') != std::string::npos) {
    readPattern(fields, field, words, sizes.back(), data);
  } else {
    data.names.push_back(besideHeader(fields.path, field.text));
  }
}

// HeaderSize counts from the beginning of a data file; -1 says that the data are its end.
void readHeaderSize(const MetaImageFields& fields, SampleFiles& data) {
  const MetaImageField* field = fields.find("HeaderSize");
  if (field == nullptr || field->text == "0") return;
  const auto bytes = integerOf(field->text);
  if (!bytes || *bytes < -1) {
    fields.fail(*field, inQuotes(field->text) + " is no count of bytes", "write a number from 0 on, or -1");
  }
  if (*bytes == -1) {
    if (data.packing != Packing::kNone) {
      fields.fail(*field, "-1 is for data that are not compressed: the end of others is not known",
                  "write the count of bytes");
    }
    data.byte_skip = -1;
    return;
  }
  const auto begin = static_cast<std::uint64_t>(*bytes);
  if (begin < data.begin) {
    fields.fail(*field,
                "HeaderSize is " + field->text + ", but the header has " + std::to_string(data.begin) + " bytes",
                "correct \"HeaderSize\", or leave it out");
  }
  data.begin = begin;
}

}  // namespace

MetaImageHeader readMetaImageHeader(const std::string& path) {
  const InputFile file(path);
  ByteStream bytes(file);
  const MetaImageFields fields = readMetaImageFields(bytes, path);
  MetaImageHeader header;
  header.path = path;
  const std::size_t dimension = readDimension(fields);
  header.has_frame_axis = dimension == 4;
  header.grid.type = readType(fields);
  const std::uint64_t total = readSizes(fields, dimension, header);
  const Positions at = readPositions(fields, dimension);
  header.grid.index_to_world = mapOf(fields, at, dimension);

  if (!fields.flag("BinaryData", true)) {
    fields.fail(*fields.find("BinaryData"), "numbers as text are not read", "write the file again in binary");
  }
  SampleFiles& data = header.data;
  data.header_path = path;
  data.packing = fields.flag("CompressedData", false) ? Packing::kGzipOrZlib : Packing::kNone;
  const bool big_endian = fields.flag("BinaryDataByteOrderMSB", fields.flag("ElementByteOrderMSB", false));
  data.swap_bytes = sampleBytes(header.grid.type) > 1 && isOtherByteOrder(big_endian);
  std::vector<std::uint64_t> sizes(header.grid.dims.begin(), header.grid.dims.end());
  if (header.has_frame_axis) sizes.push_back(header.frames);
  readDataFiles(fields, sizes, data);
  readHeaderSize(fields, data);
  data.file_bytes = total / data.files;
  for (std::uint64_t k = 0; k < data.files; ++k) checkSampleFile(data, k);
  header.times = timesOf(fields, at, header.frames);
  return header;
}

}  // namespace tet4d::exchange
