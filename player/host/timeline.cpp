#include "player/host/timeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tet4d::host {
namespace {

constexpr double kLongestLeap = 0.25;

}  // namespace

const char* loopName(Loop loop) {
  return loop == Loop::kLoop ? "loop" : loop == Loop::kPingPong ? "to and fro" : "once";
}

void Timeline::setTable(std::vector<double> times) {
  const double old_first = first(), old_last = last();
  const bool had_none = table_.empty();
  table_ = std::move(times);
  if (had_none || first() != old_first || last() != old_last) wholeRange();
  if (had_none) time_ = first();
  setTime(time_);
  if (!(begin_ < end_)) playing_ = false;
}

double Timeline::frame() const {
  if (table_.size() < 2) return 0;
  const auto after = std::upper_bound(table_.begin() + 1, table_.end() - 1, time_);
  const auto i = static_cast<double>(after - table_.begin() - 1);
  return i + (time_ - after[-1]) / (after[0] - after[-1]);
}

void Timeline::setTime(double time) { time_ = std::clamp(time, first(), last()); }

void Timeline::play(bool playing) {
  playing_ = playing && begin_ < end_;
  if (!playing_ || loop_ != Loop::kOnce) return;
  if (!backward_ && time_ >= end_) time_ = begin_;
  if (backward_ && time_ <= begin_) time_ = end_;
}

bool Timeline::advance(double seconds) {
  if (!playing_ || !(seconds > 0)) return false;
  const double before = time_, span = end_ - begin_;
  // As a part of the range, which neither tiny nor huge units of time can spoil.
  double part = (time_ - begin_) / span;
  const double step = std::min(seconds, kLongestLeap) * (unitsPerSecond() / span);
  part += backward_ ? -step : step;
  if (part < 0 || part > 1) {
    if (loop_ == Loop::kOnce) {
      part = std::clamp(part, 0.0, 1.0);
      playing_ = false;
    } else if (loop_ == Loop::kLoop) {
      part -= std::floor(part);
    } else {
      const double turned = std::abs(std::remainder(part, 2.0));  // a triangle wave: 0 .. 1
      if (turned != part && static_cast<std::int64_t>(std::floor(part)) % 2 != 0) backward_ = !backward_;
      part = turned;
    }
  }
  setTime(part == 1 ? end_ : begin_ + part * span);
  return time_ != before;
}

void Timeline::step(int frames) {
  playing_ = false;
  for (; frames > 0; --frames) {
    const auto next = std::upper_bound(table_.begin(), table_.end(), time_);
    if (next != table_.end()) time_ = *next;
  }
  for (; frames < 0; ++frames) {
    const auto here = std::lower_bound(table_.begin(), table_.end(), time_);
    if (here != table_.begin()) time_ = here[-1];
  }
}

void Timeline::setBegin(double time) {
  begin_ = std::clamp(time, first(), last());
  if (!(begin_ < end_)) end_ = last();
  if (!(begin_ < end_)) begin_ = first();
}

void Timeline::setEnd(double time) {
  end_ = std::clamp(time, first(), last());
  if (!(begin_ < end_)) begin_ = first();
  if (!(begin_ < end_)) end_ = last();
}

void Timeline::wholeRange() {
  begin_ = first();
  end_ = last();
}

void Timeline::setSpeed(double speed) {
  if (speed > 0) speed_ = std::clamp(speed, 1.0 / 1024, 1024.0);
}

double Timeline::unitsPerSecond() const {
  if (table_.size() < 2) return 0;
  return speed_ * kFramesPerSecond * ((last() - first()) / static_cast<double>(table_.size() - 1));
}

std::vector<double> Timeline::filmTimes(unsigned between) const {
  std::vector<double> times;
  const auto add = [&](double time) {
    if (time >= begin_ && time <= end_) times.push_back(time);
  };
  for (std::size_t i = 0; i < table_.size(); ++i) {
    add(table_[i]);
    for (unsigned k = 1; i + 1 < table_.size() && k <= between; ++k)
      add(table_[i] + (table_[i + 1] - table_[i]) * k / (between + 1));
  }
  if (times.empty() && !table_.empty()) times.push_back(begin_);  // a range between two frames
  return times;
}

}  // namespace tet4d::host
