// The paper's baseline: tetrahedra sliced in the shader from indexed textures. Ponchio & Hormann 2008, sec. 7 and 8,
// after Buatois et al.; the rules are those of formats/core/tet_slice.h.
//
// Drawn without attributes: gl_VertexID = 6 * tetrahedron + 3 * triangle + corner. A slice has one triangle or two; those
// that are not there go outside the view volume.

uniform samplerBuffer vertices;  // x, y, z (cells), t (frames)
uniform usamplerBuffer tets;     // four vertices
uniform float t, last_t;
uniform vec3 index_centre, offset;
uniform mat3 index_to_relative, normal_to_relative;
uniform mat4 relative_to_clip;

out vec3 position, normal;
out float value;

const vec4 kOutside = vec4(2.0, 2.0, 2.0, 1.0);

bool isAlive(float begin, float end) {
  return begin < end && begin <= t && (t < end || (t == end && end == last_t));
}

vec3 crossing(vec4 a, vec4 b) {
  return t == b.w ? b.xyz : a.xyz + (t - a.w) / (b.w - a.w) * (b.xyz - a.xyz);
}

// Neighbours in a bubble sort: equal times keep their order, an odd number of exchanges flips the winding.
void order(inout vec4 a, inout vec4 b, inout bool odd) {
  if (a.w <= b.w) return;
  vec4 later = a;
  a = b;
  b = later;
  odd = !odd;
}

void main() {
  position = vec3(0.0);
  normal = vec3(0.0);
  value = 0.0;
  gl_Position = kOutside;
  uvec4 ids = texelFetch(tets, gl_VertexID / 6);
  vec4 v0 = texelFetch(vertices, int(ids.x)), v1 = texelFetch(vertices, int(ids.y));
  vec4 v2 = texelFetch(vertices, int(ids.z)), v3 = texelFetch(vertices, int(ids.w));
  bool odd = false;
  order(v0, v1, odd);
  order(v1, v2, odd);
  order(v2, v3, odd);
  order(v0, v1, odd);
  order(v1, v2, odd);
  order(v0, v1, odd);
  bool first = gl_VertexID % 6 < 3;
  vec3 p, q, r;
  if (isAlive(v1.w, v2.w)) {
    p = first ? crossing(v0, v2) : crossing(v0, v3);
    q = first ? crossing(v0, v3) : crossing(v1, v3);
    r = crossing(v1, v2);
  } else if (first && isAlive(v0.w, v1.w)) {
    p = crossing(v0, v1);
    q = crossing(v0, v2);
    r = crossing(v0, v3);
  } else if (first && isAlive(v2.w, v3.w)) {
    p = crossing(v0, v3);
    q = crossing(v1, v3);
    r = crossing(v2, v3);
  } else {
    return;
  }
  if (odd) {
    vec3 last = r;
    r = q;
    q = last;
  }
  vec3 area = normal_to_relative * cross(q - p, r - p);
  float size = length(area);
  normal = size > 0.0 ? area / size : vec3(0.0);
  int corner = gl_VertexID % 3;
  vec3 index = corner == 0 ? p : corner == 1 ? q : r;
  position = index_to_relative * (index - index_centre) + offset;
  gl_Position = relative_to_clip * vec4(position, 1.0);
}
