// Conversion of BRDFs to tables, and the file formats.
#include "srbf/convert.h"

#include "api/table_file.h"
#include "brdf/colour.h"
#include "brdf_functions.h"
#include "measured/formats/warp.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "measured_files.h"
#include "models.h"
#include "srbf/file.h"
#include "srbf/metrics.h"

namespace srbf::convert_test {
namespace {

const std::vector<std::string> k_bundled{"paper_white_rgb", "cc_ibiza_sunset_rgb"};

/// A highlight a few degrees wide over a diffuse base.
PmModel glossy() { return axial_gaussians({{8, 7, 6}, {0.1f, 0.2f, 0.3f}}, {400, 0}); }

double error_ratio(const Evaluate& reference, const Evaluate& other) {
    return heldout_measures(reference, other, 80 * k_degree, 50000).squared_error_ratio;
}

TEST(Convert, MerlTablesSurviveARoundTrip) {
    std::mt19937_64 random(1);
    const auto table = *read_merl(
        merl_file({7, 6, 8},
                  [&](int, int, int, int c) { return c == 0 && uniform(random) < 0.2 ? -1 : 3 * uniform(random); }),
        "t");
    const auto reread = checked(read_merl(write_merl(table), "t"));
    EXPECT_EQ(reread->size, table.size);
    EXPECT_EQ(reread->masked, table.masked);
    ASSERT_GT(table.masked, 0u);
    for (std::size_t i = 0; i < table.cells.size(); ++i)
        EXPECT_TRUE(reread->cells[i] == table.cells[i] ||
                    (std::isnan(reread->cells[i].r) && std::isnan(table.cells[i].r)));
    EXPECT_EQ(write_merl(*reread), write_merl(table));
}

TEST(Convert, MerlTablesApproximateTheirBrdf) {
    const PmModel model = glossy();
    const MerlTable table = to_merl(evaluator(model));
    EXPECT_EQ(table.size, k_merl_size);
    EXPECT_EQ(table.cells.size(), 90u * 90 * 180);
    EXPECT_LT(error_ratio(evaluator(model), evaluator(table)), 1e-4);
    EXPECT_EQ(table.cells[0].g, 7.2f);  // both directions along the normal
    // The result is the same on one thread.
    EXPECT_EQ(write_merl(to_merl(evaluator(model), {20, 20, 30}, 1)),
              write_merl(to_merl(evaluator(model), {20, 20, 30}, 2)));
}

TEST(Convert, RglTablesApproximateTheirBrdf) {
    const PmModel model = glossy();
    EXPECT_LT(error_ratio(evaluator(model), evaluator(to_rgl(evaluator(model)))), 2e-3);
    for (const auto& name : k_bundled) {
        const Measured& measured = bundled(name);
        const RglTable table = to_rgl(signed_evaluator(measured));
        EXPECT_LT(error_ratio(evaluator(measured), evaluator(table)), 1e-3) << name;
    }
}

TEST(Convert, MbsdfTablesSurviveARoundTrip) {
    std::mt19937_64 random(3);
    for (const bool grey : {false, true}) {
        const int channels = grey ? 1 : 3;
        auto table = *read_mbsdf(
            mbsdf_file("", {mbsdf_block("MBSDF_DATA_REFLECTION=", 5, 7, channels,
                                        [&](int i, int, int, int) { return i == 3 ? NAN : 3 * uniform(random) - 1; })}),
            "t");
        table.metadata = {{"name", "a \"b\" \\ c"}, {"lines", "1\n2\n"}, {"größe", "½"}, {"name", "="}};
        const auto reread = checked(read_mbsdf(write_mbsdf(table), "t"));
        EXPECT_EQ(reread->polar, 5u);
        EXPECT_EQ(reread->azimuths, 7u);
        EXPECT_EQ(reread->grey, grey);
        EXPECT_EQ(reread->masked, 5u * 7);
        EXPECT_EQ(reread->metadata, table.metadata);
        ASSERT_EQ(reread->cells.size(), table.cells.size());
        EXPECT_EQ(std::memcmp(reread->cells.data(), table.cells.data(), table.cells.size() * sizeof(Rgb)), 0);
        EXPECT_EQ(write_mbsdf(*reread), write_mbsdf(table));
    }
    // Control characters, which cannot be read, are not written.
    MbsdfTable table = to_mbsdf(evaluator(glossy()), {.polar = 2, .azimuths = 2, .metadata = {{"a", "b\x1b\tc"}}});
    EXPECT_EQ(read_mbsdf(write_mbsdf(table), "t")->metadata[0].value, "b? c");
}

/// A highlight 4° wide, with NVIDIA's table size and with the default size.
TEST(Convert, MbsdfTablesApproximateTheirBrdf) {
    const PmModel model = glossy();
    const auto small = to_mbsdf(evaluator(model), {.polar = 45, .azimuths = 90, .metadata = {}});
    EXPECT_LT(error_ratio(evaluator(model), evaluator(measured_of(small))), 2e-3);
    const auto table = to_mbsdf(evaluator(model));
    EXPECT_EQ(table.cells.size(), 90u * 90 * 181);
    EXPECT_LT(error_ratio(evaluator(model), evaluator(measured_of(table))), 2e-4);
    EXPECT_EQ(table.cells[0].g, 7.2f);  // both directions along the normal
    EXPECT_FALSE(table.grey);
    for (const auto& name : k_bundled) {
        const Measured& measured = bundled(name);
        const Measured converted{"", "", 0, to_mbsdf(signed_evaluator(measured))};
        EXPECT_LT(error_ratio(evaluator(measured), evaluator(converted)), 1e-3) << name;
        // f(wl, wv) and f(wv, wl) are not confused.
        EXPECT_GT(error_ratio(evaluator(measured), exchanged(evaluator(converted))), 3e-3) << name;
    }
}

/// Cells without a value get the values of their neighbours. Grey tables store a single channel.
TEST(Convert, MbsdfTablesHaveNoMissingCells) {
    const Evaluate holes = pairwise([](Vec3f wl, Vec3f wv) {
        const float f = wv.z > 0.3f && wl.z < 0.99f ? 0.25f : NAN;
        return Rgb{f, f, f};
    });
    const auto table = to_mbsdf(holes, {.polar = 30, .azimuths = 11, .metadata = {}});
    EXPECT_TRUE(table.grey);
    EXPECT_EQ(table.masked, 0u);
    std::size_t zeros = 0;
    for (const Rgb& f : table.cells) {
        EXPECT_TRUE(f.r == 0.25f || f.r == 0);
        zeros += f.r == 0;
    }
    EXPECT_EQ(zeros, 3u * 30 * 11);  // the lights at 0, 3 and 6° have no values
    EXPECT_EQ(write_mbsdf(table).size(), 20 + 23 + 12 + 4 * table.cells.size());
}

/// A written file and its fields.
struct WrittenFile {
    std::vector<std::byte> bytes;
    TensorFile file;
    explicit WrittenFile(const RglTable& table) : bytes(write_rgl(table)), file(*parse_tensor_file(bytes, "w")) {}
    std::vector<float> floats(const char* name) const {
        const auto raw = file.find(name)->second.bytes;
        std::vector<float> numbers(raw.size() / sizeof(float));
        std::memcpy(numbers.data(), raw.data(), raw.size());
        return numbers;
    }
};

const RglOptions k_small_table{.polar = 10, .colours = 48, .description = "glossy"};

/// Conditions that the loaders of Mitsuba 3, pbrt-v4 and the database check.
TEST(Convert, RglFilesHaveTheFieldsThatRenderersRead) {
    const PmModel model = glossy();
    const WrittenFile written(to_rgl(evaluator(model), k_small_table));
    const std::map<std::string, std::vector<std::uint64_t>> shapes{{"phi_i", {1}},
                                                                   {"theta_i", {10}},
                                                                   {"ndf", {2, 256}},
                                                                   {"sigma", {2, 256}},
                                                                   {"vndf", {1, 10, 128, 128}},
                                                                   {"luminance", {1, 10, 48, 48}},
                                                                   {"rgb", {1, 10, 3, 48, 48}},
                                                                   {"wavelengths", {18}},
                                                                   {"spectra", {1, 10, 18, 48, 48}}};
    for (const auto& [name, shape] : shapes) {
        const auto field = written.file.find(name);
        ASSERT_NE(field, written.file.end()) << name;
        EXPECT_EQ(field->second.shape, shape) << name;
        EXPECT_EQ(field->second.type, TensorType::f32) << name;
    }
    for (const char* name : {"description", "jacobian"})
        EXPECT_EQ(written.file.find(name)->second.type, TensorType::u8);
    EXPECT_EQ(std::to_integer<int>(written.file.find("jacobian")->second.bytes[0]), 1);
    EXPECT_EQ(written.file.find("description")->second.bytes.size(), 6u);
}

/// Relations between the fields that hold in the database's files.
TEST(Convert, RglFilesKeepTheInvariantsOfTheFormat) {
    const PmModel model = glossy();
    const RglTable table = to_rgl(evaluator(model), k_small_table);
    const WrittenFile written(table);
    const auto ndf = written.floats("ndf"), sigma = written.floats("sigma"), vndf = written.floats("vndf"),
               luminances = written.floats("luminance"), rgb = written.floats("rgb"), theta = written.floats("theta_i");
    EXPECT_EQ(theta.front(), 0);
    EXPECT_WITHIN(theta.back(), k_pi / 2, 1e-6);
    for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(ndf[i], ndf[256 + i]);
    // The projected area of the normals seen from above is 1: σ(0) = ∫ D cos = 1.
    EXPECT_WITHIN(sigma[0], 1, 1e-4);
    double area = 0;
    for (int i = 0; i < 100000; ++i) {
        const double u = (i + 0.5) / 100000, t = u * u * k_pi / 2;
        area += double(at(table.ndf, float(u))) * std::cos(t) * std::sin(t) * 2 * k_pi * k_pi * u / 100000;
    }
    EXPECT_WITHIN(area, 1, 1e-3);
    for (std::size_t slice = 0; slice < 10; ++slice) {
        // vndf integrates to 1 over its cells. It is proportional to D(m) max(0, m·ωl) sinθ u within the slice.
        std::vector<double> expected(128 * 128);
        double sum = 0, expected_sum = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const std::size_t x = i % 128, y = i / 128;
            const double u = double(x) / 127, t = u * u * k_pi / 2,
                         cell_area = (x % 127 ? 1 : 0.5) * (y % 127 ? 1 : 0.5);
            const Vec3d m = spherical(t, (2 * double(y) / 127 - 1) * k_pi), wl = spherical(double(theta[slice]), 0.0);
            expected[i] = double(at(table.ndf, float(u))) * std::max(0.0, dot(m, wl)) * std::sin(t) * u;
            sum += cell_area * double(vndf[slice * expected.size() + i]);
            expected_sum += cell_area * expected[i];
        }
        for (std::size_t i = 0; i < expected.size(); ++i)
            EXPECT_WITHIN(double(vndf[slice * expected.size() + i]) * expected_sum, expected[i],
                          1e-5 * (expected[i] + 1e-2));
        EXPECT_WITHIN(sum, 1, 1e-5);
        // Luminance is the Rec. 709 luminance of the colours, or 0 where samples would be lost.
        double luminance_sum = 0;
        for (std::size_t i = 0; i < 48 * 48; ++i) {
            const float* const f = &rgb[slice * 3 * 48 * 48 + i];
            const double rgb_luminance = std::max(0.0, luminance(Rgb{f[0], f[48 * 48], f[2 * 48 * 48]}));
            const double l = double(luminances[slice * 48 * 48 + i]);
            EXPECT_TRUE(l == 0 || near_relative(l, rgb_luminance, 1e-5)) << l << ' ' << rgb_luminance;
            luminance_sum += l;
        }
        EXPECT_GT(luminance_sum, 0);
    }
}

TEST(Convert, RglFilesMayHoldOnlyColours) {
    const RglTable table = to_rgl(evaluator(glossy()), k_small_table);
    const auto with_spectra = write_rgl(table), without_spectra = write_rgl(table, false);
    EXPECT_LT(2 * without_spectra.size(), with_spectra.size());
    const auto file = checked(parse_tensor_file(without_spectra, "w"));
    EXPECT_TRUE(file->contains("rgb"));
    EXPECT_FALSE(file->contains("spectra") || file->contains("wavelengths"));
    const auto a = checked(read_rgl(with_spectra, "w")), b = checked(read_rgl(without_spectra, "w"));
    EXPECT_EQ(a->colour.nodes, b->colour.nodes);
}

/// rgb and spectra are the same colours, so that renderers that read either give the same picture.
TEST(Convert, RglFilesHoldTheSameMaterialAsColoursAndSpectra) {
    const RglTable table = to_rgl(evaluator(glossy()), k_small_table);
    const auto bytes = write_rgl(table);
    const auto rgb = checked(read_rgl(bytes, "w"));
    // Without the field rgb, the reader uses the spectra. The name occurs only once.
    auto without_rgb = bytes;
    const std::string name("\3\0rgb", 5);
    const auto position = std::search(without_rgb.begin(), without_rgb.end(), name.begin(), name.end(),
                                      [](std::byte b, char c) { return std::to_integer<char>(b) == c; });
    ASSERT_NE(position, without_rgb.end());
    position[2] = std::byte('x');
    const auto spectral = checked(read_rgl(without_rgb, "w"));
    EXPECT_EQ(spectral->wavelengths.size(), 18u);
    std::mt19937_64 random(2);
    for (int i = 0; i < 5000; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.05)), wv = to_float(random_direction(random, 0.05));
        const Rgb f = value(table, wl, wv), g = value(*rgb, wl, wv), h = value(*spectral, wl, wv);
        EXPECT_RGB_WITHIN_RELATIVE(g, f, 1e-4, 1e-6);
        EXPECT_RGB_WITHIN_RELATIVE(h, f, 1e-4, 1e-6);
    }
}

