// The pages of a film's files: one pager a file, what they hold, and what they have to tell.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "player/host/playback.h"
#include "player/stream/pager.h"
#include "tools/common/session.h"

namespace tet4d::play {

class Pagers {
 public:
  // frame_bytes: of the fullest picture's pages, reserved; kept_bytes: what may be held beyond them. Half of the
  // session's threads check and decode.
  Pagers(cli::Session& session, unsigned io_threads, const host::Film& film, std::uint64_t frame_bytes,
         std::uint64_t kept_bytes);
  std::span<stream::Pager* const> all() const { return pagers_; }

  // Warns of files that changed while open and, if `with_pages`, of pages that were left out; each once.
  void warn(cli::Session& session, bool with_pages) const;
  // Adds to the record: stored bytes read and of them unused, and the most bytes held.
  void count(cli::Session& session) const;

 private:
  std::vector<std::unique_ptr<stream::Pager>> owners_;
  std::vector<stream::Pager*> pagers_;
};

}  // namespace tet4d::play
