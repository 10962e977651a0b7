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

// The weights a, b of each variate.
static const float film_variates[6] = {
    1.8681641, 1.6826172,
    1.2998047, 0.12805176,
    1.4443359, 0.46826172
};

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
static const float film_lobes[99] = {
    0.95166016, 0.2854004, 0.40600586, 163.25, -3.7148438, 111.125, -78.25, 19.796875, -108.0, 42.375, 1.0673828,
    1.0048828, 0.40429688, 0.0, 23.75, 2.2109375, 12.1484375, -13.25, 1.6943359, -13.0234375, 0.5761719, 3.5507812,
    1.0, 0.4658203, 0.07220459, 17.09375, -10.3203125, 44.53125, 7.0703125, 0.0, -49.65625, 30.484375, 0.6176758,
    1.0449219, 0.51953125, 0.90625, 199.375, -98.3125, 113.8125, -1.3681641, 38.90625, -159.0, 131.75, 3.1152344,
    0.91748047, 0.99658203, 0.90966797, 37.9375, 3.9355469, 69.875, -21.46875, 0.0, -61.6875, 45.46875, 4.796875,
    0.89453125, 0.8984375, 0.9008789, 300.0, 56.90625, -183.875, 82.0, 0.014350891, 28.421875, 42.78125, -21.328125,
    1.0, 0.18286133, 0.0, 5.5585938, 12.8046875, -10.8359375, 8.921875, 0.45654297, -1.4941406, 0.8588867, -18.125,
    0.97558594, 0.49926758, 0.066589355, 116.8125, 17.3125, -73.0, 44.6875, 0.20373535, 1.9414062, 9.9921875, -10.53125,
    0.0, 0.027664185, 0.9892578, 62.90625, 10.0703125, 40.0, -32.59375, 0.52734375, -18.9375, 7.8203125, 2.8574219
};

