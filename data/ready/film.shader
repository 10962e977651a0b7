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

// The weights a, b of each variate.
static const float film_variates[6] = {
    1.5917969, 1.5996094,
    1.015625, -0.7314453,
    1.3369141, 0.07946777
};

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
static const float film_lobes[99] = {
    0.8671875, 0.9975586, 0.88720703, 123.125, 103.75, -6.9453125, -57.25, 0.0, 51.9375, 54.96875, -0.86083984,
    1.0009766, 0.16418457, 0.0, -18.484375, 21.78125, 0.8457031, -3.2753906, 0.17626953, -2.96875, -0.26757812, -32.59375,
    1.0117188, 0.0, 0.24304199, 46.25, -21.578125, -2.4589844, 50.78125, 1.0263672, -46.59375, 30.453125, 6.28125,
    0.99902344, 0.34570312, 0.0, -5.0039062, 13.5078125, -0.4716797, -0.5727539, 0.007537842, -4.3203125, 0.9316406, -6.2070312,
    1.0009766, 0.48266602, 0.8647461, 166.375, 103.125, -0.5498047, -82.375, 0.0, 76.3125, 92.125, 8.0546875,
    0.98583984, 0.89160156, 0.6582031, 77.6875, 59.90625, 6.7734375, -51.1875, 0.13183594, 20.0625, 13.03125, -26.640625,
    1.0019531, 0.44726562, 0.5629883, -4.4648438, 18.125, 0.76660156, 4.234375, 5.2734375, -17.765625, -1.2587891, -5.578125,
    1.0078125, 0.52441406, 0.037719727, 27.046875, -12.5703125, -3.5644531, 41.34375, 0.6621094, -45.40625, 22.6875, 2.5859375,
    0.95654297, 1.0029297, 0.99902344, 60.21875, 72.0, 1.6875, -34.53125, 0.0, 20.203125, 20.984375, -14.7265625
};

