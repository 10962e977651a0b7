// No include guard: itp.h includes this file for plain numbers, SIMD code once per instruction set.

// 720 (I, C_T / 2, C_P) of a linear sRGB colour that is displayed with white at 100 cd/m². The distance of two such
// values is ΔE_ITP.
template <typename Real> struct Itp {
    using Triplet = std::array<Real, 3>;

    explicit Itp(const Triplet& colour) {
        const Triplet lms = times(k_to_lms, colour);
        Triplet encoded;
        for (std::size_t i = 0; i < 3; ++i) quantise(lms[i], encoded[i], slope_[i]);
        value_ = times(k_to_itp, encoded);
    }
    const Triplet& value() const { return value_; }
    // Derivatives of the value's component i by the colour's channel c, at [i][c].
    std::array<Triplet, 3> jacobian() const {
        std::array<Triplet, 3> J;
        for (std::size_t c = 0; c < 3; ++c) {
            Triplet encoded;
            for (std::size_t k = 0; k < 3; ++k) encoded[k] = Real(k_to_lms[k][c]) * slope_[k];
            const Triplet column = times(k_to_itp, encoded);
            for (std::size_t i = 0; i < 3; ++i) J[i][c] = column[i];
        }
        return J;
    }

  private:
    static Triplet times(const Matrix3& m, const Triplet& x) {
        Triplet y;
        for (std::size_t i = 0; i < 3; ++i) y[i] = Real(m[i][0]) * x[0] + Real(m[i][1]) * x[1] + Real(m[i][2]) * x[2];
        return y;
    }
    // The perceptual quantiser of BT.2100, ((c1 + c2 y) / (1 + c3 y))^m2 with y = (x 100 cd/m² / 10000 cd/m²)^m1, and
    // its derivative. Since c1 = 1 + c3 - c2, the ratio is 1 - t.
    static void quantise(Real x, Real& encoded, Real& slope) {
        constexpr double m1 = 2610.0 / 16384, m2 = 128 * 2523.0 / 4096, c1 = 3424.0 / 4096, c2 = 32 * 2413.0 / 4096,
                         c3 = 32 * 2392.0 / 4096, white = 100.0 / 10000, least = 1e-9;
        static_assert(c1 == 1 + c3 - c2);
        using elementary::exp, elementary::log, elementary::log1p, std::max;
        const Real luminance = max(x, Real(least)) * Real(white), y = exp(Real(m1) * log(luminance)),
                   denominator = Real(1.0) + Real(c3) * y, t = Real(c2 - c3) * (Real(1.0) - y) / denominator;
        encoded = exp(Real(m2) * log1p(-t));
        slope = Real(m2 * (c2 - c1 * c3) * m1 * white) * encoded * y / ((Real(1.0) - t) * denominator * denominator * luminance);
    }

    Triplet value_, slope_;
};
