// For three.js, release 187, and its WebGLRenderer.
import { Color, DataTexture, FloatType, MaterialLoader, Matrix3, MeshStandardMaterial, RGBAFormat, REVISION } from 'three';

if (parseInt(REVISION) !== 187)
    console.warn(`three.js ${REVISION}: this material was written for release 187, and may ignore environments in others`);

const functions = /* glsl */ `
#define film_radiance measured_radiance
#define film_reflected measured_reflected
#define film_lobe_roughness(k) ((k) == 1 ? 0.316921 : (k) == 2 ? 0.20237103 : (k) == 3 ? 0.37275866 : (k) == 4 ? 0.49323845 : 1.0)
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

// g(wl, wv) = sum_j beta_j e^(s_j) prod_n G(psi_n . xi_jn | lambda_jn) prod_k e^(kappa_jk x_k(wl, wv)) [1/sr], for
// R, G, B. Here psi_n = normalize(a_n wl + b_n wv), and x_k are the further features, which are symmetric.
// rho(wl, wv) = g(wl, wv), or the mean of g(wl, wv) and g(wv, wl) in a reciprocal model. A negative sum counts as 0:
// the colour of a spectral model's lobe may have a negative channel.
vec3 film_pm_value(vec3 wl, vec3 wv) {
    float up[3];
    float down[3];
    float exchanged_up[3];
    float exchanged_down[3];
    float a_0 = 1.8681641;
    float b_0 = 1.6826172;
    film_AxialPsi psi_0 = film_axial_psi(wl, wv, a_0, b_0);
    up[0] = film_squared_distance_from_pole(psi_0, 1.0);
    down[0] = film_squared_distance_from_pole(psi_0, -1.0);
    film_AxialPsi exchanged_0 = film_axial_psi(wv, wl, a_0, b_0);
    exchanged_up[0] = film_squared_distance_from_pole(exchanged_0, 1.0);
    exchanged_down[0] = film_squared_distance_from_pole(exchanged_0, -1.0);
    float a_1 = 1.2998047;
    float b_1 = 0.12805176;
    film_AxialPsi psi_1 = film_axial_psi(wl, wv, a_1, b_1);
    up[1] = film_squared_distance_from_pole(psi_1, 1.0);
    down[1] = film_squared_distance_from_pole(psi_1, -1.0);
    film_AxialPsi exchanged_1 = film_axial_psi(wv, wl, a_1, b_1);
    exchanged_up[1] = film_squared_distance_from_pole(exchanged_1, 1.0);
    exchanged_down[1] = film_squared_distance_from_pole(exchanged_1, -1.0);
    float a_2 = 1.4443359;
    float b_2 = 0.46826172;
    film_AxialPsi psi_2 = film_axial_psi(wl, wv, a_2, b_2);
    up[2] = film_squared_distance_from_pole(psi_2, 1.0);
    down[2] = film_squared_distance_from_pole(psi_2, -1.0);
    film_AxialPsi exchanged_2 = film_axial_psi(wv, wl, a_2, b_2);
    exchanged_up[2] = film_squared_distance_from_pole(exchanged_2, 1.0);
    exchanged_down[2] = film_squared_distance_from_pole(exchanged_2, -1.0);
    film_PmFeatures features = film_pm_further_features(wl, wv);
    vec3 sum = vec3(0.0, 0.0, 0.0);
    float exponent_0 = 235.51996 + 28.560854 * features.x[0] + -155.81107 * features.x[1] + 61.1342 * features.x[2] +
            1.5399078 * features.x[3];
    float exchanged_exponent_0 = exponent_0;
    exponent_0 = exponent_0 - 2.6796935 * down[0];
    exchanged_exponent_0 = exchanged_exponent_0 - 2.6796935 * exchanged_down[0];
    exponent_0 = exponent_0 - 80.159744 * up[1];
    exchanged_exponent_0 = exchanged_exponent_0 - 80.159744 * exchanged_up[1];
    exponent_0 = exponent_0 - 56.445442 * down[2];
    exchanged_exponent_0 = exchanged_exponent_0 - 56.445442 * exchanged_down[2];
    float power_0 = 0.5 * (film_pm_power(exponent_0) + film_pm_power(exchanged_exponent_0));
    sum = sum + power_0 * vec3(0.95166016, 0.2854004, 0.40600586);
    float exponent_1 = 34.264008 + 2.44441 * features.x[0] + -18.788849 * features.x[1] + 0.83124036 * features.x[2] +
            5.1226945 * features.x[3];
    float exchanged_exponent_1 = exponent_1;
    exponent_1 = exponent_1 - 1.5948542 * up[0];
    exchanged_exponent_1 = exchanged_exponent_1 - 1.5948542 * exchanged_up[0];
    exponent_1 = exponent_1 - 8.763246 * up[1];
    exchanged_exponent_1 = exchanged_exponent_1 - 8.763246 * exchanged_up[1];
    exponent_1 = exponent_1 - 9.557855 * down[2];
    exchanged_exponent_1 = exchanged_exponent_1 - 9.557855 * exchanged_down[2];
    float power_1 = 0.5 * (film_pm_power(exponent_1) + film_pm_power(exchanged_exponent_1));
    sum = sum + power_1 * vec3(1.0048828, 0.40429688, 0.0);
    float exponent_2 = 24.661068 + -71.638824 * features.x[1] + 43.979656 * features.x[2] + 0.8911178 * features.x[3];
    float exchanged_exponent_2 = exponent_2;
    exponent_2 = exponent_2 - 7.444532 * down[0];
    exchanged_exponent_2 = exchanged_exponent_2 - 7.444532 * exchanged_down[0];
    exponent_2 = exponent_2 - 32.122505 * up[1];
    exchanged_exponent_2 = exchanged_exponent_2 - 32.122505 * exchanged_up[1];
    exponent_2 = exponent_2 - 5.1001525 * up[2];
    exchanged_exponent_2 = exchanged_exponent_2 - 5.1001525 * exchanged_up[2];
    float power_2 = 0.5 * (film_pm_power(exponent_2) + film_pm_power(exchanged_exponent_2));
    sum = sum + power_2 * vec3(1.0, 0.4658203, 0.07220459);
    float exponent_3 = 287.63733 + 56.129852 * features.x[0] + -229.3885 * features.x[1] + 190.07507 * features.x[2] +
            4.4943333 * features.x[3];
    float exchanged_exponent_3 = exponent_3;
    exponent_3 = exponent_3 - 70.91748 * down[0];
    exchanged_exponent_3 = exchanged_exponent_3 - 70.91748 * exchanged_down[0];
    exponent_3 = exponent_3 - 82.098366 * up[1];
    exchanged_exponent_3 = exchanged_exponent_3 - 82.098366 * exchanged_up[1];
    exponent_3 = exponent_3 - 0.9869218 * down[2];
    exchanged_exponent_3 = exchanged_exponent_3 - 0.9869218 * exchanged_down[2];
    float power_3 = 0.5 * (film_pm_power(exponent_3) + film_pm_power(exchanged_exponent_3));
    sum = sum + power_3 * vec3(1.0449219, 0.51953125, 0.90625);
    float exponent_4 = 54.732243 + -88.996254 * features.x[1] + 65.59754 * features.x[2] + 6.920428 * features.x[3];
    float exchanged_exponent_4 = exponent_4;
    exponent_4 = exponent_4 - 2.838897 * up[0];
    exchanged_exponent_4 = exchanged_exponent_4 - 2.838897 * exchanged_up[0];
    exponent_4 = exponent_4 - 50.40416 * up[1];
    exchanged_exponent_4 = exchanged_exponent_4 - 50.40416 * exchanged_up[1];
    exponent_4 = exponent_4 - 15.486429 * down[2];
    exchanged_exponent_4 = exchanged_exponent_4 - 15.486429 * exchanged_down[2];
    float power_4 = 0.5 * (film_pm_power(exponent_4) + film_pm_power(exchanged_exponent_4));
    sum = sum + power_4 * vec3(0.91748047, 0.99658203, 0.90966797);
    float exponent_5 = 432.8085 + 0.020703958 * features.x[0] + 41.004097 * features.x[1] + 61.7203 * features.x[2] +
            -30.76998 * features.x[3];
    float exchanged_exponent_5 = exponent_5;
    exponent_5 = exponent_5 - 41.049183 * up[0];
    exchanged_exponent_5 = exchanged_exponent_5 - 41.049183 * exchanged_up[0];
    exponent_5 = exponent_5 - 132.63777 * down[1];
    exchanged_exponent_5 = exchanged_exponent_5 - 132.63777 * exchanged_down[1];
    exponent_5 = exponent_5 - 59.150497 * up[2];
    exchanged_exponent_5 = exchanged_exponent_5 - 59.150497 * exchanged_up[2];
    float power_5 = 0.5 * (film_pm_power(exponent_5) + film_pm_power(exchanged_exponent_5));
    sum = sum + power_5 * vec3(0.89453125, 0.8984375, 0.9008789);
    float exponent_6 = 8.019356 + 0.6586523 * features.x[0] + -2.1555893 * features.x[1] + 1.2391115 * features.x[2] +
            -26.148848 * features.x[3];
    float exchanged_exponent_6 = exponent_6;
    exponent_6 = exponent_6 - 9.2366295 * up[0];
    exchanged_exponent_6 = exchanged_exponent_6 - 9.2366295 * exchanged_up[0];
    exponent_6 = exponent_6 - 7.816477 * down[1];
    exchanged_exponent_6 = exchanged_exponent_6 - 7.816477 * exchanged_down[1];
    exponent_6 = exponent_6 - 6.4357724 * up[2];
    exchanged_exponent_6 = exchanged_exponent_6 - 6.4357724 * exchanged_up[2];
    float power_6 = 0.5 * (film_pm_power(exponent_6) + film_pm_power(exchanged_exponent_6));
    sum = sum + power_6 * vec3(1.0, 0.18286133, 0.0);
    float exponent_7 = 168.52481 + 0.29392797 * features.x[0] + 2.800857 * features.x[1] + 14.415679 * features.x[2] +
            -15.193382 * features.x[3];
    float exchanged_exponent_7 = exponent_7;
    exponent_7 = exponent_7 - 12.488329 * up[0];
    exchanged_exponent_7 = exchanged_exponent_7 - 12.488329 * exchanged_up[0];
    exponent_7 = exponent_7 - 52.658367 * down[1];
    exchanged_exponent_7 = exchanged_exponent_7 - 52.658367 * exchanged_down[1];
    exponent_7 = exponent_7 - 32.235218 * up[2];
    exchanged_exponent_7 = exchanged_exponent_7 - 32.235218 * exchanged_up[2];
    float power_7 = 0.5 * (film_pm_power(exponent_7) + film_pm_power(exchanged_exponent_7));
    sum = sum + power_7 * vec3(0.97558594, 0.49926758, 0.066589355);
    float exponent_8 = 90.75453 + 0.7607962 * features.x[0] + -27.321037 * features.x[1] + 11.282326 * features.x[2] +
            4.1223884 * features.x[3];
    float exchanged_exponent_8 = exponent_8;
    exponent_8 = exponent_8 - 7.264195 * up[0];
    exchanged_exponent_8 = exchanged_exponent_8 - 7.264195 * exchanged_up[0];
    exponent_8 = exponent_8 - 28.8539 * up[1];
    exchanged_exponent_8 = exchanged_exponent_8 - 28.8539 * exchanged_up[1];
    exponent_8 = exponent_8 - 23.511421 * down[2];
    exchanged_exponent_8 = exchanged_exponent_8 - 23.511421 * exchanged_down[2];
    float power_8 = 0.5 * (film_pm_power(exponent_8) + film_pm_power(exchanged_exponent_8));
    sum = sum + power_8 * vec3(0.0, 0.027664185, 0.9892578);
    return vec3(max(sum.x, 0.0), max(sum.y, 0.0), max(sum.z, 0.0));
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
//   albedo_error 0.1388
//   delta_e_itp 5.676
//   flip 0.07836
//   generator srbf 0.1.0
//   heldout_squared_error_ratio 0.3448
//   heldout_squared_error_ratio_cosine 0.06906
//   max_theta 89
//   objective appearance
//   psnr 32.6
//   rms 0.108
//   seed 0
//   source cc_ibiza_sunset_rgb.bsdf
//   squared_error_ratio 0.06778

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
    0.908494, 0.316921, 0.028507546,
    1.1044592, 1.1422919, 1.2104686,
    0.98831743, 0.20237103, 0.028507546,
    0.41269058, 0.46374086, 0.4936448,
    0.9468176, 0.37275866, 0.028507546,
    -0.65578085, -0.667777, -0.6839306,
    0.6960641, 0.49323845, 0.028507546,
    0.1412693, 0.060969178, -0.0263845,
    0.35118127, 0.346869, 0.33257958,
    0.43280184, 0.3877354, 0.3426024,
    0.33939376, 0.23942176, 0.16202798,
    0.3416138, 0.13340917, 0.11493,
    0.24060984, 0.096823715, 0.15381725,
    0.90874594, 0.316921, 0.028507546,
    1.1044487, 1.1422837, 1.2104641,
    0.9885077, 0.20237103, 0.028507546,
    0.4126848, 0.46373898, 0.4936492,
    0.94716036, 0.37275866, 0.028507546,
    -0.65578395, -0.66777796, -0.6839277,
    0.6799635, 0.49323845, 0.028507546,
    0.14127022, 0.060970753, -0.026384661,
    0.35118127, 0.346869, 0.33257958,
    0.4326602, 0.38902512, 0.34437498,
    0.33740997, 0.23325688, 0.15384516,
    0.33844867, 0.13070226, 0.117088616,
    0, 0, 0,
    0.90862566, 0.316921, 0.029134747,
    1.1044232, 1.1422651, 1.2104566,
    0.9884682, 0.20237103, 0.029134747,
    0.41266868, 0.46373302, 0.49365962,
    0.9471327, 0.37275866, 0.029134747,
    -0.65579474, -0.667782, -0.6839205,
    0.66300184, 0.49323845, 0.029134747,
    0.14127088, 0.060973804, -0.026384952,
    0.35117695, 0.34686488, 0.33257544,
    0.4334096, 0.3912184, 0.3469425,
    0.3360009, 0.22759397, 0.14613824,
    0.33494824, 0.12810245, 0.119210675,
    0, 0, 0,
    0.9074001, 0.316921, 0.029464547,
    1.1043897, 1.1422411, 1.2104486,
    0.98840386, 0.20237103, 0.029464547,
    0.412651, 0.46372968, 0.4936792,
    0.9502717, 0.37275866, 0.029464547,
    -0.6558065, -0.667784, -0.6839061,
    0.63844806, 0.49323845, 0.029464547,
    0.14127152, 0.06097776, -0.02638614,
    0.36470833, 0.3568184, 0.33937228,
    0.43498993, 0.394207, 0.35017678,
    0.33524162, 0.22251572, 0.1390095,
    0.33117685, 0.12563367, 0.12131875,
    0, 0, 0,
    0.9068332, 0.316921, 0.028095728,
    1.104289, 1.1421679, 1.2104197,
    0.9853148, 0.20237103, 0.028095728,
    0.41261715, 0.46373755, 0.4937521,
    0.9486991, 0.37275866, 0.028095728,
    -0.6558276, -0.6677768, -0.6838532,
    0.61487436, 0.49323845, 0.028095728,
    0.14127398, 0.060987584, -0.026396533,
    0.37638137, 0.36503538, 0.34459016,
    0.43725723, 0.3977955, 0.35386783,
    0.3350065, 0.21791431, 0.13238725,
    0.32719928, 0.12331509, 0.12343387,
    0, 0, 0,
    0.9068182, 0.316921, 0.024576426,
    1.1028655, 1.1410848, 1.209896,
    0.98335373, 0.20237103, 0.024576426,
    0.4126049, 0.46426973, 0.49511665,
    0.9549786, 0.37275866, 0.024576426,
    -0.6557755, -0.66736555, -0.6828613,
    0.62831426, 0.49323845, 0.024576426,
    0.14137681, 0.061119486, -0.02668819,
    0.38672584, 0.37207702, 0.3488156,
    0.4400048, 0.40172413, 0.35774723,
    0.33529487, 0.21380463, 0.12632133,
    0.32306817, 0.12115649, 0.12556939,
    0, 0, 0,
    0.91908014, 0.316921, 0.019588644,
    1.0928539, 1.1319975, 1.2027017,
    0.98936653, 0.20237103, 0.019588644,
    0.41471735, 0.46872622, 0.50279504,
    0.9630454, 0.37275866, 0.019588644,
    -0.65556586, -0.6659044, -0.6793809,
    0.66685855, 0.49323845, 0.019588644,
    0.14281254, 0.061901316, -0.029169805,
    0.39613727, 0.3783074, 0.352383,
    0.44297242, 0.4056798, 0.36149892,
    0.3359265, 0.21002693, 0.12069478,
    0.31883433, 0.11916372, 0.12773143,
    0, 0, 0,
    0.9276652, 0.316921, 0.01474742,
    1.0558182, 1.0938337, 1.1663507,
    0.9890951, 0.20237103, 0.01474742,
    0.43737984, 0.49707532, 0.5363644,
    0.9694885, 0.37275866, 0.01474742,
    -0.6468603, -0.6548935, -0.6652562,
    0.7089956, 0.49323845, 0.01474742,
    0.14685322, 0.061482023, -0.039424036,
    0.4048284, 0.38392314, 0.35547227,
    0.44586253, 0.40931484, 0.3647771,
    0.3369294, 0.20662361, 0.11559124,
    0.31455463, 0.11734139, 0.1299241,
    0, 0, 0,
    0.9443371, 0.316921, 0.011533767,
    0.96619254, 0.992759, 1.062019,
    0.99095005, 0.20237103, 0.011533767,
    0.50697374, 0.57879734, 0.6222545,
    0.97550285, 0.37275866, 0.011533767,
    -0.64430666, -0.6430016, -0.64439803,
    0.77833056, 0.49323845, 0.011533767,
    0.15882212, 0.0658612, -0.044282842,
    0.41290647, 0.38902333, 0.35817313,
    0.448385, 0.4122947, 0.36725318,
    0.3381156, 0.20343538, 0.110910386,
    0.3102535, 0.115678556, 0.13213395,
    0, 0, 0,
    0.95221514, 0.316921, 0.010385402,
    0.8071363, 0.7960265, 0.8423572,
    0.99056154, 0.20237103, 0.010385402,
    0.654002, 0.74228257, 0.78699243,
    0.9771715, 0.37275866, 0.010385402,
    -0.648924, -0.6196065, -0.5916466,
    0.8613329, 0.49323845, 0.010385402,
    0.17118347, 0.07469825, -0.041204147,
    0.42042494, 0.39365947, 0.36053285,
    0.4502793, 0.41432247, 0.3686402,
    0.33944762, 0.20043902, 0.106677674,
    0.3059655, 0.11416728, 0.13434622,
    0, 0, 0,
    0.95401895, 0.316921, 0.010961884,
    0.5595328, 0.4846148, 0.47450808,
    0.9918441, 0.20237103, 0.010961884,
    0.8395674, 0.9537808, 1.0126354,
    0.98059535, 0.37275866, 0.010961884,
    -0.5978175, -0.54284674, -0.4846997,
    0.90127987, 0.49323845, 0.010961884,
    0.18401437, 0.10084023, -0.0032229847,
    0.4274005, 0.39785102, 0.36257043,
    0.4513403, 0.4151662, 0.36871815,
    0.34084862, 0.19757311, 0.10288401,
    0.30170754, 0.11279143, 0.136537,
    0, 0, 0,
    0.9032874, 0.316921, 0.013300051,
    0.22628139, 0.11397554, 0.05335009,
    0.9925836, 0.20237103, 0.013300051,
    1.0040323, 1.1439464, 1.2255183,
    0.9863276, 0.37275866, 0.013300051,
    -0.4266274, -0.39325318, -0.34138367,
    0.93040866, 0.49323845, 0.013300051,
    0.1835014, 0.13391769, 0.06480831,
    0.4338293, 0.4016002, 0.36429018,
    0.45142353, 0.41466638, 0.3673419,
    0.34227762, 0.19480489, 0.09954591,
    0.29750255, 0.11153719, 0.13868499,
    0, 0, 0,
    0.9318667, 0.316921, 0.017493298,
    0.21576174, 0.102949366, 0.02476299,
    0.9962527, 0.20237103, 0.017493298,
    0.9668296, 1.113041, 1.2108783,
    0.99110156, 0.37275866, 0.017493298,
    -0.355865, -0.31855914, -0.28052565,
    0.884784, 0.49323845, 0.017493298,
    0.16162948, 0.10221069, 0.047523346,
    0.43968967, 0.40489465, 0.36568445,
    0.45045784, 0.41274843, 0.36445206,
    0.34365374, 0.19206251, 0.09664118,
    0.29334757, 0.110381484, 0.1407549,
    0, 0, 0,
    0.9409647, 0.316921, 0.02353357,
    0.29206416, 0.16673315, 0.0427637,
    1, 0.20237103, 0.02353357,
    0.8631298, 1.0296445, 1.1715996,
    0.99513686, 0.37275866, 0.02353357,
    -0.29647985, -0.2665956, -0.24013679,
    0.81757873, 0.49323845, 0.02353357,
    0.12963465, 0.06886828, 0.02741837,
    0.4449493, 0.40771392, 0.36673945,
    0.44843116, 0.409408, 0.3600595,
    0.3449667, 0.18933332, 0.094195716,
    0.28926703, 0.10931266, 0.1427309,
    0, 0, 0,
    0.94749355, 0.316921, 0.031789463,
    0.4261349, 0.26867834, 0.07977861,
    1.0062996, 0.20237103, 0.031789463,
    0.7164971, 0.91116464, 1.1119307,
    1.0017034, 0.37275866, 0.031789463,
    -0.26453367, -0.23801523, -0.21200745,
    0.76247084, 0.49323845, 0.031789463,
    0.10890397, 0.055629384, 0.021538787,
    0.44956106, 0.4100244, 0.36742926,
    0.44537857, 0.40469843, 0.35423258,
    0.34617603, 0.18657398, 0.09220073,
    0.2852482, 0.108306065, 0.144577,
    0, 0, 0,
    0.9273707, 0.316921, 0.04109692,
    0.56369716, 0.36537257, 0.13423531,
    1.0144897, 0.20237103, 0.04109692,
    0.48818552, 0.7294857, 1.0088725,
    1.0122644, 0.37275866, 0.04109692,
    -0.0071307286, -0.055163167, -0.1261025,
    1.0265164, 0.49323845, 0.04109692,
    -0.0781142, -0.054203555, -0.020612428,
    0.4534833, 0.41179937, 0.36773548,
    0.44136727, 0.39871266, 0.3470775,
    0.34728527, 0.18378182, 0.09067727,
    0.2813105, 0.10735184, 0.14627872,
    0, 0, 0,
    0.52914214, 0.316921, 0.052995883,
    0.015059504, 0.008614634, 0.010507023,
    1.011882, 0.20237103, 0.052995883,
    0.49326903, 0.7002092, 0.9565565,
    0.9281686, 0.37275866, 0.052995883,
    0.57530916, 0.36576733, 0.08504183,
    1.0340807, 0.49323845, 0.052995883,
    -0.10910332, -0.085290596, -0.05376289,
    0.45667708, 0.41301602, 0.3676446,
    0.43648583, 0.39157078, 0.33872548,
    0.34827766, 0.18093176, 0.08961503,
    0.277459, 0.10643583, 0.14781632,
    0, 0, 0,
    0.29465097, 0.316921, 0.06659247,
    0.0066211117, 0.004297723, 0.0075891907,
    1.014007, 0.20237103, 0.06659247,
    0.3467248, 0.56054044, 0.85518986,
    0.9497196, 0.37275866, 0.06659247,
    0.7827956, 0.54750764, 0.21120341,
    1.0404967, 0.49323845, 0.06659247,
    -0.16075543, -0.123041146, -0.07399926,
    0.4590517, 0.4136017, 0.3670883,
    0.43083477, 0.38340777, 0.32932034,
    0.34917763, 0.17803955, 0.08902956,
    0.27369434, 0.10554427, 0.14916979,
    0, 0, 0,
    0.2899433, 0.316921, 0.081932746,
    0.006323131, 0.0043652817, 0.011855284,
    1.0113463, 0.20237103, 0.081932746,
    0.24685742, 0.44838244, 0.7503558,
    0.96903956, 0.37275866, 0.081932746,
    0.9157167, 0.68569356, 0.3355861,
    1.0605979, 0.49323845, 0.081932746,
    -0.19257444, -0.14963149, -0.09745425,
    0.4606471, 0.41360864, 0.36613372,
    0.42452604, 0.3743707, 0.31901503,
    0.34998706, 0.17510068, 0.08890589,
    0.27003017, 0.104670405, 0.15033224,
    0, 0, 0,
    0.29328716, 0.316921, 0.097630434,
    0.00509609, 0.0036682826, 0.017711356,
    1.0062938, 0.20237103, 0.097630434,
    0.18516968, 0.35752043, 0.657779,
    0.98784685, 0.37275866, 0.097630434,
    0.99106085, 0.79154044, 0.44516248,
    1.089807, 0.49323845, 0.097630434,
    -0.20465651, -0.16471784, -0.12046127,
    0.46147045, 0.4130599, 0.36480746,
    0.4176815, 0.36461496, 0.3079679,
    0.35069638, 0.172114, 0.089225106,
    0.26646832, 0.103804775, 0.15129268,
    0, 0, 0,
    0.58147883, 0.316921, 0.11185598,
    0.0015318398, -0.0014516562, 0.05143581,
    0.99762875, 0.20237103, 0.11185598,
    0.15942863, 0.28204888, 0.58461195,
    1.0015935, 0.37275866, 0.11185598,
    1.0110822, 0.8722087, 0.4919018,
    1.1170201, 0.49323845, 0.11185598,
    -0.1953347, -0.16616847, -0.12918133,
    0.46148944, 0.4119368, 0.36309415,
    0.41043273, 0.3543026, 0.29634124,
    0.35133287, 0.16910733, 0.08997483,
    0.2630172, 0.10294286, 0.1520482,
    0, 0, 0,
    0.93909585, 0.316921, 0.12262851,
    0.18901478, 0.13507022, 0.3838356,
    1.022914, 0.20237103, 0.12262851,
    0.08597332, 0.17410566, 0.35645974,
    1.0358877, 0.37275866, 0.12262851,
    0.89290506, 0.85041386, 0.42222705,
    1.1607468, 0.49323845, 0.12262851,
    -0.19261895, -0.17671706, -0.16865529,
    0.4607286, 0.4102748, 0.36102983,
    0.40292025, 0.34359998, 0.28429908,
    0.3518797, 0.16608271, 0.091115266,
    0.2597096, 0.102092974, 0.15261778,
    0, 0, 0,
    0.691775, 0.316921, 0.12996835,
    -0.052311245, -0.054795176, 0.10084388,
    0.99144775, 0.20237103, 0.12996835,
    0.1748422, 0.20612022, 0.4475416,
    0.9965174, 0.37275866, 0.12996835,
    1.003515, 0.9572744, 0.60429186,
    1.1437231, 0.49323845, 0.12996835,
    -0.14878824, -0.12512392, -0.1517352,
    0.45923424, 0.40812775, 0.35866532,
    0.39529055, 0.33267462, 0.2720046,
    0.35230377, 0.16304342, 0.09260102,
    0.25657192, 0.10126369, 0.15302156,
    0, 0, 0,
    0.635728, 0.316921, 0.13495892,
    -0.061283924, -0.06164351, 0.06767629,
    0.9902958, 0.20237103, 0.13495892,
    0.18410636, 0.18963693, 0.4029773,
    0.99091816, 0.37275866, 0.13495892,
    0.98397714, 0.9523341, 0.7049604,
    1.1545345, 0.49323845, 0.13495892,
    -0.12888135, -0.098075956, -0.17375937,
    0.4570925, 0.40558606, 0.35608476,
    0.38769063, 0.32168898, 0.259614,
    0.3525893, 0.16000473, 0.09438754,
    0.25363207, 0.100466095, 0.15328535,
    0, 0, 0,
    0.520365, 0.316921, 0.1361234,
    -0.055937734, -0.053635195, 0.037940912,
    0.9906793, 0.20237103, 0.1361234,
    0.19809948, 0.1909178, 0.3665669,
    0.9812813, 0.37275866, 0.1361234,
    0.92699534, 0.8957673, 0.77703786,
    1.170162, 0.49323845, 0.1361234,
    -0.09142239, -0.052361812, -0.17793259,
    0.45442685, 0.40277368, 0.3534013,
    0.38026318, 0.31079602, 0.247273,
    0.35268936, 0.15696964, 0.096412666,
    0.25094962, 0.09972638, 0.15346001,
    0, 0, 0,
    0.39869657, 0.316921, 0.13077849,
    -0.049249776, -0.044101935, 0.02157492,
    0.9947085, 0.20237103, 0.13077849,
    0.22548355, 0.21543571, 0.345648,
    0.9723484, 0.37275866, 0.13077849,
    0.8449466, 0.8111579, 0.7952179,
    1.222246, 0.49323845, 0.13077849,
    -0.045085907, -0.0048419987, -0.15663204,
    0.45130533, 0.3997566, 0.35065973,
    0.37314117, 0.30013454, 0.2351127,
    0.35256064, 0.15394346, 0.098618634,
    0.24854863, 0.09905616, 0.15357193,
    0, 0, 0,
    0.22556026, 0.316921, 0.124069646,
    -0.037002917, -0.03096404, 0.009065183,
    0.9956482, 0.20237103, 0.124069646,
    0.25457314, 0.2534036, 0.33715978,
    0.9630026, 0.37275866, 0.124069646,
    0.7681221, 0.726907, 0.79927164,
    1.2804098, 0.49323845, 0.124069646,
    -0.0121022975, 0.025091927, -0.13784596,
    0.4479241, 0.39672226, 0.3480315,
    0.36649224, 0.28985134, 0.22325732,
    0.35215476, 0.15093169, 0.100945994,
    0.24645163, 0.09846693, 0.15364641,
    0, 0, 0,
    -0.06259443, 0.316921, 0.122444294,
    -0.028044797, -0.021962209, 0.0017638467,
    0.9959436, 0.20237103, 0.122444294,
    0.27985758, 0.28950268, 0.3345938,
    0.94090897, 0.37275866, 0.122444294,
    0.6934374, 0.6445916, 0.7927888,
    1.3, 0.49323845, 0.122444294,
    0.024052897, 0.058033407, -0.121032536,
    0.44448373, 0.39385754, 0.34567782,
    0.3603284, 0.2800013, 0.21178527,
    0.35140383, 0.14792831, 0.10333337,
    0.24466322, 0.09796213, 0.15369418,
    0, 0, 0,
    -0.589729, 0.316921, 0.1252107,
    -0.017767113, -0.013251907, -0.0001570139,
    0.997254, 0.20237103, 0.1252107,
    0.29211843, 0.31584522, 0.32552442,
    0.91982406, 0.37275866, 0.1252107,
    0.64810663, 0.58965856, 0.79211146,
    1.3, 0.49323845, 0.1252107,
    0.041653045, 0.073148064, -0.10890934,
    0.44116428, 0.39132607, 0.3437333,
    0.35474727, 0.27065802, 0.20074813,
    0.35028827, 0.14494982, 0.10574004,
    0.24320546, 0.09755179, 0.153736,
    0, 0, 0,
    -1.3, 0.316921, 0.13059403,
    -0.013461588, -0.008749818, 0.0017897142,
    1.0014989, 0.20237103, 0.13059403,
    0.2905685, 0.33137757, 0.32202142,
    0.8963347, 0.37275866, 0.13059403,
    0.6417474, 0.56062424, 0.7688,
    1.3, 0.49323845, 0.13059403,
    0.03889954, 0.07709507, -0.08118585,
    0.43815634, 0.38929683, 0.34233528,
    0.34986368, 0.26193124, 0.19025554,
    0.3487534, 0.14199321, 0.10811959,
    0.24206844, 0.09723186, 0.15376727,
    0, 0, 0,
    0.52017546, 0.316921, 0.13587427,
    0.3000688, 0.27333593, 0.40667656,
    1.3, 0.20237103, 0.13587427,
    0.17499964, 0.23590428, 0.17663617,
    1.3, 0.37275866, 0.13587427,
    0.5141545, 0.42439392, 0.5290013,
    1.3, 0.49323845, 0.13587427,
    -0.058518894, 0.0046753054, -0.111269504,
    0.43565413, 0.38793743, 0.34161812,
    0.3456608, 0.25380033, 0.18028553,
    0.34679192, 0.13907322, 0.11045124,
    0.24126129, 0.09700617, 0.15379556,
    0, 0, 0,
    0.91297233, 0.316921, 0.13803065,
    0.36335748, 0.31721783, 0.4229323,
    1.3, 0.20237103, 0.13803065,
    0.13569425, 0.21317789, 0.16207393,
    0.5642604, 0.37275866, 0.13803065,
    0.51137453, 0.41337195, 0.5026973,
    -0.42736202, 0.49323845, 0.13803065,
    -0.088249005, -0.011085263, -0.07903141,
    0.43382576, 0.38738534, 0.3416863,
    0.34219277, 0.24631937, 0.1708959,
    0.34441155, 0.13620828, 0.11272331,
    0.24077004, 0.09686818, 0.15380946,
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
