// A vertical gradient between two sRGB colours.
uniform vec3 top, bottom;

in float height;
out vec4 color;

void main() { color = vec4(bottom + height * (top - bottom), 1.0); }
