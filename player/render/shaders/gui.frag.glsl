// Panels: colour times the font atlas.
uniform sampler2D atlas;

in vec2 place;
in vec4 shade;
out vec4 color;

void main() { color = shade * texture(atlas, place); }
