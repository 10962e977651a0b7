// Displays a previously rendered radiance, or its difference from another one; to follow any material's text and
// shading.glsl.
out vec4 pixel;

uniform sampler2D radiance;  // and coverage
uniform sampler2D other;  // also with coverage, of the same surface
uniform float exposure;
uniform float full_scale;  // difference of exposed luminances with full colour; 0: show the radiance
uniform vec3 background;  // sRGB
uniform vec3 darker;
uniform vec3 as_bright;
uniform vec3 brighter;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(radiance, at, 0);
    vec4 of_other = texelFetch(other, at, 0);
    vec4 difference = of_other - seen;
    bool is_measured = !isnan(seen.r) && !(full_scale > 0.0 && isnan(of_other.r));
    Vec3 shown = tone_mapped(min(exposure * max(seen.rgb, 0.0), Vec3(3.4e38)));
    shown = Vec3(srgb_transfer(shown.x), srgb_transfer(shown.y), srgb_transfer(shown.z));
    float luminance = dot(difference.rgb, Vec3(0.2126, 0.7152, 0.0722));
    float apart = clamp(exposure * luminance / max(full_scale, 1.0e-30), -1.0, 1.0);
    if (full_scale > 0.0) shown = mix(as_bright, apart < 0.0 ? darker : brighter, abs(apart));
    pixel = vec4(seen.a > 0.0 ? (is_measured ? shown : Vec3(1.0, 0.0, 1.0)) : background, 1.0);
}
