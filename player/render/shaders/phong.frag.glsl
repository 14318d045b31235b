// Two-sided Phong lighting per sample, in linear light, written as sRGB; colours by a column; refraction. As
// player/render/phong.h. Variants, so that drivers which take every branch take none in vain:
//   BY_COLUMN  the surface has a column's colours
//   REFRACTS   it is seen through
const int kMaxLights = 8;  // scene::kMaxLights
const int kMapEntries = 256;

uniform bool perspective;
uniform vec3 eye_or_backward;
uniform int light_count;
uniform vec3 light_toward[kMaxLights];
uniform vec3 light_color[kMaxLights];
uniform vec3 ambient, front_color, back_color;
uniform float specular, shininess;

uniform bool lit;

in vec3 position, normal;
in float value;
out vec4 color;

vec3 linearToSrgb(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

#ifdef BY_COLUMN

uniform bool logarithmic;
uniform float low, high;
uniform vec3 below, above, unknown;
uniform sampler2D color_table;  // linear light

vec3 columnColor() {
  if (isnan(value)) return unknown;
  if (value < low) return below;
  if (value > high) return above;
  float from = 0.5 * low, to = 0.5 * high, here = 0.5 * value;
  if (logarithmic) { from = log2(low); to = log2(high); here = log2(value); }
  float span = to - from;
  float s = span > 0.0 ? (here - from) / span : 0.5;
  float at = clamp(s, 0.0, 1.0) * float(kMapEntries - 1);
  int entry = min(int(at), kMapEntries - 2);
  vec3 a = texelFetch(color_table, ivec2(entry, 0), 0).rgb;
  vec3 b = texelFetch(color_table, ivec2(entry + 1, 0), 0).rgb;
  return a + (at - float(entry)) * (b - a);
}

#endif
#ifdef REFRACTS

uniform float refraction, tint, refraction_depth;
uniform mat4 relative_to_clip;
uniform vec3 up, background_top, background_bottom;
uniform sampler2D behind;  // the picture before any surface, sRGB

vec3 srgbToLinear(vec3 c) {
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045)));
}

// The background where the ray from here along `ray` meets it.
vec3 backgroundAlong(vec3 ray) {
  vec4 clip = relative_to_clip * vec4(position + refraction_depth * ray, 1.0);
  ivec2 size = textureSize(behind, 0);
  vec2 at = clip.w > 0.0 ? (0.5 * clip.xy / clip.w + 0.5) * vec2(size) : gl_FragCoord.xy;
  ivec2 texel = ivec2(floor(clamp(at, vec2(0.0), vec2(size) - 1.0)));
  return srgbToLinear(texelFetch(behind, texel, 0).rgb);
}

vec3 transparent(vec3 viewer, vec3 n, vec3 base) {
  float eta = gl_FrontFacing ? 1.0 / refraction : refraction;
  float c = clamp(dot(n, viewer), 0.0, 1.0);
  float below_root = 1.0 - eta * eta * (1.0 - c * c);
  vec3 mirrored = 2.0 * c * n - viewer;
  vec3 sky = srgbToLinear(background_bottom + (0.5 + 0.5 * dot(mirrored, up)) * (background_top - background_bottom));
  if (below_root < 0.0) return sky;  // total reflection
  float d = sqrt(below_root);
  float along = (eta * c - d) / (eta * c + d), across = (c - eta * d) / (c + eta * d);
  float reflected = c + d > 0.0 ? 0.5 * (along * along + across * across) : 1.0;
  vec3 through = backgroundAlong(-eta * viewer + (eta * c - d) * n) * (1.0 + tint * (base - 1.0));
  return through + reflected * (sky - through);
}

#endif

void main() {
  vec3 viewer = perspective ? normalize(eye_or_backward - position) : eye_or_backward;
  float size = length(normal);
  vec3 n = size > 0.0 ? (gl_FrontFacing ? normal : -normal) / size : viewer;
#ifdef BY_COLUMN
  vec3 base = columnColor();
#else
  vec3 base = gl_FrontFacing ? front_color : back_color;
#endif
#ifdef REFRACTS
  const float opaque = 0.0;
  vec3 sum = transparent(viewer, n, base);
#else
  if (!lit) {
    color = vec4(linearToSrgb(clamp(base, 0.0, 1.0)), 1.0);
    return;
  }
  const float opaque = 1.0;
  vec3 sum = ambient * base;
#endif
  for (int i = 0; i < light_count; ++i) {
    float diffuse = dot(n, light_toward[i]);
    if (diffuse <= 0.0) continue;
    vec3 mirrored = 2.0 * diffuse * n - light_toward[i];
    float highlight = pow(max(dot(mirrored, viewer), 0.0), shininess);
    sum += light_color[i] * (opaque * diffuse * base + specular * highlight);
  }
  color = vec4(linearToSrgb(clamp(sum, 0.0, 1.0)), 1.0);
}
