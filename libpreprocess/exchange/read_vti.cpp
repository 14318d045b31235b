#include "libpreprocess/exchange/read_vti.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/header_text.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/vtk_array.h"
#include "libpreprocess/exchange/vtk_selection.h"

namespace tet4d::exchange {
namespace {

constexpr const char* kMakeAgain = "write the file again";
constexpr std::size_t kMaxPieces = 4096;
constexpr std::size_t kBufferBytes = std::size_t{1} << 18;

// Inclusive indices of points: first and last along x, y, z.
struct Extent {
  std::array<std::int64_t, 3> first{}, last{};
  std::uint64_t points(std::size_t axis) const { return static_cast<std::uint64_t>(last[axis] - first[axis]) + 1; }
};

Extent extentOf(const VtkDocument& document, const XmlElement& element, std::string_view attribute) {
  constexpr std::int64_t kMost = std::int64_t{1} << 31;
  const std::string& text = document.need(element, attribute);
  const auto words = wordsOf(text);
  Extent extent;
  bool good = words.size() == 6;
  for (std::size_t axis = 0; good && axis < 3; ++axis) {
    const auto first = integerOf(words[2 * axis]), last = integerOf(words[2 * axis + 1]);
    good = first && last && *first >= -kMost && *last <= kMost && *first <= *last;
    if (good) extent.first[axis] = *first, extent.last[axis] = *last;
  }
  if (good) return extent;
  document.fail(element,
                std::string(attribute) + " is " + inQuotes(text) +
                    ", expected six whole numbers, the first and last index along x, y and z",
                kMakeAgain);
}

// A piece of the grid of samples: points or cells.
struct Piece {
  Extent points;
  std::array<std::uint64_t, 3> begin{}, dims{};  // of its samples in the whole grid
  const XmlElement* array = nullptr;
  std::uint64_t samples() const { return dims[0] * dims[1] * dims[2]; }
};

class VtiFile final : public FrameFile {
 public:
  VtiFile(const std::string& path, std::string array) : wanted_(std::move(array)) {
    header_.path = path;
    const auto opened = open();
    header_ = opened->header;
  }
  const FrameFileHeader& header() const override { return header_; }
  void close() override { open_.reset(); }

  void readLayers(std::uint64_t /*frame*/, std::uint64_t z_begin, std::uint64_t z_end,
                  std::span<std::byte> samples) override {
    if (!open_) {
      open_ = open();
      if (open_->header.grid.dims != header_.grid.dims || open_->header.grid.type != header_.grid.type) {
        throw Error(FaultCode::kBadInput, header_.path, "", "the file was changed while it was read", "run it again");
      }
    }
    for (std::size_t i = 0; i < open_->pieces.size(); ++i) {
      const Piece& piece = open_->pieces[i];
      const std::uint64_t begin = std::max(z_begin, piece.begin[2]);
      const std::uint64_t end = std::min(z_end, piece.begin[2] + piece.dims[2]);
      if (begin < end && piece.samples() > 0) readPiece(i, {begin, end}, z_begin, samples);
    }
  }

 private:
  struct Opened {
    FrameFileHeader header;
    std::shared_ptr<const InputFile> file;
    VtkDocument document;
    VtkSelection selection;
    std::vector<Piece> pieces;
    std::vector<std::unique_ptr<VtkArray>> arrays;  // one a piece
    std::vector<std::byte> buffer;
  };

  std::unique_ptr<Opened> open() const;
  void openPieces(Opened& opened, const XmlElement& image, const Extent& whole) const;
  void setGrid(Opened& opened, const XmlElement& image, const Extent& whole) const;
  static void checkCoverage(const Opened& opened, const XmlElement& image, const Extent& whole);
  static void readTime(Opened& opened, const XmlElement& image);
  void readPiece(std::size_t index, std::pair<std::uint64_t, std::uint64_t> layers, std::uint64_t z_origin,
                 std::span<std::byte> samples);

