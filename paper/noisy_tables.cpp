// Errors of fits to noisy tables. Each measurement is sampled to a table of MBSDF's layout (the truth), and the table
// gets independent normal noise of a fraction of its median value. Prints for each fit ΔE_ITP against the truth, also
// relative to the fit to the truth; the largest errors of albedo from 0 to 75°, of luminance and of a channel (relative
// to luminance); the same for the noisy table; and processor seconds. With --seeds, prints the mean ΔE_ITP and the
// largest errors of N fits.
//   usage: noisy_tables [--share X] [--seeds N] FILE...
// Compares each channel's albedo of a fit with that of the file.
//   usage: noisy_tables --own FILE...
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "fit/noise.h"
#include "srbf/fit.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

constexpr std::uint32_t k_polar = 45, k_azimuths = 91;
/// [degrees]; 0.5 instead of 0, where a table of MBSDF's layout has all azimuths.
constexpr double k_views[] = {0.5, 15, 30, 45, 60, 75};

/// f at the nodes of a table: θ = i π / (2 n_θ), φ = k π / (n_φ − 1).
MbsdfTable table_of(const Evaluate& f) {
    MbsdfTable table;
    table.polar = k_polar, table.azimuths = k_azimuths;
    const double step = k_pi / 2 / k_polar, turn = k_pi / (k_azimuths - 1);
    std::vector<Vec3f> wl, wv;
    for (std::uint32_t i = 0; i < k_polar; ++i)
        for (std::uint32_t j = 0; j < k_polar; ++j)
            for (std::uint32_t k = 0; k < k_azimuths; ++k) {
                wl.push_back(to_float(spherical(i * step, 0.0)));
                wv.push_back(to_float(spherical(j * step, k * turn)));
            }
    table.cells.resize(wl.size());
    f(wl, wv, table.cells);
    for (Rgb& cell : table.cells)
        for (int c = 0; c < 3; ++c) cell[c] = std::max(cell[c], 0.f);
    return table;
}

double median(const MbsdfTable& table) {
    std::vector<float> means;
    for (const Rgb& cell : table.cells) means.push_back((cell.r + cell.g + cell.b) / 3);
    std::ranges::nth_element(means, means.begin() + std::ptrdiff_t(means.size() / 2));
    return double(means[means.size() / 2]);
}

MbsdfTable with_noise(MbsdfTable table, double deviation) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (Rgb& cell : table.cells)
        for (int c = 0; c < 3; ++c) cell[c] += float(deviation * normal(random));
    return table;
}

struct AlbedoErrors {
    double luminance = 0, channel = 0;
};
AlbedoErrors albedo_errors_of(const Evaluate& truth, const Evaluate& other) {
    AlbedoErrors worst;
    for (const double theta : k_views) {
        const Rgb a = albedo(truth, theta * k_degree, 89 * k_degree),
                  b = albedo(other, theta * k_degree, 89 * k_degree);
        const auto raise = [](double& max, double error) { max = std::max(max, std::abs(error)); };
        raise(worst.luminance, double(luminance(b)) / double(luminance(a)) - 1);
        for (int c = 0; c < 3; ++c) raise(worst.channel, double(b[c] - a[c]) / double(luminance(a)));
    }
    return worst;
}

struct TableErrors {
    double delta_e;
    AlbedoErrors albedo;
};
TableErrors errors_against(const Evaluate& truth, const Evaluate& other) {
    return {compare_pictures(truth, {&other, 1})[0].mean.delta_e, albedo_errors_of(truth, other)};
}
struct FitErrors {
    TableErrors fit;
    double seconds, fraction;
};
/// The mean ΔE_ITP and time over seeds, and the largest errors.
FitErrors fit_errors(const Measured& measured, const Evaluate& truth, int seeds) {
    FitErrors errors{};
    for (int seed = 0; seed < seeds; ++seed) {
        const std::clock_t start = std::clock();
        Fitter fitter(measured);
        FitRequest request;
        request.seed = std::uint64_t(seed);
        const auto outcome = fitter.fit(request);
        errors.seconds += double(std::clock() - start) / CLOCKS_PER_SEC / seeds;
        if (!outcome) return fmt::print(stderr, "{}\n", message(outcome.error())), FitErrors{};
        const auto [delta_e, albedo] = errors_against(truth, evaluator(outcome->model));
        errors.fit.delta_e += delta_e / seeds;
        errors.fit.albedo.luminance = std::max(errors.fit.albedo.luminance, albedo.luminance);
        errors.fit.albedo.channel = std::max(errors.fit.albedo.channel, albedo.channel);
        errors.fraction = outcome->noise ? fraction_of(*outcome->noise) : 0;
    }
    return errors;
}

void print_albedos(const Measured& measured) {
    const Evaluate f = signed_evaluator(measured);
    Fitter fitter(measured);
    const auto outcome = fitter.fit({});
    if (!outcome) return void(fmt::print(stderr, "{}\n", message(outcome.error())));
    const Evaluate fit = evaluator(outcome->model);
    for (const double theta : k_views) {
        const Rgb a = albedo(f, theta * k_degree, 89 * k_degree), b = albedo(fit, theta * k_degree, 89 * k_degree);
        fmt::print("| {:.0f}° | {:.4f} {:.4f} {:.4f} | {:+.2f} {:+.2f} {:+.2f} |\n", theta, a.r, a.g, a.b,
                   100 * (b.r / a.r - 1), 100 * (b.g / a.g - 1), 100 * (b.b / a.b - 1));
    }
    std::fflush(stdout);
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    using namespace srbf;
    int seeds = 1;
    std::vector<double> fractions;
    std::vector<std::string> files;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--own") {
            for (++i; i < argc; ++i) print_albedos(*load_measured(argv[i]));
            return 0;
        }
        if (word == "--seeds")
            seeds = std::stoi(argv[++i]);
        else if (word == "--share")
            fractions.push_back(std::stod(argv[++i]));
        else
            files.push_back(word);
    }
    if (fractions.empty()) fractions = {0.01, 0.1, 1};
    fmt::print(
        "| table | noise | ΔE_ITP | of the clean fit's | albedo, luminance, % | channel, % | "
        "table: ΔE_ITP | luminance, % | found | s |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& file : files) {
        const auto measured = load_measured(file);
        if (!measured) return fmt::print(stderr, "{}\n", message(measured.error())), 1;
        const std::string name = std::filesystem::path(file).stem().string();
        const MbsdfTable table = table_of(evaluator(*measured));
        const Measured clean{"", "", 0, table};
        const Evaluate truth = evaluator(clean);
        const FitErrors clean_fit = fit_errors(clean, truth, seeds);
        const auto print = [&](const std::string& noise, const FitErrors& errors, const TableErrors& raw) {
            fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.0f} |\n", name,
                       noise, errors.fit.delta_e, errors.fit.delta_e / clean_fit.fit.delta_e,
                       100 * errors.fit.albedo.luminance, 100 * errors.fit.albedo.channel, raw.delta_e,
                       100 * raw.albedo.luminance, errors.fraction, errors.seconds);
            std::fflush(stdout);
        };
        print("none", clean_fit, {});
        const double median_value = median(table);
        for (const double fraction : fractions) {
            const Measured noisy{"", "", 0, with_noise(table, fraction * median_value)};
            print(fmt::format("{:g} %", 100 * fraction), fit_errors(noisy, truth, seeds),
                  errors_against(truth, signed_evaluator(noisy)));
        }
    }
}
