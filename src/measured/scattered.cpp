#include <cassert>
#include <numeric>

#include "base/floating_point.h"
#include "base/k_d_tree.h"
#include "brdf/values.h"
#include "measured/angles.h"
#include "measured/bytes.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr std::uint32_t k_neighbours = 8;

using Point = std::array<float, 5>;

/// Coordinates of a pair for the neighbour search, see `ScatteredSamples`.
Point coordinates_of(Vec3f wl, Vec3f wv, bool isotropic) {
    constexpr float sharpness = 20, right_angle = float(k_pi / 2);
    const float scale = right_angle / elementary::log1p(sharpness * right_angle);
    const float half = scale * elementary::log1p(sharpness * polar_angle(wl + wv));
    const float theta_l = polar_angle(wl), theta_v = polar_angle(wv);
    if (isotropic) return {half, theta_l, theta_v, 0, 0};
    const float phi_l = azimuth(wl.y, wl.x), phi_v = azimuth(wv.y, wv.x);
    return {half, theta_l * elementary::cos(phi_l), theta_l * elementary::sin(phi_l), theta_v * elementary::cos(phi_v),
            theta_v * elementary::sin(phi_v)};
}

using Points = PointCloud<float, 5>;

/// Collects the nearest points, in the interface that nanoflann requires. Of samples at equal distances it keeps the
/// first, so that the result does not depend on nanoflann's version. If very many samples are at one distance, any of
/// them are valid: the search ends after `k_patience` candidates that were not nearer.
class Nearest {
  public:
    using DistanceType = float;
    using IndexType = std::uint32_t;
    explicit Nearest(std::size_t max) : max_(max) {}
    std::size_t size() const { return count_; }
    bool empty() const { return count_ == 0; }
    bool full() const { return count_ == max_; }
    void sort() const {}  // they are sorted
    bool addPoint(float distance2, std::uint32_t sample) {
        const std::pair found(distance2, sample);
        if (full() && !(found < found_[count_ - 1])) return true;
        candidates_ = 0;
        std::size_t k = full() ? count_ - 1 : count_++;
        for (; k > 0 && found < found_[k - 1]; --k) found_[k] = found_[k - 1];
        found_[k] = found;
        return true;
    }
    /// A little more than the largest distance, so that nanoflann also adds points at the same distance.
    float worstDist() const {
        if (!full()) return std::numeric_limits<float>::max();
        return ++candidates_ > k_patience ? -1 : found_[count_ - 1].first * 1.000001f;
    }
    const std::pair<float, std::uint32_t>& operator[](std::size_t i) const { return found_[i]; }

  private:
    static constexpr int k_patience = 2000;  // known measurements need at most 108
    std::size_t max_, count_ = 0;
    std::array<std::pair<float, std::uint32_t>, k_neighbours + 1> found_;
    mutable int candidates_ = 0;
};

}  // namespace

/// An index of samples by their coordinates. It keeps no reference to the samples; copies of a measurement share it.
class SampleIndex {
  public:
    SampleIndex(Points points, std::vector<std::uint32_t> sample)
        : points_(std::move(points)),
          sample_(std::move(sample)),
          tree_(5, points_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

    struct Neighbours {
        std::uint32_t count;
        std::array<std::uint32_t, k_neighbours + 1> sample;
        std::array<float, k_neighbours + 1> distance2;
    };
    /// The nearest samples, in order of distance.
    Neighbours nearest(const Point& point) const {
        Neighbours found;
        Nearest result(std::min<std::size_t>(k_neighbours + 1, points_.coordinates.size()));
        tree_.findNeighbors(result, point.data(), {});
        found.count = std::uint32_t(result.size());
        for (std::size_t i = 0; i < result.size(); ++i)
            found.distance2[i] = result[i].first, found.sample[i] = sample_[result[i].second];
        return found;
    }

  private:
    Points points_;
    std::vector<std::uint32_t> sample_;  ///< the index of each point's sample, in ascending order
    KdTree<float, 5> tree_;
};

namespace {

/// Removes coincident points beyond the number that a search returns, since searches among very many are as slow as in
/// a list. Returns the indices of the others.
std::vector<std::uint32_t> keep_few_coincident(Points& points) {
    auto& coordinates = points.coordinates;
    std::vector<std::uint32_t> order(coordinates.size()), kept;
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(coordinates[i], i); });
    for (std::size_t k = 0, before = 0; k < order.size(); ++k) {
        before = k > 0 && coordinates[order[k]] == coordinates[order[k - 1]] ? before + 1 : 0;
        if (before <= k_neighbours) kept.push_back(order[k]);
    }
    std::ranges::sort(kept);
    for (std::size_t i = 0; i < kept.size(); ++i) coordinates[i] = coordinates[kept[i]];
    coordinates.resize(kept.size());
    return kept;
}

}  // namespace

