#include "fit/data/folds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "k_d_tree.h"
#include "parallel.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// Disjoint sets.
class Sets {
  public:
    explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
    std::size_t of(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t i, std::size_t k) { parent_[of(i)] = of(k); }

  private:
    std::vector<std::size_t> parent_;
};

/// A point for each pair such that distances between points are, to first order, √(|Δωl|² + |Δωv|²); for isotropic
/// samples the minimum over all rotations about the normal and reflections.
std::array<double, 6> point_of(Vec3f l, Vec3f v, bool isotropic) {
    const Vec3d wl = to_double(l), wv = to_double(v);
    if (!isotropic) return {wl.x, wl.y, wl.z, wv.x, wv.y, wv.z};
    const double rl = elementary::hypot(wl.x, wl.y), rv = elementary::hypot(wv.x, wv.y),
                 both = std::max(elementary::hypot(rl, rv), 1e-30);
    // Under a relative rotation by δ the distance is rl rv / √(rl² + rv²) δ, shared between both directions.
    const double across = std::abs(wl.x * wv.y - wl.y * wv.x) / both, along = (wl.x * wv.x + wl.y * wv.y) / both;
    return {rl, wl.z, rv, wv.z, along, across};
}

}  // namespace

Places find_places(const ScatteredSamples& samples) {
    // Sample i is point 2i; with exchanged directions it is point 2i + 1.
    const std::size_t n = samples.wl.size();
    PointCloud<double, 6> cloud;
    for (std::size_t i = 0; i < n; ++i) {
        cloud.at.push_back(point_of(samples.wl[i], samples.wv[i], samples.isotropic));
        cloud.at.push_back(point_of(samples.wv[i], samples.wl[i], samples.isotropic));
    }
    KdTree<double, 6> tree(6, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    tree.buildIndex();

    Sets sets(n);
    FoundPoints<double> found;
    for (std::size_t i = 0; i < n; ++i) {
        tree.radiusSearch(cloud.at[2 * i].data(), k_same_place * k_same_place, found, {});
        for (const auto& [point, distance] : found) sets.join(i, point / 2);
    }
    Places places{std::vector<int>(n, -1), 0, 0};
    std::vector<int> number(n, -1);
    for (std::size_t i = 0; i < n; ++i) {
        int& of_set = number[sets.of(i)];
        if (of_set < 0) of_set = places.count++;
        places.of[i] = of_set;
    }

    // The nearest point of another place, among as many neighbours as necessary.
    std::vector<double> nearest;
    std::vector<std::uint32_t> point;
    std::vector<double> distance;
    for (std::size_t i = 0; i < n && places.count > 1; ++i)
        for (std::size_t wanted = 8;; wanted = std::min(4 * wanted, 2 * n)) {
            point.resize(wanted), distance.resize(wanted);
            const std::size_t count = tree.knnSearch(cloud.at[2 * i].data(), wanted, point.data(), distance.data());
            const auto other = std::find_if(point.begin(), point.begin() + std::ptrdiff_t(count),
                                            [&](std::uint32_t p) { return places.of[p / 2] != places.of[i]; });
            if (other == point.begin() + std::ptrdiff_t(count) && wanted < 2 * n) continue;
            if (other != point.begin() + std::ptrdiff_t(count))
                nearest.push_back(std::sqrt(distance[std::size_t(other - point.begin())]));
            break;
        }
    if (nearest.empty()) return places;
    const auto twentieth = nearest.begin() + std::ptrdiff_t(nearest.size() / 20);
    std::nth_element(nearest.begin(), twentieth, nearest.end());
    places.spacing = *twentieth;
    return places;
}

double spacing(const ScatteredSamples& samples) { return find_places(samples).spacing; }

Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, double max_theta, std::uint64_t seed) {
    return assign_folds(samples, find_places(samples), max_theta, seed);
}

Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, const Places& places, double max_theta,
                                      std::uint64_t seed) {
    if (places.count < k_folds)
        return Error{"samples",
                     {},
                     "samples at different directions",
                     "at least " + std::to_string(k_folds),
                     std::to_string(places.count)};
    const auto count = std::size_t(places.count);
    std::vector<double> brightness(count), samples_there(count);
    std::vector<bool> within(count, false);
    for (std::size_t i = 0; i < places.of.size(); ++i) {
        const auto place = std::size_t(places.of[i]);
        if (std::min(samples.wl[i].z, samples.wv[i].z) >= sample_cap(max_theta)) within[place] = true;
        brightness[place] += luminance(samples.colour[i]);
        samples_there[place] += 1;
    }
    for (std::size_t place = 0; place < count; ++place) brightness[place] /= samples_there[place];
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return within[a] != within[b] ? within[a] : brightness[a] > brightness[b];
    });

    std::mt19937_64 random(seed);
    std::vector<int> of_place(count), of_sample;
    for (std::size_t first = 0; first < count; first += k_folds) {
        std::array<int, k_folds> fold;
        std::iota(fold.begin(), fold.end(), 0);
        for (std::size_t k = k_folds - 1; k > 0; --k)
            std::swap(fold[k], fold[std::size_t(uniform(random) * double(k + 1))]);
        for (std::size_t k = first; k < std::min(first + k_folds, count); ++k) of_place[order[k]] = fold[k - first];
    }
    for (const int place : places.of) of_sample.push_back(of_place[std::size_t(place)]);
    return of_sample;
}

