// Light of any extent, to follow albedo.glsl. What precedes, of each of EXTENDED_LOBES lobes but the first between two of
// EXTENDED_NODES nodes, which are placed as those of albedos:
//   light_shape(k, nodes)              (p, roughness, any)
//   light_weight(k, whole, nodes, pm)  its weight R, G, B, where `whole` is what all weights sum to
//   light_whole(albedo)                what the weights of all lobes sum to where that is the directional albedo
//   light_width(nodes)                 the solid angle to which a view is reflected

// A lobe of f_r cos(theta_l) over the light for a view: what an environment, filtered as for GGX of that roughness seen
// along the normal, shows in the direction `axis` is reflected with `weight`, which may be negative.
struct LightLobe {
    Vec3 axis;
    Real roughness;
    Vec3 weight;
};
Vec3 times(Vec3 a, Vec3 b) { return Vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
// A sum of lobes, which can be a little less than 0 where nearly all light comes from few directions.
Vec3 not_negative(Vec3 sum) {
    return Vec3(max(sum.x, Real(0.0)), max(sum.y, Real(0.0)), max(sum.z, Real(0.0)));
}
// The radiance that a view reflects of radiance 1 all round.
Vec3 reflected_of_one(Vec3 wv, Pm pm) { return light_whole(directional_albedo(wv.z, pm)); }
// A lobe after the first; `whole` is reflected_of_one.
LightLobe lobe_about(Vec3 wv, int k, NodesAbout nodes, Vec3 whole, Pm pm) {
    Vec3 shape = light_shape(k, nodes);
    Real p = shape.x;
    LightLobe lobe;
    lobe.axis = Vec3(-p * wv.x, -p * wv.y, sqrt(max(Real(1.0) - p * p * (Real(1.0) - wv.z * wv.z), Real(0.0))));
    lobe.roughness = shape.y;
    lobe.weight = light_weight(k, whole, nodes, pm);
    return lobe;
}
// The first lobe, the cosine about the normal, which has what the others leave.
LightLobe cosine_lobe(Vec3 weight) {
    LightLobe lobe;
    lobe.axis = Vec3(Real(0.0), Real(0.0), Real(1.0));
    lobe.roughness = Real(1.0);
    lobe.weight = weight;
    return lobe;
}
// Lobe k for a view wv above the horizon.
LightLobe environment_lobe(Vec3 wv, int k, Pm pm) {
    NodesAbout nodes = nodes_about(elevation_coordinate(wv.z), EXTENDED_NODES);
    Vec3 whole = reflected_of_one(wv, pm);
    if (k > 0) return lobe_about(wv, k, nodes, whole, pm);
    Vec3 rest = whole;
    for (int j = 1; j < EXTENDED_LOBES; ++j) rest = rest - light_weight(j, whole, nodes, pm);
    return cosine_lobe(rest);
}

// The radiance of the environment, which the host supplies: in a direction of the local frame, filtered as for GGX of a
// roughness, as an engine's maps hold it. At roughness 1 it is irradiance / pi. Lobes are fitted to maps of
// 6 levels, of which level 5 sqrt(roughness) is looked up, between levels linearly.
Vec3 radiance(Vec3 direction, Real roughness);
// The radiance that leaves towards the viewer.
Vec3 environment(Vec3 wv, Pm pm) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (wv.z <= Real(0.0)) return sum;
    NodesAbout nodes = nodes_about(elevation_coordinate(wv.z), EXTENDED_NODES);
    Vec3 whole = reflected_of_one(wv, pm);
    Vec3 rest = whole;
    for (int k = 1; k < EXTENDED_LOBES; ++k) {
        LightLobe lobe = lobe_about(wv, k, nodes, whole, pm);
        sum = sum + times(lobe.weight, radiance(lobe.axis, lobe.roughness));
        rest = rest - lobe.weight;
    }
    return not_negative(sum + times(rest, radiance(Vec3(Real(0.0), Real(0.0), Real(1.0)), Real(1.0))));
}

