// For three.js, release 187, and its WebGLRenderer.
import { Color, DataTexture, FloatType, MaterialLoader, Matrix3, MeshStandardMaterial, RGBAFormat, REVISION } from 'three';

if (parseInt(REVISION) !== 187)
    console.warn(`three.js ${REVISION}: this material was written for release 187, and may ignore environments in others`);

const functions = /* glsl */ `
#define film_radiance measured_radiance
#define film_reflected measured_reflected
#define film_lobe_roughness(k) ((k) == 1 ? 0.21114397 : (k) == 2 ? 0.3922485 : (k) == 3 ? 0.36724895 : (k) == 4 ? 0.35622546 : 1.0)
// GLSL, to follow the version (300 es or later): film_area, film_brdf, film_albedo, film_environment, film_environment_lobe, film_light_texel, film_lobe_roughness, film_radiance, film_reflected.
// Written by srbf; the text is under the MIT License.

#ifndef FILM_BRDF
#define FILM_BRDF

#ifdef GL_ES
precision highp float;
precision highp int;
#endif

// The features. cl and cv are the cosines of wl and wv to the normal, h is their half vector:
//   x_0 = log(cl cv)
//   x_1 = wl . h - 1
//   x_2 = 1/20 - sqrt((cl - cv)^2 + sin^2(theta_h)/16 + 1/400)
//   x_3 = -sin(theta_h)
struct film_PmFeatures {
    float x[4];
};

// psi(wl, wv) in the form that axial lobes need: sin^2 and cos of its angle to the normal.
struct film_AxialPsi {
    float across, along;
};

// The variates of a pair: psi_n, or of axial lobes its squared distances from +z and -z, which suffice.
struct film_PmVariates {
    vec3 x[3];
};

// The position of a coordinate from 0 to 1 between two of \`count\` nodes.
struct film_NodesAbout {
    int below;
    float beyond;
};

// A lobe of f_r cos(theta_l) over the light for a view. It reflects with \`weight\`, which may be negative, the
// radiance in the direction \`axis\` of an environment that is filtered as for GGX of this roughness viewed along the
// normal.
struct film_LightLobe {
    vec3 axis;
    float roughness;
    vec3 weight;
};

// The lobes for a view wv above the horizon.
struct film_LightLobes {
    film_LightLobe lobe[5];
};

// The consecutive corners of a quadrilateral.
struct film_Quadrilateral {
    vec3 a, b, c, d;
};

// The sum of the sectors of edges above the horizon z = 0, and the points where they cross it.
struct film_Outline {
    float sum;
    vec3 down, up;
};

// The further features of (wl, wv). Only the first \`count\` are computed, the number in the model's form; the others
// are not read.
film_PmFeatures film_pm_further_features(vec3 wl, vec3 wv) {
    film_PmFeatures features;
    features.x[0] = 0.0;
    features.x[1] = 0.0;
    features.x[2] = 0.0;
    features.x[3] = 0.0;
    features.x[0] = log(max(wl.z, 1.0e-6) * max(wv.z, 1.0e-6));
    vec3 sum = wl + wv;
    float squared = max(dot(sum, sum), 1.0e-12);
    float across = (sum.x * sum.x + sum.y * sum.y) / squared;
    float apart = wl.z - wv.z;
    features.x[1] = 0.5 * sqrt(squared) - 1.0;
    features.x[2] = 0.05 - sqrt(apart * apart + 0.0625 * across + 0.0025);
    features.x[3] = -sqrt(across);
    return features;
}

film_AxialPsi film_axial_psi(vec3 wl, vec3 wv, float a, float b) {
    vec3 d = a * wl + b * wv;
    float reciprocal = inversesqrt(max(dot(d, d), 1.0e-20));
    film_AxialPsi psi_;
    psi_.across = reciprocal * reciprocal * (d.x * d.x + d.y * d.y);
    psi_.along = reciprocal * d.z;
    return psi_;
}

// |psi - xi|^2 for a pole xi = (0, 0, pole), and for a general centre.
float film_squared_distance_from_pole(film_AxialPsi psi_, float pole) {
    float apart = psi_.along - pole;
    return psi_.across + apart * apart;
}

float film_pm_power(float exponent) { return exp2(max(min(exponent, 100.0), -100.0)); }

film_PmVariates film_pm_variates_of(vec3 wl, vec3 wv) {
    film_PmVariates of_pair;
    film_AxialPsi psi_0 = film_axial_psi(wl, wv, 1.5917969, 1.5996094);
    of_pair.x[0] = vec3(film_squared_distance_from_pole(psi_0, 1.0), film_squared_distance_from_pole(psi_0, -1.0), 0.0);
    film_AxialPsi psi_1 = film_axial_psi(wl, wv, 1.015625, -0.7314453);
    of_pair.x[1] = vec3(film_squared_distance_from_pole(psi_1, 1.0), film_squared_distance_from_pole(psi_1, -1.0), 0.0);
    film_AxialPsi psi_2 = film_axial_psi(wl, wv, 1.3369141, 0.07946777);
    of_pair.x[2] = vec3(film_squared_distance_from_pole(psi_2, 1.0), film_squared_distance_from_pole(psi_2, -1.0), 0.0);
    return of_pair;
}

film_NodesAbout film_nodes_about(float coordinate, int count) {
    float at = min(max(coordinate, 0.0), 1.0) * float(count - 1);
    film_NodesAbout nodes;
    nodes.below = int(min(at, float(count - 2)));
    nodes.beyond = at - float(nodes.below);
    return nodes;
}

// A coordinate of the cosine from 0 at the horizon to 1 at the normal.
float film_elevation_coordinate(float cosine) {
    float c = min(max(cosine, 0.0), 1.0);
    return 0.5 * (1.0 + sqrt(sqrt(c)) - sqrt(1.0 - c));
}

vec3 film_light_whole(vec3 albedo) { return vec3(min(albedo.x, 1.0), min(albedo.y, 1.0), min(albedo.z, 1.0)); }

// A sum of lobes, clamped to 0: it can be slightly negative where nearly all light comes from a few directions.
vec3 film_not_negative(vec3 sum) { return vec3(max(sum.x, 0.0), max(sum.y, 0.0), max(sum.z, 0.0)); }

// The first lobe, the cosine around the normal. Its weight is the total minus all other weights.
film_LightLobe film_cosine_lobe(vec3 weight) {
    film_LightLobe lobe;
    lobe.axis = vec3(0.0, 0.0, 1.0);
    lobe.roughness = 1.0;
    lobe.weight = weight;
    return lobe;
}

// An angle divided by 2 pi times its sine (Hill & Heitz 2016), within 2e-6.
float film_angle_over_sine(float cosine) {
    float c = abs(cosine);
    float numerator = 0.8543985 + (0.4965155 + 0.0145206 * c) * c;
    float sharp = numerator / (3.4175940 + (4.1616724 + c) * c);
    return cosine > 0.0 ? sharp : 0.5 * inversesqrt(max(1.0 - c * c, 1.0e-7)) - sharp;
}

// The z component of the unit vector orthogonal to two vectors, times the angle between them divided by 2 pi.
float film_sector(vec3 a, vec3 b) {
    float scale = inversesqrt(max(dot(a, a) * dot(b, b), 1.0e-30));
    return scale * (a.x * b.y - a.y * b.x) * film_angle_over_sine(scale * dot(a, b));
}

film_Outline film_with_edge(film_Outline outline, vec3 a, vec3 b) {
    film_Outline extended = outline;
    if (a.z <= 0.0 && b.z <= 0.0) return extended;
    vec3 first = a;
    vec3 last = b;
    if (a.z <= 0.0) {
        first = a + a.z / (a.z - b.z) * (b - a);
        extended.up = first;
    }
    if (b.z <= 0.0) {
        last = a + a.z / (a.z - b.z) * (b - a);
        extended.down = last;
    }
    extended.sum = outline.sum + film_sector(first, last);
    return extended;
}

// The integral of cos(theta) / pi over the directions of a quadrilateral above the horizon, from its edges (Lambert
// 1760).
float film_cosine_over(film_Quadrilateral light) {
    film_Outline outline;
    outline.sum = 0.0;
    outline.down = vec3(0.0, 0.0, 0.0);
    outline.up = outline.down;
    outline = film_with_edge(film_with_edge(film_with_edge(film_with_edge(outline, light.a, light.b), light.b, light.c),
            light.c, light.d), light.d, light.a);
    return abs(outline.sum + film_sector(outline.down, outline.up));
}

// A lobe's kernel, GGX's of its roughness without the levels of a map, is nearly a cosine around the axis whose
// directions are contracted by this factor across it (Heitz et al. 2016).
float film_stretch_of(film_LightLobe lobe) {
    float r = max(lobe.roughness, 0.01);
    return sqrt(1.0 + 3.0 * r * r * r) / (2.0 * r * r);
}

// The kernel in a direction at this cosine to the axis.
float film_kernel_of(float cosine, float stretch) {
    float along = max(cosine, 0.0);
    float squared = stretch * stretch * (1.0 - along * along) + along * along;
    return 0.31830989 * stretch * stretch * along / (squared * squared);
}

vec3 film_widened(vec3 p, vec3 axis, float stretch) {
    float across = (axis.x * p.x + axis.y * p.y) / (1.0 + axis.z) + p.z;
    return vec3(stretch * (p.x - across * axis.x), stretch * (p.y - across * axis.y), dot(axis, p));
}

// The integral of the kernel over a quadrilateral, whose directions are stretched instead.
float film_lobe_over(film_LightLobe lobe, film_Quadrilateral light) {
    float stretch = film_stretch_of(lobe);
    film_Quadrilateral wide;
    wide.a = film_widened(light.a, lobe.axis, stretch);
    wide.b = film_widened(light.b, lobe.axis, stretch);
    wide.c = film_widened(light.c, lobe.axis, stretch);
    wide.d = film_widened(light.d, lobe.axis, stretch);
    return film_cosine_over(wide);
}

// The cosine of the angle between two vectors.
float film_cosine_between(vec3 a, vec3 b) { return inversesqrt(max(dot(a, a) * dot(b, b), 1.0e-30)) * dot(a, b); }

// The largest squared distance of a light's corners from its middle, on the unit sphere.
float film_squared_size(film_Quadrilateral light) {
    vec3 middle = light.a + light.b + light.c + light.d;
    return 2.0 - 2.0 * min(min(film_cosine_between(middle, light.a), film_cosine_between(middle, light.b)),
            min(film_cosine_between(middle, light.c), film_cosine_between(middle, light.d)));
}

// The solid angle into which the lobes reflect: their sum divided by a bound of their largest value.
float film_width_of(film_LightLobes of_view) {
    float sum = 0.0;
    float largest = 1.0e-9;
    vec3 weight_0 = of_view.lobe[0].weight;
    float stretch_0 = film_stretch_of(of_view.lobe[0]);
    float total_0 = weight_0.x + weight_0.y + weight_0.z;
    sum = sum + total_0;
    largest = largest + abs(total_0) * 0.31830989 * stretch_0 * stretch_0;
    vec3 weight_1 = of_view.lobe[1].weight;
    float stretch_1 = film_stretch_of(of_view.lobe[1]);
    float total_1 = weight_1.x + weight_1.y + weight_1.z;
    sum = sum + total_1;
    largest = largest + abs(total_1) * 0.31830989 * stretch_1 * stretch_1;
    vec3 weight_2 = of_view.lobe[2].weight;
    float stretch_2 = film_stretch_of(of_view.lobe[2]);
    float total_2 = weight_2.x + weight_2.y + weight_2.z;
    sum = sum + total_2;
    largest = largest + abs(total_2) * 0.31830989 * stretch_2 * stretch_2;
    vec3 weight_3 = of_view.lobe[3].weight;
    float stretch_3 = film_stretch_of(of_view.lobe[3]);
    float total_3 = weight_3.x + weight_3.y + weight_3.z;
    sum = sum + total_3;
    largest = largest + abs(total_3) * 0.31830989 * stretch_3 * stretch_3;
    vec3 weight_4 = of_view.lobe[4].weight;
    float stretch_4 = film_stretch_of(of_view.lobe[4]);
    float total_4 = weight_4.x + weight_4.y + weight_4.z;
    sum = sum + total_4;
    largest = largest + abs(total_4) * 0.31830989 * stretch_4 * stretch_4;
    return sum / largest;
}

// The fraction of a light of this squared size that is evaluated at points: all up to 1.5 times the reflected solid
// angle, and nothing from 6 times on, where the points would be visible as dots.
float film_share_of_points(float squared, float width) {
    float x = min(max(1.3333333 - squared / (1.125 * min(4.0 * width, 0.15)), 0.0), 1.0);
    return x * x * (3.0 - 2.0 * x);
}

// A node of the two-point Gauss rule on [0, 1].
float film_gauss_node(int i) { return 0.21132487 + 0.57735027 * float(i); }

// The volume of the parallelepiped spanned by three vectors.
float film_volume(vec3 a, vec3 b, vec3 c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}

// film: 9 lobes of 3 variates, form reciprocal, 210 bytes.
//   albedo_error 0.137
//   delta_e_itp 5.535
//   flip 0.07509
//   generator srbf 0.1.0
//   heldout_squared_error_ratio 0.1733
//   heldout_squared_error_ratio_cosine 0.04752
//   max_theta 89
//   objective appearance
//   psnr 33.04
//   rms 0.09984
//   seed 0
//   source cc_ibiza_sunset_rgb.bsdf
//   squared_error_ratio 0.08493

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
const float film_lobes[99] = float[99](
    0.8671875, 0.9975586, 0.88720703, 123.125, 103.75, -6.9453125, -57.25, 0.0, 51.9375, 54.96875, -0.86083984,
    1.0009766, 0.16418457, 0.0, -18.484375, 21.78125, 0.8457031, -3.2753906, 0.17626953, -2.96875, -0.26757812, -32.59375,
    1.0117188, 0.0, 0.24304199, 46.25, -21.578125, -2.4589844, 50.78125, 1.0263672, -46.59375, 30.453125, 6.28125,
    0.99902344, 0.34570312, 0.0, -5.0039062, 13.5078125, -0.4716797, -0.5727539, 0.007537842, -4.3203125, 0.9316406, -6.2070312,
    1.0009766, 0.48266602, 0.8647461, 166.375, 103.125, -0.5498047, -82.375, 0.0, 76.3125, 92.125, 8.0546875,
    0.98583984, 0.89160156, 0.6582031, 77.6875, 59.90625, 6.7734375, -51.1875, 0.13183594, 20.0625, 13.03125, -26.640625,
    1.0019531, 0.44726562, 0.5629883, -4.4648438, 18.125, 0.76660156, 4.234375, 5.2734375, -17.765625, -1.2587891, -5.578125,
    1.0078125, 0.52441406, 0.037719727, 27.046875, -12.5703125, -3.5644531, 41.34375, 0.6621094, -45.40625, 22.6875, 2.5859375,
    0.95654297, 1.0029297, 0.99902344, 60.21875, 72.0, 1.6875, -34.53125, 0.0, 20.203125, 20.984375, -14.7265625
);

// Lobe j with the terms of its variates, from the exponent of its scale and features on.
float film_pm_lobe(int j, float exponent, film_PmVariates of_pair) {
    float sum = exponent - 0.7213475204444817 * abs(film_lobes[11 * j + 4]) * (film_lobes[11 * j + 4] < 0.0 ?
            of_pair.x[0].y : of_pair.x[0].x) - 0.7213475204444817 * abs(film_lobes[11 * j + 4 + 1]) * (film_lobes[11 *
            j + 4 + 1] < 0.0 ? of_pair.x[1].y : of_pair.x[1].x) - 0.7213475204444817 * abs(film_lobes[11 * j + 4 + 2]) *
            (film_lobes[11 * j + 4 + 2] < 0.0 ? of_pair.x[2].y : of_pair.x[2].x);
    return film_pm_power(sum);
}

// g(wl, wv) = sum_j beta_j e^(s_j) prod_n G(psi_n . xi_jn | lambda_jn) prod_k e^(kappa_jk x_k(wl, wv)) [1/sr], for
// R, G, B. Here psi_n = normalize(a_n wl + b_n wv), and x_k are the further features, which are symmetric.
// rho(wl, wv) = g(wl, wv), or the mean of g(wl, wv) and g(wv, wl) in a reciprocal model. A negative sum counts as 0:
// the colour of a spectral model's lobe may have a negative channel.
vec3 film_pm_value(vec3 wl, vec3 wv) {
    film_PmVariates of_pair = film_pm_variates_of(wl, wv);
    film_PmVariates exchanged = film_pm_variates_of(wv, wl);
    film_PmFeatures features = film_pm_further_features(wl, wv);
    vec3 sum = vec3(0.0, 0.0, 0.0);
    float exponent_0 = 177.63182 + 74.92998 * features.x[1] + 79.30315 * features.x[2] + -1.2419294 * features.x[3];
    float power_0 = 0.5 * (film_pm_lobe(0, exponent_0, of_pair) + film_pm_lobe(0, exponent_0, exchanged));
    sum = sum + power_0 * vec3(0.8671875, 0.9975586, 0.88720703);
    float exponent_1 = -26.667316 + 0.2543032 * features.x[0] + -4.283001 * features.x[1] + -0.38603362 *
            features.x[2] + -47.022842 * features.x[3];
    float power_1 = 0.5 * (film_pm_lobe(1, exponent_1, of_pair) + film_pm_lobe(1, exponent_1, exchanged));
    sum = sum + power_1 * vec3(1.0009766, 0.16418457, 0.0);
    float exponent_2 = 66.72465 + 1.4807348 * features.x[0] + -67.22057 * features.x[1] + 43.934574 * features.x[2] +
            9.061928 * features.x[3];
    float power_2 = 0.5 * (film_pm_lobe(2, exponent_2, of_pair) + film_pm_lobe(2, exponent_2, exchanged));
    sum = sum + power_2 * vec3(1.0117188, 0.0, 0.24304199);
    float exponent_3 = -7.2191105 + 0.010874807 * features.x[0] + -6.2328935 * features.x[1] + 1.3440733 *
            features.x[2] + -8.954853 * features.x[3];
    float power_3 = 0.5 * (film_pm_lobe(3, exponent_3, of_pair) + film_pm_lobe(3, exponent_3, exchanged));
    sum = sum + power_3 * vec3(0.99902344, 0.34570312, 0.0);
    float exponent_4 = 240.02838 + 110.095665 * features.x[1] + 132.90828 * features.x[2] + 11.620458 * features.x[3];
    float power_4 = 0.5 * (film_pm_lobe(4, exponent_4, of_pair) + film_pm_lobe(4, exponent_4, exchanged));
    sum = sum + power_4 * vec3(1.0009766, 0.48266602, 0.8647461);
    float exponent_5 = 112.07937 + 0.19019906 * features.x[0] + 28.944069 * features.x[1] + 18.80012 * features.x[2] +
            -38.4343 * features.x[3];
    float power_5 = 0.5 * (film_pm_lobe(5, exponent_5, of_pair) + film_pm_lobe(5, exponent_5, exchanged));
    sum = sum + power_5 * vec3(0.98583984, 0.89160156, 0.6582031);
    float exponent_6 = -6.441408 + 7.607962 * features.x[0] + -25.630379 * features.x[1] + -1.8160487 * features.x[2] +
            -8.047533 * features.x[3];
    float power_6 = 0.5 * (film_pm_lobe(6, exponent_6, of_pair) + film_pm_lobe(6, exponent_6, exchanged));
    sum = sum + power_6 * vec3(1.0019531, 0.44726562, 0.5629883);
    float exponent_7 = 39.020393 + 0.95522195 * features.x[0] + -65.50737 * features.x[1] + 32.731144 * features.x[2] +
            3.730719 * features.x[3];
    float power_7 = 0.5 * (film_pm_lobe(7, exponent_7, of_pair) + film_pm_lobe(7, exponent_7, exchanged));
    sum = sum + power_7 * vec3(1.0078125, 0.52441406, 0.037719727);
    float exponent_8 = 86.87729 + 29.146948 * features.x[1] + 30.274054 * features.x[2] + -21.24594 * features.x[3];
    float power_8 = 0.5 * (film_pm_lobe(8, exponent_8, of_pair) + film_pm_lobe(8, exponent_8, exchanged));
    sum = sum + power_8 * vec3(0.95654297, 1.0029297, 0.99902344);
    return vec3(max(sum.x, 0.0), max(sum.y, 0.0), max(sum.z, 0.0));
}

// The BRDF f_r [1/sr] in linear sRGB, without the cosine: multiply by wl.z and by the irradiance of the light on a
// surface that faces it. wl points to the light and wv to the viewer: unit vectors in the local frame, whose z is the
// shading normal. 0 where one of them is not above the horizon, or has a NaN.
vec3 film_brdf(vec3 wl, vec3 wv) {
    if (!(0.0 < wl.z && 0.0 < wv.z && dot(wl, wl) + dot(wv, wv) < 1.0e30)) return vec3(0.0, 0.0, 0.0);
    return film_pm_value(wl, wv);
}

// film_light_texel: Lobe k > 0 at a view has (p, roughness, width) at i = 2 k - 2 and its share of the albedo at i = 2
// k - 1;
// then albedos, of as many nodes in a column as there are views. The host supplies them.
#ifndef film_light_texel
vec3 film_light_texel(int i, int view);
#endif

vec3 film_albedo_node(int i) { return film_light_texel(8 + i / 32, i % 32); }

// The integral of f_r cos(theta_l) over the directions to the light, for R, G, B, at the cosine of the view to the
// normal; 0 unless that is above 0.
vec3 film_albedo(float cosine) {
    if (!(0.0 < cosine)) return vec3(0.0, 0.0, 0.0);
    film_NodesAbout nodes = film_nodes_about(film_elevation_coordinate(cosine), 129);
    return (1.0 - nodes.beyond) * film_albedo_node(nodes.below) + nodes.beyond * film_albedo_node(nodes.below + 1);
}

// film_lobe_roughness: The roughness of lobe k > 0. The host supplies it.
#ifndef film_lobe_roughness
float film_lobe_roughness(int k);
#endif

vec3 film_light_between(int i, film_NodesAbout nodes) {
    vec3 here = film_light_texel(i, nodes.below);
    return here + nodes.beyond * (film_light_texel(i, nodes.below + 1) - here);
}

float film_light_width(film_NodesAbout nodes) { return film_light_between(0, nodes).z; }

vec3 film_light_shape(int k, film_NodesAbout nodes) { return film_light_between(2 * k - 2, nodes); }

vec3 film_light_weight(int k, vec3 whole, film_NodesAbout nodes) {
    vec3 share = film_light_between(2 * k - 1, nodes);
    return vec3(share.x * whole.x, share.y * whole.y, share.z * whole.z);
}

// film_reflected: The product of a lobe's weight, in colours that the host may change, and the radiance. The host
// supplies it.
#ifndef film_reflected
vec3 film_reflected(vec3 weight, vec3 light);
#endif

// The radiance that a view reflects under radiance 1 from all directions.
vec3 film_reflected_of_one(vec3 wv) { return film_light_whole(film_albedo(wv.z)); }

// A lobe after the first; \`whole\` is reflected_of_one.
film_LightLobe film_lobe_about(vec3 wv, int k, film_NodesAbout nodes, vec3 whole) {
    vec3 shape = film_light_shape(k, nodes);
    float p = shape.x;
    film_LightLobe lobe;
    lobe.axis = vec3(-p * wv.x, -p * wv.y, sqrt(max(1.0 - p * p * (1.0 - wv.z * wv.z), 0.0)));
    lobe.roughness = shape.y;
    lobe.weight = film_light_weight(k, whole, nodes);
    return lobe;
}

film_LightLobes film_lobes_about(vec3 wv) {
    film_NodesAbout nodes = film_nodes_about(film_elevation_coordinate(wv.z), 32);
    vec3 whole = film_reflected_of_one(wv);
    vec3 cosine_weight = whole;
    film_LightLobes of_view;
    of_view.lobe[1] = film_lobe_about(wv, 1, nodes, whole);
    cosine_weight = cosine_weight - of_view.lobe[1].weight;
    of_view.lobe[2] = film_lobe_about(wv, 2, nodes, whole);
    cosine_weight = cosine_weight - of_view.lobe[2].weight;
    of_view.lobe[3] = film_lobe_about(wv, 3, nodes, whole);
    cosine_weight = cosine_weight - of_view.lobe[3].weight;
    of_view.lobe[4] = film_lobe_about(wv, 4, nodes, whole);
    cosine_weight = cosine_weight - of_view.lobe[4].weight;
    of_view.lobe[0] = film_cosine_lobe(cosine_weight);
    return of_view;
}

// Lobe k of them.
film_LightLobe film_environment_lobe(vec3 wv, int k) {
    film_NodesAbout nodes = film_nodes_about(film_elevation_coordinate(wv.z), 32);
    vec3 whole = film_reflected_of_one(wv);
    if (k > 0) return film_lobe_about(wv, k, nodes, whole);
    vec3 cosine_weight = whole;
    for (int j = 1; j < 5; ++j) cosine_weight = cosine_weight - film_light_weight(j, whole, nodes);
    return film_cosine_lobe(cosine_weight);
}

// film_radiance: The radiance of the environment, which the host supplies: in a direction of the local frame, filtered
// as for GGX
// of a roughness, as in an engine's maps. At roughness 1 it is irradiance / pi. Lobes are fitted to maps of 6
// levels, in which level 5 sqrt(roughness) is looked up, linearly between levels.
#ifndef film_radiance
vec3 film_radiance(vec3 direction, float roughness);
#endif

// The radiance that leaves towards the viewer.
vec3 film_environment(vec3 wv) {
    vec3 sum = vec3(0.0, 0.0, 0.0);
    if (wv.z <= 0.0) return sum;
    film_LightLobes of_view = film_lobes_about(wv);
    sum = film_reflected(of_view.lobe[0].weight, film_radiance(of_view.lobe[0].axis, 1.0)) +
            film_reflected(of_view.lobe[1].weight, film_radiance(of_view.lobe[1].axis, film_lobe_roughness(1))) +
            film_reflected(of_view.lobe[2].weight, film_radiance(of_view.lobe[2].axis, film_lobe_roughness(2))) +
            film_reflected(of_view.lobe[3].weight, film_radiance(of_view.lobe[3].axis, film_lobe_roughness(3))) +
            film_reflected(of_view.lobe[4].weight, film_radiance(of_view.lobe[4].axis, film_lobe_roughness(4)));
    return film_not_negative(sum);
}

// The integral over the directions of a quadrilateral, from four points, of what lobes lack of f_r cos(theta_l).
vec3 film_lacking(vec3 wv, film_Quadrilateral light, film_LightLobes of_view) {
    vec3 along = light.b - light.a;
    vec3 across = light.d - light.a;
    vec3 askew = light.c - light.d - along;
    float stretch[5];
    stretch[0] = film_stretch_of(of_view.lobe[0]);
    stretch[1] = film_stretch_of(of_view.lobe[1]);
    stretch[2] = film_stretch_of(of_view.lobe[2]);
    stretch[3] = film_stretch_of(of_view.lobe[3]);
    stretch[4] = film_stretch_of(of_view.lobe[4]);
    vec3 sum = vec3(0.0, 0.0, 0.0);
    for (int i = 0; i < 4; ++i) {
        float s = film_gauss_node(i / 2);
        float t = film_gauss_node(i - 2 * (i / 2));
        vec3 p = light.a + s * along + t * across + s * t * askew;
        float reciprocal = inversesqrt(max(dot(p, p), 1.0e-12));
        vec3 wl = reciprocal * p;
        vec3 value = max(wl.z, 0.0) * film_brdf(wl, wv) - film_kernel_of(dot(of_view.lobe[0].axis, wl), stretch[0]) *
                of_view.lobe[0].weight - film_kernel_of(dot(of_view.lobe[1].axis, wl), stretch[1]) *
                of_view.lobe[1].weight - film_kernel_of(dot(of_view.lobe[2].axis, wl), stretch[2]) *
                of_view.lobe[2].weight - film_kernel_of(dot(of_view.lobe[3].axis, wl), stretch[3]) *
                of_view.lobe[3].weight - film_kernel_of(dot(of_view.lobe[4].axis, wl), stretch[4]) *
                of_view.lobe[4].weight;
        float solid_angle = abs(film_volume(p, along + t * askew, across + s * askew)) * reciprocal * reciprocal *
                reciprocal;
        sum = sum + 0.25 * solid_angle * value;
    }
    return sum;
}

// The radiance that leaves towards the viewer from a quadrilateral that emits radiance 1 at its front and back. Its
// consecutive corners are relative to the point of the surface, in the local frame. It is the sum of the lobes, and for
// a small light also what they lack of f_r, at points.
vec3 film_area(vec3 wv, vec3 a, vec3 b, vec3 c, vec3 d) {
    vec3 sum = vec3(0.0, 0.0, 0.0);
    if (wv.z <= 0.0) return sum;
    film_Quadrilateral light;
    light.a = a;
    light.b = b;
    light.c = c;
    light.d = d;
    film_LightLobes of_view = film_lobes_about(wv);
    sum = sum + film_lobe_over(of_view.lobe[0], light) * of_view.lobe[0].weight + film_lobe_over(of_view.lobe[1],
            light) * of_view.lobe[1].weight + film_lobe_over(of_view.lobe[2], light) * of_view.lobe[2].weight +
            film_lobe_over(of_view.lobe[3], light) * of_view.lobe[3].weight + film_lobe_over(of_view.lobe[4], light) *
            of_view.lobe[4].weight;
    film_NodesAbout nodes = film_nodes_about(film_elevation_coordinate(wv.z), 32);
    float share = film_share_of_points(film_squared_size(light), min(film_light_width(nodes), film_width_of(of_view)));
    if (share > 0.0) sum = sum + share * film_lacking(wv, light, of_view);
    return film_not_negative(sum);
}

#endif
uniform highp sampler2D film_texels;
vec3 film_light_texel(int i, int view) { return texelFetch(film_texels, ivec2(i, view), 0).rgb; }
`;

