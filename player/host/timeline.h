// Where playback stands in time: a world time that runs through a range, at a speed, once or again and again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tet4d::host {

enum class Loop : std::uint8_t { kLoop, kPingPong, kOnce };
const char* loopName(Loop loop);

class Timeline {
 public:
  // The frame times of everything open, ascending, each once. The time stays where it is if the table holds it; range
  // and speed are set anew if the table's ends change.
  void setTable(std::vector<double> times);

  const std::vector<double>& table() const { return table_; }
  double first() const { return table_.empty() ? 0 : table_.front(); }
  double last() const { return table_.empty() ? 0 : table_.back(); }
  double time() const { return time_; }
  // Frames of the table, between two of them a fraction.
  double frame() const;
  bool playing() const { return playing_; }
  double begin() const { return begin_; }
  double end() const { return end_; }

  // Into the table's ends.
  void setTime(double time);
  // At the end (or, backwards, the begin) of the range, playing starts from the other side. Without two different times
  // there is nothing to play.
  void play(bool playing);
  // Lets `seconds` pass; at most a quarter of one, so that a stall is no leap. True if the time changed.
  bool advance(double seconds);
  // To the next or an earlier frame of the table; stops playing.
  void step(int frames);
  void toBegin() { setTime(begin_); }
  void toEnd() { setTime(end_); }

  // The range holds at least the time given; its other end gives way.
  void setBegin(double time);
  void setEnd(double time);
  void wholeRange();

  static constexpr double kFramesPerSecond = 12;
  // World time a second of playing. 1: kFramesPerSecond frames a second on average.
  double speed() const { return speed_; }
  void setSpeed(double speed);  // 1/1024 .. 1024
  double unitsPerSecond() const;
  bool backward() const { return backward_; }
  void setBackward(bool backward) { backward_ = backward; }
  Loop loop() const { return loop_; }
  void setLoop(Loop loop) { loop_ = loop; }

  // Times of a film of the range: every frame of the table in it and `between` times evenly between each two.
  std::vector<double> filmTimes(unsigned between) const;

 private:
  std::vector<double> table_;
  double time_ = 0, begin_ = 0, end_ = 0, speed_ = 1;
  bool playing_ = false, backward_ = false;
  Loop loop_ = Loop::kLoop;
};

}  // namespace tet4d::host
