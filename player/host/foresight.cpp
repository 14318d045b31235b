#include "player/host/foresight.h"

#include <cmath>

#include "player/scene/pages_ahead.h"

namespace tet4d::host {
namespace {

// Far enough for any disk, near enough that a frame's list stays short and little is read for nothing.
constexpr std::size_t kPicturesAhead = 128;
constexpr std::uint64_t kBytesAhead = std::uint64_t{256} << 20;  // decoded, of one file, beyond the present picture
constexpr double kSecondsAhead = 4;

}  // namespace

Foresight::Foresight(const Film& film) : film_(&film) {}

Foresight::Picture Foresight::look(std::size_t i) const {
  Picture picture;
  picture.list = scene::makeDrawList(film_->files, shotOfFrame(*film_, i), film_->format, film_->smooth);
  picture.pages.resize(film_->files.size());
  for (const scene::DrawSurface& surface : picture.list.surfaces) {
    const scene::SceneFile& file = film_->files[surface.source];
    const std::optional<float> t = film_->times[i].frames[surface.source];
    if (!file.shown || !t) continue;
    picture.pages[surface.source] =
        scene::choosePages(file.file->geometryEntries(), *t, file.file->header().last_time, picture.list, surface);
  }
  return picture;
}

const Foresight::Picture& Foresight::advance(std::size_t i) {
  now_ = i;
  if (i > 0 && !ahead_.empty()) ahead_.pop_front();
  const std::size_t known = film_->arrival == Arrival::kWait ? kPicturesAhead : 1;
  while (ahead_.size() < known && i + ahead_.size() < film_->times.size()) ahead_.push_back(look(i + ahead_.size()));
  return ahead_.front();
}

std::vector<stream::Want> Foresight::wants(std::size_t file) const {
  if (film_->arrival == Arrival::kDraw) return wantsOfPace(file);
  const auto entries = film_->files[file].file->geometryEntries();
  std::vector<bool> is_named(entries.size(), false);
  std::vector<stream::Want> wants;
  std::uint64_t bytes = 0;
  for (std::size_t k = 0; k < ahead_.size() && bytes < kBytesAhead; ++k) {
    for (const std::size_t page : ahead_[k].pages[file]) {
      if (is_named[page]) continue;
      is_named[page] = true;
      if (k > 0) bytes += entries[page].raw_bytes;
      wants.push_back({page, static_cast<double>(k)});
    }
  }
  return wants;
}

std::vector<stream::Want> Foresight::wantsOfPace(std::size_t file) const {
  const auto frameOf = [&](std::size_t i) { return film_->times[i].frames[file]; };
  const auto t = frameOf(now_);
  if (!t || !film_->files[file].shown) return {};
  scene::Playing playing;
  // Two equal steps are a direction; a jump is none.
  if (now_ >= 2 && frameOf(now_ - 1) && frameOf(now_ - 2)) {
    const double step = *t - *frameOf(now_ - 1), before = *frameOf(now_ - 1) - *frameOf(now_ - 2);
    if (std::abs(step - before) <= 0.01 * std::abs(step)) playing = {step * film_->fps, kSecondsAhead, std::nullopt};
  }
  const Picture& picture = ahead_.front();
  for (const scene::DrawSurface& surface : picture.list.surfaces) {
    if (surface.source != file) continue;
    const dyntri::File& data = *film_->files[file].file;
    return scene::pagesAhead(data.geometryEntries(), *t, data.header().last_time, playing, picture.list, surface);
  }
  return {};
}

}  // namespace tet4d::host
