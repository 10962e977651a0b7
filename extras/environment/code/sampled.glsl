// An environment sampled by the BRDF. Must follow mixture.glsl, extended.glsl and brdf.

// A sample: the mean radiance over a solid angle [sr] around a direction of the local frame is reflected with
// `weight`.
struct LightDraw {
    Vec3 direction;
    Real solid_angle;
    Vec3 weight;
};
// Sample i of `count`, from a sequence that covers the unit cube evenly (R2, Roberts 2018). Each sample represents
// the solid angle in which one sample is expected (Krivanek & Colbert 2008). A sample without a direction to the
// light has weight 0.
LightDraw environment_draw(Vec3 wv, int i, int count, Pm pm) {
    Real number = Real(i);
    Real u2 = Real(0.5) + Real(0.75487767) * number;
    Real selector = Real(0.5) + Real(0.56984029) * number;
    LightDraw draw;
    draw.direction =
        sample_light(wv, (number + Real(0.5)) / Real(count), u2 - Real(int(u2)), selector - Real(int(selector)));
    Real density = light_pdf(draw.direction, wv);
    draw.solid_angle = Real(1.0) / (Real(count) * max(density, Real(1.0e-20)));
    draw.weight = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (density > Real(0.0))
        draw.weight = draw.solid_angle * draw.direction.z * brdf(draw.direction, wv, pm);
    return draw;
}

// The mean radiance of the environment over a solid angle [sr] around a direction of the local frame, which the
// host supplies. In a chain of levels, each with half as many texels along a side, it is level log2(solid angle /
// that of a texel of the first level) / 2.
Vec3 radiance_over(Vec3 direction, Real solid_angle);
// The radiance that leaves towards the viewer, from `count` samples.
Vec3 environment_sampled(Vec3 wv, int count, Pm pm) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (wv.z <= Real(0.0)) return sum;
    for (int i = 0; i < count; ++i) {
        LightDraw draw = environment_draw(wv, i, count, pm);
        if (draw.direction.z > Real(0.0))
            sum = sum + reflected(draw.weight, radiance_over(draw.direction, draw.solid_angle));
    }
    return sum;
}
