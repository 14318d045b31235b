#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "formats/grid4.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/file_series.h"
#include "libpreprocess/exchange/frame_series.h"
#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/exchange/frame_stream.h"
#include "libpreprocess/exchange/read_vti.h"

namespace tet4d::exchange {
namespace {

namespace fs = std::filesystem;

// The frames of a .t4g. Raw pages are mapped; of compressed ones the frame being read is in memory.
class Grid4Frames final : public FrameSource {
 public:
  Grid4Frames(grid4::File file, const std::vector<double>& times) : file_(std::move(file)) {
    const grid4::GridHeader& header = file_.header();
    std::copy(std::begin(header.dims), std::end(header.dims), grid_.dims.begin());
    grid_.type = static_cast<SampleType>(header.sample_type);
    grid_.index_to_world = header.index_to_world;
    times_ = times.empty() ? std::vector<double>(file_.times().begin(), file_.times().end()) : times;
  }
  const GridInfo& grid() const override { return grid_; }
  const std::vector<double>& times() const override { return times_; }
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    if (!page_ || page_number_ != k) load(k);
    const auto begin = static_cast<std::size_t>(z_begin * grid_.layerBytes());
    std::memcpy(samples.data(), page_->bytes().subspan(begin, samples.size()).data(), samples.size());
    if (z_end == grid_.dims[2]) page_.reset();
  }
  std::string frameName(std::size_t k) const override { return file_.reader().path() + " frame " + std::to_string(k); }

 private:
  void load(std::size_t k) {
    page_.reset();
    page_ = unwrap(file_.loadFrame(k));
    page_number_ = k;
    if (page_->bytes().size() == grid_.frameBytes()) return;
    const std::string held = std::to_string(page_->bytes().size());
    page_.reset();
    throw Error(FaultCode::kBadInput, file_.reader().path(), "page " + std::to_string(k),
                "holds " + held + " bytes, expected " + std::to_string(grid_.frameBytes()), "make the file again");
  }

  grid4::File file_;
  std::optional<paged::PageBytes> page_;  // of the frame that is being read
  std::size_t page_number_ = 0;
  GridInfo grid_;
  std::vector<double> times_;
};

std::unique_ptr<FrameSource> openGrid4(const std::string& path, const FrameSourceOptions& options) {
  grid4::File file = unwrap(grid4::File::open(path));
  if (!options.times.empty()) checkGivenTimes(options.times, file.times().size());
  return std::make_unique<Grid4Frames>(std::move(file), options.times);
}

// The files of a series at the times it tells, whatever they tell themselves.
std::unique_ptr<FrameSource> openPvd(const std::string& path, FrameSourceOptions options) {
  std::vector<std::string> names;
  std::vector<double> times;
  for (PvdStep& step : readPvd(path)) {
    names.push_back(std::move(step.file));
    times.push_back(step.time);
  }
  if (options.times.empty()) options.times = std::move(times);
  return openFileSeries(names, options);
}

}  // namespace

std::unique_ptr<FrameSource> openFrames(const std::vector<std::string>& inputs, const FrameSourceOptions& options) {
  if (inputs.empty()) throw Error(FaultCode::kUsage, "", "", "no frames are given", "name the frames' files");
  if (inputs.size() > 1) {
    if (std::find(inputs.begin(), inputs.end(), "-") != inputs.end()) {
      throw Error(FaultCode::kUsage, "-", "", "standard input brings all frames or none", "give \"-\" alone, or files");
    }
    return openFileSeries(inputs, options);
  }
  const std::string& input = inputs.front();
  if (input == "-") return openFrameStream(STDIN_FILENO, "standard input", options);
  std::error_code ignored;
  if (fs::is_directory(input, ignored)) {
    const auto files = filesOfDirectory(input, options.file.raw.has_value());
    return files.size() == 1 ? openFileMovie(openFrameFile(files.front(), options.file), options)
                             : openFileSeries(files, options);
  }
  if (input.ends_with(".t4g")) return openGrid4(input, options);
  if (input.ends_with(".pvd")) return openPvd(input, options);
  if (!fs::exists(input, ignored) && input.find('%') != std::string::npos) {
    return openFileSeries(filesOfPattern(input), options);
  }
  return openFileMovie(openFrameFile(input, options.file), options);
}

}  // namespace tet4d::exchange
