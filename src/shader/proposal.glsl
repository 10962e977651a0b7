// The definitions that mixture.glsl requires, for shaders.
uniform vec4 mixture_numbers[MIXTURE_NODES * MIXTURE_VECTORS];  // of a node one after the other, in MIXTURE_VECTORS vectors
uniform vec2 mixture_grain;  // the cosine and sine of the grain's azimuth, or 0 and 0
Real mixture_number(int node, int i) { return mixture_numbers[MIXTURE_VECTORS * node + i / 4][i % 4]; }
Vec3 mixture_tangent(Vec3 wv) { return mixture_grain == vec2(0.0) ? wv : vec3(mixture_grain, 0.0); }
