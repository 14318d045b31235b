// What a film will need: its times and cameras are known, so the pages of the pictures to come are, and in which order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "player/host/playback.h"
#include "player/stream/pager.h"

namespace tet4d::host {

class Foresight {
 public:
  // `film` must outlive it.
  explicit Foresight(const Film& film);

  struct Picture {
    scene::DrawList list;                         // camera and surfaces, without items
    std::vector<std::vector<std::size_t>> pages;  // of each file
  };
  // Picture i of the film; i counts up from 0.
  const Picture& advance(std::size_t i);
  // Of the present picture (urgency 0) and of those to come (how many pictures on), for file `file`. With a paced film
  // (Arrival::kDraw) only what follows from the present time and its step is known, as in a window.
  std::vector<stream::Want> wants(std::size_t file) const;

 private:
  Picture look(std::size_t i) const;
  std::vector<stream::Want> wantsOfPace(std::size_t file) const;

  const Film* film_;
  std::size_t now_ = 0;
  std::deque<Picture> ahead_;  // from the present one
};

}  // namespace tet4d::host
