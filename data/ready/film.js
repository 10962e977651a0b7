// For three.js, release 187, and its WebGLRenderer.
import { Color, DataTexture, FloatType, MaterialLoader, Matrix3, MeshStandardMaterial, RGBAFormat, REVISION } from 'three';

if (parseInt(REVISION) !== 187)
    console.warn(`three.js ${REVISION}: this material was written for release 187, and may ignore environments in others`);

const functions = /* glsl */ `
#define film_radiance measured_radiance
#define film_reflected measured_reflected
#define film_lobe_roughness(k) ((k) == 1 ? 0.19363232 : (k) == 2 ? 0.3716556 : (k) == 3 ? 0.29506376 : (k) == 4 ? 0.49112356 : 1.0)
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
    float a_0 = 1.0683594;
    float b_0 = 0.95166016;
    film_AxialPsi psi_0 = film_axial_psi(wl, wv, a_0, b_0);
    up[0] = film_squared_distance_from_pole(psi_0, 1.0);
    down[0] = film_squared_distance_from_pole(psi_0, -1.0);
    film_AxialPsi exchanged_0 = film_axial_psi(wv, wl, a_0, b_0);
    exchanged_up[0] = film_squared_distance_from_pole(exchanged_0, 1.0);
    exchanged_down[0] = film_squared_distance_from_pole(exchanged_0, -1.0);
    float a_1 = 1.1669922;
    float b_1 = 0.17358398;
    film_AxialPsi psi_1 = film_axial_psi(wl, wv, a_1, b_1);
    up[1] = film_squared_distance_from_pole(psi_1, 1.0);
    down[1] = film_squared_distance_from_pole(psi_1, -1.0);
    film_AxialPsi exchanged_1 = film_axial_psi(wv, wl, a_1, b_1);
    exchanged_up[1] = film_squared_distance_from_pole(exchanged_1, 1.0);
    exchanged_down[1] = film_squared_distance_from_pole(exchanged_1, -1.0);
    float a_2 = 1.1083984;
    float b_2 = 0.3918457;
    film_AxialPsi psi_2 = film_axial_psi(wl, wv, a_2, b_2);
    up[2] = film_squared_distance_from_pole(psi_2, 1.0);
    down[2] = film_squared_distance_from_pole(psi_2, -1.0);
    film_AxialPsi exchanged_2 = film_axial_psi(wv, wl, a_2, b_2);
    exchanged_up[2] = film_squared_distance_from_pole(exchanged_2, 1.0);
    exchanged_down[2] = film_squared_distance_from_pole(exchanged_2, -1.0);
    film_PmFeatures features = film_pm_further_features(wl, wv);
    vec3 sum = vec3(0.0, 0.0, 0.0);
    float exponent_0 = 148.05658 + 1.2623582 * features.x[0] + -86.2912 * features.x[1] + 64.2901 * features.x[2] +
            3.243246 * features.x[3];
    float exchanged_exponent_0 = exponent_0;
    exponent_0 = exponent_0 - 6.706278 * down[0];
    exchanged_exponent_0 = exchanged_exponent_0 - 6.706278 * exchanged_down[0];
    exponent_0 = exponent_0 - 71.36832 * up[1];
    exchanged_exponent_0 = exchanged_exponent_0 - 71.36832 * exchanged_up[1];
    exponent_0 = exponent_0 - 30.589643 * down[2];
    exchanged_exponent_0 = exchanged_exponent_0 - 30.589643 * exchanged_down[2];
    float power_0 = 0.5 * (film_pm_power(exponent_0) + film_pm_power(exchanged_exponent_0));
    sum = sum + power_0 * vec3(0.98291016, 0.3232422, 0.33935547);
    float exponent_1 = 27.34358 + 2.1739047 * features.x[0] + -16.906582 * features.x[1] + 0.8157426 * features.x[2] +
            5.3734756 * features.x[3];
    float exchanged_exponent_1 = exponent_1;
    exponent_1 = exponent_1 - 1.0651147 * up[0];
    exchanged_exponent_1 = exchanged_exponent_1 - 1.0651147 * exchanged_up[0];
    exponent_1 = exponent_1 - 7.1345778 * up[1];
    exchanged_exponent_1 = exchanged_exponent_1 - 7.1345778 * exchanged_up[1];
    exponent_1 = exponent_1 - 7.85029 * down[2];
    exchanged_exponent_1 = exchanged_exponent_1 - 7.85029 * exchanged_down[2];
    float power_1 = 0.5 * (film_pm_power(exponent_1) + film_pm_power(exchanged_exponent_1));
    sum = sum + power_1 * vec3(0.9951172, 0.39331055, 0.0);
    float exponent_2 = 0.07568337 + -62.306393 * features.x[1] + 37.239567 * features.x[2] + 0.17179553 * features.x[3];
    float exchanged_exponent_2 = exponent_2;
    exponent_2 = exponent_2 - 1.7737823 * down[0];
    exchanged_exponent_2 = exchanged_exponent_2 - 1.7737823 * exchanged_down[0];
    exponent_2 = exponent_2 - 29.665417 * up[1];
    exchanged_exponent_2 = exchanged_exponent_2 - 29.665417 * exchanged_up[1];
    exponent_2 = exponent_2 - 1.2553138 * up[2];
    exchanged_exponent_2 = exchanged_exponent_2 - 1.2553138 * exchanged_up[2];
    float power_2 = 0.5 * (film_pm_power(exponent_2) + film_pm_power(exchanged_exponent_2));
    sum = sum + power_2 * vec3(1.0, 0.57373047, 0.048339844);
    float exponent_3 = 42.694756 + 0.11755358 * features.x[0] + -24.88649 * features.x[1] + 14.877792 * features.x[2] +
            3.0178251 * features.x[3];
    float exchanged_exponent_3 = exponent_3;
    exponent_3 = exponent_3 - 0.3701837 * down[0];
    exchanged_exponent_3 = exchanged_exponent_3 - 0.3701837 * exchanged_down[0];
    exponent_3 = exponent_3 - 24.615984 * up[1];
    exchanged_exponent_3 = exchanged_exponent_3 - 24.615984 * exchanged_up[1];
    exponent_3 = exponent_3 - 11.220335 * down[2];
    exchanged_exponent_3 = exchanged_exponent_3 - 11.220335 * exchanged_down[2];
    float power_3 = 0.5 * (film_pm_power(exponent_3) + film_pm_power(exchanged_exponent_3));
    sum = sum + power_3 * vec3(0.0, 0.014404297, 1.0048828);
    float exponent_4 = 432.8085 + 47.789272 * features.x[0] + -220.37167 * features.x[1] + 153.82736 * features.x[2] +
            2.0316076 * features.x[3];
    float exchanged_exponent_4 = exponent_4;
    exponent_4 = exponent_4 - 7.9460936 * down[0];
    exchanged_exponent_4 = exchanged_exponent_4 - 7.9460936 * exchanged_down[0];
    exponent_4 = exponent_4 - 143.54816 * up[1];
    exchanged_exponent_4 = exchanged_exponent_4 - 143.54816 * exchanged_up[1];
    exponent_4 = exponent_4 - 100.2673 * down[2];
    exchanged_exponent_4 = exchanged_exponent_4 - 100.2673 * exchanged_down[2];
    float power_4 = 0.5 * (film_pm_power(exponent_4) + film_pm_power(exchanged_exponent_4));
    sum = sum + power_4 * vec3(0.95458984, 0.40722656, 0.83740234);
    float exponent_5 = 69.65512 + -78.35638 * features.x[1] + 55.22817 * features.x[2] + 8.098253 * features.x[3];
    float exchanged_exponent_5 = exponent_5;
    exponent_5 = exponent_5 - 4.3083606 * up[0];
    exchanged_exponent_5 = exchanged_exponent_5 - 4.3083606 * exchanged_up[0];
    exponent_5 = exponent_5 - 47.87944 * up[1];
    exchanged_exponent_5 = exchanged_exponent_5 - 47.87944 * exchanged_up[1];
    exponent_5 = exponent_5 - 19.679262 * down[2];
    exchanged_exponent_5 = exchanged_exponent_5 - 19.679262 * exchanged_down[2];
    float power_5 = 0.5 * (film_pm_power(exponent_5) + film_pm_power(exchanged_exponent_5));
    sum = sum + power_5 * vec3(0.93652344, 0.9897461, 0.96728516);
    float exponent_6 = 345.1648 + 0.033218794 * features.x[0] + 40.46309 * features.x[1] + 47.473682 * features.x[2] +
            -32.48318 * features.x[3];
    float exchanged_exponent_6 = exponent_6;
    exponent_6 = exponent_6 - 46.43675 * up[0];
    exchanged_exponent_6 = exchanged_exponent_6 - 46.43675 * exchanged_up[0];
    exponent_6 = exponent_6 - 104.59539 * down[1];
    exchanged_exponent_6 = exchanged_exponent_6 - 104.59539 * exchanged_down[1];
    exponent_6 = exponent_6 - 41.590195 * up[2];
    exchanged_exponent_6 = exchanged_exponent_6 - 41.590195 * exchanged_up[2];
    float power_6 = 0.5 * (film_pm_power(exponent_6) + film_pm_power(exchanged_exponent_6));
    sum = sum + power_6 * vec3(0.9921875, 1.0097656, 1.0371094);
    float exponent_7 = 194.22282 + 0.2941041 * features.x[0] + 1.968208 * features.x[1] + 12.060029 * features.x[2] +
            -16.827684 * features.x[3];
    float exchanged_exponent_7 = exponent_7;
    exponent_7 = exponent_7 - 11.676813 * up[0];
    exchanged_exponent_7 = exchanged_exponent_7 - 11.676813 * exchanged_up[0];
    exponent_7 = exponent_7 - 59.330833 * down[1];
    exchanged_exponent_7 = exchanged_exponent_7 - 59.330833 * exchanged_down[1];
    exponent_7 = exponent_7 - 40.46309 * up[2];
    exchanged_exponent_7 = exchanged_exponent_7 - 40.46309 * exchanged_up[2];
    float power_7 = 0.5 * (film_pm_power(exponent_7) + film_pm_power(exchanged_exponent_7));
    sum = sum + power_7 * vec3(1.0625, 0.5522461, 0.07733154);
    float exponent_8 = -2.5669827 + 0.7206431 * features.x[0] + -2.4401834 * features.x[1] + 0.4455589 * features.x[2] +
            -27.749338 * features.x[3];
    float exchanged_exponent_8 = exponent_8;
    exponent_8 = exponent_8 - 11.141438 * up[0];
    exchanged_exponent_8 = exchanged_exponent_8 - 11.141438 * exchanged_up[0];
    exponent_8 = exponent_8 - 5.4805503 * down[1];
    exchanged_exponent_8 = exchanged_exponent_8 - 5.4805503 * exchanged_down[1];
    exponent_8 = exponent_8 - 2.4514544 * up[2];
    exchanged_exponent_8 = exchanged_exponent_8 - 2.4514544 * exchanged_up[2];
    float power_8 = 0.5 * (film_pm_power(exponent_8) + film_pm_power(exchanged_exponent_8));
    sum = sum + power_8 * vec3(1.0, 0.17260742, 0.0);
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
//   albedo_error 0.0553
//   delta_e_itp 5.567
//   flip 0.07659
//   generator srbf 0.1.0
//   heldout_squared_error_ratio 0.4099
//   heldout_squared_error_ratio_cosine 0.07283
//   max_theta 89
//   objective appearance
//   psnr 32.76
//   rms 0.112
//   seed 0
//   source cc_ibiza_sunset_rgb.bsdf
//   squared_error_ratio 0.1029

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
    onBeforeCompile(shader) {
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
        return this.terms.map((term) => term.reflectance + term.functions).join() + this.onBeforeCompile;
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
    0.9840483, 0.19363232, 0.037085075,
    0.40632933, 0.45023486, 0.48504356,
    0.9505287, 0.3716556, 0.037085075,
    -0.45001754, -0.4565201, -0.4643553,
    0.9052686, 0.29506376, 0.037085075,
    0.8818722, 0.9251685, 0.98372096,
    0.6700313, 0.49112356, 0.037085075,
    0.16769662, 0.08348616, -0.0072106775,
    0.32768926, 0.32439944, 0.31970873,
    0.43056813, 0.38458338, 0.33701265,
    0.33949697, 0.2420122, 0.16127783,
    0.34019804, 0.1323979, 0.112614535,
    0.22880769, 0.088162996, 0.14074804,
    0.9840677, 0.19363232, 0.037085075,
    0.4063189, 0.45022935, 0.48504633,
    0.95130926, 0.3716556, 0.037085075,
    -0.45002428, -0.45652318, -0.46435195,
    0.9050631, 0.29506376, 0.037085075,
    0.88185936, 0.92515934, 0.983718,
    0.653557, 0.49112356, 0.037085075,
    0.16769671, 0.08348748, -0.007210581,
    0.32768926, 0.32439944, 0.31970873,
    0.430351, 0.38574132, 0.33872604,
    0.33762255, 0.23636797, 0.15317775,
    0.33695295, 0.13000175, 0.11500784,
    0, 0, 0,
    0.9816224, 0.19363232, 0.03818866,
    0.40629166, 0.45021424, 0.48505116,
    0.94916636, 0.3716556, 0.03818866,
    -0.4500445, -0.45653373, -0.46434608,
    0.9052215, 0.29506376, 0.03818866,
    0.8818279, 0.92513734, 0.9837117,
    0.6467887, 0.49112356, 0.03818866,
    0.1676953, 0.08348966, -0.0072103394,
    0.32768768, 0.32439798, 0.3197073,
    0.4312694, 0.38803628, 0.34152502,
    0.33623064, 0.23113447, 0.14554308,
    0.333527, 0.12774292, 0.11753639,
    0, 0, 0,
    0.9829847, 0.19363232, 0.03918262,
    0.4062594, 0.4501979, 0.4850612,
    0.9522901, 0.3716556, 0.03918262,
    -0.4500684, -0.45654473, -0.46433535,
    0.9016208, 0.29506376, 0.03918262,
    0.88178736, 0.9251093, 0.98370457,
    0.6262547, 0.49112356, 0.03918262,
    0.1676933, 0.083492264, -0.0072107296,
    0.34463805, 0.3377542, 0.32987234,
    0.4333045, 0.3914037, 0.3453173,
    0.33539665, 0.22638321, 0.1384836,
    0.32997242, 0.12562759, 0.120193236,
    0, 0, 0,
    0.9805627, 0.19363232, 0.037434004,
    0.4061747, 0.4501603, 0.4850982,
    0.95290893, 0.3716556, 0.037434004,
    -0.4501357, -0.4565737, -0.4643028,
    0.9031015, 0.29506376, 0.037434004,
    0.88166213, 0.925021, 0.9836748,
    0.6215893, 0.49112356, 0.037434004,
    0.16768898, 0.08350088, -0.0072137355,
    0.35903984, 0.34865448, 0.33764082,
    0.43630278, 0.39564115, 0.3498788,
    0.3350006, 0.22199683, 0.13192979,
    0.3263269, 0.12365369, 0.12295772,
    0, 0, 0,
    0.978747, 0.19363232, 0.03268894,
    0.40540987, 0.4499719, 0.48578706,
    0.95678616, 0.3716556, 0.03268894,
    -0.45084685, -0.4568175, -0.46382615,
    0.9066035, 0.29506376, 0.03268894,
    0.8799554, 0.9237578, 0.98308504,
    0.6448319, 0.49112356, 0.03268894,
    0.16773099, 0.08364708, -0.0073388033,
    0.37164965, 0.35789916, 0.34386414,
    0.4400079, 0.4004425, 0.35488728,
    0.33505434, 0.21798712, 0.12594104,
    0.322603, 0.12180747, 0.12579241,
    0, 0, 0,
    0.98512965, 0.19363232, 0.025381817,
    0.40556335, 0.4524059, 0.49149507,
    0.9618825, 0.3716556, 0.025381817,
    -0.4524851, -0.45681563, -0.46132293,
    0.91381484, 0.29506376, 0.025381817,
    0.8705041, 0.9157086, 0.9771539,
    0.68783176, 0.49112356, 0.025381817,
    0.16928019, 0.08468145, -0.009158044,
    0.3830254, 0.36602068, 0.34905726,
    0.44406566, 0.40540367, 0.3599292,
    0.3353912, 0.21418652, 0.12039611,
    0.3188068, 0.12007254, 0.12864964,
    0, 0, 0,
    0.98488426, 0.19363232, 0.018221037,
    0.42504352, 0.47579703, 0.5195728,
    0.97141343, 0.3716556, 0.018221037,
    -0.44524032, -0.44741538, -0.44860104,
    0.92217374, 0.29506376, 0.018221037,
    0.8397117, 0.88508666, 0.9475358,
    0.7185002, 0.49112356, 0.018221037,
    0.17371185, 0.084899776, -0.01829069,
    0.39345962, 0.37329766, 0.35348877,
    0.44806597, 0.4100678, 0.3645441,
    0.33607018, 0.21065064, 0.11539675,
    0.3149457, 0.11843256, 0.13147938,
    0, 0, 0,
    0.98630303, 0.19363232, 0.01299589,
    0.48867175, 0.546426, 0.59396213,
    0.9746966, 0.3716556, 0.01299589,
    -0.4653226, -0.45978415, -0.45255157,
    0.9432602, 0.29506376, 0.01299589,
    0.7811731, 0.8191775, 0.87393653,
    0.7765976, 0.49112356, 0.01299589,
    0.1847989, 0.09022246, -0.018054726,
    0.40311405, 0.37988567, 0.3573096,
    0.45161983, 0.4140058, 0.36830372,
    0.33692634, 0.20722371, 0.11084161,
    0.3109989, 0.116859965, 0.13421962,
    0, 0, 0,
    0.9906728, 0.19363232, 0.010628612,
    0.6140624, 0.6820216, 0.7354561,
    0.978091, 0.3716556, 0.010628612,
    -0.5325513, -0.5057058, -0.47395718,
    0.9579941, 0.29506376, 0.010628612,
    0.7017465, 0.71512914, 0.7414595,
    0.8540981, 0.49112356, 0.010628612,
    0.20120531, 0.10267202, -0.0059988755,
    0.41207573, 0.38587078, 0.3606052,
    0.45435572, 0.41681325, 0.37080875,
    0.33795282, 0.20389718, 0.10676385,
    0.30696157, 0.11533521, 0.13681485,
    0, 0, 0,
    0.992537, 0.19363232, 0.010599084,
    0.7625809, 0.8517921, 0.93036866,
    0.9814846, 0.3716556, 0.010599084,
    -0.54520273, -0.49492583, -0.43722934,
    0.9610025, 0.29506376, 0.010599084,
    0.56736183, 0.5328863, 0.49934733,
    0.8976362, 0.49112356, 0.010599084,
    0.20199199, 0.10720822, 0.006321471,
    0.42038414, 0.39129612, 0.36342177,
    0.45597005, 0.41816306, 0.37174046,
    0.33910328, 0.2006258, 0.103156365,
    0.3028182, 0.11383526, 0.13920975,
    0, 0, 0,
    0.99374384, 0.19363232, 0.012609192,
    0.8711094, 0.9915941, 1.1102803,
    0.9850821, 0.3716556, 0.012609192,
    -0.45388976, -0.40016615, -0.34195927,
    0.95451754, 0.29506376, 0.012609192,
    0.38889128, 0.30732885, 0.2079272,
    0.89953077, 0.49112356, 0.012609192,
    0.18304807, 0.100374125, 0.02395886,
    0.42804423, 0.39617392, 0.36577716,
    0.4562754, 0.41785592, 0.37090838,
    0.3403643, 0.1973975, 0.10003818,
    0.2985716, 0.112345695, 0.14136408,
    0, 0, 0,
    0.99716306, 0.19363232, 0.016724568,
    0.89108855, 1.0291942, 1.1741782,
    0.98870564, 0.3716556, 0.016724568,
    -0.37466893, -0.3327241, -0.2903538,
    0.9499627, 0.29506376, 0.016724568,
    0.30186567, 0.20805712, 0.08099347,
    0.8798056, 0.49112356, 0.016724568,
    0.16986486, 0.09449617, 0.036080454,
    0.4350468, 0.4005049, 0.36768064,
    0.4551954, 0.41581535, 0.36824495,
    0.34167567, 0.19415884, 0.09738095,
    0.29420575, 0.110846795, 0.14323235,
    0, 0, 0,
    1, 0.19363232, 0.022599371,
    0.83849335, 0.98528385, 1.1499468,
    0.9974933, 0.3716556, 0.022599371,
    -0.2362522, -0.21605882, -0.1968644,
    0.9359479, 0.29506376, 0.022599371,
    0.25515276, 0.16510585, 0.028609319,
    0.807174, 0.49112356, 0.022599371,
    0.13184208, 0.06445122, 0.018940026,
    0.44136217, 0.40427268, 0.3691265,
    0.4527223, 0.41204256, 0.3637594,
    0.3430426, 0.190919, 0.09520509,
    0.28974366, 0.10933493, 0.1448005,
    0, 0, 0,
    1.0062996, 0.19363232, 0.030927818,
    0.73585194, 0.8921602, 1.1005416,
    0.99972725, 0.3716556, 0.030927818,
    -0.20735365, -0.19241351, -0.17939568,
    0.9498967, 0.29506376, 0.030927818,
    0.31916857, 0.22692184, 0.05770863,
    0.77357894, 0.49112356, 0.030927818,
    0.14109467, 0.07189157, 0.021821076,
    0.4469454, 0.40744695, 0.3700967,
    0.4489818, 0.4066835, 0.3576013,
    0.34443024, 0.18765351, 0.09348926,
    0.28517982, 0.10779753, 0.14604245,
    0, 0, 0,
    1.0088646, 0.19363232, 0.039966006,
    0.6551436, 0.8266474, 1.0167812,
    0.8704481, 0.3716556, 0.039966006,
    0.40723208, 0.23023361, 0.029664487,
    0.8049052, 0.29506376, 0.039966006,
    -0.019959012, -0.005384022, 0.008392824,
    1.0165757, 0.49112356, 0.039966006,
    -0.06749417, -0.06170478, -0.059271414,
    0.45175654, 0.41000432, 0.37058154,
    0.44416407, 0.3999566, 0.34998924,
    0.34583545, 0.18437651, 0.0922393,
    0.28054816, 0.10623907, 0.1469615,
    0, 0, 0,
    1.0121176, 0.19363232, 0.051309615,
    0.51541907, 0.7085503, 0.9521105,
    0.8991838, 0.3716556, 0.051309615,
    0.6147762, 0.37999815, 0.07812016,
    0.81736684, 0.29506376, 0.051309615,
    -0.06070657, -0.025565775, 0.014181653,
    1.0248625, 0.49112356, 0.051309615,
    -0.09426485, -0.07285839, -0.047873735,
    0.45574552, 0.4119123, 0.37056297,
    0.438429, 0.39205196, 0.34111157,
    0.34722653, 0.18107726, 0.09142667,
    0.27587512, 0.1046624, 0.14756228,
    0, 0, 0,
    1.022944, 0.19363232, 0.06452992,
    0.3039334, 0.47527176, 0.7047886,
    0.945751, 0.3716556, 0.06452992,
    0.7280291, 0.47326738, 0.102437854,
    0.9694095, 0.29506376, 0.06452992,
    0.082240924, 0.152359, 0.2703497,
    1.0519128, 0.49112356, 0.06452992,
    -0.14035721, -0.112356395, -0.081631616,
    0.4588685, 0.41314504, 0.3700301,
    0.431888, 0.3831107, 0.331107,
    0.34859955, 0.17778036, 0.09104535,
    0.2711891, 0.103072755, 0.14785494,
    0, 0, 0,
    1.0248677, 0.19363232, 0.080303945,
    0.16261846, 0.33909023, 0.535662,
    0.9758986, 0.3716556, 0.080303945,
    0.8063682, 0.55918723, 0.08671069,
    0.95850945, 0.29506376, 0.080303945,
    0.17541243, 0.21941003, 0.45479783,
    1.0777584, 0.49112356, 0.080303945,
    -0.17118445, -0.13014574, -0.08100141,
    0.46109346, 0.41368794, 0.36898232,
    0.4247559, 0.3733827, 0.32021815,
    0.3499216, 0.17448731, 0.0910594,
    0.26653588, 0.10148314, 0.1478672,
    0, 0, 0,
    1.0286316, 0.19363232, 0.0978457,
    0.08254929, 0.24322057, 0.3760259,
    0.99837834, 0.3716556, 0.0978457,
    0.83299524, 0.65601426, 0.11638008,
    0.95128787, 0.29506376, 0.0978457,
    0.23933797, 0.23268892, 0.59425914,
    1.1084212, 0.49112356, 0.0978457,
    -0.17990161, -0.14436708, -0.08954177,
    0.4623977, 0.4135348, 0.36742643,
    0.41720706, 0.3630733, 0.30864337,
    0.351142, 0.17119882, 0.09142986,
    0.26195258, 0.09990454, 0.14762565,
    0, 0, 0,
    1.033762, 0.19363232, 0.113960065,
    0.05419599, 0.17892176, 0.25553048,
    1.0170718, 0.3716556, 0.113960065,
    0.8134792, 0.7247157, 0.15110342,
    0.9434189, 0.29506376, 0.113960065,
    0.27410364, 0.2268725, 0.69114816,
    1.1431998, 0.49112356, 0.113960065,
    -0.16539057, -0.14373194, -0.09977117,
    0.4627743, 0.41269344, 0.36538142,
    0.40939844, 0.35236743, 0.2965611,
    0.35224485, 0.16794129, 0.092127375,
    0.2574838, 0.09835211, 0.1471659,
    0, 0, 0,
    1.0407394, 0.19363232, 0.12635921,
    0.05169011, 0.13159402, 0.16219756,
    1.0297344, 0.3716556, 0.12635921,
    0.76979804, 0.75394416, 0.19682777,
    0.93907654, 0.29506376, 0.12635921,
    0.297305, 0.2291618, 0.74992704,
    1.1751282, 0.49112356, 0.12635921,
    -0.14183192, -0.12975042, -0.11038657,
    0.4622432, 0.4111955, 0.36288694,
    0.40148693, 0.3414469, 0.28414834,
    0.35317156, 0.16471276, 0.09310118,
    0.2531948, 0.09685037, 0.14654273,
    0, 0, 0,
    1.0235502, 0.19363232, 0.1335006,
    0.06668183, 0.10999549, 0.08266149,
    1.0363225, 0.3716556, 0.1335006,
    0.7186807, 0.744281, 0.26739404,
    0.94454485, 0.29506376, 0.1335006,
    0.3036088, 0.22939683, 0.77056676,
    1.2107259, 0.49112356, 0.1335006,
    -0.112053655, -0.100929074, -0.12102407,
    0.46084794, 0.409093, 0.35999975,
    0.39357167, 0.33042976, 0.27152127,
    0.35385284, 0.16151144, 0.09430263,
    0.24913828, 0.09542011, 0.14580669,
    0, 0, 0,
    1.0230092, 0.19363232, 0.13526356,
    0.074168816, 0.09170202, 0.03595747,
    1.0417126, 0.3716556, 0.13526356,
    0.66139495, 0.6999294, 0.32461506,
    0.95054233, 0.29506376, 0.13526356,
    0.3268132, 0.26263696, 0.76823837,
    1.2570766, 0.49112356, 0.13526356,
    -0.08508374, -0.07301327, -0.12720352,
    0.45866317, 0.40646502, 0.3567996,
    0.3858516, 0.31953233, 0.2588927,
    0.35424742, 0.15834719, 0.09569212,
    0.24536012, 0.094079934, 0.1450069,
    0, 0, 0,
    1.0428213, 0.19363232, 0.13061747,
    0.07304377, 0.0790006, 0.015615079,
    1.039037, 0.3716556, 0.13061747,
    0.5907709, 0.6221901, 0.36915892,
    0.95819956, 0.29506376, 0.13061747,
    0.36589697, 0.31495193, 0.7467163,
    1.3, 0.49112356, 0.13061747,
    -0.053362362, -0.037437018, -0.12914433,
    0.45579672, 0.40341917, 0.3533898,
    0.37843445, 0.30887336, 0.2463808,
    0.35429794, 0.15522082, 0.09722407,
    0.24192762, 0.092857465, 0.14420839,
    0, 0, 0,
    1.0643944, 0.19363232, 0.124195345,
    0.08852934, 0.09052745, 0.023676148,
    1.0232403, 0.3716556, 0.124195345,
    0.49954382, 0.51887727, 0.40398684,
    0.95947653, 0.29506376, 0.124195345,
    0.40659982, 0.3673477, 0.70925045,
    1.3, 0.49112356, 0.124195345,
    -0.01901381, 0.00062905287, -0.13382462,
    0.45238528, 0.4000871, 0.3498928,
    0.37145606, 0.29859668, 0.23413469,
    0.35396537, 0.1521363, 0.09886645,
    0.23886915, 0.09176502, 0.14344832,
    0, 0, 0,
    1.0864094, 0.19363232, 0.12115287,
    0.10540046, 0.10848179, 0.04505407,
    0.99775237, 0.3716556, 0.12115287,
    0.40439475, 0.41613263, 0.42828602,
    0.9570361, 0.29506376, 0.12115287,
    0.44615296, 0.41322464, 0.66262364,
    1.3, 0.49112356, 0.12115287,
    0.018186085, 0.0377903, -0.1317558,
    0.44860226, 0.3966318, 0.34645718,
    0.36494905, 0.28873917, 0.22219583,
    0.3532205, 0.14910044, 0.10059514,
    0.23620585, 0.090812065, 0.14275691,
    0, 0, 0,
    1.1234864, 0.19363232, 0.12322984,
    0.11350237, 0.11902864, 0.07134846,
    0.9749364, 0.3716556, 0.12322984,
    0.3194565, 0.33048236, 0.43908936,
    0.93532634, 0.29506376, 0.12322984,
    0.48385075, 0.45203277, 0.61336076,
    1.3, 0.49112356, 0.12322984,
    0.054508343, 0.071008146, -0.11825173,
    0.44465467, 0.39324486, 0.34325477,
    0.35906357, 0.27945074, 0.21072093,
    0.35202906, 0.14611088, 0.10239085,
    0.23394102, 0.090000816, 0.14214927,
    0, 0, 0,
    0.96946377, 0.19363232, 0.13085684,
    0.07458106, 0.10136399, 0.08035719,
    0.8844932, 0.3716556, 0.13085684,
    0.26690966, 0.2773884, 0.4663473,
    1.0001818, 0.29506376, 0.13085684,
    0.5560882, 0.49998766, 0.56896436,
    1.3, 0.49112356, 0.13085684,
    0.06757117, 0.08804495, -0.10903618,
    0.44076562, 0.39012894, 0.34046385,
    0.35379618, 0.27072737, 0.1997154,
    0.35041696, 0.14318965, 0.10425814,
    0.23209414, 0.089339375, 0.14164847,
    0, 0, 0,
    0.40805033, 0.19363232, 0.1396376,
    0.04804218, 0.067721985, 0.0693868,
    0.82135427, 0.3716556, 0.1396376,
    0.28681076, 0.27524522, 0.48102617,
    1.0840837, 0.29506376, 0.1396376,
    0.5742951, 0.5430968, 0.55777085,
    1.3, 0.49112356, 0.1396376,
    0.04701329, 0.07294583, -0.10011054,
    0.4371791, 0.38750312, 0.33827505,
    0.3492314, 0.26265174, 0.18927945,
    0.3483812, 0.14033964, 0.10619628,
    0.23065533, 0.0888241, 0.14125389,
    0, 0, 0,
    -0.27067673, 0.19363232, 0.14730084,
    0.046099246, 0.06405236, 0.0714919,
    0.74685585, 0.3716556, 0.14730084,
    0.34082192, 0.30261406, 0.4860894,
    1.2455379, 0.29506376, 0.14730084,
    0.5486155, 0.53789645, 0.54460585,
    1.3, 0.49112356, 0.14730084,
    0.003094085, 0.03797906, -0.095465854,
    0.43413872, 0.3855813, 0.3368705,
    0.34532663, 0.25517616, 0.1793811,
    0.34596568, 0.13757952, 0.10822367,
    0.229632, 0.08845797, 0.1409746,
    0, 0, 0,
    0.1, 0.19363232, 0.15029109,
    -0.0029408853, 0.04074338, 0.051870916,
    0.42935875, 0.3716556, 0.15029109,
    0.40372398, 0.34027603, 0.49081865,
    1.3, 0.29506376, 0.15029109,
    0.57345116, 0.5432672, 0.5559928,
    0.46162784, 0.49112356, 0.15029109,
    -0.045777358, 0.010868417, -0.0900445,
    0.43187243, 0.38455793, 0.33641094,
    0.34211174, 0.24832825, 0.17007111,
    0.34322596, 0.13492988, 0.11035939,
    0.22901136, 0.08823581, 0.14080286,
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
    onBeforeCompile(shader) {
        super.onBeforeCompile(shader);
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