// Replaces the formulas of three's standard material for each of its lights, by the sum of these terms: materials, or one.
// `texel` is appended to the arguments of a reflectance's functions.
const reflection = (terms) => /* glsl */ `
mat3 measured_frame;  // from the frame around the normal to that of the view
mat3 measured_in_map; // and to that of the environment
vec3 measured_wv;     // to the viewer, in the frame around the normal
// The environment, filtered by three as for GGX. Without an environment, the functions below are not called.
vec3 measured_radiance(vec3 direction, float roughness) {
    #if defined(USE_ENVMAP) && defined(ENVMAP_TYPE_PMREM)
        return textureLod(envMap, measured_in_map * direction, roughnessToMip(roughness)).rgb * envMapIntensity;
    #else
        return vec3(0.0);
    #endif
}
// The weight, colour and saturation of each term.
float measured_weights[${terms.length}];
uniform vec3 measured_colours[${terms.length}];
uniform float measured_saturations[${terms.length}];
float measured_saturation;  // of the term that is evaluated
vec3 measured_saturated(vec3 reflectance) {
    return mix(vec3(dot(reflectance, vec3(0.2126, 0.7152, 0.0722))), reflectance, measured_saturation);
}
vec3 measured_reflected(vec3 weight, vec3 radiance) { return measured_saturated(weight) * radiance; }
${[...new Set(terms.map((term) => term.functions))].join('')}
// The frame around the normal, made visible to the viewer. x is along the tangent if the geometry has tangents
// (define USE_TANGENT), otherwise along the circle of latitude around y.
mat3 measured_frame_of(vec3 n, vec3 wv) {
    n = normalize(n + max(0.01 - dot(n, wv), 0.0) * wv);
    #ifdef USE_TANGENT
        vec3 t = vTangent - dot(vTangent, n) * n;
    #else
        vec3 t = cross((viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz, n);
    #endif
    t = dot(t, t) > 1e-12 ? normalize(t) : normalize(cross(n, (viewMatrix * vec4(0.0, 0.0, 1.0, 0.0)).xyz));
    return mat3(t, cross(n, t), n);
}
void RE_Direct_Measured(const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal,
                        const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal,
                        const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
    vec3 wl = directLight.direction * measured_frame;
    ${sumOf(terms, 'brdf', 'wl, measured_wv')}
    reflectedLight.directDiffuse += max(wl.z, 0.0) * reflected * material.diffuseColor * directLight.color;
}
#if NUM_RECT_AREA_LIGHTS > 0
// A rectangular light emits to one side only.
void RE_Direct_RectArea_Measured(const in RectAreaLight rectAreaLight, const in vec3 geometryPosition,
                                 const in vec3 geometryNormal, const in vec3 geometryViewDir,
                                 const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material,
                                 inout ReflectedLight reflectedLight) {
    vec3 middle = rectAreaLight.position - geometryPosition, x = rectAreaLight.halfWidth, y = rectAreaLight.halfHeight;
    if (dot(cross(x, y), middle) < 0.0) return;
    middle = middle * measured_frame, x = x * measured_frame, y = y * measured_frame;
    vec3 a = middle - x - y, b = middle + x - y, c = middle + x + y, d = middle - x + y;
    ${sumOf(terms, 'area', 'measured_wv, a, b, c, d')}
    reflectedLight.directDiffuse += rectAreaLight.color * material.diffuseColor * reflected;
}
#endif
void RE_IndirectDiffuse_Measured(const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal,
                                 const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal,
                                 const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
    if (irradiance == vec3(0.0)) return;
    float cosine = saturate(dot(geometryNormal, geometryViewDir));
    ${sumOf(terms, 'albedo', 'cosine')}
    reflectedLight.indirectDiffuse += irradiance * RECIPROCAL_PI * reflected * material.diffuseColor;
}
void RE_IndirectSpecular_Measured(const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance,
                                  const in vec3 geometryPosition, const in vec3 geometryNormal,
                                  const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal,
                                  const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
    #ifdef USE_ENVMAP
        measured_in_map = envMapRotation * transpose(mat3(viewMatrix)) * measured_frame;
    #endif
    ${sumOf(terms, 'environment', 'measured_wv')}
    reflectedLight.indirectDiffuse += reflected * material.diffuseColor;
}
// What three looks up for its own formulas.
#undef STANDARD
#define getIBLRadiance(viewer, normal, roughness) vec3(0.0)
#undef RE_Direct
#undef RE_Direct_RectArea
#undef RE_IndirectDiffuse
#undef RE_IndirectSpecular
#define RE_Direct RE_Direct_Measured
#define RE_Direct_RectArea RE_Direct_RectArea_Measured
#define RE_IndirectDiffuse RE_IndirectDiffuse_Measured
#define RE_IndirectSpecular RE_IndirectSpecular_Measured
`;
// The statements that set what all lights share.
const view = `
vec3 measured_view = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(vViewPosition);
measured_frame = measured_frame_of(normal, measured_view);
measured_wv = measured_view * measured_frame;
`;
// The statements that sum a function of all terms with a weight. An environment's functions saturate themselves, because
// radiance has colours too.
const sumOf = (terms, what, inputs) => 'vec3 reflected = vec3(0.0);' + terms.map(({ reflectance, texel }, i) => {
    const value = `${reflectance}_${what}(${inputs}${texel})`;
    return `
    if (measured_weights[${i}] > 0.0) {
        measured_saturation = measured_saturations[${i}];
        reflected += measured_weights[${i}] * measured_colours[${i}] *
                     ${what === 'environment' ? value : `max(measured_saturated(${value}), 0.0)`};
    }`;
}).join('');

