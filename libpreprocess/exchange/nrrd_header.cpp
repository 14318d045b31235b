#include "libpreprocess/exchange/nrrd_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
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

NrrdEncoding readEncoding(const NrrdFields& fields) {
  const NrrdField& field = fields.need("encoding");
  if (field.text == "raw") return NrrdEncoding::kRaw;
  if (field.text == "gzip" || field.text == "gz") return NrrdEncoding::kGzip;
  fields.fail(field, "the encoding " + inQuotes(field.text) + " is not read here, raw and gzip are",
              "encode it again: unu save -f nrrd -e gzip -i IN -o OUT");
}

bool readSwap(const NrrdFields& fields, SampleType type) {
  if (sampleBytes(type) == 1) return false;
  const NrrdField& field = fields.need("endian");
  if (field.text != "little" && field.text != "big") {
    fields.fail(field, "endian is " + inQuotes(field.text) + ", expected little or big", "correct \"endian\"");
  }
  return (field.text == "big") != (std::endian::native == std::endian::big);
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

void readSkips(const NrrdFields& fields, NrrdData& data) {
  if (const NrrdField* field = fields.find("line skip")) {
    const auto lines = nrrdCount(field->text);
    if (!lines) fields.fail(*field, inQuotes(field->text) + " is no count of lines", "write a number from 0 on");
    data.line_skip = *lines;
  }
  if (const NrrdField* field = fields.find("byte skip")) {
    const auto bytes = nrrdInteger(field->text);
    if (!bytes || *bytes < -1) {
      fields.fail(*field, inQuotes(field->text) + " is no count of bytes", "write a number from 0 on, or -1");
    }
    if (*bytes == -1 && data.encoding != NrrdEncoding::kRaw) {
      fields.fail(*field, "-1 is for raw data only: the end of compressed data is not known",
                  "write the count of bytes");
    }
    data.byte_skip = *bytes;
  }
}

std::string besideHeader(const std::string& header_path, const std::string& name) {
  const std::filesystem::path path(name);
  return path.is_absolute() ? name : (std::filesystem::path(header_path).parent_path() / path).string();
}

// "PATTERN MIN MAX STEP [SUBDIM]"; returns the subdimension, 0 if there is none.
std::uint64_t readPattern(const NrrdFields& fields, const NrrdField& field, const std::vector<std::string>& words,
                          NrrdData& data) {
  constexpr std::int64_t kMost = std::int64_t{1} << 50;  // far from any overflow below
  const auto min = nrrdInteger(words[1]), max = nrrdInteger(words[2]), step = nrrdInteger(words[3]);
  const auto subdimension = words.size() == 5 ? nrrdCount(words[4]) : std::optional<std::uint64_t>(0);
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

void readDataFiles(const NrrdFields& fields, const NrrdAxes& axes, NrrdData& data) {
  const NrrdField* field = fields.find("data file");
  if (field == nullptr) {
    data.attached_at = fields.header_bytes;
    return;
  }
  data.attached = false;
  const auto words = nrrdWords(field->text);
  if (words.empty()) fields.fail(*field, "no file is named", "write the data file's name");
  if (words[0] == "LIST") {
    const auto subdimension = words.size() == 2 ? nrrdCount(words[1]) : std::optional<std::uint64_t>(0);
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

// The samples' bytes must be there: exactly for raw data; deflate makes at most 1032 bytes of one.
void checkDataFile(const std::string& header_path, const NrrdData& data, std::uint64_t k) {
  const InputFile file(data.fileName(header_path, k));
  const std::uint64_t begin = nrrdDataOffset(file, data);
  const std::uint64_t held = file.size() - std::min(begin, file.size());
  const bool gzip = data.encoding == NrrdEncoding::kGzip;
  constexpr std::uint64_t kMostOfOneByte = 1032;
  if (gzip ? data.file_bytes / kMostOfOneByte > held : data.file_bytes > held) {
    throw Error(FaultCode::kBadInput, file.path(), "byte " + std::to_string(file.size()),
                "the file is short: it holds " + std::to_string(held) + (gzip ? " compressed" : "") +
                    " bytes of samples, but the header's sizes ask for " + std::to_string(data.file_bytes),
                "copy or make the file again, or correct the sizes");
  }
  if (!gzip && data.attached && data.byte_skip != -1 && held > data.file_bytes) {
    throw Error(FaultCode::kBadInput, file.path(), "byte " + std::to_string(begin + data.file_bytes),
                "the file goes on for " + std::to_string(held - data.file_bytes) +
                    " bytes after the samples that the header's sizes ask for",
                "correct \"sizes\" or \"type\" in the header");
  }
}

}  // namespace

std::string NrrdData::fileName(const std::string& header_path, std::uint64_t k) const {
  if (attached) return header_path;
  if (pattern.empty()) return names[static_cast<std::size_t>(k)];
  return besideHeader(header_path,
                      NumberPattern::parse(pattern)->name(pattern_min + static_cast<std::int64_t>(k) * pattern_step));
}

std::uint64_t nrrdDataOffset(const InputFile& file, const NrrdData& data) {
  if (data.byte_skip == -1) return file.size() - std::min(file.size(), data.file_bytes);
  std::uint64_t at = data.attached ? data.attached_at : 0;
  std::vector<char> buffer(std::size_t{1} << 16);
  for (std::uint64_t lines = 0; lines < data.line_skip;) {
    const std::size_t got = file.readSome(at, std::as_writable_bytes(std::span(buffer)));
    if (got == 0) {
      throw Error(FaultCode::kBadInput, file.path(), "byte " + std::to_string(file.size()),
                  "the file ends after " + std::to_string(lines) + " lines, but \"line skip\" is " +
                      std::to_string(data.line_skip),
                  "correct \"line skip\" in the header");
    }
    const std::string_view text(buffer.data(), got);
    std::size_t used = 0;
    for (; lines < data.line_skip; ++lines) {
      const std::size_t end = text.find('\n', used);
      if (end == std::string_view::npos) break;
      used = end + 1;
    }
    at += lines < data.line_skip ? got : used;
  }
  // In compressed data bytes are skipped after decoding.
  return data.encoding == NrrdEncoding::kRaw ? at + static_cast<std::uint64_t>(data.byte_skip) : at;
}

NrrdHeader readNrrdHeader(const std::string& path) {
  const InputFile file(path);
  const NrrdFields fields = readNrrdFields(file);
  NrrdHeader header;
  header.path = path;
  const NrrdAxes axes = readNrrdAxes(fields);
  header.grid.dims = axes.dims;
  header.grid.type = readType(fields);
  header.grid.index_to_world = axes.index_to_world;
  header.has_frame_axis = axes.has_frame_axis;
  header.frames = axes.frames;

  NrrdData& data = header.data;
  data.encoding = readEncoding(fields);
  data.swap_bytes = readSwap(fields, header.grid.type);
  const std::uint64_t total = totalBytes(fields, axes, header.grid.type);
  readSkips(fields, data);
  readDataFiles(fields, axes, data);
  data.file_bytes = total / data.files;
  for (std::uint64_t k = 0; k < data.files; ++k) checkDataFile(path, data, k);

  header.times = readNrrdTimes(fields, axes);
  return header;
}

}  // namespace tet4d::exchange
