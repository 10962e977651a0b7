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

// The weights a, b of each variate.
static const float film_variates[6] = {
    1.4121094, 1.4189453,
    1.5332031, -1.1298828,
    1.1191406, 0.06500244
};

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
static const float film_lobes[99] = {
    0.88427734, 1.0205078, 0.9116211, 124.0625, 105.125, -6.9648438, -57.8125, 0.0, 52.3125, 55.625, -0.9609375,
    0.99316406, 0.15844727, 0.0, -22.859375, 15.234375, 0.55859375, 1.8173828, 0.23791504, -5.1953125, 0.53222656, -29.28125,
    1.0058594, 0.0034332275, 0.25195312, 49.25, -23.03125, -2.578125, 51.21875, 1.4638672, -48.1875, 30.5625, 6.3046875,
    1.0009766, 0.35302734, 0.0, -5.453125, 11.9375, -0.40698242, -0.20080566, 0.0, -4.7421875, 0.7807617, -5.046875,
    1.0087891, 0.47485352, 0.85546875, 168.625, 101.3125, -0.47827148, -83.5625, 0.0, 77.4375, 93.6875, 8.125,
    0.9824219, 0.8808594, 0.66552734, 81.3125, 61.40625, 7.1875, -53.40625, 0.14477539, 21.234375, 13.5078125, -27.65625,
    1.0009766, 0.45043945, 0.58740234, -4.515625, 18.5625, 0.7836914, 3.9199219, 5.3710938, -17.765625, -1.2929688, -5.7773438,
    0.99365234, 0.5185547, 0.04257202, 27.828125, -13.0546875, -3.4453125, 42.8125, 0.70703125, -47.0625, 23.75, 2.5058594,
    0.9301758, 0.9926758, 0.96435547, 57.625, 68.25, 1.6035156, -33.28125, 0.0, 18.796875, 20.203125, -13.6796875
};

