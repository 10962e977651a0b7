// Fits and their errors, as Python calls them.
#pragma once
#include <cstring>
#include <functional>

#include "background.h"
#include "brdf.h"
#include "brdf/directions.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "fit/request_traits.h"
#include "srbf/fit.h"

namespace srbf {

inline py::dict measures_of(const Comparison& comparison) {
    py::dict errors;
    for_measures(comparison, [&](const std::string& name, double value) { errors[name.c_str()] = value; });
    if (comparison.appearance.lighting.empty()) return errors;
    for (const PictureErrorName& error : k_picture_errors)
        errors[error.name] = comparison.appearance.mean.*error.member;
    errors["worst_delta_e_itp"] = comparison.appearance.worst_delta_e;
    if (comparison.heldout_appearance) {
        errors["heldout_delta_e_itp"] = comparison.heldout_appearance->mean.delta_e;
        errors["heldout_worst_delta_e_itp"] = comparison.heldout_appearance->worst_delta_e;
    }
    errors["judged_delta_e_itp"] = headline_errors(comparison).mean.delta_e;
    if (comparison.measure) errors["samples_delta_e_itp"] = comparison.samples_delta_e;
    errors["headline"] = headline(comparison);
    py::dict lightings;
    for (std::size_t i = 0; i < comparison.appearance.lighting.size(); ++i) {
        py::dict lighting;
        for (const PictureErrorName& error : k_picture_errors)
            lighting[error.name] = comparison.appearance.lighting[i].*error.member;
        lightings[py::str(std::string(standard_lightings()[i].name))] = lighting;
    }
    errors["lightings"] = lightings;
    return errors;
}

inline py::dict outcome_of(FitOutcome outcome) {
    using namespace pybind11::literals;
    return py::dict("errors"_a = outcome.errors ? py::object(measures_of(*outcome.errors)) : py::none(),
                    "seconds"_a = outcome.fit_seconds, "reached"_a = outcome.reached,
                    "stop_reason"_a = outcome.stop ? py::object(py::str(std::string(name(*outcome.stop)))) : py::none(),
                    "model"_a = PyBrdf(std::move(outcome.model)));
}

inline py::dict fit_brdf(const PyBrdf& brdf, const FitRequest& request, const py::object& progress) {
    if (!brdf.measured()) raise({"srbf.fit", {}, "input", "a measurement", "a model", ErrorCode::wrong_kind});
    if (is_two_sided(brdf.content())) {
        BsdfOutcome outcome = required(in_background(
            progress, [&](const ProgressToken& token) { return fit_bsdf(*brdf.measured(), request, token); }));
        py::dict errors;
        for (const PartFit& part : outcome.parts)
            errors[py::str(std::string(name(part.part)))] = part.squared_error_ratio;
        using namespace pybind11::literals;
        return py::dict("errors"_a = errors, "seconds"_a = outcome.fit_seconds, "reached"_a = true,
                        "stop_reason"_a = py::none(), "model"_a = PyBrdf(std::move(outcome.model)));
    }
    FitOutcome outcome = required(
        in_background(progress, [&](const ProgressToken& token) { return fit(*brdf.measured(), request, token); }));
    return outcome_of(std::move(outcome));
}

/// A function of Python as a BRDF: `function(wl, wv)` returns f_r of n pairs as an array [n, 3] or [n, 1]. An
/// exception of the function is kept and cancels the computation that called it.
class CalledFunction {
  public:
    CalledFunction(const py::function& function, const ProgressToken& token) : function_(function), token_(token) {}

    void operator()(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        const py::gil_scoped_acquire acquired;
        std::ranges::fill(f, Rgb{});
        if (raised_) return;
        try {
            const auto n = py::ssize_t(wl.size());
            const auto array = [n](std::span<const Vec3f> w) { return array_of({&w[0].x, 3 * w.size()}, {n, 3}); };
            using Numbers = py::array_t<float, py::array::c_style | py::array::forcecast>;
            const Numbers values(function_(array(wl), array(wv)));
            const bool has_rows = values.ndim() == 2 && values.shape(0) == n;
            if (!has_rows || (values.shape(1) != 3 && values.shape(1) != 1)) {
                const auto shape = py::str(py::list(values.attr("shape"))).cast<std::string>();
                const std::string rows = std::to_string(n);
                throw py::value_error("function: expected shape [" + rows + ", 3] or [" + rows + ", 1], found " +
                                      shape);
            }
            const Numbers numbers = py::module_::import("numpy").attr("broadcast_to")(values, py::make_tuple(n, 3));
            std::memcpy(f.data(), numbers.data(), f.size() * sizeof(Rgb));
        } catch (...) {
            raised_ = std::current_exception();
            token_.cancel();
        }
    }
    std::exception_ptr raised() const { return raised_; }

  private:
    const py::function& function_;
    const ProgressToken& token_;
    std::exception_ptr raised_;
};

/// Runs work(f, token) with `function` as the BRDF f, and rethrows the exception of `function`, if any.
template <typename Work>
auto with_function(const py::function& function, const py::object& progress, const Work& work) {
    std::exception_ptr raised;
    auto result = in_background(progress, [&](const ProgressToken& token) {
        CalledFunction f(function, token);
        auto output = work(Evaluate(std::ref(f)), token);
        raised = f.raised();
        return output;
    });
    if (raised) std::rethrow_exception(raised);
    return result;
}

inline py::dict fit_function(const py::function& function, const FitRequest& request, const py::object& progress) {
    return outcome_of(required(with_function(
        function, progress, [&](const Evaluate& f, const ProgressToken& token) { return fit(f, request, token); })));
}

inline py::dict errors(const PyBrdf& reference, const PyBrdf& other, double max_theta, int threads) {
    const double theta = max_theta * k_degree;
    const Evaluate a = reference.evaluate(), others[] = {other.evaluate()};
    const std::vector<Vec3f> directions =
        other.model() ? matrix_directions(*other.model(), theta) : fibonacci_directions(k_matrix_directions, theta);
    return measures_of(in_background(py::none(), [&](const ProgressToken& token) {
        return compare(a, others, {theta, threads, token}, directions);
    })[0]);
}

inline py::dict errors_of_function(const PyBrdf& reference, const py::function& other, double max_theta, int threads) {
    const double theta = max_theta * k_degree;
    const Evaluate a = reference.evaluate();
    const std::vector<Vec3f> directions = fibonacci_directions(k_matrix_directions, theta);
    return measures_of(with_function(other, py::none(), [&](const Evaluate& f, const ProgressToken& token) {
        return compare(a, std::array{f}, {theta, threads, token}, directions);
    })[0]);
}

}  // namespace srbf
