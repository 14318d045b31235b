// Panels: positions in ImGui's units, colours as bytes.
uniform vec2 origin, extent;  // of the display

layout(location = 0) in vec2 position;
layout(location = 1) in vec2 texel;
layout(location = 2) in vec4 tint;

out vec2 place;
out vec4 shade;

void main() {
  place = texel;
  shade = tint;
  vec2 unit = (position - origin) / extent;
  gl_Position = vec4(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y, 0.0, 1.0);
}
