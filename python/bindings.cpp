// The library for Python: the module srbf._srbf, over which python/srbf/__init__.py lays arrays of any shape. Arrays
// here are contiguous, of float32, and of shape [n, 3] where they hold directions or colours.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "parallel.h"
#include "srbf/directions.h"
#include "srbf/file.h"
#include "srbf/fit_batch.h"
#include "srbf/fit_bsdf.h"
#include "srbf/fitting.h"
#include "srbf/load.h"
#include "srbf/prepared_bsdf.h"
#include "srbf/shading_code.h"

namespace py = pybind11;

namespace srbf {
namespace {

using Array = py::array_t<float, py::array::c_style>;
static_assert(sizeof(Vec3f) == 12 && sizeof(Rgb) == 12);

// ---- Arrays ------------------------------------------------------------------------------------------------------

std::size_t rows(const Array& array) { return std::size_t(array.shape(0)); }
template <typename T> std::span<const T> span_of(const Array& array) {
    return {reinterpret_cast<const T*>(array.data()), rows(array)};
}
template <typename T> std::span<T> changing(Array& array) {
    return {reinterpret_cast<T*>(array.mutable_data()), rows(array)};
}
Array array_of(std::span<const float> numbers, std::vector<py::ssize_t> shape) {
    Array array(std::move(shape));
    std::copy(numbers.begin(), numbers.end(), array.mutable_data());
    return array;
}
template <typename T> std::span<const float> floats(const std::vector<T>& of) {
    return {reinterpret_cast<const float*>(of.data()), of.size() * sizeof(T) / sizeof(float)};
}

/// Raises srbf.Error.
[[noreturn]] void raise(const Error& error) {
    const py::object type = py::module_::import("srbf").attr("Error");
    const py::object offset = error.offset ? py::cast(*error.offset) : py::none();
    const py::object made = type(message(error), error.source, offset, error.what, error.expected, error.found,
                                 std::string(name(error.code)));
    PyErr_SetObject(type.ptr(), made.ptr());
    throw py::error_already_set();
}
template <typename T> T required(Result<T> result) {
    if (!result) raise(result.error());
    return *std::move(result);
}

/// Raises ValueError for the first row that is not a unit vector, within 1e-3 of the square of its length.
void require_unit(const Array& directions, const char* argument) {
    const std::span<const Vec3f> w = span_of<Vec3f>(directions);
    constexpr std::size_t block = 1024;
    for (std::size_t first = 0; first < w.size(); first += block) {
        const std::size_t end = std::min(first + block, w.size());
        int wrong = 0;
        for (std::size_t i = first; i < end; ++i) wrong += !(std::abs(dot(w[i], w[i]) - 1) < 1e-3f);
        for (std::size_t i = first; wrong > 0 && i < end; ++i)
            if (!(std::abs(dot(w[i], w[i]) - 1) < 1e-3f))
                throw py::value_error(std::string(argument) + " at " + std::to_string(i) +
                                      ": expected a unit vector, found (" + std::to_string(w[i].x) + ", " +
                                      std::to_string(w[i].y) + ", " + std::to_string(w[i].z) + ")");
    }
}

/// Calls body(first, count) for parts of n rows, on all threads if there are many.
template <typename Body> void in_parts(std::size_t n, const Body& body) {
    constexpr std::size_t part = 1 << 14;
    const py::gil_scoped_release released;
    parallel_for((n + part - 1) / part, n > part ? 0 : 1,
                 [&](std::size_t i) { body(i * part, std::min(part, n - i * part)); });
}

// ---- A BRDF ------------------------------------------------------------------------------------------------------

/// A measurement or a model, with what sampling needs made when it is first asked for.
class Held {
  public:
    explicit Held(AnyBrdf content) : content_(std::make_shared<const AnyBrdf>(std::move(content))) {}