  std::string wanted_;
  FrameFileHeader header_;
  std::unique_ptr<Opened> open_;
};

// Samples along an axis with so many points: cells lie between points, but a flat image has one layer of them.
std::uint64_t samplesAlong(std::uint64_t points, bool of_cells) {
  return of_cells ? std::max<std::uint64_t>(points - 1, 1) : points;
}

std::unique_ptr<VtiFile::Opened> VtiFile::open() const {
  auto opened = std::make_unique<Opened>();
  opened->header.path = header_.path;
  opened->file = std::make_shared<InputFile>(header_.path);
  opened->document = readVtkDocument(*opened->file);
  const VtkDocument& document = opened->document;
  if (document.type != "ImageData") {
    document.fail(document.root, "the file is of type " + inQuotes(document.type) + ", expected ImageData",
                  "resample it to an image (.vti) first");
  }
  const XmlElement& image = document.dataset();
  const Extent whole = extentOf(document, image, "WholeExtent");
  openPieces(*opened, image, whole);
  setGrid(*opened, image, whole);
  checkCoverage(*opened, image, whole);
  for (const Piece& piece : opened->pieces) {
    opened->arrays.push_back(openVtkArray(document, *piece.array, opened->file, piece.samples()));
    const VtkArray& array = *opened->arrays.back();
    if (array.type() != opened->arrays.front()->type() || array.components() != opened->arrays.front()->components()) {
      document.fail(*piece.array, "its type or components differ from those in the first piece", kMakeAgain);
    }
    // Another piece may have another array of components.
    if (piece.samples() > 0 && opened->selection.component >= array.components()) {
      document.fail(*piece.array, "it has no component " + std::to_string(opened->selection.component), kMakeAgain);
    }
  }
  opened->header.grid.type = opened->arrays.front()->type();
  readTime(*opened, image);
  return opened;
}

void VtiFile::openPieces(Opened& opened, const XmlElement& image, const Extent& whole) const {
  const VtkDocument& document = opened.document;
  for (const XmlElement& element : image.children) {
    if (element.name != "Piece") continue;
    if (opened.pieces.empty()) opened.selection = selectVtkScalar(document, element, wanted_);
    if (opened.pieces.size() == kMaxPieces) {
      document.fail(element, "there are more than " + std::to_string(kMaxPieces) + " pieces", "merge them");
    }
    Piece piece;
    piece.points = extentOf(document, element, "Extent");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Extent& points = piece.points;
      if (points.first[axis] < whole.first[axis] || points.last[axis] > whole.last[axis]) {
        document.fail(element, "its Extent leaves the image's WholeExtent", kMakeAgain);
      }
      piece.begin[axis] = static_cast<std::uint64_t>(points.first[axis] - whole.first[axis]);
      // Where the whole has cells, a piece of one layer of points has none.
      const bool has_cells = opened.selection.of_cells && whole.points(axis) > 1;
      piece.dims[axis] = has_cells ? points.points(axis) - 1 : points.points(axis);
    }
    piece.array = &selectedArray(document, element, opened.selection);
    opened.pieces.push_back(piece);
  }
  if (opened.pieces.empty()) document.fail(image, "the image has no <Piece>", kMakeAgain);
}

// Dims, origin, spacing and direction.
void VtiFile::setGrid(Opened& opened, const XmlElement& image, const Extent& whole) const {
  const VtkDocument& document = opened.document;
  GridInfo& grid = opened.header.grid;
  std::uint64_t most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / sizeof(double);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.dims[axis] = samplesAlong(whole.points(axis), opened.selection.of_cells);
    if (grid.dims[axis] > most) document.fail(image, "its WholeExtent holds 2^60 samples or more", kMakeAgain);
    most /= grid.dims[axis];
  }
  const auto origin = document.numbers(image, "Origin", 3, {0, 0, 0});
  const auto spacing = document.numbers(image, "Spacing", 3, {1, 1, 1});
  const auto direction = document.numbers(image, "Direction", 9, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  AffineMap& map = grid.index_to_world;
  std::copy(origin.begin(), origin.end(), map.origin.begin());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_shifted = opened.selection.of_cells && whole.points(axis) > 1;
    const double first = static_cast<double>(whole.first[axis]) + (is_shifted ? 0.5 : 0.0);
    for (std::size_t c = 0; c < 3; ++c) {
      map.axes[axis][c] = direction[3 * c + axis] * spacing[axis];
      map.origin[c] += first * map.axes[axis][c];
    }
  }
  if (!isUsable(map)) {
    document.fail(image, "its Spacing and Direction do not span space, or are too large", "correct them");
  }
}

// Every cell of the whole lies in exactly one piece.
void VtiFile::checkCoverage(const Opened& opened, const XmlElement& image, const Extent& whole) {
  const auto cellsOf = [&](const Extent& extent) {
    std::uint64_t cells = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (whole.points(axis) > 1) cells *= extent.points(axis) - 1;
    }
    return cells;
  };
  std::uint64_t covered = 0;
  for (std::size_t i = 0; i < opened.pieces.size(); ++i) {
    const Extent& a = opened.pieces[i].points;
    const std::uint64_t cells = cellsOf(a);
    for (std::size_t j = 0; j < i && cells > 0; ++j) {
      const Extent& b = opened.pieces[j].points;
      bool overlaps = cellsOf(b) > 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (whole.points(axis) > 1) overlaps &= a.first[axis] < b.last[axis] && b.first[axis] < a.last[axis];
      }
      if (overlaps) {
        opened.document.fail(image, "pieces " + std::to_string(j) + " and " + std::to_string(i) + " overlap",
                             kMakeAgain);
      }
    }
    covered += cells;
  }
  if (covered != cellsOf(whole)) {
    opened.document.fail(image,
                         "its pieces hold " + std::to_string(covered) + " of the " + std::to_string(cellsOf(whole)) +
                             " cells of WholeExtent",
                         kMakeAgain);
  }
}

