// The BRDF or BSDF of a material. Its macros, host.glsl, kernel.glsl and the code of a BSDF precede this text.
bool is_measured = true;  // false if the last value is that of a masked cell; undefined within its expression

// f_r(wl, wv) [1/sr] for R, G, B, of unit vectors in the local frame with wl.z, wv.z > 0.
#if defined PM_EDITED
#include "srbf/kernel/roughen.glsl"
// A part of an edited model before its fit: the body, or the highlight with another roughness (`Roughen` of srbf/edit.h).
uniform vec2 edited_roughness;  // the factor, and that of the model's own highlight
Vec3 brdf(Vec3 wl, Vec3 wv) {
    if (edited_part == 1 || edited_roughness.x == 1.0) return pm_value(Pm(0), wl, wv);
    DirectionPair from = with_slope_over(edited_roughness.x, wl, wv);
    return ggx_facets(wl, wv, edited_roughness.x * edited_roughness.y) / ggx_facets(from.l, from.v, edited_roughness.y) *
           pm_value(Pm(0), from.l, from.v);
}
#elif defined PM_LOBES
Vec3 brdf(Vec3 wl, Vec3 wv) { return pm_value(Pm(0), wl, wv); }

#elif defined SU_LOBES
#if SU_ROTATED
Vec3 su_value(Vec3 evaluated, Vec3 sampled) { return su_rotated_value(Su(0), evaluated, sampled); }
#elif SU_CUBE
uniform usamplerCube su_index;
Vec3 su_value(Vec3 evaluated, Vec3 sampled) {
    return su_plain_value(Su(0), SuNearest(texture(su_index, sampled)), evaluated, sampled, SU_NEIGHBOURS);
}
#else
uniform usampler2D su_index;
Vec3 su_value(Vec3 evaluated, Vec3 sampled) {
    vec2 texel = vec2(0.5) + 0.5 * sampled.xy / (1.0 + sampled.z);
    return su_plain_value(Su(0), SuNearest(texture(su_index, texel)), evaluated, sampled, SU_NEIGHBOURS);
}
#endif
#if SU_OF_LIGHTS
Vec3 brdf(Vec3 wl, Vec3 wv) { return su_value(wv, wl); }
#else
Vec3 brdf(Vec3 wl, Vec3 wv) { return su_value(wl, wv); }
#endif

#elif defined MERL_SIZE
// A table in Rusinkiewicz coordinates, with axes phi_d (periodic), theta_d, theta_h. A texel holds colour times weight,
// and the weight, which is 0 for a masked cell. The coordinates are those of MerlTable (srbf/measured.h).
uniform sampler3D merl_table;
Vec3 merl_value(int part, Vec3 wl, Vec3 wv) {
    Vec3 h = wl + wv;
    Vec3 d = wl - wv;
    float planar2 = dot(h.xy, h.xy);
    float length_h = sqrt(planar2 + h.z * h.z);
    float theta_h = atan(sqrt(planar2), h.z);
    float theta_d = atan(sqrt(dot(d, d)), length_h);
    float y_d = length_h * (h.x * d.y - h.y * d.x);
    float x_d = h.z * (h.x * d.x + h.y * d.y) - planar2 * d.z;
    float phi_d = y_d == 0.0 && x_d == 0.0 ? 0.0 : atan(y_d, x_d);
    vec3 n = MERL_SIZE;
    vec3 node = n * vec3(phi_d / 3.141592653589793, theta_d / 1.5707963267948966, sqrt(theta_h / 1.5707963267948966));
    node.yz = min(node.yz, n.yz - 1.0);
    node.z += n.z * float(part);  // the texture stacks the tables of parts
    vec4 f = texture(merl_table, (node + 0.5) / (n * vec3(1.0, 1.0, SIDES == 2 ? 4.0 : 1.0)));
    is_measured = f.a > 0.0;
    return f.rgb / max(f.a, 1.0e-6);
}
#if SIDES == 1
Vec3 brdf(Vec3 wl, Vec3 wv) { return merl_value(0, wl, wv); }
#else
Vec3 bsdf(Vec3 wl, Vec3 wv) {
    int part = (wl.z * wv.z < 0.0 ? 2 : 0) + (wl.z < 0.0 ? 1 : 0);
    return merl_value(part, Vec3(wl.xy, abs(wl.z)), Vec3(wv.xy, abs(wv.z)));
}
#endif

#elif defined VALUE
Vec3 brdf(Vec3 wl, Vec3 wv) { return Vec3(VALUE); }

#else
Vec3 bsdf(Vec3 wl, Vec3 wv) { return material_bsdf(wl, wv); }
#endif

#if SIDES == 1
Vec3 bsdf(Vec3 wl, Vec3 wv) { return brdf(wl, wv); }
#else
#if HAS_BEAM
Vec3 straight_beam(Vec3 wv) { return material_beam(wv); }
#else
Vec3 straight_beam(Vec3 wv) { return Vec3(0.0); }
#endif
#if HAS_MIRROR_BEAM
Vec3 mirror_beam(Vec3 wv) { return material_mirror_beam(wv); }
#else
Vec3 mirror_beam(Vec3 wv) { return Vec3(0.0); }
#endif
#endif