    const AnyBrdf& content() const { return *content_; }
    const Model* model() const { return std::get_if<Model>(content_.get()); }
    const Measured* measured() const { return std::get_if<Measured>(content_.get()); }
    const Model& require_model() const {
        if (!model()) raise({"srbf", {}, "brdf", "a model", "a measurement", ErrorCode::wrong_kind});
        return *model();
    }
    bool isotropic() const {
        return std::visit([](const auto& of) { return is_isotropic(of); }, *content_);
    }
    /// It shares the content.
    Evaluate evaluate() const {
        const auto kept = content_;
        return std::visit(
            [&kept](const auto& of) -> Evaluate {
                return [kept, f = evaluator(of)](auto wl, auto wv, auto to) { f(wl, wv, to); };
            },
            *content_);
    }
    const PreparedBrdf& prepared() const {
        std::call_once(*once_, [&] {
            const ProposeOptions options{.azimuths = isotropic() ? 1 : k_anisotropic_azimuths};
            *prepared_ = std::visit([&](const auto& of) { return prepare(of, options); }, *content_);
        });
        return **prepared_;
    }

    /// Of something of both sides.
    const PreparedBsdf& prepared_sides() const {
        std::call_once(*once_, [&] {
            const ProposeOptions options{.azimuths = isotropic() ? 1 : k_anisotropic_azimuths};
            *sides_ = std::visit([&](const auto& of) { return prepare_bsdf(of, options); }, *content_);
        });
        return **sides_;
    }

  private:
    std::shared_ptr<const AnyBrdf> content_;
    std::shared_ptr<std::once_flag> once_ = std::make_shared<std::once_flag>();
    std::shared_ptr<std::optional<PreparedBrdf>> prepared_ = std::make_shared<std::optional<PreparedBrdf>>();
    std::shared_ptr<std::optional<PreparedBsdf>> sides_ = std::make_shared<std::optional<PreparedBsdf>>();
};

Array values_of(const Held& brdf, const Array& wl, const Array& wv) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    Array f({py::ssize_t(rows(wl)), py::ssize_t(3)});
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const auto to = changing<Rgb>(f);
    const Evaluate of = brdf.evaluate();
    in_parts(l.size(), [&](std::size_t first, std::size_t count) {
        of(l.subspan(first, count), v.subspan(first, count), to.subspan(first, count));
    });
    return f;
}

Array channels_of(const Held& brdf, const Array& wl, const Array& wv) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    const Channels of = brdf.model()                            ? channels(*brdf.model())
                        : wavelengths(*brdf.measured()).empty() ? rgb_channels(brdf.evaluate())
                                                                : spectra(*brdf.measured());
    const std::size_t count_of = of.count();
    Array f({py::ssize_t(rows(wl)), py::ssize_t(count_of)});
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const std::span<float> to(f.mutable_data(), l.size() * count_of);
    in_parts(l.size(), [&](std::size_t first, std::size_t count) {
        of.evaluate(l.subspan(first, count), v.subspan(first, count), to.subspan(first * count_of, count * count_of));
    });
    return f;
}

/// Calls use(prepared), with what the BRDF or BSDF is sampled by, made without the interpreter's lock.
template <typename Use> void with_prepared(const Held& brdf, const Use& use) {
    const auto made = [&](auto get) -> const auto& {
        const py::gil_scoped_release released;
        return (brdf.*get)();
    };
    if (is_two_sided(brdf.content()))
        use(made(&Held::prepared_sides));
    else
        use(made(&Held::prepared));
}

bool is_beam(const LightSample&) { return false; }
bool is_beam(const BsdfSample& drawn) { return drawn.is_beam; }

/// Directions, weights and densities.
py::tuple sampled(const Held& brdf, const Array& wv, const Array& u) {
    require_unit(wv, "wv");
    const auto n = py::ssize_t(rows(wv));
    Array wl({n, py::ssize_t(3)}), weight({n, py::ssize_t(3)}), density(n);
    const auto v = span_of<Vec3f>(wv), uniform = span_of<Vec3f>(u);
    const auto wl_to = changing<Vec3f>(wl);
    const auto weight_to = changing<Rgb>(weight);
    const auto density_to = changing<float>(density);
    with_prepared(brdf, [&](const auto& prepared) {
        in_parts(v.size(), [&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i) {
                const Vec3f& at = uniform[i];
                const auto drawn = sample(prepared, v[i], {at.x, at.y}, at.z);
                const bool has_direction = is_beam(drawn) || drawn.pdf > 0;
                wl_to[i] = has_direction ? drawn.wl : Vec3f(0, 0, -1), weight_to[i] = drawn.weight;
                density_to[i] = is_beam(drawn) ? std::numeric_limits<float>::infinity() : drawn.pdf;
            }
        });
    });
    return py::make_tuple(wl, weight, density);
}

