// What a screen shows of a radiance that was drawn before, or of how another one differs; after any material's text,
// and shading.glsl.
out vec4 pixel;

uniform sampler2D radiance;  // and coverage
uniform sampler2D other;     // likewise, of the same surface
uniform float exposure;
uniform float full_scale;    // the difference of exposed luminances that shows in full colour; 0: show the radiance
uniform vec3 background;     // these as sRGB
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
    float apart = clamp(exposure * dot(difference.rgb, Vec3(0.2126, 0.7152, 0.0722)) / max(full_scale, 1.0e-30), -1.0, 1.0);
    if (full_scale > 0.0) shown = mix(as_bright, apart < 0.0 ? darker : brighter, abs(apart));
    pixel = vec4(seen.a > 0.0 ? (is_measured ? shown : Vec3(1.0, 0.0, 1.0)) : background, 1.0);
}