void make_index(ScatteredSamples& samples) {
    const StandardArithmetic mode;
    Points points;
    points.coordinates.reserve(samples.wl.size());
    for (std::size_t i = 0; i < samples.wl.size(); ++i)
        points.coordinates.push_back(coordinates_of(samples.wl[i], samples.wv[i], samples.isotropic));
    std::vector<std::uint32_t> kept = keep_few_coincident(points);
    samples.index = std::make_shared<const SampleIndex>(std::move(points), std::move(kept));
}

namespace {

/// Interpolation between samples: Σ_k weight_k number(sample_k).
struct Blend {
    std::uint32_t count = 0;
    std::array<std::size_t, k_neighbours> sample;
    std::array<double, k_neighbours> weight;

    /// At the horizon the result may exceed the range of float, and is clamped.
    template <typename Number> float interpolate(const Number& number) const {
        double sum = 0;
        for (std::uint32_t k = 0; k < count; ++k) sum += weight[k] * double(number(sample[k]));
        return float(std::clamp<double>(sum, -k_max_float, k_max_float));
    }
    Rgb colour(const ScatteredSamples& samples) const {
        const auto channel = [&](int c) { return interpolate([&](std::size_t i) { return samples.colour[i][c]; }); };
        return {channel(0), channel(1), channel(2)};
    }
};

/// The weights w_k / Σ w_k.
Blend blend(const ScatteredSamples& samples, Vec3f wl, Vec3f wv) {
    assert(samples.index);
    const auto near = samples.index->nearest(coordinates_of(wl, wv, samples.isotropic));
    // Modified Shepard weights ((R − d) / (R d))², R being the distance of the ninth neighbour. Distances below
    // rounding count as 0 and give the value of the sample itself.
    const double rounding = 1e-6, R = std::sqrt(double(near.distance2[near.count - 1]));
    const bool is_sample = double(near.distance2[0]) <= rounding * rounding;
    Blend blend;
    blend.count = near.count > k_neighbours ? k_neighbours : near.count;
    double weights = 0;
    for (std::uint32_t k = 0; k < blend.count; ++k) {
        const double d = std::sqrt(double(near.distance2[k]));
        double w = 1 / std::max(d, rounding);
        if (is_sample)
            w = d <= rounding;
        else if (near.count > k_neighbours)
            w = w - 1 / R;
        blend.sample[k] = near.sample[k];
        blend.weight[k] = w * w;
        weights += w * w;
    }
    if (!(weights > 0)) {  // all neighbours are at the same distance
        blend.weight.fill(1);
        weights = blend.count;
    }
    for (double& weight : blend.weight) weight /= weights;
    return blend;
}

/// The weights of f_r: the weights of f A times ((1 − t) / A + t / Ā), see `ScatteredSamples`.
Blend blend_of_values(const ScatteredSamples& samples, Vec3f wl, Vec3f wv) {
    constexpr double ridge = 0.01, rounding = 1e-12;
    Blend blend = srbf::blend(samples, wl, wv);
    double a = 0, aa = 0, fa = 0, faa = 0;  // means of A, A², f A, f A²
    for (std::uint32_t k = 0; k < blend.count; ++k) {
        const std::size_t i = blend.sample[k];
        const double A = cosines(samples.wl[i], samples.wv[i]), w = blend.weight[k];
        const Rgb& colour = samples.colour[i];
        const double f = double(colour.r) + double(colour.g) + double(colour.b);
        a += w * A;
        aa += w * A * A;
        fa += w * f * A;
        faa += w * f * A * A;
        blend.weight[k] *= A;
    }
    // 1 − t, of the least Σ w (f_k A_k − f A − s (A_k − Ā))² + ridge Ā² (s − f A / Ā)² with t = s Ā / (f A)
    const double rest = fa > 0 ? aa - a * faa / fa : 0;
    const double flat = rest > rounding * aa ? std::min(rest / (aa - a * a + ridge * a * a), 1.0) : 0;
    for (double& weight : blend.weight) weight *= flat / cosines(wl, wv) + (1 - flat) / a;
    return blend;
}

}  // namespace

Rgb mean_of_neighbours(const ScatteredSamples& samples, Vec3f wl, Vec3f wv) {
    return blend(samples, wl, wv).colour(samples);
}

Rgb signed_value(const ScatteredSamples& samples, Vec3f wl, Vec3f wv) {
    return above_horizon(wl, wv) ? blend_of_values(samples, wl, wv).colour(samples) : Rgb{};
}

void signed_spectrum(const ScatteredSamples& samples, Vec3f wl, Vec3f wv, std::span<float> f) {
    std::ranges::fill(f, 0.0f);
    if (!above_horizon(wl, wv)) return;
    const Blend neighbours = blend_of_values(samples, wl, wv);
    for (std::size_t c = 0; c < f.size(); ++c)
        f[c] = neighbours.interpolate([&](std::size_t i) { return samples.spectrum[i * f.size() + c]; });
}

}  // namespace
