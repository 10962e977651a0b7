// Light of any extent. Must follow albedo.glsl and these functions, which describe each of EXTENDED_LOBES lobes but
// the first between two of EXTENDED_NODES nodes, placed like those of albedos:
//   light_shape(k, nodes)              (p, roughness, any)
//   light_weight(k, whole, nodes, pm)  its weight R, G, B, where `whole` is the sum of all weights
//   light_whole(albedo)                the sum of the weights of all lobes for this directional albedo
//   light_roughness(k, of_view)        its roughness; of_view is that of light_shape
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
// The lobes for a view wv above the horizon.
struct LightLobes {
    LightLobe lobe[EXTENDED_LOBES];
};
LightLobes lobes_about(Vec3 wv, Pm pm) {
    NodesAbout nodes = nodes_about(elevation_coordinate(wv.z), EXTENDED_NODES);
    Vec3 whole = reflected_of_one(wv, pm);
    Vec3 cosine_weight = whole;
    LightLobes of_view;
    for (int k = 1; k < EXTENDED_LOBES; ++k) {
        of_view.lobe[k] = lobe_about(wv, k, nodes, whole, pm);
        cosine_weight = cosine_weight - of_view.lobe[k].weight;
    }
    of_view.lobe[0] = cosine_lobe(cosine_weight);
    return of_view;
}
// Lobe k of them.
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
    LightLobes of_view = lobes_about(wv, pm);
    sum = reflected(of_view.lobe[0].weight, radiance(of_view.lobe[0].axis, Real(1.0)));
    for (int k = 1; k < EXTENDED_LOBES; ++k)
        sum = sum + reflected(of_view.lobe[k].weight,
                              radiance(of_view.lobe[k].axis, light_roughness(k, of_view.lobe[k].roughness)));
    return not_negative(sum);
}

