// Directional albedo. This text follows mixture.glsl, and requires:
//   albedo_node(pm, i)  R, G, B of node i of ALBEDO_NODES, which are uniform in
//                       sqrt(sqrt(cos(theta_v))) - sqrt(1 - cos(theta_v)), from the horizon to the normal

// A coordinate of the cosine from 0 at the horizon to 1 at the normal.
Real elevation_coordinate(Real cosine) {
    Real c = min(max(cosine, Real(0.0)), Real(1.0));
    return Real(0.5) * (Real(1.0) + sqrt(sqrt(c)) - sqrt(Real(1.0) - c));
}
// The integral of f_r cos(theta_l) over the directions to the light, for R, G, B, at the cosine of the view to the
// normal; 0 unless that is above 0.
Vec3 directional_albedo(Real cosine, Pm pm) {
    if (!(Real(0.0) < cosine)) return Vec3(Real(0.0), Real(0.0), Real(0.0));
    NodesAbout nodes = nodes_about(elevation_coordinate(cosine), ALBEDO_NODES);
    return (Real(1.0) - nodes.beyond) * albedo_node(pm, nodes.below) + nodes.beyond * albedo_node(pm, nodes.below + 1);
}