// Directional albedo (R, G, B), a row for each node.
static const float film_albedo_nodes[387] = {
    0.29545495, 0.27229992, 0.23382708,
    0.29545495, 0.27229992, 0.23382708,
    0.29545453, 0.27229962, 0.23382719,
    0.31511274, 0.28981778, 0.24704352,
    0.33260888, 0.30539393, 0.25879163,
    0.3483284, 0.31937546, 0.26933542,
    0.36273217, 0.33217517, 0.27898815,
    0.3760802, 0.34402627, 0.28792828,
    0.38851935, 0.35506052, 0.2962581,
    0.4001284, 0.36534914, 0.30403462,
    0.4109367, 0.37491882, 0.3112817,
    0.4209409, 0.3837674, 0.31800237,
    0.43010998, 0.39186776, 0.3241811,
    0.43839607, 0.39917824, 0.3297923,
    0.44573605, 0.40564293, 0.3348,
    0.45206293, 0.41120258, 0.33916676,
    0.45730916, 0.4157974, 0.34285548,
    0.46138155, 0.41934785, 0.34581614,
    0.46433783, 0.42189902, 0.34809113,
    0.46606335, 0.42334998, 0.34961334,
    0.4665968, 0.42373568, 0.3504223,
    0.46597654, 0.4230886, 0.35055438,
    0.46429065, 0.4214857, 0.35008073,
    0.46166277, 0.4190335, 0.3490938,
    0.45820224, 0.41582686, 0.34767526,
    0.45417377, 0.41210648, 0.34602287,
    0.4497915, 0.40805033, 0.3442786,
    0.44527417, 0.4038529, 0.34259588,
    0.44089523, 0.39975715, 0.3411626,
    0.4369104, 0.39598992, 0.34014904,
    0.43355283, 0.3927598, 0.33970454,
    0.431024, 0.39024955, 0.33995035,
    0.42947143, 0.38859642, 0.34096226,
    0.42898095, 0.3878846, 0.34276435,
    0.42956242, 0.38813347, 0.34531823,
    0.43114957, 0.38929567, 0.34852195,
    0.43359706, 0.39124978, 0.35220814,
    0.436699, 0.39381614, 0.35615987,
    0.44019786, 0.3967614, 0.36011794,
    0.4438007, 0.39981267, 0.36379564,
    0.44720322, 0.40268034, 0.3669001,
    0.45010975, 0.4050733, 0.36914903,
    0.45225382, 0.40671968, 0.3702901,
    0.45341206, 0.4073812, 0.37011278,
    0.45341653, 0.40686765, 0.36846045,
    0.45216465, 0.40504768, 0.36523893,
    0.4496157, 0.4018487, 0.3604131,
    0.44579342, 0.3972612, 0.35400966,
    0.44077793, 0.39133263, 0.34610897,
    0.4346976, 0.38416174, 0.33683825,
    0.42771855, 0.37588894, 0.32636178,
    0.42003456, 0.3666873, 0.31487128,
    0.41185495, 0.3567508, 0.30257523,
    0.40339252, 0.34628183, 0.2896867,
    0.39485645, 0.33548445, 0.27641788,
    0.3864406, 0.3245517, 0.26296803,
    0.37832007, 0.31366193, 0.249521,
    0.37064585, 0.30297363, 0.2362411,
    0.36358258, 0.29264188, 0.22327542,
    0.357154, 0.2827397, 0.21073385,
    0.35145235, 0.2733591, 0.1987153,
    0.34655446, 0.26458958, 0.18731067,
    0.34244016, 0.25643152, 0.17654769,
    0.3391324, 0.24892461, 0.16648582,
    0.33657968, 0.24203925, 0.1571263,
    0.3348169, 0.23581977, 0.14852482,
    0.33368793, 0.23014201, 0.14061072,
    0.33320498, 0.22502555, 0.13342439,
    0.33325288, 0.22038035, 0.12691773,
    0.33379832, 0.21618293, 0.12109501,
    0.334713, 0.21232718, 0.11589624,
    0.33598006, 0.20880127, 0.11133262,
    0.3374593, 0.20548974, 0.10733344,
    0.33910513, 0.20235457, 0.10388461,
    0.34084532, 0.1993356, 0.10095293,
    0.34262964, 0.1963925, 0.09851507,
    0.34438172, 0.19346361, 0.096528925,
    0.3460705, 0.19052678, 0.09497636,
    0.34764236, 0.18754002, 0.09382103,
    0.3490698, 0.18449187, 0.093042456,
    0.35031322, 0.18135563, 0.09260576,
    0.35136336, 0.17813857, 0.09249491,
    0.35220045, 0.17483728, 0.09268208,
    0.35279322, 0.17144714, 0.09313403,
    0.353158, 0.16800159, 0.09384177,
    0.3532812, 0.16451074, 0.094776675,
    0.35314423, 0.16098957, 0.09591055,
    0.35276285, 0.15747209, 0.09722926,
    0.35212797, 0.15398426, 0.09870998,
    0.35124555, 0.15055346, 0.10033367,
    0.35012144, 0.1472109, 0.102083266,
    0.34874183, 0.14397277, 0.103933245,
    0.34713653, 0.14087713, 0.10587847,
    0.34528688, 0.1379326, 0.10789194,
    0.34321004, 0.13515918, 0.10996277,
    0.34092027, 0.13257393, 0.11208019,
    0.33840758, 0.13017374, 0.114221446,
    0.33569774, 0.12796412, 0.11637968,
    0.33278477, 0.12593226, 0.11853398,
    0.32968807, 0.12407012, 0.12067503,
    0.32642356, 0.12236118, 0.122791424,
    0.32300007, 0.120781, 0.1248693,
    0.31943265, 0.119305186, 0.12689857,
    0.31575257, 0.11791324, 0.12887853,
    0.31197348, 0.11657759, 0.13080223,
    0.30813172, 0.11528388, 0.13267705,
    0.30425674, 0.114019, 0.13450998,
    0.30039304, 0.1127822, 0.13631883,
    0.29656106, 0.11157277, 0.13811138,
    0.29280624, 0.11040515, 0.13990994,
    0.28912985, 0.109286, 0.14171219,
    0.28554985, 0.10823305, 0.14352337,
    0.28205392, 0.10725463, 0.14532712,
    0.27861327, 0.106353156, 0.14709343,
    0.27520093, 0.105527155, 0.1487887,
    0.27177557, 0.10476492, 0.15036659,
    0.26830435, 0.10405142, 0.15178223,
    0.26478782, 0.10337822, 0.1530111,
    0.26122698, 0.102730915, 0.154026,
    0.25763872, 0.10209634, 0.15480876,
    0.2540854, 0.1014763, 0.15537198,
    0.25061274, 0.10086414, 0.15571535,
    0.24728772, 0.10026216, 0.15585542,
    0.24418326, 0.09967642, 0.15581523,
    0.24141572, 0.09913351, 0.15565363,
    0.2390844, 0.09865672, 0.15542156,
    0.23731425, 0.09828395, 0.15519425,
    0.23619401, 0.09804123, 0.15502274,
    0.23581372, 0.0979586, 0.15496238
};