TEST(Convert, ReflectanceSpectraHaveTheirColour) {
    const auto weights = rgb_weights(k_primary_wavelengths);
    std::mt19937_64 random(3);
    for (int i = 0; i < 200; ++i) {
        const Rgb colour{float(uniform(random)), float(uniform(random)), float(uniform(random))};
        const auto spectrum = reflectance_spectrum(colour);
        const Rgb result = to_rgb(spectrum, weights);
        EXPECT_RGB_WITHIN(result, colour, 3e-6);
        for (const float r : spectrum) EXPECT_TRUE(r >= 0 && r <= 1);
    }
    for (const float r : reflectance_spectrum({1, 1, 1})) EXPECT_WITHIN(r, 1, 2e-6);
}

TEST(Convert, WarpUndoesUnwarp) {
    const Measured& measured = bundled("cc_ibiza_sunset_rgb");
    const auto& table = std::get<RglTable>(measured.table);
    std::mt19937_64 random(4);
    for (std::size_t slice = 0; slice + 1 < table.theta_l.size(); ++slice)
        for (int i = 0; i < 3000; ++i) {
            const float x = float(uniform(random)), y = float(uniform(random));
            const Warped u = warp(table.visible, slice, x, y);
            const Warped w = unwarp(table.visible, Slices{slice, slice, 0}, u.x, u.y);
            if (u.density < 1e-2f) continue;  // where the density vanishes, many points map to one
            EXPECT_WITHIN(w.x, x, 1e-3);
            EXPECT_WITHIN(w.y, y, 1e-4);
            EXPECT_WITHIN_RELATIVE(w.density, u.density, 1e-2);
        }
}

