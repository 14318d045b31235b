#include "player/host/viewer_files.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "formats/container.h"
#include "formats/hypermesh.h"
#include "player/scene/dyntri_chooser.h"
#include "player/scene/pages_ahead.h"

namespace tet4d::host {
namespace {

constexpr double kSecondsAhead = 4;

// The pace in frames of one file, as if its times were evenly spaced.
scene::Playing playingOf(const dyntri::File& file, const Pace& pace) {
  const auto times = file.times();
  const double span = times.back() - times.front();
  if (pace.units_per_second == 0 || !(span > 0)) return {};
  scene::Playing playing{pace.units_per_second * (static_cast<double>(times.size() - 1) / span), kSecondsAhead, {}};
  const auto begin = scene::frameAt(file, pace.begin), end = scene::frameAt(file, pace.end);
  if (pace.loops && begin && end && *begin < *end) playing.loop.emplace(double{*begin}, double{*end});
  return playing;
}

// The colours of a file for what stands in its place now.
scene::Coloring carriedOver(const ViewerFile& old, const dyntri::File& now) {
  scene::Coloring coloring = old.coloring;
  const auto placeOf = [&](std::size_t column) {
    std::size_t place = 0;
    for (; place < now.columns().size(); ++place) {
      if (scene::columnName(now, place) == scene::columnName(old.file, column) &&
          now.columns()[place].components == old.file.columns()[column].components)
        break;
    }
    return place;
  };
  if (coloring.by == scene::ColorBy::kColumn) {
    coloring.column = placeOf(coloring.column);
    if (coloring.column == now.columns().size()) coloring.by = scene::ColorBy::kMaterial, coloring.column = 0;
  }
  if (coloring.normal_column) {
    coloring.normal_column = placeOf(*coloring.normal_column);
    if (*coloring.normal_column == now.columns().size()) coloring.normal_column.reset();
  }
  return coloring;
}

}  // namespace

Result<dyntri::File> openDynamicTriangles(const std::string& path) {
  const auto header = container::peek(path);
  if (!header.ok()) return header.fault();
  if (header.value().payload == hypermesh::kPayload) {
    const std::string output = std::filesystem::path(path).replace_extension(".t4d").string();
    return Fault{FaultCode::kBadInput, path, "", "is a hypermesh, and the player plays dynamic triangles",
                 "run first: dyntri-build " + path + " -o " + output + " (or give --offscreen --renderer tets)"};
  }
  return dyntri::File::open(path);
}

Status ViewerFiles::open(const std::string& path, const scene::Shot& shot) {
  auto opened = openDynamicTriangles(path);
  if (!opened.ok()) return opened.fault();
  auto file = std::make_unique<ViewerFile>(ViewerFile{path, std::move(opened).value()});
  file->scans = std::make_unique<ColumnScans>(file->file);
  std::optional<scene::Material> material;
  for (auto& other : files_) {
    std::error_code error;
    if (other == nullptr || !std::filesystem::equivalent(other->path, path, error)) continue;
    material = other->material;
    file->coloring = carriedOver(*other, file->file);
    other.reset();  // its rank stands for what it was
  }
  file->pager = std::make_unique<stream::Pager>(
      file->file, stream::PagerOptions{budget_bytes_ / (count() + 1), 1, std::max(threads_ / 2, 1u)});
  files_.push_back(std::move(file));
  divideBudget();
  // Told apart by rank, as the files of a command line are.
  const std::vector<scene::SceneFile> ranks(count() == 1 ? 1 : files_.size());
  files_.back()->material = material ? *material : scene::materialOf(ranks, ranks.size() - 1, shot);
  return {};
}

void ViewerFiles::remove(std::size_t rank) {
  if (rank < files_.size()) files_[rank].reset();
  divideBudget();
}

void ViewerFiles::divideBudget() {
  for (const auto& file : files_) {
    if (file != nullptr) file->pager->setBudget(share());
  }
}

std::optional<scene::DrawColumn> ViewerFile::drawn() const {
  const bool reads = coloring.by == scene::ColorBy::kColumn;
  return scene::drawColumnOf(coloring, file, reads ? scans->known(coloring.column, coloring.component) : nullptr);
}

std::vector<Legend> ViewerFiles::legends() const {
  std::vector<Legend> all;
  for (const auto& file : files_) {
    if (file == nullptr || !file->shown) continue;
    const std::optional<scene::DrawColumn> drawn = file->drawn();
    const std::string note = count() > 1 ? std::filesystem::path(file->path).filename().string() : "";
    for (Legend& legend : legendOf(file->file, file->coloring, drawn ? &*drawn : nullptr, note))
      all.push_back(std::move(legend));
  }
  return all;
}

std::size_t ViewerFiles::count() const {
  return static_cast<std::size_t>(
      std::count_if(files_.begin(), files_.end(), [](const auto& file) { return file != nullptr; }));
}

std::vector<scene::SceneFile> ViewerFiles::sceneFiles(std::vector<std::size_t>* ranks) const {
  std::vector<scene::SceneFile> files;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    if (files_[i] == nullptr) continue;
    const ViewerFile& file = *files_[i];
    files.push_back(
        {&file.file, file.material, file.shown, file.drawn(), file.coloring.normal_column, file.coloring.lit});
    if (ranks != nullptr) ranks->push_back(i);
  }
  return files;
}

