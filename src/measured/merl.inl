// No include guard: merl.cpp includes this file for plain numbers, table_batch.cpp once per instruction set.

/// f_r by trilinear interpolation over the measured ones of the eight surrounding nodes; NaN if none was measured.
/// With h = ωl + ωv and d = ωl − ωv, which are orthogonal:
///   tan θ_h = √(h_x² + h_y²) / h_z,  tan θ_d = |d| / |h|,
///   tan φ_d = |h| (h_x d_y − h_y d_x) / (h_z (h_x d_x + h_y d_y) − (h_x² + h_y²) d_z).
/// For close directions d is exact, so that the angles are accurate where an arc cosine of a dot product would lose
/// half of its digits. φ_d is 0 if it is undefined (h along the normal, or ωl = ωv), under every rotation about the
/// normal.
template <typename Vector> Vector merl_value(const MerlTable& table, Vector wl, Vector wv) {
    using Real = decltype(wl.x);
    const std::size_t n_h = table.size[0], n_d = table.size[1], n_p = table.size[2];
    const Real zero(0.0), one(1.0), right_angle = Real(k_pi / 2);
    const Vector h = wl + wv, d = wl - wv;
    const Real planar2 = h.x * h.x + h.y * h.y, length = sqrt(planar2 + h.z * h.z);
    const Real theta_h = polar_angle(planar2, h.z), theta_d = polar_angle(dot(d, d), length);
    const Real y_d = length * (h.x * d.y - h.y * d.x), x_d = h.z * (h.x * d.x + h.y * d.y) - planar2 * d.z;
    // Exchanging ωl and ωv negates x_d and y_d. Negating both if y_d is negative reduces φ_d modulo π.
    const Real phi_d = azimuth(abs(y_d), select(y_d < zero, -x_d, select(zero < y_d, x_d, abs(x_d))));

    // The position in units of nodes, and the nodes around it.
    const Real at_h = min(Real(double(n_h)) * sqrt(theta_h / right_angle), Real(double(n_h - 1)));
    const Real at_d = min(Real(double(n_d)) * (theta_d / right_angle), Real(double(n_d - 1)));
    const Real at_p = min(Real(double(n_p)) * (phi_d / Real(k_pi)), Real(double(n_p)));
    const Real first_h = floor(at_h), first_d = floor(at_d), first_p = min(floor(at_p), Real(double(n_p - 1)));
    const Real t_h = at_h - first_h, t_d = at_d - first_d, t_p = at_p - first_p;
    const Real next_h = min(first_h + one, Real(double(n_h - 1))), next_d = min(first_d + one, Real(double(n_d - 1))),
               next_p = select(first_p < Real(double(n_p - 1)), first_p + one, zero);

    const float* const cells = &table.cells[0].r;
    Vector sum(zero, zero, zero);
    Real weight = zero;
    for (int corner = 0; corner < 8; ++corner) {
        const bool is_next_h = corner & 4, is_next_d = corner & 2, is_next_p = corner & 1;
        const Indices plane = scale(index(is_next_h ? next_h : first_h), n_d),
                      line = scale(added(plane, index(is_next_d ? next_d : first_d)), n_p),
                      cell = scale(added(line, index(is_next_p ? next_p : first_p)), 3);
        const Real w = (is_next_h ? t_h : one - t_h) * (is_next_d ? t_d : one - t_d) * (is_next_p ? t_p : one - t_p);
        const Real r = gather(cells, cell);
        const auto valid = is_number(r);
        weight = weight + select(valid, w, zero);
        sum.x = sum.x + select(valid, w * r, zero);
        sum.y = sum.y + select(valid, w * gather(cells + 1, cell), zero);
        sum.z = sum.z + select(valid, w * gather(cells + 2, cell), zero);
    }
    // The mean may be rounded beyond the largest float.
    const Real most(3.4028234663852886e38), nan(k_nan);
    const auto is_measured = zero < weight;
    return {select(is_measured, min(sum.x / weight, most), nan), select(is_measured, min(sum.y / weight, most), nan),
            select(is_measured, min(sum.z / weight, most), nan)};
}