/// Importance sampling of a written file as in renderers, for light at 45°: luminance first, then visible normals.
/// The relative variance of f cosθv / pdf, and the fraction of samples below the horizon.
struct SamplingQuality {
    double theta, variance, lost, albedo;
};

SamplingQuality sampling_quality(const RglTable& table, const Evaluate& brdf) {
    const WrittenFile written(table);
    const auto numbers = written.floats("luminance");
    // The view is at the node of θ_l closest to 45°, so that no slices are interpolated.
    std::size_t slice = 0;
    for (std::size_t i = 0; i < table.theta_l.size(); ++i)
        if (std::abs(table.theta_l[i] - k_pi / 4) < std::abs(table.theta_l[slice] - k_pi / 4)) slice = i;
    RglTable::VisibleNormals luminances{table.colour.width, table.colour.height, {}, {}};
    const std::size_t size = std::size_t(luminances.width) * luminances.height;
    EXPECT_TRUE(integrate(std::span(numbers).subspan(slice * size, size), luminances));
    const Vec3d wl = spherical(double(table.theta_l[slice]), 0.0);
    std::mt19937_64 random(5);
    constexpr int count = 50000;
    double sum = 0, squares = 0;
    int lost = 0;
    for (int i = 0; i < count; ++i) {
        const Warped w = warp(luminances, 0, float(uniform(random)), float(uniform(random)));
        const Warped u = warp(table.visible, slice, w.x, w.y);
        const double theta = double(u.x) * double(u.x) * k_pi / 2;
        const Vec3d m = spherical(theta, (2 * double(u.y) - 1) * k_pi), wv = 2 * dot(wl, m) * m - wl;
        if (wv.z <= 0) {
            ++lost;
            continue;
        }
        const double jacobian = std::max(2 * k_pi * k_pi * double(u.x) * std::sin(theta), 1e-6) * 4 * dot(wl, m);
        const double pdf = double(u.density) * double(w.density) / jacobian;
        Rgb f;
        const Vec3f l = to_float(wl), v = to_float(wv);
        brdf(std::span(&l, 1), std::span(&v, 1), std::span(&f, 1));
        const double weight = luminance(f) * wv.z / pdf;
        sum += weight;
        squares += weight * weight;
    }
    const double mean = sum / count;
    return {double(table.theta_l[slice]), squares / count / (mean * mean) - 1, double(lost) / count, mean};
}