// The texels of NAME_light_texel, one row for each view. They are in a texture because some drivers index constants slowly.
function lobesTexture(numbers) {
    const views = 32, texels = new Float32Array((4 * numbers.length) / 3);
    for (let i = 0, j = 0; i < numbers.length; i += 3, j += 4) texels.set(numbers.slice(i, i + 3), j);
    const texture = new DataTexture(texels, texels.length / (4 * views), views, RGBAFormat, FloatType);
    texture.needsUpdate = true;
    return texture;
}

const after = (text, place, more) => text.replace(place, () => place + more);
// Adds the varying `measured_uv`: the mesh's uv, transformed as `texture()` says, which may be null.
function addUv(shader, texture) {
    shader.uniforms.measured_transform = {
        get value() {
            const of = texture();
            if (of?.matrixAutoUpdate) of.updateMatrix();
            return of?.matrix ?? new Matrix3();
        },
    };
    shader.vertexShader = after(shader.vertexShader, '#include <uv_pars_vertex>', `
        uniform mat3 measured_transform;
        varying vec2 measured_uv;`);
    shader.vertexShader = after(shader.vertexShader, '#include <uv_vertex>', `
        measured_uv = (measured_transform * vec3(uv, 1.0)).xy;`);
}

// A MeshStandardMaterial with a measured reflectance under every light of three: environments (of the scene or its
// own), area lights, ambient light and light probes too. Skinning, instances, shadows, fog, occlusion,
// transparency, normal and bump maps are three's. Colours, colour maps and vertex colours multiply the reflectance,
// and `saturation` multiplies its distance from grey. Roughness and metalness are not used.
class MeasuredMaterial extends MeshStandardMaterial {
    constructor(reflectance, { saturation = 1, ...parameters } = {}, { texel = '', lobes = null, terms } = {}) {
        super({ metalness: 0, ...parameters });
        this.saturation = saturation;
        Object.defineProperties(this, { reflectance: { value: reflectance }, texel: { value: texel }, lobes: { value: lobes },
            functions: { value: functions }, terms: { value: terms ?? [this] } });
    }
    copy(source) {
        super.copy(source);
        this.saturation = source.saturation ?? 1;
        return this;
    }
    // What three calls. A function that a page sets here runs after the material's own.
    get onBeforeCompile() {
        const { added } = this;
        return (shader, renderer) => {
            if (!shader.uniforms.measured_colours) this.addReflectance(shader);
            added?.call(this, shader, renderer);
        };
    }
    set onBeforeCompile(added) {
        this.added = added;
    }
    addReflectance(shader) {
        const { terms } = this, white = new Color(1, 1, 1);
        for (const { reflectance, lobes } of terms) shader.uniforms[`${reflectance}_texels`] = { value: lobes };
        shader.uniforms.measured_colours = { get value() { return terms.length > 1 ? terms.map((term) => term.color) : [white]; } };
        shader.uniforms.measured_saturations = { get value() { return terms.map((term) => term.saturation); } };
        shader.fragmentShader = after(shader.fragmentShader, '#include <lights_physical_pars_fragment>', reflection(terms));
        shader.fragmentShader = after(shader.fragmentShader, '#include <lights_physical_fragment>', view + this.weights());
    }
    // The statements that set the weights of the terms.
    weights() {
        return '\nmeasured_weights[0] = 1.0;';
    }
    customProgramCacheKey() {
        return this.terms.map((term) => term.reflectance + term.functions).join() + this.added;
    }
    // The JSON of three names the class of a model, which a page that loads it imports. Of blends and maps loading it yields a
    // MeshStandardMaterial.
    toJSON(meta) {
        if (this.savedAs) return { ...super.toJSON(meta), type: this.savedAs, saturation: this.saturation };
        console.warn(`${this.constructor.name}: JSON does not keep the reflectance; construct the material after loading`);
        return super.toJSON(meta);
    }
    fromJSON(json, textures) {
        super.fromJSON(json, textures);
        this.saturation = json.saturation ?? 1;
        return this;
    }
}
// Lets the loaders of three make materials of that name.
function savedAs(name, material) {
    Object.defineProperty(material.prototype, 'savedAs', { value: name });
    MaterialLoader.registerMaterial?.(name, material);
}

