// Two-sided Phong lighting per sample, in linear light, written as sRGB. As player/render/phong.h.
const int kMaxLights = 8;  // scene::kMaxLights

uniform bool perspective;
uniform vec3 eye_or_backward;
uniform int light_count;
uniform vec3 light_toward[kMaxLights];
uniform vec3 light_color[kMaxLights];
uniform vec3 ambient, front_color, back_color;
uniform float specular, shininess;

in vec3 position, normal;
out vec4 color;

vec3 linearToSrgb(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

void main() {
  vec3 viewer = perspective ? normalize(eye_or_backward - position) : eye_or_backward;
  float size = length(normal);
  vec3 n = size > 0.0 ? (gl_FrontFacing ? normal : -normal) / size : viewer;
  vec3 base = gl_FrontFacing ? front_color : back_color;
  vec3 sum = ambient * base;
  for (int i = 0; i < light_count; ++i) {
    float diffuse = dot(n, light_toward[i]);
    if (diffuse <= 0.0) continue;
    vec3 mirrored = 2.0 * diffuse * n - light_toward[i];
    float highlight = pow(max(dot(mirrored, viewer), 0.0), shininess);
    sum += light_color[i] * (diffuse * base + specular * highlight);
  }
  color = vec4(linearToSrgb(clamp(sum, 0.0, 1.0)), 1.0);
}
