// What a chooser and a renderer see of a file's pages: those that are in memory, checked and proved.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "formats/dynamic_triangles.h"

namespace tet4d::stream {

// A page of tetrahedra; every index is below the number of vertices.
struct TetPage {
  std::span<const Vec4f> vertices;
  std::span<const std::array<std::uint32_t, 4>> tets;
};

class Residency {
 public:
  virtual ~Residency() = default;
  // Page `page`, or nullptr if it is not resident. Never reads, never waits. Valid until the next frame begins.
  virtual const dyntri::PageView* resident(std::size_t page) const = 0;
  // The page's values of column `column` of the file: one row of its components for each of the page's vertices, any
  // float; empty if they are not resident. Valid until the next frame begins.
  virtual std::span<const float> residentColumn(std::size_t page, std::size_t column) const {
    static_cast<void>(page), static_cast<void>(column);
    return {};
  }
  // The page as tetrahedra, where that is what the file holds.
  virtual std::optional<TetPage> residentTets(std::size_t page) const {
    static_cast<void>(page);
    return std::nullopt;
  }
};

}  // namespace tet4d::stream
