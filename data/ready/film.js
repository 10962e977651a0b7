// For three.js, release 187, and its WebGLRenderer.
import { Color, DataTexture, FloatType, MaterialLoader, Matrix3, MeshStandardMaterial, RGBAFormat, REVISION } from 'three';

if (parseInt(REVISION) !== 187)
    console.warn(`three.js ${REVISION}: this material was written for release 187, and may ignore environments in others`);

const functions = /* glsl */ `
#define film_radiance measured_radiance
#define film_reflected measured_reflected
#define film_lobe_roughness(k) ((k) == 1 ? 0.20948279 : (k) == 2 ? 0.36724916 : (k) == 3 ? 0.3917187 : (k) == 4 ? 0.35612872 : 1.0)
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
    film_AxialPsi psi_0 = film_axial_psi(wl, wv, 1.4121094, 1.4189453);
    of_pair.x[0] = vec3(film_squared_distance_from_pole(psi_0, 1.0), film_squared_distance_from_pole(psi_0, -1.0), 0.0);
    film_AxialPsi psi_1 = film_axial_psi(wl, wv, 1.5332031, -1.1298828);
    of_pair.x[1] = vec3(film_squared_distance_from_pole(psi_1, 1.0), film_squared_distance_from_pole(psi_1, -1.0), 0.0);
    film_AxialPsi psi_2 = film_axial_psi(wl, wv, 1.1191406, 0.06500244);
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
//   albedo_error 0.1378
//   delta_e_itp 5.537
//   flip 0.07505
//   generator srbf 0.1.0
//   heldout_squared_error_ratio 0.1714
//   heldout_squared_error_ratio_cosine 0.04742
//   max_theta 89
//   objective appearance
//   psnr 33.06
//   rms 0.09987
//   seed 0
//   source cc_ibiza_sunset_rgb.bsdf
//   squared_error_ratio 0.08808

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
const float film_lobes[99] = float[99](
    0.88427734, 1.0205078, 0.9116211, 124.0625, 105.125, -6.9648438, -57.8125, 0.0, 52.3125, 55.625, -0.9609375,
    0.99316406, 0.15844727, 0.0, -22.859375, 15.234375, 0.55859375, 1.8173828, 0.23791504, -5.1953125, 0.53222656, -29.28125,
    1.0058594, 0.0034332275, 0.25195312, 49.25, -23.03125, -2.578125, 51.21875, 1.4638672, -48.1875, 30.5625, 6.3046875,
    1.0009766, 0.35302734, 0.0, -5.453125, 11.9375, -0.40698242, -0.20080566, 0.0, -4.7421875, 0.7807617, -5.046875,
    1.0087891, 0.47485352, 0.85546875, 168.625, 101.3125, -0.47827148, -83.5625, 0.0, 77.4375, 93.6875, 8.125,
    0.9824219, 0.8808594, 0.66552734, 81.3125, 61.40625, 7.1875, -53.40625, 0.14477539, 21.234375, 13.5078125, -27.65625,
    1.0009766, 0.45043945, 0.58740234, -4.515625, 18.5625, 0.7836914, 3.9199219, 5.3710938, -17.765625, -1.2929688, -5.7773438,
    0.99365234, 0.5185547, 0.04257202, 27.828125, -13.0546875, -3.4453125, 42.8125, 0.70703125, -47.0625, 23.75, 2.5058594,
    0.9301758, 0.9926758, 0.96435547, 57.625, 68.25, 1.6035156, -33.28125, 0.0, 18.796875, 20.203125, -13.6796875
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
    float exponent_0 = 178.98436 + 75.470985 * features.x[1] + 80.24991 * features.x[2] + -1.3863398 * features.x[3];
    float power_0 = 0.5 * (film_pm_lobe(0, exponent_0, of_pair) + film_pm_lobe(0, exponent_0, exchanged));
    sum = sum + power_0 * vec3(0.88427734, 1.0205078, 0.9116211);
    float exponent_1 = -32.979107 + 0.34323886 * features.x[0] + -7.4952517 * features.x[1] + 0.7678406 *
            features.x[2] + -42.243916 * features.x[3];
    float power_1 = 0.5 * (film_pm_lobe(1, exponent_1, of_pair) + film_pm_lobe(1, exponent_1, exchanged));
    sum = sum + power_1 * vec3(0.99316406, 0.15844727, 0.0);
    float exponent_2 = 71.052734 + 2.111914 * features.x[0] + -69.51987 * features.x[1] + 44.09237 * features.x[2] +
            9.095741 * features.x[3];
    float power_2 = 0.5 * (film_pm_lobe(2, exponent_2, of_pair) + film_pm_lobe(2, exponent_2, exchanged));
    sum = sum + power_2 * vec3(1.0058594, 0.0034332275, 0.25195312);
    float exponent_3 = -7.8671966 + -6.8415303 * features.x[1] + 1.1264011 * features.x[2] + -7.2811017 * features.x[3];
    float power_3 = 0.5 * (film_pm_lobe(3, exponent_3, of_pair) + film_pm_lobe(3, exponent_3, exchanged));
    sum = sum + power_3 * vec3(1.0009766, 0.35302734, 0.0);
    float exponent_4 = 243.27444 + 111.7187 * features.x[1] + 135.16249 * features.x[2] + 11.721897 * features.x[3];
    float power_4 = 0.5 * (film_pm_lobe(4, exponent_4, of_pair) + film_pm_lobe(4, exponent_4, exchanged));
    sum = sum + power_4 * vec3(1.0087891, 0.47485352, 0.85546875);
    float exponent_5 = 117.30914 + 0.20886673 * features.x[0] + 30.634727 * features.x[1] + 19.487654 * features.x[2] +
            -39.899536 * features.x[3];
    float power_5 = 0.5 * (film_pm_lobe(5, exponent_5, of_pair) + film_pm_lobe(5, exponent_5, exchanged));
    sum = sum + power_5 * vec3(0.9824219, 0.8808594, 0.66552734);
    float exponent_6 = -6.51467 + 7.7488503 * features.x[0] + -25.630379 * features.x[1] + -1.8653597 * features.x[2] +
            -8.334946 * features.x[3];
    float power_6 = 0.5 * (film_pm_lobe(6, exponent_6, of_pair) + film_pm_lobe(6, exponent_6, exchanged));
    sum = sum + power_6 * vec3(1.0009766, 0.45043945, 0.58740234);
    float exponent_7 = 40.1475 + 1.0200305 * features.x[0] + -67.896835 * features.x[1] + 34.264008 * features.x[2] +
            3.615191 * features.x[3];
    float power_7 = 0.5 * (film_pm_lobe(7, exponent_7, of_pair) + film_pm_lobe(7, exponent_7, exchanged));
    sum = sum + power_7 * vec3(0.99365234, 0.5185547, 0.04257202);
    float exponent_8 = 83.1353 + 27.118158 * features.x[1] + 29.146948 * features.x[2] + -19.735617 * features.x[3];
    float power_8 = 0.5 * (film_pm_lobe(8, exponent_8, of_pair) + film_pm_lobe(8, exponent_8, exchanged));
    sum = sum + power_8 * vec3(0.9301758, 0.9926758, 0.96435547);
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
    0.9777426, 0.20948279, 0.008585204,
    0.96790683, 1.0485009, 1.1136633,
    0.54687107, 0.36724916, 0.008585204,
    0.047951132, 0.030411525, 0.016562488,
    0.86978006, 0.3917187, 0.008585204,
    0.48421502, 0.43274122, 0.38123253,
    0.96331733, 0.35612872, 0.008585204,
    -0.50304675, -0.50901693, -0.50658685,
    0.29545495, 0.27229992, 0.23382708,
    0.42947143, 0.38859642, 0.34096226,
    0.33657968, 0.24203925, 0.1571263,
    0.33840758, 0.13017374, 0.114221446,
    0.23581372, 0.0979586, 0.15496238,
    0.97801876, 0.20948279, 0.008585204,
    0.96790385, 1.0484973, 1.1136589,
    0.5492209, 0.36724916, 0.008585204,
    0.04795124, 0.030413728, 0.016565217,
    0.87042487, 0.3917187, 0.008585204,
    0.4842133, 0.43273926, 0.38122982,
    0.96330976, 0.35612872, 0.008585204,
    -0.50304955, -0.5090203, -0.50659096,
    0.29545495, 0.27229992, 0.23382708,
    0.42898095, 0.3878846, 0.34276435,
    0.3348169, 0.23581977, 0.14852482,
    0.33569774, 0.12796412, 0.11637968,
    0, 0, 0,
    0.97744703, 0.20948279, 0.009084012,
    0.96789885, 1.0484909, 1.1136508,
    0.5529685, 0.36724916, 0.009084012,
    0.047951262, 0.030417865, 0.01657037,
    0.86695915, 0.3917187, 0.009084012,
    0.48421046, 0.43273595, 0.3812249,
    0.96363515, 0.35612872, 0.009084012,
    -0.5030539, -0.50902593, -0.50659823,
    0.29545453, 0.27229962, 0.23382719,
    0.42956242, 0.38813347, 0.34531823,
    0.33368793, 0.23014201, 0.14061072,
    0.33278477, 0.12593226, 0.11853398,
    0, 0, 0,
    0.9774735, 0.20948279, 0.009894682,
    0.9678915, 1.0484824, 1.1136409,
    0.5634595, 0.36724916, 0.009894682,
    0.047950614, 0.030422483, 0.016576173,
    0.8646331, 0.3917187, 0.009894682,
    0.4842059, 0.43273127, 0.3812185,
    0.96468806, 0.35612872, 0.009894682,
    -0.5030616, -0.5090346, -0.5066083,
    0.31511274, 0.28981778, 0.24704352,
    0.43114957, 0.38929567, 0.34852195,
    0.33320498, 0.22502555, 0.13342439,
    0.32968807, 0.12407012, 0.12067503,
    0, 0, 0,
    0.97820175, 0.20948279, 0.010096402,
    0.96787083, 1.0484622, 1.1136191,
    0.5700336, 0.36724916, 0.010096402,
    0.047946803, 0.030433755, 0.016590318,
    0.86403275, 0.3917187, 0.010096402,
    0.48419204, 0.4327191, 0.38120243,
    0.96549374, 0.35612872, 0.010096402,
    -0.503091, -0.5090632, -0.5066378,
    0.33260888, 0.30539393, 0.25879163,
    0.43359706, 0.39124978, 0.35220814,
    0.33325288, 0.22038035, 0.12691773,
    0.32642356, 0.12236118, 0.122791424,
    0, 0, 0,
    0.97933996, 0.20948279, 0.009594164,
    0.96765834, 1.0483041, 1.113491,
    0.57397604, 0.36724916, 0.009594164,
    0.047899317, 0.030572407, 0.016756963,
    0.86933124, 0.3917187, 0.009594164,
    0.48404646, 0.43260747, 0.3810447,
    0.9674526, 0.35612872, 0.009594164,
    -0.50358623, -0.5095071, -0.5070413,
    0.3483284, 0.31937546, 0.26933542,
    0.436699, 0.39381614, 0.35615987,
    0.33379832, 0.21618293, 0.12109501,
    0.32300007, 0.120781, 0.1248693,
    0, 0, 0,
    0.98235077, 0.20948279, 0.008643894,
    0.9678003, 1.0488509, 1.1144314,
    0.5726096, 0.36724916, 0.008643894,
    0.047953237, 0.031299084, 0.01745584,
    0.8809322, 0.3917187, 0.008643894,
    0.48415095, 0.43270326, 0.38070816,
    0.9698925, 0.35612872, 0.008643894,
    -0.5072767, -0.51278687, -0.5097493,
    0.36273217, 0.33217517, 0.27898815,
    0.44019786, 0.3967614, 0.36011794,
    0.334713, 0.21232718, 0.11589624,
    0.31943265, 0.119305186, 0.12689857,
    0, 0, 0,
    0.98513556, 0.20948279, 0.0076584704,
    0.9758365, 1.0582436, 1.1253908,
    0.5525716, 0.36724916, 0.0076584704,
    0.046767376, 0.030426199, 0.016111676,
    0.90158314, 0.3917187, 0.0076584704,
    0.48875314, 0.43594572, 0.3809829,
    0.9732963, 0.35612872, 0.0076584704,
    -0.52242476, -0.52625555, -0.5205563,
    0.3760802, 0.34402627, 0.28792828,
    0.4438007, 0.39981267, 0.36379564,
    0.33598006, 0.20880127, 0.11133262,
    0.31575257, 0.11791324, 0.12887853,
    0, 0, 0,
    0.9887649, 0.20948279, 0.0074580126,
    1.0089986, 1.0939846, 1.1641543,
    0.5245561, 0.36724916, 0.0074580126,
    0.035825327, 0.020489937, 0.007821152,
    0.91740716, 0.3917187, 0.0074580126,
    0.50729483, 0.4481814, 0.38263735,
    0.9756754, 0.35612872, 0.0074580126,
    -0.5661576, -0.5660889, -0.5539521,
    0.38851935, 0.35506052, 0.2962581,
    0.44720322, 0.40268034, 0.3669001,
    0.3374593, 0.20548974, 0.10733344,
    0.31197348, 0.11657759, 0.13080223,
    0, 0, 0,
    0.9912813, 0.20948279, 0.008227875,
    1.066192, 1.1550257, 1.2296056,
    0.528984, 0.36724916, 0.008227875,
    0.027598387, 0.013056348, 0.0021558804,
    0.93412995, 0.3917187, 0.008227875,
    0.5281327, 0.45505938, 0.36971292,
    0.9789434, 0.35612872, 0.008227875,
    -0.6368828, -0.62710595, -0.60119504,
    0.4001284, 0.36534914, 0.30403462,
    0.45010975, 0.4050733, 0.36914903,
    0.33910513, 0.20235457, 0.10388461,
    0.30813172, 0.11528388, 0.13267705,
    0, 0, 0,
    0.9900955, 0.20948279, 0.009989156,
    1.1114073, 1.204842, 1.2829024,
    0.52845407, 0.36724916, 0.009989156,
    0.018510636, 0.0062191356, -0.001725385,
    0.9371381, 0.3917187, 0.009989156,
    0.5386958, 0.44351748, 0.33259815,
    0.9763103, 0.35612872, 0.009989156,
    -0.68404526, -0.65833795, -0.6129407,
    0.4109367, 0.37491882, 0.3112817,
    0.45225382, 0.40671968, 0.3702901,
    0.34084532, 0.1993356, 0.10095293,
    0.30425674, 0.114019, 0.13450998,
    0, 0, 0,
    0.99346524, 0.20948279, 0.012884042,
    1.1082594, 1.2104198, 1.2953953,
    0.543316, 0.36724916, 0.012884042,
    0.015276211, 0.0038206938, -0.002727692,
    0.93828803, 0.3917187, 0.012884042,
    0.517405, 0.39845422, 0.26445696,
    0.98062426, 0.35612872, 0.012884042,
    -0.6566519, -0.61643773, -0.5561902,
    0.4209409, 0.3837674, 0.31800237,
    0.45341206, 0.4073812, 0.37011278,
    0.34262964, 0.1963925, 0.09851507,
    0.30039304, 0.1127822, 0.13631883,
    0, 0, 0,
    0.99699855, 0.20948279, 0.017163604,
    1.0460923, 1.1627958, 1.2617884,
    0.52086204, 0.36724916, 0.017163604,
    0.008821651, 0.0013896025, -0.002065458,
    0.9245602, 0.3917187, 0.017163604,
    0.42783937, 0.29153085, 0.14564157,
    0.98809284, 0.35612872, 0.017163604,
    -0.49878976, -0.4591983, -0.4041178,
    0.43010998, 0.39186776, 0.3241811,
    0.45341653, 0.40686765, 0.36846045,
    0.34438172, 0.19346361, 0.096528925,
    0.29656106, 0.11157277, 0.13811138,
    0, 0, 0,
    0.9989447, 0.20948279, 0.023050401,
    0.9735104, 1.1106647, 1.234971,
    0.5025631, 0.36724916, 0.023050401,
    0.008851246, 0.002177698, -0.00012841292,
    0.91088355, 0.3917187, 0.023050401,
    0.37570915, 0.23364133, 0.08285865,
    0.9940223, 0.35612872, 0.023050401,
    -0.37581185, -0.35099885, -0.316889,
    0.43839607, 0.39917824, 0.3297923,
    0.45216465, 0.40504768, 0.36523893,
    0.3460705, 0.19052678, 0.09497636,
    0.29280624, 0.11040515, 0.13990994,
    0, 0, 0,
    1.0043396, 0.20948279, 0.031050304,
    0.88277054, 1.0308806, 1.1723955,
    0.24134302, 0.36724916, 0.031050304,
    0.004292747, 0.0013065253, 0.001016771,
    0.89670867, 0.3917187, 0.031050304,
    0.39012665, 0.23041952, 0.061969623,
    1.0047399, 0.35612872, 0.031050304,
    -0.29457012, -0.26698467, -0.2338852,
    0.44573605, 0.40564293, 0.3348,
    0.4496157, 0.4018487, 0.3604131,
    0.34764236, 0.18754002, 0.09382103,
    0.28912985, 0.109286, 0.14171219,
    0, 0, 0,
    1.008316, 0.20948279, 0.041713785,
    0.7893307, 0.94609493, 1.1211019,
    0.3010941, 0.36724916, 0.041713785,
    0.0033614687, 0.0011385418, 0.0031696083,
    0.8901584, 0.3917187, 0.041713785,
    0.41416267, 0.2505976, 0.059586015,
    1.0163571, 0.35612872, 0.041713785,
    -0.22538488, -0.20303537, -0.18202582,
    0.45206293, 0.41120258, 0.33916676,
    0.44579342, 0.3972612, 0.35400966,
    0.3490698, 0.18449187, 0.093042456,
    0.28554985, 0.10823305, 0.14352337,
    0, 0, 0,
    1.0108289, 0.20948279, 0.055264577,
    0.7062867, 0.8556269, 1.0370067,
    0.52002907, 0.36724916, 0.055264577,
    0.003225782, 0.0015543472, 0.016371546,
    0.8787205, 0.3917187, 0.055264577,
    0.3926043, 0.24243349, 0.03524511,
    1.039288, 0.35612872, 0.055264577,
    -0.12261391, -0.10652464, -0.08672667,
    0.45730916, 0.4157974, 0.34285548,
    0.44077793, 0.39133263, 0.34610897,
    0.35031322, 0.18135563, 0.09260576,
    0.28205392, 0.10725463, 0.14532712,
    0, 0, 0,
    1.0100422, 0.20948279, 0.07084691,
    0.65399414, 0.7868614, 0.9560731,
    0.5855571, 0.36724916, 0.07084691,
    0.004651057, 0.0037721603, 0.03709762,
    0.8656931, 0.3917187, 0.07084691,
    0.35861832, 0.22837734, 0.023518855,
    1.0857594, 0.35612872, 0.07084691,
    -0.038086273, -0.027301477, -0.015452538,
    0.46138155, 0.41934785, 0.34581614,
    0.4346976, 0.38416174, 0.33683825,
    0.35136336, 0.17813857, 0.09249491,
    0.27861327, 0.106353156, 0.14709343,
    0, 0, 0,
    1.0078938, 0.20948279, 0.086191915,
    0.39856246, 0.5683918, 0.7661395,
    0.9387014, 0.36724916, 0.086191915,
    0.60676813, 0.42774948, 0.24672477,
    1.1168321, 0.3917187, 0.086191915,
    -0.261, -0.22322673, -0.14164314,
    1.1146814, 0.35612872, 0.086191915,
    0.23054506, 0.2148698, 0.12602533,
    0.46433783, 0.42189902, 0.34809113,
    0.42771855, 0.37588894, 0.32636178,
    0.35220045, 0.17483728, 0.09268208,
    0.27520093, 0.105527155, 0.1487887,
    0, 0, 0,
    1.0031186, 0.20948279, 0.099625126,
    0.27765083, 0.44246012, 0.6504646,
    0.94970465, 0.36724916, 0.099625126,
    0.69023395, 0.5049383, 0.36970422,
    1.1348892, 0.3917187, 0.099625126,
    -0.41083688, -0.3550306, -0.18965732,
    1.1272603, 0.35612872, 0.099625126,
    0.42037374, 0.39566532, 0.1681462,
    0.46606335, 0.42334998, 0.34961334,
    0.42003456, 0.3666873, 0.31487128,
    0.35279322, 0.17144714, 0.09313403,
    0.27177557, 0.10476492, 0.15036659,
    0, 0, 0,
    0.99907273, 0.20948279, 0.10981467,
    0.22173077, 0.3579919, 0.57659644,
    0.956474, 0.36724916, 0.10981467,
    0.68927884, 0.5171438, 0.46374172,
    1.1540859, 0.3917187, 0.10981467,
    -0.43628293, -0.386109, -0.21182536,
    1.1376867, 0.35612872, 0.10981467,
    0.5029151, 0.49702337, 0.1708612,
    0.4665968, 0.42373568, 0.3504223,
    0.41185495, 0.3567508, 0.30257523,
    0.353158, 0.16800159, 0.09384177,
    0.26830435, 0.10405142, 0.15178223,
    0, 0, 0,
    0.99377847, 0.20948279, 0.11702869,
    0.19193584, 0.28782073, 0.514207,
    0.9554898, 0.36724916, 0.11702869,
    0.6007007, 0.45006287, 0.52627856,
    1.1529374, 0.3917187, 0.11702869,
    -0.40058446, -0.33491164, -0.24141197,
    1.1156319, 0.35612872, 0.11702869,
    0.58546746, 0.58081645, 0.20176634,
    0.46597654, 0.4230886, 0.35055438,
    0.40339252, 0.34628183, 0.2896867,
    0.3532812, 0.16451074, 0.094776675,
    0.26478782, 0.10337822, 0.1530111,
    0, 0, 0,
    0.9899726, 0.20948279, 0.12131039,
    0.17038906, 0.2287936, 0.45532897,
    0.9633834, 0.36724916, 0.12131039,
    0.53544724, 0.41963002, 0.57999325,
    1.1622125, 0.3917187, 0.12131039,
    -0.34248933, -0.25889826, -0.28671262,
    1.1000326, 0.35612872, 0.12131039,
    0.6145689, 0.5925901, 0.25386328,
    0.46429065, 0.4214857, 0.35008073,
    0.39485645, 0.33548445, 0.27641788,
    0.35314423, 0.16098957, 0.09591055,
    0.26122698, 0.102730915, 0.154026,
    0, 0, 0,
    0.9856861, 0.20948279, 0.124156676,
    0.1693192, 0.19038942, 0.41318247,
    0.9808738, 0.36724916, 0.124156676,
    0.4891301, 0.4375892, 0.6233352,
    1.1679603, 0.3917187, 0.124156676,
    -0.2847321, -0.1980493, -0.3478371,
    1.0817888, 0.35612872, 0.124156676,
    0.6040613, 0.55069935, 0.3151877,
    0.46166277, 0.4190335, 0.3490938,
    0.3864406, 0.3245517, 0.26296803,
    0.35276285, 0.15747209, 0.09722926,
    0.25763872, 0.10209634, 0.15480876,
    0, 0, 0,
    0.9865724, 0.20948279, 0.12722796,
    0.1735191, 0.15993667, 0.3684148,
    0.98555076, 0.36724916, 0.12722796,
    0.4101221, 0.45623377, 0.59976816,
    1.1998726, 0.3917187, 0.12722796,
    -0.17978047, -0.13610499, -0.33149323,
    1.0619216, 0.35612872, 0.12722796,
    0.573466, 0.49847808, 0.36900562,
    0.45820224, 0.41582686, 0.34767526,
    0.37832007, 0.31366193, 0.249521,
    0.35212797, 0.15398426, 0.09870998,
    0.2540854, 0.1014763, 0.15537198,
    0, 0, 0,
    0.9848296, 0.20948279, 0.12618606,
    0.18200828, 0.15521687, 0.3373384,
    0.9764779, 0.36724916, 0.12618606,
    0.37357354, 0.47502178, 0.55686253,
    1.2482728, 0.3917187, 0.12618606,
    -0.11257283, -0.11206494, -0.28814662,
    1.0612247, 0.35612872, 0.12618606,
    0.53387904, 0.45898312, 0.40306294,
    0.45417377, 0.41210648, 0.34602287,
    0.37064585, 0.30297363, 0.2362411,
    0.35124555, 0.15055346, 0.10033367,
    0.25061274, 0.10086414, 0.15571535,
    0, 0, 0,
    0.9814195, 0.20948279, 0.12483071,
    0.20334709, 0.17954744, 0.33618551,
    0.99942344, 0.36724916, 0.12483071,
    0.34848645, 0.45078686, 0.51001346,
    1.3, 0.3917187, 0.12483071,
    -0.04983766, -0.0847904, -0.25618276,
    1.0367936, 0.35612872, 0.12483071,
    0.47087446, 0.42606968, 0.41983694,
    0.4497915, 0.40805033, 0.3442786,
    0.36358258, 0.29264188, 0.22327542,
    0.35012144, 0.1472109, 0.102083266,
    0.24728772, 0.10026216, 0.15585542,
    0, 0, 0,
    0.97814405, 0.20948279, 0.12099413,
    0.23354138, 0.22200058, 0.3587816,
    1.0054163, 0.36724916, 0.12099413,
    0.3192438, 0.3949979, 0.46890187,
    1.3, 0.3917187, 0.12099413,
    0.010319087, -0.03484446, -0.24367858,
    1.0170279, 0.35612872, 0.12099413,
    0.40316826, 0.38191372, 0.4247677,
    0.44527417, 0.4038529, 0.34259588,
    0.357154, 0.2827397, 0.21073385,
    0.34874183, 0.14397277, 0.103933245,
    0.24418326, 0.09967642, 0.15581523,
    0, 0, 0,
    0.97518116, 0.20948279, 0.11698767,
    0.2606429, 0.2537457, 0.38854364,
    0.98769885, 0.36724916, 0.11698767,
    0.27576977, 0.33062726, 0.41334274,
    1.3, 0.3917187, 0.11698767,
    0.090279, 0.044183064, -0.19763397,
    0.98709136, 0.35612872, 0.11698767,
    0.33235097, 0.32875043, 0.40365362,
    0.44089523, 0.39975715, 0.3411626,
    0.35145235, 0.2733591, 0.1987153,
    0.34713653, 0.14087713, 0.10587847,
    0.24141572, 0.09913351, 0.15565363,
    0, 0, 0,
    0.9794628, 0.20948279, 0.11429942,
    0.2793836, 0.27143684, 0.41244993,
    0.9602233, 0.36724916, 0.11429942,
    0.24481055, 0.2858776, 0.36489457,
    1.3, 0.3917187, 0.11429942,
    0.14768142, 0.105467245, -0.14968233,
    0.9551769, 0.35612872, 0.11429942,
    0.2789271, 0.2890515, 0.3792818,
    0.4369104, 0.39598992, 0.34014904,
    0.34655446, 0.26458958, 0.18731067,
    0.34528688, 0.1379326, 0.10789194,
    0.2390844, 0.09865672, 0.15542156,
    0, 0, 0,
    1.0000614, 0.20948279, 0.1155632,
    0.28661093, 0.27991593, 0.42851308,
    1.0324874, 0.36724916, 0.1155632,
    0.24284568, 0.26467976, 0.33046913,
    1.3, 0.3917187, 0.1155632,
    0.15399377, 0.12985021, -0.11669175,
    0.8458273, 0.35612872, 0.1155632,
    0.2528353, 0.26744634, 0.36187172,
    0.43355283, 0.3927598, 0.33970454,
    0.34244016, 0.25643152, 0.17654769,
    0.34321004, 0.13515918, 0.10996277,
    0.23731425, 0.09828395, 0.15519425,
    0, 0, 0,
    1.1583179, 0.20948279, 0.11824717,
    0.28392062, 0.27959502, 0.43130004,
    1.0324984, 0.36724916, 0.11824717,
    0.24803104, 0.2587692, 0.3157655,
    1.3, 0.3917187, 0.11824717,
    0.1362844, 0.13571508, -0.09372803,
    0.6548053, 0.35612872, 0.11824717,
    0.2625826, 0.26544935, 0.35118312,
    0.431024, 0.39024955, 0.33995035,
    0.3391324, 0.24892461, 0.16648582,
    0.34092027, 0.13257393, 0.11208019,
    0.23619401, 0.09804123, 0.15502274,
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
