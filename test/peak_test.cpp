// Where highlights are: synthetic BRDFs, as functions, as samples and as tables of each format.
#include "peaks.h"
#include "srbf/convert.h"

namespace srbf::peak_test {
namespace {

/// Oren and Nayar's matte surface of slopes of 30°, which is brighter towards the light.
double rough_matte(const Vec3d& wl, const Vec3d& wv) {
    const double squared = 0.274, a = 1 - 0.5 * squared / (squared + 0.33), b = 0.45 * squared / (squared + 0.09);
    const double sine = std::hypot(wl.x, wl.y) * std::hypot(wv.x, wv.y);
    return (a + b * std::max(0.0, wl.x * wv.x + wl.y * wv.y) / std::max({wl.z, wv.z, 1e-3}) * (sine > 0 ? 1 : 0)) /
           k_pi;
}
/// A brushed metal: the half vector deviates by tenths across the brush and by hundredths along it.
double brushed(const Vec3d& wl, const Vec3d& wv) {
    const Vec3d h = normalize(wl + wv);
    return 0.05 + 3 * std::exp(-(h.x * h.x / 0.04 + h.y * h.y / 0.0004) / (h.z * h.z));
}

TEST(Peak, IsAtTheHighlight) {
    const auto place = [](ScalarBrdf f) { return peak_of(to_evaluate(std::move(f))).position; };
    for (const double bandwidth : {8.0, 100.0, 1e5}) {  // as wide as a satin paint's to 0.2°
        EXPECT_EQ(place(lobe(bandwidth, 2, mirror_direction)), PeakPosition::mirror) << bandwidth;
        EXPECT_EQ(place(lobe(bandwidth, 2, retroreflection)), PeakPosition::retro) << bandwidth;
        EXPECT_EQ(place(lobe(bandwidth, 2, rotated_quarter)), PeakPosition::beside) << bandwidth;
    }
    EXPECT_EQ(place(brushed), PeakPosition::mirror);
    EXPECT_EQ(place([](const Vec3d&, const Vec3d&) { return 0.2; }), PeakPosition::none);
    EXPECT_EQ(place([](const Vec3d&, const Vec3d&) { return 0.0; }), PeakPosition::none);
    EXPECT_EQ(place(rough_matte), PeakPosition::none);
    // A rise towards the horizon alone is no highlight.
    EXPECT_EQ(place([](const Vec3d& wl, const Vec3d& wv) { return 0.1 / std::sqrt(wl.z * wv.z); }), PeakPosition::none);
    EXPECT_EQ(place([](const Vec3d&, const Vec3d& wv) { return wv.z > 0.9 ? 5 : 0.1; }), PeakPosition::elsewhere);
    EXPECT_EQ(place([](const Vec3d&, const Vec3d&) { return std::nan(""); }), PeakPosition::unknown);
    EXPECT_WITHIN_RELATIVE(peak_of(to_evaluate(lobe(1e4, 0.9, mirror_direction))).ratio, 10, 0.5);
    EXPECT_EQ(peak_of(to_evaluate([](const Vec3d& wl, const Vec3d& wv) { return dot(mirror(wl), wv) > 0.999; })).ratio,
              k_max_peak);
}

/// Samples in all directions, with noise, and of a scan in the plane of incidence, from one side to the other.
TEST(Peak, SamplesKeepTheHighlight) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    for (const auto& [f, place] :
         {std::pair<ScalarBrdf, PeakPosition>{lobe(100, 2, mirror_direction), PeakPosition::mirror},
          {lobe(100, 2, retroreflection), PeakPosition::retro},
          {[](const Vec3d&, const Vec3d&) { return 0.2; }, PeakPosition::none}}) {
        ScatteredSamples all, scan, steep;
        for (int i = 0; i < 2000; ++i) {
            const Vec3d wl = random_direction(random, 0.1), wv = random_direction(random, 0.1);
            const auto y = float(f(wl, wv) * (1 + 0.1 * normal(random)));
            all.wl.push_back(to_float(wl)), all.wv.push_back(to_float(wv)), all.colour.push_back({y, y, y});
        }
        for (const double theta_l : {5.0, 45.0})
            for (int theta = -80; theta <= 80; theta += 5) {
                const Vec3d wl = spherical(theta_l * k_degree, k_pi), wv = spherical(theta * k_degree, 0.0);
                const auto y = float(f(wl, wv));
                for (ScatteredSamples* samples : {&scan, &steep})
                    if (samples == &scan || theta_l < 10)
                        samples->wl.push_back(to_float(wl)), samples->wv.push_back(to_float(wv)),
                            samples->colour.push_back({y, y, y});
            }
        EXPECT_EQ(peak_of(Measured{"f", "CSV", 0, all}).position, place);
        EXPECT_EQ(peak_of(Measured{"f", "CSV", 0, scan}).position, place);
        EXPECT_EQ(peak_of(Measured{"f", "CSV", 0, steep}).position, PeakPosition::unknown);
    }
}

/// Tables of each format keep it; of a BSDF it is that of the part, straight through in transmission.
TEST(Peak, TablesKeepTheHighlight) {
    expect_peaks_kept([](const Evaluate& brdf) {
        RglOptions rgl;
        rgl.polar = 6, rgl.colours = 24;
        const Measured mbsdf{"f", "MBSDF", 0, to_mbsdf(brdf, {20, 19, {}, 0})};
        BsdfTable bsdf{{{}}, 0, {}};
        bsdf.bands[0].part[std::size_t(Part::transmission_front)] = std::make_shared<const Measured>(mbsdf);
        return std::vector<Measured>{{"f", "MERL", 0, to_merl(brdf, {20, 20, 18})},
                                     {"f", "RGL", 0, to_rgl(brdf, rgl)},
                                     mbsdf,
                                     {"f", "MBSDF of both sides", 0, bsdf},
                                     {"f", "CSV", 0, to_samples(brdf, true, 64, 80 * k_degree)}};
    });
}

TEST(Peak, TextAsksAboutTheAzimuths) {
    EXPECT_EQ(peak_text({PeakPosition::mirror, 14}), "highlight at the mirror direction, 14 times f elsewhere");
    EXPECT_EQ(peak_text({PeakPosition::mirror, k_max_peak}, true),
              "highlight straight through, over 1000 times f elsewhere");
    EXPECT_CONTAINS(peak_text({PeakPosition::retro, 3}),
                    "retro direction, 3 times f elsewhere: are the azimuths exchanged?");
    EXPECT_CONTAINS(peak_text({PeakPosition::none, 1.2}), "no highlight (matte)");
}

}  // namespace
}  // namespace srbf::peak_test