// Directional albedo (R, G, B), a row for each node.
static const float film_albedo_nodes[387] = {
    0.2977831, 0.276252, 0.23969467,
    0.2977831, 0.276252, 0.23969467,
    0.29778272, 0.27625176, 0.23969486,
    0.31828076, 0.29434374, 0.25290772,
    0.33615673, 0.31013444, 0.26444918,
    0.35197902, 0.3241138, 0.2746715,
    0.3663098, 0.33677322, 0.28393242,
    0.37946367, 0.34838802, 0.29243392,
    0.39162368, 0.35911825, 0.30029494,
    0.40289235, 0.3690533, 0.30758345,
    0.41331893, 0.37823573, 0.31433406,
    0.42291528, 0.3866752, 0.3205579,
    0.43166324, 0.3943547, 0.32624745,
    0.43952715, 0.40124196, 0.3313846,
    0.44645846, 0.40729332, 0.3359437,
    0.45239955, 0.41245678, 0.3398937,
    0.45729613, 0.41668364, 0.343207,
    0.46106434, 0.41990155, 0.34584066,
    0.46376324, 0.42215747, 0.34783834,
    0.4652953, 0.42336455, 0.3491444,
    0.4656982, 0.42355704, 0.34979817,
    0.46501297, 0.42277026, 0.3498378,
    0.463325, 0.42107913, 0.3493321,
    0.46075568, 0.41858956, 0.34837133,
    0.4574081, 0.41539106, 0.34703088,
    0.45353228, 0.41171366, 0.34549844,
    0.44933268, 0.40772852, 0.34390682,
    0.44501358, 0.4036186, 0.342397,
    0.44083256, 0.3996146, 0.3411437,
    0.4370305, 0.39593232, 0.34030455,
    0.43382984, 0.39277247, 0.3400188,
    0.43141925, 0.3903078, 0.34039637,
    0.42993975, 0.3886708, 0.34150586,
    0.42947233, 0.3879421, 0.34336588,
    0.4300282, 0.3881421, 0.34593692,
    0.43154392, 0.38922542, 0.34911737,
    0.43388167, 0.39107674, 0.352744,
    0.43684456, 0.39352307, 0.35660547,
    0.44018555, 0.39633945, 0.36044982,
    0.4436237, 0.39926225, 0.36399925,
    0.4468653, 0.40200981, 0.36696884,
    0.4496253, 0.40429947, 0.3690853,
    0.45164412, 0.4058641, 0.3701021,
    0.45270485, 0.40647045, 0.3698152,
    0.4526446, 0.40593168, 0.36807308,
    0.45136073, 0.40411583, 0.36478293,
    0.44881272, 0.4009497, 0.3599113,
    0.44502255, 0.39642143, 0.3534847,
    0.4400667, 0.39057517, 0.34558228,
    0.43406832, 0.38350415, 0.33632797,
    0.42718968, 0.37534538, 0.32588422,
    0.41961938, 0.366267, 0.31443948,
    0.41156092, 0.35645753, 0.3021983,
    0.40322298, 0.34611562, 0.28937104,
    0.39480984, 0.33544093, 0.2761665,
    0.38651204, 0.32462344, 0.2627816,
    0.37850142, 0.3138388, 0.24939819,
    0.37092653, 0.30324334, 0.23617874,
    0.36395073, 0.2929909, 0.22326906,
    0.3575948, 0.2831524, 0.21077771,
    0.35195205, 0.27382046, 0.1988039,
    0.34709775, 0.2650837, 0.18743728,
    0.34301198, 0.25694242, 0.17670552,
    0.33971882, 0.24943778, 0.16666868,
    0.33716756, 0.24254058, 0.1573284,
    0.33539322, 0.23629618, 0.14873944,
    0.33424217, 0.230582, 0.14083304,
    0.33372706, 0.22541864, 0.13364881,
    0.33373496, 0.22071844, 0.12714033,
    0.33423343, 0.21645916, 0.12131095,
    0.33509567, 0.2125363, 0.116102,
    0.33630678, 0.20894079, 0.11152519,
    0.33772805, 0.20555852, 0.10751011,
    0.3393148, 0.20235331, 0.10404294,
    0.34099612, 0.19926673, 0.10109088,
    0.34272224, 0.19626012, 0.09863107,
    0.34441814, 0.19327311, 0.096621476,
    0.3460526, 0.19028473, 0.09504425,
    0.34757346, 0.18725412, 0.09386342,
    0.3489528, 0.18417072, 0.09305886,
    0.35015193, 0.18100838, 0.09259624,
    0.3511617, 0.17777483, 0.09245965,
    0.35196283, 0.17446691, 0.09262203,
    0.35252473, 0.17107998, 0.093050584,
    0.3528637, 0.16764717, 0.0937367,
    0.35296682, 0.16417807, 0.09465232,
    0.3528162, 0.16068749, 0.09577025,
    0.35242817, 0.1572085, 0.097076595,
    0.35179392, 0.1537661, 0.098549016,
    0.35092, 0.15038647, 0.100168765,
    0.3498125, 0.14709984, 0.10191921,
    0.34845775, 0.14392093, 0.10377487,
    0.34688553, 0.14088622, 0.105730385,
    0.34507665, 0.13800274, 0.10775854,
    0.34304753, 0.13528864, 0.109847754,
    0.34081098, 0.13275924, 0.11198662,
    0.33835596, 0.13040932, 0.114151195,
    0.33570638, 0.12824287, 0.1163338,
    0.3328543, 0.12624528, 0.118512355,
    0.32981715, 0.1244072, 0.120676525,
    0.32660884, 0.1227112, 0.12281408,
    0.32323655, 0.12113253, 0.12491075,
    0.3197137, 0.11964703, 0.12695624,
    0.31607062, 0.11823541, 0.12895027,
    0.31232032, 0.11687186, 0.13088666,
    0.308499, 0.11554456, 0.13277394,
    0.30463618, 0.114243, 0.13462004,
    0.30077663, 0.11296937, 0.13644381,
    0.29694128, 0.11172553, 0.13825357,
    0.29317576, 0.110527724, 0.14007135,
    0.28948185, 0.109383896, 0.14189419,
    0.28587762, 0.10831166, 0.14372554,
    0.28235132, 0.107318684, 0.14554705,
    0.27887508, 0.10640602, 0.1473266,
    0.27542275, 0.10557043, 0.14902835,
    0.27195475, 0.104798816, 0.15060464,
    0.26843932, 0.10407472, 0.15200938,
    0.26487797, 0.10338882, 0.15321754,
    0.2612731, 0.102726646, 0.15420265,
    0.25764275, 0.10207542, 0.15494789,
    0.2540506, 0.101437815, 0.15546824,
    0.25054467, 0.1008086, 0.1557668,
    0.24719407, 0.10019164, 0.15586403,
    0.2440735, 0.09959434, 0.1557866,
    0.24129933, 0.09904395, 0.15559581,
    0.23896943, 0.09856362, 0.15534358,
    0.23720525, 0.098190166, 0.1551043,
    0.23609103, 0.09794795, 0.15492685,
    0.23571333, 0.09786571, 0.15486483
};

