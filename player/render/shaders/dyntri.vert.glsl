// The lookup shader of dynamic triangles. Ponchio & Hormann 2008, sec. 7.1, figure 8: a triangle's corner names an edge,
// the edge two vertices of space-time, and the corner lies where the edge crosses time t.
//
// Drawn without attributes: gl_VertexID = 3 * triangle + corner. Three variants of one text:
//   ACCUMULATE  one point a corner: adds the triangle's area vector to the texel of its slice vertex (see normals.frag)
//   FLAT        triangles, each with its own normal
//   (neither)   triangles, with the normals that ACCUMULATE summed up

uniform samplerBuffer vertices;    // x, y, z (cells), t (frames)
uniform usamplerBuffer edges;      // a, b with t(a) < t(b)
uniform usamplerBuffer triangles;  // an edge a texel, three a triangle
uniform samplerBuffer lifespans;   // begin, end
uniform int edge_count;
uniform float t, last_t;
uniform ivec2 sums_size;  // texels of the normal sums: key k stands at (k % width, k / width)

struct Crossing {
  vec3 position;  // index space
  int key;        // the edge, or edge_count + the end where t is exactly that end's time
  ivec2 ends;
  float lambda;
};

// As interpolateAt() in formats/core/tet_slice.h, and the keys of player/render/page_slice.h.
Crossing crossingOf(int triangle, int corner) {
  int edge = int(texelFetch(triangles, 3 * triangle + corner).x);
  uvec2 ends = texelFetch(edges, edge).xy;
  vec4 a = texelFetch(vertices, int(ends.x));
  vec4 b = texelFetch(vertices, int(ends.y));
  if (t == b.w) return Crossing(b.xyz, edge_count + int(ends.y), ivec2(ends), 1.0);
  float lambda = (t - a.w) / (b.w - a.w);
  int key = t == a.w ? edge_count + int(ends.x) : edge;
  return Crossing(a.xyz + lambda * (b.xyz - a.xyz), key, ivec2(ends), lambda);
}

// Half-open, closed at the last time: isAlive() in formats/core/tet_slice.h.
bool isAlive(int triangle) {
  vec2 life = texelFetch(lifespans, triangle).xy;
  return life.x <= t && (t < life.y || (t == life.y && life.y == last_t));
}

vec3 areaVector(int triangle) {
  vec3 origin = crossingOf(triangle, 0).position;
  return cross(crossingOf(triangle, 1).position - origin, crossingOf(triangle, 2).position - origin);
}

// All corners of a dead triangle go to one point outside the view volume.
const vec4 kOutside = vec4(2.0, 2.0, 2.0, 1.0);

#ifdef ACCUMULATE

flat out vec3 area;

void main() {
  int triangle = gl_VertexID / 3;
  area = vec3(0.0);
  gl_Position = kOutside;
  if (!isAlive(triangle)) return;
  area = areaVector(triangle);
  int key = crossingOf(triangle, gl_VertexID % 3).key;
  vec2 texel = vec2(key % sums_size.x, key / sums_size.x) + 0.5;
  gl_Position = vec4(2.0 * texel / vec2(sums_size) - 1.0, 0.0, 1.0);
}

#else

uniform sampler2D normal_sums;
uniform vec3 index_centre, offset;
uniform mat3 index_to_relative, normal_to_relative;
uniform mat4 relative_to_clip;

uniform bool has_file_normals;
uniform samplerBuffer file_normals;  // x, y, z of vertex v at 3 v, world
uniform int components;              // of the column, 0: no column, or its page is not there; -1: page_value
uniform float page_value;            // of all of the page
uniform int component;               // -1: the length
uniform samplerBuffer column;        // of vertex v from v * components

out vec3 position, normal;
out float value;

float between(float a, float b, float lambda) {
  return lambda == 0.0 ? a : lambda == 1.0 ? b : a + lambda * (b - a);
}

vec3 fileNormal(Crossing c) {
  vec3 n;
  for (int i = 0; i < 3; ++i) {
    n[i] = between(texelFetch(file_normals, 3 * c.ends.x + i).x, texelFetch(file_normals, 3 * c.ends.y + i).x, c.lambda);
  }
  return n;
}

// As valueOf() in player/render/slice_columns.h.
float columnValue(Crossing c) {
  if (components == 0) return uintBitsToFloat(0x7fc00000u);  // NaN
  if (components < 0) return page_value;
  float squares = 0.0;
  for (int i = 0; i < components; ++i) {
    float x = between(texelFetch(column, components * c.ends.x + i).x, texelFetch(column, components * c.ends.y + i).x,
                      c.lambda);
    if (i == component) return x;
    squares += x * x;
  }
  return sqrt(squares);
}

void main() {
  int triangle = gl_VertexID / 3;
  position = vec3(0.0);
  normal = vec3(0.0);
  value = 0.0;
  gl_Position = kOutside;
  if (!isAlive(triangle)) return;
  Crossing crossing = crossingOf(triangle, gl_VertexID % 3);
  value = columnValue(crossing);
#ifdef FLAT
  vec3 area = normal_to_relative * areaVector(triangle);
#else
  vec3 area = has_file_normals ? fileNormal(crossing)
                               : normal_to_relative * texelFetch(normal_sums, ivec2(crossing.key % sums_size.x, crossing.key / sums_size.x), 0).xyz;
#endif
  float size = length(area);
  normal = size > 0.0 ? area / size : vec3(0.0);
  position = index_to_relative * (crossing.position - index_centre) + offset;
  gl_Position = relative_to_clip * vec4(position, 1.0);
}

#endif
