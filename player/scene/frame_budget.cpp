#include "player/scene/frame_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tet4d::scene {
namespace {

constexpr std::size_t kWindow = 64;
constexpr double kForgetting = 0.97;  // a frame
constexpr std::size_t kSamples = 3;   // among the terms
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// The smallest value with at least `share` of the values not above it; 0 of none.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  const auto at = values.begin() + std::max<std::ptrdiff_t>(rank, 0);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Normal equations of a least-squares problem whose answer has no negative part.
template <std::size_t N>
struct Normal {
  std::array<std::array<double, N>, N> matrix{};
  std::array<double, N> right{};

  void add(const std::array<double, N>& row, double value, double weight) {
    for (std::size_t i = 0; i < N; ++i) {
      right[i] += weight * row[i] * value;
      for (std::size_t j = 0; j < N; ++j) matrix[i][j] += weight * row[i] * row[j];
    }
  }
  // By coordinate descent from `x`, which stays where no frame tells terms apart. The constant, term 0, comes last: a
  // cost that may be anyone's is the work's.
  std::array<double, N> solve(std::array<double, N> x) const {
    constexpr int kRounds = 400;
    constexpr double kPull = 1e-9;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t k = 0; k < N; ++k) {
        const std::size_t i = (k + 1) % N;
        if (!(matrix[i][i] > 0)) continue;
        double rest = right[i];
        for (std::size_t j = 0; j < N; ++j) rest -= j == i ? 0 : matrix[i][j] * x[j];
        x[i] = std::max(rest / (matrix[i][i] * (1 + kPull)), 0.0);
      }
    }
    return x;
  }
};

double dot(const auto& a, const auto& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

void FrameBudget::add(const FrameWork& work, double ms) {
  if (!std::isfinite(ms) || ms < 0) return;
  Frame frame{{1, work.primitives, work.bytes, work.samples}, ms, predictMs(work)};
  if (!std::all_of(frame.terms.begin(), frame.terms.end(), [](double term) { return std::isfinite(term); })) return;
  frames_.push_back(frame);
  ++count_;
  if (frames_.size() > kWindow) forgetOne();
  constexpr std::size_t kRun = 4;
  if (hasChanged()) {
    frames_.erase(frames_.begin(), frames_.end() - kRun);
    tells_samples_apart_ = false;
  }
  constexpr double kApart = 1.5;
  const auto [least, most] = std::minmax_element(frames_.begin(), frames_.end(), [](const Frame& a, const Frame& b) {
    return a.terms[kSamples] < b.terms[kSamples];
  });
  tells_samples_apart_ = tells_samples_apart_ || most->terms[kSamples] > kApart * least->terms[kSamples];
  fit();
}

// The oldest frame that another with as many samples is there for: the last of its kind is all that tells what its
// samples cost.
void FrameBudget::forgetOne() {
  const auto has_like = [&](const Frame& one) { return seen({0, 0, one.terms[kSamples]}) > 1; };
  const auto oldest = std::find_if(frames_.begin(), frames_.end(), has_like);
  frames_.erase(oldest == frames_.end() ? frames_.begin() : oldest);
}

// The last four frames all far from what was predicted, on the same side.
bool FrameBudget::hasChanged() const {
  constexpr std::size_t kRun = 4;
  constexpr double kFar = 2;
  if (frames_.size() <= kRun) return false;
  const auto all = [&](auto is_far) { return std::all_of(frames_.end() - kRun, frames_.end(), is_far); };
  return all([&](const Frame& f) { return f.ms > kFar * f.predicted_ms; }) ||
         all([&](const Frame& f) { return f.ms * kFar < f.predicted_ms; });
}

void FrameBudget::fit() {
  std::array<double, kTerms> scale{};
  for (const Frame& frame : frames_) {
    for (std::size_t i = 0; i < kTerms; ++i) scale[i] = std::max(scale[i], frame.terms[i]);
  }
  std::vector<double> far(frames_.size(), 0);  // residuals of the round before
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> sizes;
    for (const double residual : far) sizes.push_back(std::abs(residual));
    const double usual = 1.5 * quantile(sizes, 0.5);
    Normal<kTerms> normal;
    double age = 1;
    for (std::size_t k = frames_.size(); k-- > 0; age *= kForgetting) {
      std::array<double, kTerms> row{};
      for (std::size_t i = 0; i < kTerms; ++i) row[i] = scale[i] > 0 ? frames_[k].terms[i] / scale[i] : 0;
      const double huber = std::abs(far[k]) > usual ? usual / std::abs(far[k]) : 1;
      normal.add(row, frames_[k].ms, age * huber);
    }
    std::array<double, kTerms> known{};
    for (std::size_t i = 0; i < kTerms; ++i) known[i] = cost_[i] * scale[i];
    const auto fitted = normal.solve(known);
    // A term that no frame of the window has keeps the cost it was known to have.
    for (std::size_t i = 0; i < kTerms; ++i)
      if (scale[i] > 0) cost_[i] = fitted[i] / scale[i];
    for (std::size_t k = 0; k < frames_.size(); ++k) far[k] = frames_[k].ms - dot(frames_[k].terms, cost_);
  }
}

