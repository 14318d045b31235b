// The lookup shader of dynamic triangles. Ponchio & Hormann 2008, sec. 7.1, figure 8: a triangle's corner names an edge,
// the edge two vertices of space-time, and the corner lies where the edge crosses time t.
//
// Drawn indexed: an index is an edge, so each slice vertex is computed once for as long as the driver's cache keeps it.
// A triangle lives exactly while its three edges do (formats/dynamic_triangles.h); a vertex says whether its edge does.
// Variants of one text:
//   BY_TRIANGLE        hands corners to a geometry shader, which knows all three, here normals.geom
//   BY_TRIANGLE, FLAT  and here flat.geom
//   (neither)          the vertex of a smooth surface, with the file's normal or the one that normals.geom summed up
//   BY_COLUMN          with a column's value

layout(location = 0) in uvec2 ends;  // vertices a, b of the edge, t(a) < t(b)

uniform samplerBuffer vertices;  // x, y, z (cells), t (frames)
uniform float t, last_t;
uniform int edge_count;

struct Crossing {
  vec3 position;  // index space
  float lambda;   // 0..1, also where the edge is dead
  int key;        // the edge, or edge_count + the end where t is exactly that end's time
  bool alive;
};

// As interpolateAt() and isAlive() in formats/core/tet_slice.h, and the keys of player/render/page_slice.h.
Crossing crossingOfEdge() {
  vec4 a = texelFetch(vertices, int(ends.x));
  vec4 b = texelFetch(vertices, int(ends.y));
  bool alive = a.w <= t && (t < b.w || (t == b.w && b.w == last_t));
  if (t >= b.w) return Crossing(b.xyz, 1.0, edge_count + int(ends.y), alive);
  if (t <= a.w) return Crossing(a.xyz, 0.0, edge_count + int(ends.x), alive);
  float lambda = (t - a.w) / (b.w - a.w);
  return Crossing(a.xyz + lambda * (b.xyz - a.xyz), lambda, gl_VertexID, alive);
}

uniform vec3 index_centre, offset;
uniform mat3 index_to_relative, normal_to_relative;
uniform mat4 relative_to_clip;

float between(float a, float b, float lambda) {
  return lambda == 0.0 ? a : lambda == 1.0 ? b : a + lambda * (b - a);
}

#ifdef BY_COLUMN

uniform int components;        // of the column, 0: no column, or its page is not there; -1: page_value
uniform float page_value;      // of all of the page
uniform int component;         // -1: the length
uniform samplerBuffer column;  // of vertex v from v * components

// As valueOf() in player/render/slice_columns.h.
float columnValue(float lambda) {
  if (components == 0) return uintBitsToFloat(0x7fc00000u);  // NaN
  if (components < 0) return page_value;
  float squares = 0.0;
  for (int i = 0; i < components; ++i) {
    float x = between(texelFetch(column, components * int(ends.x) + i).x,
                      texelFetch(column, components * int(ends.y) + i).x, lambda);
    if (i == component) return x;
    squares += x * x;
  }
  return sqrt(squares);
}

#else

float columnValue(float lambda) { return 0.0; }

#endif

#ifdef BY_TRIANGLE

out vec3 corner_index;     // index space
out vec3 corner_position;  // relative to the scene's centre
out float corner_value;
flat out int corner_key;
flat out int corner_alive;

void main() {
  Crossing c = crossingOfEdge();
  corner_index = c.position;
  corner_key = c.key;
  corner_alive = c.alive ? 1 : 0;
#ifdef FLAT
  corner_value = columnValue(c.lambda);
  corner_position = index_to_relative * (c.position - index_centre) + offset;
  gl_Position = relative_to_clip * vec4(corner_position, 1.0);
#else
  corner_value = 0.0;
  corner_position = vec3(0.0);
  gl_Position = vec4(0.0);
#endif
}

#else

uniform sampler2D normal_sums;
uniform ivec2 sums_size;  // texels of the normal sums: key k stands at (k % width, k / width)
uniform bool has_file_normals;
uniform samplerBuffer file_normals;  // x, y, z of vertex v at 3 v, world

out vec3 position, normal;
out float value;
out float gl_ClipDistance[1];

vec3 fileNormal(float lambda) {
  vec3 n;
  for (int i = 0; i < 3; ++i) {
    n[i] = between(texelFetch(file_normals, 3 * int(ends.x) + i).x, texelFetch(file_normals, 3 * int(ends.y) + i).x,
                   lambda);
  }
  return n;
}

void main() {
  Crossing c = crossingOfEdge();
  // A triangle with a dead corner is clipped away as a whole: so far outside is that corner that the cut falls onto the
  // living ones, in float exactly. (With the place itself outside, as in the paper, slivers would be left.)
  gl_ClipDistance[0] = c.alive ? 1.0 : -1e30;
  value = columnValue(c.lambda);
  vec3 area = has_file_normals ? fileNormal(c.lambda)
                               : normal_to_relative *
                                     texelFetch(normal_sums, ivec2(c.key % sums_size.x, c.key / sums_size.x), 0).xyz;
  float size = length(area);
  normal = size > 0.0 ? area / size : vec3(0.0);
  position = index_to_relative * (c.position - index_centre) + offset;
  gl_Position = relative_to_clip * vec4(position, 1.0);
}

#endif
