// The coefficients of texels in shared lobes.
#include <cmath>
#include <limits>
#include <numeric>

#include "base/floating_point.h"
#include "base/half.h"
#include "base/least_squares.h"
#include "base/parallel.h"
#include "brdf/values.h"
#include "extras/maps/texel_sums.h"
#include "observe/excess.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"
#include "srbf/fit_map.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_unlimited = std::numeric_limits<double>::infinity();
/// Number of texels that a thread takes at once.
constexpr std::size_t k_texels_of_task = 16 * k_block_texels;
/// Smaller values of a lobe, relative to its largest, are 0: their products would be subnormal.
constexpr double k_min_value = 1e-15;
/// A texel whose coefficients exceed 16-bit floats loses its largest values, at most this fraction of them.
constexpr double k_max_left_out = 1.0 / 16;

/// The values of lobe j, with coefficient 1, at pairs of directions.
std::vector<Rgb> lobe_values(const TexelMap& map, std::size_t j, std::span<const Vec3f> wl, std::span<const Vec3f> wv) {
    PmModel lobe = map.basis;
    lobe.coefficient.assign(lobe.coefficient.size(), {}), lobe.coefficient[j] = {1, 1, 1};
    std::vector<Rgb> values(wl.size());
    evaluate(Model{std::move(lobe), {}}, wl, wv, values);
    return values;
}

/// The largest coefficient of each lobe in the texels in which the lobes were found, relative to the texel's largest
/// f cosθl cosθv.
std::vector<double> largest_fractions(const TexelMap& map, const SharedPairs& pairs) {
    const auto J = std::size_t(map.basis.lobes);
    std::vector<double> fractions(J);
    std::vector<Rgb> f(pairs.wl.size());
    for (std::size_t t = 0; t < map.count(); ++t) {
        evaluate(texel(map, t), pairs.wl, pairs.wv, f);
        double sampled = 0;
        for (std::size_t i = 0; i < f.size(); ++i)
            sampled = std::max(sampled, largest_of(f[i]) * cosines(pairs.wl[i], pairs.wv[i]));
        for (std::size_t j = 0; j < J && sampled > 0; ++j)
            fractions[j] = std::max(fractions[j], largest_of(map.coefficient[t * J + j]) / sampled);
    }
    return fractions;
}

/// The lobes at the samples, and how far the samples constrain them.
struct SampledLobes {
    std::vector<Aligned<float>> values;  ///< values of each lobe, in multiples of its scale
    std::vector<double> scale;           ///< the largest value of each lobe for coefficient 1
    std::vector<double> largest;  ///< upper bounds on coefficients if f cosθl cosθv of the samples is at most 1
    /// lobes that do not rise by `k_max_excess` between or beyond the samples
    std::vector<std::size_t> constrained;
    std::vector<std::size_t> all;
};

