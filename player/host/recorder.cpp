#include "player/host/recorder.h"

#include <cstdio>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

#include "player/host/output_file.h"
#include "player/host/png.h"

namespace tet4d::host {
namespace {

constexpr int kMostNames = 1'000'000;

std::string numbered(const std::string& directory, const std::string& stem, const std::string& suffix, int number) {
  std::string digits = std::to_string(number);
  if (digits.size() < 4) digits.insert(0, 4 - digits.size(), '0');
  std::string name = stem;
  name += '-' + digits + suffix;
  return directory.empty() || directory == "." ? name : (std::filesystem::path(directory) / name).string();
}

// A pattern names the film's pictures: percent signs of the folder stand for themselves.
std::string escaped(const std::string& name) {
  std::string out;
  for (const char c : name) out += c == '%' ? "%%" : std::string(1, c);
  return out;
}

Result<std::string> saveBytes(const std::string& directory, const std::string& stem, const std::string& suffix,
                              std::span<const std::byte> bytes) {
  std::string name = nextName(directory, stem, suffix);
  if (Status status = writeFile(name, bytes, false); !status.ok()) return status.fault();
  return name;
}

}  // namespace

std::string nextName(const std::string& directory, const std::string& stem, const std::string& suffix) {
  int number = 1;
  std::error_code error;
  while (number < kMostNames &&
         std::filesystem::exists(std::filesystem::symlink_status(numbered(directory, stem, suffix, number), error)))
    ++number;
  return numbered(directory, stem, suffix, number);
}

Result<std::string> savePicture(const std::string& directory, const render::Image& picture) {
  const auto bytes = encodePng(picture, nextName(directory, "picture", ".png"));
  if (!bytes.ok()) return bytes.fault();
  return saveBytes(directory, "picture", ".png", bytes.value());
}

Result<std::string> saveText(const std::string& directory, const std::string& stem, const std::string& suffix,
                             const std::string& text) {
  return saveBytes(directory, stem, suffix, std::as_bytes(std::span(text)));
}

Result<Recorder> Recorder::start(const std::string& directory, FilmKind kind, double fps, std::vector<double> times,
                                 const scene::Format& format) {
  Recorder recorder;
  recorder.name_ = nextName(directory, "film", kind == FilmKind::kY4m ? ".y4m" : "");
  recorder.format_ = format;
  recorder.times_ = std::move(times);
  auto sink = kind == FilmKind::kY4m
                  ? makeY4mFilm(recorder.name_, fps, false)
                  : makePngFrames(escaped(recorder.name_) + "/%05d.png", recorder.times_.size(), false);
  if (!sink.ok()) return sink.fault();
  recorder.sink_ = std::move(sink).value();
  return recorder;
}

Status Recorder::add(const render::Image& picture) {
  if (Status status = sink_->add(picture); !status.ok()) return status;
  ++taken_;
  return done() ? sink_->finish() : Status{};
}

Status Recorder::finish() {
  times_.resize(taken_);
  return sink_->finish();
}

}  // namespace tet4d::host
