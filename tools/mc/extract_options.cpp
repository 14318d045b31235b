#include "tools/mc/extract_options.h"

#include <algorithm>
#include <utility>

#include "libpreprocess/error.h"

namespace tet4d::mc {
namespace {

hypermesh::NanRule nanRuleOf(const std::string& word) {
  return word == "mask"    ? hypermesh::NanRule::kMask
         : word == "error" ? hypermesh::NanRule::kError
                           : hypermesh::NanRule::kOutside;
}

hypermesh::Normals normalsOf(const std::string& word) {
  return word == "tets"       ? hypermesh::Normals::kTets
         : word == "gradient" ? hypermesh::Normals::kGradient
                              : hypermesh::Normals::kNone;
}

// "NAME=FRAMES".
hypermesh::Field fieldOf(const std::string& text, const hypermesh::Options& options) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const auto bad = [&](const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kUsage, "", "option --field", "\"" + text + "\" " + what, remedy);
  };
  if (equals == std::string::npos || name.empty() || equals + 1 == text.size())
    bad("is not NAME=FRAMES", "write a name for the column, =, and the frames: --field temperature=t_%04d.nrrd");
  if (name.size() > 55) bad("has a name of more than 55 bytes", "give a shorter name");
  const auto columns = hypermesh::columnsOf(options);
  if (name == "normal" || name == "velocity" ||
      std::any_of(columns.begin(), columns.end(), [&](const auto& column) { return column.name == name; })) {
    bad("names a column that is there already", "give another name");
  }
  return {name, nullptr};
}

}  // namespace

std::string extractOption(const ExtractOptions& options) {
  for (const auto& [name, is_given] : {std::pair{"--iso", !options.isovalues.empty()},
                                       {"--split", options.split != "hull"},
                                       {"--nan", options.nan != "outside"},
                                       {"--normals", options.normals != "none"},
                                       {"--cap", options.cap},
                                       {"--velocity", options.velocity},
                                       {"--pad", options.pad != 0},
                                       {"--field", !options.fields.empty()}}) {
    if (is_given) return name;
  }
  return "";
}

void addExtractOptions(cli::Command& command, ExtractOptions& options) {
  command.heading("Surface")
      .option("--iso", "V[,V...]", "isovalue: samples at or above it are inside; several make several parts",
              &options.isovalues)
      .flag("--cap", "close the surface at the walls, as if all samples beyond were outside", &options.cap)
      .option("--pad", "N", "widen the grid by N layers of outside samples on every side; closes the surface as well",
              &options.pad)
      .option("--nan", "RULE", "what a NaN is: outside, a hole (mask), or an error",
              cli::Choice{&options.nan, {"outside", "mask", "error"}})
      .option("--split", "WAY",
              "how a hypercube is cut: by convex hulls, or into 24 pentatopes (5 times the tetrahedra)",
              cli::Choice{&options.split, {"hull", "kuhn"}})
      .heading("Columns")
      .option("--normals", "FROM",
              "store vertex normals: sums of the tetrahedra's, or the field's gradient (holds four frames, not two)",
              cli::Choice{&options.normals, {"none", "tets", "gradient"}})
      .flag("--velocity", "store the surface's velocity along its normal, from the same normals", &options.velocity)
      .option(
          "--field", "NAME=FRAMES",
          "store another field sampled on the surface; FRAMES as for the volumes, on the same grid; may be repeated",
          &options.fields, cli::kIsInput)
      .heading("Output")
      .option("--page-codec", "CODEC", "how pages are stored", cli::Choice{&options.codec, {"raw", "zstd"}});
}

Extraction extractionOf(const ExtractOptions& given, const frames::FrameOptions& frame_options, cli::Session& session) {
  if (given.isovalues.empty()) {
    throw Error(FaultCode::kUsage, "", "option --iso", "is not given, but frames of a volume need it",
                "give the value that separates inside from outside: --iso 0.5");
  }
  if (given.cap && given.pad > 0) {
    throw Error(FaultCode::kUsage, "", "option --cap", "is given beside --pad, which closes the surface as well",
                "leave one of them out");
  }
  Extraction extraction;
  hypermesh::Options& options = extraction.options;
  options.iso = given.isovalues.front();
  options.more_isos.assign(given.isovalues.begin() + 1, given.isovalues.end());
  options.split = given.split == "kuhn" ? hypermesh::Split::kKuhn : hypermesh::Split::kHull;
  options.nan = nanRuleOf(given.nan);
  options.pad = given.cap ? 1 : given.pad;
  options.normals = normalsOf(given.normals);
  options.velocity = given.velocity;
  options.page_codec = given.codec == "zstd" ? paged::Codec::kZstd : paged::Codec::kRaw;
  for (const std::string& text : given.fields) {
    hypermesh::Field field = fieldOf(text, options);
    const std::string input = text.substr(text.find('=') + 1);
    if (input == "-") {
      throw Error(FaultCode::kUsage, "", "option --field", "cannot come from standard input", "give files");
    }
    extraction.fields.push_back(frames::openFrames({input}, frame_options, session));
    field.frames = extraction.fields.back().get();
    options.fields.push_back(field);
  }
  return extraction;
}

}  // namespace tet4d::mc
