#include "observe/excess.h"

#include <algorithm>

#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

double bound_cosines(Vec3f wl, Vec3f wv) {
    return std::max(double(wl.z), k_grazing_cosine) * std::max(double(wv.z), k_grazing_cosine);
}

double largest_measured(const Observations& observations) {
    double largest = 0;
    for (std::size_t i = 0; i < observations.f.size(); ++i)
        largest = std::max(largest, largest_of(observations.f[i]) * cosines(observations.wl[i], observations.wv[i]));
    return largest;
}

std::vector<std::size_t> exceeded_pairs(const Observations& observations, std::size_t first, const PmModel& model,
                                        double largest) {
    const std::span<const Vec3f> wl(observations.wl), wv(observations.wv);
    std::vector<Rgb> f(wl.size() - first);
    evaluator(model)(wl.subspan(first), wv.subspan(first), f);
    std::vector<std::size_t> where;
    for (std::size_t i = first; i < wl.size(); ++i)
        if (largest_of(f[i - first]) * bound_cosines(wl[i], wv[i]) > k_max_excess * largest) where.push_back(i);
    return where;
}

PmModel only_lobe(PmModel model, int lobe) {
    for (int j = 0; j < model.lobes; ++j)
        if (j != lobe) model.coefficient[std::size_t(j)] = {};
    return model;
}

double bound_weight(const Observations& observations, std::size_t i, double loss, double largest) {
    return k_excess_weight * loss * elementary::square(bound_cosines(observations.wl[i], observations.wv[i]) / largest);
}

std::size_t promote_exceeded_pairs(Observations& observations, std::size_t first, const PmModel& model, double loss) {
    const double largest = largest_measured(observations);
    const std::vector<std::size_t> where = exceeded_pairs(observations, first, model, largest);
    for (const std::size_t i : where) {
        const std::size_t end = observations.fitted_count();
        if (i < end) {
            observations.weight[i] *= k_bound_growth;
            continue;
        }
        observations.swap_rows(i, end);
        observations.weight[end] = bound_weight(observations, end, loss, largest);
        --observations.bound_pairs;
    }
    return where.size();
}

}  // namespace
