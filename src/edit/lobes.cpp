#include "edit/lobes.h"

#include "brdf/directions.h"
#include "brdf/values.h"
#include "observe/excess.h"

namespace SRBF_NAMESPACE {

namespace {

/// The light that a lobe reflects at some views.
struct LobeReflection {
    Rgb albedo;     ///< the sum
    double spread;  ///< see `spread`
};
LobeReflection reflection_of(const PmModel& model, int lobe) {
    constexpr double k_views[] = {5 * k_degree, 45 * k_degree, 70 * k_degree};
    constexpr int k_light_directions = 4096;
    const PmModel alone = only_lobe(model, lobe);
    const MirrorMixture mixture(k_pi / 2);
    LobeReflection total{};
    double squared_sines = 0, lambert_squared_sines = 0;  // means, times the albedo
    for (const double theta : k_views) {
        const Vec3d wv = spherical(theta, 0.0);
        const Quadrature light = mixture.quadrature(wv, k_light_directions);
        const std::vector<Rgb> f = values_towards(evaluator(alone), light.w, to_float(wv));
        double albedo = 0, lambert_mean = 0;
        for (std::size_t i = 0; i < f.size(); ++i) {
            const double weight = light.weight[i] * double(light.w[i].z), value = largest_of(f[i]);
            const Vec3d sum = to_double(light.w[i]) + wv;
            const double squared_sine = 1 - sum.z * sum.z / dot(sum, sum);
            albedo += weight * value;
            squared_sines += weight * value * squared_sine;
            lambert_mean += weight / k_pi * squared_sine;
            for (int c = 0; c < 3; ++c) total.albedo[c] += float(weight) * f[i][c];
        }
        lambert_squared_sines += albedo * lambert_mean;
    }
    total.spread = lambert_squared_sines > 0 ? squared_sines / lambert_squared_sines : 0;
    return total;
}

/// The distance of the chromaticities of two colours, at most √2; k_distance_of_black if one is black.
constexpr double k_distance_of_black = 10;
double chromatic_distance(const Rgb& a, const Rgb& b) {
    const double sum_a = 3 * mean_of(a), sum_b = 3 * mean_of(b);
    if (!(sum_a > 0 && sum_b > 0)) return k_distance_of_black;
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += elementary::square(double(a[c]) / sum_a - double(b[c]) / sum_b);
    return std::sqrt(sum);
}

/// Replaces the colour of each lobe by `colour(j, beta)`. A channel below 0 becomes 0.
template <typename Colour> PmModel with_colours(PmModel model, const Colour& colour) {
    for (std::size_t j = 0; j < model.coefficient.size(); ++j)
        model.coefficient[j] = non_negative(colour(j, model.coefficient[j]));
    return model;
}

/// The model with another variate, which no lobe depends on.
PmModel with_variate(PmModel model, Parameterization variate) {
    const auto N = std::ptrdiff_t(model.variates++);
    model.parameterization.push_back(variate);
    for (std::ptrdiff_t j = model.lobes; j > 0; --j) {
        model.centre.insert(model.centre.begin() + j * N, Vec3f(0, 0, 1));
        model.bandwidth.insert(model.bandwidth.begin() + j * N, 0);
    }
    return model;
}

/// Adds the lobes of `b`, whose variate n is number index[n] of the model.
void append_lobes(PmModel& model, const PmModel& b, std::span<const std::size_t> index) {
    const auto N = std::size_t(model.variates), variates_b = std::size_t(b.variates);
    for (std::size_t j = 0; j < std::size_t(b.lobes); ++j) {
        const std::size_t first = model.bandwidth.size();
        model.centre.resize(first + N, Vec3f(0, 0, 1)), model.bandwidth.resize(first + N);
        for (std::size_t n = 0; n < variates_b; ++n) {
            model.centre[first + index[n]] = b.centre[j * variates_b + n];
            model.bandwidth[first + index[n]] = b.bandwidth[j * variates_b + n];
        }
    }
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(model.coefficient, b.coefficient), append(model.spectrum, b.spectrum);
    append(model.log_scale, b.log_scale), append(model.exponent, b.exponent);
    model.lobes += b.lobes;
}

/// A reciprocal model as the sum of its two halves.
PmModel as_two_halves(const PmModel& model, PmForm form) {
    PmModel half = scaled(model, 0.5f);
    half.form = form;
    PmModel other = half;
    exchange(other);
    return join_lobes(std::move(half), std::move(other));
}

PmModel in_form(PmModel model, PmForm form) {
    if (is_reciprocal(model.form) && !is_reciprocal(form)) return as_two_halves(model, form);
    const auto F = std::size_t(features(model.form)), wanted = std::size_t(features(form));
    std::vector<float> exponent;
    for (std::size_t j = 0; j < std::size_t(model.lobes); ++j)
        for (std::size_t k = 0; k < wanted; ++k) exponent.push_back(k < F ? model.exponent[j * F + k] : 0);
    model.exponent = std::move(exponent);
    model.form = form;
    return model;
}

/// The form that has the terms of both.
PmForm common_form(PmForm a, PmForm b) {
    if (a == b) return a;
    PmForm common = features(a) > features(b) ? a : b;
    return is_reciprocal(common) ? PmForm::extended : common;
}

}  // namespace

double spread(const PmModel& model, int lobe) { return reflection_of(model, lobe).spread; }

std::vector<double> body_fractions(const PmModel& model) {
    constexpr double k_much_nearer = 0.5, k_min_fraction_of_body = 0.05;
    std::vector<LobeReflection> lobes;
    Rgb highlight, body, total;
    for (int j = 0; j < model.lobes; ++j) {
        const LobeReflection& lobe = lobes.emplace_back(reflection_of(model, j));
        Rgb* part = nullptr;
        if (lobe.spread >= k_min_body_spread) part = &body;
        if (lobe.spread < k_max_highlight_spread) part = &highlight;
        for (int c = 0; c < 3; ++c) {
            total[c] += lobe.albedo[c];
            if (part) (*part)[c] += lobe.albedo[c];
        }
    }
    const bool has_body = mean_of(body) >= k_min_fraction_of_body * mean_of(total);
    std::vector<double> fractions;
    for (const LobeReflection& lobe : lobes) {
        const bool has_its_colour =
            chromatic_distance(lobe.albedo, body) < k_much_nearer * chromatic_distance(lobe.albedo, highlight);
        double fraction = (lobe.spread - k_max_highlight_spread) / (1 - k_max_highlight_spread);
        if (has_its_colour) fraction = 1;
        if (!has_body || lobe.spread < k_max_highlight_spread) fraction = 0;
        if (lobe.spread >= k_min_body_spread) fraction = 1;
        fractions.push_back(fraction);
    }
    return fractions;
}

HighlightAndBody separate_highlight(const PmModel& model) {
    const std::vector<double> body_fraction = body_fractions(model);
    return {
        with_colours(model, [&](std::size_t j, const Rgb& beta) { return scaled(float(1 - body_fraction[j]), beta); }),
        with_colours(model, [&](std::size_t j, const Rgb& beta) { return scaled(float(body_fraction[j]), beta); })};
}

PmModel tinted(PmModel model, const Tint& tint) {
    const std::vector<double> body_fraction = body_fractions(model);
    return with_colours(std::move(model), [&](std::size_t j, const Rgb& beta) {
        const Rgb by = body_fraction[j] < 1 ? mixed(tint.highlight, tint.body, float(body_fraction[j])) : tint.body;
        return Rgb{beta.r * by.r, beta.g * by.g, beta.b * by.b};
    });
}

PmModel saturated(PmModel model, double factor) {
    return with_colours(std::move(model), [&](std::size_t, const Rgb& beta) {
        const auto grey = float(luminance(beta));
        return mixed({grey, grey, grey}, beta, float(factor));
    });
}

PmModel turn_hue(PmModel model, double hue) {
    const auto cosine = float(elementary::cos(hue)), sine = float(elementary::sin(hue) / std::sqrt(3.0));
    return with_colours(std::move(model), [&](std::size_t, const Rgb& beta) {
        // The difference to grey is rotated about (1, 1, 1) by Rodrigues' formula.
        const auto mean = float(mean_of(beta));
        Rgb colour;
        for (int c = 0; c < 3; ++c)
            colour[c] = cosine * (beta[c] - mean) + sine * (beta[(c + 2) % 3] - beta[(c + 1) % 3]);
        const auto grey = float(luminance(beta) - luminance(colour));
        return Rgb{grey + colour.r, grey + colour.g, grey + colour.b};
    });
}

PmModel rotated(PmModel model, double angle) {
    if (model.axial) return model;
    const auto cosine = float(elementary::cos(angle)), sine = float(elementary::sin(angle));
    for (Vec3f& xi : model.centre) xi = {cosine * xi.x - sine * xi.y, sine * xi.x + cosine * xi.y, xi.z};
    return model;
}

PmModel scaled(PmModel model, float factor) {
    for (Rgb& beta : model.coefficient) beta = {factor * beta.r, factor * beta.g, factor * beta.b};
    for (float& beta : model.spectrum) beta *= factor;
    return model;
}

PmModel widened(PmModel model, double factor) {
    const std::vector<double> body_fraction = body_fractions(model);
    const auto N = std::size_t(model.variates), F = std::size_t(features(model.form));
    for (std::size_t j = 0; j < body_fraction.size(); ++j) {
        if (body_fraction[j] > 0.5) continue;
        for (std::size_t i = j * N; i < (j + 1) * N; ++i)
            model.bandwidth[i] = float(double(model.bandwidth[i]) / (factor * factor));
        for (std::size_t k = 2; k < F; ++k)  // γ and σ, of features linear in the slope
            model.exponent[j * F + k] = float(double(model.exponent[j * F + k]) / factor);
    }
    return model;
}

PmModel join_lobes(PmModel a, PmModel b) {
    const PmForm form = common_form(a.form, b.form);
    a = in_form(std::move(a), form);
    b = in_form(std::move(b), form);
    a.axial = a.axial && b.axial;
    const std::size_t count = a.parameterization.size();
    std::vector<std::size_t> index;
    for (const Parameterization& p : b.parameterization) {
        std::size_t n = 0;
        while (n < count && (!(a.parameterization[n] == p) || std::ranges::count(index, n))) ++n;
        index.push_back(n < count ? n : a.parameterization.size());
        if (n == count) a = with_variate(std::move(a), p);
    }
    append_lobes(a, b, index);
    return a;
}

}  // namespace