// Directional albedo (R, G, B), a row for each node.
static const float film_albedo_nodes[387] = {
    0.35118127, 0.346869, 0.33257958,
    0.35118127, 0.346869, 0.33257958,
    0.35117695, 0.34686488, 0.33257544,
    0.36470833, 0.3568184, 0.33937228,
    0.37638137, 0.36503538, 0.34459016,
    0.38672584, 0.37207702, 0.3488156,
    0.39613727, 0.3783074, 0.352383,
    0.4048284, 0.38392314, 0.35547227,
    0.41290647, 0.38902333, 0.35817313,
    0.42042494, 0.39365947, 0.36053285,
    0.4274005, 0.39785102, 0.36257043,
    0.4338293, 0.4016002, 0.36429018,
    0.43968967, 0.40489465, 0.36568445,
    0.4449493, 0.40771392, 0.36673945,
    0.44956106, 0.4100244, 0.36742926,
    0.4534833, 0.41179937, 0.36773548,
    0.45667708, 0.41301602, 0.3676446,
    0.4590517, 0.4136017, 0.3670883,
    0.4606471, 0.41360864, 0.36613372,
    0.46147045, 0.4130599, 0.36480746,
    0.46148944, 0.4119368, 0.36309415,
    0.4607286, 0.4102748, 0.36102983,
    0.45923424, 0.40812775, 0.35866532,
    0.4570925, 0.40558606, 0.35608476,
    0.45442685, 0.40277368, 0.3534013,
    0.45130533, 0.3997566, 0.35065973,
    0.4479241, 0.39672226, 0.3480315,
    0.44448373, 0.39385754, 0.34567782,
    0.44116428, 0.39132607, 0.3437333,
    0.43815634, 0.38929683, 0.34233528,
    0.43565413, 0.38793743, 0.34161812,
    0.43382576, 0.38738534, 0.3416863,
    0.43280184, 0.3877354, 0.3426024,
    0.4326602, 0.38902512, 0.34437498,
    0.4334096, 0.3912184, 0.3469425,
    0.43498993, 0.394207, 0.35017678,
    0.43725723, 0.3977955, 0.35386783,
    0.4400048, 0.40172413, 0.35774723,
    0.44297242, 0.4056798, 0.36149892,
    0.44586253, 0.40931484, 0.3647771,
    0.448385, 0.4122947, 0.36725318,
    0.4502793, 0.41432247, 0.3686402,
    0.4513403, 0.4151662, 0.36871815,
    0.45142353, 0.41466638, 0.3673419,
    0.45045784, 0.41274843, 0.36445206,
    0.44843116, 0.409408, 0.3600595,
    0.44537857, 0.40469843, 0.35423258,
    0.44136727, 0.39871266, 0.3470775,
    0.43648583, 0.39157078, 0.33872548,
    0.43083477, 0.38340777, 0.32932034,
    0.42452604, 0.3743707, 0.31901503,
    0.4176815, 0.36461496, 0.3079679,
    0.41043273, 0.3543026, 0.29634124,
    0.40292025, 0.34359998, 0.28429908,
    0.39529055, 0.33267462, 0.2720046,
    0.38769063, 0.32168898, 0.259614,
    0.38026318, 0.31079602, 0.247273,
    0.37314117, 0.30013454, 0.2351127,
    0.36649224, 0.28985134, 0.22325732,
    0.3603284, 0.2800013, 0.21178527,
    0.35474727, 0.27065802, 0.20074813,
    0.34986368, 0.26193124, 0.19025554,
    0.3456608, 0.25380033, 0.18028553,
    0.34219277, 0.24631937, 0.1708959,
    0.33939376, 0.23942176, 0.16202798,
    0.33740997, 0.23325688, 0.15384516,
    0.3360009, 0.22759397, 0.14613824,
    0.33524162, 0.22251572, 0.1390095,
    0.3350065, 0.21791431, 0.13238725,
    0.33529487, 0.21380463, 0.12632133,
    0.3359265, 0.21002693, 0.12069478,
    0.3369294, 0.20662361, 0.11559124,
    0.3381156, 0.20343538, 0.110910386,
    0.33944762, 0.20043902, 0.106677674,
    0.34084862, 0.19757311, 0.10288401,
    0.34227762, 0.19480489, 0.09954591,
    0.34365374, 0.19206251, 0.09664118,
    0.3449667, 0.18933332, 0.094195716,
    0.34617603, 0.18657398, 0.09220073,
    0.34728527, 0.18378182, 0.09067727,
    0.34827766, 0.18093176, 0.08961503,
    0.34917763, 0.17803955, 0.08902956,
    0.34998706, 0.17510068, 0.08890589,
    0.35069638, 0.172114, 0.089225106,
    0.35133287, 0.16910733, 0.08997483,
    0.3518797, 0.16608271, 0.091115266,
    0.35230377, 0.16304342, 0.09260102,
    0.3525893, 0.16000473, 0.09438754,
    0.35268936, 0.15696964, 0.096412666,
    0.35256064, 0.15394346, 0.098618634,
    0.35215476, 0.15093169, 0.100945994,
    0.35140383, 0.14792831, 0.10333337,
    0.35028827, 0.14494982, 0.10574004,
    0.3487534, 0.14199321, 0.10811959,
    0.34679192, 0.13907322, 0.11045124,
    0.34441155, 0.13620828, 0.11272331,
    0.3416138, 0.13340917, 0.11493,
    0.33844867, 0.13070226, 0.117088616,
    0.33494824, 0.12810245, 0.119210675,
    0.33117685, 0.12563367, 0.12131875,
    0.32719928, 0.12331509, 0.12343387,
    0.32306817, 0.12115649, 0.12556939,
    0.31883433, 0.11916372, 0.12773143,
    0.31455463, 0.11734139, 0.1299241,
    0.3102535, 0.115678556, 0.13213395,
    0.3059655, 0.11416728, 0.13434622,
    0.30170754, 0.11279143, 0.136537,
    0.29750255, 0.11153719, 0.13868499,
    0.29334757, 0.110381484, 0.1407549,
    0.28926703, 0.10931266, 0.1427309,
    0.2852482, 0.108306065, 0.144577,
    0.2813105, 0.10735184, 0.14627872,
    0.277459, 0.10643583, 0.14781632,
    0.27369434, 0.10554427, 0.14916979,
    0.27003017, 0.104670405, 0.15033224,
    0.26646832, 0.103804775, 0.15129268,
    0.2630172, 0.10294286, 0.1520482,
    0.2597096, 0.102092974, 0.15261778,
    0.25657192, 0.10126369, 0.15302156,
    0.25363207, 0.100466095, 0.15328535,
    0.25094962, 0.09972638, 0.15346001,
    0.24854863, 0.09905616, 0.15357193,
    0.24645163, 0.09846693, 0.15364641,
    0.24466322, 0.09796213, 0.15369418,
    0.24320546, 0.09755179, 0.153736,
    0.24206844, 0.09723186, 0.15376727,
    0.24126129, 0.09700617, 0.15379556,
    0.24077004, 0.09686818, 0.15380946,
    0.24060984, 0.096823715, 0.15381725
};