/// A lobe that rises beyond the samples, where light or viewer is closer to the horizon than in any sample, may
/// reach `k_max_excess` there. The coefficient of a lobe that rises between or beyond them, relative to the values
/// at the samples, is at most `k_max_excess` times that of any texel in which the lobes were found.
SampledLobes sampled_lobes(const TexelMap& map, const SharedPairs& pairs, std::size_t padded) {
    float min = 1;  // cosine of a sample
    for (std::size_t i = 0; i < pairs.wl.size(); ++i)
        if (const float cosine = std::min(pairs.wl[i].z, pairs.wv[i].z); cosine > 0) min = std::min(min, cosine);
    std::vector<Vec3f> wl, wv;
    for (const auto& grid : {horizon_grid(), grazing_grid()})
        for (const DirectionPair& pair : grid) wl.push_back(pair.wl), wv.push_back(pair.wv);
    const std::size_t J = std::size_t(map.basis.lobes);
    const std::vector<double> fractions = largest_fractions(map, pairs);
    SampledLobes lobes{{}, {}, std::vector<double>(J), {}, {}};
    for (std::size_t j = 0; j < J; ++j) {
        double at_samples = 0, between = 0, beyond = 0, scale = 0;
        const std::vector<Rgb> sampled = lobe_values(map, j, pairs.wl, pairs.wv);
        for (std::size_t i = 0; i < sampled.size(); ++i) {
            scale = std::max(scale, double(sampled[i].r));
            at_samples = std::max(at_samples, double(sampled[i].r) * cosines(pairs.wl[i], pairs.wv[i]));
        }
        lobes.scale.push_back(scale > 0 ? scale : 1);
        Aligned<float>& column = lobes.values.emplace_back(padded);
        for (std::size_t i = 0; i < sampled.size(); ++i)
            if (const double value = double(sampled[i].r) / lobes.scale[j]; value > k_min_value)
                column[i] = float(value);
        const std::vector<Rgb> values = lobe_values(map, j, wl, wv);
        for (std::size_t i = 0; i < wl.size(); ++i) {
            double& peak = std::min(wl[i].z, wv[i].z) < min ? beyond : between;
            peak = std::max(peak, double(values[i].r) * bound_cosines(wl[i], wv[i]));
        }
        lobes.largest[j] = beyond > k_max_excess * between ? k_max_excess / beyond : k_unlimited;
        lobes.all.push_back(j);
        const bool is_constrained = std::max(between, beyond) <= k_max_excess * at_samples;
        if (is_constrained)
            lobes.constrained.push_back(j);
        else
            lobes.largest[j] = std::min(lobes.largest[j], k_max_excess * fractions[j]);
    }
    return lobes;
}

/// The products of lobes, which the Gram matrix of a texel weights: columns of pairs j ≥ k.
struct LobeProducts {
    explicit LobeProducts(const std::vector<Aligned<float>>& lobes) {
        for (std::size_t j = 0; j < lobes.size(); ++j)
            for (std::size_t k = 0; k <= j; ++k) {
                Aligned<float>& product = values.emplace_back(lobes[j].size());
                for (std::size_t i = 0; i < product.size(); ++i) product[i] = lobes[j][i] * lobes[k][i];
            }
    }
    std::vector<Aligned<float>> values;
};

std::vector<const float*> columns_of(const std::vector<Aligned<float>>& values) {
    std::vector<const float*> columns;
    for (const Aligned<float>& column : values) columns.push_back(column.data());
    return columns;
}

/// True if `more` further coefficients above 0 lower the squared residual of `count` values from `before` to
/// `after` by more than noise would: the Bayesian information criterion.
bool is_evident(double before, double after, std::size_t more, double count) {
    return before > after &&
           (after == 0 || count * elementary::log(before / after) > double(more) * elementary::log(count));
}

/// Solves for the coefficients of blocks of texels.
class BlockSolver {
  public:
    BlockSolver(const SampledLobes& lobes, const TexelPairs& pairs, std::span<const float* const> columns,
                std::span<const float* const> products)
        : lobes_(lobes),
          pairs_(pairs),
          columns_(columns),
          products_(products),
          block_(pairs.pairs),
          gram_(products.size() * k_block_texels),
          right_(3 * columns.size() * k_block_texels) {}

    /// Fits `count` texels with the values f[t][i]. Sets coefficients, with their stored precision, and errors; `next`
    /// are their numbers in `texels`.
    void fit(std::span<const Rgb> f, std::span<const std::size_t> next, TexelCoefficients& texels) {
        const std::size_t count = next.size();
        load_texels(f, count, pairs_, block_);
        weighted_sums(products_, pairs_, block_, gram_.data());
        weighted_products(columns_, pairs_, block_, right_.data());
        solve(lobes_.all, count, complete_);
        const bool has_choice = lobes_.constrained.size() < lobes_.all.size();
        if (has_choice) solve(lobes_.constrained, count, constrained_);
        for (std::size_t t = 0; t < count; ++t)
            take(t, has_choice && !needs_all(t) ? constrained_ : complete_, texels, next[t]);
    }