void VtiFile::readTime(Opened& opened, const XmlElement& image) {
  const XmlElement* fields = image.child("FieldData");
  if (fields == nullptr) return;
  for (const XmlElement& array : fields->children) {
    const std::string* name = array.attribute("Name");
    if (array.name != "DataArray" || name == nullptr || *name != "TimeValue") continue;
    double time = 0;
    openVtkArray(opened.document, array, opened.file, 1)->readNumbers(0, std::span(&time, 1));
    if (!std::isfinite(time)) opened.document.fail(array, "the time is " + numberText(time), "give a finite time");
    opened.header.times = {time};
    return;
  }
}

// Layers of a piece into a buffer that begins with layer z_origin of the whole.
void VtiFile::readPiece(std::size_t index, std::pair<std::uint64_t, std::uint64_t> layers, std::uint64_t z_origin,
                        std::span<std::byte> samples) {
  const Piece& piece = open_->pieces[index];
  VtkArray& array = *open_->arrays[index];
  const std::uint64_t bytes = sampleBytes(array.type()), components = array.components();
  const std::uint64_t layer = piece.dims[0] * piece.dims[1];
  const std::uint64_t first = (layers.first - piece.begin[2]) * layer, end = (layers.second - piece.begin[2]) * layer;
  const auto& dims = header_.grid.dims;
  if (components == 1 && piece.dims[0] == dims[0] && piece.dims[1] == dims[1]) {
    const std::uint64_t at = (layers.first - z_origin) * layer * bytes;
    array.read(first, samples.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>((end - first) * bytes)));
    return;
  }
  const std::uint64_t tuple = components * bytes;
  if (tuple > kBufferBytes) open_->document.fail(*piece.array, "it has too many components", "write one component");
  open_->buffer.resize(kBufferBytes);
  for (std::uint64_t at = first; at < end;) {
    const std::uint64_t count = std::min<std::uint64_t>(end - at, kBufferBytes / tuple);
    array.read(at * components, std::span(open_->buffer).first(static_cast<std::size_t>(count * tuple)));
    const std::byte* from = open_->buffer.data() + open_->selection.component * bytes;
    for (const std::uint64_t stop = at + count; at < stop;) {
      const std::uint64_t x = at % piece.dims[0], y = at / piece.dims[0] % piece.dims[1], z = at / layer;
      const std::uint64_t run = std::min(stop - at, piece.dims[0] - x);
      const std::uint64_t to =
          ((piece.begin[2] + z - z_origin) * dims[1] + piece.begin[1] + y) * dims[0] + piece.begin[0] + x;
      std::byte* out = samples.data() + to * bytes;
      for (std::uint64_t i = 0; i < run; ++i, out += bytes, from += tuple) {
        std::memcpy(out, from, static_cast<std::size_t>(bytes));
      }
      at += run;
    }
  }
}

}  // namespace

std::unique_ptr<FrameFile> openVti(const std::string& path, const std::string& array) {
  return std::make_unique<VtiFile>(path, array);
}

std::vector<PvdStep> readPvd(const std::string& path) {
  const InputFile file(path);
  const VtkDocument document = readVtkDocument(file);
  if (document.type != "Collection") {
    document.fail(document.root, "the file is of type " + inQuotes(document.type) + ", expected Collection",
                  "give a .pvd series");
  }
  std::vector<PvdStep> steps;
  for (const XmlElement& element : document.dataset().children) {
    if (element.name != "DataSet") continue;
    const std::string& text = document.need(element, "timestep");
    const auto time = numberOf(text);
    if (!time || !std::isfinite(*time)) {
      document.fail(element, "timestep is " + inQuotes(text) + ", expected a finite number", "correct the time");
    }
    const std::filesystem::path name(document.need(element, "file"));
    const auto beside = std::filesystem::path(path).parent_path() / name;  // name itself where it is absolute
    steps.push_back({*time, beside.string()});
  }
  std::stable_sort(steps.begin(), steps.end(), [](const PvdStep& a, const PvdStep& b) { return a.time < b.time; });
  const auto same = std::adjacent_find(steps.begin(), steps.end(),
                                       [](const PvdStep& a, const PvdStep& b) { return a.time == b.time; });
  if (same != steps.end()) {
    throw Error(FaultCode::kBadInput, path, "time " + numberText(same->time),
                "several files are of this time: " + same->file + " and " + std::next(same)->file,
                "merge the parts of a time into one file");
  }
  if (steps.empty()) throw Error(FaultCode::kBadInput, path, "", "the series names no files", kMakeAgain);
  return steps;
}

}  // namespace tet4d::exchange
