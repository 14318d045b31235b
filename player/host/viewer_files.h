// The files open in the player, and the pages of them that are in memory.
//
// A file keeps its rank for as long as the program runs, also when others are removed: renderers keep copies by rank.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "player/host/column_scans.h"
#include "player/host/legend.h"
#include "player/scene/coloring.h"
#include "player/scene/scene_files.h"
#include "player/stream/pager.h"

namespace tet4d::host {

// Opens dynamic triangles. For a hypermesh the Fault says how to make them from it.
Result<dyntri::File> openDynamicTriangles(const std::string& path);

struct ViewerFile {
  std::string path;
  dyntri::File file;
  scene::Material material = {};
  bool shown = true;
  scene::Coloring coloring = {};
  std::unique_ptr<stream::Pager> pager = nullptr;  // after `file`: goes before it
  std::unique_ptr<ColumnScans> scans = nullptr;    // likewise
  std::uint64_t damaged = 0;  // pages that cannot be read, so far: reported once each, then left out

  // What the present coloring comes to; nothing by material, or as long as the values' range is not known.
  std::optional<scene::DrawColumn> drawn() const;
};

// What one picture cost and had to do with.
struct SceneStats {
  std::uint64_t drawn = 0, processed = 0, bytes_touched = 0, resident_bytes = 0;
  std::uint64_t pages_active = 0;   // to be drawn
  std::uint64_t pages_waiting = 0;  // of them, on their way: not in the picture
  std::uint64_t pages_damaged = 0;
  std::uint64_t ranges_waiting = 0;  // columns whose range is being found out: drawn by material until then
  double ms = 0;
  bool is_first = false;  // of its kind: see scene::DrawnKinds
};

// How time runs, for pages to be there in time.
struct Pace {
  double units_per_second = 0;  // world time, negative backward; 0: it stands still
  double begin = 0, end = 0;    // of the range, if it is played again and again
  bool loops = false;
};

class ViewerFiles {
 public:
  // budget_bytes: of pages, of all files together; each open file has an equal share of it.
  ViewerFiles(std::uint64_t budget_bytes, unsigned threads)
      : budget_bytes_(budget_bytes), threads_(threads > 1 ? threads : 1) {}

  // The file comes after those that are open, and they make room for it. A file that is open already is read anew, with
  // the colours that it had as far as it still has their columns.
  Status open(const std::string& path, const scene::Shot& shot);
  void remove(std::size_t rank);
  // Bytes of pages that a file may keep now.
  std::uint64_t share() const { return budget_bytes_ / std::max<std::size_t>(1, count()); }

  // By rank; null where one was removed.
  const std::vector<std::unique_ptr<ViewerFile>>& all() const { return files_; }
  std::vector<std::unique_ptr<ViewerFile>>& all() { return files_; }
  std::size_t count() const;

  scene::WorldBox box() const;
  std::vector<double> times() const;
  std::uint64_t triangles() const;

  struct Request {
    double time = 0;  // world
    scene::Format format;
    bool smooth = true;
    Pace pace;
    // Wait for all pages, for a picture that is kept; otherwise what is there is drawn, and nothing waits.
    bool whole = false;
  };
  // The draw list at a time; pages it lacks, and those of the near future, are asked for. A page that cannot be read is
  // left out, and its Fault added to `faults` once.
  scene::DrawList list(const Request& request, const scene::Shot& shot, SceneStats& stats, std::vector<Fault>& faults);
  // Whether a thread is finding out where values lie; how many files shown wait for it.
  bool isScanning() const;
  std::uint64_t rangesWaiting() const;
  std::size_t scansDone() const;
  // Read to find out where values lie, of the files open now, drawn or not: no part of a picture's bytes_touched.
  std::uint64_t scannedBytes() const;
  // Of the files shown, by their present coloring.
  std::vector<Legend> legends() const;
  // What renderers see of the files, by rank.
  std::vector<const stream::Residency*> residencies() const;

 private:
  std::vector<scene::SceneFile> sceneFiles(std::vector<std::size_t>* ranks) const;
  static void askForPages(ViewerFile& file, const Request& request, const scene::DrawList& list,
                          scene::DrawSurface& surface, SceneStats& stats);

  void divideBudget();
  void askForRanges(bool whole, SceneStats& stats, std::vector<Fault>& faults);

  std::uint64_t budget_bytes_;
  unsigned threads_;
  std::vector<std::unique_ptr<ViewerFile>> files_;
};

}  // namespace tet4d::host
