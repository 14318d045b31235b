// A wall of the data's box: four corners, drawn as a fan.
uniform mat4 relative_to_clip;
uniform vec3 corners[4];

void main() { gl_Position = relative_to_clip * vec4(corners[gl_VertexID], 1.0); }