scene::WorldBox ViewerFiles::box() const { return scene::sceneBox(sceneFiles(nullptr)); }

std::vector<double> ViewerFiles::times() const { return scene::sceneTimes(sceneFiles(nullptr)); }

std::uint64_t ViewerFiles::triangles() const {
  std::uint64_t sum = 0;
  for (const auto& file : files_) sum += file != nullptr ? file->file.header().triangles : 0;
  return sum;
}

scene::DrawList ViewerFiles::list(const Request& request, const scene::Shot& shot, SceneStats& stats,
                                  std::vector<Fault>& faults) {
  askForRanges(request.whole, stats, faults);
  std::vector<std::size_t> ranks;
  const std::vector<scene::SceneFile> files = sceneFiles(&ranks);
  scene::DrawList list = scene::makeDrawList(files, shot, request.format, request.smooth);
  for (std::size_t i = 0; i < files.size(); ++i) {
    list.surfaces[i].source = ranks[i];
    ViewerFile& file = *files_[ranks[i]];
    file.pager->useColumns(scene::columnsOf(files[i]));
    file.pager->beginFrame();
    askForPages(file, request, list, list.surfaces[i], stats);
    for (Fault& fault : file.pager->takeFaults()) {
      file.damaged += fault.place.empty() ? 0 : 1;
      faults.push_back(std::move(fault));
    }
    stats.bytes_touched += file.pager->frameReads().touched;
    stats.resident_bytes += file.pager->totals().held;
    stats.pages_damaged += file.damaged;
  }
  stats.drawn = list.drawn();
  stats.processed = list.processed();
  return list;
}

bool ViewerFiles::isScanning() const {
  return std::any_of(files_.begin(), files_.end(), [](const auto& f) { return f != nullptr && f->scans->busy(); });
}

std::size_t ViewerFiles::scansDone() const {
  std::size_t done = 0;
  for (const auto& file : files_) done += file != nullptr ? file->scans->done() : 0;
  return done;
}

std::uint64_t ViewerFiles::scannedBytes() const {
  std::uint64_t bytes = 0;
  for (const auto& file : files_) bytes += file != nullptr ? file->scans->bytesRead() : 0;
  return bytes;
}

std::uint64_t ViewerFiles::rangesWaiting() const {
  return static_cast<std::uint64_t>(std::count_if(files_.begin(), files_.end(), [](const auto& f) {
    return f != nullptr && f->shown && f->coloring.needsSpread() &&
           f->scans->known(f->coloring.column, f->coloring.component) == nullptr;
  }));
}

// Where values lie, for the colours of the files shown.
void ViewerFiles::askForRanges(bool whole, SceneStats& stats, std::vector<Fault>& faults) {
  for (const auto& file : files_) {
    if (file == nullptr) continue;
    const scene::Coloring& coloring = file->coloring;
    if (file->shown && coloring.needsSpread()) {
      if (whole) file->scans->wait(coloring.column, coloring.component);
      stats.ranges_waiting += file->scans->of(coloring.column, coloring.component) == nullptr ? 1 : 0;
    }
    for (Fault& fault : file->scans->takeFaults()) faults.push_back(std::move(fault));
  }
}

void ViewerFiles::askForPages(ViewerFile& file, const Request& request, const scene::DrawList& list,
                              scene::DrawSurface& surface, SceneStats& stats) {
  const std::optional<float> t = scene::frameAt(file.file, request.time);
  if (!file.shown || !t) return file.pager->want({});
  const float last_t = file.file.header().last_time;
  const auto entries = file.file.geometryEntries();
  const std::vector<stream::Want> wants =
      scene::pagesAhead(entries, *t, last_t, playingOf(file.file, request.pace), list, surface);
  file.pager->want(wants);
  std::vector<std::size_t> pages = scene::choosePages(entries, *t, last_t, list, surface);
  if (request.whole) file.pager->waitFor(pages);
  stats.pages_active += pages.size();
  std::erase_if(pages, [&](std::size_t page) { return file.pager->faultOf(page) != nullptr; });
  scene::chooseTriangles(*file.pager, pages, *t, last_t, surface);
  stats.pages_waiting += surface.absent;
  // A page that is there without its column is drawn grey until that comes.
  const scene::SceneFile drawn{&file.file, std::nullopt, true, surface.column, surface.normal_column};
  const std::vector<std::size_t> columns = scene::columnsOf(drawn);
  stats.pages_waiting += static_cast<std::uint64_t>(std::count_if(pages.begin(), pages.end(), [&](std::size_t page) {
    return entries[page].counts[0] > 0 && file.pager->resident(page) != nullptr &&
           std::any_of(columns.begin(), columns.end(),
                       [&](std::size_t column) { return file.pager->residentColumn(page, column).empty(); });
  }));
}

std::vector<const stream::Residency*> ViewerFiles::residencies() const {
  std::vector<const stream::Residency*> all;
  for (const auto& file : files_) all.push_back(file != nullptr ? file->pager.get() : nullptr);
  return all;
}

}  // namespace tet4d::host
