// Texture units of the shaders. Private to player/render.
#pragma once

namespace tet4d::render {

enum GlUnit : int {
  kVerticesUnit,
  kTetsUnit,
  kNormalSumsUnit,
  kColumnUnit,
  kFileNormalsUnit,
  kColorTableUnit,
  kBehindUnit,
  kScratchUnit,  // where textures are made
};

}  // namespace tet4d::render
