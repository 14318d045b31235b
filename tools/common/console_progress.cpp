#include "tools/common/console_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tet4d::cli {

namespace {

constexpr int kBarWidth = 32;
constexpr double kRedrawSeconds = 0.1;  // between redraws of the bar

double seconds(std::chrono::steady_clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace

double processCpuSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

ConsoleProgress::ConsoleProgress(std::string program, Look look) : program_(std::move(program)), look_(look) {}

double ConsoleProgress::secondsInPhase() const { return seconds(Clock::now() - phase_begin_); }

void ConsoleProgress::phase(std::string_view name, std::uint64_t total) {
  {
    const std::lock_guard lock(mutex_);
    endPhase();
    const auto same = [&](const PhaseTimes& phase) { return phase.name == name; };
    current_ = static_cast<std::size_t>(std::find_if(phases_.begin(), phases_.end(), same) - phases_.begin());
    if (current_ == phases_.size()) phases_.push_back({std::string(name)});
    in_phase_ = true;
    total_ = total;
    done_ = shown_percent_ = 0;
    phase_begin_ = last_shown_ = Clock::now();
    phase_cpu_begin_ = processCpuSeconds();
  }
  outofcore::Progress::step(0);
}

void ConsoleProgress::step(std::uint64_t done) {
  outofcore::Progress::step(done);
  const std::lock_guard lock(mutex_);
  if (!in_phase_) return;
  done_ = std::max(done_, done);
  show(done_);
}

void ConsoleProgress::endPhase() {
  if (!in_phase_) return;
  in_phase_ = false;
  PhaseTimes& times = phases_[current_];
  times.seconds_wall += secondsInPhase();
  times.seconds_cpu += processCpuSeconds() - phase_cpu_begin_;
}

void ConsoleProgress::show(std::uint64_t done) {
  const double since_shown = seconds(Clock::now() - last_shown_);
  const bool complete = done >= total_;
  const double part = total_ == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
  const auto percent = static_cast<std::uint64_t>(100 * part);

  const auto& name = phases_[current_].name;
  if (look_ == Look::kBar) {
    if (since_shown < kRedrawSeconds && (!complete || !bar_on_screen_)) return;
    drawBar(part);
  } else if (look_ == Look::kPlain) {
    // Every 10 %, but steps within the same second share a line; and every 30 s.
    const bool tenth = percent / 10 > shown_percent_ / 10 && (since_shown >= 1 || complete);
    if (!tenth && since_shown < 30) return;
    fmt::print(stderr, "{}: {}: {} % ({} of {}), {:.1f} s\n", program_, name, percent, done, total_, secondsInPhase());
  } else if (look_ == Look::kJson) {
    if (since_shown < kRedrawSeconds && !(complete && shown_percent_ < 100)) return;
    const nlohmann::ordered_json line{
        {"phase", name}, {"done", done}, {"total", total_}, {"seconds", secondsInPhase()}};
    fmt::print(stderr, "{}\n", line.dump());
  }
  shown_percent_ = percent;
  last_shown_ = Clock::now();
}

void ConsoleProgress::drawBar(double part) {
  const auto filled = static_cast<int>(part * kBarWidth);
  fmt::print(stderr, "\r\x1b[K{} {:<8} [{:#<{}}{:.<{}}] {:3.0f} %", program_, phases_[current_].name, "", filled, "",
             kBarWidth - filled, 100 * part);
  std::fflush(stderr);
  bar_on_screen_ = true;
}

void ConsoleProgress::clearLine() {
  const std::lock_guard lock(mutex_);
  if (!bar_on_screen_) return;
  std::fputs("\r\x1b[K", stderr);
  bar_on_screen_ = false;
}

void ConsoleProgress::finish(bool summary) {
  clearLine();
  const std::lock_guard lock(mutex_);
  endPhase();
  if (finished_) return;
  finished_ = true;
  if (!summary || look_ == Look::kNone || phases_.empty()) return;
  if (look_ == Look::kJson) {
    fmt::print(stderr, "{}\n", nlohmann::ordered_json{{"phase", "done"}}.dump());
    return;
  }
  double total = 0;
  std::string parts;
  for (const PhaseTimes& phase : phases_) {
    total += phase.seconds_wall;
    parts += fmt::format("{}{} {:.1f}", parts.empty() ? "" : ", ", phase.name, phase.seconds_wall);
  }
  fmt::print(stderr, "{}: done in {:.1f} s ({})\n", program_, total, parts);
}

}  // namespace tet4d::cli