// The consecutive corners of a quadrilateral.
struct Quadrilateral {
    Vec3 a;
    Vec3 b;
    Vec3 c;
    Vec3 d;
};
// An angle divided by 2 pi times its sine (Hill & Heitz 2016), within 2e-6.
Real angle_over_sine(Real cosine) {
    Real c = abs(cosine);
    Real numerator = Real(0.8543985) + (Real(0.4965155) + Real(0.0145206) * c) * c;
    Real sharp = numerator / (Real(3.4175940) + (Real(4.1616724) + c) * c);
    return cosine > Real(0.0) ? sharp : Real(0.5) * inversesqrt(max(Real(1.0) - c * c, Real(1.0e-7))) - sharp;
}
// The z component of the unit vector orthogonal to two vectors, times the angle between them divided by 2 pi.
Real sector(Vec3 a, Vec3 b) {
    Real scale = inversesqrt(max(dot(a, a) * dot(b, b), Real(1.0e-30)));
    return scale * (a.x * b.y - a.y * b.x) * angle_over_sine(scale * dot(a, b));
}
// The sum of the sectors of edges above the horizon z = 0, and the points where they cross it.
struct Outline {
    Real sum;
    Vec3 down;
    Vec3 up;
};
Outline with_edge(Outline outline, Vec3 a, Vec3 b) {
    Outline extended = outline;
    if (a.z <= Real(0.0) && b.z <= Real(0.0)) return extended;
    Vec3 first = a;
    Vec3 last = b;
    if (a.z <= Real(0.0)) {
        first = a + a.z / (a.z - b.z) * (b - a);
        extended.up = first;
    }
    if (b.z <= Real(0.0)) {
        last = a + a.z / (a.z - b.z) * (b - a);
        extended.down = last;
    }
    extended.sum = outline.sum + sector(first, last);
    return extended;
}
// The integral of cos(theta) / pi over the directions of a quadrilateral above the horizon, from its edges (Lambert
// 1760).
Real cosine_over(Quadrilateral light) {
    Outline outline;
    outline.sum = Real(0.0);
    outline.down = Vec3(Real(0.0), Real(0.0), Real(0.0));
    outline.up = outline.down;
    outline = with_edge(outline, light.a, light.b);
    outline = with_edge(outline, light.b, light.c);
    outline = with_edge(outline, light.c, light.d);
    outline = with_edge(outline, light.d, light.a);
    return abs(outline.sum + sector(outline.down, outline.up));
}
// A lobe's kernel, GGX's of its roughness without the levels of a map, is nearly a cosine around the axis whose
// directions are contracted by this factor across it (Heitz et al. 2016).
Real stretch_of(LightLobe lobe) {
    Real r = max(lobe.roughness, Real(0.01));
    return sqrt(Real(1.0) + Real(3.0) * r * r * r) / (Real(2.0) * r * r);
}
// The kernel in a direction at this cosine to the axis.
Real kernel_of(Real cosine, Real stretch) {
    Real along = max(cosine, Real(0.0));
    Real squared = stretch * stretch * (Real(1.0) - along * along) + along * along;
    return Real(0.31830989) * stretch * stretch * along / (squared * squared);
}
Vec3 widened(Vec3 p, Vec3 axis, Real stretch) {
    Real across = (axis.x * p.x + axis.y * p.y) / (Real(1.0) + axis.z) + p.z;
    return Vec3(stretch * (p.x - across * axis.x), stretch * (p.y - across * axis.y), dot(axis, p));
}
// The integral of the kernel over a quadrilateral, whose directions are stretched instead.
Real lobe_over(LightLobe lobe, Quadrilateral light) {
    Real stretch = stretch_of(lobe);
    Quadrilateral wide;
    wide.a = widened(light.a, lobe.axis, stretch);
    wide.b = widened(light.b, lobe.axis, stretch);
    wide.c = widened(light.c, lobe.axis, stretch);
    wide.d = widened(light.d, lobe.axis, stretch);
    return cosine_over(wide);
}
// The cosine of the angle between two vectors.
Real cosine_between(Vec3 a, Vec3 b) { return inversesqrt(max(dot(a, a) * dot(b, b), Real(1.0e-30))) * dot(a, b); }
// The largest squared distance of a light's corners from its middle, on the unit sphere.
Real squared_size(Quadrilateral light) {
    Vec3 middle = light.a + light.b + light.c + light.d;
    return Real(2.0) - Real(2.0) * min(min(cosine_between(middle, light.a), cosine_between(middle, light.b)),
                                       min(cosine_between(middle, light.c), cosine_between(middle, light.d)));
}
// The solid angle into which the lobes reflect: their sum divided by a bound of their largest value.
Real width_of(LightLobes of_view) {
    Real sum = Real(0.0);
    Real largest = Real(1.0e-9);
    for (int k = 0; k < EXTENDED_LOBES; ++k) {
        Vec3 weight = of_view.lobe[k].weight;
        Real stretch = stretch_of(of_view.lobe[k]);
        Real total = weight.x + weight.y + weight.z;
        sum = sum + total;
        largest = largest + abs(total) * Real(0.31830989) * stretch * stretch;
    }
    return sum / largest;
}
// The fraction of a light of this squared size that is evaluated at points: all up to 1.5 times the reflected solid
// angle, and nothing from 6 times on, where the points would be visible as dots.
Real share_of_points(Real squared, Real width) {
    Real x = min(max(Real(1.3333333) - squared / (Real(1.125) * min(Real(4.0) * width, Real(0.15))), Real(0.0)), Real(1.0));
    return x * x * (Real(3.0) - Real(2.0) * x);
}
// A node of the two-point Gauss rule on [0, 1].
Real gauss_node(int i) { return Real(0.21132487) + Real(0.57735027) * Real(i); }
// The volume of the parallelepiped spanned by three vectors.
Real volume(Vec3 a, Vec3 b, Vec3 c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}
// The integral over the directions of a quadrilateral, from four points, of what lobes lack of f_r cos(theta_l).
Vec3 lacking(Vec3 wv, Quadrilateral light, LightLobes of_view, Pm pm) {
    Vec3 along = light.b - light.a;
    Vec3 across = light.d - light.a;
    Vec3 askew = light.c - light.d - along;
    Real stretch[EXTENDED_LOBES];
    for (int k = 0; k < EXTENDED_LOBES; ++k) stretch[k] = stretch_of(of_view.lobe[k]);
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    for (int i = 0; i < 4; ++i) {
        Real s = gauss_node(i / 2);
        Real t = gauss_node(i - 2 * (i / 2));
        Vec3 p = light.a + s * along + t * across + s * t * askew;
        Real reciprocal = inversesqrt(max(dot(p, p), Real(1.0e-12)));
        Vec3 wl = reciprocal * p;
        Vec3 value = max(wl.z, Real(0.0)) * brdf(wl, wv, pm);
        for (int k = 0; k < EXTENDED_LOBES; ++k)
            value = value - kernel_of(dot(of_view.lobe[k].axis, wl), stretch[k]) * of_view.lobe[k].weight;
        Real solid_angle = abs(volume(p, along + t * askew, across + s * askew)) * reciprocal * reciprocal * reciprocal;
        sum = sum + Real(0.25) * solid_angle * value;
    }
    return sum;
}
// The radiance that leaves towards the viewer from a quadrilateral that emits radiance 1 at its front and back. Its
// consecutive corners are relative to the point of the surface, in the local frame. It is the sum of the lobes, and for
// a small light also what they lack of f_r, at points.
Vec3 area(Vec3 wv, Vec3 a, Vec3 b, Vec3 c, Vec3 d, Pm pm) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (wv.z <= Real(0.0)) return sum;
    Quadrilateral light;
    light.a = a;
    light.b = b;
    light.c = c;
    light.d = d;
    LightLobes of_view = lobes_about(wv, pm);
    for (int k = 0; k < EXTENDED_LOBES; ++k) sum = sum + lobe_over(of_view.lobe[k], light) * of_view.lobe[k].weight;
    NodesAbout nodes = nodes_about(elevation_coordinate(wv.z), EXTENDED_NODES);
    Real share = share_of_points(squared_size(light), min(light_width(nodes), width_of(of_view)));
    if (share > Real(0.0)) sum = sum + share * lacking(wv, light, of_view, pm);
    return not_negative(sum);
}