// A polygon of up to five corners, which follow each other.
struct Polygon {
    int count;
    Vec3 corner[5];
};
Polygon with_corner(Polygon of, Vec3 corner) {
    Polygon more = of;
    more.corner[of.count] = corner;
    more.count = of.count + 1;
    return more;
}
// The part above z = 0 of four corners and their edges.
Polygon above_horizon(Polygon of) {
    Polygon kept = of;
    kept.count = 0;
    for (int i = 0; i < of.count; ++i) {
        Vec3 here = of.corner[i];
        Vec3 next = of.corner[i + 1 < of.count ? i + 1 : 0];
        if (here.z > Real(0.0)) kept = with_corner(kept, here);
        if (here.z * next.z < Real(0.0)) kept = with_corner(kept, here + here.z / (here.z - next.z) * (next - here));
    }
    return kept;
}
// An angle over its sine.
Real angle_over_sine(Real cosine) {
    if (cosine > Real(0.999)) return Real(1.0) + (Real(1.0) - cosine) / Real(3.0);
    Real least = max(cosine, Real(-0.99999));
    return acos(least) / sqrt(Real(1.0) - least * least);
}
// The integral of cos(theta) / pi over the directions of a polygon above the horizon, by its edges (Lambert 1760).
Real cosine_over(Polygon of) {
    Real sum = Real(0.0);
    for (int i = 0; i < of.count; ++i) {
        Vec3 here = of.corner[i];
        Vec3 next = of.corner[i + 1 < of.count ? i + 1 : 0];
        Real scale = inversesqrt(max(dot(here, here) * dot(next, next), Real(1.0e-30)));
        sum = sum + scale * (here.x * next.y - here.y * next.x) * angle_over_sine(scale * dot(here, next));
    }
    return abs(sum) * Real(0.15915494);
}
// The integral over a polygon of a lobe's part of weight 1: GGX's kernel of its roughness, without the levels of a map. It is
// nearly a cosine about the axis whose directions are drawn together, and the polygon's are drawn apart instead (Heitz et
// al. 2016).
Real lobe_over(LightLobe lobe, Polygon of) {
    Vec3 axis = lobe.axis;
    Real r = max(lobe.roughness, Real(0.01));
    Real apart = sqrt(Real(1.0) + Real(3.0) * r * r * r) / (Real(2.0) * r * r);
    Real x = axis.x;
    Real y = axis.y;
    Real s = Real(1.0) / (Real(1.0) + axis.z);
    Polygon about = of;
    for (int i = 0; i < of.count; ++i) {
        Vec3 p = of.corner[i];
        about.corner[i] = Vec3(apart * dot(Vec3(Real(1.0) - x * x * s, -x * y * s, -x), p),
                               apart * dot(Vec3(-x * y * s, Real(1.0) - y * y * s, -y), p), dot(axis, p));
    }
    return cosine_over(above_horizon(about));
}
// The largest squared distance of a light's corners from its middle, on the unit sphere.
Real squared_size(Polygon of) {
    Vec3 middle = of.corner[0] + of.corner[1] + of.corner[2] + of.corner[3];
    Real least = Real(1.0);
    for (int i = 0; i < 4; ++i) {
        Vec3 corner = of.corner[i];
        Real reciprocal = inversesqrt(max(dot(middle, middle) * dot(corner, corner), Real(1.0e-30)));
        least = min(least, reciprocal * dot(middle, corner));
    }
    return Real(2.0) * (Real(1.0) - least);
}
// How much of a light of this squared size is seen as by points: all of it to 3 times the solid angle of what is
// reflected, and nothing from 12 times on, where they would show as dots.
Real share_of_points(Real squared, Real width) {
    Real x = min(max(Real(1.3333333) - squared / (Real(2.25) * min(Real(4.0) * width, Real(0.15))), Real(0.0)), Real(1.0));
    return x * x * (Real(3.0) - Real(2.0) * x);
}
// A node of Gauss' rule of three on [0, 1], and its weight.
Real gauss_node(int i) { return Real(0.5) + Real(0.38729833) * Real(i - 1); }
Real gauss_weight(int i) { return i == 1 ? Real(0.44444444) : Real(0.27777778); }
// The volume of the parallelepiped of three vectors.
Real volume(Vec3 a, Vec3 b, Vec3 c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}
// The integral of f_r cos(theta_l) over the directions of four corners, by nine points in each of parts x parts.
Vec3 by_points(Su su, Vec3 wv, Polygon of, int parts, Pm pm) {
    Real part = Real(1.0) / Real(parts);
    Vec3 along = of.corner[1] - of.corner[0];
    Vec3 across = of.corner[3] - of.corner[0];
    Vec3 askew = of.corner[2] - of.corner[3] - along;
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    for (int i = 0; i < 3 * parts; ++i) {
        for (int j = 0; j < 3 * parts; ++j) {
            int of_i = i - 3 * (i / 3);
            int of_j = j - 3 * (j / 3);
            Real s = part * (Real(i / 3) + gauss_node(of_i));
            Real t = part * (Real(j / 3) + gauss_node(of_j));
            Vec3 p = of.corner[0] + s * along + t * across + s * t * askew;
            Real reciprocal = inversesqrt(max(dot(p, p), Real(1.0e-12)));
            Real solid_angle = abs(volume(p, along + t * askew, across + s * askew)) * reciprocal * reciprocal * reciprocal;
            Vec3 wl = reciprocal * p;
            Real weight = part * part * gauss_weight(of_i) * gauss_weight(of_j);
            sum = sum + weight * solid_angle * max(wl.z, Real(0.0)) * brdf(su, wl, wv, pm);
        }
    }
    return sum;
}
// The radiance that leaves towards the viewer from a quadrilateral of radiance 1 on either side, whose corners follow
// each other: from the point of the surface, in the local frame. A small one is seen by points, since it shows f_r itself;
// others are the sum of the lobes.
Vec3 area(Su su, Vec3 wv, Vec3 a, Vec3 b, Vec3 c, Vec3 d, Pm pm) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (wv.z <= Real(0.0)) return sum;
    Polygon light;
    light.count = 4;
    light.corner[0] = a;
    light.corner[1] = b;
    light.corner[2] = c;
    light.corner[3] = d;
    light.corner[4] = d;
    NodesAbout nodes = nodes_about(elevation_coordinate(wv.z), EXTENDED_NODES);
    Real width = light_width(nodes);
    Real squared = squared_size(light);
    Real share = share_of_points(squared, width);
    // Nine points are enough for a light that is smaller than what is reflected.
    if (share > Real(0.0)) sum = share * by_points(su, wv, light, squared < Real(0.75) * width ? 1 : 2, pm);
    if (share >= Real(1.0)) return sum;
    Vec3 whole = reflected_of_one(wv, pm);
    Vec3 rest = whole;
    for (int k = 1; k < EXTENDED_LOBES; ++k) {
        LightLobe lobe = lobe_about(wv, k, nodes, whole, pm);
        sum = sum + (Real(1.0) - share) * lobe_over(lobe, light) * lobe.weight;
        rest = rest - lobe.weight;
    }
    return not_negative(sum + (Real(1.0) - share) * lobe_over(cosine_lobe(rest), light) * rest);
}
