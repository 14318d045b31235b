// One sRGB colour, unlit.
uniform vec3 panel_color;

out vec4 color;

void main() { color = vec4(panel_color, 1.0); }
