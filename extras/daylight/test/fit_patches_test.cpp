// Fits to averages over patches, and a real roller shade.
#include "api/table_file.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "extras/daylight/test/bsdf_files.h"
#include "furnace.h"
#include "measured/formats.h"
#include "models/bsdf/bsdf_functions.h"
#include "srbf/file.h"
#include "srbf/fit.h"

namespace srbf::fit_patches_test {
namespace {

/// Averages over patches of a smooth function are fitted as averages: the fit is closer to the function than the
/// patches are.
TEST(FitPatches, AveragesOverPatches) {
    const AngleBasis basis = small_basis();
    const auto f = [](Vec3d wl, Vec3d wv) { return 0.1 + 0.3 * elementary::exp(8 * (normalize(wl + wv).z - 1)); };
    const auto mean = [&](std::size_t o, std::size_t i) {
        double sum = 0;
        constexpr int n = 6;
        for (int k = 0; k < n * n * n * n; ++k) {
            const auto u = [&](int d) { return (k / int(std::pow(n, d)) % n + 0.5) / n; };
            const Vec3d in = basis.point_of(i, u(0), u(1)), out = basis.point_of(o, u(2), u(3));
            sum += f({in.x, -in.y, in.z}, {-out.x, out.y, out.z});
        }
        return sum / (n * n * n * n);
    };
    const auto measured = checked(read_measured(
        as_bytes(bsdf_xml(small_basis_xml(), matrix_xml("Reflection Front", "small", basis.patches(), mean))), "f"));
    PmRequest pm;
    pm.size = LobeCount{2}, pm.variates = 1, pm.form = PmForm::gaussian;
    const auto fitted = checked(fit_bsdf(*measured, {.model = pm}));
    EXPECT_LT(fitted->parts[0].squared_error_ratio, 1e-2);
    std::mt19937_64 random(4);
    double fit_error = 0, patch_error = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec3d wl = random_direction(random, 0.2), wv = random_direction(random, 0.2);
        const Vec3f l = to_float(wl), v = to_float(wv);
        fit_error += elementary::pow(double(value(fitted->model, l, v).r) - f(wl, wv), 2);
        patch_error += elementary::pow(double(value(*measured, l, v).r) - f(wl, wv), 2);
    }
    EXPECT_LT(fit_error, 0.2 * patch_error);
}

TEST(FitPatches, FitsASmallShadeOfFourParts) {
    const std::string text = small_shade();
    const auto measured = checked(read_measured(as_bytes(text), "f"));
    FitRequest request;
    request.model = PmRequest{.variates = 2, .size = LobeCount{2}};
    const auto fitted = checked(fit_bsdf(*measured, request));
    ASSERT_EQ(fitted->parts.size(), 4u);
    EXPECT_FALSE(fitted->parts[1].answered_by.has_value());
    EXPECT_EQ(fitted->parts[3].answered_by, Part::transmission_front);
    EXPECT_WITHIN(fitted->parts[2].hemispherical[0].fitted, 0.05 * k_pi + 0.08, 1e-3);
    request.threads = 1;
    const auto again = fit_bsdf(*measured, request);
    EXPECT_EQ(write_model(again->model), write_model(fitted->model));
}

/// A matrix that few lobes cannot represent is still fitted.
TEST(FitPatches, PatchesThatNoLobesFollowGiveAFit) {
    const std::string text = small_shade();
    const auto measured = checked(read_measured(as_bytes(text), "f"));
    const auto& part = std::get<BsdfTable>(measured->table).band().part[std::size_t(Part::transmission_front)];
    KlemsTable table = *table_as<KlemsTable>(*part);
    for (std::size_t i = 0; i < table.cells.size(); ++i) table.cells[i] = i % 7 == 0 ? Rgb{5, 5, 5} : Rgb{};
    const auto one = fit_patches(table, {.model = PmRequest{.variates = 1, .size = LobeCount{1}}}),
               any = fit_patches(table, {.model = PmRequest{}});
    ASSERT_TRUE(one.ok()) << message(one.error());
    ASSERT_TRUE(any.ok()) << message(any.error());
    EXPECT_EQ(std::get<PmModel>(one->model.model).lobes, 1);
    const PatchSums sums = sums_of(table, k_measured_points);
    EXPECT_LE(sums.error_ratio(evaluator(any->model)), sums.error_ratio(evaluator(one->model)));
}

/// The fraction of the light from θ [degrees] that a part scatters or lets go on.
double total(const AnyBrdf& brdf, Part part, double theta) {
    const Evaluate f = part_of(std::visit([](const auto& content) { return evaluator(content); }, brdf), part);
    const Vec3f wl = to_float(spherical(theta * k_degree, 0.1));
    double sum = double(fraction_at(beams_of(brdf), part, wl).g);
    for (const Vec3f& wv : fibonacci_directions(500, k_pi / 2)) {
        Rgb value;
        f({&wl, 1}, {&wv, 1}, {&value, 1});
        sum += double(value.g) * double(wv.z) * 2 * k_pi / 500;
    }
    return sum;
}

/// Reading, fitting, and writing and reading again keep the totals, whether parts scatter, have beams, both or
/// neither. The side that a file lacks is like the other one. At 90° a mirror rises to what is not scattered, and what
/// passes falls to 0.
TEST(FitPatches, TotalsAreKept) {
    const AngleBasis basis = klems_basis(KlemsBasis::quarter);
    for (const double scattered : {0.0, 0.3})
        for (const double beam : {0.0, 1.0}) {
            const auto matrix = [&](const char* direction, double first, double last, double f) {
                return matrix_xml(direction, basis.name, basis.patches(), [=, &basis](std::size_t o, std::size_t i) {
                    const std::size_t ring = basis.ring_of(i);
                    const double fraction = o == i ? beam * (ring == 4 ? last : first) : 0;
                    return f / k_pi + fraction / basis.projected_solid_angle(ring);
                });
            };
            const std::string text = bsdf_xml(
                "", matrix("Transmission Back", 0.6, 0.2, 0) + matrix("Reflection Back", 0.08, 0.4, scattered));
            const auto measured = checked(read_measured(as_bytes(text), "f"));
            const auto fitted = checked(fit_bsdf(*measured, {.model = GgxRequest{}}));
            std::vector<AnyBrdf> all{*measured, fitted->model};
            for (const Format& format : formats()) {
                if (!format.write || format.one_sided) continue;
                const auto bytes = table_file(
                    all[1], format, {.description = {}, .directions = 32, .choice = format.option ? "quarter" : ""});
                EXPECT_EQ(bytes.ok(), format.beams || beam == 0) << format.name;
                if (!bytes) continue;
                const auto again = checked(read_as(format, *bytes, "f"));
                all.push_back(*again);
            }
            for (const AnyBrdf& brdf : all)
                for (const std::size_t back : {0, 1}) {
                    if (back && !is_two_sided(brdf)) continue;  // of light from the front alone
                    const double last = beam * 0.4, end = beam * (1 - scattered);
                    EXPECT_WITHIN(total(brdf, Part(back), 0), 0.08 * beam + scattered, 0.01);
                    EXPECT_WITHIN(total(brdf, Part(back), 76.5), last + scattered, 0.02);
                    EXPECT_WITHIN(total(brdf, Part(back), 85), last + scattered + (end - last) * 17 / 27, 0.02);
                    EXPECT_WITHIN(total(brdf, Part(2 + back), 85), beam * 0.2 * 10 / 27, 0.01);
                }
        }
}

// ---- The roller shade ----

struct Shade {
    Measured measured;
    BsdfOutcome fitted;
};
const Shade* shade() {
    static const std::optional<Shade> fit = []() -> std::optional<Shade> {
        auto measured = load_measured(shared_data() / "klems" / "2011-SA1.xml");
        if (!measured) return {};
        auto fitted = fit_bsdf(*measured, {.model = PmRequest{}});
        if (!fitted) return {};
        return Shade{*std::move(measured), *std::move(fitted)};
    }();
    return fit ? &*fit : nullptr;
}

TEST(FitPatches, KeepsTheSumsOfARollerShade) {
    const Shade* fit = shade();
    if (!fit) GTEST_SKIP() << "no klems/2011-SA1.xml";
    EXPECT_LE(payload_bytes(fit->fitted.model), 400u);  // from 2 MB
    ASSERT_EQ(fit->fitted.parts.size(), 4u);
    for (const PartFit& part : fit->fitted.parts) {
        EXPECT_WITHIN(part.squared_error_ratio, 0, 2e-3) << name(part.part);
        ASSERT_EQ(part.hemispherical.size(), 9u);
        for (const Hemispherical& sum : part.hemispherical)
            EXPECT_WITHIN(sum.fitted, sum.measured, std::max(0.02 * sum.measured, 0.002)) << name(part.part);
    }
    EXPECT_LE(fit->fitted.max_fitted, 1);
    EXPECT_WITHIN(fit->fitted.max_fitted, fit->fitted.max_measured, 0.005);
}

TEST(FitPatches, ARollerShadePassesTheFurnaceTest) {
    const Shade* fit = shade();
    if (!fit) GTEST_SKIP() << "no klems/2011-SA1.xml";
    const double matrix = mean_over_disc(prepare_bsdf(fit->measured, {.threads = 1}), 64);
    EXPECT_WITHIN_RELATIVE(expect_energy_conserved(fit->fitted.model), matrix, 0.01);
}

TEST(FitPatches, ARollerShadeIsSampledWithLittleNoise) {
    const Shade* fit = shade();
    if (!fit) GTEST_SKIP() << "no klems/2011-SA1.xml";
    const PreparedBsdf bsdf = prepare_bsdf(fit->fitted.model, {.threads = 1});
    std::mt19937_64 random(1);
    for (const double theta : {45.0, 135.0}) {
        double sum = 0, squares = 0;
        constexpr int count = 20000;
        for (int i = 0; i < count; ++i) {
            const Vec2f u{float(uniform(random)), float(uniform(random))};
            const double weight =
                luminance(sample(bsdf, to_float(spherical(theta * k_degree, 0.3)), u, float(uniform(random))).weight);
            sum += weight;
            squares += weight * weight;
        }
        EXPECT_LE(squares * count / (sum * sum) - 1, 0.1) << theta;
    }
}

}  // namespace
}  // namespace srbf::fit_patches_test
