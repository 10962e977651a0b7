// The measured material film for Unity (Universal Render Pipeline, Unity 6). NOT RUN in Unity: it was written from Unity's documentation, and
// compiled and drawn with functions that stand in for Unity's.
//
// Put this file into a folder below Assets, and create a material of the shader "Measured/Film (URP)". The project must use linear
// colours (Player Settings).
Shader "Measured/Film (URP)"
{
    Properties
    {
        _Tint ("Tint", Color) = (1, 1, 1, 1)
    }

    SubShader
    {
        Tags { "RenderType" = "Opaque" "RenderPipeline" = "UniversalPipeline" }

        Pass
        {
            Tags { "LightMode" = "UniversalForwardOnly" }  // which the deferred renderer draws too
            HLSLPROGRAM
            #pragma target 4.5
            #pragma vertex vert
            #pragma fragment frag
            #pragma multi_compile _ _MAIN_LIGHT_SHADOWS _MAIN_LIGHT_SHADOWS_CASCADE _MAIN_LIGHT_SHADOWS_SCREEN
            #pragma multi_compile _ _ADDITIONAL_LIGHTS
            #pragma multi_compile _ _FORWARD_PLUS _CLUSTER_LIGHT_LOOP  // of Unity 6.0, and of later versions
            #pragma multi_compile_fragment _ _ADDITIONAL_LIGHT_SHADOWS
            #pragma multi_compile_fragment _ _SHADOWS_SOFT _SHADOWS_SOFT_LOW _SHADOWS_SOFT_MEDIUM _SHADOWS_SOFT_HIGH
            #pragma multi_compile_fog
            #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
            #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Lighting.hlsl"

            CBUFFER_START(UnityPerMaterial)
            float4 _Tint;
            CBUFFER_END
            static float3x3 to_local;  // its rows are the axes of the surface's frame in world space; the last one is the normal

            float3x3 frame_about(float3 n)
            {
                float3 t = normalize(abs(n.y) < 0.9 ? cross(float3(0, 1, 0), n) : cross(float3(1, 0, 0), n));
                return float3x3(t, cross(n, t), n);
            }

            // The environment, filtered as for GGX of this roughness: the reflection probe, or for roughness 1 the ambient light and light
            // probes, whose values are irradiance / pi.
            float3 probe_radiance(float3 direction, float roughness)
            {
                float3 in_world = mul(direction, to_local);
                if (roughness >= 1.0) return max(SampleSH(in_world), 0.0);
                return GlossyEnvironmentReflection(in_world, roughness, 1.0);
            }
            #define film_radiance probe_radiance
// HLSL: film_brdf, film_environment, film_environment_lobe, film_radiance.
// Written by srbf; the text is under the MIT License.

#ifndef FILM_BRDF
#define FILM_BRDF

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
    float3 x[3];
};

// The position of a coordinate from 0 to 1 between two of `count` nodes.
struct film_NodesAbout {
    int below;
    float beyond;
};

// A lobe of f_r cos(theta_l) over the light for a view. It reflects with `weight`, which may be negative, the
// radiance in the direction `axis` of an environment that is filtered as for GGX of this roughness viewed along the
// normal.
struct film_LightLobe {
    float3 axis;
    float roughness;
    float3 weight;
};

// The lobes for a view wv above the horizon.
struct film_LightLobes {
    film_LightLobe lobe[6];
};

// The further features of (wl, wv). Only the first `count` are computed, the number in the model's form; the others
// are not read.
film_PmFeatures film_pm_further_features(float3 wl, float3 wv) {
    film_PmFeatures features;
    for (int k = 0; k < 4; ++k) features.x[k] = 0.0;
    features.x[0] = log(max(wl.z, 1.0e-6) * max(wv.z, 1.0e-6));
    float3 sum = wl + wv;
    float squared = max(dot(sum, sum), 1.0e-12);
    float across = (sum.x * sum.x + sum.y * sum.y) / squared;
    float apart = wl.z - wv.z;
    features.x[1] = 0.5 * sqrt(squared) - 1.0;
    features.x[2] = 0.05 - sqrt(apart * apart + 0.0625 * across + 0.0025);
    features.x[3] = -sqrt(across);
    return features;
}

film_AxialPsi film_axial_psi(float3 wl, float3 wv, float a, float b) {
    float3 d = a * wl + b * wv;
    float reciprocal = rsqrt(max(dot(d, d), 1.0e-20));
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

float3 film_light_whole(float3 albedo) { return float3(min(albedo.x, 1.0), min(albedo.y, 1.0), min(albedo.z, 1.0)); }

float3 film_reflected(float3 weight, float3 light) {
    return float3(weight.x * light.x, weight.y * light.y, weight.z * light.z);
}

// A sum of lobes, clamped to 0: it can be slightly negative where nearly all light comes from a few directions.
float3 film_not_negative(float3 sum) { return float3(max(sum.x, 0.0), max(sum.y, 0.0), max(sum.z, 0.0)); }

// The first lobe, the cosine around the normal. Its weight is the total minus all other weights.
film_LightLobe film_cosine_lobe(float3 weight) {
    film_LightLobe lobe;
    lobe.axis = float3(0.0, 0.0, 1.0);
    lobe.roughness = 1.0;
    lobe.weight = weight;
    return lobe;
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

// The weights a, b of each variate.
static const float film_variates[6] = {
    0.42456055, 1.8886719,
    1.1005859, 0.0034179688,
    -0.24902344, 1.3388672
};

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
static const float film_lobes[99] = {
    0.97265625, 0.9975586, 0.95996094, 54.34375, -13.1796875, 23.078125, -16.25, 0.0, -5.8203125, 45.75, 7.5078125,
    0.9980469, 0.16137695, 0.0, -8.8984375, 4.0703125, 4.5234375, -2.3046875, 0.76416016, -6.2773438, 1.6425781, -12.984375,
    0.9995117, 0.59228516, 0.0026817322, -4.8710938, 41.625, 24.09375, 6.6601562, 0.0, -70.25, 14.234375, -2.0039062,
    0.9472656, 0.8388672, 0.69873047, 300.0, 1.7919922, 129.75, -191.75, 0.033172607, -21.390625, 166.0, -12.4140625,
    0.9951172, 0.29174805, 0.33447266, 31.265625, 1.8994141, 32.125, -16.1875, 2.8378906, -22.84375, 38.8125, 5.265625,
    1.0029297, 0.4555664, 0.9736328, 8.8125, 113.0625, 9.2890625, -4.4453125, 0.0, -51.15625, 79.9375, -1.9277344,
    0.99902344, 0.3996582, 0.0, 2.8847656, 3.1875, -3.1796875, 4.7578125, 0.4284668, -10.859375, 6.125, 1.0859375,
    0.9848633, 0.359375, 0.23632812, 127.75, -45.03125, 63.8125, -22.15625, 8.1875, -36.1875, 64.875, -2.0019531,
    0.26953125, 0.17370605, 0.9995117, -5.3320312, 24.546875, 11.7890625, 1.3505859, 0.3828125, -21.359375, 1.6132812, -7.8476562
};

// Directional albedo (R, G, B), a row for each node.
static const float film_albedo_nodes[387] = {
    0.37250504, 0.3434849, 0.29861313,
    0.37250504, 0.3434849, 0.29861313,
    0.37250596, 0.34348595, 0.29861423,
    0.38722882, 0.35631928, 0.3091664,
    0.3987007, 0.36621347, 0.31723058,
    0.4080871, 0.37421077, 0.32368216,
    0.4161127, 0.38095787, 0.3290638,
    0.42316467, 0.38680238, 0.33366886,
    0.42946047, 0.39194143, 0.33766547,
    0.43513232, 0.39649692, 0.34115928,
    0.44024915, 0.40053478, 0.34420964,
    0.44485548, 0.40409973, 0.34685823,
    0.44896394, 0.40720862, 0.34912422,
    0.4525793, 0.40987155, 0.35102126,
    0.4556818, 0.41207734, 0.35254553,
    0.4582707, 0.413832, 0.3537081,
    0.46031654, 0.41511655, 0.3544993,
    0.46182224, 0.41594213, 0.35493606,
    0.46274868, 0.4162801, 0.35499954,
    0.46312004, 0.41616073, 0.35472298,
    0.46293172, 0.4155886, 0.35411754,
    0.46222082, 0.41460526, 0.35322538,
    0.46102104, 0.41324925, 0.35208616,
    0.45938683, 0.41157746, 0.3507544,
    0.45739624, 0.40966725, 0.34930167,
    0.45515317, 0.40761977, 0.34781978,
    0.4527391, 0.4055126, 0.34637752,
    0.4502808, 0.40346378, 0.3450776,
    0.44789332, 0.40157884, 0.34401023,
    0.44570005, 0.3999681, 0.3432672,
    0.44381198, 0.3987278, 0.3429255,
    0.4423269, 0.3979384, 0.34304523,
    0.44131815, 0.39765435, 0.34366068,
    0.44083202, 0.39790097, 0.34477714,
    0.4408766, 0.39866433, 0.34636226,
    0.44142503, 0.39989385, 0.34834835,
    0.44240502, 0.4014932, 0.35062453,
    0.44370955, 0.4033302, 0.35304636,
    0.4451977, 0.40523842, 0.35543734,
    0.44670084, 0.40702394, 0.3575966,
    0.4480373, 0.4084807, 0.3593135,
    0.44902855, 0.40940627, 0.36038202,
    0.4495021, 0.40960678, 0.36060706,
    0.4493088, 0.40891415, 0.35982013,
    0.44832924, 0.40719396, 0.35788748,
    0.44647935, 0.40435192, 0.35471603,
    0.443718, 0.40034196, 0.3502609,
    0.44004285, 0.3951626, 0.34452188,
    0.4354899, 0.38885662, 0.3375427,
    0.43012846, 0.3815056, 0.3294055,
    0.42405388, 0.3732221, 0.3202227,
    0.41738302, 0.36414343, 0.31013072,
    0.41024694, 0.3544231, 0.29928127,
    0.40278584, 0.34422383, 0.28783372,
    0.3951442, 0.33371097, 0.27594942,
    0.3874675, 0.32304773, 0.263786,
    0.37989676, 0.31238872, 0.25149196,
    0.37256768, 0.30187815, 0.23920529,
    0.36564106, 0.2916637, 0.22705705,
    0.3591709, 0.2818296, 0.21514745,
    0.3532587, 0.27246296, 0.20355953,
    0.3480381, 0.26368093, 0.19240415,
    0.34351975, 0.25549218, 0.18170834,
    0.33977577, 0.24795936, 0.17154956,
    0.33680525, 0.24107683, 0.16195108,
    0.33467904, 0.2349025, 0.15299526,
    0.33326387, 0.22931647, 0.1446243,
    0.33260345, 0.22435738, 0.1369195,
    0.33257484, 0.21991761, 0.1298448,
    0.33313918, 0.21596557, 0.12343219,
    0.33416912, 0.2123955, 0.11765559,
    0.335612, 0.20916536, 0.112539224,
    0.33729732, 0.20613518, 0.10802626,
    0.33915362, 0.20324892, 0.104121104,
    0.3410873, 0.20043287, 0.10080552,
    0.34302187, 0.19762687, 0.09806001,
    0.34487262, 0.1947654, 0.095848255,
    0.34659582, 0.19181786, 0.09414721,
    0.3481499, 0.18875471, 0.09291959,
    0.34950498, 0.18556401, 0.09212905,
    0.3506462, 0.18224175, 0.09173106,
    0.3515729, 0.17880546, 0.09168914,
    0.35228512, 0.17527142, 0.091956526,
    0.35277045, 0.17165577, 0.092482515,
    0.3530474, 0.16799998, 0.09323515,
    0.3531137, 0.16432917, 0.094170436,
    0.3529509, 0.16066487, 0.09524753,
    0.35257205, 0.15704475, 0.096445784,
    0.3519604, 0.15349256, 0.097742535,
    0.35112035, 0.15003668, 0.09913018,
    0.35004842, 0.14670041, 0.10060666,
    0.34873116, 0.14349703, 0.10217251,
    0.34719202, 0.14045401, 0.103848755,
    0.3454166, 0.13757633, 0.105642624,
    0.3434265, 0.13487948, 0.10757558,
    0.3412344, 0.13237171, 0.10966301,
    0.3388368, 0.13004838, 0.11190666,
    0.33626094, 0.12791318, 0.11431447,
    0.33350003, 0.12595235, 0.116870925,
    0.33056688, 0.12415705, 0.1195607,
    0.32746875, 0.12251276, 0.12235716,
    0.32420403, 0.120998845, 0.12522219,
    0.3207715, 0.11959375, 0.12811266,
    0.31718424, 0.11828023, 0.13098866,
    0.31343904, 0.11703433, 0.13380086,
    0.30955112, 0.115840204, 0.13651012,
    0.30553213, 0.11468108, 0.13907735,
    0.30141157, 0.1135485, 0.14147714,
    0.2972007, 0.11242871, 0.14367756,
    0.29294604, 0.111322835, 0.14567298,
    0.28866285, 0.11022182, 0.14744289,
    0.28439632, 0.10913046, 0.14899121,
    0.28017983, 0.10805039, 0.15031832,
    0.27604133, 0.10698313, 0.15142587,
    0.27201813, 0.10593527, 0.15232648,
    0.2681318, 0.104908794, 0.15302621,
    0.26440263, 0.1039069, 0.15353434,
    0.26086333, 0.10293943, 0.15387408,
    0.25752753, 0.10200989, 0.15405838,
    0.25440407, 0.10112071, 0.15409951,
    0.2515261, 0.1002856, 0.15403123,
    0.24890156, 0.09950829, 0.15386924,
    0.24654499, 0.09879605, 0.15363577,
    0.2444694, 0.09815589, 0.15335272,
    0.2427156, 0.097606316, 0.15306233,
    0.24130356, 0.09715725, 0.15278986,
    0.24027112, 0.09682584, 0.15257256,
    0.2396331, 0.09661905, 0.15242663,
    0.23942135, 0.0965504, 0.15237822
};

// A row for each node: p, roughness and share of the albedo (R, G, B) of each lobe after the first; width.
static const float film_light_lobes[832] = {
    0.9117028, 0.45879278, 0.8210236, 0.72724754, 0.62599254, 0.9949799, 0.07061848, 0.20986727, 0.23333141, 0.25828338, 0.9775208, 0.16001938, 0.4570132, 0.4714381, 0.48403707, 0.9812103, 0.53088063, -0.83251053, -0.7389134, -0.6292202, 0.999, 0.56163925, 0.31606185, 0.27774313, 0.23074499, 0.008366171,
    0.9117028, 0.45879278, 0.8210245, 0.7272486, 0.6259934, 0.9949799, 0.07061848, 0.20986779, 0.23333406, 0.2582873, 0.9775208, 0.16001938, 0.45701328, 0.4714402, 0.48404035, 0.9812103, 0.53088063, -0.8325088, -0.7389109, -0.6292174, 0.999, 0.56163925, 0.31606328, 0.27774563, 0.23074803, 0.008366171,
    0.9117028, 0.45879278, 0.8210262, 0.72725075, 0.6259951, 0.9949799, 0.07061848, 0.20986882, 0.23333938, 0.25829518, 0.9775208, 0.16001938, 0.45701346, 0.4714444, 0.48404694, 0.9812103, 0.53088063, -0.8325053, -0.73890585, -0.6292118, 0.999, 0.56163925, 0.31606615, 0.27775067, 0.23075414, 0.008574716,
    0.9116742, 0.45878822, 0.8210294, 0.72725445, 0.625998, 0.9949804, 0.07067749, 0.20987178, 0.2333484, 0.25830773, 0.9775194, 0.1600257, 0.45701504, 0.47145164, 0.4840575, 0.9812052, 0.5308871, -0.8324991, -0.73889756, -0.6292027, 0.99900097, 0.5616327, 0.31607166, 0.2777592, 0.2307641, 0.008861202,
    0.91077876, 0.45808077, 0.82104355, 0.7272687, 0.62600845, 0.9953157, 0.06702929, 0.20989013, 0.23338674, 0.25835758, 0.97768974, 0.16001633, 0.4570272, 0.47148252, 0.4840992, 0.98111725, 0.5309607, -0.8324712, -0.7388636, -0.62916714, 0.9990092, 0.5614455, 0.31609786, 0.27779472, 0.23080373, 0.008899701,
    0.91172445, 0.45816463, 0.8211966, 0.7273768, 0.62603116, 0.9954657, 0.06388338, 0.21027115, 0.23405856, 0.2592048, 0.9780986, 0.16025254, 0.4572592, 0.47198686, 0.4847717, 0.98127276, 0.5310826, -0.832037, -0.7383576, -0.6286373, 0.9990516, 0.5615227, 0.3164852, 0.27831122, 0.23139052, 0.00865886,
    0.9119538, 0.45671123, 0.82074714, 0.72586125, 0.62347984, 0.9964073, 0.06085812, 0.21270685, 0.23802382, 0.26421174, 0.97914594, 0.16020398, 0.45820215, 0.4743437, 0.488143, 0.9818164, 0.5300777, -0.8296172, -0.736008, -0.62638205, 0.9992037, 0.56291664, 0.31840554, 0.28062546, 0.23399137, 0.00813383,
    0.91363305, 0.45735812, 0.81057954, 0.7095534, 0.60169715, 0.9973787, 0.05923085, 0.22201398, 0.25151792, 0.2807315, 0.98141587, 0.15991633, 0.4594623, 0.47956994, 0.49655372, 0.98297083, 0.5291022, -0.8242299, -0.7314667, -0.62237525, 0.99962646, 0.565797, 0.3198549, 0.28344673, 0.23806153, 0.0075959624,
    0.91489947, 0.4559173, 0.7695864, 0.6523644, 0.529689, 0.9986326, 0.058819033, 0.25080603, 0.28739268, 0.32182333, 0.9815829, 0.15998651, 0.45956764, 0.4870667, 0.5106415, 0.9832865, 0.52665293, -0.806641, -0.7149365, -0.6064148, 1.0, 0.57018095, 0.32011402, 0.2881714, 0.24678795, 0.0073581683,
    0.91523504, 0.4682835, 0.68424565, 0.5435876, 0.39932176, 0.9998897, 0.06179042, 0.31124607, 0.3539092, 0.3916472, 0.98229814, 0.15993105, 0.45837393, 0.49431032, 0.52569073, 0.9813112, 0.54291105, -0.7599054, -0.66697216, -0.5568194, 1.0, 0.60932416, 0.30041623, 0.2769001, 0.24374487, 0.0078124525,
    0.9107365, 0.46772447, 0.55638355, 0.40094906, 0.2476743, 1.0, 0.059747905, 0.3889619, 0.43586195, 0.4739466, 0.9826314, 0.1597778, 0.42809045, 0.4705916, 0.50764596, 0.9809984, 0.5420659, -0.6539291, -0.5611525, -0.45263356, 1.0, 0.6175891, 0.27379262, 0.2548006, 0.22577383, 0.00912718,
    0.9017992, 0.47845444, 0.42239138, 0.26697588, 0.12017541, 1.0, 0.08384209, 0.4797007, 0.5300957, 0.5683299, 0.98097867, 0.15995792, 0.36814985, 0.41130295, 0.44869977, 0.983071, 0.55657893, -0.49581185, -0.40915638, -0.3118024, 1.0, 0.6431547, 0.21833491, 0.2011892, 0.17561325, 0.0115341935,
    0.8792163, 0.48838404, 0.35909128, 0.20072478, 0.05398565, 1.0, 0.10832637, 0.5270693, 0.5909845, 0.64230835, 0.97993463, 0.1594355, 0.27181813, 0.31596157, 0.35423112, 0.96927655, 0.67795306, -0.2679487, -0.19330722, -0.118690245, 1.0, 0.8804748, 0.10192292, 0.085725844, 0.06876849, 0.015378586,
    0.8811776, 0.46649113, 0.3512779, 0.18047029, 0.02340714, 1.0, 0.15209289, 0.5723316, 0.6511231, 0.72021186, 0.97273827, 0.15995811, 0.1939904, 0.24366741, 0.28448114, 0.97721255, 0.66167855, -0.17389521, -0.11401062, -0.060569968, 1.0, 1.0, 0.045362126, 0.037302576, 0.032720804, 0.020498192,
    0.8960675, 0.4527413, 0.4756137, 0.25827867, 0.042900015, 1.0062996, 0.15996678, 0.5009302, 0.5926902, 0.68454343, 0.9750006, 0.1827073, 0.17981468, 0.25194, 0.313811, 0.97570825, 0.6569375, -0.20771633, -0.1363406, -0.06886429, 1.0062996, 1.0, 0.036606666, 0.029732298, 0.02677794, 0.027905876,
    0.90984225, 0.41973197, 0.59980714, 0.36926898, 0.116361916, 1.0265164, 0.17791113, 0.31447548, 0.40048978, 0.498129, 0.9892643, 0.16780037, 0.24291213, 0.35229495, 0.46113095, 0.9998458, 0.64032537, -0.21689619, -0.16234714, -0.111879386, 1.0027623, 1.0, 0.043950506, 0.03658852, 0.03663253, 0.03851579,
    0.9234861, 0.38836285, 0.65234584, 0.42648494, 0.15725902, 1.0351843, 0.2472501, 0.2359822, 0.3107189, 0.3857534, 0.9965757, 0.16431075, 0.23794886, 0.38135207, 0.5552903, 1.0365711, 0.64038193, -0.20881636, -0.18045887, -0.14958876, 1.030734, 1.0, 0.06321507, 0.05616504, 0.051971633, 0.051218323,
    0.9338211, 0.34891728, 0.6034143, 0.39105606, 0.1824158, 1.0123937, 0.33843854, 0.28393188, 0.34151024, 0.29350257, 1.0110561, 0.16004023, 0.18269496, 0.34532204, 0.5889883, 1.0778962, 0.6410365, -0.15847547, -0.14042225, -0.09720915, 1.0669813, 1.0, 0.064471684, 0.053399883, 0.03226333, 0.06632742,
    0.94278234, 0.3452004, 0.52963257, 0.33586842, 0.2985645, 1.0035123, 0.36663467, 0.40916887, 0.45136565, 0.22754177, 1.0110567, 0.16001281, 0.14573029, 0.29978725, 0.5326833, 1.0929103, 0.63655436, -0.1616563, -0.13864224, -0.076900415, 1.0777973, 1.0, 0.05492537, 0.0425517, 0.017686307, 0.081899166,
    0.94930047, 0.3411267, 0.46695375, 0.29076633, 0.44064805, 1.0051211, 0.37163496, 0.5151657, 0.5460006, 0.17178918, 1.0107208, 0.17636557, 0.116709486, 0.26232204, 0.4633156, 1.1054934, 0.6401627, -0.16465946, -0.14326876, -0.10033522, 1.1004002, 1.0, 0.044930022, 0.034701906, 0.025257103, 0.09609184,
    0.94507504, 0.3378427, 0.40207675, 0.24575415, 0.540502, 1.0227133, 0.37402597, 0.52810085, 0.5376072, 0.14290632, 1.0158432, 0.2346975, 0.16879745, 0.32060632, 0.46509364, 1.1789287, 0.58075356, -0.1538476, -0.14804935, -0.28646192, 1.2447238, 0.6204848, 0.033557665, 0.032524392, 0.13589312, 0.10543123,
    0.94500536, 0.318427, 0.31747553, 0.19646984, 0.5742188, 1.0106244, 0.35994154, 0.5149789, 0.48926747, 0.21686105, 1.0286564, 0.29128122, 0.2304218, 0.3801261, 0.44940436, 1.1785455, 0.5189205, -0.073329486, -0.06607758, -0.3520398, 1.3, 0.6179637, -0.012137518, -0.014380746, 0.106747165, 0.113466844,
    0.9611858, 0.31015798, 0.2767171, 0.19350523, 0.5672398, 0.99952424, 0.36002725, 0.4893765, 0.43729165, 0.27530128, 1.027918, 0.3162744, 0.2872009, 0.4031645, 0.41946137, 1.195303, 0.5185963, -0.059828207, -0.015165882, -0.39602873, 1.3, 0.64240116, -0.015374074, -0.03431489, 0.1300216, 0.11868069,
    0.98127484, 0.30395854, 0.26238257, 0.2161567, 0.5584444, 1.0019112, 0.36007982, 0.4667889, 0.4113986, 0.31763524, 1.0194632, 0.33272406, 0.3319759, 0.39579365, 0.40876, 1.2064435, 0.5007595, -0.07834063, -0.012782075, -0.39786744, 1.3, 0.6772283, -0.006062122, -0.030171663, 0.11166043, 0.12324906,
    0.9884586, 0.27672908, 0.2485854, 0.2326003, 0.5335643, 1.0120915, 0.3599703, 0.44885764, 0.4041359, 0.33918244, 1.0238616, 0.35015568, 0.36598656, 0.39353836, 0.39652732, 1.2424302, 0.46957555, -0.08844131, -0.046893165, -0.32028753, 1.3, 0.76720667, 0.00053718715, -0.0073515046, 0.05463346, 0.12689176,
    0.9933055, 0.25702953, 0.23975238, 0.24176084, 0.5166851, 1.0311885, 0.3598922, 0.44031268, 0.40528497, 0.35552427, 1.0319273, 0.36000288, 0.38839978, 0.3992176, 0.39139304, 1.3, 0.42593434, -0.09341464, -0.07412436, -0.26916382, 1.3, 1.0, -0.0012221568, 0.001364132, 0.011257901, 0.12799941,
    0.9961859, 0.25229514, 0.24135631, 0.25508162, 0.52238125, 1.0313752, 0.35815987, 0.41903228, 0.3934562, 0.37447196, 1.0321375, 0.3597196, 0.38488021, 0.39056808, 0.39782283, 1.3, 0.41839543, -0.074848875, -0.075013876, -0.30198428, 1.234338, 1.0, 0.00028654977, 0.007344145, 0.013550492, 0.13098653,
    0.9994652, 0.24833414, 0.2419446, 0.26467434, 0.5127847, 1.0189059, 0.35995403, 0.3904708, 0.3753667, 0.3879643, 1.0118886, 0.35977936, 0.36492318, 0.37460145, 0.40545374, 1.3, 0.42577708, -0.02950866, -0.055680104, -0.321441, 1.0743562, 1.0, 0.0006927306, 0.01372958, 0.026862536, 0.13755262,
    0.9975822, 0.24943174, 0.23645389, 0.27334064, 0.5175982, 1.0111068, 0.3594939, 0.37746426, 0.3661586, 0.4002946, 1.0043647, 0.35998073, 0.35860655, 0.36678094, 0.4151455, 1.3, 0.4254316, -0.010488957, -0.053481456, -0.35401067, 1.0442731, 1.0, 0.0035546399, 0.018875834, 0.03515606, 0.14731723,
    0.9973042, 0.24602117, 0.22269076, 0.26918814, 0.49874425, 0.96612704, 0.35989472, 0.37044293, 0.3570226, 0.39258552, 0.9595644, 0.3593163, 0.35537848, 0.35727292, 0.40452304, 1.3, 0.43987983, 0.007093536, -0.036516283, -0.3235597, 0.74693215, 1.0, 0.017598933, 0.03762732, 0.0625271, 0.15784518,
    0.9869107, 0.24506825, 0.20184508, 0.25867334, 0.476596, 0.9488139, 0.35996765, 0.38726765, 0.36078775, 0.37292182, 0.94256914, 0.3599888, 0.3759686, 0.3609345, 0.38236067, 1.3, 0.46789065, -0.020506358, -0.04088298, -0.26524857, 0.90239215, 1.0, 0.028114812, 0.037780512, 0.053774316, 0.16639271,
    0.9983455, 0.21757738, 0.1516637, 0.2115113, 0.37630793, 0.90772665, 0.3600028, 0.40938523, 0.37443078, 0.35125208, 0.904248, 0.3600479, 0.4003012, 0.37452933, 0.35884526, 1.2209816, 0.64217377, -0.031206494, -0.03289062, -0.13273333, 1.3, 1.0, 0.023504589, 0.029819576, 0.040952854, 0.1694278
};

float film_pm_with_variate(int j, int n, float exponent, float squared_distance_) {
    return exponent - 0.7213475204444817 * abs(film_lobes[11 * j + 4 + n]) * squared_distance_;
}

float film_pm_with_features(int j, float exponent, film_PmFeatures features) {
    float sum = exponent;
    for (int k = 0; k < 4; ++k) sum = sum + 1.4426950408889634 * film_lobes[11 * j + 7 + k] * features.x[k];
    return sum;
}

film_PmVariates film_pm_variates_of(float3 wl, float3 wv) {
    film_PmVariates of_pair;
    for (int n = 0; n < 3; ++n) {
        film_AxialPsi psi_ = film_axial_psi(wl, wv, film_variates[2 * n], film_variates[2 * n + 1]);
        of_pair.x[n] = float3(film_squared_distance_from_pole(psi_, 1.0), film_squared_distance_from_pole(psi_, -1.0),
                0.0);
    }
    return of_pair;
}

// Lobe j with the terms of its variates, from the exponent of its scale and features on.
float film_pm_lobe(int j, float exponent, film_PmVariates of_pair) {
    float sum = exponent;
    for (int n = 0; n < 3; ++n)
        sum = film_pm_with_variate(j, n, sum, film_lobes[11 * j + 4 + n] < 0.0 ? of_pair.x[n].y : of_pair.x[n].x);
    return film_pm_power(sum);
}

// g(wl, wv) = sum_j beta_j e^(s_j) prod_n G(psi_n . xi_jn | lambda_jn) prod_k e^(kappa_jk x_k(wl, wv)) [1/sr], for
// R, G, B. Here psi_n = normalize(a_n wl + b_n wv), and x_k are the further features, which are symmetric.
// rho(wl, wv) = g(wl, wv), or the mean of g(wl, wv) and g(wv, wl) in a reciprocal model. A negative sum counts as 0:
// the colour of a spectral model's lobe may have a negative channel.
float3 film_pm_value(float3 wl, float3 wv) {
    film_PmVariates of_pair = film_pm_variates_of(wl, wv);
    film_PmVariates exchanged = film_pm_variates_of(wv, wl);
    film_PmFeatures features = film_pm_further_features(wl, wv);
    float3 sum = float3(0.0, 0.0, 0.0);
    for (int j = 0; j < 9; ++j) {
        float exponent = film_pm_with_features(j, 1.4426950408889634 * film_lobes[11 * j + 3], features);
        float power = film_pm_lobe(j, exponent, of_pair);
        power = 0.5 * (power + film_pm_lobe(j, exponent, exchanged));
        sum = sum + power * float3(film_lobes[11 * j], film_lobes[11 * j + 1], film_lobes[11 * j + 2]);
    }
    return float3(max(sum.x, 0.0), max(sum.y, 0.0), max(sum.z, 0.0));
}

// The BRDF f_r [1/sr] in linear sRGB, without the cosine: multiply by wl.z and by the irradiance of the light on a
// surface that faces it. wl points to the light and wv to the viewer: unit vectors in the local frame, whose z is the
// shading normal. 0 where one of them is not above the horizon, or has a NaN.
float3 film_brdf(float3 wl, float3 wv) {
    if (!(0.0 < wl.z && 0.0 < wv.z && dot(wl, wl) + dot(wv, wv) < 1.0e30)) return float3(0.0, 0.0, 0.0);
    return film_pm_value(wl, wv);
}

float3 film_albedo_node(int i) {
    return float3(film_albedo_nodes[3 * i], film_albedo_nodes[3 * i + 1], film_albedo_nodes[3 * i + 2]);
}

// The integral of f_r cos(theta_l) over the directions to the light, for R, G, B, at the cosine of the view to the
// normal; 0 unless that is above 0.
float3 film_directional_albedo(float cosine) {
    if (!(0.0 < cosine)) return float3(0.0, 0.0, 0.0);
    film_NodesAbout nodes = film_nodes_about(film_elevation_coordinate(cosine), 129);
    return (1.0 - nodes.beyond) * film_albedo_node(nodes.below) + nodes.beyond * film_albedo_node(nodes.below + 1);
}

float film_light_number(int i, film_NodesAbout nodes) {
    int at = 26 * nodes.below + i;
    return film_light_lobes[at] + nodes.beyond * (film_light_lobes[at + 26] - film_light_lobes[at]);
}

float3 film_light_shape(int k, film_NodesAbout nodes) {
    return float3(film_light_number(5 * k - 5, nodes), film_light_number(5 * k - 4, nodes), 0.0);
}

float3 film_light_weight(int k, float3 whole, film_NodesAbout nodes) {
    return float3(whole.x * film_light_number(5 * k - 3, nodes), whole.y * film_light_number(5 * k - 2, nodes),
            whole.z * film_light_number(5 * k - 1, nodes));
}

// The radiance that a view reflects under radiance 1 from all directions.
float3 film_reflected_of_one(float3 wv) { return film_light_whole(film_directional_albedo(wv.z)); }

// A lobe after the first; `whole` is reflected_of_one.
film_LightLobe film_lobe_about(float3 wv, int k, film_NodesAbout nodes, float3 whole) {
    float3 shape = film_light_shape(k, nodes);
    float p = shape.x;
    film_LightLobe lobe;
    lobe.axis = float3(-p * wv.x, -p * wv.y, sqrt(max(1.0 - p * p * (1.0 - wv.z * wv.z), 0.0)));
    lobe.roughness = shape.y;
    lobe.weight = film_light_weight(k, whole, nodes);
    return lobe;
}

film_LightLobes film_lobes_about(float3 wv) {
    film_NodesAbout nodes = film_nodes_about(film_elevation_coordinate(wv.z), 32);
    float3 whole = film_reflected_of_one(wv);
    float3 cosine_weight = whole;
    film_LightLobes of_view;
    for (int k = 1; k < 6; ++k) {
        of_view.lobe[k] = film_lobe_about(wv, k, nodes, whole);
        cosine_weight = cosine_weight - of_view.lobe[k].weight;
    }
    of_view.lobe[0] = film_cosine_lobe(cosine_weight);
    return of_view;
}

// Lobe k of them.
film_LightLobe film_environment_lobe(float3 wv, int k) {
    film_NodesAbout nodes = film_nodes_about(film_elevation_coordinate(wv.z), 32);
    float3 whole = film_reflected_of_one(wv);
    if (k > 0) return film_lobe_about(wv, k, nodes, whole);
    float3 cosine_weight = whole;
    for (int j = 1; j < 6; ++j) cosine_weight = cosine_weight - film_light_weight(j, whole, nodes);
    return film_cosine_lobe(cosine_weight);
}

// film_radiance: The radiance of the environment, which the host supplies: in a direction of the local frame, filtered
// as for GGX
// of a roughness, as in an engine's maps. At roughness 1 it is irradiance / pi. Lobes are fitted to maps of 6
// levels, in which level 5 sqrt(roughness) is looked up, linearly between levels.
#ifndef film_radiance
float3 film_radiance(float3 direction, float roughness);
#endif

// The radiance that leaves towards the viewer.
float3 film_environment(float3 wv) {
    float3 sum = float3(0.0, 0.0, 0.0);
    if (wv.z <= 0.0) return sum;
    film_LightLobes of_view = film_lobes_about(wv);
    sum = film_reflected(of_view.lobe[0].weight, film_radiance(of_view.lobe[0].axis, 1.0));
    for (int k = 1; k < 6; ++k)
        sum = sum + film_reflected(of_view.lobe[k].weight, film_radiance(of_view.lobe[k].axis,
                of_view.lobe[k].roughness));
    return film_not_negative(sum);
}

#endif


            struct Attributes
            {
                float4 position : POSITION;
                float3 normal : NORMAL;
            };
            struct Interpolated
            {
                float4 pos : SV_POSITION;
                float3 position : TEXCOORD0;  // in world space
                float3 normal : TEXCOORD1;
                float fog : TEXCOORD2;
            };

            Interpolated vert(Attributes v)
            {
                Interpolated o;
                o.position = TransformObjectToWorld(v.position.xyz);
                o.pos = TransformWorldToHClip(o.position);
                o.normal = TransformObjectToWorldNormal(v.normal);
                o.fog = ComputeFogFactor(o.pos.z);
                return o;
            }

            // Unity's own diffuse term lacks 1/pi, therefore the factor pi. `place` has the light's direction or position in `float`; that of
            // Light is in `half`, whose steps show beside a sharp highlight.
            float3 reflected(Light light, float4 place, float3 position, float3 wv)
            {
                float3 wl = mul(to_local, normalize(place.xyz - position * place.w));
                return PI * film_brdf(wl, wv) * max(wl.z, 0.0) * light.color * light.distanceAttenuation * light.shadowAttenuation;
            }
            float3 reflected(uint i, float3 position, float3 wv)
            {
                Light light = GetAdditionalLight(i, position, half4(1, 1, 1, 1));
                #if !defined(_FORWARD_PLUS) && !defined(_CLUSTER_LIGHT_LOOP)
                i = GetPerObjectLightIndex(i);
                #endif
                return reflected(light, _AdditionalLightsPosition[i], position, wv);
            }

            // Unity's loop about the additional lights reads a variable of this name.
            float3 reflected_of_additional(InputData inputData, float3 wv)
            {
                float3 radiance = 0;
                #if defined(_FORWARD_PLUS) || defined(_CLUSTER_LIGHT_LOOP)  // whose loop leaves out directional lights beside the main one
                for (uint i = 0; i < min(URP_FP_DIRECTIONAL_LIGHTS_COUNT, MAX_VISIBLE_LIGHTS); ++i)
                    radiance += reflected(i, inputData.positionWS, wv);
                #endif
                uint count = GetAdditionalLightsCount();
                LIGHT_LOOP_BEGIN(count)
                    radiance += reflected(lightIndex, inputData.positionWS, wv);
                LIGHT_LOOP_END
                return radiance;
            }

            float4 frag(Interpolated i) : SV_Target
            {
                // An interpolated normal may face away from the viewer; it is turned back.
                float3 viewer = normalize(GetWorldSpaceViewDir(i.position)), normal = normalize(i.normal);
                to_local = frame_about(normalize(normal + max(0.01 - dot(normal, viewer), 0.0) * viewer));
                float3 wv = mul(to_local, viewer);
                InputData inputData = (InputData)0;
                inputData.positionWS = i.position;
                inputData.normalizedScreenSpaceUV = GetNormalizedScreenSpaceUV(i.pos);
                #ifdef _MAIN_LIGHT_SHADOWS_SCREEN
                float4 shadow = float4(inputData.normalizedScreenSpaceUV, 0, 1);
                #else
                float4 shadow = TransformWorldToShadowCoord(i.position);
                #endif
                float3 radiance = film_environment(wv) + reflected(GetMainLight(shadow), _MainLightPosition, i.position, wv);
                radiance += reflected_of_additional(inputData, wv);
                return float4(MixFog(_Tint.rgb * radiance, i.fog), 1);
            }
            ENDHLSL
        }

        UsePass "Universal Render Pipeline/Lit/ShadowCaster"
        UsePass "Universal Render Pipeline/Lit/DepthOnly"
        UsePass "Universal Render Pipeline/Complex Lit/DepthNormalsOnly"  // which the deferred renderer draws too
        UsePass "Universal Render Pipeline/Lit/MotionVectors"
    }
}
