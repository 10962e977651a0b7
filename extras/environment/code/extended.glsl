// Light of any extent. Must follow albedo.glsl and these functions, which describe each of EXTENDED_LOBES lobes but
// the first between two of EXTENDED_NODES nodes, placed like those of albedos:
//   light_shape(k, nodes)              (p, roughness, any)
//   light_weight(k, whole, nodes, pm)  its weight R, G, B, where `whole` is the sum of all weights
//   light_whole(albedo)                the sum of the weights of all lobes for this directional albedo
//   light_width(nodes)                 the solid angle into which a view is reflected
//   reflected(weight, light)           their product, channel by channel

// A lobe of f_r cos(theta_l) over the light for a view. It reflects with `weight`, which may be negative, the
// radiance in the direction `axis` of an environment that is filtered as for GGX of this roughness viewed along the
// normal.
struct LightLobe {
    Vec3 axis;
    Real roughness;
    Vec3 weight;
};
// A sum of lobes, clamped to 0: it can be slightly negative where nearly all light comes from a few directions.
Vec3 not_negative(Vec3 sum) {
    return Vec3(max(sum.x, Real(0.0)), max(sum.y, Real(0.0)), max(sum.z, Real(0.0)));
}
// The radiance that a view reflects under radiance 1 from all directions.
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
// The first lobe, the cosine around the normal. Its weight is the total minus all other weights.
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
    Vec3 cosine_weight = whole;
    for (int j = 1; j < EXTENDED_LOBES; ++j) cosine_weight = cosine_weight - light_weight(j, whole, nodes, pm);
    return cosine_lobe(cosine_weight);
}

// The radiance of the environment, which the host supplies: in a direction of the local frame, filtered as for GGX
// of a roughness, as in an engine's maps. At roughness 1 it is irradiance / pi. Lobes are fitted to maps of 6
// levels, in which level 5 sqrt(roughness) is looked up, linearly between levels.
Vec3 radiance(Vec3 direction, Real roughness);
// The radiance that leaves towards the viewer.
Vec3 environment(Vec3 wv, Pm pm) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (wv.z <= Real(0.0)) return sum;
    NodesAbout nodes = nodes_about(elevation_coordinate(wv.z), EXTENDED_NODES);
    Vec3 whole = reflected_of_one(wv, pm);
    Vec3 cosine_weight = whole;
    for (int k = 1; k < EXTENDED_LOBES; ++k) {
        LightLobe lobe = lobe_about(wv, k, nodes, whole, pm);
        sum = sum + reflected(lobe.weight, radiance(lobe.axis, lobe.roughness));
        cosine_weight = cosine_weight - lobe.weight;
    }
    return not_negative(sum + reflected(cosine_weight, radiance(Vec3(Real(0.0), Real(0.0), Real(1.0)), Real(1.0))));
}

