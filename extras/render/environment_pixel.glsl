// Adds one more sample of a pixel under an environment, and directional lights beside it. Must follow
// proposal_text, shading.glsl, environment.glsl and LIGHTS. It covers the picture: where there is no surface it
// shows the environment. Two directions are sampled from the environment and one from the BRDF, combined with the
// power heuristic (Veach & Guibas 1995).
out vec4 pixel;  // the mean of the samples so far

uniform sampler2D surface_positions;  // at 2 x 2 points of each pixel
uniform sampler2D surface_normals;
uniform sampler2D before;  // the mean without this sample
uniform float share;  // weight of this sample in the mean: 1 for the first
uniform int sample_index;
uniform vec3 eye;
uniform mat3 picture_axes;  // x and y to the right and upper edge, and -z to the middle of a picture at distance 1
uniform vec2 picture_size;
// offset of this sample from the pixel's centre, in pixels; the other points are half a pixel away
uniform vec2 shift;
uniform vec3 light_direction[LIGHTS];   // to the light, unit vectors
uniform vec3 light_irradiance[LIGHTS];  // irradiance of a surface that faces the light

// The first two dimensions of Sobol's sequence, with Owen scrambling by hashes of Laine and Karras (Burley,
// "Practical Hash-based Owen Scrambling", JCGT 2020). Each pixel has its own seeds, so that pictures repeat and
// neighbours differ.
uint hashed(uint x) {  // lowbias32 (Wellons 2018)
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}
uint reversed(uint x) {
    x = (x >> 16) | (x << 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}
// A number in [0,1) from 32 bits in reversed order.
float scrambled(uint x, uint seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return float(reversed(x) >> 8) / 16777216.0;
}
vec2 point_at(int index, uint seed) {
    uint second = 0u;
    uint column = 0x80000000u;  // of the second dimension's matrix, for each bit of the index
    for (uint bits = uint(index); bits != 0u; bits >>= 1) {
        if ((bits & 1u) != 0u) second ^= column;
        column ^= column >> 1;
    }
    return vec2(scrambled(uint(index), hashed(seed)), scrambled(reversed(second), hashed(seed + 1u)));
}

// f |cos(theta_l)|; values that were not measured count as 0.
Vec3 reflectance(Vec3 wl, Vec3 wv) {
    if (SIDES == 1 && wl.z <= 0.0) return Vec3(0.0);
    Vec3 f = bsdf(wl, wv);
    bool known = is_measured && !any(isnan(f)) && !any(isinf(f));
    return known ? abs(wl.z) * f : Vec3(0.0);
}
// Directions in the frame of a part (srbf/brdf.h), and the side of the direction to the light, 1 or -1.
#if SIDES == 2
Vec3 to_part(Vec3 w) { return Vec3(w.xy, abs(w.z)); }
Vec3 to_side(Vec3 w, float side) { return Vec3(w.xy, side * w.z); }
void choose_part(float side, Vec3 wv) { mixture_part = (side * wv.z < 0.0 ? 2 : 0) + (side < 0.0 ? 1 : 0); }
#else
Vec3 to_part(Vec3 w) { return w; }
Vec3 to_side(Vec3 w, float side) { return w; }
void choose_part(float side, Vec3 wv) {}
#endif
float luminance(Vec3 colour) { return dot(colour, Vec3(0.2126, 0.7152, 0.0722)); }
Vec3 from_surface(SurfaceFrame frame, Vec3 w) {
    return w.x * frame.tangent + w.y * frame.bitangent + w.z * frame.normal;
}
// The power heuristic: the weight of samples with density a, times their number, if others have density b.
float power_heuristic(float a, float b) { return 1.0 / (1.0 + (b / a) * (b / a)); }

// Probabilities of the mixture's lobes for a view, on one side of a surface. Each is proportional to the lobe's
// weight times the luminance around its centre, averaged over its solid angle, or for facets that of a highlight of
// their roughness. The mean luminance is added for light that this average misses.
struct LitLobes {
    Vec3 wv;      // in the frame of the part
    Stretch stretch;  // the shape of half-vector lobes
    float power;
    float chance[MIXTURE_COMPONENTS];
};
LitLobes lit_lobes(SurfaceFrame frame, Vec3 wv, float side) {
    choose_part(side, wv);
    LitLobes lit;
    lit.wv = to_part(wv);
    NodesAbout nodes = mixture_nodes(lit.wv);
    lit.stretch = mixture_stretch(lit.wv, nodes);
    lit.power = mixture_power(nodes);
    vec2 above = environment_place(side * frame.normal);
    vec2 mirrored = environment_place(from_surface(frame, to_side(Vec3(-lit.wv.xy, lit.wv.z), side)));
    float mean = luminance(environment_radiance(vec2(0.5), 32.0));
    float sum = 0.0;
    for (int k = 0; k < MIXTURE_COMPONENTS; ++k) {
        float chance = mixture_between(k, nodes);
        if (chance > 0.0) {
            // 2 pi / lambda; the reflection of half vectors multiplies it by 4 cos(theta_v).
            float spread = k < SRBF_FIRST_HALF_VECTOR_LOBE ? 2.0 : 8.0 * lit.wv.z;
            float solid_angle = k < 2 ? k_pi_ : spread * k_pi_ / proposal_bandwidth(k);
            if (k >= SRBF_PROPOSAL_LOBES) {
                Facets facets = mixture_facets(k);
                // most normals are within pi times the product of both roughnesses
                solid_angle = 4.0 * k_pi_ * lit.wv.z * (facets.xx * facets.yy - facets.xy * facets.xy);
            }
            vec2 centre = k < 2 ? above : mirrored;
            chance *= mean + luminance(environment_radiance(centre, environment_level(solid_angle)));
        }
        lit.chance[k] = chance;
        sum += chance;
    }
    // If there is no light, the weights of the mixture remain.
    for (int k = 0; k < MIXTURE_COMPONENTS; ++k)
        lit.chance[k] = sum > 0.0 ? lit.chance[k] / sum : mixture_between(k, nodes);
    return lit;
}
// A direction to the light, in the frame of the part. The lobe is chosen by u.x, rescaled within its interval so
// that it is uniform again: the points of every lobe are then a low-discrepancy sequence in two dimensions.
Vec3 sample_lit(LitLobes lit, vec2 u) {
    int chosen = 0;
    float remainder = u.x;
    for (int k = 0; k < MIXTURE_COMPONENTS - 1; ++k) {
        if (chosen == k && remainder >= lit.chance[k]) {
            remainder -= lit.chance[k];
            chosen = k + 1;
        }
    }
    if (lit.chance[chosen] <= 0.0) chosen = 0;  // a remainder left by rounding belongs to the cosine
    float u1 = min(remainder / lit.chance[chosen], 0.99999994);
    if (chosen >= SRBF_PROPOSAL_LOBES) return sample_facets(lit.wv, mixture_facets(chosen), u1, u.y);
    return sample_proposal_lobe(chosen, lit.wv, lit.stretch, lit.power, u1, u.y);
}
// The density of sample_lit [1/sr].
float lit_pdf(LitLobes lit, Vec3 wl) {
    if (wl.z <= 0.0 || lit.wv.z <= 0.0) return 0.0;
    ProposalPoint at = proposal_point(wl, lit.wv, lit.stretch, lit.power);
    float sum = 0.0;
    for (int k = 0; k < SRBF_PROPOSAL_LOBES; ++k) sum += lit.chance[k] * proposal_lobe_pdf(k, at);
    for (int k = SRBF_PROPOSAL_LOBES; k < MIXTURE_COMPONENTS; ++k)
        sum += lit.chance[k] > 0.0 ? lit.chance[k] * facets_pdf(wl, lit.wv, mixture_facets(k)) : 0.0;
    return sum;
}

// Number of samples from the environment for each one from the material; half of them are below the horizon.
#define LIGHT_DRAWS 2

// The environment's light from a direction on the given side that is sampled from the material.
Vec3 by_material(SurfaceFrame frame, Vec3 wv, LitLobes lit, float side, vec2 u) {
    choose_part(side, wv);
    Vec3 direction = sample_lit(lit, u);
    float density = direction.z > 0.0 ? lit_pdf(lit, direction) : 0.0;
    if (density <= 0.0) return Vec3(0.0);
    Vec3 wl = to_side(direction, side);
    vec2 place = environment_place(from_surface(frame, wl));
    float weight = power_heuristic(density, float(LIGHT_DRAWS) * environment_pdf(place));
    return weight / density * reflectance(wl, wv) * environment_radiance(place, 0.0);
}
// The contribution of a direction wl on the given side that was sampled from the environment.
Vec3 by_environment(Vec3 wl, Vec3 wv, LitLobes lit, float side, EnvironmentSample light) {
    choose_part(side, wv);
    float density = float(LIGHT_DRAWS) * light.pdf;
    float weight = power_heuristic(density, lit_pdf(lit, to_part(wl)));
    return weight / density * reflectance(wl, wv) * light.radiance;
}

// `normal` is that of surface_pixel.glsl, `index` that of the points from which directions are sampled. Each side
// of a surface has its own samples from the material.
Vec3 scattered_radiance(Vec3 position, vec4 normal, int index) {
    Vec3 to_viewer = normalize(eye - position);
    SurfaceFrame frame = surface_frame_about((SIDES == 2 ? normal.w : 1.0) * visible_normal(normal.xyz, to_viewer));
    Vec3 wv = to_surface(frame, to_viewer);
    Vec3 sum = Vec3(0.0);
    uint seed = hashed(uint(gl_FragCoord.x) + hashed(uint(gl_FragCoord.y)));
    vec2 u_material = point_at(index, seed + 2u);
    LitLobes front = lit_lobes(frame, wv, 1.0);
    sum += by_material(frame, wv, front, 1.0, u_material);
#if SIDES == 2
    LitLobes back = lit_lobes(frame, wv, -1.0);
    sum += by_material(frame, wv, back, -1.0, u_material);
#endif
    for (int i = 0; i < LIGHT_DRAWS; ++i) {
        vec2 u = point_at(LIGHT_DRAWS * index + i, seed);
        EnvironmentSample light = sample_environment(u.x, u.y);
        Vec3 wl = to_surface(frame, light.towards);
        if (light.pdf <= 0.0) continue;
#if SIDES == 2
        if (wl.z < 0.0) sum += by_environment(wl, wv, back, -1.0, light);
#endif
        if (wl.z > 0.0) sum += by_environment(wl, wv, front, 1.0, light);
    }
#if SIDES == 2
    sum += straight_beam(wv) * environment_radiance(environment_place(-to_viewer), 0.0);
    Vec3 mirrored = from_surface(frame, Vec3(-wv.xy, wv.z));
    sum += mirror_beam(wv) * environment_radiance(environment_place(mirrored), 0.0);
#endif
    for (int k = 0; k < LIGHTS; ++k)
        if (any(greaterThan(light_irradiance[k], vec3(0.0))))
            sum += reflectance(to_surface(frame, light_direction[k]), wv) * light_irradiance[k];
    return sum;
}

// Returns whether the picture shows surfaces, or what is around them. Pictures of edits show them apart (srbf/shader.h).
#ifdef PM_EDITED
bool shows(bool surface) { return surface != (edited_part == 2); }
#else
bool shows(bool surface) { return true; }
#endif

// The radiance of point k of a pixel; point 0 is shown by every pixel.
vec3 radiance_at(ivec2 pixel_, int k) {
    ivec2 first = ivec2(step(vec2(0.0), shift));
    ivec2 point = first ^ ivec2(k & 1, k >> 1);
    ivec2 texel = 2 * pixel_ + point;
    vec4 position = texelFetch(surface_positions, texel, 0);
    vec3 radiance;
    if (!shows(position.w > 0.0)) {
        radiance = vec3(0.0);
    } else if (position.w > 0.0) {
        // Each point has its own section of the sequence.
        radiance = scattered_radiance(position.xyz, texelFetch(surface_normals, texel, 0), sample_index + (k << 20));
    } else {
        vec2 screen = 2.0 * (gl_FragCoord.xy + shift + 0.5 * vec2(point - first)) / picture_size - 1.0;
        radiance = environment_radiance(environment_place(normalize(picture_axes * vec3(screen, -1.0))), 0.0);
    }
    return any(isnan(radiance)) || any(isinf(radiance)) ? vec3(0.0) : radiance;
}
// True if the surface ends at one of the pixel's points, or is viewed there at less than asin(1/8) = 7 degrees.
// Reflections are compressed to lines there and BRDFs grow, so that all points are shown. The choice of point 0
// does not affect this, so that the mean of both kinds of samples is that of all points.
bool is_edge(ivec2 pixel_) {
    int surfaces = 0;
    bool is_grazing = false;
    for (int k = 0; k < 4; ++k) {
        ivec2 texel = 2 * pixel_ + ivec2(k & 1, k >> 1);
        vec4 position = texelFetch(surface_positions, texel, 0);
        if (position.w <= 0.0) continue;
        ++surfaces;
        vec3 normal = texelFetch(surface_normals, texel, 0).xyz;
        if (dot(normalize(normal), normalize(eye - position.xyz)) < 0.125) is_grazing = true;
    }
    return is_grazing || (surfaces > 0 && surfaces < 4);
}

void main() {
    ivec2 pixel_ = ivec2(gl_FragCoord.xy);
    int points = is_edge(pixel_) ? 4 : 1;
    vec3 sum = vec3(0.0);
    for (int k = 0; k < points; ++k) sum += radiance_at(pixel_, k);
    vec4 now = vec4(sum / float(points), 1.0);
    pixel = share < 1.0 ? mix(texelFetch(before, pixel_, 0), now, share) : now;
}