// A row for each node: p, roughness and share of the albedo (R, G, B) of each lobe after the first; width.
static const float film_light_lobes[832] = {
    0.6712421, 0.5692395, 0.19230126, 0.099451594, -0.0021016705, 0.9073278, 0.32646182, 0.59749, 0.61570734, 0.67589754, 0.998825, 0.54822445, -0.05851848, -0.07228048, -0.08193984, 0.98841745, 0.13821594, 0.37076536, 0.41238514, 0.42575356, 0.9710515, 0.4590274, -0.092916526, -0.05297993, -0.025176557, 0.028507546,
    0.65671945, 0.57539, 0.1922964, 0.09945231, -0.0020955713, 0.9073925, 0.32647726, 0.5974489, 0.6156761, 0.67587966, 0.999, 0.5496233, -0.058534022, -0.07228777, -0.08193449, 0.9884195, 0.13799031, 0.37071946, 0.4123504, 0.425734, 0.97102785, 0.45893726, -0.09293557, -0.052990284, -0.025174432, 0.028507546,
    0.65596807, 0.57029593, 0.19228421, 0.09945288, -0.0020827544, 0.90680116, 0.32785684, 0.5973589, 0.615609, 0.6758439, 0.9989037, 0.5486338, -0.05857459, -0.072308205, -0.081924535, 0.9884134, 0.13939771, 0.37061968, 0.4122761, 0.42569485, 0.9711064, 0.46079165, -0.09298203, -0.053016007, -0.025170447, 0.029134747,
    0.6340422, 0.5597502, 0.19226596, 0.099452585, -0.0020645729, 0.904204, 0.33240438, 0.5972339, 0.6155153, 0.67579234, 0.99900097, 0.54443175, -0.05862573, -0.07233192, -0.081907436, 0.98841894, 0.15194663, 0.3704829, 0.41217357, 0.42563874, 0.9718344, 0.45672512, -0.09304194, -0.053047754, -0.025162408, 0.029464547,
    0.63154155, 0.56324893, 0.19219416, 0.09944375, -0.0020000737, 0.90655184, 0.33664417, 0.5967925, 0.61517924, 0.67559314, 0.9990092, 0.54201186, -0.058778025, -0.07239132, -0.08183428, 0.98681587, 0.15269731, 0.37000853, 0.41181085, 0.4254195, 0.9719633, 0.45815462, -0.09322805, -0.053139575, -0.025126018, 0.028095728,
    0.89437175, 0.40574992, 0.1908545, 0.09919531, -0.00081109995, 0.96938056, 0.18024477, 0.58893996, 0.60908395, 0.6716892, 0.9990516, 0.57735705, -0.0606449, -0.07275905, -0.08010936, 0.9913885, 0.08394194, 0.36165658, 0.4052283, 0.42096594, 0.973547, 0.5223588, -0.09577225, -0.054163326, -0.024144135, 0.024576426,
    0.89306194, 0.44046736, 0.20266022, 0.11100025, 0.010726766, 0.97690505, 0.16004664, 0.5653571, 0.58865887, 0.65464777, 0.9992037, 0.591108, -0.053012088, -0.06302014, -0.067010306, 0.99377847, 0.051303133, 0.33519027, 0.3822021, 0.40111467, 0.9737236, 0.5570235, -0.092030995, -0.04783349, -0.014550479, 0.019588644,
    0.89665514, 0.45700505, 0.2551917, 0.15660448, 0.04708836, 0.9784373, 0.1599907, 0.5326702, 0.5578817, 0.62589943, 0.99962646, 0.58853966, -0.039701007, -0.04849587, -0.049388397, 0.99441874, 0.050595567, 0.29654276, 0.34669736, 0.36716214, 0.9795077, 0.5622636, -0.086832836, -0.03925973, -0.0021053765, 0.01474742,
    0.89794785, 0.49176982, 0.34097642, 0.22405973, 0.093888685, 0.9811827, 0.15999882, 0.51080835, 0.5372089, 0.60689723, 1.0, 0.62454814, -0.038318075, -0.04462638, -0.04109034, 0.99758285, 0.05, 0.27095923, 0.32613587, 0.34842902, 0.97706896, 0.591348, -0.113533914, -0.05723797, -0.0113114575, 0.011533767,
    0.90407103, 0.5121538, 0.39702675, 0.25297096, 0.10491197, 0.9825897, 0.15998766, 0.5016941, 0.52619404, 0.5912052, 1.0, 0.648316, -0.022214908, -0.02679484, -0.022384819, 0.99963355, 0.05, 0.28733277, 0.34895027, 0.370882, 0.97457874, 0.591865, -0.18090433, -0.106235676, -0.043205038, 0.010385402,
    0.89995176, 0.5070961, 0.40026125, 0.23064159, 0.08247379, 0.98316675, 0.1599722, 0.47037446, 0.4889338, 0.5394639, 1.0, 0.6972826, 0.02017873, 0.012044613, 0.008249246, 1.0, 0.05, 0.34217888, 0.41524523, 0.44146964, 0.96828973, 0.5894823, -0.2426702, -0.14804454, -0.070351996, 0.010961884,
    0.8931878, 0.5003293, 0.38584173, 0.20644744, 0.06550496, 0.9840414, 0.15999283, 0.4043788, 0.4073067, 0.43130252, 1.0, 0.7870241, 0.03529433, 0.027201084, 0.021903627, 1.0, 0.053632863, 0.42052156, 0.5125849, 0.55910516, 0.9593679, 0.59178233, -0.25366005, -0.15397431, -0.077306546, 0.013300051,
    0.886094, 0.4978613, 0.32963422, 0.16695587, 0.043745182, 0.97474873, 0.15998566, 0.28466973, 0.2645434, 0.24983016, 0.9996832, 1.0, 0.05297315, 0.039464157, 0.030695895, 0.9996419, 0.13588162, 0.53484005, 0.6592259, 0.7476792, 0.9645513, 0.6855456, -0.21189135, -0.13171689, -0.07209917, 0.017493298,
    0.8180696, 0.54990137, 0.19524693, 0.096848615, 0.02972106, 0.93424577, 0.32721022, 0.27790537, 0.17182417, 0.06352067, 1.0, 1.0, 0.061165936, 0.04698952, 0.037408814, 1.0, 0.15998822, 0.67099255, 0.8260267, 0.95842934, 0.95891696, 0.681997, -0.21343486, -0.14298901, -0.0895362, 0.02353357,
    0.80105203, 0.5526282, 0.22554146, 0.12080819, 0.044471707, 0.94689226, 0.33143702, 0.37344816, 0.25188825, 0.09789371, 1.0062996, 1.0, 0.046673622, 0.037634216, 0.03240037, 1.0062996, 0.1600224, 0.57406807, 0.74645686, 0.9233206, 0.956406, 0.6593347, -0.22624582, -0.15661609, -0.09697781, 0.031789463,
    0.9048491, 0.44418478, 0.5254704, 0.33840296, 0.15095086, 0.9882048, 0.16013235, 0.3273325, 0.32996926, 0.26713687, 1.0265164, 1.0, 0.03744246, 0.03896231, 0.051435966, 1.0245435, 0.19488265, 0.31132022, 0.4761035, 0.70757145, 0.9960357, 0.65403813, -0.21952307, -0.18912865, -0.17927708, 0.04109692,
    0.66674215, 0.5571471, 0.10091068, 0.05715451, 0.032790355, 0.95097697, 0.34287605, 0.63454336, 0.45954815, 0.16869247, 1.047709, 0.91897446, 0.05331658, 0.050587315, 0.052955426, 1.0119014, 0.19639693, 0.38820893, 0.59970963, 0.9037682, 1.0162902, 0.6400493, -0.18578963, -0.16799451, -0.15401492, 0.052995883,
    0.5416754, 0.56365603, 0.05237095, 0.03159977, 0.0304587, 0.9596791, 0.3505313, 0.7775105, 0.5615472, 0.19847363, 1.0684601, 0.98942626, 0.046136882, 0.037764527, 0.028781008, 1.0110598, 0.1963516, 0.2750166, 0.5029686, 0.8551698, 1.0454158, 0.6401281, -0.16256483, -0.1365026, -0.10496672, 0.06659247,
    0.41133502, 0.55987835, 0.029444031, 0.019530958, 0.03542163, 0.96800494, 0.3572603, 0.8660285, 0.65264046, 0.2807067, 1.0978304, 0.9789697, 0.045838058, 0.034717135, 0.023564206, 1.0091597, 0.19282709, 0.20011698, 0.41337627, 0.7641256, 1.0763298, 0.64034647, -0.15444523, -0.1243123, -0.09094635, 0.081932746,
    0.358428, 0.52275854, 0.016632857, 0.011640722, 0.042176493, 0.98326606, 0.37149072, 0.9033992, 0.6955168, 0.3341266, 1.1795448, 0.7119615, 0.078262195, 0.06866756, 0.109031714, 1.004678, 0.21899928, 0.20558272, 0.4070162, 0.7551899, 1.1277606, 0.62053984, -0.22106215, -0.19056912, -0.22651021, 0.097630434,
    0.3085471, 0.50754815, 0.008141579, 0.004394876, 0.041202508, 0.99953103, 0.37040374, 0.8665265, 0.68659365, 0.37240404, 1.2447238, 0.6805702, 0.048354402, 0.047324654, 0.1435951, 0.99675477, 0.2626903, 0.24556114, 0.42517042, 0.7821762, 1.1659559, 0.59573543, -0.18822965, -0.17427534, -0.32611585, 0.11185598,
    0.69133633, 0.3833412, -0.02188308, -0.029748384, 0.077310555, 0.9966627, 0.36574948, 0.81107336, 0.6781102, 0.39384115, 1.3, 0.62156093, 0.007940559, 0.0023173052, 0.15749952, 0.996872, 0.28058416, 0.28478453, 0.42137474, 0.7412822, 1.1981608, 0.56878984, -0.10538749, -0.0876469, -0.3716795, 0.12262851,
    0.6714785, 0.35057977, -0.07187252, -0.06872145, 0.03776278, 0.9708984, 0.3599475, 0.7573861, 0.6455249, 0.47188553, 1.3, 0.64303786, -0.030478897, -0.051209785, 0.13418855, 1.0010811, 0.29625323, 0.34341928, 0.4296557, 0.74865294, 1.1816585, 0.5307626, -0.022139428, 0.028158322, -0.3967516, 0.12996835,
    0.6186007, 0.35265782, -0.07865056, -0.07111314, 0.019766433, 0.96280223, 0.35994312, 0.7126219, 0.6168777, 0.52039653, 1.3, 0.65832174, -0.03539907, -0.076307386, 0.13822274, 0.9993574, 0.30101168, 0.38299933, 0.42254576, 0.7304446, 1.1870972, 0.5255716, -0.005714354, 0.0894152, -0.41123638, 0.13495892,
    0.56209666, 0.35105717, -0.08400979, -0.07268167, 0.005870013, 0.95135456, 0.35994864, 0.67379636, 0.5914998, 0.5518717, 1.3, 0.6788842, -0.028491393, -0.07468181, 0.11930708, 0.99761015, 0.3038348, 0.41470563, 0.42177725, 0.7016854, 1.1940248, 0.5215453, -0.0016833815, 0.11219221, -0.37836364, 0.1361234,
    0.48674956, 0.35163432, -0.086327255, -0.07199746, -0.0038804978, 0.9324548, 0.3598479, 0.6348954, 0.5643868, 0.5667247, 1.3, 0.7325814, -0.020526007, -0.05043302, 0.072166026, 0.9985658, 0.29720464, 0.43035513, 0.42316, 0.6602609, 1.2039953, 0.5107551, 0.013022497, 0.108150005, -0.29184654, 0.13077849,
    0.38659796, 0.35362053, -0.08141915, -0.06686566, -0.016520401, 0.91194135, 0.35954738, 0.6051222, 0.5466717, 0.58386725, 1.3, 1.0, -0.008441875, -0.016707173, 0.019266281, 1.0032494, 0.28800148, 0.4361005, 0.4309197, 0.6124732, 1.2506472, 0.48776004, 0.016626645, 0.07444373, -0.1921254, 0.124069646,
    0.18710978, 0.357515, -0.067365535, -0.05658851, -0.014564357, 0.8555076, 0.3426956, 0.5738443, 0.53359896, 0.599958, 1.3, 1.0, -0.004325617, -0.006494133, 0.014621347, 1.0422025, 0.28748304, 0.4212876, 0.42336464, 0.5486402, 1.298591, 0.49791223, 0.04052363, 0.07162272, -0.1421797, 0.122444294,
    -0.081706814, 0.4165401, -0.0680891, -0.05766819, -0.020070706, 0.7795268, 0.33892494, 0.54776484, 0.5215947, 0.614555, 0.27893496, 1.0, 0.0030162921, 0.018016037, -0.010907063, 1.087663, 0.2873156, 0.41500053, 0.4193843, 0.5039488, 1.3, 0.47558582, 0.05811842, 0.071368106, -0.094215095, 0.1252107,
    -0.536142, 0.44068107, -0.0721882, -0.060900763, -0.01852177, 0.63575315, 0.31896317, 0.41160795, 0.434752, 0.5170022, 1.3, 0.6498838, 0.03389057, 0.04883461, -0.025816558, 1.2203748, 0.25609162, 0.29915473, 0.33543223, 0.3565349, 0.8422155, 0.35993066, 0.27086964, 0.19241738, 0.17358808, 0.13059403,
    -1.3, 0.4657315, -0.075047635, -0.058460426, -0.023730224, 0.46601757, 0.31277692, 0.3513538, 0.3841172, 0.4333364, 1.3, 0.660616, 0.013305119, 0.03489009, -0.021632934, 1.3, 0.26063284, 0.2646427, 0.325628, 0.32546288, 0.7892822, 0.36002868, 0.3716163, 0.25191626, 0.288383, 0.13587427,
    -0.22891606, 0.32938, 0.034302134, 0.03122661, 0.08164243, 1.3, 0.3340622, 0.3330317, 0.3509813, 0.38811958, 0.17634434, 0.6432112, -0.062000394, -0.02878512, -0.057749785, 1.3, 0.2670127, 0.23616919, 0.3221168, 0.29573455, 0.9655158, 0.3563886, 0.36715856, 0.24677339, 0.2873116, 0.13803065
};

