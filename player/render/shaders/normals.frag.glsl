// Blended additively: the texel of a slice vertex gathers the area vectors of its triangles.
flat in vec3 area;
out vec4 sum;

void main() { sum = vec4(area, 1.0); }
