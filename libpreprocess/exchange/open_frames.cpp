#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "formats/grid4.h"
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/file_series.h"
#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/read_nrrd.h"

namespace tet4d::exchange {
namespace {

namespace fs = std::filesystem;

// One file a frame. Headers stay, data files are open only while a frame is read.
class NrrdSeries final : public FrameSource {
 public:
  NrrdSeries(std::vector<NrrdFile> files, std::vector<double> times)
      : files_(std::move(files)), times_(std::move(times)) {}
  const GridInfo& grid() const override { return files_.front().header().grid; }
  const std::vector<double>& times() const override { return times_; }
  void readFrame(std::size_t k, std::span<std::byte> samples) override {
    files_[k].readFrame(0, samples);
    files_[k].close();
  }
  std::string frameName(std::size_t k) const override { return files_[k].header().path; }

 private:
  std::vector<NrrdFile> files_;
  std::vector<double> times_;
};

// All frames in one file.
class NrrdMovie final : public FrameSource {
 public:
  NrrdMovie(NrrdFile file, std::vector<double> times) : file_(std::move(file)), times_(std::move(times)) {}
  const GridInfo& grid() const override { return file_.header().grid; }
  const std::vector<double>& times() const override { return times_; }
  void readFrame(std::size_t k, std::span<std::byte> samples) override { file_.readFrame(k, samples); }
  std::string frameName(std::size_t k) const override { return file_.header().path + " frame " + std::to_string(k); }

 private:
  NrrdFile file_;
  std::vector<double> times_;
};

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
  void readFrame(std::size_t k, std::span<std::byte> samples) override {
    const paged::PageBytes page = unwrap(file_.loadFrame(k));
    if (page.bytes().size() != samples.size()) {
      throw Error(FaultCode::kBadInput, file_.reader().path(), "page " + std::to_string(k),
                  "holds " + std::to_string(page.bytes().size()) + " bytes, expected " + std::to_string(samples.size()),
                  "make the file again");
    }
    std::memcpy(samples.data(), page.bytes().data(), samples.size());
  }
  std::string frameName(std::size_t k) const override { return file_.reader().path() + " frame " + std::to_string(k); }

 private:
  grid4::File file_;
  GridInfo grid_;
  std::vector<double> times_;
};

std::string sizeText(const GridInfo& grid) {
  return std::to_string(grid.dims[0]) + " x " + std::to_string(grid.dims[1]) + " x " + std::to_string(grid.dims[2]);
}

// Equal but for the last digits of a decimal text.
bool nearlyEqual(const AffineMap& a, const AffineMap& b) {
  double cell = 0;
  for (const auto& axis : a.axes) cell = std::max(cell, std::hypot(axis[0], axis[1], axis[2]));
  double distance = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    distance = std::max(distance, std::abs(a.origin[c] - b.origin[c]));
    for (std::size_t i = 0; i < 3; ++i) distance = std::max(distance, std::abs(a.axes[c][i] - b.axes[c][i]));
  }
  return distance <= 1e-6 * cell;
}

void checkSameGrid(const NrrdHeader& first, const NrrdHeader& other) {
  const auto fail = [&](const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kBadInput, other.path, "header", what, remedy);
  };
  if (other.grid.dims != first.grid.dims) {
    fail("the size is " + sizeText(other.grid) + ", but " + first.path + " has " + sizeText(first.grid),
         "all frames must be of one size");
  }
  if (other.grid.type != first.grid.type) {
    fail("the samples are " + std::string(sampleName(other.grid.type)) + ", but " + first.path + " has " +
             std::string(sampleName(first.grid.type)),
         "all frames must be of one type (unu convert)");
  }
  if (!nearlyEqual(first.grid.index_to_world, other.grid.index_to_world)) {
    fail("the grid's spacing, axes or origin differ from those of " + first.path, "all frames must lie on one grid");
  }
}

// Times given by the caller, as many as frames and growing.
void checkGivenTimes(const std::vector<double>& times, std::size_t frames) {
  if (times.size() != frames) {
    throw Error(FaultCode::kUsage, "", "frame times",
                std::to_string(times.size()) + " times are given for " + std::to_string(frames) + " frames",
                "give one time a frame");
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::isfinite(times[k]) && (k == 0 || times[k] > times[k - 1])) continue;
    throw Error(FaultCode::kUsage, "", "frame times",
                "time " + std::to_string(k) + " (" + numberText(times[k]) + ") does not come after the one before",
                "give finite times in growing order");
  }
}