  private:
    struct Solution {
        std::vector<float> beta;  ///< rounded to 16-bit floats: 3 j + c of each texel
        Aligned<float> scaled;    ///< coefficients for the scaled columns and y
        alignas(64) float residual[k_block_texels];
    };
    std::size_t J() const { return columns_.size(); }
    static std::size_t at(std::size_t number, std::size_t t) { return number * k_block_texels + t; }

    void solve(const std::vector<std::size_t>& which, std::size_t count, Solution& solution) {
        const std::size_t n = which.size();
        solution.beta.assign(3 * J() * k_block_texels, 0);
        solution.scaled.assign(solution.beta.size(), 0);
        const auto size = Eigen::Index(n);
        Eigen::MatrixXd G(size, size);
        Eigen::VectorXd g(size), upper(size), solved;
        for (std::size_t t = 0; t < count; ++t) {
            if (!(block_.bright[t] > 0)) continue;
            solved.resize(0);  // drops the previous channel's values
            const double bright = double(block_.bright[t]);
            for (std::size_t a = 0; a < n; ++a) {
                const std::size_t j = which[a];
                for (std::size_t b = 0; b <= a; ++b)  // j ≥ which[b]
                    G(Eigen::Index(a), Eigen::Index(b)) = G(Eigen::Index(b), Eigen::Index(a)) =
                        double(gram_[at(j * (j + 1) / 2 + which[b], t)]);
                const double limit =
                    std::min(bright * double(block_.largest[t]) * lobes_.largest[j], double(k_half_max));
                upper[Eigen::Index(a)] = limit * lobes_.scale[j] / bright;
            }
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t a = 0; a < n; ++a) g[Eigen::Index(a)] = double(right_[at(3 * which[a] + c, t)]);
                solved = bounded_least_squares(G, g, upper, solved);
                for (std::size_t a = 0; a < n; ++a) {
                    const std::size_t number = at(3 * which[a] + c, t);
                    const double scale = lobes_.scale[which[a]] / bright;
                    const double x = solved[Eigen::Index(a)];
                    if (!(x > 0)) continue;
                    solution.beta[number] = round_to_half(std::min(float(x / scale), k_half_max));
                    solution.scaled[number] = float(double(solution.beta[number]) * scale);
                }
            }
        }
        weighted_residuals(columns_, solution.scaled.data(), pairs_, block_, solution.residual);
    }

    /// True if it is evident that texel t needs lobes that the samples do not constrain.
    bool needs_all(std::size_t t) const {
        std::size_t all = 0, constrained = 0;
        for (std::size_t number = 0; number < 3 * J(); ++number) {
            all += complete_.beta[at(number, t)] > 0;
            constrained += constrained_.beta[at(number, t)] > 0;
        }
        return is_evident(double(constrained_.residual[t]), double(complete_.residual[t]),
                          all > constrained ? all - constrained : 1, 3 * double(block_.known[t]));
    }

    void take(std::size_t t, const Solution& solution, TexelCoefficients& texels, std::size_t n) const {
        float largest = 0;
        for (std::size_t j = 0; j < J(); ++j)
            for (std::size_t c = 0; c < 3; ++c) {
                const float beta = solution.beta[at(3 * j + c, t)];
                texels.coefficient[n * J() + j][int(c)] = beta;
                largest = std::max(largest, beta);
            }
        const double energy = double(block_.energy[t]);
        texels.error[n] = energy > 0            ? float(std::sqrt(double(solution.residual[t]) / energy))
                          : block_.known[t] > 0 ? 0.f
                                                : 1.f;
        texels.left_out[n] = std::uint32_t(pairs_.above) - std::uint32_t(block_.known[t]);
        texels.state[n] = largest >= k_half_max  ? TexelState::failed
                          : block_.bright[t] > 0 ? TexelState::fitted
                          : block_.known[t] > 0  ? TexelState::black
                                                 : TexelState::failed;
    }

    const SampledLobes& lobes_;
    const TexelPairs& pairs_;
    std::span<const float*const> columns_, products_;
    TexelBlock block_;
    Aligned<float> gram_, right_;
    Solution complete_, constrained_;
};

