// Each corner of a living triangle becomes a point that adds the triangle's area vector to the texel of its slice
// vertex (see normals.frag).
layout(triangles) in;
layout(points, max_vertices = 3) out;

uniform ivec2 sums_size;

in vec3 corner_index[];
flat in int corner_key[];
flat in int corner_alive[];

flat out vec3 area;

void main() {
  if (corner_alive[0] + corner_alive[1] + corner_alive[2] != 3) return;
  vec3 origin = corner_index[0];
  vec3 sum = cross(corner_index[1] - origin, corner_index[2] - origin);
  for (int i = 0; i < 3; ++i) {
    vec2 texel = vec2(corner_key[i] % sums_size.x, corner_key[i] / sums_size.x) + 0.5;
    area = sum;
    gl_Position = vec4(2.0 * texel / vec2(sums_size) - 1.0, 0.0, 1.0);
    EmitVertex();
    EndPrimitive();
  }
}
