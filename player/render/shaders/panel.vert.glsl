// A wall of the data's box: four corners, drawn as a fan.
uniform mat4 relative_to_clip;
uniform vec3 corners[4];

out vec2 place;  // 0..1 along the sides 0-1 and 1-2

void main() {
  place = vec2(gl_VertexID == 1 || gl_VertexID == 2 ? 1.0 : 0.0, gl_VertexID >= 2 ? 1.0 : 0.0);
  gl_Position = relative_to_clip * vec4(corners[gl_VertexID], 1.0);
}