// Times the files tell, growing; nothing if none tells its time.
std::vector<double> toldTimes(const std::vector<NrrdFile>& files) {
  std::vector<double> times;
  const NrrdHeader* with = nullptr;
  const NrrdHeader* without = nullptr;
  for (const NrrdFile& file : files) {
    const NrrdHeader& header = file.header();
    (header.times.empty() ? without : with) = &header;
    if (header.times.empty()) continue;
    const double time = header.times.front();
    if (!times.empty() && without == nullptr && !(time > times.back())) {
      const NrrdHeader& before = files[times.size() - 1].header();
      throw Error(FaultCode::kBadInput, header.path, "key time",
                  "its time " + numberText(time) + " does not come after the time " + numberText(times.back()) +
                      " of the frame before it, " + before.path,
                  "give the frames in time order");
    }
    times.push_back(time);
  }
  if (with != nullptr && without != nullptr) {
    throw Error(FaultCode::kBadInput, without->path, "header", "tells no time, but " + with->path + " does",
                "add \"time:=T\" to all frames or to none");
  }
  return times;
}

// Frame numbers as times: 0, 1, 2 … and, where a hole was accepted, further apart.
std::vector<double> countedTimes(std::size_t frames, const std::optional<std::vector<std::int64_t>>& numbers) {
  std::vector<double> times(frames);
  std::int64_t step = 1;
  if (numbers && frames > 1) {
    step = (*numbers)[1] - (*numbers)[0];
    for (std::size_t k = 2; k < frames; ++k) step = std::min(step, (*numbers)[k] - (*numbers)[k - 1]);
  }
  for (std::size_t k = 0; k < frames; ++k) {
    times[k] = numbers ? static_cast<double>((*numbers)[k] - numbers->front()) / static_cast<double>(step)
                       : static_cast<double>(k);
  }
  return times;
}

std::vector<double> seriesTimes(const std::vector<std::string>& names, const std::vector<NrrdFile>& files,
                                const FrameSourceOptions& options) {
  if (!options.times.empty()) {
    checkGivenTimes(options.times, files.size());
    return options.times;
  }
  std::vector<double> times = toldTimes(files);
  const auto numbers = fileNumbers(names);
  // Told times may stand on irregular numbers (a solver's steps), but a number left out of a regular row is a lost
  // file.
  const bool regular_row = !times.empty() && numbers && hasCommonStep(*numbers);
  if (numbers && (times.empty() || regular_row)) checkNumbering(names, *numbers, options.allow_gaps);
  return times.empty() ? countedTimes(files.size(), numbers) : times;
}

std::unique_ptr<FrameSource> openSeries(const std::vector<std::string>& names, const FrameSourceOptions& options) {
  std::vector<NrrdFile> files;
  files.reserve(names.size());
  for (const std::string& name : names) {
    files.emplace_back(name);
    const NrrdHeader& header = files.back().header();
    if (header.frames != 1) {
      throw Error(FaultCode::kBadInput, name, "header",
                  "holds " + std::to_string(header.frames) + " frames, but is one of " + std::to_string(names.size()) +
                      " files",
                  "give one 4D file alone, or 3D files of one frame each");
    }
    checkSameGrid(files.front().header(), header);
  }
  std::vector<double> times = seriesTimes(names, files, options);
  return std::make_unique<NrrdSeries>(std::move(files), std::move(times));
}

std::unique_ptr<FrameSource> openMovie(NrrdFile file, const FrameSourceOptions& options) {
  const auto frames = static_cast<std::size_t>(file.header().frames);
  std::vector<double> times = options.times;
  if (!times.empty()) {
    checkGivenTimes(times, frames);
  } else {
    times = file.header().times.empty() ? countedTimes(frames, std::nullopt) : file.header().times;
  }
  return std::make_unique<NrrdMovie>(std::move(file), std::move(times));
}

std::unique_ptr<FrameSource> openGrid4(const std::string& path, const FrameSourceOptions& options) {
  grid4::File file = unwrap(grid4::File::open(path));
  if (!options.times.empty()) checkGivenTimes(options.times, file.times().size());
  return std::make_unique<Grid4Frames>(std::move(file), options.times);
}

}  // namespace

std::unique_ptr<FrameSource> openFrames(const std::vector<std::string>& inputs, const FrameSourceOptions& options) {
  if (inputs.empty()) throw Error(FaultCode::kUsage, "", "", "no frames are given", "name the frames' files");
  if (inputs.size() > 1) return openSeries(inputs, options);
  const std::string& input = inputs.front();
  std::error_code ignored;
  if (fs::is_directory(input, ignored)) {
    const auto files = filesOfDirectory(input);
    return files.size() == 1 ? openMovie(NrrdFile(files.front()), options) : openSeries(files, options);
  }
  if (input.ends_with(".t4g")) return openGrid4(input, options);
  if (!fs::exists(input, ignored) && input.find('%') != std::string::npos) {
    return openSeries(filesOfPattern(input), options);
  }
  return openMovie(NrrdFile(input), options);
}

}  // namespace tet4d::exchange
