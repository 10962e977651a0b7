// Samples directions by a view-by-view model: chooses a sampled view, a lobe, and a direction.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "base/floating_point.h"
#include "models/su/neighbours.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {
namespace {

using SuKernel = Kernel<float>;

/// The fraction s of a view's samples that follow the cosine is v₀ / (v₀ + v), within bounds. v is the relative
/// variance of samples by the cosine alone; for v = v₀ the fraction is half.
constexpr float k_min_cosine_fraction = 0.1f, k_max_cosine_fraction = 0.99f, k_half_fraction_variance = 0.2f;
constexpr int k_variance_samples = 128;  ///< samples that estimate this variance
/// Lower bound on the reflectance of a lobe, so that the fractions of black lobes are defined.
constexpr float k_min_integral = 1e-20f;

/// The largest float below 1.
constexpr float k_below_one = 0x1.fffffep-1f;
/// A choice made by a number in [0,1), and that number rescaled, so that it is uniform again.
struct Choice {
    int index;
    float u;
};
/// Chooses an index by probabilities that sum to 1, with u uniform in [0,1).
template <typename Fraction> Choice choose(int count, float u, const Fraction& fraction) {
    int last = 0;
    for (int k = 0; k < count; ++k) {
        const float part = fraction(k);
        if (!(part > 0)) continue;
        if (u < part) return {k, std::min(u / part, k_below_one)};
        u -= part;
        last = k;
    }
    return {last, k_below_one};  // shares were rounded to a sum below u
}

/// A lobe times the cosine, which is like a lobe of bandwidth 2.133 about the normal (Wang et al. 2009).
auto lobe_times_cosine(const SuModel& model, std::size_t k) {
    return SuKernel::gaussian_product(model.centre[k], model.bandwidth[k], {0, 0, 1}, 2.133f);
}

Vec3f sample_view(const ViewProposal& proposal, std::size_t view, Vec2f u, float selector) {
    const SuModel& model = *proposal.model;
    const auto J = std::size_t(model.lobes);
    const float* const fraction = &proposal.fraction[view * (J + 1)];
    const Choice part = choose(model.lobes + 1, selector, [&](int k) { return fraction[k]; });
    if (part.index == 0) return SuKernel::sample_cosine(u.x, u.y);
    const auto lobe = lobe_times_cosine(model, view * J + std::size_t(part.index) - 1);
    return SuKernel::reflected_up(SuKernel::sample_vmf(lobe.centre, lobe.bandwidth, u.x, u.y));
}
float view_pdf(const ViewProposal& proposal, std::size_t view, Vec3f wl) {
    const auto J = std::size_t(proposal.model->lobes);
    const float* const fraction = &proposal.fraction[view * (J + 1)];
    float pdf = fraction[0] * SuKernel::cosine_pdf(wl);
    for (std::size_t j = 0; j < J; ++j) {
        const auto lobe = lobe_times_cosine(*proposal.model, view * J + j);
        pdf += fraction[j + 1] * (SuKernel::vmf_pdf(wl, lobe.centre, lobe.bandwidth) +
                                  SuKernel::vmf_pdf({wl.x, wl.y, -wl.z}, lobe.centre, lobe.bandwidth));
    }
    return pdf;
}

/// The relative variance of f cosθl / pdf in a view if samples follow the cosine alone.
float cosine_variance(const ViewProposal& proposal, std::size_t view) {
    double sum = 0, squares = 0;
    for (int i = 0; i < k_variance_samples; ++i) {
        const auto turns = [i](double step) { return float(i * step - std::floor(i * step)); };
        const Vec3f wl = sample_view(proposal, view, {turns(0.8191725134), turns(0.6710436067)}, turns(0.5497004779));
        const Vec3f f = SuKernel::su_view_value(*proposal.model, int(view), wl);
        const double reflected = luminance(Rgb{f.x, f.y, f.z}) * double(wl.z),
                     pdf = double(view_pdf(proposal, view, wl));
        if (!(reflected > 0)) continue;
        sum += reflected / pdf;
        squares += reflected * reflected / (double(SuKernel::cosine_pdf(wl)) * pdf);
    }
    return sum > 0 ? float(std::max(squares * k_variance_samples / (sum * sum) - 1, 0.0)) : 0;
}

}  // namespace

ViewProposal propose(const SuModel& model) {
    const StandardArithmetic mode;
    assert(model.discretise == Discretise::view);
    const std::vector<float> integral = lobe_integrals(model);
    const auto J = std::size_t(model.lobes);
    ViewProposal proposal{&model, std::vector<float>(model.direction.size() * (J + 1))};
    for (std::size_t view = 0; view < model.direction.size(); ++view) {
        const auto fraction = std::span(proposal.fraction).subspan(view * (J + 1), J + 1);
        for (std::size_t j = 0; j < J; ++j)
            fraction[j + 1] =
                std::max(integral[view * J + j] * float(luminance(model.coefficient[view * J + j])), k_min_integral);
        const auto set_cosine_fraction = [&](float cosine_fraction) {
            fraction[0] = 0;
            const float sum = std::accumulate(fraction.begin(), fraction.end(), 0.f);
            for (float& lobe_fraction : fraction) lobe_fraction *= (1 - cosine_fraction) / sum;
            fraction[0] = cosine_fraction;
        };
        set_cosine_fraction(k_min_cosine_fraction);
        const float variance = cosine_variance(proposal, view);
        set_cosine_fraction(std::clamp(k_half_fraction_variance / (k_half_fraction_variance + variance),
                                       k_min_cosine_fraction, k_max_cosine_fraction));
    }
    return proposal;
}

Vec3f sample(const ViewProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    const ViewNeighbours neighbours = find_neighbours(*proposal.model, wv);
    const Choice view =
        choose(neighbours.count, selector, [&](int k) { return neighbours.view[std::size_t(k)].weight; });
    const auto& neighbour = neighbours.view[std::size_t(view.index)];
    return SuKernel::turned(sample_view(proposal, std::size_t(neighbour.view), u, view.u), neighbour.cosine,
                            -neighbour.sine);
}

float pdf(const ViewProposal& proposal, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return 0;
    const ViewNeighbours neighbours = find_neighbours(*proposal.model, wv);
    float sum = 0;
    for (int k = 0; k < neighbours.count; ++k) {
        const auto& neighbour = neighbours.view[std::size_t(k)];
        const Vec3f turned = SuKernel::turned(wl, neighbour.cosine, neighbour.sine);
        sum += neighbour.weight * view_pdf(proposal, std::size_t(neighbour.view), turned);
    }
    return sum;
}

}  // namespace
