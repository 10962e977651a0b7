// The definitions that mixture.glsl requires, for shaders.
uniform float mixture_weights[MIXTURE_PARTS * MIXTURE_NODES * SRBF_PROPOSAL_LOBES];
uniform vec3 mixture_grain[MIXTURE_PARTS];  // the stretch, and the cosine and sine of the grain's azimuth
#if MIXTURE_PARTS > 1
int mixture_part = 0;
#define MIXTURE_FIRST (MIXTURE_NODES * SRBF_PROPOSAL_LOBES * mixture_part)
#else
const int mixture_part = 0;
#define MIXTURE_FIRST 0
#endif
Real mixture_stretch() { return mixture_grain[mixture_part].x; }
Vec3 into_grain(Vec3 w) { return turned(w, mixture_grain[mixture_part].y, -mixture_grain[mixture_part].z); }
Vec3 out_of_grain(Vec3 w) { return turned(w, mixture_grain[mixture_part].y, mixture_grain[mixture_part].z); }