double FrameBudget::predictMs(const FrameWork& work) const {
  return dot(std::array<double, kTerms>{1, work.primitives, work.bytes, work.samples}, cost_);
}

namespace {

// 95 of 100 ratios are not above it. Of a few frames the longest may be an accident.
double usualMost(const std::vector<double>& ratios) {
  const std::size_t few = ratios.size();
  const double share = few > 1 ? std::min(0.95, static_cast<double>(few - 1) / static_cast<double>(few)) : 1;
  return quantile(ratios, share);
}

bool isAlike(double samples, double others) {
  constexpr double kAlike = 0.1;
  return std::abs(samples - others) <= kAlike * others;
}

}  // namespace

// Measured over predicted, of the frames with as many samples as `like`, or of all.
std::vector<double> FrameBudget::ratios(const FrameWork* like) const {
  std::vector<double> ratios;
  for (const Frame& frame : frames_) {
    const double now = dot(frame.terms, cost_);
    if (now > 0 && (like == nullptr || isAlike(frame.terms[kSamples], like->samples))) ratios.push_back(frame.ms / now);
  }
  return ratios;
}

// How much longer than the model says 95 of 100 frames may take.
double FrameBudget::margin() const { return std::max(usualMost(ratios(nullptr)), 1.0); }

std::size_t FrameBudget::seen(const FrameWork& work) const {
  return static_cast<std::size_t>(std::count_if(
      frames_.begin(), frames_.end(), [&](const Frame& f) { return isAlike(f.terms[kSamples], work.samples); }));
}

double FrameBudget::expectMs(const FrameWork& work) const {
  const std::vector<double> own = ratios(&work);
  return predictMs(work) * (own.empty() ? 1 : quantile(own, 0.5));
}

bool FrameBudget::fits(const FrameWork& work, double part) const {
  if (target_ms_ == kInfinite) return true;
  const std::vector<double> own = ratios(&work);
  return predictMs(work) * (own.empty() ? margin() : usualMost(own)) <= part * target_ms_ && target_ms_ > 0;
}

double FrameBudget::primitives(const FrameWork& work) {
  if (target_ms_ <= 0) return 0;
  if (target_ms_ == kInfinite || frames_.empty() || !(cost_[1] > 0)) return kInfinite;
  FrameWork rest = work;
  rest.primitives = 0;
  const double wanted = std::max(target_ms_ / margin() - predictMs(rest), 0.0) / cost_[1];
  constexpr double kDeadBand = 0.1, kRise = 1.25;
  const double last = last_primitives_;
  if (last >= 0 && wanted >= last && wanted - last <= kDeadBand * last) return last;
  // From nothing it could not rise by a quarter: half of what is wanted then.
  last_primitives_ = last < 0 ? wanted : std::min(wanted, std::max(last * kRise, last == 0 ? wanted / 2 : 0.0));
  return last_primitives_;
}