Array density(const Held& brdf, const Array& wl, const Array& wv) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    Array densities{py::ssize_t(rows(wl))};
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const auto to = changing<float>(densities);
    with_prepared(brdf, [&](const auto& prepared) {
        in_parts(l.size(), [&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i) to[i] = pdf(prepared, l[i], v[i]);
        });
    });
    return densities;
}

Array reflected(const Held& brdf, const Array& cosine) {
    Array albedos({py::ssize_t(rows(cosine)), py::ssize_t(3)});
    const auto at = span_of<float>(cosine);
    const auto to = changing<Rgb>(albedos);
    in_parts(at.size(), [&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) to[i] = albedo(brdf.prepared(), at[i]);
    });
    return albedos;
}

py::dict parameters(const Held& brdf) {
    using Shape = std::vector<py::ssize_t>;
    py::dict of;
    const auto add = [&](const char* name, std::span<const float> numbers, Shape shape) {
        of[name] = array_of(numbers, std::move(shape));
    };
    const auto& model = brdf.require_model().model;
    if (const auto* bsdf = std::get_if<BsdfModel>(&model)) {
        for (std::size_t p = 0; p < k_parts; ++p)
            if (bsdf->part[p]) of[py::str(std::string(k_part_names[p]))] = parameters(Held(*bsdf->part[p]));
        for (std::size_t b = 0; b < bsdf->beam.size(); ++b) {
            const Beam& beam = bsdf->beam[b];
            if (beam.empty()) continue;
            const std::string beam_name = "beam_" + std::string(k_beam_names[b]);
            const auto n = py::ssize_t(beam.theta.size());
            add((beam_name + "_angle").c_str(), beam.theta, {n});
            add((beam_name + "_share").c_str(), floats(beam.share), {n, 3});
        }
    } else if (const auto* pm = std::get_if<PmModel>(&model)) {
        const py::ssize_t J = pm->lobes, N = pm->variates, F = features(pm->form);
        of["form"] = std::string(name(pm->form));
        of["axial"] = pm->axial;
        add("coefficient", floats(pm->coefficient), {J, 3});
        add("log_scale", pm->log_scale, {J});
        add("centre", floats(pm->centre), {J, N, 3});
        add("bandwidth", pm->bandwidth, {J, N});
        add("parameterization", floats(pm->parameterization), {N, 2});
        add("exponent", pm->exponent, {J, F});
        if (!pm->wavelength.empty()) {
            add("wavelength", pm->wavelength, {py::ssize_t(pm->wavelength.size())});
            add("spectrum", pm->spectrum, {J, py::ssize_t(pm->wavelength.size())});
        }
    } else if (const auto* su = std::get_if<SuModel>(&model)) {
        const py::ssize_t J = su->lobes, n = py::ssize_t(su->direction.size());
        of["interpolation"] = std::string(name(su->interpolation));
        of["discretise"] = std::string(name(su->discretise));
        add("direction", floats(su->direction), {n, 3});
        add("coefficient", floats(su->coefficient), {n, J, 3});
        add("centre", floats(su->centre), {n, J, 3});
        add("bandwidth", su->bandwidth, {n, J});
        if (!su->shape.empty()) add("shape", su->shape, {n, J});
    } else if (const auto* ggx = std::get_if<GgxModel>(&model)) {
        std::vector<float> roughness, f0, f90;
        for (const GgxModel::Lobe& lobe : ggx->lobes) {
            roughness.push_back(lobe.roughness), f90.push_back(lobe.f90);
            f0.insert(f0.end(), {lobe.f0.r, lobe.f0.g, lobe.f0.b});
        }
        const auto L = py::ssize_t(ggx->lobes.size());
        add("diffuse", floats(std::vector{ggx->diffuse}), {3});
        add("roughness", roughness, {L});
        add("f0", f0, {L, 3});
        add("f90", f90, {L});
    }
    return of;
}

// ---- Fits --------------------------------------------------------------------------------------------------------

