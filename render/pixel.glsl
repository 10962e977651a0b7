// A pixel of a surface under directional lights; after host.glsl, kernel.glsl and shading.glsl.
out vec4 pixel;

#if DEFERRED
uniform sampler2D surface_positions;
uniform sampler2D surface_normals;
#else
in vec3 surface_position;
in vec3 surface_normal;
#endif

uniform vec3 eye;
uniform vec3 light_direction[LIGHTS];   // to the light, unit vectors
uniform vec3 light_irradiance[LIGHTS];  // on a surface that faces it
uniform float exposure;

bool is_measured = true;  // whether the value that was asked for last was measured

// f_r(wl, wv) [1/sr], wl.z, wv.z > 0.
#if defined PM_LOBES
Vec3 brdf(Vec3 wl, Vec3 wv) { return pm_value(Pm(0), wl, wv); }

#elif defined SU_LOBES
#if SU_ROTATED
Vec3 su_value(Vec3 of_lobes, Vec3 sampled) { return su_rotated_value(Su(0), of_lobes, sampled); }
#elif SU_CUBE
uniform usamplerCube su_index;
Vec3 su_value(Vec3 of_lobes, Vec3 sampled) {
    return su_plain_value(Su(0), SuNearest(texture(su_index, sampled)), of_lobes, sampled, SU_NEIGHBOURS);
}
#else
uniform usampler2D su_index;
Vec3 su_value(Vec3 of_lobes, Vec3 sampled) {
    vec2 at = vec2(0.5) + 0.5 * sampled.xy / (1.0 + sampled.z);
    return su_plain_value(Su(0), SuNearest(texture(su_index, at)), of_lobes, sampled, SU_NEIGHBOURS);
}
#endif
#if SU_OF_LIGHTS
Vec3 brdf(Vec3 wl, Vec3 wv) { return su_value(wv, wl); }
#else
Vec3 brdf(Vec3 wl, Vec3 wv) { return su_value(wl, wv); }
#endif

#elif defined MERL_SIZE
// A table in Rusinkiewicz' angles: axes phi_d (periodic), theta_d, theta_h; colours times weight, weight, which is 0 where nothing was
// measured. With h = wl + wv, d = wl - wv as in srbf/measured.h's table.
uniform sampler3D merl_table;
Vec3 brdf(Vec3 wl, Vec3 wv) {
    Vec3 h = wl + wv;
    Vec3 d = wl - wv;
    float planar2 = dot(h.xy, h.xy);
    float size = sqrt(planar2 + h.z * h.z);
    float theta_h = atan(sqrt(planar2), h.z);
    float theta_d = atan(sqrt(dot(d, d)), size);
    float across = size * (h.x * d.y - h.y * d.x);
    float along = h.z * (h.x * d.x + h.y * d.y) - planar2 * d.z;
    float phi_d = across == 0.0 && along == 0.0 ? 0.0 : atan(across, along);
    vec3 n = MERL_SIZE;
    vec3 node = n * vec3(phi_d / 3.141592653589793, theta_d / 1.5707963267948966, sqrt(theta_h / 1.5707963267948966));
    node.yz = min(node.yz, n.yz - 1.0);
    vec4 f = texture(merl_table, (node + 0.5) / n);
    is_measured = f.a > 0.0;
    return f.rgb / max(f.a, 1.0e-6);
}

#elif defined GGX
uniform vec4 ggx_numbers[4];
Vec3 brdf(Vec3 wl, Vec3 wv) {
    GgxLobe first = GgxLobe(ggx_numbers[1].w, ggx_numbers[1].rgb, ggx_numbers[0].w);
    GgxLobe second = GgxLobe(ggx_numbers[2].w, ggx_numbers[2].rgb, ggx_numbers[3].w);
    return ggx_value(ggx_numbers[0].rgb, first, second, wl, wv);
}

#else
Vec3 brdf(Vec3 wl, Vec3 wv) { return Vec3(FLAT); }
#endif

// f_r max(0, n.l) E of one light, and 1 where f_r was asked for but not measured. Without a branch, so that what the values for
// several lights have in common is found once.
vec4 reflected(SurfaceFrame frame, Vec3 wv, Vec3 towards, Vec3 irradiance) {
    Vec3 wl = to_surface(frame, towards);
    vec4 lit = vec4(wl.z * brdf(wl, wv) * irradiance, is_measured ? 0.0 : 1.0);
    return wl.z > 0.0 ? lit : vec4(0.0);
}

void main() {
#if DEFERRED
    ivec2 at = ivec2(gl_FragCoord.xy);
    Vec3 position = texelFetch(surface_positions, at, 0).xyz;
    Vec3 normal = texelFetch(surface_normals, at, 0).xyz;
#else
    Vec3 position = surface_position;
    Vec3 normal = gl_FrontFacing ? surface_normal : -surface_normal;
#endif
    Vec3 to_viewer = normalize(eye - position);
    SurfaceFrame frame = surface_frame_about(visible_normal(normal, to_viewer));
    Vec3 wv = to_surface(frame, to_viewer);
    vec4 sum = vec4(0.0);
#define ADD_LIGHT(k) sum += reflected(frame, wv, light_direction[k], light_irradiance[k]);
    EACH_LIGHT(ADD_LIGHT)
#if SHOWN
    Vec3 shown = tone_mapped(min(exposure * max(sum.rgb, 0.0), Vec3(3.4e38)));
    pixel = vec4(srgb_transfer(shown.x), srgb_transfer(shown.y), srgb_transfer(shown.z), 1.0);
    if (sum.w > 0.0) pixel = vec4(1.0, 0.0, 1.0, 1.0);
#else
    pixel = vec4(sum.w > 0.0 ? Vec3(intBitsToFloat(0x7fc00000)) : sum.rgb, 1.0);
#endif
}