FrameBudget::Report FrameBudget::report() const {
  std::vector<double> ms, errors;
  for (const Frame& frame : frames_) {
    ms.push_back(frame.ms);
    if (frame.ms > 0) errors.push_back(std::abs(frame.ms - frame.predicted_ms) / frame.ms);
  }
  return {count_, quantile(ms, 0.5), quantile(ms, 0.95), quantile(errors, 0.5), quantile(errors, 0.95)};
}

namespace {

// From coarse to fine.
constexpr std::array<Quality, 6> kLevels{{{1, 4}, {1, 2}, {1, 1}, {4, 1}, {9, 1}, {16, 1}}};

// `whole` has one sample a pixel.
FrameWork workOf(const Quality& quality, const FrameWork& whole) {
  return {whole.primitives, whole.bytes, whole.samples * quality.samples / (quality.divide * quality.divide)};
}

}  // namespace

MotionQuality::MotionQuality(std::uint32_t full_samples) : full_samples_(full_samples), full_level_(2) {
  while (full_level_ + 1 < kLevels.size() && kLevels[full_level_].samples < full_samples) ++full_level_;
  level_ = full_level_;
}

void MotionQuality::settle(const FrameBudget& budget, const FrameWork& whole) {
  const std::size_t before = level_;
  fall(budget, whole);
  if (level_ == before) rise(budget, whole);
  if (level_ != before) spare_ = waited_ = 0;
}

void MotionQuality::fall(const FrameBudget& budget, const FrameWork& whole) {
  const std::size_t before = level_;
  const FrameWork now = workOf(kLevels[before], whole);
  const auto may_fit = [&](std::size_t level) {
    const FrameWork work = workOf(kLevels[level], whole);
    if (budget.fits(work)) return true;
    if (level == before || budget.tellsSamplesApart()) return false;
    return budget.expectMs(now) * work.samples / now.samples <= budget.targetMs() && budget.targetMs() > 0;
  };
  if (may_fit(level_)) return;
  // Told nothing, the model gives one answer for all levels, and that is no reason to stay where pictures are too slow.
  while (level_ > 0 && (level_ == before || !may_fit(level_))) --level_;
  if (budget.targetMs() <= 0 || !budget.tellsSamplesApart() || may_fit(level_)) return;
  constexpr double kLittle = 1.1;
  // As all frames say: one slow picture at the coarsest level is no reason to go back to the finest.
  const double least = budget.predictMs(workOf(kLevels[0], whole));
  while (level_ < full_level_ && budget.expectMs(workOf(kLevels[level_ + 1], whole)) <= kLittle * least) ++level_;
}

void MotionQuality::rise(const FrameBudget& budget, const FrameWork& whole) {
  constexpr double kPart = 0.9, kLittle = 1.1;
  constexpr unsigned kPatience = 8, kSeldom = 1U << 12;
  if (level_ == full_level_) return;
  const auto work = [&](std::size_t level) { return workOf(kLevels[level], whole); };
  ++waited_;
  spare_ = budget.fits(work(level_ + 1), kPart) ? spare_ + 1 : 0;
  if (waited_ == kPatience && tried_level_ == level_) try_after_ = kTryAfter;  // it was worth trying
  if (spare_ >= kPatience) {
    const double least = budget.expectMs(work(level_));
    ++level_;
    while (budget.tellsSamplesApart() && level_ < full_level_ && budget.fits(work(level_ + 1), kPart) &&
           budget.expectMs(work(level_ + 1)) <= kLittle * least)
      ++level_;
  } else if (waited_ >= try_after_ && budget.fits(work(level_)) && budget.seen(work(level_ + 1)) < 2) {
    tried_level_ = ++level_;
    try_after_ = std::min(2 * try_after_, kSeldom);
  }
}

Quality MotionQuality::next(const FrameBudget& budget, double pixels, double primitives, double bytes, bool is_moving) {
  const Quality full{full_samples_, 1};
  if (!is_moving || budget.targetMs() == kInfinite) return full;
  settle(budget, {primitives, bytes, pixels});
  return level_ == full_level_ ? full : kLevels[level_];
}

}  // namespace tet4d::scene
