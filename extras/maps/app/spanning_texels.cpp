#include "extras/maps/app/spanning_texels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brdf/directions.h"
#include "brdf/values.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of candidates for the texels that span the set, and the most values of them in memory.
constexpr std::size_t k_spread_texels = 1024, k_most_values = std::size_t(1) << 24;
/// A candidate's values are left out where f cosθl cosθv is more than k_most_of_others times the largest one of any
/// pair in all but the brightest k_brightest of the candidates.
constexpr double k_brightest = 0.02, k_most_of_others = 1000;

/// Makes values of the candidates unknown that no other texel is near.
void leave_out_outliers(const SharedPairs& pairs, std::span<Rgb> f) {
    const std::size_t M = pairs.wl.size();
    const auto value = [&](std::size_t i) {
        const double of = largest_of(f[i]) * cosines(pairs.wl[i % M], pairs.wv[i % M]);
        return is_finite(f[i]) ? of : 0;
    };
    std::vector<double> largest(f.size() / M);
    for (std::size_t i = 0; i < f.size(); ++i) largest[i / M] = std::max(largest[i / M], value(i));
    std::ranges::sort(largest);
    const double most = k_most_of_others * largest[std::size_t((1 - k_brightest) * double(largest.size() - 1))];
    for (std::size_t i = 0; i < f.size() && most > 0; ++i)
        if (value(i) > most) f[i].r = std::numeric_limits<float>::quiet_NaN();
}

/// The values of texels that span the set: each is the one farthest from those chosen before, by cube roots.
std::vector<Rgb> spanning_texels(std::span<const Rgb> f, std::size_t pairs, std::size_t most) {
    const std::size_t count = f.size() / pairs;
    const auto distance = [&](std::size_t a, std::size_t b) {
        double sum = 0;
        for (std::size_t i = 0; i < pairs; ++i)
            for (int c = 0; c < 3; ++c) {
                const double x = double(f[a * pairs + i][c]), y = double(f[b * pairs + i][c]);
                const double d = std::cbrt(x) - std::cbrt(y);
                if (std::isfinite(d)) sum += d * d;
            }
        return sum;
    };
    std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
    std::vector<Rgb> chosen;
    std::size_t next = 0;
    for (std::size_t n = 0; n < std::min(count, most); ++n) {
        chosen.insert(chosen.end(), f.begin() + std::ptrdiff_t(next * pairs),
                      f.begin() + std::ptrdiff_t((next + 1) * pairs));
        for (std::size_t t = 0; t < count; ++t) nearest[t] = std::min(nearest[t], distance(t, next));
        next = std::size_t(std::ranges::max_element(nearest) - nearest.begin());
    }
    return chosen;
}

}  // namespace

Result<std::vector<Rgb>> spanning_values(const Texels& texels, const SharedPairs& pairs, std::size_t most) {
    const std::size_t M = pairs.wl.size(), held = std::max(k_most_values / M, most),
                      spread = std::min({texels.count(), k_spread_texels, held});
    std::vector<Rgb> candidates(spread * M);
    for (std::size_t n = 0; n < spread; ++n)
        if (const auto read = texels.read(n * texels.count() / spread, std::span(candidates).subspan(n * M, M)); !read)
            return read.error();
    leave_out_outliers(pairs, candidates);
    return spanning_texels(candidates, M, most);
}

}  // namespace srbf
