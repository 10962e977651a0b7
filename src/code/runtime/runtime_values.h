// The form of a multivariate model. Its numbers are 16 weights of variates by the light, 16 by the viewer, of a
// reciprocal model with the exchanged ones after them; then groups of eight lobes. A row has a number of each lobe. A
// group has the rows: log2 of the scale; R, G, B; the exponents; and for each variate minus its falloff, if its centre
// is +z and if it is -z, or with x, y, z of the centre. Lobes that the last group lacks are 0.
#define SRBF_FIRST_ROW 32
typedef struct {
    int lobes, variates, features, axial, reciprocal;
} srbf_form;
SRBF_FN int srbf_rows_of_variate(srbf_form form) { return form.axial ? 2 : 4; }
SRBF_FN int srbf_rows(srbf_form form) { return 4 + form.features + form.variates * srbf_rows_of_variate(form); }

// pm_value of kernel.glsl, with variates in lanes, then lobes. x has in all lanes each variate's x, y, z, or of an
// axial model its squared distances from +z and from -z; further has the features. Constant sizes make it faster.
SRBF_INLINE srbf_vec3 srbf_lobes_value(srbf_form form, const float* number, srbf_vec3 wl, srbf_vec3 wv) {
    const int axial = form.axial, variates = form.variates, count = form.features;
    const int other = form.reciprocal ? variates : 0, columns = srbf_rows_of_variate(form);
    const srbf_PmFeatures features = srbf_pm_further_features(count, wl, wv);
    const srbf_x_vec3 l = srbf_x_all(wl), v = srbf_x_all(wv);
    srbf_x x[16][3], further[4];
    srbf_x_vec3 sum = srbf_x_all(srbf_vec3_of(0.0f, 0.0f, 0.0f));
    float each[3][SRBF_LANES];
    int j, n, k;
    SRBF_UNROLL
    for (k = 0; k < 4; ++k) further[k] = srbf_x_of(features.x[k]);
    SRBF_UNROLL
    for (n = 0; n < variates + other; ++n) {
        if (n % SRBF_LANES == 0) {
            const srbf_x a = srbf_x_load(number + n), b = srbf_x_load(number + 16 + n);
            const srbf_x_AxialPsi at = srbf_x_axial_psi(l, v, a, b);
            const srbf_x_vec3 psi = srbf_x_psi(l, v, a, b);
            srbf_x_store(axial ? srbf_x_squared_distance_from_pole(at, srbf_x_of(1.0f)) : psi.x, each[0]);
            srbf_x_store(axial ? srbf_x_squared_distance_from_pole(at, srbf_x_of(-1.0f)) : psi.y, each[1]);
            srbf_x_store(psi.z, each[2]);
        }
        for (k = 0; k < columns - columns / 4; ++k) x[n][k] = srbf_x_of(each[k][n % SRBF_LANES]);
    }
    for (j = 0; j < form.lobes; j += SRBF_LANES) {
        const float *group = number + SRBF_FIRST_ROW + j / 8 * 8 * srbf_rows(form) + j % 8, *row = group + 32;
        srbf_x exponent = srbf_x_load(group), exchanged, power;
        SRBF_UNROLL
        for (k = 0; k < count; ++k, row += 8) exponent = exponent + srbf_x_load(row) * further[k];
        exchanged = exponent;
        SRBF_UNROLL
        for (n = 0; n < variates; ++n, row += 8 * columns) {
            const srbf_x first = srbf_x_load(row), second = srbf_x_load(row + 8);
            const srbf_x *y = x[n], *z = x[n + other];
            if (axial) {
                exponent = exponent + first * y[0] + second * y[1];
                exchanged = exchanged + first * z[0] + second * z[1];
            } else {
                const srbf_x_vec3 xi = srbf_x_rows(row + 8);
                exponent = exponent + first * srbf_x_squared_distance(srbf_x_vec3_of(y[0], y[1], y[2]), xi);
                exchanged = exchanged + first * srbf_x_squared_distance(srbf_x_vec3_of(z[0], z[1], z[2]), xi);
            }
        }
        power = srbf_x_pm_power(exponent);
        if (form.reciprocal) power = srbf_x_of(0.5f) * (power + srbf_x_pm_power(exchanged));
        sum = srbf_x_add(sum, srbf_x_scale(power, srbf_x_rows(group + 8)));
    }
    return srbf_vec3_of(srbf_max(srbf_x_sum(sum.x), 0.0f), srbf_max(srbf_x_sum(sum.y), 0.0f),
                        srbf_max(srbf_x_sum(sum.z), 0.0f));
}
