// Displays a previously rendered radiance, or its difference from another one. Must follow a material's text and
// shading.glsl.
out vec4 pixel;

uniform sampler2D radiance;  // and coverage
uniform sampler2D other;  // also with coverage, of the same surface
uniform float exposure;
uniform float full_scale;  // difference of exposed luminances that has the full colour; 0: show the radiance
uniform vec3 background;  // sRGB
uniform vec3 darker;
uniform vec3 as_bright;
uniform vec3 brighter;

// show the difference as Delta E_ITP / 100 of the displayed colours, from as_bright to brighter
uniform bool in_delta_e;

// ITU-R BT.2124, with white at 100 cd/m^2: 720 times (I, C_T / 2, C_P) of linear sRGB. Columns of matrices.
vec3 itp(vec3 colour) {
    const mat3 to_lms = mat3(0.2958094, 0.1562490, 0.0351357, 0.6231013, 0.7273257, 0.1565747, 0.0810893, 0.1164253,
                             0.8082896);
    const mat3 to_itp = mat3(360.0, 580.957, 3152.29, 360.0, -1196.455, -3056.84, 0.0, 615.498, -95.4492);
    vec3 y = pow(max(to_lms * colour, 1.0e-9) * 0.01, vec3(0.1593017578125));
    return to_itp * pow((0.8359375 + 18.8515625 * y) / (1.0 + 18.6875 * y), vec3(78.84375));
}
vec3 displayed(vec3 radiance_) { return tone_mapped(min(exposure * max(radiance_, 0.0), Vec3(3.4e38))); }

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 reference = texelFetch(radiance, texel, 0);
    vec4 compared = texelFetch(other, texel, 0);
    vec4 difference = compared - reference;
    bool is_measured = !isnan(reference.r) && !(full_scale > 0.0 && isnan(compared.r));
    Vec3 shown = displayed(reference.rgb);
    shown = Vec3(srgb_transfer(shown.x), srgb_transfer(shown.y), srgb_transfer(shown.z));
    float luminance = dot(difference.rgb, Vec3(0.2126, 0.7152, 0.0722));
    if (in_delta_e && is_measured)
        luminance = 0.01 * distance(itp(displayed(reference.rgb)), itp(displayed(compared.rgb))) / exposure;
    float level = clamp(exposure * luminance / max(full_scale, 1.0e-30), -1.0, 1.0);
    if (full_scale > 0.0) shown = mix(as_bright, level < 0.0 ? darker : brighter, abs(level));
    pixel = vec4(reference.a > 0.0 ? (is_measured ? shown : Vec3(1.0, 0.0, 1.0)) : background, 1.0);
}
