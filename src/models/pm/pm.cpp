#include "srbf/models/pm.h"

#include "base/half.h"
#include "brdf/colour.h"
#include "models/pm/pm_functions.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {

static_assert(k_terms.size() == SRBF_TERMS);

Rgb value(const PmModel& model, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const Vec3f f = Kernel<float>::pm_value(model, wl, wv);
    return {f.x, f.y, f.z};
}

bool is_reciprocal(const PmModel& model) {
    if (is_reciprocal(model.form)) return true;
    const auto J = std::size_t(model.lobes), N = std::size_t(model.variates);
    std::vector<bool> matched(N, false);
    const auto are_swapped = [&](std::size_t n, std::size_t m) {
        const Parameterization p = model.parameterization[n], q = model.parameterization[m];
        bool same = p.a == q.b && p.b == q.a;
        for (std::size_t j = 0; j < J; ++j)
            same = same && model.bandwidth[j * N + n] == model.bandwidth[j * N + m] &&
                   model.centre[j * N + n] == model.centre[j * N + m];
        return same;
    };
    for (std::size_t n = 0; n < N; ++n)
        for (std::size_t m = n; m < N && !matched[n]; ++m)
            if (!matched[m] && are_swapped(n, m)) matched[n] = matched[m] = true;
    return std::all_of(matched.begin(), matched.end(), [](bool x) { return x; });
}

bool has_log_scale(const PmModel& model) {
    return features(model.form) > 0 ||
           std::any_of(model.log_scale.begin(), model.log_scale.end(), [](float s) { return round_to_half(s) != 0; });
}

std::size_t payload_bytes(const PmModel& model) {
    return payload_bytes(model.form, model.axial, has_log_scale(model), model.lobes, model.variates,
                         model.wavelength.empty() ? 3 : int(model.wavelength.size()));
}

std::vector<Rgb> colours(std::span<const float> spectra, std::span<const float> wavelengths) {
    const std::vector<Rgb> weights = rgb_weights(wavelengths);
    std::vector<Rgb> colours;
    for (; !spectra.empty(); spectra = spectra.subspan(weights.size()))
        colours.push_back(to_rgb(spectra.first(weights.size()), weights));
    return colours;
}

void exchange(PmModel& model) {
    for (Parameterization& p : model.parameterization) std::swap(p.a, p.b);  // everything else is symmetric
}

}  // namespace
