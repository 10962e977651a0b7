// BSDFs: their parts, models and files, sampling over the sphere, and fits of both sides.
#include "api/table_file.h"
#include "brdf/parts.h"
#include "models.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "properties.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/fit.h"
#include "srbf/load.h"
#include "srbf/prepared_bsdf.h"
#include "statistics.h"

namespace srbf::bsdf_test {
namespace {

std::vector<std::pair<Vec3f, Vec3f>> random_pairs(int count) {
    std::mt19937_64 random(5);
    std::vector<std::pair<Vec3f, Vec3f>> all;
    for (int i = 0; i < count; ++i)
        all.emplace_back(to_float(random_direction(random)), to_float(random_direction(random)));
    return all;
}

/// Each part answers in its frame; light from straight behind comes to it from the mirror direction.
TEST(Bsdf, PartsHaveFramesOfTheirOwn) {
    const Model model{lobe_bsdf_with_beams(), {}};
    const auto& parts = std::get<BsdfModel>(model.model).part;
    std::array<int, k_parts> pairs_of_part{};
    std::vector<Vec3f> lights, views;
    for (const auto& [wl, wv] : random_pairs(400)) {
        const auto framed = to_part_frame(wl, wv);
        ASSERT_TRUE(framed.has_value());
        ++pairs_of_part[std::size_t(framed->part)];
        EXPECT_EQ(is_transmission(framed->part), wl.z * wv.z < 0);
        EXPECT_EQ(is_back(framed->part), wl.z < 0);
        EXPECT_EQ(to_side(framed->wl, side_of_light(framed->part)), wl);
        EXPECT_EQ(to_side(framed->wv, side_of_viewer(framed->part)), wv);
        EXPECT_EQ(value(model, wl, wv), value(*parts[std::size_t(framed->part)], framed->wl, framed->wv));
        EXPECT_EQ(to_part_frame(wl, {-wl.x, -wl.y, -wl.z})->wv, mirror(to_part_frame(wl, wl)->wl));
        lights.push_back(wl);
        views.push_back(wv);
    }
    for (const int n : pairs_of_part) EXPECT_GT(n, 50);
    std::vector<Rgb> f(lights.size());
    evaluator(model)(lights, views, f);
    for (std::size_t i = 0; i < f.size(); ++i) EXPECT_RGB_WITHIN(f[i], value(model, lights[i], views[i]), 1e-5);
    EXPECT_EQ(value(model, {1, 0, 0}, {0, 0, 1}), Rgb{});
    EXPECT_FALSE(to_part_frame({1, 0, 1e-40f}, {0, 0, 1}).has_value());
}

/// A part that is empty is answered by its counterpart: transmission is then reciprocal.
TEST(Bsdf, MissingPartsHaveTheValuesOfTheirCounterparts) {
    BsdfModel bsdf = lobe_bsdf_with_beams();
    bsdf.part[1].reset();
    bsdf.part[3].reset();
    const Model model{bsdf, {}};
    for (const auto& [wl, wv] : random_pairs(400)) {
        const bool across = wl.z * wv.z < 0;
        EXPECT_EQ(value(model, wl, wv), across ? value(model, wv, wl) : value(model, to_side(wl, -1), to_side(wv, -1)));
    }
    Model swapped = model;
    exchange(swapped);
    const Model complete{lobe_bsdf_with_beams(), {}};
    Model complete_swapped = complete;
    exchange(complete_swapped);
    for (const auto& [wl, wv] : random_pairs(200)) {
        EXPECT_RGB_WITHIN(value(swapped, wl, wv), value(model, wv, wl), 1e-6);
        EXPECT_RGB_WITHIN(value(complete_swapped, wl, wv), value(complete, wv, wl), 1e-6);
    }
}

TEST(Bsdf, FilesKeepAllParts) {
    Model model{lobe_bsdf_with_beams(), {{"source", "test"}}};
    auto& bsdf = std::get<BsdfModel>(model.model);
    bsdf.part[1].reset();
    bsdf.part[2] = std::make_shared<const Model>(Model{GgxModel{{0.1f, 0.2f, 0.3f}, {GgxModel::Lobe{}}}, {}});
    const auto bytes = write_model(model);
    const auto reread = checked(read_model(bytes, "m"));
    EXPECT_EQ(write_model(*reread), bytes);
    EXPECT_EQ(reread->provenance, model.provenance);
    EXPECT_EQ(payload_bytes(*reread), payload_bytes(model));
    const auto& read = std::get<BsdfModel>(reread->model);
    EXPECT_FALSE(read.part[1]);
    EXPECT_TRUE(std::holds_alternative<GgxModel>(read.part[2]->model));
    for (const auto& [wl, wv] : random_pairs(200))
        EXPECT_RGB_WITHIN_RELATIVE(value(*reread, wl, wv), value(model, wl, wv), 0.02, 1e-4);
    for (std::size_t size = 0; size < bytes.size(); size += 7)
        EXPECT_FALSE(read_model(std::span(bytes).first(size), "m").ok());
}

/// The numbers of azimuths of a beam's rings are whole, above 0, and those of its nodes.
TEST(Bsdf, RefusesBadBeams) {
    const auto error_of = [](std::vector<int> azimuths, std::size_t nodes) {
        BsdfModel bsdf = lobe_bsdf_with_beams();
        bsdf.beam[2] = {{0.25f, 0.5f}, std::vector<Rgb>(nodes, Rgb{0.1f, 0.2f, 0.3f}), std::move(azimuths)};
        return error_text(read_model(write_model({bsdf, {}}), "f"));
    };
    EXPECT_EQ(error_of({1, 3}, 4), "");
    EXPECT_EQ(error_of({1, 3}, 3), "f: tensor 'beam.transmission.share': shape: expected [4, 3], found [3, 3]");
    EXPECT_EQ(error_of({2, 0}, 2),
              "f: tensor 'beam.transmission.azimuths': expected whole numbers from 1 to 2048, found 0");
    EXPECT_EQ(error_of({2, 4096}, 2),
              "f: tensor 'beam.transmission.azimuths': expected whole numbers from 1 to 2048, found 4096");
}

/// The density over the sphere integrates to 1 with the chances of beams and of draws without a direction, and draws
/// follow it.
TEST(Bsdf, SamplesFollowTheDensity) {
    const PreparedBsdf bsdf = prepare_bsdf(Model{lobe_bsdf_with_beams(), {}}, {.threads = 1});
    int test = 0;
    for (const double theta : {10.0, 55.0, 125.0, 165.0}) {
        const Vec3f wv = to_float(spherical(theta * k_degree, 0.7));
        std::mt19937_64 random(std::uint64_t(++test));
        const auto next = [&] { return float(uniform(random)); };
        const PolarBins bins = sphere_bins();
        const auto density = [&](Vec3d w) { return double(pdf(bsdf, to_float(w), wv)); };
        const std::vector<double> mass = bins.integrals(density, 48);
        std::vector<double> observed(bins.size());
        constexpr int count = 200000;
        int beams = 0, lost = 0;
        double scattered = 0, squares = 0, by_beam = 0;
        for (int i = 0; i < count; ++i) {
            const Vec2f u{next(), next()};
            const BsdfSample drawn = sample(bsdf, wv, u, next());
            if (drawn.is_beam) {
                ++beams;
                EXPECT_EQ(drawn.pdf, 0);
                const Vec3f straight{-wv.x, -wv.y, drawn.wl.z * wv.z < 0 ? -wv.z : wv.z};
                EXPECT_EQ(drawn.wl, straight);
                by_beam += double(drawn.weight.r);
                continue;
            }
            if (!(drawn.pdf > 0)) {
                ++lost;
                continue;
            }
            EXPECT_WITHIN_RELATIVE(drawn.pdf, pdf(bsdf, drawn.wl, wv), 1e-3);
            const ValuePdf both = value_pdf(bsdf, drawn.wl, wv);
            EXPECT_EQ(both.pdf, pdf(bsdf, drawn.wl, wv));
            EXPECT_EQ(both.value, value(bsdf, drawn.wl, wv));
            observed[bins.index(to_double(drawn.wl))] += 1;
            scattered += double(drawn.weight.r);
            squares += std::pow(double(drawn.weight.r), 2);
        }
        EXPECT_WITHIN(sum_of(mass) + double(beams + lost) / count, 1, 5e-3);
        EXPECT_GT(chi2_p_value_of_shape(observed, mass), sidak(0.01, 4)) << theta;
        // Weights are unbiased: the light that arrives, and that of the beams.
        const double reflected =
            sum_of(bins.integrals([&](Vec3d w) { return double(value(bsdf, to_float(w), wv).r) * std::abs(w.z); }, 48));
        const double mean = scattered / count, deviation = std::sqrt((squares / count - mean * mean) / count);
        EXPECT_WITHIN(mean, reflected, 4 * deviation + 2e-3 * reflected);
        const Beams beam = lobe_bsdf_with_beams().beam;
        const Vec3f from = mirror(wv);
        const bool front = theta < 90;
        const double expected_beams =
            double(fraction_at(beam, front ? Part::reflection_front : Part::reflection_back, from).r) +
            double(fraction_at(beam, front ? Part::transmission_back : Part::transmission_front, from).r);
        EXPECT_WITHIN_RELATIVE(by_beam / count, expected_beams, 0.03);
    }
}

/// A BRDF is the same on both sides, and its samples are those of the BRDF alone.
TEST(Bsdf, SamplesOfABrdfAreThoseOfTheBrdf) {
    std::mt19937_64 random(3);
    const Model model{random_model(random, {}), {}};
    const PreparedBrdf brdf = prepare(model, {.threads = 1});
    const PreparedBsdf bsdf(brdf);
    EXPECT_TRUE(bsdf.is_brdf());
    for (int i = 0; i < 200; ++i) {
        const Vec3f wv = to_float(random_direction(random, 0.01));
        const Vec2f u{float(uniform(random)), float(uniform(random))};
        const float selector = float(uniform(random));
        const LightSample a = sample(brdf, wv, u, selector);
        const BsdfSample b = sample(bsdf, wv, u, selector), c = sample(bsdf, to_side(wv, -1), u, selector);
        EXPECT_EQ(a.pdf, b.pdf);
        EXPECT_EQ(a.weight, b.weight);
        EXPECT_EQ(to_side(c.wl, -1), b.wl);
        EXPECT_EQ(pdf(bsdf, a.wl, wv), pdf(brdf, a.wl, wv));
    }
}

// ---- Formats of both sides ----

TEST(Bsdf, ReadsCsvOfBothSides) {
    const std::string text =
        "# both sides\nwl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0,1,0,0.6,0.8,1\n0,0,-1,0,0.6,-0.8,2\n"
        "0,0,1,0,0.6,-0.8,3\n0,0,1,1,0,0,9\n";
    const auto measured = checked(read_measured(as_bytes(text), "f"));
    const Vec3f up{0, 0, 1}, down{0, 0, -1}, above{0, 0.6f, 0.8f}, below{0, 0.6f, -0.8f};
    EXPECT_WITHIN(value(*measured, up, above).r, 1, 1e-6);
    EXPECT_WITHIN(value(*measured, down, below).r, 2, 1e-6);
    EXPECT_WITHIN(value(*measured, up, below).r, 3, 1e-6);
    EXPECT_WITHIN(value(*measured, below, up).r, 3, 1e-6);  // follows from reciprocity
    // Without the comment values below the horizon are masked.
    const auto front = checked(read_measured(as_bytes(text.substr(text.find('\n') + 1)), "f"));
    EXPECT_EQ(std::get<ScatteredSamples>(front->table).masked, 3u);
}

/// A BSDF as MBSDF and as CSV has the values that it had.
TEST(Bsdf, IsConverted) {
    BsdfModel bsdf = lobe_bsdf_with_beams(4);
    bsdf.part[1].reset(), bsdf.part[3].reset(), bsdf.beam = {};
    const AnyBrdf model = Model{bsdf, {}};
    EXPECT_TRUE(is_two_sided(model));
    for (const char* name : {"x.mbsdf", "x.csv"}) {
        const Format& format = *format_written_to(name);
        const auto bytes = checked(table_file(model, format, {.description = "a leaf", .directions = 48}));
        const auto reread = checked(read_measured(*bytes, "f"));
        double error = 0, energy = 0;
        for (const auto& [wl, wv] : random_pairs(2000)) {
            if (std::min(std::abs(wl.z), std::abs(wv.z)) < 0.2) continue;
            const double a = double(value(std::get<Model>(model), wl, wv).g), b = double(value(*reread, wl, wv).g);
            error += (a - b) * (a - b);
            energy += a * a;
        }
        EXPECT_LT(error / energy, format.name == "MBSDF" ? 1e-4 : 2e-2);
    }
    for (const char* name : {"x.binary", "x.bsdf"})
        EXPECT_EQ(message(table_file(model, *format_written_to(name)).error()),
                  "table: input: expected a BRDF, found a BSDF");
}

}  // namespace
}  // namespace srbf::bsdf_test
