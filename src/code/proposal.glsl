// The definitions that mixture.glsl requires, for shaders.
// The numbers of all nodes, with MIXTURE_VECTORS vectors for each.
uniform vec4 mixture_numbers[MIXTURE_PARTS * MIXTURE_NODES * MIXTURE_VECTORS];
uniform vec2 mixture_grain[MIXTURE_PARTS];  // the cosine and sine of the grain's azimuth, or 0 and 0
#if MIXTURE_PARTS > 1
int mixture_part = 0;
#else
const int mixture_part = 0;
#endif
Real mixture_number(int node, int i) {
    return mixture_numbers[MIXTURE_VECTORS * (MIXTURE_NODES * mixture_part + node) + i / 4][i % 4];
}
Vec3 mixture_tangent(Vec3 wv) {
    vec2 grain = mixture_grain[mixture_part];
    return grain == vec2(0.0) ? wv : vec3(grain, 0.0);
}
