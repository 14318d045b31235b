#include "libpreprocess/exchange/frame_series.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/file_series.h"
#include "libpreprocess/exchange/number_text.h"

namespace tet4d::exchange {
namespace {

using FrameFiles = std::vector<std::unique_ptr<FrameFile>>;

class FileSeries final : public FrameSource {
 public:
  FileSeries(FrameFiles files, std::vector<double> times) : files_(std::move(files)), times_(std::move(times)) {}
  const GridInfo& grid() const override { return files_.front()->header().grid; }
  const std::vector<double>& times() const override { return times_; }
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    assert(k < files_.size());
    if (k != open_) files_[open_]->close();
    open_ = k;
    files_[k]->readLayers(0, z_begin, z_end, samples);
    if (z_end == grid().dims[2]) files_[k]->close();
  }
  std::string frameName(std::size_t k) const override { return files_[k]->header().path; }

 private:
  FrameFiles files_;
  std::vector<double> times_;
  std::size_t open_ = 0;  // the one file that may have a descriptor
};

class FileMovie final : public FrameSource {
 public:
  FileMovie(std::unique_ptr<FrameFile> file, std::vector<double> times)
      : file_(std::move(file)), times_(std::move(times)) {}
  const GridInfo& grid() const override { return file_->header().grid; }
  const std::vector<double>& times() const override { return times_; }
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    file_->readLayers(k, z_begin, z_end, samples);
  }
  std::string frameName(std::size_t k) const override { return file_->header().path + " frame " + std::to_string(k); }

 private:
  std::unique_ptr<FrameFile> file_;
  std::vector<double> times_;
};

// Times the files tell, growing; nothing if none tells its time.
std::vector<double> toldTimes(const FrameFiles& files) {
  std::vector<double> times;
  const FrameFileHeader* with = nullptr;
  const FrameFileHeader* without = nullptr;
  for (const auto& file : files) {
    const FrameFileHeader& header = file->header();
    (header.times.empty() ? without : with) = &header;
    if (header.times.empty()) continue;
    const double time = header.times.front();
    if (!times.empty() && without == nullptr && !(time > times.back())) {
      const FrameFileHeader& before = files[times.size() - 1]->header();
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

std::vector<double> seriesTimes(const std::vector<std::string>& names, const FrameFiles& files,
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

}  // namespace

void checkSameGrid(const std::string& first_name, const GridInfo& first, const std::string& other_name,
                   const GridInfo& other) {
  const auto fail = [&](const std::string& what, const std::string& remedy) {
    throw Error(FaultCode::kBadInput, other_name, "header", what, remedy);
  };
  if (other.dims != first.dims) {
    fail("the size is " + sizeText(other) + ", but " + first_name + " has " + sizeText(first),
         "all frames must be of one size");
  }
  if (other.type != first.type) {
    fail("the samples are " + std::string(sampleName(other.type)) + ", but " + first_name + " has " +
             std::string(sampleName(first.type)),
         "all frames must be of one type (unu convert)");
  }
  if (!isSameGrid(first.index_to_world, other.index_to_world)) {
    fail("the grid's spacing, axes or origin differ from those of " + first_name, "all frames must lie on one grid");
  }
}

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

std::unique_ptr<FrameSource> openFileSeries(const std::vector<std::string>& names, const FrameSourceOptions& options) {
  FrameFiles files;
  files.reserve(names.size());
  for (const std::string& name : names) {
    files.push_back(openFrameFile(name, options.file));
    const FrameFileHeader& header = files.back()->header();
    if (header.frames != 1) {
      throw Error(FaultCode::kBadInput, name, "header",
                  "holds " + std::to_string(header.frames) + " frames, but is one of " + std::to_string(names.size()) +
                      " files",
                  "give one 4D file alone, or 3D files of one frame each");
    }
    checkSameGrid(names.front(), files.front()->header().grid, name, header.grid);
  }
  std::vector<double> times = seriesTimes(names, files, options);
  return std::make_unique<FileSeries>(std::move(files), std::move(times));
}

std::unique_ptr<FrameSource> openFileMovie(std::unique_ptr<FrameFile> file, const FrameSourceOptions& options) {
  const auto frames = static_cast<std::size_t>(file->header().frames);
  std::vector<double> times = options.times;
  if (!times.empty()) {
    checkGivenTimes(times, frames);
  } else {
    times = file->header().times.empty() ? countedTimes(frames, std::nullopt) : file->header().times;
  }
  return std::make_unique<FileMovie>(std::move(file), std::move(times));
}

}  // namespace tet4d::exchange
