// Pictures, films and camera files saved from the window: numbered, never over a file that exists.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "player/host/film.h"
#include "player/scene/draw_list.h"

namespace tet4d::host {

// `directory`/`stem`-0001`suffix`, or the first number after it that is not taken. suffix may be empty.
std::string nextName(const std::string& directory, const std::string& stem, const std::string& suffix);

// Writes `picture` to the next free picture-NNNN.png and returns its name.
Result<std::string> savePicture(const std::string& directory, const render::Image& picture);

// Writes `text` to the next free name and returns it.
Result<std::string> saveText(const std::string& directory, const std::string& stem, const std::string& suffix,
                             const std::string& text);

enum class FilmKind : std::uint8_t { kPng, kY4m };

// A film taken one picture at a time, between the window's own pictures.
class Recorder {
 public:
  // times: at least one.
  static Result<Recorder> start(const std::string& directory, FilmKind kind, double fps, std::vector<double> times,
                                const scene::Format& format);

  const std::string& name() const { return name_; }
  const scene::Format& format() const { return format_; }
  std::size_t count() const { return times_.size(); }
  std::size_t taken() const { return taken_; }
  bool done() const { return taken_ == times_.size(); }
  double nextTime() const { return times_[taken_]; }
  // The picture at nextTime(). After the last one the film is complete under its name.
  Status add(const render::Image& picture);
  // Ends the film after the pictures taken so far.
  Status finish();

 private:
  std::string name_;
  scene::Format format_;
  std::vector<double> times_;
  std::size_t taken_ = 0;
  std::unique_ptr<FrameSink> sink_;
};

}  // namespace tet4d::host
