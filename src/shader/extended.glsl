// Light of any extent, to follow albedo.glsl. What precedes:
//   light_lobes  for each of EXTENDED_NODES nodes, placed as those of albedos, and each of EXTENDED_LOBES lobes: p, roughness,
//                weight R, G, B

// A lobe of f_r cos(theta_l) over the light for a view: what an environment, blurred as for GGX of that roughness seen
// along the normal, shows in the direction `axis` is reflected with `weight`.
struct LightLobe {
    Vec3 axis;
    Real roughness;
    Vec3 weight;
};
Real light_number(int i, NodesAbout nodes) {
    int at = 5 * EXTENDED_LOBES * nodes.below + i;
    return light_lobes[at] + nodes.beyond * (light_lobes[at + 5 * EXTENDED_LOBES] - light_lobes[at]);
}
// Lobe k, of which the first is the cosine about the normal, for a view wv above the horizon.
LightLobe environment_lobe(Vec3 wv, int k) {
    NodesAbout nodes = nodes_about(elevation_coordinate(wv.z), EXTENDED_NODES);
    Real p = light_number(5 * k, nodes);
    LightLobe lobe;
    lobe.axis = Vec3(-p * wv.x, -p * wv.y, sqrt(max(Real(1.0) - p * p * (Real(1.0) - wv.z * wv.z), Real(0.0))));
    lobe.roughness = light_number(5 * k + 1, nodes);
    lobe.weight = Vec3(light_number(5 * k + 2, nodes), light_number(5 * k + 3, nodes), light_number(5 * k + 4, nodes));
    return lobe;
}

// The radiance of the environment, which the host supplies: in a direction of the local frame, blurred as for GGX of a
// roughness, as an engine's filtered maps hold it. At roughness 1 it is irradiance / pi.
Vec3 radiance(Vec3 direction, Real roughness);
// The radiance that leaves towards the viewer.
Vec3 environment(Vec3 wv) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (wv.z <= Real(0.0)) return sum;
    for (int k = 0; k < EXTENDED_LOBES; ++k) {
        LightLobe lobe = environment_lobe(wv, k);
        Vec3 light = radiance(lobe.axis, lobe.roughness);
        sum = sum + Vec3(lobe.weight.x * light.x, lobe.weight.y * light.y, lobe.weight.z * light.z);
    }
    return sum;
}
