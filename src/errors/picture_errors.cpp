#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "brdf/colour.h"
#include "errors/image_errors.h"
#include "errors/itp.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_max_psnr = 100;  ///< [dB]; the PSNR of equal pictures is infinite

/// The colours of the sphere in [0, 1], on a grey background.
Image expose(const Image& radiance, float exposure) {
    Image shown = radiance;
    for (int y = 0; y < shown.height; ++y)
        for (int x = 0; x < shown.width; ++x) {
            Rgb& pixel = shown.at(x, y);
            pixel = shows_sphere(shown.width, x, y) ? exposed(pixel, exposure)
                                                    : Rgb{k_background, k_background, k_background};
        }
    return shown;
}

}  // namespace

double delta_e_itp(const Rgb& a, const Rgb& b) {
    const auto itp = [](const Rgb& colour) {
        return Itp<double>({double(colour.r), double(colour.g), double(colour.b)}).value();
    };
    const Itp<double>::Triplet x = itp(a), y = itp(b);
    return elementary::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

PictureErrors picture_errors(const Image& reference, const Image& other) {
    assert(reference.width == other.width && reference.height == other.height && reference.width == reference.height);
    const float exposure = exposure_to(reference, k_exposed_value);
    const Image a = expose(reference, exposure), b = expose(other, exposure);
    const std::vector<double> flip = flip_map(a, b);
    const auto square = [](double x) { return x * x; };
    PictureErrors errors;
    double pixels = 0, encoded = 0, squares = 0, reference_squares = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        if (!shows_sphere(a.width, int(i) % a.width, int(i) / a.width)) continue;
        ++pixels;
        errors.delta_e += delta_e_itp(a.pixels[i], b.pixels[i]);
        errors.flip += flip[i];
        for (int c = 0; c < 3; ++c) {
            encoded += square(srgb_encoded(double(a.pixels[i][c])) - srgb_encoded(double(b.pixels[i][c])));
            squares += square(double(reference.pixels[i][c]) - double(other.pixels[i][c]));
            reference_squares += square(double(reference.pixels[i][c]));
        }
    }
    errors.delta_e /= pixels, errors.flip /= pixels;
    errors.psnr = std::min(-10 * elementary::log10(encoded / (3 * pixels)), k_max_psnr);
    errors.rms = squares > 0 ? std::sqrt(squares / reference_squares) : 0;
    return errors;
}

Verdict verdict(const PictureErrors& errors) {
    for (std::size_t k = 0; k < k_verdict_limits.size(); ++k)
        if (errors.delta_e <= k_verdict_limits[k].delta_e && errors.flip <= k_verdict_limits[k].flip) return Verdict(k);
    return Verdict::visible_at_once;
}

std::string_view name(Verdict verdict) {
    constexpr std::array<std::string_view, k_verdicts> k_words{"hardly visible", "visible if you look for it",
                                                               "visible side by side", "visible at once"};
    return k_words[std::size_t(verdict)];
}

namespace {

/// The mean and the worst of the errors under each lighting.
Appearance summarise(std::vector<PictureErrors> lighting) {
    Appearance summary;
    const auto n = double(lighting.size());
    for (const PictureErrors& errors : lighting) {
        for (const PictureErrorName& error : k_picture_errors) summary.mean.*error.member += errors.*error.member / n;
        summary.worst_delta_e = std::max(summary.worst_delta_e, errors.delta_e);
    }
    summary.lighting = std::move(lighting);
    return summary;
}

}  // namespace

Appearance headline_errors(const Comparison& found) {
    const auto& heldout = found.heldout_appearance;
    Appearance worst = heldout && heldout->mean.delta_e > found.appearance.mean.delta_e ? *heldout : found.appearance;
    worst.mean.delta_e = std::max(worst.mean.delta_e, found.samples_delta_e);
    worst.worst_delta_e = std::max(worst.worst_delta_e, found.samples_delta_e);
    return worst;
}

std::string headline(const Comparison& found, std::string_view between_sentences) {
    const Appearance worst = headline_errors(found);
    const std::string text = fmt::format("{}: ΔE_ITP {:.3g}", name(verdict(worst.mean)), worst.mean.delta_e);
    if (!found.measure)
        return fmt::format("{} in the mean of eight lights, {:.3g} under the worst", text, worst.worst_delta_e);
    const MeasureName& name = *std::ranges::find(k_measures, found.measure, &MeasureName::member);
    const double fit = found.appearance.mean.delta_e, unit = name.is_ratio ? 100 : 1,
                 heldout = found.heldout_appearance ? found.heldout_appearance->mean.delta_e : fit,
                 at_samples = unit * found.matrix.*found.measure, predicted = unit * found.heldout.*found.measure;
    const auto apart = [](std::initializer_list<double> errors) {
        return std::max(errors) > 2 * std::min(errors) ? ", more than a factor of two apart" : "";
    };
    const char* percent = name.is_ratio ? " %" : "";
    return fmt::format("{}, the worst of {:.3g} in pictures, {:.3g} in cross-validation and {:.3g} at the samples{}{}",
                       text, fit, heldout, found.samples_delta_e, apart({fit, heldout, found.samples_delta_e}),
                       between_sentences) +
           fmt::format("{} {:.3g}{} at the samples, {:.3g}{} in cross-validation{}", name.full_title, at_samples,
                       percent, predicted, percent, apart({at_samples, predicted}));
}

Appearance mean_of(std::span<const Appearance> all) {
    std::vector<PictureErrors> lighting(all.front().lighting.size());
    for (const Appearance& one : all)
        for (std::size_t k = 0; k < lighting.size(); ++k)
            for (const PictureErrorName& error : k_picture_errors)
                lighting[k].*error.member += one.lighting[k].*error.member / double(all.size());
    return summarise(std::move(lighting));
}

std::vector<Appearance> compare_pictures(std::span<const Evaluate> brdfs, std::span<const ComparedPair> pairs,
                                         const PictureOptions& options) {
    const auto images = sphere_pictures(brdfs, standard_lightings(), options.size, options.threads, options.progress,
                                        k_mirror_points, options.is_isotropic);
    std::vector<Appearance> all(pairs.size());
    for (Appearance& appearance : all) appearance.lighting.resize(images.size());
    parallel_for(images.size() * pairs.size(), options.threads, [&](std::size_t i) {
        const std::size_t lighting = i / pairs.size(), pair = i % pairs.size();
        const auto [reference, other] = pairs[pair];
        all[pair].lighting[lighting] = picture_errors(images[lighting][reference], images[lighting][other]);
    });
    for (Appearance& appearance : all) appearance = summarise(std::move(appearance.lighting));
    return all;
}

std::vector<Appearance> compare_pictures(const Evaluate& reference, std::span<const Evaluate> others,
                                         const PictureOptions& options) {
    std::vector<Evaluate> brdfs{reference};
    brdfs.insert(brdfs.end(), others.begin(), others.end());
    std::vector<ComparedPair> pairs;
    for (std::size_t other = 1; other < brdfs.size(); ++other) pairs.push_back({0, other});
    return compare_pictures(brdfs, pairs, options);
}

}  // namespace
