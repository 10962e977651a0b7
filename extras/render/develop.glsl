// Displays a previously rendered radiance. Must follow a material's text and shading.glsl.
out vec4 pixel;

uniform sampler2D radiance;  // and coverage
uniform float exposure;
uniform vec3 background;  // sRGB

vec3 displayed(vec3 radiance_) { return tone_mapped(min(exposure * max(radiance_, 0.0), Vec3(3.4e38))); }

void main() {
    vec4 seen = texelFetch(radiance, ivec2(gl_FragCoord.xy), 0);
    Vec3 shown = displayed(seen.rgb);
    shown = Vec3(srgb_transfer(shown.x), srgb_transfer(shown.y), srgb_transfer(shown.z));
    if (isnan(seen.r)) shown = Vec3(1.0, 0.0, 1.0);
    pixel = vec4(seen.a > 0.0 ? shown : background, 1.0);
}