ScatteredSamples without_fold(const ScatteredSamples& samples, std::span<const int> fold, int left_out) {
    ScatteredSamples rest;
    rest.description = samples.description;
    rest.isotropic = samples.isotropic;
    rest.wavelengths = samples.wavelengths;
    const std::size_t C = samples.wavelengths.size();
    for (std::size_t i = 0; i < fold.size(); ++i) {
        if (fold[i] == left_out) continue;
        rest.wl.push_back(samples.wl[i]);
        rest.wv.push_back(samples.wv[i]);
        rest.colour.push_back(samples.colour[i]);
        const auto spectrum = samples.spectrum.begin() + std::ptrdiff_t(i * C);
        if (!samples.spectrum.empty())
            rest.spectrum.insert(rest.spectrum.end(), spectrum, spectrum + std::ptrdiff_t(C));
    }
    make_index(rest);
    return rest;
}

Result<std::vector<std::vector<float>>> cross_validate(const ScatteredSamples& samples, std::span<const int> fold,
                                                       const FitToSamples& fit) {
    std::array<std::optional<Result<std::vector<Model>>>, k_folds> models;
    const FlushSubnormals mode;
    parallel_for(std::size_t(k_folds),
                 [&](std::size_t left_out) { models[left_out] = fit(without_fold(samples, fold, int(left_out))); });
    std::vector<std::vector<float>> predicted;
    for (int left_out = 0; left_out < k_folds; ++left_out) {
        const auto& of_fold = *models[std::size_t(left_out)];
        if (!of_fold) return of_fold.error();
        predicted.resize(of_fold->size());
        for (std::size_t k = 0; k < predicted.size(); ++k) {
            // Colours come from `value`, which is the same on any machine.
            const Model& fitted = (*of_fold)[k];
            const Channels model =
                wavelengths(fitted).empty() ? rgb_channels(evaluator<Model>(fitted)) : channels(fitted);
            const std::size_t C = model.count();
            std::vector<float> f(C * samples.wl.size());
            model.evaluate(samples.wl, samples.wv, f);
            predicted[k].resize(f.size());
            for (std::size_t i = 0; i < fold.size(); ++i)
                if (fold[i] == left_out) std::copy_n(&f[i * C], C, &predicted[k][i * C]);
        }
    }
    return predicted;
}

}  // namespace srbf