TEST(Convert, RglFilesAreSampledWell) {
    for (const auto& name : k_bundled) {
        const Measured& measured = bundled(name);
        const RglTable table = to_rgl(signed_evaluator(measured));
        const auto quality = sampling_quality(table, evaluator(measured));
        EXPECT_LT(quality.variance, 0.05) << name;
        EXPECT_LT(quality.lost, 0.02) << name;
        std::printf("%s: relative variance %.4f, %.2f %% of samples lost\n", name.c_str(), quality.variance,
                    100 * quality.lost);
        // The estimate is unbiased: the mean weight is the albedo.
        const Rgb reference_albedo = albedo(exchanged(evaluator(measured)), quality.theta, k_pi / 2);
        EXPECT_WITHIN_RELATIVE(quality.albedo, luminance(reference_albedo), 0.02) << name;
    }
}

TEST(Convert, SamplesSurviveARoundTrip) {
    const auto spectral = *read_cornell(as_bytes(k_small_cornell), "c");
    const auto reread = checked(read_csv(as_bytes(write_csv(spectral)), "c", {}));
    EXPECT_EQ(reread->wavelengths, spectral.wavelengths);
    EXPECT_EQ(reread->spectrum, spectral.spectrum);
    EXPECT_TRUE(reread->isotropic);
    const auto expect_near = [](Vec3f a, Vec3f b) {
        EXPECT_TRUE(near(a.x, b.x, 1e-6) && near(a.y, b.y, 1e-6) && near(a.z, b.z, 1e-6)) << a.x << ' ' << b.x;
    };
    for (std::size_t i = 0; i < spectral.wl.size(); ++i) {
        expect_near(reread->wl[i], spectral.wl[i]);
        expect_near(reread->wv[i], spectral.wv[i]);
    }

    const PmModel model = glossy();
    const ScatteredSamples samples = to_samples(evaluator(model), true, 20, 89 * k_degree);
    ASSERT_EQ(samples.wl.size(), 400u);
    for (std::size_t i = 0; i < samples.wl.size(); ++i)
        EXPECT_RGB_WITHIN_RELATIVE(samples.colour[i], value(model, samples.wl[i], samples.wv[i]), 1e-4, 0);
    const auto colours = checked(read_csv(as_bytes(write_csv(samples)), "m", {}));
    EXPECT_EQ(colours->colour, samples.colour);
    EXPECT_TRUE(colours->isotropic);
}

