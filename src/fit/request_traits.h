// Properties of the requests of fits, and of their outcomes.
#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "srbf/fit.h"

SRBF_BEGIN

/// The bytes of a `ByteBudget`, and the ΔE_ITP of a `TargetDeltaE`.
inline constexpr std::size_t k_least_chosen_bytes = 12, k_most_chosen_bytes = 512;
inline constexpr double k_finest_delta_e = 0.01, k_most_delta_e = 100;
/// The J that `AutomaticLobes` and goals of samples choose from.
inline constexpr int k_tried_lobes[] = {2, 3, 4, 6, 9, 12};

/// The names of the models that a request can ask for, in the order of `AnyRequest`.
inline constexpr auto k_model_names = []<typename... R>(std::type_identity<std::variant<R...>>) {
    return std::array{R::k_name...};
}(std::type_identity<AnyRequest>());
inline std::string_view model_name(const FitRequest& request) { return k_model_names[request.model.index()]; }

/// The goal by which the size is chosen; none: it is a number of lobes or automatic, or the model is not multivariate.
inline std::optional<SizeGoal> goal_of(const FitRequest& request) {
    const auto* pm = std::get_if<PmRequest>(&request.model);
    const auto* goal = pm && pm->size ? std::get_if<SizeGoal>(&*pm->size) : nullptr;
    return goal ? std::optional(*goal) : std::nullopt;
}

/// True if the size is chosen by the visible error.
inline bool is_by_pictures(const FitRequest& request) {
    const auto goal = goal_of(request);
    return goal && std::holds_alternative<TargetDeltaE>(*goal);
}

/// Picture error between f and its transpose f(wv, wl). A reciprocal fit differs from one of them by at least half of
/// it.
Appearance compare_exchanged(const Evaluate& f, int threads = 0);

/// The directions of the matrix on which a model is measured: the sampled directions of a view-by-view model, otherwise
/// the Fibonacci set of k_matrix_directions within θmax [rad].
std::vector<Vec3f> matrix_directions(const Model& model, double theta_max);

SRBF_END
