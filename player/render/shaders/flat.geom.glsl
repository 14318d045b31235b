// Living triangles, each with its own normal.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

uniform mat3 normal_to_relative;

in vec3 corner_index[];
in vec3 corner_position[];
in float corner_value[];
flat in int corner_alive[];

out vec3 position, normal;
out float value;

void main() {
  if (corner_alive[0] + corner_alive[1] + corner_alive[2] != 3) return;
  vec3 origin = corner_index[0];
  vec3 area = normal_to_relative * cross(corner_index[1] - origin, corner_index[2] - origin);
  float size = length(area);
  for (int i = 0; i < 3; ++i) {
    normal = size > 0.0 ? area / size : vec3(0.0);
    position = corner_position[i];
    value = corner_value[i];
    gl_Position = gl_in[i].gl_Position;
    EmitVertex();
  }
  EndPrimitive();
}
