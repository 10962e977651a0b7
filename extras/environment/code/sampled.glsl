// An environment by draws of the BRDF, to follow mixture.glsl, extended.glsl and brdf.

// A draw: the mean radiance over a solid angle [sr] about a direction of the local frame is reflected with `weight`.
struct LightDraw {
    Vec3 direction;
    Real solid_angle;
    Vec3 weight;
};
// Draw i of `count`, by a sequence that covers the unit cube evenly (R2, Roberts 2018). Each stands for the solid angle in
// which one draw is expected (Krivanek & Colbert 2008). One without a direction to the light has weight 0.
LightDraw environment_draw(Su su, Vec3 wv, int i, int count, Pm pm) {
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
        draw.weight = draw.solid_angle * draw.direction.z * brdf(su, draw.direction, wv, pm);
    return draw;
}

// The mean radiance of the environment over a solid angle [sr] about a direction of the local frame, which the host supplies: of a
// chain of levels, each of half as many texels along a side, level log2(solid angle / that of a texel of the first) / 2.
Vec3 radiance_over(Vec3 direction, Real solid_angle);
// The radiance that leaves towards the viewer, by `count` draws.
Vec3 environment_sampled(Su su, Vec3 wv, int count, Pm pm) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    if (wv.z <= Real(0.0)) return sum;
    for (int i = 0; i < count; ++i) {
        LightDraw draw = environment_draw(su, wv, i, count, pm);
        if (draw.direction.z > Real(0.0))
            sum = sum + times(draw.weight, radiance_over(draw.direction, draw.solid_angle));
    }
    return sum;
}
