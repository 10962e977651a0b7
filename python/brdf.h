// A BRDF, or BSDF, as Python holds it: what srbf.Brdf calls, and where one comes from.
#pragma once
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>

#include "arrays.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/prepared_bsdf.h"

namespace srbf {

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

inline Array values_of(const Held& brdf, const Array& wl, const Array& wv) {
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

inline Array channels_of(const Held& brdf, const Array& wl, const Array& wv) {
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

inline bool is_beam(const LightSample&) { return false; }
inline bool is_beam(const BsdfSample& drawn) { return drawn.is_beam; }

/// Directions, weights and densities.
inline py::tuple sampled(const Held& brdf, const Array& wv, const Array& u) {
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

inline Array density(const Held& brdf, const Array& wl, const Array& wv) {
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

inline Array reflected(const Held& brdf, const Array& cosine) {
    Array albedos({py::ssize_t(rows(cosine)), py::ssize_t(3)});
    const auto at = span_of<float>(cosine);
    const auto to = changing<Rgb>(albedos);
    in_parts(at.size(), [&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) to[i] = albedo(brdf.prepared(), at[i]);
    });
    return albedos;
}

inline py::dict parameters(const Held& brdf) {
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

inline Measured samples_of(const Array& wl, const Array& wv, const Array& f, bool isotropic) {
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

inline py::list load_stack(const std::string& path) {
    const auto stack = required(read_stack(required(read_file(path)), path));
    py::list texels;
    for (std::size_t i = 0; i < stack.models.size(); ++i)
        texels.append(py::make_tuple(Held(Model{stack.models[i], stack.provenance}), stack.error[i], stack.state[i]));
    return texels;
}

inline Held loaded(const std::string& path) {
    const py::gil_scoped_release released;
    Result<AnyBrdf> brdf = load_brdf(path);
    if (brdf) return Held(*std::move(brdf));
    const py::gil_scoped_acquire acquired;
    raise(brdf.error());
}

}  // namespace srbf
