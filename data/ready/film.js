// For three.js, release 187, and its WebGLRenderer.
import { Color, DataTexture, FloatType, MaterialLoader, Matrix3, MeshStandardMaterial, RGBAFormat, REVISION } from 'three';

if (parseInt(REVISION) !== 187)
    console.warn(`three.js ${REVISION}: this material was written for release 187, and may ignore environments in others`);

const functions = /* glsl */ `
#define film_radiance measured_radiance
#define film_reflected measured_reflected
#define film_lobe_roughness(k) ((k) == 1 ? 0.19347532 : (k) == 2 ? 0.36808193 : (k) == 3 ? 0.36741447 : (k) == 4 ? 0.41157073 : 1.0)
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
    film_AxialPsi psi_0 = film_axial_psi(wl, wv, 0.42456055, 1.8886719);
    of_pair.x[0] = vec3(film_squared_distance_from_pole(psi_0, 1.0), film_squared_distance_from_pole(psi_0, -1.0), 0.0);
    film_AxialPsi psi_1 = film_axial_psi(wl, wv, 1.1005859, 0.0034179688);
    of_pair.x[1] = vec3(film_squared_distance_from_pole(psi_1, 1.0), film_squared_distance_from_pole(psi_1, -1.0), 0.0);
    film_AxialPsi psi_2 = film_axial_psi(wl, wv, -0.24902344, 1.3388672);
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
//   albedo_error 0.134
//   delta_e_itp 5.521
//   flip 0.07501
//   generator srbf 0.1.0
//   heldout_squared_error_ratio 0.1508
//   heldout_squared_error_ratio_cosine 0.04774
//   max_theta 89
//   objective appearance
//   psnr 32.98
//   rms 0.1172
//   seed 0
//   source cc_ibiza_sunset_rgb.bsdf
//   squared_error_ratio 0.07106

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
const float film_lobes[99] = float[99](
    0.97265625, 0.9975586, 0.95996094, 54.34375, -13.1796875, 23.078125, -16.25, 0.0, -5.8203125, 45.75, 7.5078125,
    0.9980469, 0.16137695, 0.0, -8.8984375, 4.0703125, 4.5234375, -2.3046875, 0.76416016, -6.2773438, 1.6425781, -12.984375,
    0.9995117, 0.59228516, 0.0026817322, -4.8710938, 41.625, 24.09375, 6.6601562, 0.0, -70.25, 14.234375, -2.0039062,
    0.9472656, 0.8388672, 0.69873047, 300.0, 1.7919922, 129.75, -191.75, 0.033172607, -21.390625, 166.0, -12.4140625,
    0.9951172, 0.29174805, 0.33447266, 31.265625, 1.8994141, 32.125, -16.1875, 2.8378906, -22.84375, 38.8125, 5.265625,
    1.0029297, 0.4555664, 0.9736328, 8.8125, 113.0625, 9.2890625, -4.4453125, 0.0, -51.15625, 79.9375, -1.9277344,
    0.99902344, 0.3996582, 0.0, 2.8847656, 3.1875, -3.1796875, 4.7578125, 0.4284668, -10.859375, 6.125, 1.0859375,
    0.9848633, 0.359375, 0.23632812, 127.75, -45.03125, 63.8125, -22.15625, 8.1875, -36.1875, 64.875, -2.0019531,
    0.26953125, 0.17370605, 0.9995117, -5.3320312, 24.546875, 11.7890625, 1.3505859, 0.3828125, -21.359375, 1.6132812, -7.8476562
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
    float exponent_0 = 78.40146 + -8.396936 * features.x[1] + 66.003296 * features.x[2] + 10.831484 * features.x[3];
    float power_0 = 0.5 * (film_pm_lobe(0, exponent_0, of_pair) + film_pm_lobe(0, exponent_0, exchanged));
    sum = sum + power_0 * vec3(0.97265625, 0.9975586, 0.95996094);
    float exponent_1 = -12.837731 + 1.1024501 * features.x[0] + -9.056293 * features.x[1] + 2.3697393 * features.x[2] +
            -18.732494 * features.x[3];
    float power_1 = 0.5 * (film_pm_lobe(1, exponent_1, of_pair) + film_pm_lobe(1, exponent_1, exchanged));
    sum = sum + power_1 * vec3(0.9980469, 0.16137695, 0.0);
    float exponent_2 = -7.027503 + -101.34933 * features.x[1] + 20.535862 * features.x[2] + -2.8910255 * features.x[3];
    float power_2 = 0.5 * (film_pm_lobe(2, exponent_2, of_pair) + film_pm_lobe(2, exponent_2, exchanged));
    sum = sum + power_2 * vec3(0.9995117, 0.59228516, 0.0026817322);
    float exponent_3 = 432.8085 + 0.047857955 * features.x[0] + -30.86015 * features.x[1] + 239.48738 * features.x[2] +
            -17.909706 * features.x[3];
    float power_3 = 0.5 * (film_pm_lobe(3, exponent_3, of_pair) + film_pm_lobe(3, exponent_3, exchanged));
    sum = sum + power_3 * vec3(0.9472656, 0.8388672, 0.69873047);
    float exponent_4 = 45.106762 + 4.0942106 * features.x[0] + -32.956566 * features.x[1] + 55.994602 * features.x[2] +
            7.596691 * features.x[3];
    float power_4 = 0.5 * (film_pm_lobe(4, exponent_4, of_pair) + film_pm_lobe(4, exponent_4, exchanged));
    sum = sum + power_4 * vec3(0.9951172, 0.29174805, 0.33447266);
    float exponent_5 = 12.71375 + -73.80287 * features.x[1] + 115.32543 * features.x[2] + -2.781133 * features.x[3];
    float power_5 = 0.5 * (film_pm_lobe(5, exponent_5, of_pair) + film_pm_lobe(5, exponent_5, exchanged));
    sum = sum + power_5 * vec3(1.0029297, 0.4555664, 0.9736328);
    float exponent_6 = 4.161837 + 0.61814696 * features.x[0] + -15.666766 * features.x[1] + 8.836507 * features.x[2] +
            1.5666766 * features.x[3];
    float power_6 = 0.5 * (film_pm_lobe(6, exponent_6, of_pair) + film_pm_lobe(6, exponent_6, exchanged));
    sum = sum + power_6 * vec3(0.99902344, 0.3996582, 0.0);
    float exponent_7 = 184.30429 + 11.812066 * features.x[0] + -52.207527 * features.x[1] + 93.59484 * features.x[2] +
            -2.888208 * features.x[3];
    float power_7 = 0.5 * (film_pm_lobe(7, exponent_7, of_pair) + film_pm_lobe(7, exponent_7, exchanged));
    sum = sum + power_7 * vec3(0.9848633, 0.359375, 0.23632812);
    float exponent_8 = -7.692495 + 0.5522817 * features.x[0] + -30.815063 * features.x[1] + 2.3274727 * features.x[2] +
            -11.3217745 * features.x[3];
    float power_8 = 0.5 * (film_pm_lobe(8, exponent_8, of_pair) + film_pm_lobe(8, exponent_8, exchanged));
    sum = sum + power_8 * vec3(0.26953125, 0.17370605, 0.9995117);
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
// Three looks these up for its own formulas.
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
            const map = texture();
            if (map?.matrixAutoUpdate) map.updateMatrix();
            return map?.matrix ?? new Matrix3();
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
    // Three calls this function. One that a page sets here runs after the material's own.
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
    0.984182, 0.19347532, 0.008366171,
    0.80957323, 0.8591542, 0.9073139,
    0.9749012, 0.36808193, 0.008366171,
    -0.7258748, -0.700411, -0.662941,
    0.9187466, 0.36741447, 0.008366171,
    0.7853024, 0.7151559, 0.6373965,
    0.999, 0.41157073, 0.008366171,
    0.09115069, 0.087158956, 0.07974168,
    0.37250504, 0.3434849, 0.29861313,
    0.44131815, 0.39765435, 0.34366068,
    0.33680525, 0.24107683, 0.16195108,
    0.3388368, 0.13004838, 0.11190666,
    0.23942135, 0.0965504, 0.15237822,
    0.98416394, 0.19347532, 0.008366171,
    0.80957407, 0.85915715, 0.9073181,
    0.97446024, 0.36808193, 0.008366171,
    -0.72587305, -0.7004082, -0.66293764,
    0.91892904, 0.36741447, 0.008366171,
    0.78530324, 0.7151573, 0.6373979,
    0.999, 0.41157073, 0.008366171,
    0.091152556, 0.08716194, 0.07974521,
    0.37250504, 0.3434849, 0.29861313,
    0.44083202, 0.39790097, 0.34477714,
    0.33467904, 0.2349025, 0.15299526,
    0.33626094, 0.12791318, 0.11431447,
    0, 0, 0,
    0.98419386, 0.19347532, 0.008574716,
    0.80957663, 0.8591639, 0.9073273,
    0.97443604, 0.36808193, 0.008574716,
    -0.72586775, -0.700401, -0.6629297,
    0.91840667, 0.36741447, 0.008574716,
    0.7853056, 0.7151608, 0.63740134,
    0.999, 0.41157073, 0.008574716,
    0.09115987, 0.08717114, 0.079754986,
    0.37250596, 0.34348595, 0.29861423,
    0.4408766, 0.39866433, 0.34636226,
    0.33326387, 0.22931647, 0.1446243,
    0.33350003, 0.12595235, 0.116870925,
    0, 0, 0,
    0.9843036, 0.19347532, 0.008861202,
    0.8095817, 0.8591748, 0.9073417,
    0.97479355, 0.36808193, 0.008861202,
    -0.7258587, -0.7003892, -0.6629169,
    0.91813767, 0.36741447, 0.008861202,
    0.78530985, 0.7151665, 0.6374069,
    0.99900097, 0.41157073, 0.008861202,
    0.09117292, 0.08718672, 0.07977116,
    0.38722882, 0.35631928, 0.3091664,
    0.44142503, 0.39989385, 0.34834835,
    0.33260345, 0.22435738, 0.1369195,
    0.33056688, 0.12415705, 0.1195607,
    0, 0, 0,
    0.98391247, 0.19347532, 0.008899701,
    0.80960494, 0.85921836, 0.90739733,
    0.9747136, 0.36808193, 0.008899701,
    -0.72582275, -0.70034444, -0.6628692,
    0.9179351, 0.36741447, 0.008899701,
    0.78532636, 0.7151872, 0.6374262,
    0.9990092, 0.41157073, 0.008899701,
    0.09122331, 0.08724511, 0.079831205,
    0.3987007, 0.36621347, 0.31723058,
    0.44240502, 0.4014932, 0.35062453,
    0.33257484, 0.21991761, 0.1298448,
    0.32746875, 0.12251276, 0.12235716,
    0, 0, 0,
    0.982717, 0.19347532, 0.00865886,
    0.81006336, 0.8599968, 0.90838116,
    0.9747316, 0.36808193, 0.00865886,
    -0.7251508, -0.69955415, -0.6620353,
    0.91583216, 0.36741447, 0.00865886,
    0.7855522, 0.7154423, 0.63764024,
    0.9990516, 0.41157073, 0.00865886,
    0.09211942, 0.08823535, 0.080835976,
    0.4080871, 0.37421077, 0.32368216,
    0.44370955, 0.4033302, 0.35304636,
    0.33313918, 0.21596557, 0.12343219,
    0.32420403, 0.120998845, 0.12522219,
    0, 0, 0,
    0.98814785, 0.19347532, 0.00813383,
    0.81180084, 0.8637408, 0.9136454,
    0.9778406, 0.36808193, 0.00813383,
    -0.72300845, -0.697114, -0.65943956,
    0.92075753, 0.36741447, 0.00813383,
    0.7847392, 0.71419454, 0.6357773,
    0.9992037, 0.41157073, 0.00813383,
    0.09409279, 0.09036002, 0.0829986,
    0.4161127, 0.38095787, 0.3290638,
    0.4451977, 0.40523842, 0.35543734,
    0.33416912, 0.2123955, 0.11765559,
    0.3207715, 0.11959375, 0.12811266,
    0, 0, 0,
    0.9879998, 0.19347532, 0.0075959624,
    0.8176913, 0.8768386, 0.9328115,
    0.97990113, 0.36808193, 0.0075959624,
    -0.7150952, -0.6892556, -0.6515325,
    0.9209027, 0.36741447, 0.0075959624,
    0.77087224, 0.69643986, 0.61418355,
    0.99962646, 0.41157073, 0.0075959624,
    0.103449374, 0.09918619, 0.09124343,
    0.42316467, 0.38680238, 0.33366886,
    0.44670084, 0.40702394, 0.3575966,
    0.335612, 0.20916536, 0.112539224,
    0.31718424, 0.11828023, 0.13098866,
    0, 0, 0,
    0.99138373, 0.19347532, 0.0073581683,
    0.84403765, 0.9199101, 0.99068856,
    0.9830478, 0.36808193, 0.0073581683,
    -0.69433993, -0.6698942, -0.6330814,
    0.9285878, 0.36741447, 0.0073581683,
    0.72379297, 0.63710284, 0.54274684,
    1, 0.41157073, 0.0073581683,
    0.105550095, 0.10082123, 0.09238525,
    0.42946047, 0.39194143, 0.33766547,
    0.4480373, 0.4084807, 0.3593135,
    0.33729732, 0.20613518, 0.10802626,
    0.31343904, 0.11703433, 0.13380086,
    0, 0, 0,
    0.9908882, 0.19347532, 0.0078124525,
    0.90038407, 1.0040952, 1.0999262,
    0.97605705, 0.36808193, 0.0078124525,
    -0.6113599, -0.5879924, -0.5528727,
    0.9192124, 0.36741447, 0.0078124525,
    0.57256997, 0.46746215, 0.35639575,
    0.93518, 0.41157073, 0.0078124525,
    0.1255167, 0.11347575, 0.09789104,
    0.43513232, 0.39649692, 0.34115928,
    0.44902855, 0.40940627, 0.36038202,
    0.33915362, 0.20324892, 0.104121104,
    0.30955112, 0.115840204, 0.13651012,
    0, 0, 0,
    0.9912229, 0.19347532, 0.00912718,
    0.9684781, 1.0810558, 1.17969,
    0.990577, 0.36808193, 0.00912718,
    -0.5600098, -0.5436033, -0.5133942,
    0.9153574, 0.36741447, 0.00912718,
    0.38757902, 0.27618483, 0.1658248,
    1, 0.41157073, 0.00912718,
    0.18590963, 0.1806137, 0.16817746,
    0.44024915, 0.40053478, 0.34420964,
    0.4495021, 0.40960678, 0.36060706,
    0.3410873, 0.20043287, 0.10080552,
    0.30553213, 0.11468108, 0.13907735,
    0, 0, 0,
    0.9933896, 0.19347532, 0.0115341935,
    1.0437367, 1.1458719, 1.2266997,
    0.98175234, 0.36808193, 0.0115341935,
    -0.4367829, -0.4398954, -0.43122375,
    0.7871486, 0.36741447, 0.0115341935,
    0.076292895, 0.022684876, -0.0136819435,
    0.92981064, 0.41157073, 0.0115341935,
    0.30369523, 0.26945746, 0.22131547,
    0.44485548, 0.40409973, 0.34685823,
    0.4493088, 0.40891415, 0.35982013,
    0.34302187, 0.19762687, 0.09806001,
    0.30141157, 0.1135485, 0.14147714,
    0, 0, 0,
    0.9950782, 0.19347532, 0.015378586,
    1.0091261, 1.1275129, 1.2240003,
    0.9837851, 0.36808193, 0.015378586,
    -0.42924663, -0.4228517, -0.40691826,
    0.8445096, 0.36741447, 0.015378586,
    0.11215033, 0.039517913, -0.017587107,
    0.93933815, 0.41157073, 0.015378586,
    0.2902753, 0.25186685, 0.20309481,
    0.44896394, 0.40720862, 0.34912422,
    0.44832924, 0.40719396, 0.35788748,
    0.34487262, 0.1947654, 0.095848255,
    0.2972007, 0.11242871, 0.14367756,
    0, 0, 0,
    0.9984997, 0.19347532, 0.020498192,
    0.93050873, 1.070432, 1.1914268,
    0.9942682, 0.36808193, 0.020498192,
    -0.25785115, -0.26040366, -0.26290107,
    0.8537456, 0.36741447, 0.020498192,
    0.10743914, 0.023706721, -0.044657666,
    0.89372724, 0.41157073, 0.020498192,
    0.20051648, 0.16123024, 0.11787438,
    0.4525793, 0.40987155, 0.35102126,
    0.44647935, 0.40435192, 0.35471603,
    0.34659582, 0.19181786, 0.09414721,
    0.29294604, 0.111322835, 0.14567298,
    0, 0, 0,
    1.0053691, 0.19347532, 0.027905876,
    0.7692706, 0.9451575, 1.1210276,
    1.0062996, 0.36808193, 0.027905876,
    -0.1676397, -0.17166379, -0.19089343,
    0.89825195, 0.36741447, 0.027905876,
    0.39218697, 0.22435264, 0.053284124,
    1.0062996, 0.41157073, 0.027905876,
    -0.01964486, -0.007654945, 0.0150914,
    0.4556818, 0.41207734, 0.35254553,
    0.443718, 0.40034196, 0.3502609,
    0.3481499, 0.18875471, 0.09291959,
    0.28866285, 0.11022182, 0.14744289,
    0, 0, 0,
    1.009535, 0.19347532, 0.03851579,
    0.6502829, 0.83515376, 1.0413699,
    0.93937445, 0.36808193, 0.03851579,
    0.08657881, 0.05604473, -0.0342385,
    0.8678169, 0.36741447, 0.03851579,
    0.34951437, 0.20196958, 0.07707168,
    1.0179191, 0.41157073, 0.03851579,
    -0.11102229, -0.1030632, -0.08677609,
    0.4582707, 0.413832, 0.3537081,
    0.44004285, 0.3951626, 0.34452188,
    0.34950498, 0.18556401, 0.09212905,
    0.28439632, 0.10913046, 0.14899121,
    0, 0, 0,
    1.0100048, 0.19347532, 0.051218323,
    0.4693047, 0.6704, 0.9088235,
    1.0526137, 0.36808193, 0.051218323,
    0.19132186, 0.1718586, 0.12366064,
    0.91726744, 0.36741447, 0.051218323,
    0.5652199, 0.36065775, 0.11462328,
    1.0526137, 0.41157073, 0.051218323,
    -0.25315055, -0.21442051, -0.1495415,
    0.46031654, 0.41511655, 0.3544993,
    0.4354899, 0.38885662, 0.3375427,
    0.3506462, 0.18224175, 0.09173106,
    0.28017983, 0.10805039, 0.15031832,
    0, 0, 0,
    1.0088805, 0.19347532, 0.06632742,
    0.35567325, 0.5491576, 0.79089844,
    1.0735941, 0.36808193, 0.06632742,
    0.3071873, 0.28223234, 0.1948739,
    0.92736596, 0.36741447, 0.06632742,
    0.61657846, 0.42113933, 0.18811494,
    1.0825499, 0.41157073, 0.06632742,
    -0.30592105, -0.2641411, -0.17597193,
    0.46182224, 0.41594213, 0.35493606,
    0.43012846, 0.3815056, 0.3294055,
    0.3515729, 0.17880546, 0.09168914,
    0.27604133, 0.10698313, 0.15142587,
    0, 0, 0,
    1.0060303, 0.19347532, 0.081899166,
    0.27564144, 0.4490459, 0.6783374,
    1.0915024, 0.36808193, 0.081899166,
    0.39221758, 0.37014958, 0.19688444,
    0.9430369, 0.36741447, 0.081899166,
    0.6585654, 0.47802818, 0.30096403,
    1.1067313, 0.41157073, 0.081899166,
    -0.35169217, -0.30928823, -0.17794542,
    0.46274868, 0.4162801, 0.35499954,
    0.42405388, 0.3732221, 0.3202227,
    0.35228512, 0.17527142, 0.091956526,
    0.27201813, 0.10593527, 0.15232648,
    0, 0, 0,
    1.0026108, 0.19347532, 0.09609184,
    0.21532908, 0.35528427, 0.5765666,
    1.0830804, 0.36808193, 0.09609184,
    0.5205375, 0.51098335, 0.20034763,
    0.9511296, 0.36741447, 0.09609184,
    0.64324737, 0.48195767, 0.42194593,
    1.1088221, 0.41157073, 0.09609184,
    -0.40285552, -0.3607793, -0.19909847,
    0.46312004, 0.41616073, 0.35472298,
    0.41738302, 0.36414343, 0.31013072,
    0.35277045, 0.17165577, 0.092482515,
    0.2681318, 0.104908794, 0.15302621,
    0, 0, 0,
    0.9996176, 0.19347532, 0.10543123,
    0.18042995, 0.28243744, 0.49878538,
    1.0967597, 0.36808193, 0.10543123,
    0.57822144, 0.59225166, 0.20403957,
    0.9546161, 0.36741447, 0.10543123,
    0.616363, 0.48027468, 0.5249202,
    1.1336553, 0.41157073, 0.10543123,
    -0.39691842, -0.36806557, -0.22633573,
    0.46293172, 0.4155886, 0.35411754,
    0.41024694, 0.3544231, 0.29928127,
    0.3530474, 0.16799998, 0.09323515,
    0.26440263, 0.1039069, 0.15353434,
    0, 0, 0,
    0.99626315, 0.19347532, 0.113466844,
    0.16556315, 0.22523214, 0.43552804,
    1.0878804, 0.36808193, 0.113466844,
    0.6180614, 0.63895243, 0.23889591,
    0.95297074, 0.36741447, 0.113466844,
    0.5533518, 0.4460903, 0.59287196,
    1.1392531, 0.41157073, 0.113466844,
    -0.35886627, -0.32548884, -0.26585245,
    0.46222082, 0.41460526, 0.35322538,
    0.40278584, 0.34422383, 0.28783372,
    0.3531137, 0.16432917, 0.094170436,
    0.26086333, 0.10293943, 0.15387408,
    0, 0, 0,
    0.9958063, 0.19347532, 0.11868069,
    0.15169117, 0.18038075, 0.37342235,
    1.0715564, 0.36808193, 0.11868069,
    0.60706395, 0.62476474, 0.29574376,
    0.97307056, 0.36741447, 0.11868069,
    0.52805674, 0.43995583, 0.65771663,
    1.1508192, 0.41157073, 0.11868069,
    -0.30802915, -0.261688, -0.32514635,
    0.46102104, 0.41324925, 0.35208616,
    0.3951442, 0.33371097, 0.27594942,
    0.3529509, 0.16066487, 0.09524753,
    0.25752753, 0.10200989, 0.15405838,
    0, 0, 0,
    0.9914795, 0.19347532, 0.12324906,
    0.15185599, 0.15789196, 0.3330121,
    1.0585303, 0.36808193, 0.12324906,
    0.5700991, 0.5763092, 0.3619022,
    0.9910486, 0.36741447, 0.12324906,
    0.49625683, 0.43853337, 0.6504052,
    1.1799052, 0.41157073, 0.12324906,
    -0.2392572, -0.19135778, -0.34319702,
    0.45938683, 0.41157746, 0.3507544,
    0.3874675, 0.32304773, 0.263786,
    0.35257205, 0.15704475, 0.096445784,
    0.25440407, 0.10112071, 0.15409951,
    0, 0, 0,
    0.9855371, 0.19347532, 0.12689176,
    0.16265666, 0.15730111, 0.3294331,
    1.0320326, 0.36808193, 0.12689176,
    0.51362365, 0.51779336, 0.4085715,
    1.029264, 0.36741447, 0.12689176,
    0.4704037, 0.43381262, 0.58965707,
    1.2291874, 0.41157073, 0.12689176,
    -0.16850342, -0.13037531, -0.3250903,
    0.45739624, 0.40966725, 0.34930167,
    0.37989676, 0.31238872, 0.25149196,
    0.3519604, 0.15349256, 0.097742535,
    0.2515261, 0.1002856, 0.15403123,
    0, 0, 0,
    0.98389465, 0.19347532, 0.12799941,
    0.17152785, 0.16750804, 0.33685765,
    1.0372798, 0.36808193, 0.12799941,
    0.4745382, 0.47801495, 0.41371837,
    1.0341809, 0.36741447, 0.12799941,
    0.45102513, 0.4269886, 0.52742666,
    1.3, 0.41157073, 0.12799941,
    -0.120482, -0.09735702, -0.27306134,
    0.45515317, 0.40761977, 0.34781978,
    0.37256768, 0.30187815, 0.23920529,
    0.35112035, 0.15003668, 0.09913018,
    0.24890156, 0.09950829, 0.15386924,
    0, 0, 0,
    0.9835084, 0.19347532, 0.13098653,
    0.18644863, 0.18905523, 0.3569326,
    1.0309218, 0.36808193, 0.13098653,
    0.43918344, 0.4411784, 0.42904797,
    1.0311134, 0.36741447, 0.13098653,
    0.42992103, 0.4101937, 0.5005658,
    1.3, 0.41157073, 0.13098653,
    -0.08265465, -0.06988797, -0.2826704,
    0.4527391, 0.4055126, 0.34637752,
    0.36564106, 0.2916637, 0.22705705,
    0.35004842, 0.14670041, 0.10060666,
    0.24654499, 0.09879605, 0.15363577,
    0, 0, 0,
    0.9801643, 0.19347532, 0.13755262,
    0.19385001, 0.20427588, 0.3636098,
    1.0173751, 0.36808193, 0.13755262,
    0.40385982, 0.40823343, 0.439281,
    1.0193379, 0.36741447, 0.13755262,
    0.40465394, 0.38998464, 0.48527098,
    1.3, 0.41157073, 0.13755262,
    -0.03258622, -0.035558067, -0.28468445,
    0.4502808, 0.40346378, 0.3450776,
    0.3591709, 0.2818296, 0.21514745,
    0.34873116, 0.14349703, 0.10217251,
    0.2444694, 0.09815589, 0.15335272,
    0, 0, 0,
    0.9753497, 0.19347532, 0.14731723,
    0.19201578, 0.21247928, 0.36797526,
    0.99175996, 0.36808193, 0.14731723,
    0.3746243, 0.38105646, 0.43936026,
    0.9969851, 0.36741447, 0.14731723,
    0.38192242, 0.37129804, 0.4707438,
    1.3, 0.41157073, 0.14731723,
    0.017817272, -0.0017465682, -0.2754316,
    0.44789332, 0.40157884, 0.34401023,
    0.3532587, 0.27246296, 0.20355953,
    0.34719202, 0.14045401, 0.103848755,
    0.2427156, 0.097606316, 0.15306233,
    0, 0, 0,
    0.9547032, 0.19347532, 0.15784518,
    0.18432662, 0.21766047, 0.37236145,
    0.9667015, 0.36808193, 0.15784518,
    0.36678684, 0.36642614, 0.43917352,
    0.97868305, 0.36741447, 0.15784518,
    0.37634954, 0.3625032, 0.46351245,
    1.3, 0.41157073, 0.15784518,
    0.032288596, 0.009490463, -0.27542815,
    0.44570005, 0.3999681, 0.3432672,
    0.3480381, 0.26368093, 0.19240415,
    0.3454166, 0.13757633, 0.105642624,
    0.24130356, 0.09715725, 0.15278986,
    0, 0, 0,
    0.92111367, 0.19347532, 0.16639271,
    0.17516156, 0.2203351, 0.37558466,
    0.9938561, 0.36808193, 0.16639271,
    0.38503686, 0.3654131, 0.44172695,
    0.959344, 0.36741447, 0.16639271,
    0.39104035, 0.3653423, 0.4646718,
    1.3, 0.41157073, 0.16639271,
    -0.0006068212, -0.0030202996, -0.28708032,
    0.44381198, 0.3987278, 0.3429255,
    0.34351975, 0.25549218, 0.18170834,
    0.3434265, 0.13487948, 0.10757558,
    0.24027112, 0.09682584, 0.15257256,
    0, 0, 0,
    0.6451038, 0.19347532, 0.1694278,
    0.17094046, 0.22088435, 0.37681022,
    1.0587096, 0.36808193, 0.1694278,
    0.39932287, 0.36691335, 0.44207728,
    0.99786997, 0.36741447, 0.1694278,
    0.40587717, 0.36820114, 0.46273017,
    1.3, 0.41157073, 0.1694278,
    -0.031438876, -0.0123275975, -0.28858173,
    0.4423269, 0.3979384, 0.34304523,
    0.33977577, 0.24795936, 0.17154956,
    0.3412344, 0.13237171, 0.10966301,
    0.2396331, 0.09661905, 0.15242663,
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
    constructor(...terms) {
        const options = terms.at(-1)?.isMaterial ? {} : terms.pop() ?? {};
        const { mask = null, vertexMask = false, shares, ...parameters } = options;
        if (terms.length < 2 || terms.length > 3 || !terms.every((material) => material.reflectance && !material.texel))
            throw new Error('BlendMaterial: expected two or three materials of such modules');
        if (terms.some((a) => terms.some((b) => a.reflectance === b.reflectance && a.functions !== b.functions)))
            throw new Error('BlendMaterial: expected materials of different names, as modules define functions by them');
        super('blend', parameters, { terms });
        this.mask = mask;
        this.vertexMask = vertexMask;
        this.shares = shares ?? terms.map(() => 1 / terms.length);
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
        const weights = this.mask ? 'texture2D(measured_mask, measured_uv).rg' : 'measured_vertex_mask';
        return this.mask || this.vertexMask ? `
            vec2 mask = clamp(${weights}, 0.0, 1.0);
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