// A polygon with up to five consecutive corners.
struct Polygon {
    int count;
    Vec3 corner[5];
};
Polygon with_corner(Polygon polygon, Vec3 corner) {
    Polygon extended = polygon;
    extended.corner[polygon.count] = corner;
    extended.count = polygon.count + 1;
    return extended;
}
// The part above z = 0 of a polygon with four corners.
Polygon above_horizon(Polygon polygon) {
    Polygon kept = polygon;
    kept.count = 0;
    for (int i = 0; i < polygon.count; ++i) {
        Vec3 here = polygon.corner[i];
        Vec3 next = polygon.corner[i + 1 < polygon.count ? i + 1 : 0];
        if (here.z > Real(0.0)) kept = with_corner(kept, here);
        if (here.z * next.z < Real(0.0)) kept = with_corner(kept, here + here.z / (here.z - next.z) * (next - here));
    }
    return kept;
}
// An angle divided by its sine.
Real angle_over_sine(Real cosine) {
    if (cosine > Real(0.999)) return Real(1.0) + (Real(1.0) - cosine) / Real(3.0);
    Real least = max(cosine, Real(-0.99999));
    return acos(least) / sqrt(Real(1.0) - least * least);
}
// The integral of cos(theta) / pi over the directions of a polygon above the horizon, from its edges (Lambert
// 1760).
Real cosine_over(Polygon polygon) {
    Real sum = Real(0.0);
    for (int i = 0; i < polygon.count; ++i) {
        Vec3 here = polygon.corner[i];
        Vec3 next = polygon.corner[i + 1 < polygon.count ? i + 1 : 0];
        Real scale = inversesqrt(max(dot(here, here) * dot(next, next), Real(1.0e-30)));
        sum = sum + scale * (here.x * next.y - here.y * next.x) * angle_over_sine(scale * dot(here, next));
    }
    return abs(sum) * Real(0.15915494);
}
// The integral over a polygon of a lobe of weight 1: GGX's kernel of its roughness, without the levels of a map.
// The kernel is nearly a cosine around the axis whose directions are contracted; instead the polygon's directions
// are stretched (Heitz et al. 2016).
Real lobe_over(LightLobe lobe, Polygon polygon) {
    Vec3 axis = lobe.axis;
    Real r = max(lobe.roughness, Real(0.01));
    Real stretch = sqrt(Real(1.0) + Real(3.0) * r * r * r) / (Real(2.0) * r * r);
    Real x = axis.x;
    Real y = axis.y;
    Real s = Real(1.0) / (Real(1.0) + axis.z);
    Polygon transformed = polygon;
    for (int i = 0; i < polygon.count; ++i) {
        Vec3 p = polygon.corner[i];
        transformed.corner[i] = Vec3(stretch * dot(Vec3(Real(1.0) - x * x * s, -x * y * s, -x), p),
                                     stretch * dot(Vec3(-x * y * s, Real(1.0) - y * y * s, -y), p), dot(axis, p));
    }
    return cosine_over(above_horizon(transformed));
}
// The largest squared distance of a light's corners from its middle, on the unit sphere.
Real squared_size(Polygon polygon) {
    Vec3 middle = polygon.corner[0] + polygon.corner[1] + polygon.corner[2] + polygon.corner[3];
    Real least = Real(1.0);
    for (int i = 0; i < 4; ++i) {
        Vec3 corner = polygon.corner[i];
        Real reciprocal = inversesqrt(max(dot(middle, middle) * dot(corner, corner), Real(1.0e-30)));
        least = min(least, reciprocal * dot(middle, corner));
    }
    return Real(2.0) * (Real(1.0) - least);
}
// The fraction of a light of this squared size that is evaluated at points: all up to 3 times the reflected solid
// angle, and nothing from 12 times on, where the points would be visible as dots.
Real share_of_points(Real squared, Real width) {
    Real x = min(max(Real(1.3333333) - squared / (Real(2.25) * min(Real(4.0) * width, Real(0.15))), Real(0.0)), Real(1.0));
    return x * x * (Real(3.0) - Real(2.0) * x);
}
// A node of the three-point Gauss rule on [0, 1], and its weight.
Real gauss_node(int i) { return Real(0.5) + Real(0.38729833) * Real(i - 1); }
Real gauss_weight(int i) { return i == 1 ? Real(0.44444444) : Real(0.27777778); }
// The volume of the parallelepiped spanned by three vectors.
Real volume(Vec3 a, Vec3 b, Vec3 c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}
// The integral of f_r cos(theta_l) over the directions of a quadrilateral, from nine points in each of parts x
// parts cells.
Vec3 by_points(Su su, Vec3 wv, Polygon polygon, int parts, Pm pm) {
    Real part = Real(1.0) / Real(parts);
    Vec3 along = polygon.corner[1] - polygon.corner[0];
    Vec3 across = polygon.corner[3] - polygon.corner[0];
    Vec3 askew = polygon.corner[2] - polygon.corner[3] - along;
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    for (int i = 0; i < 3 * parts; ++i) {
        for (int j = 0; j < 3 * parts; ++j) {
            int node_i = i - 3 * (i / 3);
            int node_j = j - 3 * (j / 3);
            Real s = part * (Real(i / 3) + gauss_node(node_i));
            Real t = part * (Real(j / 3) + gauss_node(node_j));
            Vec3 p = polygon.corner[0] + s * along + t * across + s * t * askew;
            Real reciprocal = inversesqrt(max(dot(p, p), Real(1.0e-12)));
            Real solid_angle = abs(volume(p, along + t * askew, across + s * askew)) * reciprocal * reciprocal * reciprocal;
            Vec3 wl = reciprocal * p;
            Real weight = part * part * gauss_weight(node_i) * gauss_weight(node_j);
            sum = sum + weight * solid_angle * max(wl.z, Real(0.0)) * brdf(su, wl, wv, pm);
        }
    }
    return sum;
}
// The radiance that leaves towards the viewer from a quadrilateral that emits radiance 1 at its front and back. Its
// consecutive corners are relative to the point of the surface, in the local frame. A small light is evaluated at
// points, because it shows f_r itself; others are the sum of the lobes.
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
    // Nine points are enough for a light smaller than the reflected solid angle.
    if (share > Real(0.0)) sum = share * by_points(su, wv, light, squared < Real(0.75) * width ? 1 : 2, pm);
    if (share >= Real(1.0)) return sum;
    Vec3 whole = reflected_of_one(wv, pm);
    Vec3 cosine_weight = whole;
    for (int k = 1; k < EXTENDED_LOBES; ++k) {
        LightLobe lobe = lobe_about(wv, k, nodes, whole, pm);
        sum = sum + (Real(1.0) - share) * lobe_over(lobe, light) * lobe.weight;
        cosine_weight = cosine_weight - lobe.weight;
    }
    return not_negative(sum + (Real(1.0) - share) * lobe_over(cosine_lobe(cosine_weight), light) * cosine_weight);
}
