// Shades a pixel of a surface under directional lights. Must follow a material's text, LIGHTS, EACH_LIGHT,
// DEFERRED, SHOWN and shading.glsl.
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
uniform vec3 light_irradiance[LIGHTS];  // irradiance of a surface that faces the light
uniform float exposure;

// f |n.l| E of one light, for a BRDF if it is above the horizon, and 1 if f was needed but not measured.
// Branch-free, so that the compiler shares common subexpressions between lights. Directional lights have no width,
// so that beams do not show them.
vec4 scattered(SurfaceFrame frame, Vec3 wv, Vec3 towards, Vec3 irradiance) {
    Vec3 wl = to_surface(frame, towards);
    Vec3 f = bsdf(wl, wv);  // a separate statement, because it sets is_measured
    vec4 lit = vec4(abs(wl.z) * f * irradiance, is_measured ? 0.0 : 1.0);
    return SIDES == 2 || wl.z > 0.0 ? lit : vec4(0.0);
}

void main() {
#if DEFERRED
    ivec2 texel = ivec2(gl_FragCoord.xy);
    Vec3 position = texelFetch(surface_positions, texel, 0).xyz;
    vec4 normal = texelFetch(surface_normals, texel, 0);
#else
    Vec3 position = surface_position;
    float facing = gl_FrontFacing ? 1.0 : -1.0;
    vec4 normal = vec4(facing * surface_normal, facing);
#endif
    Vec3 to_viewer = normalize(eye - position);
    // The frame of a BRDF is around the normal on the viewer's side, that of a BSDF around the normal of its front.
    float side = SIDES == 2 ? normal.w : 1.0;
    SurfaceFrame frame = surface_frame_about(side * visible_normal(normal.xyz, to_viewer));
    Vec3 wv = to_surface(frame, to_viewer);
    vec4 sum = vec4(0.0);
#define ADD_LIGHT(k) sum += scattered(frame, wv, light_direction[k], light_irradiance[k]);
    EACH_LIGHT(ADD_LIGHT)
#if SHOWN
    Vec3 shown = tone_mapped(min(exposure * max(sum.rgb, 0.0), Vec3(3.4e38)));
    pixel = vec4(srgb_transfer(shown.x), srgb_transfer(shown.y), srgb_transfer(shown.z), 1.0);
    if (sum.w > 0.0) pixel = vec4(1.0, 0.0, 1.0, 1.0);
#else
    pixel = vec4(sum.w > 0.0 ? Vec3(intBitsToFloat(0x7fc00000)) : sum.rgb, 1.0);
#endif
}
