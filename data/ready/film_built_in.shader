// The measured material film for Unity (built-in render pipeline). NOT RUN in Unity: it was written from Unity's documentation, and
// compiled and drawn with functions that stand in for Unity's.
//
// Put this file into a folder below Assets, and create a material of the shader "Measured/Film". The project must use linear
// colours (Player Settings).
Shader "Measured/Film"
{
    Properties
    {
        _Tint ("Tint", Color) = (1, 1, 1, 1)
    }

    CGINCLUDE
    #include "UnityCG.cginc"
    #include "Lighting.cginc"
    #include "AutoLight.cginc"
    #ifndef UNITY_SPECCUBE_LOD_STEPS
    #define UNITY_SPECCUBE_LOD_STEPS 6  // the level of a reflection probe for roughness 1
    #endif

    float4 _Tint;
    static float3x3 to_local;  // its rows are the axes of the surface's frame in world space; the last one is the normal

    float3x3 frame_about(float3 n)
    {
        float3 t = normalize(abs(n.y) < 0.9 ? cross(float3(0, 1, 0), n) : cross(float3(1, 0, 0), n));
        return float3x3(t, cross(n, t), n);
    }

    // The environment, filtered as for GGX of this roughness: the reflection probe, or for roughness 1 the ambient light and light probes,
    // whose values are irradiance / pi.
    float3 probe_radiance(float3 direction, float roughness)
    {
        float3 in_world = mul(direction, to_local);
        if (roughness >= 1.0) return max(ShadeSH9(float4(in_world, 1)), 0.0);
        float level = UNITY_SPECCUBE_LOD_STEPS * roughness * (1.7 - 0.7 * roughness);  // as Unity's own materials look it up
        return DecodeHDR(UNITY_SAMPLE_TEXCUBE_LOD(unity_SpecCube0, in_world, level), unity_SpecCube0_HDR);
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

// The weights a, b of each variate.
static const float film_variates[6] = {
    1.0683594, 0.95166016,
    1.1669922, 0.17358398,
    1.1083984, 0.3918457
};

// A row for each lobe: its coefficient (R, G, B) and log scale, a bandwidth for each variate, negative where its centre
// is -z, exponents.
static const float film_lobes[99] = {
    0.98291016, 0.3232422, 0.33935547, 102.625, -9.296875, 98.9375, -42.40625, 0.875, -59.8125, 44.5625, 2.2480469,
    0.9951172, 0.39331055, 0.0, 18.953125, 1.4765625, 9.890625, -10.8828125, 1.5068359, -11.71875, 0.5654297, 3.7246094,
    1.0, 0.57373047, 0.048339844, 0.052459717, -2.4589844, 41.125, 1.7402344, 0.0, -43.1875, 25.8125, 0.11907959,
    0.0, 0.014404297, 1.0048828, 29.59375, -0.5131836, 34.125, -15.5546875, 0.08148193, -17.25, 10.3125, 2.0917969,
    0.95458984, 0.40722656, 0.83740234, 300.0, -11.015625, 199.0, -139.0, 33.125, -152.75, 106.625, 1.4082031,
    0.93652344, 0.9897461, 0.96728516, 48.28125, 5.9726562, 66.375, -27.28125, 0.0, -54.3125, 38.28125, 5.6132812,
    0.9921875, 1.0097656, 1.0371094, 239.25, 64.375, -145.0, 57.65625, 0.023025513, 28.046875, 32.90625, -22.515625,
    1.0625, 0.5522461, 0.07733154, 134.625, 16.1875, -82.25, 56.09375, 0.20385742, 1.3642578, 8.359375, -11.6640625,
    1.0, 0.17260742, 0.0, -1.7792969, 15.4453125, -7.5976562, 3.3984375, 0.49951172, -1.6914062, 0.3088379, -19.234375
};

// Directional albedo (R, G, B), a row for each node.
static const float film_albedo_nodes[387] = {
    0.32768926, 0.32439944, 0.31970873,
    0.32768926, 0.32439944, 0.31970873,
    0.32768768, 0.32439798, 0.3197073,
    0.34463805, 0.3377542, 0.32987234,
    0.35903984, 0.34865448, 0.33764082,
    0.37164965, 0.35789916, 0.34386414,
    0.3830254, 0.36602068, 0.34905726,
    0.39345962, 0.37329766, 0.35348877,
    0.40311405, 0.37988567, 0.3573096,
    0.41207573, 0.38587078, 0.3606052,
    0.42038414, 0.39129612, 0.36342177,
    0.42804423, 0.39617392, 0.36577716,
    0.4350468, 0.4005049, 0.36768064,
    0.44136217, 0.40427268, 0.3691265,
    0.4469454, 0.40744695, 0.3700967,
    0.45175654, 0.41000432, 0.37058154,
    0.45574552, 0.4119123, 0.37056297,
    0.4588685, 0.41314504, 0.3700301,
    0.46109346, 0.41368794, 0.36898232,
    0.4623977, 0.4135348, 0.36742643,
    0.4627743, 0.41269344, 0.36538142,
    0.4622432, 0.4111955, 0.36288694,
    0.46084794, 0.409093, 0.35999975,
    0.45866317, 0.40646502, 0.3567996,
    0.45579672, 0.40341917, 0.3533898,
    0.45238528, 0.4000871, 0.3498928,
    0.44860226, 0.3966318, 0.34645718,
    0.44465467, 0.39324486, 0.34325477,
    0.44076562, 0.39012894, 0.34046385,
    0.4371791, 0.38750312, 0.33827505,
    0.43413872, 0.3855813, 0.3368705,
    0.43187243, 0.38455793, 0.33641094,
    0.43056813, 0.38458338, 0.33701265,
    0.430351, 0.38574132, 0.33872604,
    0.4312694, 0.38803628, 0.34152502,
    0.4333045, 0.3914037, 0.3453173,
    0.43630278, 0.39564115, 0.3498788,
    0.4400079, 0.4004425, 0.35488728,
    0.44406566, 0.40540367, 0.3599292,
    0.44806597, 0.4100678, 0.3645441,
    0.45161983, 0.4140058, 0.36830372,
    0.45435572, 0.41681325, 0.37080875,
    0.45597005, 0.41816306, 0.37174046,
    0.4562754, 0.41785592, 0.37090838,
    0.4551954, 0.41581535, 0.36824495,
    0.4527223, 0.41204256, 0.3637594,
    0.4489818, 0.4066835, 0.3576013,
    0.44416407, 0.3999566, 0.34998924,
    0.438429, 0.39205196, 0.34111157,
    0.431888, 0.3831107, 0.331107,
    0.4247559, 0.3733827, 0.32021815,
    0.41720706, 0.3630733, 0.30864337,
    0.40939844, 0.35236743, 0.2965611,
    0.40148693, 0.3414469, 0.28414834,
    0.39357167, 0.33042976, 0.27152127,
    0.3858516, 0.31953233, 0.2588927,
    0.37843445, 0.30887336, 0.2463808,
    0.37145606, 0.29859668, 0.23413469,
    0.36494905, 0.28873917, 0.22219583,
    0.35906357, 0.27945074, 0.21072093,
    0.35379618, 0.27072737, 0.1997154,
    0.3492314, 0.26265174, 0.18927945,
    0.34532663, 0.25517616, 0.1793811,
    0.34211174, 0.24832825, 0.17007111,
    0.33949697, 0.2420122, 0.16127783,
    0.33762255, 0.23636797, 0.15317775,
    0.33623064, 0.23113447, 0.14554308,
    0.33539665, 0.22638321, 0.1384836,
    0.3350006, 0.22199683, 0.13192979,
    0.33505434, 0.21798712, 0.12594104,
    0.3353912, 0.21418652, 0.12039611,
    0.33607018, 0.21065064, 0.11539675,
    0.33692634, 0.20722371, 0.11084161,
    0.33795282, 0.20389718, 0.10676385,
    0.33910328, 0.2006258, 0.103156365,
    0.3403643, 0.1973975, 0.10003818,
    0.34167567, 0.19415884, 0.09738095,
    0.3430426, 0.190919, 0.09520509,
    0.34443024, 0.18765351, 0.09348926,
    0.34583545, 0.18437651, 0.0922393,
    0.34722653, 0.18107726, 0.09142667,
    0.34859955, 0.17778036, 0.09104535,
    0.3499216, 0.17448731, 0.0910594,
    0.351142, 0.17119882, 0.09142986,
    0.35224485, 0.16794129, 0.092127375,
    0.35317156, 0.16471276, 0.09310118,
    0.35385284, 0.16151144, 0.09430263,
    0.35424742, 0.15834719, 0.09569212,
    0.35429794, 0.15522082, 0.09722407,
    0.35396537, 0.1521363, 0.09886645,
    0.3532205, 0.14910044, 0.10059514,
    0.35202906, 0.14611088, 0.10239085,
    0.35041696, 0.14318965, 0.10425814,
    0.3483812, 0.14033964, 0.10619628,
    0.34596568, 0.13757952, 0.10822367,
    0.34322596, 0.13492988, 0.11035939,
    0.34019804, 0.1323979, 0.112614535,
    0.33695295, 0.13000175, 0.11500784,
    0.333527, 0.12774292, 0.11753639,
    0.32997242, 0.12562759, 0.120193236,
    0.3263269, 0.12365369, 0.12295772,
    0.322603, 0.12180747, 0.12579241,
    0.3188068, 0.12007254, 0.12864964,
    0.3149457, 0.11843256, 0.13147938,
    0.3109989, 0.116859965, 0.13421962,
    0.30696157, 0.11533521, 0.13681485,
    0.3028182, 0.11383526, 0.13920975,
    0.2985716, 0.112345695, 0.14136408,
    0.29420575, 0.110846795, 0.14323235,
    0.28974366, 0.10933493, 0.1448005,
    0.28517982, 0.10779753, 0.14604245,
    0.28054816, 0.10623907, 0.1469615,
    0.27587512, 0.1046624, 0.14756228,
    0.2711891, 0.103072755, 0.14785494,
    0.26653588, 0.10148314, 0.1478672,
    0.26195258, 0.09990454, 0.14762565,
    0.2574838, 0.09835211, 0.1471659,
    0.2531948, 0.09685037, 0.14654273,
    0.24913828, 0.09542011, 0.14580669,
    0.24536012, 0.094079934, 0.1450069,
    0.24192762, 0.092857465, 0.14420839,
    0.23886915, 0.09176502, 0.14344832,
    0.23620585, 0.090812065, 0.14275691,
    0.23394102, 0.090000816, 0.14214927,
    0.23209414, 0.089339375, 0.14164847,
    0.23065533, 0.0888241, 0.14125389,
    0.229632, 0.08845797, 0.1409746,
    0.22901136, 0.08823581, 0.14080286,
    0.22880769, 0.088162996, 0.14074804
};

// A row for each node: p, roughness and share of the albedo (R, G, B) of each lobe after the first; width.
static const float film_light_lobes[832] = {
    0.99148476, 0.060819466, 0.11621341, 0.13217957, 0.13422593, 0.9009111, 0.37633744, 1.1992626, 1.0264479, 0.79129463, 0.98045343, 0.16000208, 0.2605859, 0.3525804, 0.5001605, 0.9705914, 0.46629676, -0.88368005, -0.7667006, -0.61835575, 0.9977971, 0.5342239, 0.28399917, 0.24182563, 0.19035016, 0.037085075,
    0.99148476, 0.060819466, 0.116203375, 0.13217491, 0.13423045, 0.9009111, 0.37633744, 1.1992531, 1.0264411, 0.79129267, 0.98045343, 0.16000208, 0.26057458, 0.35257414, 0.500163, 0.9705914, 0.46629676, -0.8836805, -0.766698, -0.61834735, 0.9977971, 0.5342239, 0.28400517, 0.24183461, 0.19036561, 0.037085075,
    0.9912996, 0.053283826, 0.11618324, 0.13216557, 0.13423957, 0.900235, 0.3771643, 1.1992341, 1.0264277, 0.7912887, 0.9802738, 0.16019085, 0.26055184, 0.3525616, 0.500168, 0.970722, 0.46674946, -0.8836815, -0.76669276, -0.6183305, 0.99804294, 0.53412783, 0.28401706, 0.2418526, 0.1903966, 0.03818866,
    0.9917499, 0.07275948, 0.11616305, 0.13215935, 0.13425687, 0.89986235, 0.37939608, 1.1992127, 1.0264125, 0.79128397, 0.9786196, 0.16071852, 0.26052716, 0.35254994, 0.50017846, 0.9711015, 0.47086617, -0.88367486, -0.76667917, -0.6183033, 0.9981434, 0.533768, 0.2840442, 0.24188632, 0.19044563, 0.03918262,
    0.990934, 0.05, 0.116148956, 0.13218085, 0.13433471, 0.8925611, 0.4034303, 1.1991744, 1.0263834, 0.791269, 0.97782737, 0.16061318, 0.26049587, 0.35255125, 0.5002319, 0.97086626, 0.5298873, -0.8835992, -0.7665932, -0.61819404, 0.9990092, 0.5848127, 0.28420424, 0.24205329, 0.19063978, 0.037434004,
    0.9911845, 0.05, 0.116567485, 0.13298017, 0.13566358, 0.8928244, 0.41064376, 1.1985562, 1.0257498, 0.79056984, 0.9742138, 0.16007842, 0.26057792, 0.3529693, 0.5011238, 0.9743795, 0.53736705, -0.8827044, -0.76560485, -0.6170276, 0.9990516, 0.5806563, 0.28614736, 0.24407986, 0.19294143, 0.03268894,
    0.99111706, 0.08018589, 0.123504706, 0.14098556, 0.14464761, 0.8921868, 0.43461668, 1.1922679, 1.0179161, 0.78020996, 0.97451687, 0.16027583, 0.26546264, 0.35851663, 0.5072672, 0.9727636, 0.5461386, -0.8846323, -0.7666514, -0.61715525, 0.9992037, 0.5885634, 0.28598145, 0.24564256, 0.19699398, 0.025381817,
    0.99373484, 0.05, 0.15538168, 0.17467332, 0.17835124, 0.8799729, 0.50066173, 1.1609541, 0.9773031, 0.727388, 0.97668076, 0.16000018, 0.29083908, 0.38355255, 0.53048867, 0.95933294, 0.6442196, -0.8931988, -0.7729626, -0.6211841, 0.99962646, 0.6698983, 0.27869543, 0.24422649, 0.2038671, 0.018221037,
    0.99700755, 0.05, 0.22256757, 0.24596071, 0.24729991, 0.88446933, 0.52888167, 1.0469472, 0.8457235, 0.58363897, 0.97851634, 0.15999779, 0.3385977, 0.42939124, 0.5681499, 0.9641, 0.6600278, -0.89434886, -0.76666117, -0.60517085, 1.0, 0.70100516, 0.28921977, 0.25941783, 0.22447823, 0.01299589,
    0.9980984, 0.05, 0.3077657, 0.3357841, 0.3337725, 0.8921993, 0.54400754, 0.8395218, 0.62412834, 0.37241706, 0.97973704, 0.15996389, 0.37736556, 0.46082604, 0.5804153, 0.9681109, 0.66281337, -0.8224096, -0.6802766, -0.5070567, 1.0, 0.71488285, 0.3003697, 0.26980236, 0.23016973, 0.010628612,
    1.0, 0.05, 0.38105306, 0.4200631, 0.4268292, 0.88767207, 0.5203807, 0.605498, 0.3931564, 0.17902508, 0.9817243, 0.15997298, 0.37529448, 0.44861248, 0.54175234, 0.9652517, 0.6689466, -0.6058925, -0.46527958, -0.30812982, 1.0, 0.7961685, 0.24424177, 0.20836452, 0.1625474, 0.010599084,
    1.0, 0.052091207, 0.46118292, 0.51418525, 0.54434705, 0.8869604, 0.5151185, 0.44219086, 0.25441477, 0.08014624, 0.9820612, 0.1599745, 0.34178695, 0.3909236, 0.44352582, 0.963218, 0.6722445, -0.41032422, -0.28642136, -0.15892668, 1.0, 0.7916297, 0.15943743, 0.12742133, 0.089811586, 0.012609192,
    1.0, 0.12000597, 0.5511966, 0.6279318, 0.6978285, 0.8739606, 0.4774196, 0.3083055, 0.15588644, 0.02490776, 0.9776685, 0.15994637, 0.26353893, 0.29512596, 0.3086487, 0.9716648, 0.6899899, -0.19968082, -0.1330953, -0.0749789, 0.99661976, 1.0, 0.069188334, 0.054490082, 0.04323955, 0.016724568,
    1.0, 0.15999311, 0.59810954, 0.70746607, 0.83613235, 0.8750686, 0.47202566, 0.32918397, 0.16253844, 0.014426142, 0.966945, 0.21308525, 0.20581792, 0.22029936, 0.1883832, 0.9709287, 0.67777276, -0.19923681, -0.13923447, -0.08151797, 0.99982476, 1.0, 0.05467182, 0.046501573, 0.04037702, 0.022599371,
    1.0062996, 0.16005717, 0.51519257, 0.63529956, 0.8028846, 0.8685704, 0.47586, 0.39060488, 0.20951556, 0.033003725, 0.9742634, 0.24796955, 0.26207334, 0.27815628, 0.22402462, 0.9713478, 0.6700779, -0.22804941, -0.17101867, -0.10788183, 1.0062996, 1.0, 0.049465626, 0.045899507, 0.045183167, 0.030927818,
    1.0265164, 0.19899791, 0.33242464, 0.42234772, 0.5360126, 0.9025699, 0.43523285, 0.5711088, 0.36003536, 0.11457308, 0.9915004, 0.16008689, 0.27417812, 0.36410725, 0.4491787, 0.9999151, 0.64363116, -0.23562019, -0.19051476, -0.14913064, 1.0261934, 1.0, 0.04339889, 0.04084353, 0.047757205, 0.039966006,
    1.0324128, 0.27250308, 0.29768926, 0.35032663, 0.38452852, 0.9057928, 0.412156, 0.5925109, 0.39036602, 0.1299056, 1.0002143, 0.16009259, 0.2704975, 0.40654373, 0.5979311, 1.0338575, 0.6402118, -0.26931772, -0.23799358, -0.20224524, 1.0526137, 0.8370822, 0.092072025, 0.08610801, 0.08836445, 0.051309615,
    1.0119032, 0.31266552, 0.3995743, 0.41397512, 0.3074197, 0.9092949, 0.4139946, 0.53941983, 0.35481378, 0.15398327, 1.0061263, 0.1600177, 0.21369262, 0.36561292, 0.6329234, 1.0595356, 0.64009404, -0.3006234, -0.2578688, -0.20671867, 1.0857594, 0.7424158, 0.1306813, 0.11737622, 0.111974105, 0.06452992,
    1.0065182, 0.35996673, 0.44302332, 0.45807886, 0.23652081, 0.9277455, 0.41307396, 0.51410997, 0.33865178, 0.26120478, 1.0067637, 0.16020513, 0.19870977, 0.33961892, 0.6142257, 1.0920277, 0.63827056, -0.3190235, -0.27226254, -0.25093532, 1.1274269, 0.708276, 0.1443907, 0.12745567, 0.13963942, 0.080303945,
    1.0089628, 0.3605004, 0.52705055, 0.54800564, 0.23492081, 0.9485508, 0.41354814, 0.49306634, 0.32703498, 0.41675913, 1.0057702, 0.16609555, 0.15258592, 0.27356374, 0.52465105, 1.1176293, 0.6189424, -0.28553385, -0.23896094, -0.31656206, 1.1795448, 0.6989213, 0.09384167, 0.08027182, 0.14119522, 0.0978457,
    1.0194466, 0.3599659, 0.5880419, 0.5862276, 0.2598629, 0.9482155, 0.40106833, 0.3303548, 0.19764285, 0.4107347, 1.0051731, 0.23614337, 0.21318628, 0.33487374, 0.5829074, 1.1569464, 0.57368904, -0.18451148, -0.15761238, -0.41874716, 1.2447238, 0.6229286, 0.03211243, 0.025828611, 0.16236638, 0.113960065,
    0.9758127, 0.35996896, 0.71099776, 0.6292936, 0.46475905, 0.69133884, 0.3518586, -0.037978157, -0.050949853, 0.062403265, 1.0055373, 0.297812, 0.37396333, 0.4658159, 0.7561317, 1.1625205, 0.51522183, -0.046702106, -0.029323027, -0.39584458, 1.2918698, 0.6301773, -0.023654582, -0.029749194, 0.10922621, 0.12635921,
    0.9615863, 0.36000237, 0.69134974, 0.6025081, 0.51245046, 0.66092527, 0.34840506, -0.07592053, -0.07733493, 0.01567232, 1.0024261, 0.30954278, 0.40915164, 0.47288698, 0.73298943, 1.1939027, 0.53173554, -0.015535386, 0.045386154, -0.4092932, 1.3, 0.6428943, -0.032634158, -0.060091823, 0.14477514, 0.1335006,
    0.9544823, 0.3600363, 0.669191, 0.5895286, 0.549643, 0.6113378, 0.34910205, -0.08644831, -0.08176636, -0.00892163, 1.0015966, 0.31508622, 0.43631008, 0.46818018, 0.7164502, 1.204057, 0.53030914, -0.012005505, 0.0770727, -0.3966685, 1.3, 0.66743237, -0.031420276, -0.07233817, 0.138702, 0.13526356,
    0.9437016, 0.36063465, 0.652684, 0.58440596, 0.5708224, 0.5734245, 0.34605306, -0.10053244, -0.09114751, -0.030693209, 0.99822855, 0.31261876, 0.45218375, 0.46246034, 0.6972289, 1.211048, 0.52090496, -0.0043770587, 0.080141135, -0.33144256, 1.3, 0.70295995, -0.025994372, -0.05883168, 0.095735595, 0.13061747,
    0.93478596, 0.36000025, 0.6341465, 0.5748787, 0.5807745, 0.5057951, 0.34728813, -0.095786214, -0.08334101, -0.038673818, 0.9960259, 0.29746538, 0.44811594, 0.4497018, 0.66524434, 1.2335424, 0.48039684, -0.0048355954, 0.0508518, -0.22509341, 1.3, 0.9419733, -0.010061814, -0.019047733, 0.023802781, 0.124195345,
    0.90064305, 0.3549868, 0.61472654, 0.56642336, 0.59391785, 0.38396382, 0.35112715, -0.0881908, -0.07675176, -0.03958764, 1.010245, 0.2874756, 0.4332394, 0.4379841, 0.61722386, 1.2786741, 0.47768047, 0.0160232, 0.053138655, -0.17927635, 1.3, 1.0, -0.006390073, -0.009818127, 0.015072623, 0.12115287,
    0.84590936, 0.3426423, 0.59261197, 0.5534068, 0.6145838, 0.19762646, 0.3859935, -0.07627453, -0.06575789, -0.029334497, 1.0539638, 0.28039548, 0.40615875, 0.41528603, 0.55603534, 1.3, 0.4800703, 0.042713888, 0.06476639, -0.14840211, 1.3, 1.0, -0.0035249498, -0.002869134, 0.013117907, 0.12322984,
    0.77884513, 0.3395407, 0.5799955, 0.5459019, 0.64059764, -0.08453753, 0.4280362, -0.07444408, -0.06421027, -0.032992586, 1.0982095, 0.28270265, 0.39846307, 0.40782088, 0.52696717, 1.3, 0.45745438, 0.041729838, 0.05849969, -0.1377633, 0.2861363, 1.0, 0.028976675, 0.039714105, 0.021474933, 0.13085684,
    0.64694536, 0.3386247, 0.5693452, 0.5385884, 0.64397234, -0.6457068, 0.43730202, -0.062269144, -0.05419976, -0.031019803, 1.215009, 0.2830347, 0.39854094, 0.4115585, 0.49488944, 1.3, 0.4738039, 0.03467308, 0.046249587, -0.11074168, 0.33036903, 1.0, 0.026767168, 0.03940922, 0.012892075, 0.1396376,
    0.35921654, 0.3406191, 0.5664344, 0.53179514, 0.6022131, -1.3, 0.43462837, -0.08859392, -0.07569608, -0.05618463, 1.3, 0.30297694, 0.45097816, 0.4672565, 0.51104087, 1.3, 0.65363944, -0.007749815, 0.003969095, -0.07521601, 0.7344607, 1.0, 0.026552623, 0.031118833, 0.017441763, 0.14730084,
    0.42791802, 0.33967647, 0.5433732, 0.5021075, 0.56540346, 0.878521, 0.35654664, 0.0650968, 0.035663478, 0.052482568, 1.3, 0.2901278, 0.35338584, 0.40842664, 0.44944945, 0.31942648, 0.63581485, -0.046674278, -0.022679672, -0.077298686, 1.3, 1.0, 0.026909174, 0.02756426, 0.005313312, 0.15029109
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


    struct Interpolated
    {
        float4 pos : SV_POSITION;
        float3 position : TEXCOORD0;  // in world space
        float3 normal : TEXCOORD1;
        UNITY_FOG_COORDS(2)
        UNITY_SHADOW_COORDS(3)
    };

    Interpolated vert(appdata_full v)
    {
        Interpolated o;
        UNITY_INITIALIZE_OUTPUT(Interpolated, o);
        o.pos = UnityObjectToClipPos(v.vertex);
        o.position = mul(unity_ObjectToWorld, v.vertex).xyz;
        o.normal = UnityObjectToWorldNormal(v.normal);
        UNITY_TRANSFER_SHADOW(o, v.texcoord1.xy);
        UNITY_TRANSFER_FOG(o, o.pos);
        return o;
    }

    // Sets the frame and returns the direction to the viewer in it. An interpolated normal may face away from the viewer; it is turned back.
    float3 viewer_in_frame(Interpolated i)
    {
        float3 viewer = normalize(UnityWorldSpaceViewDir(i.position)), normal = normalize(i.normal);
        to_local = frame_about(normalize(normal + max(0.01 - dot(normal, viewer), 0.0) * viewer));
        return mul(to_local, viewer);
    }

    // What the light of this pass adds. Unity's own diffuse term lacks 1/pi, therefore the factor pi.
    float3 reflected(Interpolated i, float3 wv)
    {
        UNITY_LIGHT_ATTENUATION(attenuation, i, i.position);
        float3 wl = mul(to_local, normalize(UnityWorldSpaceLightDir(i.position)));
        return UNITY_PI * film_brdf(wl, wv) * max(wl.z, 0.0) * _LightColor0.rgb * attenuation;
    }
    ENDCG

    SubShader
    {
        Tags { "RenderType" = "Opaque" }

        Pass  // the main light, reflection probe, ambient light and light probes
        {
            Tags { "LightMode" = "ForwardBase" }
            CGPROGRAM
            #pragma target 4.5
            #pragma vertex vert
            #pragma fragment frag
            #pragma multi_compile_fwdbase
            #pragma multi_compile_fog
            float4 frag(Interpolated i) : SV_Target
            {
                float3 wv = viewer_in_frame(i);
                float4 colour = float4(_Tint.rgb * (reflected(i, wv) + film_environment(wv)), 1);
                UNITY_APPLY_FOG(i.fogCoord, colour);
                return colour;
            }
            ENDCG
        }

        Pass  // each further light
        {
            Tags { "LightMode" = "ForwardAdd" }
            Blend One One
            ZWrite Off
            CGPROGRAM
            #pragma target 4.5
            #pragma vertex vert
            #pragma fragment frag
            #pragma multi_compile_fwdadd_fullshadows
            #pragma multi_compile_fog
            float4 frag(Interpolated i) : SV_Target
            {
                float4 colour = float4(_Tint.rgb * reflected(i, viewer_in_frame(i)), 1);
                UNITY_APPLY_FOG_COLOR(i.fogCoord, colour, float4(0, 0, 0, 0));
                return colour;
            }
            ENDCG
        }
    }
    FallBack "VertexLit"  // which casts shadows
}
