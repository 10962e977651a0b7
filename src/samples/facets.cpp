#include "samples/facets.h"

#include <limits>

#include "base/least_squares.h"
#include "observe/excess.h"
#include "observe/pair_weights.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

/// Roughnesses in half octaves down to 1/1024, as in the scan of Lambert-GGX fits.
constexpr int k_roughnesses = 21;
constexpr int k_terms = 1 + 2 * k_roughnesses;

double roughness(int r) { return elementary::exp2(-0.5 * r); }

using Terms = std::array<float, k_terms>;

/// The factors of a channel's amounts.
Terms terms_at(Vec3f wl, Vec3f wv) {
    using K = Kernel<float>;
    Terms terms{float(1 / k_pi)};
    const float s = K::schlick_weight(wl, wv);
    for (int r = 0; r < k_roughnesses; ++r) {
        const float facets = K::ggx_facets(wl, wv, float(roughness(r)));
        terms[std::size_t(1 + 2 * r)] = facets * (1 - s);
        terms[std::size_t(2 + 2 * r)] = facets * s;
    }
    return terms;
}

/// The channel's non-negative amounts that minimise Σ w (f − f̂)².
std::vector<float> solve_channel(const Observations& samples, std::span<const Terms> terms, int channel) {
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(k_terms, k_terms);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(k_terms);
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const double f = double(samples.f[i][channel]);
        for (int a = 0; a < k_terms; ++a) {
            const double weighted = samples.weight[i] * double(terms[i][std::size_t(a)]);
            g[a] += weighted * f;
            for (int b = 0; b <= a; ++b) G(a, b) += weighted * double(terms[i][std::size_t(b)]);
        }
    }
    G.triangularView<Eigen::StrictlyUpper>() = G.transpose();
    const auto unbounded = Eigen::VectorXd::Constant(k_terms, std::numeric_limits<double>::infinity());
    const Eigen::VectorXd x = bounded_least_squares(G, g, unbounded);
    std::vector<float> amounts;
    for (const double amount : x) amounts.push_back(float(amount));
    return amounts;
}

}  // namespace

FacetMixture fit_facets(const Observations& samples) {
    Observations weighed = samples;
    std::vector<Terms> terms;
    for (std::size_t i = 0; i < samples.fitted_count(); ++i) {
        Terms& row = terms.emplace_back(terms_at(samples.wl[i], samples.wv[i]));
        for (int r = 0; r < k_roughnesses; ++r)  // an amount whose factor is 0 at all samples becomes 0
            if (roughness(r) < samples.min_roughness) row[std::size_t(1 + 2 * r)] = row[std::size_t(2 + 2 * r)] = 0;
    }
    FacetMixture mixture{{}, k_max_excess * largest_measured(samples)};
    for (int iteration = 0; iteration < k_facet_rounds; ++iteration) {
        for (int c = 0; c < 3; ++c) mixture.amounts[std::size_t(c)] = solve_channel(weighed, terms, c);
        weighed.weight = samples.weight;
        weigh_large_errors(weighed, evaluator(mixture), k_max_facet_change);
    }
    return mixture;
}

Rgb value(const FacetMixture& mixture, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const Terms terms = terms_at(wl, wv);
    const double bound = mixture.bound / cosines(wl, wv);
    Rgb f;
    for (int c = 0; c < 3; ++c) {
        const std::vector<float>& amounts = mixture.amounts[std::size_t(c)];
        float sum = 0;
        for (std::size_t a = 0; a < terms.size(); ++a) sum += amounts[a] * terms[a];
        f[c] = std::min(sum, std::max(float(bound), amounts[0] * terms[0]));
    }
    return f;
}

}  // namespace