/// A table for isotropic surfaces does not take an anisotropic model, and a CSV file does not call it isotropic.
TEST(Convert, AnisotropicModelsAreNotCalledIsotropic) {
    std::mt19937_64 random(5);
    for (const bool axial : {true, false}) {
        const AnyBrdf model = Model{random_model(random, {.axial = axial}), {}};
        const auto csv = table_file(model, *format_written_to("x.csv"), {.description = "a model", .directions = 8});
        const auto samples = checked(read_csv(*csv, "c", {}));
        EXPECT_EQ(samples->isotropic, axial);
        const auto table = table_file(model, *format_written_to("x.binary"));
        EXPECT_EQ(table.ok(), axial);
        if (axial) continue;
        EXPECT_EQ(message(table.error()), "table: input: expected an isotropic BRDF, found an anisotropic one");
    }
}

// A spectral model keeps its wavelengths in every format that holds some, and spectra where they are exact.
TEST(Convert, SpectraAreKept) {
    std::mt19937_64 random(3);
    const Model model{rounded(spectral_model(random, {.axial = true, .lobes = 2, .variates = 1}, 5)), {}};
    for (const Format& format : formats()) {
        if (format.name != "RGL" && format.name != "CSV" && format.name != "OpenMATERIAL") continue;
        const auto bytes = table_file(model, format, {.description = "", .directions = 8, .max_theta = 80 * k_degree});
        const auto read = checked(read_measured(*bytes, "m"));
        ASSERT_EQ(wavelengths(*read).size(), 5u) << format.name;
        const Vec3f wl = to_float(spherical(30 * k_degree, 0.0)), wv = to_float(spherical(25 * k_degree, 2.0));
        std::vector<float> exact(5), table(5);
        spectra(std::get<PmModel>(model.model)).evaluate({&wl, 1}, {&wv, 1}, exact);
        spectra(*read).evaluate({&wl, 1}, {&wv, 1}, table);
        for (std::size_t c = 0; c < 5; ++c) {
            EXPECT_WITHIN(wavelengths(*read)[c], wavelengths(model)[c], 1e-3);
            EXPECT_TRUE(format.name != "RGL" || near_relative(table[c], exact[c], 0.02)) << table[c] << ' ' << exact[c];
        }
    }
}

}  // namespace
}  // namespace srbf::convert_test
