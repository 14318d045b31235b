// PNG through libspng. The bytes depend on the picture alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/result.h"
#include "player/render/image.h"

namespace tet4d::host {

// What encoding takes for each pixel while it runs, at most: three bytes as RGB, a buffer that doubles, its copy. A y4m
// frame takes less.
inline constexpr std::uint64_t kEncodingBytes = 12;

// 8-bit RGB (pictures are opaque), marked as sRGB. `name` stands for the file in faults.
Result<std::vector<std::byte>> encodePng(const render::Image& image, const std::string& name);

}  // namespace tet4d::host
