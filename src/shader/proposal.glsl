// The definitions that mixture.glsl requires, for shaders.
uniform float mixture_weights[MIXTURE_NODES * SRBF_PROPOSAL_LOBES];
uniform vec3 mixture_grain;  // the stretch, and the cosine and sine of the grain's azimuth
Real mixture_stretch() { return mixture_grain.x; }
Vec3 into_grain(Vec3 w) { return turned(w, mixture_grain.y, -mixture_grain.z); }
Vec3 out_of_grain(Vec3 w) { return turned(w, mixture_grain.y, mixture_grain.z); }
