#include "tools/play/pagers.h"

#include <algorithm>

namespace tet4d::play {

Pagers::Pagers(cli::Session& session, unsigned io_threads, const host::Film& film, std::uint64_t frame_bytes,
               std::uint64_t kept_bytes) {
  // Several files share the room; each holds its own part of a picture's pages whatever its budget.
  const std::size_t files = film.files.size();
  const std::uint64_t budget = kept_bytes / files + (files == 1 ? frame_bytes : 0);
  const unsigned decode_threads = std::max(static_cast<unsigned>(session.executor().threads()) / 2, 1U);
  for (const scene::SceneFile& file : film.files) {
    owners_.push_back(
        std::make_unique<stream::Pager>(*file.file, stream::PagerOptions{budget, io_threads, decode_threads}));
    pagers_.push_back(owners_.back().get());
  }
}

void Pagers::warn(cli::Session& session, bool with_pages) const {
  for (stream::Pager* pager : pagers_) {
    for (const Fault& fault : pager->takeFaults()) {
      if (fault.place.empty()) {
        session.warn(fault.file + ": " + fault.what + ": " + fault.remedy);
      } else if (with_pages) {
        session.warn(fault.file + ": " + fault.place + ": " + fault.what + ": left out");
      }
    }
  }
}

void Pagers::count(cli::Session& session) const {
  stream::Pager::Totals sum;
  for (const stream::Pager* pager : pagers_) {
    const stream::Pager::Totals totals = pager->totals();
    sum.read += totals.read;
    sum.unused += totals.unused;
    sum.peak += totals.peak;
  }
  session.stats().count("page_bytes_read", sum.read);
  session.stats().count("page_bytes_unused", sum.unused);
  session.stats().count("page_bytes_peak", sum.peak);
}

}  // namespace tet4d::play