/// Runs work(token) on a thread of its own, so that signals (Ctrl-C) and `progress(stage, fraction)` are served here
/// meanwhile. A callback that returns False cancels, as does an exception, which is raised again.
template <typename Work> auto in_background(const py::object& progress, const Work& work) {
    std::mutex mutex;
    std::condition_variable changed;
    std::string stage;
    double fraction = 0;
    bool done = false;
    const ProgressToken token([&](const Progress& now) {
        const std::lock_guard lock(mutex);
        stage = now.stage, fraction = now.fraction;
        return true;
    });
    std::optional<decltype(work(token))> result;
    std::exception_ptr failure, raised;
    std::thread worker([&] {
        try {
            result.emplace(work(token));
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(mutex);
        done = true;
        changed.notify_all();
    });
    {
        const py::gil_scoped_release released;
        std::unique_lock lock(mutex);
        double told = -1;
        while (!changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; })) {
            if (raised) continue;
            const std::string now = stage;
            const double at = fraction;
            lock.unlock();
            {
                const py::gil_scoped_acquire acquired;
                try {
                    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
                    if (!progress.is_none() && at > told && progress(now, at).is(py::bool_(false))) token.cancel();
                    told = at;
                } catch (...) {
                    raised = std::current_exception();
                    token.cancel();
                }
            }
            lock.lock();
        }
    }
    {
        const py::gil_scoped_release released;
        worker.join();
    }
    if (raised) std::rethrow_exception(raised);
    if (failure) std::rethrow_exception(failure);
    return *std::move(result);
}

struct Request {
    std::string model = "pm", form, objective, channels = "rgb";
    std::optional<int> lobes, variates;
    bool automatic = false, reciprocal = false;
    std::optional<bool> axial;
    std::optional<std::size_t> budget;
    std::optional<double> target_error, target_delta_e, max_theta;
    std::uint64_t seed = 0;
    int threads = 0;

    FitRequest fit_request() const {
        FitRequest request;
        if (model == "pm") {
            PmRequest pm;
            const auto named = form_named(form);
            if (!form.empty() && !named) throw py::value_error("form: expected one of srbf.forms(), found " + form);
            if (named) pm.form = *named;
            if (variates) pm.variates = *variates;
            if (lobes) pm.size = LobeCount{*lobes};
            if (automatic) pm.size = AutomaticLobes{};
            if (budget) pm.size = ByteBudget{*budget};
            if (target_error) pm.size = TargetError{*target_error};
            if (target_delta_e) pm.size = TargetDeltaE{*target_delta_e};
            pm.axial = axial, pm.reciprocal = reciprocal;
            request.model = pm;
        } else if (model == "su") {
            SuRequest su;
            if (lobes) su.lobes = *lobes;
            request.model = su;
        } else if (model == "ggx") {
            request.model = GgxRequest{lobes.value_or(GgxRequest{}.lobes)};
        } else {
            throw py::value_error("model: expected pm, su or ggx, found " + model);
        }
        if (!objective.empty()) {
            const auto named = objective_named(objective);
            if (!named) throw py::value_error("objective: expected one of srbf.objectives(), found " + objective);
            request.objective = *named;
        }
        if (max_theta) request.max_theta = *max_theta * k_degree;
        request.spectral = channels == "spectral";
        request.seed = seed, request.threads = threads;
        return request;
    }
};

py::dict measures_of(const Comparison& of) {
    py::dict errors;
    for (const MeasureName& measure : k_measures) {
        errors[measure.name] = of.matrix.*measure.member;
        errors[("heldout_" + std::string(measure.name)).c_str()] = of.heldout.*measure.member;
    }
    errors["albedo_error"] = of.albedo_error;
    if (of.appearance.lighting.empty()) return errors;
    for (const PictureErrorName& error : k_picture_errors) errors[error.name] = of.appearance.mean.*error.member;
    errors["worst_delta_e_itp"] = of.appearance.worst_delta_e;
    py::dict lightings;
    for (std::size_t i = 0; i < of.appearance.lighting.size(); ++i) {
        py::dict lighting;
        for (const PictureErrorName& error : k_picture_errors)
            lighting[error.name] = of.appearance.lighting[i].*error.member;
        lightings[py::str(std::string(standard_lightings()[i].name))] = lighting;
    }
    errors["lightings"] = lightings;
    return errors;
}

