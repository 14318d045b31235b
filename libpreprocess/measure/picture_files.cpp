#include "libpreprocess/measure/picture_files.h"

#include <algorithm>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/read_png.h"

namespace tet4d::measure {
namespace {

using exchange::PngRows;

constexpr std::size_t kMostOpen = 32;  // pictures, and as many exact ones

void requireAlike(const PngRows& a, const PngRows& b) {
  if (a.width() == b.width() && a.height() == b.height()) return;
  const auto size = [](const PngRows& p) { return std::to_string(p.width()) + "x" + std::to_string(p.height()); };
  throw Error(FaultCode::kUsage, a.path(), "", "is of " + size(a) + " pixels, " + b.path() + " of " + size(b),
              "give pictures of one size");
}

// Pictures begin … end - 1, the first `counted` of them for the flicker only.
void addPart(const std::vector<std::string>& pictures, const std::vector<std::string>& references, std::size_t begin,
             std::size_t end, std::size_t counted, FilmMeter& meter) {
  std::vector<PngRows> a, b;
  for (std::size_t k = begin; k < end; ++k) {
    a.emplace_back(pictures[k]);
    b.emplace_back(references[k]);
    requireAlike(a.back(), b.back());
    requireAlike(a.back(), a.front());
  }
  std::vector<FilmMeter::Row> rows(a.size()), exact(a.size());
  for (std::uint32_t y = 0; y < a.front().height(); ++y) {
    for (std::size_t k = 0; k < a.size(); ++k) rows[k] = a[k].next(), exact[k] = b[k].next();
    meter.addRow(rows, exact, counted);
  }
}

}  // namespace

PictureError comparePictureFiles(const std::string& picture, const std::string& reference) {
  PngRows a(picture), b(reference);
  requireAlike(a, b);
  PictureMeter meter;
  for (std::uint32_t y = 0; y < a.height(); ++y) {
    const auto row = a.next();
    meter.addRow(row, b.next());
  }
  return meter.result();
}

void addFilm(const std::vector<std::string>& pictures, const std::vector<std::string>& references, FilmMeter& meter) {
  if (pictures.size() != references.size()) {
    throw Error(FaultCode::kUsage, "", "films",
                "of " + std::to_string(pictures.size()) + " and " + std::to_string(references.size()) +
                    " pictures cannot be compared",
                "give as many");
  }
  for (std::size_t begin = 0; begin < pictures.size();) {
    const std::size_t end = std::min(pictures.size(), begin + kMostOpen);
    addPart(pictures, references, begin, end, begin > 0 ? 2 : 0, meter);
    if (end == pictures.size()) break;
    begin = end - 2;  // flicker reaches over the seam
  }
}

}  // namespace tet4d::measure