/// Sets the value with the largest f cosθl cosθv of a texel to NaN.
void leave_out_largest(const SharedPairs& pairs, std::span<Rgb> f) {
    std::size_t largest = 0;
    double max = -1;
    for (std::size_t i = 0; i < f.size(); ++i)
        if (const double x = largest_of(f[i]) * cosines(pairs.wl[i], pairs.wv[i]); is_finite(f[i]) && x > max) {
            max = x;
            largest = i;
        }
    f[largest].r = std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

TexelCoefficients coefficients_of_texels(const TexelMap& map, const SharedPairs& shared, std::span<const Rgb> f,
                                         int threads) {
    const StandardArithmetic mode;
    const std::size_t M = shared.wl.size(), T = f.size() / M, J = std::size_t(map.basis.lobes);
    const TexelPairs pairs(shared);
    const SampledLobes lobes = sampled_lobes(map, shared, pairs.pairs);
    const LobeProducts lobe_products(lobes.values);
    const auto columns = columns_of(lobes.values), products = columns_of(lobe_products.values);
    TexelCoefficients texels{std::vector<Rgb>(T * J), std::vector<float>(T), std::vector<TexelState>(T),
                             std::vector<std::uint32_t>(T)};
    parallel_for_chunks(T, k_texels_of_task, threads, [&](std::size_t begin, std::size_t end) {
        BlockSolver solver(lobes, pairs, columns, products);
        std::vector<std::size_t> next(end - begin);
        std::iota(next.begin(), next.end(), begin);
        std::span<const Rgb> values = f.subspan(begin * M, next.size() * M);
        std::vector<Rgb> remaining;  // values of texels whose coefficients were too large
        for (std::size_t left_out = 0;; ++left_out) {
            for (std::size_t n = 0; n < next.size(); n += k_block_texels) {
                const std::size_t count = std::min(k_block_texels, next.size() - n);
                solver.fit(values.subspan(n * M, count * M), std::span(next).subspan(n, count), texels);
            }
            std::vector<Rgb> others;
            std::vector<std::size_t> failed;
            for (std::size_t n = 0; n < next.size(); ++n)
                if (texels.state[next[n]] == TexelState::failed && texels.left_out[next[n]] < pairs.above) {
                    failed.push_back(next[n]);
                    const auto texel = values.subspan(n * M, M);
                    others.insert(others.end(), texel.begin(), texel.end());
                    leave_out_largest(shared, std::span(others).last(M));
                }
            next = std::move(failed), remaining = std::move(others), values = remaining;
            if (next.empty() || double(left_out) >= k_max_left_out * double(pairs.above)) break;
        }
        for (const std::size_t t : next) {
            std::fill_n(texels.coefficient.begin() + std::ptrdiff_t(t * J), J, Rgb{});
            texels.error[t] = 1;
        }
    });
    return texels;
}

TexelCoefficients painted_texels(const TexelMap& materials, std::span<const float> fractions) {
    const StandardArithmetic mode;
    const std::size_t K = materials.count(), T = fractions.size() / K, J = std::size_t(materials.basis.lobes);
    TexelCoefficients texels{std::vector<Rgb>(T * J), std::vector<float>(T), std::vector<TexelState>(T),
                             std::vector<std::uint32_t>(T)};
    for (std::size_t t = 0; t < T; ++t) {
        Rgb* const beta = &texels.coefficient[t * J];
        for (std::size_t k = 0; k < K; ++k) {
            const float fraction = fractions[t * K + k];
            texels.error[t] += fraction * materials.error[k];
            for (std::size_t j = 0; j < J; ++j)
                for (int c = 0; c < 3; ++c) beta[j][c] += fraction * materials.coefficient[k * J + j][c];
        }
        for (std::size_t j = 0; j < J; ++j)
            for (int c = 0; c < 3; ++c) beta[j][c] = round_to_half(std::min(beta[j][c], k_half_max));
    }
    return texels;
}

}  // namespace