float film_pm_with_variate(int j, int n, float exponent, float squared_distance_) {
    return exponent - 0.7213475204444817 * abs(film_lobes[11 * j + 4 + n]) * squared_distance_;
}

float film_pm_with_features(int j, float exponent, film_PmFeatures features) {
    float sum = exponent;
    for (int k = 0; k < 4; ++k) sum = sum + 1.4426950408889634 * film_lobes[11 * j + 7 + k] * features.x[k];
    return sum;
}

// g(wl, wv) = sum_j beta_j e^(s_j) prod_n G(psi_n . xi_jn | lambda_jn) prod_k e^(kappa_jk x_k(wl, wv)) [1/sr], for
// R, G, B. Here psi_n = normalize(a_n wl + b_n wv), and x_k are the further features, which are symmetric.
// rho(wl, wv) = g(wl, wv), or the mean of g(wl, wv) and g(wv, wl) in a reciprocal model. A negative sum counts as 0:
// the colour of a spectral model's lobe may have a negative channel.
float3 film_pm_value(float3 wl, float3 wv) {
    float up[3];
    float down[3];
    float exchanged_up[3];
    float exchanged_down[3];
    for (int n = 0; n < 3; ++n) {
        float a = film_variates[2 * n];
        float b = film_variates[2 * n + 1];
        film_AxialPsi psi_ = film_axial_psi(wl, wv, a, b);
        up[n] = film_squared_distance_from_pole(psi_, 1.0);
        down[n] = film_squared_distance_from_pole(psi_, -1.0);
        film_AxialPsi exchanged = film_axial_psi(wv, wl, a, b);
        exchanged_up[n] = film_squared_distance_from_pole(exchanged, 1.0);
        exchanged_down[n] = film_squared_distance_from_pole(exchanged, -1.0);
    }
    film_PmFeatures features = film_pm_further_features(wl, wv);
    float3 sum = float3(0.0, 0.0, 0.0);
    for (int j = 0; j < 9; ++j) {
        float exponent = film_pm_with_features(j, 1.4426950408889634 * film_lobes[11 * j + 3], features);
        float exchanged_exponent = exponent;
        for (int n = 0; n < 3; ++n) {
            exponent = film_pm_with_variate(j, n, exponent, film_lobes[11 * j + 4 + n] < 0.0 ? down[n] : up[n]);
            exchanged_exponent = film_pm_with_variate(j, n, exchanged_exponent, film_lobes[11 * j + 4 + n] < 0.0 ?
                    exchanged_down[n] : exchanged_up[n]);
        }
        float power = film_pm_power(exponent);
        power = 0.5 * (power + film_pm_power(exchanged_exponent));
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