const film_lobes = lobesTexture([
    0.9777416, 0.21114397, 0.008775546,
    0.97576827, 1.0557961, 1.1215872,
    0.86883473, 0.3922485, 0.008775546,
    0.4845147, 0.43481782, 0.3831453,
    0.5486528, 0.36724895, 0.008775546,
    0.045490406, 0.030033162, 0.016223656,
    0.9629748, 0.35622546, 0.008775546,
    -0.5100901, -0.5176008, -0.5155155,
    0.2977831, 0.276252, 0.23969467,
    0.42993975, 0.3886708, 0.34150586,
    0.33716756, 0.24254058, 0.1573284,
    0.33835596, 0.13040932, 0.114151195,
    0.23571333, 0.09786571, 0.15486483,
    0.9777806, 0.21114397, 0.008775546,
    0.9757649, 1.055793, 1.1215838,
    0.8685026, 0.3922485, 0.008775546,
    0.48451254, 0.43481603, 0.38314322,
    0.5527882, 0.36724895, 0.008775546,
    0.045490295, 0.030035099, 0.016225949,
    0.96330374, 0.35622546, 0.008775546,
    -0.51009315, -0.5176036, -0.5155185,
    0.2977831, 0.276252, 0.23969467,
    0.42947233, 0.3879421, 0.34336588,
    0.33539322, 0.23629618, 0.14873944,
    0.33570638, 0.12824287, 0.1163338,
    0, 0, 0,
    0.97716403, 0.21114397, 0.009262258,
    0.97575796, 1.0557865, 1.121577,
    0.865278, 0.3922485, 0.009262258,
    0.48450822, 0.43481246, 0.38313892,
    0.5562755, 0.36724895, 0.009262258,
    0.04549, 0.030038862, 0.01623046,
    0.9630921, 0.35622546, 0.009262258,
    -0.5100995, -0.5176096, -0.5155249,
    0.29778272, 0.27625176, 0.23969486,
    0.4300282, 0.3881421, 0.34593692,
    0.33424217, 0.230582, 0.14083304,
    0.3328543, 0.12624528, 0.118512355,
    0, 0, 0,
    0.97738147, 0.21114397, 0.010025645,
    0.9757484, 1.055778, 1.1215686,
    0.8628609, 0.3922485, 0.010025645,
    0.48450202, 0.43480754, 0.38313335,
    0.56585646, 0.36724895, 0.010025645,
    0.04548923, 0.030043205, 0.016235651,
    0.9643933, 0.35622546, 0.010025645,
    -0.51010936, -0.5176185, -0.51553386,
    0.31828076, 0.29434374, 0.25290772,
    0.43154392, 0.38922542, 0.34911737,
    0.33372706, 0.22541864, 0.13364881,
    0.32981715, 0.1244072, 0.120676525,
    0, 0, 0,
    0.9776829, 0.21114397, 0.010196423,
    0.97572166, 1.0557572, 1.1215502,
    0.86240464, 0.3922485, 0.010196423,
    0.48448378, 0.43479437, 0.38311908,
    0.57365435, 0.36724895, 0.010196423,
    0.04548638, 0.030054532, 0.016248688,
    0.9646198, 0.35622546, 0.010196423,
    -0.510145, -0.51764864, -0.5155612,
    0.33615673, 0.31013444, 0.26444918,
    0.43388167, 0.39107674, 0.352744,
    0.33373496, 0.22071844, 0.12714033,
    0.32660884, 0.1227112, 0.12281408,
    0, 0, 0,
    0.9790174, 0.21114397, 0.009675156,
    0.97544193, 1.0555857, 1.1214495,
    0.86827177, 0.3922485, 0.009675156,
    0.48429644, 0.43466967, 0.38297442,
    0.57527643, 0.36724895, 0.009675156,
    0.04548893, 0.030217428, 0.016414957,
    0.9667982, 0.35622546, 0.009675156,
    -0.51070994, -0.51811767, -0.51595634,
    0.35197902, 0.3241138, 0.2746715,
    0.43684456, 0.39352307, 0.35660547,
    0.33423343, 0.21645916, 0.12131095,
    0.32323655, 0.12113253, 0.12491075,
    0, 0, 0,
    0.981835, 0.21114397, 0.0087254,
    0.9752264, 1.0559849, 1.1223946,
    0.87948966, 0.3922485, 0.0087254,
    0.48422816, 0.4346684, 0.38264,
    0.5756664, 0.36724895, 0.0087254,
    0.046200637, 0.031348236, 0.017282648,
    0.9691961, 0.35622546, 0.0087254,
    -0.51471233, -0.5215671, -0.5187293,
    0.3663098, 0.33677322, 0.28393242,
    0.44018555, 0.39633945, 0.36044982,
    0.33509567, 0.2125363, 0.116102,
    0.3197137, 0.11964703, 0.12695624,
    0, 0, 0,
    0.9850454, 0.21114397, 0.0077503854,
    0.98128223, 1.063952, 1.1323547,
    0.90353286, 0.3922485, 0.0077503854,
    0.48781818, 0.43713802, 0.38258573,
    0.582824, 0.36724895, 0.0077503854,
    0.0494447, 0.03388621, 0.018243784,
    0.9730804, 0.35622546, 0.0077503854,
    -0.53197795, -0.5367927, -0.5309431,
    0.37946367, 0.34838802, 0.29243392,
    0.4436237, 0.39926225, 0.36399925,
    0.33630678, 0.20894079, 0.11152519,
    0.31607062, 0.11823541, 0.12895027,
    0, 0, 0,
    0.9887007, 0.21114397, 0.0075485483,
    1.0146525, 1.1001204, 1.1710663,
    0.9168644, 0.3922485, 0.0075485483,
    0.5083012, 0.45087135, 0.3854821,
    0.5252859, 0.36724895, 0.0075485483,
    0.03516365, 0.02091249, 0.00820589,
    0.9753606, 0.35622546, 0.0075485483,
    -0.57393974, -0.5752944, -0.5637161,
    0.39162368, 0.35911825, 0.30029494,
    0.4468653, 0.40200981, 0.36696884,
    0.33772805, 0.20555852, 0.10751011,
    0.31232032, 0.11687186, 0.13088666,
    0, 0, 0,
    0.9911896, 0.21114397, 0.008320312,
    1.0699488, 1.159803, 1.2349049,
    0.9340075, 0.3922485, 0.008320312,
    0.52893335, 0.45722628, 0.37253767,
    0.52884215, 0.36724895, 0.008320312,
    0.026459817, 0.013069542, 0.0024790168,
    0.97902906, 0.35622546, 0.008320312,
    -0.641765, -0.6340278, -0.60932434,
    0.40289235, 0.3690533, 0.30758345,
    0.4496253, 0.40429947, 0.3690853,
    0.3393148, 0.20235331, 0.10404294,
    0.308499, 0.11554456, 0.13277394,
    0, 0, 0,
    0.99043554, 0.21114397, 0.010068323,
    1.1129628, 1.2083858, 1.2870433,
    0.9375185, 0.3922485, 0.010068323,
    0.53693366, 0.44389495, 0.33495745,
    0.5271805, 0.36724895, 0.010068323,
    0.017322056, 0.005950403, -0.0016394482,
    0.9775796, 0.35622546, 0.010068323,
    -0.68375957, -0.66186094, -0.61919796,
    0.41331893, 0.37823573, 0.31433406,
    0.45164412, 0.4058641, 0.3701021,
    0.34099612, 0.19926673, 0.10109088,
    0.30463618, 0.114243, 0.13462004,
    0, 0, 0,
    0.99332756, 0.21114397, 0.012972713,
    1.113478, 1.217277, 1.3001943,
    0.93947303, 0.3922485, 0.012972713,
    0.50820476, 0.40159, 0.2798008,
    0.682348, 0.36724895, 0.012972713,
    0.023458717, 0.005970342, -0.0046862816,
    0.980395, 0.35622546, 0.012972713,
    -0.66289485, -0.62913686, -0.57419455,
    0.42291528, 0.3866752, 0.3205579,
    0.45270485, 0.40647045, 0.3698152,
    0.34272224, 0.19626012, 0.09863107,
    0.30077663, 0.11296937, 0.13644381,
    0, 0, 0,
    0.9969819, 0.21114397, 0.017281307,
    1.0512874, 1.1688796, 1.267274,
    0.92532647, 0.3922485, 0.017281307,
    0.43127707, 0.29618636, 0.15042152,
    0.5236768, 0.36724895, 0.017281307,
    0.00813846, 0.0010960164, -0.0020427927,
    0.9880673, 0.35622546, 0.017281307,
    -0.50737035, -0.46964005, -0.41438314,
    0.43166324, 0.3943547, 0.32624745,
    0.4526446, 0.40593168, 0.36807308,
    0.34441814, 0.19327311, 0.096621476,
    0.29694128, 0.11172553, 0.13825357,
    0, 0, 0,
    0.9987677, 0.21114397, 0.023217196,
    0.97766674, 1.1158694, 1.2398733,
    0.9092452, 0.3922485, 0.023217196,
    0.3759916, 0.23349696, 0.082341455,
    0.49313712, 0.36724895, 0.023217196,
    0.007297287, 0.0015818035, 4.966081e-06,
    0.9939127, 0.35622546, 0.023217196,
    -0.37854254, -0.35521182, -0.3214123,
    0.43952715, 0.40124196, 0.3313846,
    0.45136073, 0.40411583, 0.36478293,
    0.3460526, 0.19028473, 0.09504425,
    0.29317576, 0.110527724, 0.14007135,
    0, 0, 0,
    1.0042199, 0.21114397, 0.03125713,
    0.888799, 1.0370816, 1.1771576,
    0.89601797, 0.3922485, 0.03125713,
    0.38954708, 0.23029767, 0.062517025,
    0.22704932, 0.36724895, 0.03125713,
    0.0037705977, 0.0010773327, 0.0010771005,
    1.0042307, 0.35622546, 0.03125713,
    -0.2993391, -0.27261877, -0.23923874,
    0.44645846, 0.40729332, 0.3359437,
    0.44881272, 0.4009497, 0.3599113,
    0.34757346, 0.18725412, 0.09386342,
    0.28948185, 0.109383896, 0.14189419,
    0, 0, 0,
    1.0082779, 0.21114397, 0.041931078,
    0.7937525, 0.95083946, 1.1258585,
    0.8898838, 0.3922485, 0.041931078,
    0.4112333, 0.24906556, 0.053853236,
    0.42037392, 0.36724895, 0.041931078,
    0.0034740074, 0.0009325535, 0.0048190267,
    1.0165582, 0.35622546, 0.041931078,
    -0.2272395, -0.20610768, -0.18298154,
    0.45239955, 0.41245678, 0.3398937,
    0.44502255, 0.39642143, 0.3534847,
    0.3489528, 0.18417072, 0.09305886,
    0.28587762, 0.10831166, 0.14372554,
    0, 0, 0,
    1.0106605, 0.21114397, 0.055422343,
    0.71214336, 0.8614198, 1.0410049,
    0.8780037, 0.3922485, 0.055422343,
    0.38903016, 0.23892917, 0.03236775,
    0.51788646, 0.36724895, 0.055422343,
    0.0032936728, 0.001721203, 0.017095309,
    1.0387614, 0.35622546, 0.055422343,
    -0.12457835, -0.10872187, -0.08863948,
    0.45729613, 0.41668364, 0.343207,
    0.4400667, 0.39057517, 0.34558228,
    0.35015193, 0.18100838, 0.09259624,
    0.28235132, 0.107318684, 0.14554705,
    0, 0, 0,
    1.0101404, 0.21114397, 0.0708594,
    0.65595764, 0.79017174, 0.9604142,
    0.8668012, 0.3922485, 0.0708594,
    0.35793036, 0.22575092, 0.020363351,
    0.57694274, 0.36724895, 0.0708594,
    0.004549925, 0.003937765, 0.036453288,
    1.0857594, 0.35622546, 0.0708594,
    -0.03934468, -0.02819988, -0.016160518,
    0.46106434, 0.41990155, 0.34584066,
    0.43406832, 0.38350415, 0.33632797,
    0.3511617, 0.17777483, 0.09245965,
    0.27887508, 0.10640602, 0.1473266,
    0, 0, 0,
    1.0081443, 0.21114397, 0.08598426,
    0.39688843, 0.5682871, 0.77047884,
    1.1174505, 0.3922485, 0.08598426,
    -0.25759453, -0.22102392, -0.1387301,
    0.9373284, 0.36724895, 0.08598426,
    0.6054948, 0.42534977, 0.24108037,
    1.1147609, 0.35622546, 0.08598426,
    0.2302469, 0.21526195, 0.1241748,
    0.46376324, 0.42215747, 0.34783834,
    0.42718968, 0.37534538, 0.32588422,
    0.35196283, 0.17446691, 0.09262203,
    0.27542275, 0.10557043, 0.14902835,
    0, 0, 0,
    1.0033686, 0.21114397, 0.09926318,
    0.28013918, 0.44633913, 0.6618002,
    1.1360321, 0.3922485, 0.09926318,
    -0.4100846, -0.35464573, -0.18881823,
    0.9511907, 0.36724895, 0.09926318,
    0.69478744, 0.50678843, 0.3597953,
    1.1295611, 0.35622546, 0.09926318,
    0.41245466, 0.38943043, 0.16551955,
    0.4652953, 0.42336455, 0.3491444,
    0.41961938, 0.366267, 0.31443948,
    0.35252473, 0.17107998, 0.093050584,
    0.27195475, 0.104798816, 0.15060464,
    0, 0, 0,
    0.9987972, 0.21114397, 0.11003064,
    0.21968444, 0.35593256, 0.58330786,
    1.1479709, 0.3922485, 0.11003064,
    -0.43161452, -0.37780973, -0.20698552,
    0.95260954, 0.36724895, 0.11003064,
    0.66320354, 0.4905951, 0.45060006,
    1.1278113, 0.35622546, 0.11003064,
    0.5262658, 0.51727366, 0.17258324,
    0.4656982, 0.42355704, 0.34979817,
    0.41156092, 0.35645753, 0.3021983,
    0.3528637, 0.16764717, 0.0937367,
    0.26843932, 0.10407472, 0.15200938,
    0, 0, 0,
    0.99357903, 0.21114397, 0.116612524,
    0.19175312, 0.28875658, 0.5231573,
    1.1493235, 0.3922485, 0.116612524,
    -0.39587802, -0.3260441, -0.237745,
    0.9531752, 0.36724895, 0.116612524,
    0.57854813, 0.42746803, 0.5136486,
    1.1096731, 0.35622546, 0.116612524,
    0.6028627, 0.5935372, 0.20187026,
    0.46501297, 0.42277026, 0.3498378,
    0.40322298, 0.34611562, 0.28937104,
    0.35296682, 0.16417807, 0.09465232,
    0.26487797, 0.10338882, 0.15321754,
    0, 0, 0,
    0.9896804, 0.21114397, 0.12097478,
    0.17076738, 0.23292337, 0.46441567,
    1.1559887, 0.3922485, 0.12097478,
    -0.35077724, -0.2586521, -0.29144877,
    0.9674079, 0.36724895, 0.12097478,
    0.5388821, 0.41440457, 0.5849291,
    1.0953884, 0.35622546, 0.12097478,
    0.6186808, 0.59333664, 0.2444126,
    0.463325, 0.42107913, 0.3493321,
    0.39480984, 0.33544093, 0.2761665,
    0.3528162, 0.16068749, 0.09577025,
    0.2612731, 0.102726646, 0.15420265,
    0, 0, 0,
    0.98354936, 0.21114397, 0.1239082,
    0.16857125, 0.19280702, 0.41626078,
    1.1709343, 0.3922485, 0.1239082,
    -0.28315353, -0.19491978, -0.33740333,
    0.98241866, 0.36724895, 0.1239082,
    0.48270205, 0.43054017, 0.6196022,
    1.0815282, 0.35622546, 0.1239082,
    0.60894686, 0.5515725, 0.30488515,
    0.46075568, 0.41858956, 0.34837133,
    0.38651204, 0.32462344, 0.2627816,
    0.35242817, 0.1572085, 0.097076595,
    0.25764275, 0.10207542, 0.15494789,
    0, 0, 0,
    0.9850687, 0.21114397, 0.12701666,
    0.1761434, 0.16585489, 0.371467,
    1.2031993, 0.3922485, 0.12701666,
    -0.18787462, -0.14081158, -0.32084784,
    0.98031545, 0.36724895, 0.12701666,
    0.41027603, 0.45461383, 0.5980415,
    1.0680604, 0.35622546, 0.12701666,
    0.57892984, 0.49935064, 0.35728055,
    0.4574081, 0.41539106, 0.34703088,
    0.37850142, 0.3138388, 0.24939819,
    0.35179392, 0.1537661, 0.098549016,
    0.2540506, 0.101437815, 0.15546824,
    0, 0, 0,
    0.9870764, 0.21114397, 0.1269067,
    0.18638574, 0.16053891, 0.34445915,
    1.2427831, 0.3922485, 0.1269067,
    -0.10886123, -0.10794365, -0.28477862,
    0.97646314, 0.36724895, 0.1269067,
    0.3672906, 0.46622026, 0.55631393,
    1.0555263, 0.35622546, 0.1269067,
    0.5316745, 0.45824394, 0.39275065,
    0.45353228, 0.41171366, 0.34549844,
    0.37092653, 0.30324334, 0.23617874,
    0.35092, 0.15038647, 0.100168765,
    0.25054467, 0.1008086, 0.1557668,
    0, 0, 0,
    0.9813004, 0.21114397, 0.124547005,
    0.20533226, 0.18380898, 0.34046412,
    1.3, 0.3922485, 0.124547005,
    -0.050848275, -0.08311104, -0.25105068,
    0.99812496, 0.36724895, 0.124547005,
    0.34826133, 0.4451854, 0.50882465,
    1.0371137, 0.35622546, 0.124547005,
    0.46993515, 0.42577574, 0.41108462,
    0.44933268, 0.40772852, 0.34390682,
    0.36395073, 0.2929909, 0.22326906,
    0.3498125, 0.14709984, 0.10191921,
    0.24719407, 0.10019164, 0.15586403,
    0, 0, 0,
    0.9798444, 0.21114397, 0.120770775,
    0.23754944, 0.22708172, 0.36498907,
    1.3, 0.3922485, 0.120770775,
    0.013922875, -0.029892754, -0.23317109,
    1.0073038, 0.36724895, 0.120770775,
    0.31712517, 0.3872588, 0.4620662,
    1.0073189, 0.35622546, 0.120770775,
    0.39778504, 0.38008156, 0.41477755,
    0.44501358, 0.4036186, 0.342397,
    0.3575948, 0.2831524, 0.21077771,
    0.34845775, 0.14392093, 0.10377487,
    0.2440735, 0.09959434, 0.1557866,
    0, 0, 0,
    0.9749037, 0.21114397, 0.11695214,
    0.2638911, 0.2596945, 0.39545077,
    1.3, 0.3922485, 0.11695214,
    0.092401996, 0.047601137, -0.18830863,
    0.9874476, 0.36724895, 0.11695214,
    0.2741969, 0.3240306, 0.40612805,
    0.98466444, 0.35622546, 0.11695214,
    0.3282985, 0.32617113, 0.39417756,
    0.44083256, 0.3996146, 0.3411437,
    0.35195205, 0.27382046, 0.1988039,
    0.34688553, 0.14088622, 0.105730385,
    0.24129933, 0.09904395, 0.15559581,
    0, 0, 0,
    0.9735944, 0.21114397, 0.114609405,
    0.2796608, 0.27720547, 0.41811228,
    1.3, 0.3922485, 0.114609405,
    0.15112582, 0.10975501, -0.13934551,
    0.94691443, 0.36724895, 0.114609405,
    0.24321105, 0.27918005, 0.35731372,
    0.969182, 0.35622546, 0.114609405,
    0.27677038, 0.2860403, 0.3703755,
    0.4370305, 0.39593232, 0.34030455,
    0.34709775, 0.2650837, 0.18743728,
    0.34507665, 0.13800274, 0.10775854,
    0.23896943, 0.09856362, 0.15534358,
    0, 0, 0,
    1.0102915, 0.21114397, 0.116236694,
    0.2841773, 0.28471944, 0.43332514,
    1.3, 0.3922485, 0.116236694,
    0.15758823, 0.1338243, -0.10726116,
    1.0587898, 0.36724895, 0.116236694,
    0.2455725, 0.25923085, 0.32252163,
    0.8128739, 0.35622546, 0.116236694,
    0.24811687, 0.26360893, 0.3545174,
    0.43382984, 0.39277247, 0.3400188,
    0.34301198, 0.25694242, 0.17670552,
    0.34304753, 0.13528864, 0.109847754,
    0.23720525, 0.098190166, 0.1551043,
    0, 0, 0,
    1.1619953, 0.21114397, 0.11891504,
    0.28230977, 0.2863114, 0.4372299,
    1.3, 0.3922485, 0.11891504,
    0.13982801, 0.1391868, -0.08527745,
    0.8970851, 0.36724895, 0.11891504,
    0.24969491, 0.2526672, 0.30824047,
    0.7587586, 0.35622546, 0.11891504,
    0.25796142, 0.26055622, 0.34315762,
    0.43141925, 0.3903078, 0.34039637,
    0.33971882, 0.24943778, 0.16666868,
    0.34081098, 0.13275924, 0.11198662,
    0.23609103, 0.09794795, 0.15492685,
    0, 0, 0,
]);
export class FilmMaterial extends MeasuredMaterial {
    constructor(parameters) {
        super('film', parameters, { lobes: film_lobes });
    }
}
savedAs('FilmMaterial', FilmMaterial);

