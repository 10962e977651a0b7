#include "fit/cuda/batched_search.h"

#include <algorithm>

#include "least_squares.h"

namespace srbf {
namespace {

/// The steps of one stage.
struct Steps {
    Batches& batches;
    double log_peak_limit;

    DeviceWork work_on(const BatchedCandidate& of, int iterations) const {
        DeviceWork work;
        work.rows = of.rows, work.lobes = of.candidate.lobes;
        work.log_peak_limit = log_peak_limit, work.iterations = iterations;
        return work;
    }
    static void take(BatchedCandidate& of, DeviceWork& work) {
        of.candidate.lobes = std::move(work.lobes), of.candidate.loss = work.loss;
        of.beta = std::move(work.beta), of.gram = std::move(work.gram);
    }

    Result<Done> optimise(std::span<BatchedCandidate> all, int iterations) const {
        std::vector<DeviceWork> work;
        for (const BatchedCandidate& of : all) work.push_back(work_on(of, iterations));
        if (const auto done = batches.optimise(work); !done) return done;
        for (std::size_t i = 0; i < all.size(); ++i) take(all[i], work[i]);
        return Done{};
    }

    /// Adds the best of many random lobes to each.
    Result<Done> add_lobes(std::span<DeviceWork> work, std::span<std::mt19937_64> random) const {
        for (std::size_t i = 0; i < work.size(); ++i) work[i].candidates = random_candidates(random[i], work[i].lobes);
        if (const auto done = batches.best_additions(work); !done) return done;
        for (DeviceWork& of : work) {
            of.lobes = with_lobe(std::move(of.lobes), of.addition);
            of.candidates.clear();
        }
        return Done{};
    }

    /// Optimises the work and keeps what is better than the candidate it came from.
    Result<Done> keep_better(std::span<BatchedCandidate* const> all, std::span<DeviceWork> work) const {
        for (std::size_t i = 0; i < all.size(); ++i)
            work[i].iterations = k_perturbation_steps, work[i].target = all[i]->candidate.loss;
        if (const auto done = batches.optimise(work); !done) return done;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (work[i].loss < all[i]->candidate.loss) take(*all[i], work[i]);
        return Done{};
    }

    Result<Done> replace_lobes(std::span<BatchedCandidate* const> all, std::span<std::mt19937_64> random) const {
        std::vector<DeviceWork> work;
        for (const BatchedCandidate* of : all) {
            const std::vector<double> cost = cost_of_dropping(of->gram, of->beta);
            work.push_back(work_on(*of, 0));
            work.back().lobes =
                without_lobe(std::move(work.back().lobes), std::min_element(cost.begin(), cost.end()) - cost.begin());
        }
        if (const auto added = add_lobes(work, random); !added) return added;
        return keep_better(all, work);
    }

    Result<Done> replace_variates(std::span<BatchedCandidate* const> all, std::span<std::mt19937_64> random) const {
        std::vector<DeviceWork> without, work;
        for (const BatchedCandidate* of : all)
            for (int n = 0; n < of->candidate.lobes.shape.variates; ++n) {
                without.push_back(work_on(*of, 0));
                without.back().lobes = without_variate(std::move(without.back().lobes), n);
            }
        if (const auto done = batches.optimise(without); !done) return done;
        std::size_t first = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const auto N = std::size_t(all[i]->candidate.lobes.shape.variates);
            const auto of_this = std::span(without).subspan(first, N);
            const auto least = std::ranges::min_element(of_this, {}, &DeviceWork::loss) - of_this.begin();
            work.push_back(work_on(*all[i], 0));
            work.back().lobes = std::move(of_this[std::size_t(least)].lobes);
            work.back().lobes.angle[std::size_t(least)] = k_pi * uniform(random[i]);
            first += N;
        }
        return keep_better(all, work);
    }
};

std::vector<BatchedCandidate*> pointers_to(std::span<BatchedCandidate> all) {
    std::vector<BatchedCandidate*> pointers;
    for (BatchedCandidate& of : all) pointers.push_back(&of);
    return pointers;
}

}  // namespace

Result<Done> grow(Batches& batches, const FitOptions& options, double log_peak_limit,
                  std::span<BatchedCandidate> candidates, Reporter& reporter) {
    const Steps steps{batches, log_peak_limit};
    std::vector<std::mt19937_64> random;
    for (BatchedCandidate& of : candidates) {
        random.push_back(generator(options.seed, of.candidate.start, 0));
        of.candidate.lobes = without_lobes(shape_of(options), of.candidate.start, random.back());
    }
    for (int j = 0; j < options.lobes; ++j) {
        std::vector<DeviceWork> work;
        for (const BatchedCandidate& of : candidates)
            work.push_back(steps.work_on(of, j + 1 < options.lobes ? k_growth_steps : k_grown_steps));
        if (const auto added = steps.add_lobes(work, random); !added) return added;
        if (const auto done = batches.optimise(work); !done) return done;
        for (std::size_t i = 0; i < work.size(); ++i) Steps::take(candidates[i], work[i]);
        if (!reporter.advance("growing lobes", double(candidates.size()))) break;
    }
    return Done{};
}

Result<Done> improve(Batches& batches, const FitOptions& options, double log_peak_limit, int until,
                     std::span<BatchedCandidate> candidates, Reporter& reporter) {
    const Steps steps{batches, log_peak_limit};
    if (candidates.empty() || candidates[0].candidate.perturbations >= until) return Done{};
    if (const auto done = steps.optimise(candidates, k_first_steps); !done) return done;
    const auto all = pointers_to(candidates);
    while (candidates[0].candidate.perturbations < until) {
        std::vector<std::mt19937_64> random;
        for (BatchedCandidate& of : candidates)
            random.push_back(generator(options.seed, of.candidate.start, 2 + of.candidate.perturbations++));
        const bool of_variates = candidates[0].candidate.perturbations % (k_lobe_perturbations + 1) == 0;
        const auto done = of_variates ? steps.replace_variates(all, random) : steps.replace_lobes(all, random);
        if (!done) return done;
        if (!reporter.advance("replacing lobes", double(candidates.size()))) break;
    }
    return Done{};
}

Result<Done> polish(Batches& batches, const FitOptions& options, double log_peak_limit,
                    std::span<BatchedCandidate> candidates) {
    const Steps steps{batches, log_peak_limit};
    if (const auto done = steps.optimise(candidates, k_polish_steps); !done) return done;
    std::vector<std::mt19937_64> random;
    for (const BatchedCandidate& of : candidates) random.push_back(generator(options.seed, of.candidate.start, 1));
    for (int attempt = 0; attempt < k_polish_attempts; ++attempt) {
        std::vector<BatchedCandidate*> with_useless;
        std::vector<std::mt19937_64> of_these;
        std::vector<std::size_t> place;
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const std::vector<double> cost = cost_of_dropping(candidates[i].gram, candidates[i].beta);
            if (*std::min_element(cost.begin(), cost.end()) > k_useless * candidates[i].candidate.loss) continue;
            with_useless.push_back(&candidates[i]), of_these.push_back(random[i]), place.push_back(i);
        }
        if (with_useless.empty()) break;
        if (const auto done = steps.replace_lobes(with_useless, of_these); !done) return done;
        for (std::size_t k = 0; k < place.size(); ++k) random[place[k]] = of_these[k];
    }
    return Done{};
}

}  // namespace srbf