// A row for each node: p, roughness and share of the albedo (R, G, B) of each lobe after the first; width.
static const float film_light_lobes[832] = {
    0.9944491, 0.05, 0.23627998, 0.25126097, 0.2924176, 0.8511918, 0.4690237, 0.71747935, 0.5968434, 0.476594, 0.97512656, 0.15998279, 0.4015752, 0.46460852, 0.49113682, 0.95481384, 0.62074417, -0.538315, -0.47171777, -0.3895782, 0.9987035, 0.6400643, 0.18077438, 0.16183604, 0.13392437, 0.008585204,
    0.9944491, 0.05, 0.23627561, 0.25125563, 0.29241136, 0.8511918, 0.4690237, 0.7174756, 0.5968396, 0.47658968, 0.97512656, 0.15998279, 0.40157074, 0.46460325, 0.49113056, 0.95481384, 0.62074417, -0.53831935, -0.47172242, -0.38958314, 0.9987035, 0.6400643, 0.18076992, 0.16183075, 0.1339185, 0.008585204,
    0.99446857, 0.05, 0.23626685, 0.25124493, 0.29239884, 0.8516348, 0.46849447, 0.71746796, 0.5968319, 0.476581, 0.97541076, 0.16001208, 0.40156177, 0.46459267, 0.49111795, 0.9545382, 0.6218577, -0.53832805, -0.47173178, -0.38959306, 0.9986742, 0.6400026, 0.18076096, 0.16182014, 0.1339067, 0.009084012,
    0.99446857, 0.05, 0.2362579, 0.25123414, 0.292386, 0.8516348, 0.46849447, 0.7174583, 0.59682256, 0.47657043, 0.97541076, 0.16001208, 0.40155205, 0.4645816, 0.4911046, 0.9545382, 0.6218577, -0.5383386, -0.47174263, -0.38960436, 0.9986742, 0.6400026, 0.18075094, 0.16180861, 0.13389394, 0.009894682,
    0.99447024, 0.05, 0.23624355, 0.251218, 0.29236588, 0.8516113, 0.46854648, 0.7174291, 0.5967964, 0.47654176, 0.97544086, 0.15999755, 0.40153274, 0.4645622, 0.49108014, 0.95456034, 0.6218939, -0.53836733, -0.47176936, -0.38963026, 0.9986876, 0.64000535, 0.18072931, 0.16178565, 0.13386932, 0.010096402,
    0.99494445, 0.05, 0.23629825, 0.2512959, 0.29242602, 0.8573333, 0.470951, 0.7170074, 0.59643424, 0.47615823, 0.97646815, 0.15998425, 0.40146258, 0.46454403, 0.49102232, 0.95806885, 0.6213596, -0.5387223, -0.47206354, -0.38987577, 0.9990516, 0.6400831, 0.18059243, 0.16166617, 0.1337572, 0.009594164,
    0.99621886, 0.05, 0.23915865, 0.25428104, 0.2953965, 0.8639159, 0.4744089, 0.7139743, 0.59357476, 0.47311845, 0.97850835, 0.159986, 0.4029845, 0.46642247, 0.4926862, 0.9634669, 0.61427057, -0.5407713, -0.47374058, -0.39105934, 0.9992037, 0.6398328, 0.18102449, 0.1621822, 0.13439007, 0.008643894,
    0.9972454, 0.05, 0.25571167, 0.27050412, 0.3116067, 0.8854337, 0.48918793, 0.6978084, 0.57672775, 0.4549107, 0.9808046, 0.15998466, 0.4120208, 0.47609186, 0.50133276, 0.9731605, 0.6015194, -0.5515891, -0.48281223, -0.39757538, 0.99962646, 0.63067544, 0.18137233, 0.16345288, 0.13661784, 0.0076584704,
    0.9983556, 0.05559508, 0.29345563, 0.3078697, 0.3507827, 0.8948923, 0.49178085, 0.65227383, 0.52685827, 0.39953607, 0.98133594, 0.15998513, 0.42322293, 0.48910144, 0.5131998, 0.97550416, 0.5932289, -0.56686044, -0.4948965, -0.40475634, 1.0, 0.6334242, 0.19146423, 0.1745443, 0.14824177, 0.0074580126,
    0.9999493, 0.06512814, 0.3577495, 0.3712352, 0.41627222, 0.90628564, 0.5008173, 0.5754144, 0.44144514, 0.3058293, 0.9818913, 0.15998843, 0.4291373, 0.4959288, 0.5166765, 0.97882193, 0.58313197, -0.57386625, -0.4952629, -0.39657295, 1.0, 0.6391812, 0.20389438, 0.18884704, 0.1628702, 0.008227875,
    1.0, 0.064917184, 0.42858973, 0.44608325, 0.49638763, 0.9060831, 0.5013851, 0.49376547, 0.34975415, 0.20826942, 0.9817984, 0.15997557, 0.39583346, 0.4624589, 0.47894758, 0.9791369, 0.58193624, -0.5398751, -0.4549108, -0.34995073, 1.0, 0.6399984, 0.21254079, 0.19707322, 0.169026, 0.009989156,
    1.0, 0.07663896, 0.50325954, 0.53124905, 0.59036523, 0.90197533, 0.50331104, 0.43610123, 0.28082284, 0.13549541, 0.9807077, 0.15994506, 0.33203217, 0.3936876, 0.40399313, 0.97703016, 0.5858242, -0.45478103, -0.36581916, -0.26287973, 1.0, 0.6482259, 0.17371304, 0.15956962, 0.13423438, 0.012884042,
    1.0, 0.14126709, 0.56786036, 0.61802006, 0.69505614, 0.88573074, 0.50091666, 0.40486142, 0.2346286, 0.08164249, 0.97557265, 0.1599472, 0.23142216, 0.2883655, 0.29644787, 0.95639676, 0.6624459, -0.27653992, -0.1938947, -0.11453474, 0.99737906, 0.9856845, 0.06308074, 0.05317788, 0.04342927, 0.017163604,
    1.0, 0.15889873, 0.5940892, 0.6654515, 0.7656398, 0.88022995, 0.4972317, 0.406361, 0.22406916, 0.056929164, 0.9717647, 0.15987638, 0.1808258, 0.22951475, 0.22927432, 0.9558748, 0.6765037, -0.24189728, -0.1600903, -0.08459828, 1.0, 1.0, 0.04918836, 0.039856363, 0.03338142, 0.023050401,
    1.0062996, 0.15998949, 0.511216, 0.6060554, 0.74611646, 0.8932303, 0.47113276, 0.48801976, 0.27413666, 0.06655418, 0.9734227, 0.21107188, 0.20188342, 0.26162696, 0.25523075, 0.9696094, 0.66654474, -0.26739135, -0.18798797, -0.102926135, 1.0055169, 1.0, 0.052685786, 0.043406885, 0.034769658, 0.031050304,
    1.0253378, 0.17481701, 0.30915746, 0.41847473, 0.5867228, 0.9113819, 0.43517163, 0.6246717, 0.40104654, 0.15263268, 0.9871059, 0.16010295, 0.25751758, 0.32912064, 0.3532414, 0.99256265, 0.64219254, -0.25621974, -0.19321415, -0.1337501, 1.0265164, 0.9078363, 0.04859662, 0.040804487, 0.04034693, 0.041713785,
    1.0141448, 0.1647713, 0.27078384, 0.39933348, 0.64287835, 0.8993073, 0.43361455, 0.54162633, 0.34093753, 0.1322517, 0.99917287, 0.277492, 0.3749475, 0.42269498, 0.33437613, 1.0217686, 0.6399234, -0.30303442, -0.26225382, -0.19161789, 1.0526137, 0.78253365, 0.1008011, 0.09491582, 0.08122257, 0.055264577,
    1.0093704, 0.16275598, 0.24669036, 0.3704941, 0.6220214, 0.9042559, 0.43104059, 0.5383291, 0.34388673, 0.18185167, 1.0051922, 0.3371831, 0.4161531, 0.4638763, 0.3206427, 1.0452536, 0.63996285, -0.33529443, -0.29468602, -0.21441239, 1.0857594, 0.75544786, 0.11854828, 0.110279426, 0.08961016, 0.07084691,
    1.0076929, 0.17692451, 0.22000846, 0.33538422, 0.5909755, 0.9207581, 0.43030658, 0.54515827, 0.3398619, 0.2670153, 1.0060303, 0.36006573, 0.4481835, 0.5097007, 0.29431412, 1.0598737, 0.6399682, -0.3151972, -0.27041698, -0.22466235, 1.1252232, 0.7787896, 0.08545869, 0.07724177, 0.07346451, 0.086191915,
    1.0028396, 0.18241458, 0.16611992, 0.2750531, 0.5301506, 0.9414935, 0.40656933, 0.52273077, 0.2955033, 0.37424263, 1.0104315, 0.35999414, 0.46897852, 0.5649121, 0.23808572, 1.1175739, 0.63833153, -0.27643064, -0.22995065, -0.2530758, 1.1795448, 0.7131189, 0.1006345, 0.08422656, 0.112687446, 0.099625126,
    1.0013644, 0.20950544, 0.16371405, 0.26590046, 0.5212966, 0.94662744, 0.39402235, 0.47510663, 0.24441552, 0.47643232, 1.0219882, 0.36118868, 0.49171174, 0.60197216, 0.17519203, 1.1609366, 0.61974615, -0.21588, -0.17593996, -0.31026056, 1.2447238, 0.675648, 0.066368945, 0.05101949, 0.13809721, 0.10981467,
    0.9939146, 0.24757361, 0.18518475, 0.2739458, 0.54178697, 0.95699817, 0.3750425, 0.44740388, 0.2187457, 0.50433224, 1.0421045, 0.35351342, 0.47249547, 0.5957498, 0.17762709, 1.1965744, 0.5454586, -0.14839698, -0.111373946, -0.3795185, 1.3, 0.5919402, 0.021982431, 0.007651737, 0.15341942, 0.11702869,
    0.9839332, 0.2780661, 0.19592331, 0.25256282, 0.5607619, 0.9787364, 0.35967702, 0.44336507, 0.23911947, 0.48939985, 1.0436295, 0.3444898, 0.43303478, 0.5520371, 0.22524919, 1.1939803, 0.5024421, -0.08383032, -0.025618885, -0.4308643, 1.3, 0.5943362, -0.012606525, -0.035463106, 0.15090251, 0.12131039,
    0.98406243, 0.28472054, 0.22379734, 0.24326909, 0.56106937, 0.9940879, 0.35980865, 0.41130286, 0.28901967, 0.47073564, 1.0311244, 0.3464498, 0.42420655, 0.48665017, 0.27384526, 1.1995289, 0.49381742, -0.06603576, 0.0008567592, -0.44146588, 1.3, 0.6252469, -0.01702452, -0.03888727, 0.1331633, 0.124156676,
    0.98364186, 0.29077223, 0.2529103, 0.25109342, 0.55094856, 1.0012246, 0.35998276, 0.3778071, 0.34523484, 0.4490202, 1.0240192, 0.34506106, 0.41252506, 0.42721903, 0.30635196, 1.2138078, 0.48769626, -0.05738847, -0.03901678, -0.4131203, 1.3, 0.68575495, -0.0108281225, -0.008187287, 0.10775906, 0.12722796,
    0.98892397, 0.29308516, 0.27298447, 0.27167964, 0.535203, 0.993248, 0.35914993, 0.36053094, 0.38725284, 0.4334837, 1.0275491, 0.34542182, 0.3976909, 0.390406, 0.32190785, 1.2411782, 0.4708175, -0.04643234, -0.093701765, -0.35812458, 1.3, 0.69137794, -0.009880682, 0.019764893, 0.07210306, 0.12618606,
    0.97524095, 0.2863915, 0.2853974, 0.3087832, 0.52007264, 1.0214597, 0.34871873, 0.3751167, 0.40179852, 0.43767488, 1.0455424, 0.34515747, 0.37712502, 0.37034327, 0.34780988, 1.3, 0.3619046, -0.049643088, -0.11567372, -0.2404292, 1.0967201, 0.63864374, -0.01835653, 0.009811529, -0.06421445, 0.12483071,
    0.97524095, 0.2863915, 0.31986946, 0.34983265, 0.54654557, 1.0214597, 0.34871873, 0.35823002, 0.38284212, 0.4248335, 1.0455424, 0.34515747, 0.31899866, 0.32117277, 0.33783326, 1.3, 0.3619046, -0.02054702, -0.09610243, -0.24465692, 1.0967201, 0.63864374, -0.011847416, 0.012669792, -0.06603228, 0.12099413,
    0.97537124, 0.28389487, 0.33845794, 0.36527026, 0.56821597, 1.0213276, 0.3443084, 0.3453847, 0.36254856, 0.4112573, 1.0435001, 0.34075323, 0.24384244, 0.2550236, 0.30837375, 1.3, 0.3600097, 0.03576381, -0.032559182, -0.22625948, 1.0568093, 0.65199757, -0.007429622, 0.012176085, -0.06971318, 0.11698767,
    0.82546514, 0.3403471, 0.30905673, 0.33142874, 0.506926, 1.0320323, 0.34219489, 0.34260955, 0.34831905, 0.37416008, 1.122096, 0.17556076, 0.15163411, 0.16959172, 0.23968683, 1.2902021, 0.40542185, 0.17928152, 0.106657825, -0.080250725, 0.8889079, 0.6398652, -0.039220557, -0.00032295726, -0.052795343, 0.11429942,
    0.82546514, 0.3403471, 0.2891104, 0.31258076, 0.4671107, 1.0320323, 0.34219489, 0.3298055, 0.33476767, 0.35614344, 1.122096, 0.17556076, 0.14352944, 0.15765734, 0.24129589, 1.2902021, 0.40542185, 0.22038282, 0.15843552, -0.008812102, 0.8889079, 0.6398652, -0.05874923, -0.022809083, -0.07828805, 0.1155632,
    0.027845727, 0.32029563, 0.26543966, 0.2892569, 0.41578922, 1.2957414, 0.35977942, 0.31681344, 0.32330212, 0.34748217, 1.3, 0.17696504, 0.13572347, 0.1469631, 0.23742636, 1.2932718, 0.35994396, 0.22927687, 0.18224409, 0.055499703, 0.43809608, 0.7116775, -0.04473785, -0.013762519, -0.101601124, 0.11824717
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
