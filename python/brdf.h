// A BRDF, or BSDF, as Python holds it: what srbf.Brdf calls, and where one comes from.
#pragma once
#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>

#include "archive.h"
#include "arrays.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/prepared_bsdf.h"

namespace srbf {

/// A measurement or a model, with what sampling needs made when it is first asked for.
class Held {
  public:
    explicit Held(AnyBrdf content, bool exchanged = false)
        : content_(std::make_shared<const AnyBrdf>(std::move(content))), exchanged_(exchanged) {}

    const AnyBrdf& content() const { return *content_; }
    const Model* model() const { return std::get_if<Model>(content_.get()); }
    const Measured* measured() const { return std::get_if<Measured>(content_.get()); }
    const Model& require_model() const {
        if (!model()) raise({"srbf", {}, "brdf", "a model", "a measurement", ErrorCode::wrong_kind});
        return *model();
    }
    /// True if light and viewer are those of the file, or of the data of a model, exchanged.
    bool is_exchanged() const { return model() ? model()->provenance.contains("exchanged") : exchanged_; }
    Held exchanged() const {
        AnyBrdf content = *content_;
        std::visit([](auto& of) { exchange(of); }, content);
        return Held(std::move(content), !exchanged_);
    }
    bool isotropic() const {
        return std::visit([](const auto& of) { return is_isotropic(of); }, *content_);
    }
    /// True if each value is searched for among samples, slices or patches, which takes up to twelve times as long as
    /// from a table or a model.
    bool is_searched() const {
        if (!measured()) return false;
        const auto& table = measured()->table;
        return !std::holds_alternative<MerlTable>(table) && !std::holds_alternative<RglTable>(table) &&
               !std::holds_alternative<UtiaTable>(table) && !std::holds_alternative<MbsdfTable>(table);
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
        return front_->of(*this, [](const auto& of, const ProposeOptions& options) { return prepare(of, options); });
    }
    /// The part of something with front and back.
    const PreparedBsdf& prepared_sides() const {
        return sides_->of(*this,
                          [](const auto& of, const ProposeOptions& options) { return prepare_bsdf(of, options); });
    }

  private:
    /// The prepared BRDF, made when it is first asked for.
    template <typename Prepared> struct Once {
        std::once_flag flag;
        std::optional<Prepared> prepared;

        template <typename Prepare> const Prepared& of(const Held& held, const Prepare& prepare) {
            std::call_once(flag, [&] {
                const ProposeOptions options{.azimuths = held.isotropic() ? 1 : k_anisotropic_azimuths};
                prepared = std::visit([&](const auto& of) { return prepare(of, options); }, *held.content_);
            });
            return *prepared;
        }
    };

    std::shared_ptr<const AnyBrdf> content_;
    bool exchanged_;
    std::shared_ptr<Once<PreparedBrdf>> front_ = std::make_shared<Once<PreparedBrdf>>();
    std::shared_ptr<Once<PreparedBsdf>> sides_ = std::make_shared<Once<PreparedBsdf>>();
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

/// The value at one pair of directions and the density of `sample`: R, G, B, 1/sr.
inline std::array<float, 4> value_at(const Held& brdf, const Vec3f& wl, const Vec3f& wv) {
    const Rgb f = value(brdf.prepared(), wl, wv);
    return {f.r, f.g, f.b, pdf(brdf.prepared(), wl, wv)};
}
/// One draw: direction, weight, density.
inline std::array<float, 7> drawn_at(const Held& brdf, const Vec3f& wv, const Vec3f& u) {
    const LightSample drawn = sample(brdf.prepared(), wv, {u.x, u.y}, u.z);
    return {drawn.wl.x, drawn.wl.y, drawn.wl.z, drawn.weight.r, drawn.weight.g, drawn.weight.b, drawn.pdf};
}

/// The change by azimuth of samples that are said to be isotropic; otherwise 0.
inline double change_by_azimuth(const Held& brdf) {
    const auto* samples = brdf.measured() ? std::get_if<ScatteredSamples>(&brdf.measured()->table) : nullptr;
    if (!samples || !samples->isotropic) return 0;
    const py::gil_scoped_release released;
    return change_by_azimuth(*samples);
}

/// The samples that are finite and above the horizon, without an index.
inline ScatteredSamples samples_at(const Array& wl, const Array& wv, const Array& f, bool isotropic) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    ScatteredSamples samples;
    samples.isotropic = isotropic;
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const auto values = span_of<Rgb>(f);
    const py::gil_scoped_release released;
    for (std::size_t i = 0; i < l.size(); ++i) {
        if (!is_finite(values[i]) || !above_horizon(l[i], v[i])) {
            ++samples.masked;
            continue;
        }
        samples.wl.push_back(l[i]), samples.wv.push_back(v[i]), samples.colour.push_back(values[i]);
    }
    return samples;
}

inline Held samples_of(const Array& wl, const Array& wv, const Array& f, bool isotropic) {
    ScatteredSamples samples = samples_at(wl, wv, f, isotropic);
    if (samples.wl.empty()) raise({"arrays", {}, "samples", "some above the horizon", "none", ErrorCode::no_data});
    {
        const py::gil_scoped_release released;
        make_index(samples);
    }
    const std::uint64_t bytes = 36 * std::uint64_t(rows(wl));
    return Held(Measured{"arrays", "arrays", bytes, std::move(samples)});
}

inline py::bytes pickled(const Held& brdf) {
    ArchiveWriter writer;
    {
        const py::gil_scoped_release released;
        writer(brdf.content());
    }
    return writer.bytes;
}
inline Held unpickled(const py::bytes& bytes, bool exchanged) {
    const auto text = std::string_view(bytes);
    const py::gil_scoped_release released;
    return Held(ArchiveReader{text}.next<AnyBrdf>(), exchanged);
}
/// The members that determine the values: `pickled` without where they come from.
inline py::bytes numbers(const Held& brdf) {
    ArchiveWriter writer;
    {
        const py::gil_scoped_release released;
        if (brdf.model())
            writer(brdf.model()->model);
        else
            writer(brdf.measured()->exchanged), writer(brdf.measured()->table);
    }
    return writer.bytes;
}

inline py::list load_stack(const std::string& path) {
    const auto stack = required([&]() -> Result<ModelStack> {
        const py::gil_scoped_release released;
        const auto bytes = read_file(path, all_if(is_safetensors));
        if (!bytes) return bytes.error();
        return read_stack(*bytes, path);
    }());
    py::list texels;
    for (std::size_t i = 0; i < stack.models.size(); ++i)
        texels.append(py::make_tuple(Held(Model{stack.models[i], stack.provenance}), stack.error[i], stack.state[i]));
    return texels;
}

inline Held loaded(const std::string& path, const std::string& columns, const std::string& quantity, float floor) {
    const ReadOptions options{columns, quantity_named(quantity), floor};
    const py::gil_scoped_release released;
    Result<AnyBrdf> brdf = load_brdf(path, options);
    if (brdf) return Held(*std::move(brdf));
    const py::gil_scoped_acquire acquired;
    raise(brdf.error());
}

}  // namespace srbf
