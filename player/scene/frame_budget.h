// From a budget of milliseconds a frame to a budget of work: what a chooser may hand over, how finely a picture is
// sampled. Knows neither clock nor GL: it is told what a frame did and how long that took.
//
// Model: ms = a + b * primitives + c * bytes + d * samples, none negative, fitted to the last frames by least squares
// with falling weights for frames far from the model (Huber) and long ago. A budget is met by 95 of 100 frames: the
// model's answer is divided by the 95th percentile of measured over predicted. Four frames in a row that all took far
// longer, or far less, than predicted mean that the machine has changed: what was before is forgotten.
//
// Samples cost what lines do not say: a filter, a buffer read back, a shader that waits for vertices. Where frames with
// about as many samples stand in the window, the model's answer is theirs: times measured over predicted of those
// frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace tet4d::scene {

// What a frame does. Counts; not negative.
struct FrameWork {
  double primitives = 0;  // handed over
  double bytes = 0;       // brought in for it
  double samples = 0;     // of the picture
};

class FrameBudget {
 public:
  // target_ms: at least 0; infinity sets no bound.
  explicit FrameBudget(double target_ms) : target_ms_(target_ms) {}
  double targetMs() const { return target_ms_; }

  // A frame has been drawn. A time that is not a number or negative is not counted. O(1): the window is 64 frames, the
  // last ones and of each number of samples at least one.
  void add(const FrameWork& work, double ms);

  // What the model says of `work`; 0 before the first frame.
  double predictMs(const FrameWork& work) const;
  // The most primitives for a frame whose bytes and samples are those of `work`, so that it meets the target. It falls
  // at once and rises by at most a quarter a call, not for less than a tenth. 0 with a target of 0; infinity without a
  // target, before the first frame, or where primitives cost nothing.
  double primitives(const FrameWork& work);
  // True if a frame with `work` is to be expected within the target, times `part` of it.
  bool fits(const FrameWork& work, double part = 1) const;
  // What half of the frames with `work` take at most.
  double expectMs(const FrameWork& work) const;
  // Frames of the window with as many samples as `work`, within a tenth.
  std::size_t seen(const FrameWork& work) const;
  // True if frames with fewer and with more samples have said, since the machine changed, what samples cost.
  bool tellsSamplesApart() const { return tells_samples_apart_; }

  // Of the frames of the window: milliseconds, and |measured - predicted| / measured as predicted before each. 0
  // without frames.
  struct Report {
    std::size_t frames = 0;  // since the beginning
    double p50_ms = 0, p95_ms = 0, error_p50 = 0, error_p95 = 0;
  };
  Report report() const;

 private:
  static constexpr std::size_t kTerms = 4;
  struct Frame {
    std::array<double, kTerms> terms{};  // 1, primitives, bytes, samples
    double ms = 0, predicted_ms = 0;
  };
  void fit();
  void forgetOne();
  double margin() const;
  std::vector<double> ratios(const FrameWork* like) const;
  bool hasChanged() const;

  double target_ms_;
  std::deque<Frame> frames_;
  std::array<double, kTerms> cost_{};  // ms a unit of each term
  double last_primitives_ = -1;        // answered by primitives(); negative: nothing yet
  std::size_t count_ = 0;
  bool tells_samples_apart_ = false;
};

// How finely a moving picture is sampled, under a budget: what a player without levels of detail can give up.
struct Quality {
  std::uint32_t samples = 1;  // a pixel, as asked for or fewer: 1, 4, 9 or 16
  std::uint32_t divide = 1;   // width and height drawn at 1/divide: 1, 2 or 4
  bool operator==(const Quality&) const = default;
};

// Chooses it picture by picture. A still picture is always the full one.
class MotionQuality {
 public:
  // full_samples: 1, 4, 9 or 16.
  explicit MotionQuality(std::uint32_t full_samples);
  // For a picture of `pixels` pixels that hands over `primitives`. Coarser at once when the budget says so; while
  // nothing tells what samples cost, as far as would do if they were all of it. Finer when eight pictures in a row had
  // a tenth of the time to spare, past steps that save less than a tenth; what saves less than that is not given up
  // where nothing fits. A step that the model thinks too slow, but no two pictures of the window were, is tried now and
  // then.
  Quality next(const FrameBudget& budget, double pixels, double primitives, double bytes, bool is_moving);

 private:
  // `whole`: of a picture with one sample a pixel.
  void settle(const FrameBudget& budget, const FrameWork& whole);
  void fall(const FrameBudget& budget, const FrameWork& whole);
  void rise(const FrameBudget& budget, const FrameWork& whole);

  std::uint32_t full_samples_;
  std::size_t level_ = 0;  // 0 is the coarsest
  std::size_t full_level_;
  unsigned spare_ = 0;  // pictures in a row
  static constexpr unsigned kTryAfter = 24;
  unsigned waited_ = 0, try_after_ = kTryAfter;  // pictures at this level; before a finer one is tried
  std::size_t tried_level_ = 0;                  // last; 0: none
};

}  // namespace tet4d::scene