py::dict outcome_of(FitOutcome outcome) {
    py::dict of;
    of["errors"] = outcome.errors ? py::object(measures_of(*outcome.errors)) : py::none();
    of["seconds"] = outcome.fit_seconds;
    of["reached"] = outcome.reached;
    of["stop_reason"] = outcome.stop ? py::object(py::str(std::string(name(*outcome.stop)))) : py::none();
    of["model"] = Held(std::move(outcome.model));
    return of;
}

py::dict fit_brdf(const Held& brdf, const Request& asked, const py::object& progress) {
    if (!brdf.measured()) raise({"srbf.fit", {}, "input", "a measurement", "a model", ErrorCode::wrong_kind});
    const FitRequest request = asked.fit_request();
    if (is_two_sided(brdf.content())) {
        BsdfOutcome outcome = required(in_background(
            progress, [&](const ProgressToken& token) { return fit_bsdf(*brdf.measured(), request, token); }));
        outcome.model.provenance["source"] = brdf.measured()->source;
        py::dict of, errors;
        for (const PartFit& part : outcome.parts)
            errors[py::str(std::string(name(part.part)))] = part.squared_error_ratio;
        of["errors"] = errors;
        of["seconds"] = outcome.fit_seconds;
        of["reached"] = true;
        of["stop_reason"] = py::none();
        of["model"] = Held(std::move(outcome.model));
        return of;
    }
    FitOutcome outcome = required(
        in_background(progress, [&](const ProgressToken& token) { return fit(*brdf.measured(), request, token); }));
    outcome.model.provenance["source"] = brdf.measured()->source;
    return outcome_of(std::move(outcome));
}

/// `function(wl, wv)` returns f_r of n pairs as an array that broadcasts to [n, 3].
py::dict fit_function(const py::function& function, const Request& asked, const py::object& progress) {
    const FitRequest request = asked.fit_request();
    std::exception_ptr raised;
    const auto run = [&](const ProgressToken& token) {
        return fit(
            [&](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
                const py::gil_scoped_acquire acquired;
                std::ranges::fill(f, Rgb{});
                if (raised) return;
                try {
                    const auto n = py::ssize_t(wl.size());
                    const auto array = [n](std::span<const Vec3f> w) {
                        return array_of({&w[0].x, 3 * w.size()}, {n, 3});
                    };
                    const py::module_ numpy = py::module_::import("numpy");
                    const py::object values =
                        numpy.attr("broadcast_to")(function(array(wl), array(wv)), py::make_tuple(n, 3));
                    const auto numbers = py::array_t<float, py::array::c_style | py::array::forcecast>(values);
                    std::memcpy(f.data(), numbers.data(), f.size() * sizeof(Rgb));
                } catch (...) {
                    raised = std::current_exception();
                    token.cancel();
                }
            },
            request, token);
    };
    Result<FitOutcome> outcome = in_background(progress, run);
    if (raised) std::rethrow_exception(raised);
    return outcome_of(required(std::move(outcome)));
}

Measured samples_of(const Array& wl, const Array& wv, const Array& f, bool isotropic) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    ScatteredSamples samples;
    samples.isotropic = isotropic;
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const auto values = span_of<Rgb>(f);
    for (std::size_t i = 0; i < l.size(); ++i) {
        if (!is_finite(values[i]) || !above_horizon(l[i], v[i])) {
            ++samples.masked;
            continue;
        }
        samples.wl.push_back(l[i]), samples.wv.push_back(v[i]), samples.colour.push_back(values[i]);
    }
    if (samples.wl.empty()) raise({"arrays", {}, "samples", "some above the horizon", "none", ErrorCode::no_data});
    make_index(samples);
    const std::uint64_t bytes = 36 * std::uint64_t(l.size());
    return {"arrays", "arrays", bytes, std::move(samples)};
}

