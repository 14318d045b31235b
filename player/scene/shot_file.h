// The camera file: a Shot as JSON. All keys are optional; what is missing is taken from the defaults.
//
//   { "eye": [x,y,z], "target": [x,y,z], "up": [x,y,z],            world units; eye and target come together
//     "fov_y_degrees": 32  |  "ortho_height": 10,                  one of the two
//     "near": 0.1, "far": 100,                                     distances along the view
//     "lights": [{"direction": [x,y,z], "color": [r,g,b]}, …],     the way the light travels; linear
//     "ambient": [r,g,b],                                          linear
//     "material": {"color": [r,g,b], "back_color": [r,g,b], "specular": 0.25, "shininess": 48,   sRGB
//                  "refraction": 0 | 1..3, "tint": 0..1},                    opaque, or an index; how much of the
//                  colour
//     "background": [r,g,b]  |  {"top": [r,g,b], "bottom": [r,g,b], "room": [r,g,b] | false,     sRGB
//                                                                 "checker": squares a wall} }
// A background of one colour has no room; "room" is the far walls and the floor of the data's box.
#pragma once

#include <string>
#include <string_view>

#include "formats/core/result.h"
#include "player/scene/shot.h"

namespace tet4d::scene {

// Reads a camera file. A Fault names the file, the key (as `lights[1].color`), what was found and what was expected; a
// misspelt key is a fault that names the nearest one.
Result<Shot> readShot(const std::string& path, const Shot& defaults);

// As readShot(), from text; `name` stands for the file in faults.
Result<Shot> parseShot(std::string_view text, const std::string& name, const Shot& defaults);

// The JSON text of a shot, with every key. parseShot(formatShot(s)) gives s back bit for bit.
std::string formatShot(const Shot& shot);

}  // namespace tet4d::scene
