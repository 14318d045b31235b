#include "player/render/renderer.h"

#include <algorithm>
#include <string>
#include <utility>

namespace tet4d::render {

Status Renderer::start(const scene::DrawList& list, std::span<const stream::Residency* const> sources) {
  auto image = draw(list, sources);
  if (!image.ok()) return image.fault();
  started_ = std::move(image).value();
  return {};
}

Result<Image> Renderer::take() { return std::move(started_); }

Result<std::uint32_t> sampleGrid(const scene::Format& format) {
  std::uint32_t side = 0;
  for (const std::uint32_t candidate : {1u, 2u, 3u, 4u}) {
    if (candidate * candidate == format.samples) side = candidate;
  }
  if (side == 0) {
    return Fault{FaultCode::kUsage, "", "samples",
                 "found " + std::to_string(format.samples) + ", expected 1, 4, 9 or 16", "give --samples 4"};
  }
  const std::uint32_t longest = std::max(format.width, format.height);
  if (format.width == 0 || format.height == 0 || longest > kMaxSide / side) {
    return Fault{FaultCode::kUsage, "", "size",
                 "found " + std::to_string(format.width) + "x" + std::to_string(format.height) + " with " +
                     std::to_string(format.samples) + " samples a pixel, expected sides from 1 to " +
                     std::to_string(kMaxSide / side),
                 "give a smaller --size or fewer --samples"};
  }
  return side;
}

std::vector<std::span<const scene::DrawItem>> itemsByPage(std::span<const scene::DrawItem> items) {
  std::vector<std::span<const scene::DrawItem>> pages;
  for (std::size_t first = 0, end = 0; first < items.size(); first = end) {
    while (end < items.size() && items[end].page == items[first].page) ++end;
    pages.push_back(items.subspan(first, end - first));
  }
  return pages;
}

Fault absentPage(std::size_t page) {
  return {FaultCode::kUsage, "", "page " + std::to_string(page), "is to be drawn but is not resident",
          "load the pages that the chooser names before drawing"};
}

}  // namespace tet4d::render
