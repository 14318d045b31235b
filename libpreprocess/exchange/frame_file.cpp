#include "libpreprocess/exchange/frame_file.h"

#include <algorithm>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/input_file.h"
#include "libpreprocess/exchange/read_metaimage.h"
#include "libpreprocess/exchange/read_nrrd.h"
#include "libpreprocess/exchange/read_raw.h"
#include "libpreprocess/exchange/read_vti.h"

namespace tet4d::exchange {
namespace {

template <class File>
std::unique_ptr<FrameFile> make(const std::string& path, const FrameFileOptions& options) {
  return std::make_unique<File>(path, options);
}

bool isNrrd(std::string_view head) { return head.starts_with("NRRD000"); }
bool isMetaImage(std::string_view head) {
  return head.starts_with("ObjectType") || (head.starts_with("NDims") && head.find('=') != std::string_view::npos);
}

std::unique_ptr<FrameFile> makeVti(const std::string& path, const FrameFileOptions& options) {
  return openVti(path, options.array);
}

bool isVtkXml(std::string_view head) { return head.find("<VTKFile") != head.npos; }

// A format: its suffixes, how a file of it begins, and its reader. A new one is a row here.
struct Format {
  std::string_view name;
  std::array<std::string_view, 2> suffixes;
  bool (*begins)(std::string_view head);  // of the file's first kHeadBytes
  std::unique_ptr<FrameFile> (*open)(const std::string& path, const FrameFileOptions& options);
};
constexpr std::size_t kHeadBytes = 256;
constexpr std::array<Format, 3> kFormats{{
    {"NRRD", {".nrrd", ".nhdr"}, isNrrd, make<NrrdFile>},
    {"VTK ImageData", {".vti"}, isVtkXml, makeVti},
    {"MetaImage", {".mha", ".mhd"}, isMetaImage, make<MetaImageFile>},
}};

bool hasSuffix(const Format& format, std::string_view path) {
  return std::any_of(format.suffixes.begin(), format.suffixes.end(),
                     [&](std::string_view suffix) { return !suffix.empty() && path.ends_with(suffix); });
}

const Format* formatBySuffix(std::string_view path) {
  const auto it = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& f) { return hasSuffix(f, path); });
  return it == kFormats.end() ? nullptr : it;
}

const Format* formatByHead(const std::string& path) {
  const InputFile file(path);
  std::array<char, kHeadBytes> head;
  const std::size_t got = file.readSome(0, std::as_writable_bytes(std::span(head)));
  const auto begins = [&](const Format& f) { return f.begins(std::string_view(head.data(), got)); };
  const auto it = std::find_if(kFormats.begin(), kFormats.end(), begins);
  return it == kFormats.end() ? nullptr : it;
}

}  // namespace

std::unique_ptr<FrameFile> openFrameFile(const std::string& path, const FrameFileOptions& options) {
  const Format* format = formatBySuffix(path);
  if (options.raw) {
    if (format == nullptr) return std::make_unique<RawFile>(path, *options.raw, options.centering);
    throw Error(FaultCode::kUsage, path, "",
                "--size is for raw files, but by its suffix this is a " + std::string(format->name) + " file",
                "leave --size out, or give the file another name");
  }
  if (format == nullptr) format = formatByHead(path);
  if (format != nullptr) return format->open(path, options);
  throw Error(FaultCode::kBadInput, path, "byte 0", "neither its suffix nor its first bytes are of a known format",
              "give one of " + frameSuffixes() + "; a raw file needs --size X,Y,Z and --type");
}

std::string sizeText(const GridInfo& grid) {
  return std::to_string(grid.dims[0]) + " x " + std::to_string(grid.dims[1]) + " x " + std::to_string(grid.dims[2]);
}

std::string_view frameFormatOf(const std::string& path) {
  const Format* format = formatBySuffix(path);
  return format == nullptr ? std::string_view() : format->name;
}

std::string frameSuffixes() {
  std::string text;
  for (const Format& format : kFormats) {
    for (const std::string_view suffix : format.suffixes) {
      if (!suffix.empty()) text.append(text.empty() ? "" : ", ").append(suffix);
    }
  }
  return text;
}

}  // namespace tet4d::exchange
