#include "libpreprocess/exchange/frame_view.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "libpreprocess/error.h"

namespace tet4d::exchange {
namespace {

constexpr std::uint64_t kToTheEnd = std::numeric_limits<std::uint64_t>::max();

std::string rangeText(const IndexRange& range) {
  return std::to_string(range.first) + ":" + (range.last == kToTheEnd ? "" : std::to_string(range.last));
}

[[noreturn]] void fail(const std::string& option, const std::string& what, const std::string& remedy) {
  throw Error(FaultCode::kUsage, "", "option " + option, what, remedy);
}

// `range` with its end known, within `count` things called `of`.
IndexRange within(const std::string& option, const IndexRange& range, std::uint64_t count, const std::string& of) {
  if (range.last < range.first) fail(option, "the range " + rangeText(range) + " is empty", "give FIRST:LAST");
  const bool ends_outside = range.last != kToTheEnd && range.last >= count;
  if (range.first >= count || ends_outside) {
    fail(option, "the range " + rangeText(range) + " goes beyond the " + of + ", 0:" + std::to_string(count - 1),
         "both ends are included and count from 0");
  }
  return {range.first, std::min(range.last, count - 1)};
}

class FrameView final : public FrameSource {
 public:
  FrameView(std::unique_ptr<FrameSource> source, const FrameViewOptions& options);
  const GridInfo& grid() const override { return grid_; }
  const std::vector<double>& times() const override { return times_; }
  bool isStream() const override { return source_->isStream(); }
  bool hasFrame(std::size_t k) override;
  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override;
  std::string frameName(std::size_t k) const override { return source_->frameName(sourceFrame(k)); }

 private:
  std::size_t sourceFrame(std::size_t k) const { return static_cast<std::size_t>(frames_.first + k * frame_step_); }
  void readFirstHeader();

  std::unique_ptr<FrameSource> source_;
  std::array<IndexRange, 3> box_;
  std::array<std::uint64_t, 3> stride_;
  IndexRange frames_;
  std::uint64_t frame_step_;
  GridInfo grid_;
  std::vector<double> times_;
  std::vector<std::byte> layer_;  // of the source; empty if whole layers are kept
};

FrameView::FrameView(std::unique_ptr<FrameSource> source, const FrameViewOptions& options)
    : source_(std::move(source)), stride_(options.stride), frames_(options.frames), frame_step_(options.frame_step) {
  const GridInfo& whole = source_->grid();
  if (frame_step_ == 0) fail("--time-stride", "a step of 0 frames", "give a number from 1 on");
  grid_ = whole;
  for (std::size_t c = 0; c < 3; ++c) {
    if (stride_[c] == 0) fail("--stride", "a step of 0 samples", "give numbers from 1 on");
    const std::string axis(1, "xyz"[c]);
    box_[c] =
        within("--crop", options.crop ? (*options.crop)[c] : IndexRange{}, whole.dims[c], "samples along " + axis);
    grid_.dims[c] = (box_[c].last - box_[c].first) / stride_[c] + 1;
    for (std::size_t i = 0; i < 3; ++i) {
      grid_.index_to_world.origin[i] += static_cast<double>(box_[c].first) * whole.index_to_world.axes[c][i];
      grid_.index_to_world.axes[c][i] *= static_cast<double>(stride_[c]);
    }
  }
  if (!isUsable(grid_.index_to_world)) fail("--stride", "the cells become too large for float64", "give smaller steps");
  const bool whole_layers = grid_.dims[0] == whole.dims[0] && grid_.dims[1] == whole.dims[1];
  if (!whole_layers) layer_.resize(static_cast<std::size_t>(whole.layerBytes()));
  if (isStream()) {
    if (frames_.last < frames_.first) within("--frames", frames_, kToTheEnd, "");
    readFirstHeader();
    return;
  }
  frames_ = within("--frames", frames_, source_->times().size(), "frames");
  for (std::uint64_t k = frames_.first; k <= frames_.last; k += frame_step_) {
    times_.push_back(source_->times()[static_cast<std::size_t>(k)]);
    if (frames_.last - k < frame_step_) break;
  }
}

// A stream's first frame: builders ask for its name and time before they read.
void FrameView::readFirstHeader() {
  if (hasFrame(0)) return;
  fail("--frames",
       "the range " + rangeText(frames_) + " begins after the stream's last frame, " +
           std::to_string(source_->times().size() - 1),
       "both ends are included and count from 0");
}

bool FrameView::hasFrame(std::size_t k) {
  if (!isStream()) return k < times_.size();
  if (k > (frames_.last - frames_.first) / frame_step_) return false;
  while (times_.size() <= k) {
    const std::size_t next = sourceFrame(times_.size());
    if (!source_->hasFrame(next)) {
      const std::size_t there = source_->times().size();
      if (frames_.last != kToTheEnd && frames_.last >= there) within("--frames", frames_, there, "stream's frames");
      return false;
    }
    times_.push_back(source_->times()[next]);
  }
  return true;
}

void FrameView::readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) {
  const std::size_t frame = sourceFrame(k);
  if (layer_.empty() && stride_[2] == 1) {
    source_->readLayers(frame, box_[2].first + z_begin, box_[2].first + z_end, samples);
    return;
  }
  const GridInfo& whole = source_->grid();
  const std::size_t size = sampleBytes(grid_.type);
  std::byte* out = samples.data();
  for (std::uint64_t z = z_begin; z < z_end; ++z) {
    const std::uint64_t at = box_[2].first + z * stride_[2];
    if (layer_.empty()) {
      const auto layer = static_cast<std::size_t>(grid_.layerBytes());
      source_->readLayers(frame, at, at + 1, {out, layer});
      out += layer;
      continue;
    }
    source_->readLayers(frame, at, at + 1, layer_);
    for (std::uint64_t y = 0; y < grid_.dims[1]; ++y) {
      const std::uint64_t row = (box_[1].first + y * stride_[1]) * whole.dims[0] + box_[0].first;
      const std::byte* in = layer_.data() + row * size;
      if (stride_[0] == 1) {
        std::memcpy(out, in, static_cast<std::size_t>(grid_.dims[0]) * size);
        out += grid_.dims[0] * size;
        continue;
      }
      for (std::uint64_t x = 0; x < grid_.dims[0]; ++x, out += size) std::memcpy(out, in + x * stride_[0] * size, size);
    }
  }
}

}  // namespace

bool FrameViewOptions::isWhole() const {
  return !crop && stride == std::array<std::uint64_t, 3>{1, 1, 1} && frames.first == 0 && frames.last == kToTheEnd &&
         frame_step == 1;
}

std::unique_ptr<FrameSource> viewFrames(std::unique_ptr<FrameSource> source, const FrameViewOptions& options) {
  if (options.isWhole()) return source;
  return std::make_unique<FrameView>(std::move(source), options);
}

}  // namespace tet4d::exchange
