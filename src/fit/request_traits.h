// Properties of the requests of fits, and of their outcomes.
#pragma once
#include <type_traits>

#include "srbf/fit.h"

SRBF_BEGIN

/// The ΔE_ITP of `AutomaticLobes`.
inline constexpr double k_finest_delta_e = 0.01, k_max_delta_e = 100;
/// The numbers of lobes that it tries; for samples up to k_max_sample_lobes.
inline constexpr int k_tried_lobes[] = {2, 3, 4, 6, 9, 12, 16, 24}, k_max_sample_lobes = 12;

/// The names of the models that a request can ask for, in the order of `AnyRequest`.
inline constexpr auto k_model_names = []<typename... R>(std::type_identity<std::variant<R...>>) {
    return std::array{R::k_name...};
}(std::type_identity<AnyRequest>());
inline std::string_view model_name(const FitRequest& request) { return k_model_names[request.model.index()]; }

/// The requested ΔE_ITP by which the size is chosen, if any.
inline std::optional<double> target_of(const FitRequest& request) {
    const auto* pm = std::get_if<PmRequest>(&request.model);
    const auto* chosen = pm && pm->size ? std::get_if<AutomaticLobes>(&*pm->size) : nullptr;
    return chosen ? chosen->delta_e : std::nullopt;
}

/// The directions of the matrix on which a model is measured: the sampled directions of a view-by-view model, otherwise
/// the Fibonacci set of k_matrix_directions within θmax [rad].
std::vector<Vec3f> matrix_directions(const Model& model, double theta_max);

SRBF_END