// A row for each node: p, roughness and share of the albedo (R, G, B) of each lobe after the first; width.
static const float film_light_lobes[832] = {
    0.99445844, 0.101317264, 0.27117002, 0.28589642, 0.32055646, 0.97480804, 0.16002287, 0.41811144, 0.4730672, 0.5004557, 0.8884921, 0.35996354, 0.52130246, 0.46970287, 0.40636286, 0.9512958, 0.39160395, -0.3039169, -0.29121226, -0.26806906, 0.5856125, 0.43598127, 0.090082966, 0.06490779, 0.044128105, 0.008775546,
    0.99445844, 0.101317264, 0.2711644, 0.28589067, 0.32055056, 0.97480804, 0.16002287, 0.418106, 0.4730617, 0.50044996, 0.8884921, 0.35996354, 0.5212981, 0.46969873, 0.40635836, 0.9512958, 0.39160395, -0.30392194, -0.29121718, -0.26807404, 0.5856125, 0.43598127, 0.09008321, 0.06490957, 0.0441302, 0.008775546,
    0.99445844, 0.101317264, 0.27115306, 0.2858791, 0.3205387, 0.97480804, 0.16002287, 0.418095, 0.4730507, 0.50043833, 0.8884921, 0.35996354, 0.5212894, 0.4696904, 0.4063493, 0.9512958, 0.39160395, -0.30393204, -0.29122698, -0.26808405, 0.5856125, 0.43598127, 0.09008367, 0.06491311, 0.04413436, 0.009262258,
    0.99448913, 0.10280959, 0.27113947, 0.28586578, 0.3205254, 0.9751027, 0.16015851, 0.41808152, 0.47303778, 0.50042504, 0.88879734, 0.36001933, 0.52127814, 0.46968007, 0.4063382, 0.9512686, 0.39193746, -0.30394483, -0.29123893, -0.26809585, 0.5876358, 0.4349661, 0.09008382, 0.06491708, 0.044138946, 0.010025645,
    0.99448913, 0.10280959, 0.27111012, 0.2858397, 0.32050103, 0.9751027, 0.16015851, 0.41805068, 0.4730112, 0.50039876, 0.88879734, 0.36001933, 0.52124834, 0.46965456, 0.40631118, 0.9512686, 0.39193746, -0.3039767, -0.29126614, -0.26812127, 0.5876358, 0.4349661, 0.09008463, 0.06492787, 0.044150177, 0.010196423,
    0.9949142, 0.09818148, 0.2709126, 0.28571203, 0.3204275, 0.9760754, 0.16122788, 0.41780117, 0.47284725, 0.50026065, 0.8936175, 0.3600065, 0.52091897, 0.46938807, 0.4060235, 0.9555879, 0.39129475, -0.3042879, -0.29149666, -0.2683078, 0.5905251, 0.44022697, 0.090150416, 0.065086275, 0.044280477, 0.009675156,
    0.99636084, 0.098617636, 0.2714134, 0.28654933, 0.32172015, 0.9790632, 0.16003777, 0.4177424, 0.47324008, 0.500851, 0.9018185, 0.36000764, 0.51925474, 0.46789083, 0.40429676, 0.9585433, 0.38625535, -0.30564287, -0.29240063, -0.2687812, 0.6009245, 0.45845607, 0.090907425, 0.065823816, 0.04452183, 0.0087254,
    0.99810386, 0.10720594, 0.27892643, 0.29474324, 0.33153707, 0.98195493, 0.16010532, 0.42095128, 0.4776729, 0.5058588, 0.9171447, 0.3578443, 0.5117182, 0.4599983, 0.3947598, 0.96870685, 0.37826243, -0.3083012, -0.2936607, -0.26842788, 0.607186, 0.47677347, 0.09041192, 0.06359751, 0.040234394, 0.0077503854,
    0.9992398, 0.102102555, 0.30968836, 0.3259072, 0.3651551, 0.9829941, 0.16002356, 0.42992353, 0.48837557, 0.51679707, 0.9199702, 0.3592981, 0.48765013, 0.43188727, 0.35941818, 0.97300696, 0.37229756, -0.30294535, -0.28607568, -0.25795704, 0.5772631, 0.5412523, 0.07333112, 0.04431899, 0.020797892, 0.0075485483,
    0.9999876, 0.093949005, 0.3655304, 0.38286126, 0.42507175, 0.98265016, 0.16003439, 0.42752844, 0.48793525, 0.51646453, 0.9299366, 0.3594974, 0.43269664, 0.36693922, 0.2812299, 0.9761523, 0.36634982, -0.29000032, -0.26629186, -0.22967818, 0.58940184, 0.5737226, 0.061098248, 0.03091336, 0.008429935, 0.008320312,
    1.0, 0.080551445, 0.43387565, 0.45556983, 0.5006346, 0.98273957, 0.1600825, 0.39759454, 0.45975322, 0.48857147, 0.92921156, 0.3598291, 0.36610714, 0.2855956, 0.1858945, 0.97762614, 0.36012185, -0.25346017, -0.22165759, -0.17640525, 0.60436255, 0.5983758, 0.05138588, 0.021346522, 0.001258534, 0.010068323,
    1.0, 0.1025238, 0.50275594, 0.5315055, 0.5794416, 0.98181903, 0.16006385, 0.35117382, 0.41146275, 0.44097006, 0.93221873, 0.3613543, 0.33861807, 0.24161747, 0.1273288, 0.976608, 0.36016083, -0.24918613, -0.2052377, -0.14893548, 0.6205218, 0.60731906, 0.0517185, 0.020914605, 0.0012092438, 0.012972713,
    1.0, 0.15965958, 0.54556435, 0.5836755, 0.6373263, 0.9845445, 0.159992, 0.28688112, 0.3491956, 0.38653687, 0.92471033, 0.35945675, 0.30690342, 0.1985023, 0.072880164, 0.9840015, 0.36848018, -0.19835089, -0.15197618, -0.09765718, 0.6560827, 0.6141434, 0.051720444, 0.019624302, 0.0010281968, 0.017281307,
    1.0, 0.15998957, 0.5403877, 0.59738153, 0.6726923, 0.98820484, 0.15997878, 0.233134, 0.29774657, 0.34311694, 0.92198473, 0.35608378, 0.32513234, 0.20092668, 0.049475927, 0.9836849, 0.39243537, -0.17565311, -0.12634338, -0.07163884, 0.7179885, 0.59560955, 0.067223735, 0.028480165, 0.0073621087, 0.023217196,
    1.0062996, 0.15999795, 0.4950911, 0.5842616, 0.7008649, 0.9770906, 0.19544074, 0.19776328, 0.26158112, 0.30998573, 0.90737426, 0.42631093, 0.40473616, 0.23742889, 0.019208822, 0.9664149, 0.6326793, -0.15387355, -0.10667759, -0.044791065, 0.628326, 0.6020001, 0.04635756, 0.021370165, 0.017544227, 0.03125713,
    1.0203768, 0.15999454, 0.37286317, 0.48227564, 0.6401114, 0.9771453, 0.19565691, 0.23864138, 0.30210632, 0.35406572, 0.90743005, 0.4263626, 0.5170642, 0.31983608, 0.03580725, 0.9664377, 0.63338876, -0.18031499, -0.1273925, -0.054918673, 0.627905, 0.6019072, 0.040410277, 0.020387186, 0.030172396, 0.041931078,
    1.0188868, 0.17289993, 0.34291917, 0.4790419, 0.6975536, 0.96339095, 0.26824167, 0.2649019, 0.3360437, 0.38394824, 0.9234757, 0.42063788, 0.5218132, 0.289237, -0.06107609, 0.99652463, 0.6399259, -0.17789184, -0.12990007, -0.05723536, 0.5886539, 0.5601471, 0.03447949, 0.021191059, 0.04352309, 0.055422343,
    1.0169835, 0.18789096, 0.28670374, 0.44123584, 0.70280504, 0.96504545, 0.30594382, 0.31381577, 0.37683758, 0.40879756, 0.94067144, 0.41724107, 0.5412096, 0.29509816, -0.08708425, 1.0215427, 0.63984966, -0.18323375, -0.13558951, -0.0640876, 0.52623993, 0.5519174, 0.026324086, 0.01648309, 0.048838247, 0.0708594,
    1.0154189, 0.19659317, 0.21720487, 0.3734196, 0.651304, 0.97301745, 0.3280378, 0.38114813, 0.41657612, 0.4300153, 0.9550447, 0.41755372, 0.5649441, 0.34279218, -0.043683477, 1.036959, 0.6398753, -0.19723669, -0.14939752, -0.07747474, 0.4769665, 0.53618914, 0.017255722, 0.008832968, 0.050986875, 0.08598426,
    1.0090296, 0.18843874, 0.15797311, 0.2770661, 0.58846647, 0.9749362, 0.35026073, 0.4212167, 0.42976978, 0.4146137, 0.97938615, 0.40145808, 0.5499496, 0.4403699, -1.6900327e-05, 1.0620561, 0.6398983, -0.17315657, -0.14681354, -0.07352716, 0.69536066, 0.41780514, 0.022241225, -0.013065319, 0.07269504, 0.09926318,
    1.0060389, 0.17590617, 0.114680216, 0.1932092, 0.50461465, 0.96384704, 0.35819075, 0.46282077, 0.43786526, 0.4203075, 1.002382, 0.38100174, 0.5164845, 0.5308954, 0.03671539, 1.1172538, 0.6399163, -0.117461614, -0.114132464, -0.05669159, 0.7759032, 0.36003205, 0.0002638116, -0.06164028, 0.094929606, 0.11003064,
    1.0024339, 0.19419295, 0.11684416, 0.16664043, 0.49425712, 0.94491655, 0.3586193, 0.4985833, 0.4366002, 0.45915082, 1.0189482, 0.38128048, 0.5146174, 0.5811982, 0.051091686, 1.1372076, 0.6394774, -0.10988573, -0.11089546, -0.06280257, 0.74451387, 0.3498855, -0.04377653, -0.089514986, 0.058223944, 0.116612524,
    0.9999612, 0.21625735, 0.11790604, 0.146568, 0.49453187, 0.9291594, 0.3599105, 0.4994552, 0.43268073, 0.50027066, 1.0291504, 0.36889786, 0.52687, 0.5893404, 0.080666125, 1.1729627, 0.5748594, -0.09941519, -0.09233334, -0.083711565, 0.68807226, 0.3413822, -0.0684519, -0.09463411, 0.009352667, 0.12097478,
    0.9965985, 0.25195503, 0.14162749, 0.15479422, 0.5160107, 0.93224657, 0.35926697, 0.4748847, 0.43562213, 0.51341647, 1.0360781, 0.35993323, 0.5368432, 0.5529936, 0.14615023, 1.2002766, 0.47824553, -0.11233235, -0.08915971, -0.15613298, 0.6212612, 0.34057364, -0.06591102, -0.07577242, -0.016896833, 0.1239082,
    0.99683285, 0.2588477, 0.1722914, 0.17477097, 0.4965361, 0.9254498, 0.35990086, 0.4480781, 0.43875822, 0.49718222, 1.0235521, 0.35997766, 0.5381891, 0.5031122, 0.20736986, 1.2198973, 0.46447116, -0.09797227, -0.066408016, -0.17555551, 0.5929503, 0.34285247, -0.08606549, -0.072845146, -0.022049043, 0.12701666,
    0.99863833, 0.26716155, 0.20186514, 0.19893822, 0.48150307, 0.9131004, 0.35852996, 0.4173622, 0.43191543, 0.48253348, 1.0027418, 0.35997477, 0.52726704, 0.45908576, 0.26912376, 1.2487427, 0.4500952, -0.072317265, -0.045353796, -0.18736331, 0.53030515, 0.34685037, -0.10045651, -0.068238534, -0.040848218, 0.1269067,
    1.0045133, 0.26978123, 0.2310373, 0.22723041, 0.4691852, 0.90995085, 0.35713255, 0.38011858, 0.413718, 0.46784785, 0.96107066, 0.35997188, 0.49613076, 0.4286839, 0.31523862, 1.3, 0.4326639, -0.034526393, -0.025215415, -0.18642591, 0.40143216, 0.3527419, -0.10156968, -0.07190622, -0.059600506, 0.124547005,
    1.0610358, 0.2639701, 0.23612593, 0.23556532, 0.42581296, 0.8571893, 0.3386291, 0.3438603, 0.38676748, 0.47684216, 0.9215514, 0.35994637, 0.46917275, 0.40536922, 0.35329834, 1.3, 0.4227155, 0.0150382295, 0.017098296, -0.18171236, 0.2586382, 0.37967595, -0.10246442, -0.081905745, -0.072475456, 0.120770775,
    1.1319131, 0.24210335, 0.22007592, 0.2238681, 0.36736858, 0.7640498, 0.32002822, 0.29936543, 0.3411498, 0.4789956, 0.8576369, 0.35997447, 0.4395812, 0.37839344, 0.38142264, 1.2073836, 0.41903245, 0.09840819, 0.10080333, -0.15194073, 0.021977758, 0.3857796, -0.10118688, -0.08661429, -0.078291334, 0.11695214,
    1.2533504, 0.22740716, 0.20035201, 0.20587875, 0.3306984, 0.6427701, 0.3055187, 0.2642649, 0.30168274, 0.46071512, 0.8114112, 0.3596273, 0.4089768, 0.35488087, 0.39008746, 1.1896825, 0.40360448, 0.14895096, 0.15393858, -0.11909616, -0.53548163, 0.38933548, -0.073543146, -0.063743636, -0.06312289, 0.114609405,
    1.3, 0.22858869, 0.19950086, 0.21074946, 0.32853436, 0.48204705, 0.3039552, 0.2694664, 0.29007906, 0.438616, 0.81047064, 0.35999858, 0.3982285, 0.34128124, 0.38788846, 1.3, 0.41433012, 0.1371943, 0.15787628, -0.09235428, -1.3, 0.40640792, -0.06811954, -0.05347204, -0.06749675, 0.116236694,
    1.3, 0.18543275, 0.14583132, 0.16573988, 0.2639483, -0.36451173, 0.31840682, 0.24164721, 0.25894877, 0.3875755, 1.3, 0.35993537, 0.383187, 0.33160713, 0.3924756, 1.3, 0.3596574, 0.17425239, 0.1847991, 0.008170503, -0.705165, 0.64121526, -0.03375415, -0.011846882, -0.07596111, 0.11891504
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