// Two or three materials, of this module or others, mixed by a mask: a texture at the mesh's uv, whose red is the share of
// the second material and green that of the third, at most what the second leaves, while the first has the rest. With
// `vertexMask` these are the red and green of the geometry's colours instead. Without either, `shares` are those of all.
// The colour and saturation of each material count; all else is of the blend. Colours and saturations of the materials,
// the shares and the texture may change without another compilation.
export class BlendMaterial extends MeasuredMaterial {
    constructor(...of) {
        const { mask = null, vertexMask = false, shares, ...parameters } = of.at(-1)?.isMaterial ? {} : of.pop() ?? {};
        if (of.length < 2 || of.length > 3 || !of.every((material) => material.reflectance && !material.texel))
            throw new Error('BlendMaterial: expected two or three materials of such modules');
        if (of.some((a) => of.some((b) => a.reflectance === b.reflectance && a.functions !== b.functions)))
            throw new Error('BlendMaterial: expected materials of different names, as modules define functions by them');
        super('blend', parameters, { terms: of });
        this.mask = mask;
        this.vertexMask = vertexMask;
        this.shares = shares ?? of.map(() => 1 / of.length);
    }
    clone() {
        return new this.constructor(...this.terms, {}).copy(this);
    }
    copy(source) {
        super.copy(source);
        this.mask = source.mask;
        this.vertexMask = source.vertexMask;
        this.shares = [...source.shares];
        return this;
    }
    weights() {
        const of = this.mask ? 'texture2D(measured_mask, measured_uv).rg' : 'measured_vertex_mask';
        return this.mask || this.vertexMask ? `
            vec2 mask = clamp(${of}, 0.0, 1.0);
            mask.g = ${this.terms.length > 2 ? 'min(mask.g, 1.0 - mask.r)' : '0.0'};
            measured_weights[0] = 1.0 - mask.r - mask.g;
            measured_weights[1] = mask.r;
            ${this.terms.length > 2 ? 'measured_weights[2] = mask.g;' : ''}` : `
            measured_weights = measured_shares;`;
    }
    addReflectance(shader) {
        super.addReflectance(shader);
        const material = this, count = this.terms.length;
        let inputs = `uniform float measured_shares[${count}];\n`;
        if (this.mask) {
            addUv(shader, () => material.mask);
            shader.uniforms.measured_mask = { get value() { return material.mask; } };
            inputs = 'uniform sampler2D measured_mask;\nvarying vec2 measured_uv;\n';
        } else if (this.vertexMask) {
            shader.vertexShader = after(after(shader.vertexShader, '#include <uv_pars_vertex>', `
                #if !defined(USE_COLOR) && !defined(USE_COLOR_ALPHA)
                    attribute vec3 color;
                #endif
                varying vec2 measured_vertex_mask;`), '#include <uv_vertex>', `
                measured_vertex_mask = color.rg;`);
            inputs = 'varying vec2 measured_vertex_mask;\n';
        }
        shader.uniforms.measured_shares = { get value() { return material.shares; } };
        shader.fragmentShader = shader.fragmentShader.replace('#include <common>', (place) => `${place}\n${inputs}`);
    }
    customProgramCacheKey() {
        return [super.customProgramCacheKey(), this.mask !== null, this.vertexMask].join();
    }
}
