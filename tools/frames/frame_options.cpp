#include "tools/frames/frame_options.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/frame_view.h"
#include "tools/frames/option_text.h"

namespace tet4d::frames {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void failUsage(const std::string& option, const std::string& what, const std::string& remedy) {
  throw Error(FaultCode::kUsage, "", "option " + option, what, remedy);
}

std::optional<exchange::RawLayout> rawLayoutOf(const FrameOptions& options) {
  const std::pair<const char*, bool> given[] = {{"--type", !options.type.empty()},
                                                {"--byte-order", !options.byte_order.empty()},
                                                {"--spacing", !options.spacing.empty()},
                                                {"--origin", !options.origin.empty()},
                                                {"--skip", options.skip != 0}};
  if (options.size.empty()) {
    for (const auto& [option, is_given] : given) {
      if (is_given)
        failUsage(option, "describes raw files, which need --size", "give --size X,Y,Z too, or leave it out");
    }
    return std::nullopt;
  }
  if (options.type.empty())
    failUsage("--size", "the type of the samples is not given", "add --type, such as --type f32");
  exchange::RawLayout layout;
  layout.dims = countsOf("--size", options.size, false);
  layout.type = *sampleTypeOfName(options.type);
  layout.big_endian = options.byte_order == "big";
  if (!options.spacing.empty()) layout.spacing = numbersOf("--spacing", options.spacing, true);
  if (!options.origin.empty()) layout.origin = numbersOf("--origin", options.origin, false);
  layout.skip = options.skip;
  return layout;
}

exchange::FrameViewOptions viewOf(const FrameOptions& options) {
  exchange::FrameViewOptions view;
  if (!options.crop.empty()) view.crop = boxOf("--crop", options.crop);
  if (!options.stride.empty()) view.stride = countsOf("--stride", options.stride, true);
  view.frame_step = options.time_stride;
  if (options.range.empty()) return view;
  const SteppedRange range = steppedRangeOf("--frames", options.range);
  view.frames = range.range;
  if (view.frame_step > std::numeric_limits<std::uint64_t>::max() / range.step) {
    failUsage("--time-stride", "the step of --frames times --time-stride is over 2^64", "give smaller steps");
  }
  view.frame_step *= range.step;
  return view;
}

void nameDependencies(const std::vector<std::string>& inputs, const exchange::FrameSource& source,
                      cli::Session& session) {
  std::error_code ignored;
  for (const std::string& input : inputs)
    if (fs::is_regular_file(input, ignored)) session.dependsOn(input);
  // A directory or a pattern stands for the files its frames are called after.
  if (inputs.size() != 1 || source.isStream() || fs::is_regular_file(inputs[0], ignored)) return;
  for (std::size_t k = 0; k < source.times().size(); ++k)
    if (fs::is_regular_file(source.frameName(k), ignored)) session.dependsOn(source.frameName(k));
}

}  // namespace

std::vector<double> givenTimes(const std::string& argument, const std::string& flag, cli::Session& session) {
  std::error_code ignored;
  if (argument.empty() || !fs::is_regular_file(argument, ignored)) return timesOf(flag, argument, "");
  session.dependsOn(argument);
  std::ifstream in(argument, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  if (!in) throw Error(FaultCode::kIo, argument, "", "cannot be read", "check its permissions");
  return timesOf(flag, text, argument);
}

std::string volumeOption(const FrameOptions& options) {
  for (const auto& [name, value] : {std::pair{"--array", &options.array},
                                    {"--centering", &options.centering},
                                    {"--size", &options.size},
                                    {"--type", &options.type},
                                    {"--byte-order", &options.byte_order},
                                    {"--spacing", &options.spacing},
                                    {"--origin", &options.origin},
                                    {"--crop", &options.crop},
                                    {"--stride", &options.stride},
                                    {"--frames", &options.range}}) {
    if (!value->empty()) return name;
  }
  if (options.skip != 0) return "--skip";
  return options.time_stride != 1 ? "--time-stride" : "";
}

void addFrameOptions(cli::Command& command, FrameOptions& options, const std::string& times_flag) {
  const unsigned keeps = cli::kKeepsResult;
  command.heading("Frames")
      .option(times_flag, "TIMES", "world times of the frames instead of the files' own: T,T,... or a file of them",
              &options.times, keeps | cli::kIsInput)
      .flag("--allow-gaps", "accept a hole in the numbering of the files", &options.allow_gaps, keeps)
      .option("--array", "NAME", "which array of VTK files, a component as NAME:0; the active or only scalar otherwise",
              &options.array)
      .option("--centering", "WHERE", "where samples sit, if a NRRD does not tell or files are raw (default node)",
              cli::Choice{&options.centering, {"node", "cell"}}, keeps)
      .option("--crop", "X0:X1,Y0:Y1,Z0:Z1", "a box of samples; both ends are included, one left out is the grid's",
              &options.crop)
      .option("--stride", "N|X,Y,Z", "every n-th sample of the box", &options.stride)
      .option("--frames", "A:B[:STEP]", "frames A to B, both included", &options.range)
      .option("--time-stride", "N", "every n-th of the frames", &options.time_stride)
      .heading("Raw files")
      .option("--size", "X,Y,Z", "samples of a frame: the files are raw, x fastest", &options.size, keeps)
      .option("--type", "TYPE", "of the samples",
              cli::Choice{&options.type, {"u8", "i8", "u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64"}}, keeps)
      .option("--byte-order", "ORDER", "of the samples (default little)",
              cli::Choice{&options.byte_order, {"little", "big"}}, keeps)
      .option("--spacing", "D|X,Y,Z", "distance of samples in the world (default 1)", &options.spacing, keeps)
      .option("--origin", "X,Y,Z", "where the first sample is, or the corner of the first cell (default 0,0,0)",
              &options.origin, keeps)
      .option("--skip", "BYTES", "bytes in front of the samples in each file", &options.skip, keeps);
}

std::unique_ptr<exchange::FrameSource> openFrames(const std::vector<std::string>& inputs, const FrameOptions& options,
                                                  cli::Session& session, const std::string& times_flag) {
  exchange::FrameSourceOptions source_options;
  source_options.allow_gaps = options.allow_gaps;
  source_options.times = givenTimes(options.times, times_flag, session);
  source_options.file.raw = rawLayoutOf(options);
  source_options.file.array = options.array;
  if (!options.centering.empty()) {
    source_options.file.centering =
        options.centering == "cell" ? exchange::Centering::kCell : exchange::Centering::kNode;
  }
  const exchange::FrameViewOptions view = viewOf(options);
  auto source = exchange::viewFrames(exchange::openFrames(inputs, source_options), view);
  nameDependencies(inputs, *source, session);
  return source;
}

}  // namespace tet4d::frames
