// The mathematics of srbf, written once in the common subset of GLSL 4.50, GLSL ES 3.00 and C++: a text for each kind of model in
// kernel/, over those of lobes and densities.
//
// The host defines before including it
//   Real, Vec3, Bool        a number, a vector of three components, a truth value (GLSL: float, vec3, bool)
//   SRBF_FN                 a prefix for functions (GLSL: nothing; C++: static)
//   select(Bool, Real, Real)  the second argument where the first holds, otherwise the third
// and what pm.glsl and su.glsl name.
// Branches depend only on the structure of a model (its counts, its form, whether lobes are axial), so that Real may be
// a SIMD batch. The exception is the choice of sampled views (su_rotated_..., su_plain_...), which works on one pair of
// directions. Directions are unit vectors; wl points to the light, wv to the viewer, the shading normal is +z. Angles
// are in radians.

#include "srbf/kernel/common.glsl"
#include "srbf/kernel/pm.glsl"
#include "srbf/kernel/su.glsl"