py::list fit_texels(const Array& wl, const Array& wv, const Array& f, const Request& asked, bool isotropic,
                    const py::object& progress) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const SharedPairs pairs{{l.begin(), l.end()}, {v.begin(), v.end()}, isotropic};
    const std::span<const Rgb> values(reinterpret_cast<const Rgb*>(f.data()), std::size_t(f.size()) / 3);
    BatchOptions options;
    options.request = asked.fit_request();
    const auto start = std::chrono::steady_clock::now();
    auto fits = required(
        in_background(progress, [&](const ProgressToken& token) { return fit_batch(pairs, values, options, token); }));
    const std::chrono::duration<double> all = std::chrono::steady_clock::now() - start;
    py::list outcomes;
    for (TexelFit& fit : fits) {
        py::dict of, errors;
        const bool fitted = fit.state == TexelState::fitted;
        for (const MeasureName& measure : k_measures) errors[measure.name] = fit.errors.*measure.member;
        of["errors"] = fitted ? py::object(errors) : py::none();
        of["seconds"] = all.count() / double(fits.size());
        of["reached"] = fitted;
        of["stop_reason"] = fitted ? py::object(py::str(std::string(name(fit.stop)))) : py::none();
        of["model"] = Held(Model{std::move(fit.model), {{"objective", std::string(name(options.request.objective))}}});
        outcomes.append(of);
    }
    return outcomes;
}

py::list load_stack(const std::string& path) {
    const auto stack = required(read_stack(required(read_file(path)), path));
    py::list texels;
    for (std::size_t i = 0; i < stack.models.size(); ++i)
        texels.append(py::make_tuple(Held(Model{stack.models[i], stack.provenance}), stack.error[i], stack.state[i]));
    return texels;
}

// ---- The rest ----------------------------------------------------------------------------------------------------

py::dict errors(const Held& reference, const Held& other, double max_theta, int threads) {
    const double theta = max_theta * k_degree;
    const Evaluate a = reference.evaluate(), others[] = {other.evaluate()};
    const std::vector<Vec3f> directions =
        other.model() ? matrix_directions(*other.model(), theta) : fibonacci_directions(k_matrix_directions, theta);
    return measures_of(in_background(py::none(), [&](const ProgressToken& token) {
        return compare(a, others, {theta, threads, token}, directions);
    })[0]);
}

Array render(const Held& brdf, const std::string& lighting, int size) {
    const auto all = standard_lightings();
    const auto found = std::ranges::find(all, std::string_view(lighting), &Lighting::name);
    if (found == all.end()) throw py::value_error("lighting: expected one of srbf.lightings(), found " + lighting);
    if (size < 1 || size > 4096) throw py::value_error("size: expected 1 to 4096");
    const Evaluate of[] = {brdf.evaluate()};
    const auto pictures = in_background(py::none(), [&](const ProgressToken& token) {
        return sphere_pictures(of, std::span(&*found, 1), size, 0, token);
    });
    return array_of(floats(pictures[0][0].pixels), {size, size, 3});
}

void convert(const Held& brdf, const std::string& path, bool spectra, int threads) {
    const TableFormatRow* row = table_format(path);
    if (!row) throw py::value_error("path: expected a name that ends in .binary, .bsdf, .mbsdf or .csv, found " + path);
    const auto bytes = required(in_background(py::none(), [&](const ProgressToken&) {
        return table_file(brdf.content(), row->format, {.spectra = spectra, .threads = threads});
    }));
    required(write_file(path, bytes));
}

/// The names of a table's rows.
template <typename Rows> std::vector<std::string> names_of(const Rows& rows) {
    std::vector<std::string> names;
    for (const auto& row : rows) names.emplace_back(row.name);
    return names;
}

std::string code(const std::vector<Held>& models, const std::vector<std::string>& names, const std::string& to,
                 const std::string& prefix, bool sampling, bool albedo) {
    std::vector<NamedModel> named;
    for (std::size_t i = 0; i < models.size(); ++i) named.push_back({identifier(names[i]), &models[i].require_model()});
    if (to == "three") return required(three_module(named, prefix));
    for (const auto& [language, name] : k_code_languages)
        if (to == name)
            return required(
                shading_code(named, prefix, {.language = language, .sampling = sampling, .albedo = albedo}));
    throw py::value_error("to: expected three or one of srbf.code_languages(), found " + to);
}

Held loaded(const std::string& path) {
    const py::gil_scoped_release released;
    Result<AnyBrdf> brdf = load_brdf(path);
    if (brdf) return Held(*std::move(brdf));
    const py::gil_scoped_acquire acquired;
    raise(brdf.error());
}

}  // namespace
}  // namespace srbf

