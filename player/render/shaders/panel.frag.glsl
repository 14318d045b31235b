// One sRGB colour, or a checker of it and a darker one; unlit.
uniform vec3 panel_color;
uniform vec2 squares;
uniform float checker_shade;

in vec2 place;
out vec4 color;

void main() {
  vec2 square = floor(place * squares);
  bool dark = mod(square.x + square.y, 2.0) == 1.0;
  color = vec4(dark ? checker_shade * panel_color : panel_color, 1.0);
}
