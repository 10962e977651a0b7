// For three.js, release 187, and its WebGLRenderer.
import { Color, DataTexture, FloatType, MaterialLoader, Matrix3, MeshStandardMaterial, RGBAFormat, REVISION } from 'three';

if (parseInt(REVISION) !== 187)
    console.warn(`three.js ${REVISION}: this material was written for release 187, and may ignore environments in others`);

const functions = /* glsl */ `
#define film_radiance measured_radiance
#define film_reflected measured_reflected
#define film_lobe_roughness(k) ((k) == 1 ? 0.20488252 : (k) == 2 ? 0.37288117 : (k) == 3 ? 0.48927948 : (k) == 4 ? 0.3069369 : 1.0)
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
    0.9849789, 0.20488252, 0.03712881,
    0.4286488, 0.47690237, 0.5181669,
    0.9496747, 0.37288117, 0.03712881,
    -0.5384431, -0.5496185, -0.5624704,
    0.6702218, 0.48927948, 0.03712881,
    0.16511913, 0.07954318, -0.011914873,
    0.90695083, 0.3069369, 0.03712881,
    0.94914263, 0.9940817, 1.0520214,
    0.32768926, 0.32439944, 0.31970873,
    0.43056813, 0.38458338, 0.33701265,
    0.33949697, 0.2420122, 0.16127783,
    0.34019804, 0.1323979, 0.112614535,
    0.22880769, 0.088162996, 0.14074804,
    0.98498285, 0.20488252, 0.03712881,
    0.42864, 0.47689924, 0.5181732,
    0.9498389, 0.37288117, 0.03712881,
    -0.53844965, -0.54962045, -0.56246465,
    0.6592264, 0.48927948, 0.03712881,
    0.16511817, 0.07954408, -0.011914959,
    0.9069805, 0.3069369, 0.03712881,
    0.94912845, 0.99407166, 1.0520185,
    0.32768926, 0.32439944, 0.31970873,
    0.430351, 0.38574132, 0.33872604,
    0.33762255, 0.23636797, 0.15317775,
    0.33695295, 0.13000175, 0.11500784,
    0, 0, 0,
    0.98078585, 0.20488252, 0.038640752,
    0.42861858, 0.4768907, 0.5181861,
    0.9436889, 0.37288117, 0.038640752,
    -0.53846675, -0.5496267, -0.56245303,
    0.65128267, 0.48927948, 0.038640752,
    0.16511558, 0.07954594, -0.011915091,
    0.90362453, 0.3069369, 0.038640752,
    0.94909644, 0.99404955, 1.052013,
    0.32768768, 0.32439798, 0.3197073,
    0.4312694, 0.38803628, 0.34152502,
    0.33623064, 0.23113447, 0.14554308,
    0.333527, 0.12774292, 0.11753639,
    0, 0, 0,
    0.98252195, 0.20488252, 0.039233744,
    0.42859343, 0.476882, 0.5182047,
    0.95081, 0.37288117, 0.039233744,
    -0.5384858, -0.5496321, -0.56243557,
    0.6358027, 0.48927948, 0.039233744,
    0.1651118, 0.07954769, -0.011915979,
    0.90504783, 0.3069369, 0.039233744,
    0.9490556, 0.9940215, 1.0520062,
    0.34463805, 0.3377542, 0.32987234,
    0.4333045, 0.3914037, 0.3453173,
    0.33539665, 0.22638321, 0.1384836,
    0.32997242, 0.12562759, 0.120193236,
    0, 0, 0,
    0.98257154, 0.20488252, 0.03738275,
    0.42853007, 0.4768666, 0.5182673,
    0.95267075, 0.37288117, 0.03738275,
    -0.5385368, -0.5496432, -0.562382,
    0.639101, 0.48927948, 0.03738275,
    0.16510113, 0.07955136, -0.011924363,
    0.9043781, 0.3069369, 0.03738275,
    0.94893056, 0.9939331, 1.0519778,
    0.35903984, 0.34865448, 0.33764082,
    0.43630278, 0.39564115, 0.3498788,
    0.3350006, 0.22199683, 0.13192979,
    0.3263269, 0.12365369, 0.12295772,
    0, 0, 0,
    0.98278517, 0.20488252, 0.03272016,
    0.42811084, 0.4769917, 0.5192315,
    0.9540458, 0.37288117, 0.03272016,
    -0.53890514, -0.54958606, -0.5616568,
    0.63862866, 0.48927948, 0.03272016,
    0.16504216, 0.07956909, -0.012219185,
    0.90553886, 0.3069369, 0.03272016,
    0.9472772, 0.99265355, 1.0512936,
    0.37164965, 0.35789916, 0.34386414,
    0.4400079, 0.4004425, 0.35488728,
    0.33505434, 0.21798712, 0.12594104,
    0.322603, 0.12180747, 0.12579241,
    0, 0, 0,
    0.97936594, 0.20488252, 0.025451524,
    0.42972127, 0.48082447, 0.5261863,
    0.9570704, 0.37288117, 0.025451524,
    -0.5377711, -0.54689354, -0.5566547,
    0.6763089, 0.48927948, 0.025451524,
    0.16555493, 0.07948327, -0.015260821,
    0.91106045, 0.3069369, 0.025451524,
    0.9374955, 0.98391235, 1.0442525,
    0.3830254, 0.36602068, 0.34905726,
    0.44406566, 0.40540367, 0.3599292,
    0.3353912, 0.21418652, 0.12039611,
    0.3188068, 0.12007254, 0.12864964,
    0, 0, 0,
    0.983995, 0.20488252, 0.018202934,
    0.45144147, 0.50697386, 0.5574844,
    0.9691469, 0.37288117, 0.018202934,
    -0.52404946, -0.5305099, -0.5363769,
    0.7164005, 0.48927948, 0.018202934,
    0.16624765, 0.075938456, -0.028324755,
    0.9206418, 0.3069369, 0.018202934,
    0.90080124, 0.9464656, 1.0071088,
    0.39345962, 0.37329766, 0.35348877,
    0.44806597, 0.4100678, 0.3645441,
    0.33607018, 0.21065064, 0.11539675,
    0.3149457, 0.11843256, 0.13147938,
    0, 0, 0,
    0.9843169, 0.20488252, 0.013023503,
    0.5187712, 0.58421946, 0.64152527,
    0.9734313, 0.37288117, 0.013023503,
    -0.5219541, -0.51849, -0.51329124,
    0.78459626, 0.48927948, 0.013023503,
    0.17457055, 0.07709225, -0.035451725,
    0.938268, 0.3069369, 0.013023503,
    0.8161945, 0.85211265, 0.904001,
    0.40311405, 0.37988567, 0.3573096,
    0.45161983, 0.4140058, 0.36830372,
    0.33692634, 0.20722371, 0.11084161,
    0.3109989, 0.116859965, 0.13421962,
    0, 0, 0,
    0.99021554, 0.20488252, 0.010537218,
    0.66299933, 0.7418219, 0.80668783,
    0.9782253, 0.37288117, 0.010537218,
    -0.56280786, -0.53516537, -0.50233316,
    0.86223996, 0.48927948, 0.010537218,
    0.19464329, 0.095222555, -0.01653253,
    0.9553379, 0.3069369, 0.010537218,
    0.6877446, 0.69102347, 0.708335,
    0.41207573, 0.38587078, 0.3606052,
    0.45435572, 0.41681325, 0.37080875,
    0.33795282, 0.20389718, 0.10676385,
    0.30696157, 0.11533521, 0.13681485,
    0, 0, 0,
    0.98832625, 0.20488252, 0.010487087,
    0.853678, 0.96188754, 1.0568321,
    0.98004997, 0.37288117, 0.010487087,
    -0.5002637, -0.44634444, -0.38425845,
    0.90237254, 0.48927948, 0.010487087,
    0.18724357, 0.09788679, 7.370902e-05,
    0.94640326, 0.3069369, 0.010487087,
    0.4461428, 0.383615, 0.326348,
    0.42038414, 0.39129612, 0.36342177,
    0.45597005, 0.41816306, 0.37174046,
    0.33910328, 0.2006258, 0.103156365,
    0.3028182, 0.11383526, 0.13920975,
    0, 0, 0,
    0.9919146, 0.20488252, 0.012636852,
    0.98936415, 1.1170592, 1.2261641,
    0.98435646, 0.37288117, 0.012636852,
    -0.4312238, -0.38405448, -0.3345475,
    0.90892637, 0.48927948, 0.012636852,
    0.18927023, 0.119252436, 0.051798746,
    0.93177867, 0.3069369, 0.012636852,
    0.24106549, 0.14692369, 0.057962805,
    0.42804423, 0.39617392, 0.36577716,
    0.4562754, 0.41785592, 0.37090838,
    0.3403643, 0.1973975, 0.10003818,
    0.2985716, 0.112345695, 0.14136408,
    0, 0, 0,
    0.9962368, 0.20488252, 0.016902467,
    1.0126588, 1.1457528, 1.2594945,
    0.98876613, 0.37288117, 0.016902467,
    -0.4047769, -0.37667665, -0.35154673,
    0.9254572, 0.48927948, 0.016902467,
    0.18979335, 0.13428675, 0.08574015,
    0.90243196, 0.3069369, 0.016902467,
    0.18706, 0.094767, 0.008878639,
    0.4350468, 0.4005049, 0.36768064,
    0.4551954, 0.41581535, 0.36824495,
    0.34167567, 0.19415884, 0.09738095,
    0.29420575, 0.110846795, 0.14323235,
    0, 0, 0,
    1, 0.20488252, 0.022619186,
    0.8909683, 1.0392886, 1.2015692,
    0.994829, 0.37288117, 0.022619186,
    -0.28610766, -0.2659925, -0.24625634,
    0.8192468, 0.48927948, 0.022619186,
    0.14427933, 0.07628566, 0.030559417,
    0.935541, 0.3069369, 0.022619186,
    0.23976932, 0.14964288, 0.015515459,
    0.44136217, 0.40427268, 0.3691265,
    0.4527223, 0.41204256, 0.3637594,
    0.3430426, 0.190919, 0.09520509,
    0.28974366, 0.10933493, 0.1448005,
    0, 0, 0,
    1.0062996, 0.20488252, 0.030230481,
    0.77505434, 0.93237334, 1.137749,
    0.9990218, 0.37288117, 0.030230481,
    -0.24166542, -0.22810109, -0.21610568,
    0.7781205, 0.48927948, 0.030230481,
    0.14205568, 0.07281541, 0.025643537,
    0.94629735, 0.3069369, 0.030230481,
    0.31242692, 0.22094822, 0.053436402,
    0.4469454, 0.40744695, 0.3700967,
    0.4489818, 0.4066835, 0.3576013,
    0.34443024, 0.18765351, 0.09348926,
    0.28517982, 0.10779753, 0.14604245,
    0, 0, 0,
    1.0081689, 0.20488252, 0.039864223,
    0.68601894, 0.85087115, 1.0342331,
    0.85996854, 0.37288117, 0.039864223,
    0.37865618, 0.20942503, 0.012403055,
    1.0178105, 0.48927948, 0.039864223,
    -0.06780098, -0.06519175, -0.06663803,
    0.7985936, 0.3069369, 0.039864223,
    -0.021936078, -0.0053594606, 0.015195032,
    0.45175654, 0.41000432, 0.37058154,
    0.44416407, 0.3999566, 0.34998924,
    0.34583545, 0.18437651, 0.0922393,
    0.28054816, 0.10623907, 0.1469615,
    0, 0, 0,
    1.0125023, 0.20488252, 0.05130962,
    0.5486687, 0.737573, 0.97018784,
    0.8858223, 0.37288117, 0.05130962,
    0.59683335, 0.36758885, 0.074694715,
    1.0276053, 0.48927948, 0.05130962,
    -0.08804629, -0.07354067, -0.05876665,
    0.80431575, 0.3069369, 0.05130962,
    -0.081441596, -0.04127705, 0.010130561,
    0.45574552, 0.4119123, 0.37056297,
    0.438429, 0.39205196, 0.34111157,
    0.34722653, 0.18107726, 0.09142667,
    0.27587512, 0.1046624, 0.14756228,
    0, 0, 0,
    1.0208439, 0.20488252, 0.06452992,
    0.3423381, 0.5262051, 0.763656,
    0.9436407, 0.37288117, 0.06452992,
    0.72683185, 0.4668017, 0.076909356,
    1.0498329, 0.48927948, 0.06452992,
    -0.14236844, -0.112102, -0.07678204,
    0.95176107, 0.3069369, 0.06452992,
    0.047338627, 0.10776729, 0.23229691,
    0.4588685, 0.41314504, 0.3700301,
    0.431888, 0.3831107, 0.331107,
    0.34859955, 0.17778036, 0.09104535,
    0.2711891, 0.103072755, 0.14785494,
    0, 0, 0,
    1.0224503, 0.20488252, 0.08030394,
    0.19533017, 0.38975924, 0.6143268,
    0.9767729, 0.37288117, 0.08030394,
    0.7966992, 0.55746466, 0.064386405,
    1.0773565, 0.48927948, 0.08030394,
    -0.17550318, -0.13369334, -0.076284885,
    0.9446843, 0.3069369, 0.08030394,
    0.15723889, 0.17419215, 0.39418256,
    0.46109346, 0.41368794, 0.36898232,
    0.4247559, 0.3733827, 0.32021815,
    0.3499216, 0.17448731, 0.0910594,
    0.26653588, 0.10148314, 0.1478672,
    0, 0, 0,
    1.0255783, 0.20488252, 0.097615704,
    0.112712614, 0.28762716, 0.4702065,
    1.001101, 0.37288117, 0.097615704,
    0.81544966, 0.6544866, 0.09631752,
    1.1060097, 0.48927948, 0.097615704,
    -0.18824646, -0.15360267, -0.088039376,
    0.9372707, 0.3069369, 0.097615704,
    0.23497294, 0.19857329, 0.51857984,
    0.4623977, 0.4135348, 0.36742643,
    0.41720706, 0.3630733, 0.30864337,
    0.351142, 0.17119882, 0.09142986,
    0.26195258, 0.09990454, 0.14762565,
    0, 0, 0,
    1.026639, 0.20488252, 0.11389527,
    0.07356585, 0.20545821, 0.32712168,
    1.0203438, 0.37288117, 0.11389527,
    0.8007716, 0.73601735, 0.18057838,
    1.1467092, 0.48927948, 0.11389527,
    -0.1675979, -0.14858277, -0.10542696,
    0.93726575, 0.3069369, 0.11389527,
    0.26978382, 0.19355366, 0.5958976,
    0.4627743, 0.41269344, 0.36538142,
    0.40939844, 0.35236743, 0.2965611,
    0.35224485, 0.16794129, 0.092127375,
    0.2574838, 0.09835211, 0.1471659,
    0, 0, 0,
    1.020537, 0.20488252, 0.12730174,
    0.08187646, 0.16919868, 0.27279696,
    1.0348015, 0.37288117, 0.12730174,
    0.8281187, 0.8234973, 0.34505212,
    1.1776302, 0.48927948, 0.12730174,
    -0.16789177, -0.15524504, -0.14622304,
    0.94154775, 0.3069369, 0.12730174,
    0.23423259, 0.14661627, 0.52522445,
    0.4622432, 0.4111955, 0.36288694,
    0.40148693, 0.3414469, 0.28414834,
    0.35317156, 0.16471276, 0.09310118,
    0.2531948, 0.09685037, 0.14654273,
    0, 0, 0,
    0.9916305, 0.20488252, 0.13463067,
    0.1847534, 0.20867075, 0.40876213,
    0.9951501, 0.37288117, 0.13463067,
    0.98390883, 0.94838303, 0.6656353,
    1.1532617, 0.48927948, 0.13463067,
    -0.14133517, -0.11597166, -0.15973707,
    0.6973365, 0.3069369, 0.13463067,
    -0.048675817, -0.056215007, 0.08557244,
    0.46084794, 0.409093, 0.35999975,
    0.39357167, 0.33042976, 0.27152127,
    0.35385284, 0.16151144, 0.09430263,
    0.24913828, 0.09542011, 0.14580669,
    0, 0, 0,
    0.99317014, 0.20488252, 0.13597824,
    0.17786874, 0.18306713, 0.36579123,
    0.9951751, 0.37288117, 0.13597824,
    0.9486769, 0.9201114, 0.79119766,
    1.1929302, 0.48927948, 0.13597824,
    -0.11403372, -0.085645, -0.18025514,
    0.48019728, 0.3069369, 0.13597824,
    -0.033455245, -0.03416036, 0.025348492,
    0.45866317, 0.40646502, 0.3567996,
    0.3858516, 0.31953233, 0.2588927,
    0.35424742, 0.15834719, 0.09569212,
    0.24536012, 0.094079934, 0.1450069,
    0, 0, 0,
    0.9985582, 0.20488252, 0.13093431,
    0.2055872, 0.20247142, 0.3391952,
    0.98666054, 0.37288117, 0.13093431,
    0.887687, 0.86241955, 0.81896096,
    1.2330523, 0.48927948, 0.13093431,
    -0.07434478, -0.044538986, -0.16534676,
    0.4382359, 0.3069369, 0.13093431,
    -0.040186457, -0.038836423, 0.011958875,
    0.45579672, 0.40341917, 0.3533898,
    0.37843445, 0.30887336, 0.2463808,
    0.35429794, 0.15522082, 0.09722407,
    0.24192762, 0.092857465, 0.14420839,
    0, 0, 0,
    0.9964485, 0.20488252, 0.12440865,
    0.23947275, 0.23606803, 0.33882287,
    0.9792859, 0.37288117, 0.12440865,
    0.81238484, 0.78690886, 0.8170941,
    1.2801577, 0.48927948, 0.12440865,
    -0.040406458, -0.012009134, -0.1493789,
    0.3070587, 0.3069369, 0.12440865,
    -0.03336756, -0.0310587, 0.00025096978,
    0.45238528, 0.4000871, 0.3498928,
    0.37145606, 0.29859668, 0.23413469,
    0.35396537, 0.1521363, 0.09886645,
    0.23886915, 0.09176502, 0.14344832,
    0, 0, 0,
    0.9969482, 0.20488252, 0.12153705,
    0.27448428, 0.2745737, 0.34702897,
    0.9665945, 0.37288117, 0.12153705,
    0.7381817, 0.71042347, 0.8058591,
    1.3, 0.48927948, 0.12153705,
    -0.010583935, 0.01600149, -0.140197,
    0.18198583, 0.3069369, 0.12153705,
    -0.026028119, -0.023696609, -0.005059169,
    0.44860226, 0.3966318, 0.34645718,
    0.36494905, 0.28873917, 0.22219583,
    0.3532205, 0.14910044, 0.10059514,
    0.23620585, 0.090812065, 0.14275691,
    0, 0, 0,
    1.0041935, 0.20488252, 0.12411137,
    0.29633948, 0.30173522, 0.34932098,
    0.9430824, 0.37288117, 0.12411137,
    0.67514515, 0.64341104, 0.7922917,
    1.3, 0.48927948, 0.12411137,
    0.019436028, 0.04497513, -0.12868264,
    -0.15965684, 0.3069369, 0.12411137,
    -0.01770994, -0.015682105, -0.0038410479,
    0.44465467, 0.39324486, 0.34325477,
    0.35906357, 0.27945074, 0.21072093,
    0.35202906, 0.14611088, 0.10239085,
    0.23394102, 0.090000816, 0.14214927,
    0, 0, 0,
    1.0175447, 0.20488252, 0.13073024,
    0.30416772, 0.3136202, 0.34935296,
    0.9133209, 0.37288117, 0.13073024,
    0.631156, 0.59761065, 0.77215374,
    1.3, 0.48927948, 0.13073024,
    0.0451323, 0.06895964, -0.10810214,
    -0.6654754, 0.3069369, 0.13073024,
    -0.012758662, -0.011277354, -0.0025264055,
    0.44076562, 0.39012894, 0.34046385,
    0.35379618, 0.27072737, 0.1997154,
    0.35041696, 0.14318965, 0.10425814,
    0.23209414, 0.089339375, 0.14164847,
    0, 0, 0,
    1.0361383, 0.20488252, 0.13909982,
    0.29480425, 0.30879757, 0.3559342,
    0.8890371, 0.37288117, 0.13909982,
    0.631904, 0.59308285, 0.7304364,
    1.3, 0.48927948, 0.13909982,
    0.04509529, 0.06966857, -0.07277081,
    -1.3, 0.3069369, 0.13909982,
    -0.011103076, -0.009626434, 0.00013665896,
    0.4371791, 0.38750312, 0.33827505,
    0.3492314, 0.26265174, 0.18927945,
    0.3483812, 0.14033964, 0.10619628,
    0.23065533, 0.0888241, 0.14125389,
    0, 0, 0,
    1.3, 0.20488252, 0.14738919,
    0.17626095, 0.21116255, 0.25703615,
    1.0565544, 0.37288117, 0.14738919,
    0.5478934, 0.542708, 0.4797172,
    -1.3, 0.48927948, 0.14738919,
    -0.03234849, -0.01772945, 0.005881661,
    0.47514117, 0.3069369, 0.14738919,
    0.2430079, 0.19870074, 0.28337437,
    0.43413872, 0.3855813, 0.3368705,
    0.34532663, 0.25517616, 0.1793811,
    0.34596568, 0.13757952, 0.10822367,
    0.229632, 0.08845797, 0.1409746,
    0, 0, 0,
    1.3, 0.20488252, 0.1503681,
    0.12907061, 0.18296845, 0.2060605,
    1.3, 0.37288117, 0.1503681,
    0.54870296, 0.5161698, 0.49317503,
    -0.12091407, 0.48927948, 0.1503681,
    -0.07099969, -0.022099104, -0.045112617,
    0.3895401, 0.3069369, 0.1503681,
    0.32085422, 0.25592822, 0.36219242,
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