PYBIND11_MODULE(_srbf, module) {
    using namespace srbf;
    py::class_<Held>(module, "Brdf")
        .def("evaluate", &values_of)
        .def("evaluate_channels", &channels_of)
        .def("sample", &sampled)
        .def("density", &density)
        .def("reflected", &reflected)
        .def("parameters", &parameters)
        .def("is_model", [](const Held& brdf) { return brdf.model() != nullptr; })
        .def("isotropic", &Held::isotropic)
        .def("wavelengths",
             [](const Held& brdf) {
                 const auto of = brdf.model() ? wavelengths(*brdf.model()) : wavelengths(*brdf.measured());
                 return array_of(of, {py::ssize_t(of.size())});
             })
        .def("exchanged",
             [](const Held& brdf) {
                 AnyBrdf content = brdf.content();
                 std::visit([](auto& of) { exchange(of); }, content);
                 return Held(std::move(content));
             })
        .def("kind",
             [](const Held& brdf) {
                 constexpr std::array<const char*, 4> names{"pm", "su", "ggx", "bsdf"};
                 return brdf.model() ? std::string(names[brdf.model()->model.index()]) : brdf.measured()->format;
             })
        .def("nbytes",
             [](const Held& brdf) { return brdf.model() ? payload_bytes(*brdf.model()) : brdf.measured()->bytes; })
        .def("source", [](const Held& brdf) { return brdf.measured() ? brdf.measured()->source : std::string(); })
        .def("provenance",
             [](const Held& brdf) {
                 return brdf.model() ? brdf.model()->provenance : std::map<std::string, std::string>{};
             })
        .def("save",
             [](const Held& brdf, const std::string& path) { required(save_model(brdf.require_model(), path)); })
        .def("to_bytes", [](const Held& brdf) {
            const auto bytes = write_model(brdf.require_model());
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        });
    py::class_<Request>(module, "Request")
        .def(py::init())
        .def_readwrite("model", &Request::model)
        .def_readwrite("form", &Request::form)
        .def_readwrite("objective", &Request::objective)
        .def_readwrite("channels", &Request::channels)
        .def_readwrite("lobes", &Request::lobes)
        .def_readwrite("variates", &Request::variates)
        .def_readwrite("automatic", &Request::automatic)
        .def_readwrite("reciprocal", &Request::reciprocal)
        .def_readwrite("axial", &Request::axial)
        .def_readwrite("budget", &Request::budget)
        .def_readwrite("target_error", &Request::target_error)
        .def_readwrite("target_delta_e", &Request::target_delta_e)
        .def_readwrite("max_theta", &Request::max_theta)
        .def_readwrite("seed", &Request::seed)
        .def_readwrite("threads", &Request::threads);
    module.def("load", &loaded);
    module.def("from_bytes", [](const py::bytes& bytes) {
        const std::string text = bytes;
        return Held(required(read_model(as_bytes(text), "bytes")));
    });
    module.def("from_arrays", [](const Array& wl, const Array& wv, const Array& f, bool isotropic) {
        return Held(samples_of(wl, wv, f, isotropic));
    });
    module.def("fit", &fit_brdf);
    module.def("fit_function", &fit_function);
    module.def("fit_batch", &fit_texels);
    module.def("load_stack", &load_stack);
    module.def("errors", &errors);
    module.def("render", &render);
    module.def("convert", &convert);
    module.def("code", &code);
    module.def("python_code", [](const Held& brdf) { return required(python_code(brdf.require_model())); });
    module.def("identifier", [](const std::string& text) { return identifier(text); });
    module.def("lightings", [] { return names_of(standard_lightings()); });
    module.def("forms", [] { return names_of(k_form_rows); });
    module.def("code_languages", [] { return names_of(k_code_languages); });
    module.def("objectives", [] {
        std::vector<std::string> names;
        for (const Objective objective : objectives()) names.emplace_back(name(objective));
        return names;
    });
    module.attr("version") = SRBF_VERSION;
    module.attr("knows_numpy_2") = PYBIND11_VERSION_HEX >= 0x020C0000;
}
