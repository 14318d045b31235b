#include "libpreprocess/exchange/nrrd_header.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/nrrd_axes.h"
#include "libpreprocess/exchange/printf_pattern.h"

namespace tet4d::exchange {
namespace {

struct TypeName {
  std::string_view name;
  SampleType type;
};
constexpr std::array<TypeName, 40> kTypeNames{{
    {"signed char", SampleType::kI8},
    {"int8", SampleType::kI8},
    {"int8_t", SampleType::kI8},
    {"uchar", SampleType::kU8},
    {"unsigned char", SampleType::kU8},
    {"uint8", SampleType::kU8},
    {"uint8_t", SampleType::kU8},
    {"short", SampleType::kI16},
    {"short int", SampleType::kI16},
    {"signed short", SampleType::kI16},
    {"signed short int", SampleType::kI16},
    {"int16", SampleType::kI16},
    {"int16_t", SampleType::kI16},
    {"ushort", SampleType::kU16},
    {"unsigned short", SampleType::kU16},
    {"unsigned short int", SampleType::kU16},
    {"uint16", SampleType::kU16},
    {"uint16_t", SampleType::kU16},
    {"int", SampleType::kI32},
    {"signed int", SampleType::kI32},
    {"int32", SampleType::kI32},
    {"int32_t", SampleType::kI32},
    {"uint", SampleType::kU32},
    {"unsigned int", SampleType::kU32},
    {"uint32", SampleType::kU32},
    {"uint32_t", SampleType::kU32},
    {"longlong", SampleType::kI64},
    {"long long", SampleType::kI64},
    {"long long int", SampleType::kI64},
    {"signed long long", SampleType::kI64},
    {"signed long long int", SampleType::kI64},
    {"int64", SampleType::kI64},
    {"int64_t", SampleType::kI64},
    {"ulonglong", SampleType::kU64},
    {"unsigned long long", SampleType::kU64},
    {"unsigned long long int", SampleType::kU64},
    {"uint64", SampleType::kU64},
    {"uint64_t", SampleType::kU64},
    {"float", SampleType::kF32},
    {"double", SampleType::kF64},
}};

SampleType readType(const NrrdFields& fields) {
  const NrrdField& field = fields.need("type");
  for (const TypeName& row : kTypeNames) {
    if (row.name == field.text) return row.type;
  }
  const bool block = field.text == "block";
  fields.fail(field, "samples of type " + inQuotes(field.text) + " are " + (block ? "opaque" : "unknown"),
              "convert to an integer or floating point type (unu convert -t float)");
}

Packing readEncoding(const NrrdFields& fields) {
  const NrrdField& field = fields.need("encoding");
  if (field.text == "raw") return Packing::kNone;
  if (field.text == "gzip" || field.text == "gz") return Packing::kGzip;
  fields.fail(field, "the encoding " + inQuotes(field.text) + " is not read here, raw and gzip are",
              "encode it again: unu save -f nrrd -e gzip -i IN -o OUT");
}

bool readSwap(const NrrdFields& fields, SampleType type) {
  if (sampleBytes(type) == 1) return false;
  const NrrdField& field = fields.need("endian");
  if (field.text != "little" && field.text != "big") {
    fields.fail(field, "endian is " + inQuotes(field.text) + ", expected little or big", "correct \"endian\"");
  }
  return isOtherByteOrder(field.text == "big");
}

std::uint64_t checkedProduct(const NrrdFields& fields, std::uint64_t a, std::uint64_t b) {
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (b != 0 && a > kMost / b) {
    fields.fail(fields.need("sizes"), "the product of the sizes is over 2^63 bytes", "correct \"sizes\"");
  }
  return a * b;
}

std::uint64_t totalBytes(const NrrdFields& fields, const NrrdAxes& axes, SampleType type) {
  std::uint64_t total = sampleBytes(type);
  for (const std::uint64_t size : axes.sizes) total = checkedProduct(fields, total, size);
  return total;
}

void readSkips(const NrrdFields& fields, SampleFiles& data) {
  if (const NrrdField* field = fields.find("line skip")) {
    const auto lines = countOf(field->text);
    if (!lines) fields.fail(*field, inQuotes(field->text) + " is no count of lines", "write a number from 0 on");
    data.line_skip = *lines;
  }
  if (const NrrdField* field = fields.find("byte skip")) {
    const auto bytes = integerOf(field->text);
    if (!bytes || *bytes < -1) {
      fields.fail(*field, inQuotes(field->text) + " is no count of bytes", "write a number from 0 on, or -1");
    }
    if (*bytes == -1 && data.packing != Packing::kNone) {
      fields.fail(*field, "-1 is for raw data only: the end of compressed data is not known",
                  "write the count of bytes");
    }
    data.byte_skip = *bytes;
  }
}

// "PATTERN MIN MAX STEP [SUBDIM]"; returns the subdimension, 0 if there is none.
std::uint64_t readPattern(const NrrdFields& fields, const NrrdField& field, const std::vector<std::string>& words,
                          SampleFiles& data) {
  constexpr std::int64_t kMost = std::int64_t{1} << 50;  // far from any overflow below
  const auto min = integerOf(words[1]), max = integerOf(words[2]), step = integerOf(words[3]);
  const auto subdimension = words.size() == 5 ? countOf(words[4]) : std::optional<std::uint64_t>(0);
  const auto small = [](const auto& number) { return number && *number > -kMost && *number < kMost; };
  const bool ok = small(min) && small(max) && small(step) && *step != 0 && (*max - *min) / *step >= 0 && subdimension &&
                  ((*max >= *min) == (*step > 0) || *max == *min) && NumberPattern::parse(words[0]);
  if (!ok) {
    fields.fail(field, "expected \"PATTERN MIN MAX STEP\" with one %d in the pattern, found " + inQuotes(field.text),
                "correct \"data file\"");
  }
  data.pattern = words[0];
  data.pattern_min = *min;
  data.pattern_step = *step;
  data.files = static_cast<std::uint64_t>((*max - *min) / *step) + 1;
  return *subdimension;
}

// How many files there are must follow from the sizes: one a slice of `subdimension` axes, or equal parts of the last
// axis.
void checkFileCount(const NrrdFields& fields, const NrrdField& field, const NrrdAxes& axes, std::uint64_t subdimension,
                    std::uint64_t files) {
  const std::size_t dimension = axes.sizes.size();
  if (subdimension > dimension) {
    fields.fail(field, "subdimension " + std::to_string(subdimension) + " of " + std::to_string(dimension) + " axes",
                "correct \"data file\"");
  }
  if (subdimension == 0) subdimension = dimension - 1;
  std::uint64_t expected = 1;
  for (std::size_t a = static_cast<std::size_t>(subdimension); a < dimension; ++a) expected *= axes.sizes[a];
  const bool ok = subdimension == dimension ? axes.sizes.back() % files == 0 : expected == files;
  if (ok) return;
  fields.fail(
      field,
      std::to_string(files) + " data files, but the sizes ask for " +
          (subdimension == dimension ? "a divisor of " + std::to_string(axes.sizes.back()) : std::to_string(expected)),
      "correct \"sizes\" or \"data file\"");
}

void readDataFiles(const NrrdFields& fields, const NrrdAxes& axes, SampleFiles& data) {
  const NrrdField* field = fields.find("data file");
  if (field == nullptr) {
    data.begin = fields.header_bytes;
    return;
  }
  data.attached = false;
  const auto words = wordsOf(field->text);
  if (words.empty()) fields.fail(*field, "no file is named", "write the data file's name");
  if (words[0] == "LIST") {
    const auto subdimension = words.size() == 2 ? countOf(words[1]) : std::optional<std::uint64_t>(0);
    if (!subdimension || words.size() > 2 || fields.listed_files.empty()) {
      fields.fail(*field, "expected \"LIST\" and then one file name a line", "correct \"data file\"");
    }
    for (const std::string& name : fields.listed_files) data.names.push_back(besideHeader(fields.path, name));
    data.files = data.names.size();
    checkFileCount(fields, *field, axes, *subdimension, data.files);
  } else if ((words.size() == 4 || words.size() == 5) && words[0].find('%') != std::string::npos) {
    const std::uint64_t subdimension = readPattern(fields, *field, words, data);
    checkFileCount(fields, *field, axes, subdimension, data.files);
  } else {
    data.names.push_back(besideHeader(fields.path, field->text));
  }
}

}  // namespace

NrrdHeader nrrdHeaderOf(const NrrdFields& fields, Centering centering) {
  NrrdHeader header;
  header.path = fields.path;
  const NrrdAxes axes = readNrrdAxes(fields, centering);
  header.grid.dims = axes.dims;
  header.grid.type = readType(fields);
  header.grid.index_to_world = axes.index_to_world;
  header.has_frame_axis = axes.has_frame_axis;
  header.frames = axes.frames;

  SampleFiles& data = header.data;
  data.header_path = fields.path;
  data.packing = readEncoding(fields);
  data.swap_bytes = readSwap(fields, header.grid.type);
  const std::uint64_t total = totalBytes(fields, axes, header.grid.type);
  readSkips(fields, data);
  readDataFiles(fields, axes, data);
  data.file_bytes = total / data.files;
  return header;
}

NrrdHeader readNrrdHeader(const std::string& path, Centering centering) {
  const InputFile file(path);
  ByteStream bytes(file);
  const NrrdFields fields = readNrrdFields(bytes, path);
  NrrdHeader header = nrrdHeaderOf(fields, centering);
  for (std::uint64_t k = 0; k < header.data.files; ++k) checkSampleFile(header.data, k);
  header.times = readNrrdTimes(fields, readNrrdAxes(fields, centering));
  return header;
}

}  // namespace tet4d::exchange
