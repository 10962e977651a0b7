// Tables of half and difference angles: their values at, between and beyond the nodes.
#include "measured/angles.h"
#include "measured/readers.h"
#include "measured/tables.h"
#include "measured_files.h"

namespace srbf::merl_test {
namespace {

TEST(Angles, AgreeWithTheirDefinitions) {
    double polar_error = 0, azimuth_error = 0;
    for (int i = 0; i <= 400000; ++i) {
        const double theta = k_pi / 2 * std::pow(i / 400000.0, 4), phi = -k_pi + 2 * k_pi * (i + 0.5) / 400001;
        const float s = float(3 * std::sin(theta)), c = float(3 * std::abs(std::cos(theta)));
        if (i > 0 && s > 1e-15f)
            polar_error =
                std::max(polar_error, std::abs(double(polar_angle(s * s, c)) / std::atan2(double(s), double(c)) - 1));
        const float x = float(2 * std::cos(phi)), y = float(2 * std::sin(phi));
        azimuth_error = std::max(azimuth_error, std::abs(double(azimuth(y, x)) - std::atan2(double(y), double(x))));
    }
    EXPECT_LE(polar_error, 4e-7);
    EXPECT_LE(azimuth_error, 4e-7);
    EXPECT_EQ(polar_angle(Vec3f{}), 0);
    EXPECT_EQ(azimuth(0.0f, 0.0f), 0);
}

constexpr int k_h = 12, k_d = 10, k_p = 16;  ///< numbers of nodes

/// Linear in the indices h and d, and between nodes in p, where it is periodic.
double multilinear(double h, double d, double p) {
    return (1 + 0.3 * h) * (5 - 0.4 * d) * (1 + std::abs(p - k_p / 2.0));
}

MerlTable merl_table(const std::function<double(int, int, int, int)>& f) {
    return *read_merl(merl_file({k_h, k_d, k_p}, f), "table");
}

MerlTable multilinear_table() {
    return merl_table([](int h, int d, int p, int c) { return (c + 1) * multilinear(h, d, p); });
}

struct Pair {
    Vec3f wl, wv;
};

/// The pair at the position (h, d, p) in units of nodes, as the docstring of MerlTable says, rotated about the normal.
Pair pair_at(double h, double d, double p, double rotation) {
    const double theta_h = (h / k_h) * (h / k_h) * k_pi / 2, theta_d = d / k_d * k_pi / 2, phi_d = p / k_p * k_pi;
    const auto to_surface = [&](Vec3d w) {
        const double x = std::cos(theta_h) * w.x + std::sin(theta_h) * w.z;
        const double z = std::cos(theta_h) * w.z - std::sin(theta_h) * w.x;
        return rotate(to_float(Vec3d{x, w.y, z}), rotation);
    };
    const Vec3d difference = spherical(theta_d, phi_d);
    return {to_surface(difference), to_surface(mirror(difference))};
}

TEST(Merl, ReproducesItsNodes) {
    const MerlTable table = multilinear_table();
    EXPECT_EQ(table.masked, 0u);
    int compared = 0;
    for (int h = 0; h < k_h; ++h)
        for (int d = 0; d < k_d; ++d)
            for (int p = 0; p < k_p; ++p) {
                const auto [wl, wv] = pair_at(h, d, p, 0.1 * p);
                if (wl.z <= 0 || wv.z <= 0) continue;
                // φ_d has no meaning where h is the normal or ωl = ωv: there the table answers with φ_d = 0.
                const int known_p = h == 0 || d == 0 ? 0 : p;
                if (h == 0 && d > 0 && p > 0) continue;
                const Rgb f = value(table, wl, wv);
                for (int c = 0; c < 3; ++c) {
                    const double expected = (c + 1) * multilinear(h, d, known_p);
                    EXPECT_WITHIN_RELATIVE(f[c], expected, d == 0 ? 1e-3 : 1e-4) << h << ' ' << d << ' ' << p;
                }
                ++compared;
            }
    EXPECT_GT(compared, 500);
}

/// Interpolates as the docstring of value() says, in double at a known position.
double interpolated(const MerlTable& table, double h, double d, double p) {
    double sum = 0, weight = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int i = int(h) + (corner & 1), j = int(d) + (corner >> 1 & 1), k = int(p) + (corner >> 2);
        const double w = (1 - std::abs(h - i)) * (1 - std::abs(d - j)) * (1 - std::abs(p - k));
        const float f = table.cells[std::size_t(k % k_p + k_p * (j + k_d * i))].g;
        if (!std::isnan(f)) {
            sum += w * double(f);
            weight += w;
        }
    }
    return sum / weight;
}

TEST(Merl, InterpolatesOverTheValidNodes) {
    std::mt19937_64 random(1);
    for (const double masked_fraction : {0.0, 0.3, 0.9}) {
        const MerlTable table = merl_table([&](int h, int d, int p, int c) {
            const double f = multilinear(h, d, p);
            return c == 1 && uniform(random) < masked_fraction ? -1 : f;
        });
        EXPECT_EQ(table.masked > 0, masked_fraction > 0);
        int compared = 0, lacking = 0;
        for (int i = 0; i < 20000; ++i) {
            const double h = 1 + (k_h - 2.1) * uniform(random), d = 0.2 + (k_d - 1.3) * uniform(random),
                         p = k_p * uniform(random);
            const auto [wl, wv] = pair_at(h, d, p, 6 * uniform(random));
            if (wl.z <= 0 || wv.z <= 0) continue;
            const double expected = interpolated(table, h, d, p);
            const Rgb f = value(table, wl, wv);
            if (std::isnan(expected)) {
                EXPECT_TRUE(std::isnan(f.r) && std::isnan(f.g) && std::isnan(f.b));
                ++lacking;
                continue;
            }
            // Where all the valid weight lies in a corner, the rounding of the position counts for more.
            EXPECT_WITHIN_RELATIVE(f.g, expected, masked_fraction == 0 ? 1e-4 : 2e-2);
            if (masked_fraction == 0) {
                EXPECT_WITHIN_RELATIVE(f.r, multilinear(h, d, p), 1e-4);
            }
            ++compared;
        }
        EXPECT_GT(compared, 3000);
        EXPECT_EQ(lacking > 0, masked_fraction == 0.9);
    }
}

TEST(Merl, IsReciprocalIsotropicAndBounded) {
    std::mt19937_64 random(2);
    const MerlTable table = merl_table([&](int h, int d, int p, int) {
        const auto [wl, wv] = pair_at(h, d, p, 0);
        return wl.z <= 0 || wv.z <= 0 ? -1 : multilinear(h, d, p);
    });
    EXPECT_GT(table.masked, 0u);
    double largest = 0;
    for (const Rgb& f : table.cells) largest = std::max(largest, double(f.r));
    for (int i = 0; i < 20000; ++i) {
        const Vec3f wl = direction_with_extremes(random), wv = direction_with_extremes(random);
        const Rgb f = value(table, wl, wv), exchanged = value(table, wv, wl);
        ASSERT_TRUE(satisfies_contract(f, wl, wv, true));
        const double angle = 6 * uniform(random);
        const Rgb rotated = value(table, rotate(wl, angle), rotate(wv, angle));
        if (std::isnan(f.r)) {
            EXPECT_TRUE(std::isnan(exchanged.r));
            continue;
        }
        EXPECT_LE(f.r, largest * (1 + 1e-6));
        EXPECT_EQ(f, exchanged);
        const double sine_h = std::hypot(double(wl.x + wv.x), double(wl.y + wv.y));
        if (sine_h < 0.05 || wl.z < 0.1f || wv.z < 0.1f) continue;
        EXPECT_WITHIN_RELATIVE(rotated.r, f.r, 1e-3);
    }
}

TEST(Merl, BatchesHaveTheBitsOfSingleValues) {
    std::mt19937_64 random(7);
    const auto sparse = [&](int, int, int, int c) {
        return c == 1 && uniform(random) < 0.5 ? -1 : 1e3 * uniform(random);
    };
    const MerlTable tables[] = {multilinear_table(), merl_table(sparse),
                                *read_merl(merl_file({1, 1, 1}, sparse), "one")};
    const float nan = std::nanf("");
    const Vec3f special[] = {{0, 0, 1},       {1, 0, 0},      {0, 0, -1},  {0.6f, 0, 0.8f}, {-0.6f, 0, 0.8f},
                             {0, 0.6f, 0.8f}, {1, 0, 1e-30f}, {nan, 0, 1}, {0, 0, nan}};
    std::vector<Vec3f> wl, wv;
    for (const Vec3f l : special)
        for (const Vec3f v : special) {
            wl.push_back(l);
            wv.push_back(v);
        }
    for (int i = 0; i < 5000; ++i) {
        wl.push_back(to_float(random_direction(random)));
        wv.push_back(i % 5 == 0 ? mirror(wl.back()) : to_float(random_direction(random)));
    }
    for (const MerlTable& table : tables) {
        std::vector<Rgb> f(wl.size());
        evaluate_signed(table, wl, wv, f);
        for (std::size_t i = 0; i < f.size(); ++i) {
            const Rgb expected = value(table, wl[i], wv[i]);
            for (int c = 0; c < 3; ++c)
                EXPECT_TRUE(f[i][c] == expected[c] || (std::isnan(f[i][c]) && std::isnan(expected[c])))
                    << i << ": " << f[i][c] << ", " << expected[c];
        }
    }
}

}  // namespace
}  // namespace srbf::merl_test
