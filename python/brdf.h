// The BRDF or BSDF that an srbf.Brdf of Python holds, with its functions.
#pragma once
#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>

#include "archive.h"
#include "arrays.h"
#include "base/files.h"
#include "brdf/channels.h"
#include "measured/readers.h"
#include "measured/tables.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/prepared_bsdf.h"

namespace srbf {

/// A measurement or a model. What sampling needs is prepared at the first use.
class PyBrdf {
  public:
    explicit PyBrdf(AnyBrdf content, bool exchanged = false)
        : content_(std::make_shared<const AnyBrdf>(std::move(content))), exchanged_(exchanged) {}

    const AnyBrdf& content() const { return *content_; }
    const Model* model() const { return std::get_if<Model>(content_.get()); }
    const Measured* measured() const { return std::get_if<Measured>(content_.get()); }
    const Model& require_model() const {
        if (!model()) raise({"srbf", {}, "brdf", "a model", "a measurement", ErrorCode::wrong_kind});
        return *model();
    }
    /// True if light and viewer are exchanged, compared with the file or with the data of a model.
    bool is_exchanged() const { return model() ? model()->provenance.contains("exchanged") : exchanged_; }
    PyBrdf exchanged() const {
        AnyBrdf content = *content_;
        std::visit([](auto& brdf) { exchange(brdf); }, content);
        return PyBrdf(std::move(content), !exchanged_);
    }
    bool isotropic() const {
        return std::visit([](const auto& brdf) { return is_isotropic(brdf); }, *content_);
    }
    /// True if each value is interpolated among samples, slices or patches, which takes up to twelve times as long
    /// as a lookup in a table or an evaluation of a model.
    bool is_slow() const {
        if (!measured()) return false;
        const auto& table = measured()->table;
        return !std::holds_alternative<MerlTable>(table) && !std::holds_alternative<RglTable>(table) &&
               !std::holds_alternative<UtiaTable>(table) && !std::holds_alternative<MbsdfTable>(table);
    }
    /// Evaluates the BRDF. The result shares the content.
    Evaluate evaluate() const {
        const auto shared = content_;
        return std::visit(
            [&shared](const auto& brdf) -> Evaluate {
                return [shared, evaluate = evaluator(brdf)](auto wl, auto wv, auto f) { evaluate(wl, wv, f); };
            },
            *content_);
    }
    const PreparedBrdf& prepared() const {
        return front_->get(*this,
                           [](const auto& brdf, const ProposeOptions& options) { return prepare(brdf, options); });
    }
    /// A BSDF arranged for evaluation and sampling of single pairs.
    const PreparedBsdf& prepared_sides() const {
        return sides_->get(*this,
                           [](const auto& brdf, const ProposeOptions& options) { return prepare_bsdf(brdf, options); });
    }

  private:
    /// A prepared BRDF, made at the first use.
    template <typename Prepared> struct Once {
        std::once_flag flag;
        std::optional<Prepared> prepared;

        template <typename Prepare> const Prepared& get(const PyBrdf& brdf, const Prepare& prepare) {
            std::call_once(flag, [&] {
                const ProposeOptions options{.azimuths = azimuths_for(brdf.isotropic())};
                prepared = std::visit([&](const auto& content) { return prepare(content, options); }, *brdf.content_);
            });
            return *prepared;
        }
    };

    std::shared_ptr<const AnyBrdf> content_;
    bool exchanged_;
    std::shared_ptr<Once<PreparedBrdf>> front_ = std::make_shared<Once<PreparedBrdf>>();
    std::shared_ptr<Once<PreparedBsdf>> sides_ = std::make_shared<Once<PreparedBsdf>>();
};

inline Array values_of(const PyBrdf& brdf, const Array& wl, const Array& wv) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    Array f({py::ssize_t(rows(wl)), py::ssize_t(3)});
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const auto values = mutable_span_of<Rgb>(f);
    const Evaluate evaluate = brdf.evaluate();
    for_parts(l.size(), [&](std::size_t first, std::size_t count) {
        evaluate(l.subspan(first, count), v.subspan(first, count), values.subspan(first, count));
    });
    return f;
}

inline Array channels_of(const PyBrdf& brdf, const Array& wl, const Array& wv) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    const Channels channels = brdf.model()                            ? srbf::channels(*brdf.model())
                              : wavelengths(*brdf.measured()).empty() ? rgb_channels(brdf.evaluate())
                                                                      : spectra(*brdf.measured());
    const std::size_t channel_count = channels.count();
    Array f({py::ssize_t(rows(wl)), py::ssize_t(channel_count)});
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const std::span<float> values(f.mutable_data(), l.size() * channel_count);
    for_parts(l.size(), [&](std::size_t first, std::size_t count) {
        channels.evaluate(l.subspan(first, count), v.subspan(first, count),
                          values.subspan(first * channel_count, count * channel_count));
    });
    return f;
}

/// Calls use(prepared) with the BRDF or BSDF prepared for sampling. The preparation does not hold the interpreter's
/// lock.
template <typename Use> void with_prepared(const PyBrdf& brdf, const Use& use) {
    const auto prepared = [&](auto get) -> const auto& {
        const py::gil_scoped_release released;
        return (brdf.*get)();
    };
    if (is_two_sided(brdf.content()))
        use(prepared(&PyBrdf::prepared_sides));
    else
        use(prepared(&PyBrdf::prepared));
}

inline bool is_beam(const LightSample&) { return false; }
inline bool is_beam(const BsdfSample& sample) { return sample.is_beam; }

/// Samples the light: directions, weights and densities.
inline py::tuple sample_rows(const PyBrdf& brdf, const Array& wv, const Array& u) {
    require_unit(wv, "wv");
    const auto n = py::ssize_t(rows(wv));
    Array wl({n, py::ssize_t(3)}), weight({n, py::ssize_t(3)}), density(n);
    const auto v = span_of<Vec3f>(wv), uniform = span_of<Vec3f>(u);
    const auto directions = mutable_span_of<Vec3f>(wl);
    const auto weights = mutable_span_of<Rgb>(weight);
    const auto densities = mutable_span_of<float>(density);
    with_prepared(brdf, [&](const auto& prepared) {
        for_parts(v.size(), [&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i) {
                const Vec3f& numbers = uniform[i];
                const auto light = sample(prepared, v[i], {numbers.x, numbers.y}, numbers.z);
                const bool has_direction = is_beam(light) || light.pdf > 0;
                directions[i] = has_direction ? light.wl : Vec3f(0, 0, -1), weights[i] = light.weight;
                densities[i] = is_beam(light) ? std::numeric_limits<float>::infinity() : light.pdf;
            }
        });
    });
    return py::make_tuple(wl, weight, density);
}

inline Array pdf_rows(const PyBrdf& brdf, const Array& wl, const Array& wv) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    Array densities{py::ssize_t(rows(wl))};
    const auto l = span_of<Vec3f>(wl), v = span_of<Vec3f>(wv);
    const auto values = mutable_span_of<float>(densities);
    with_prepared(brdf, [&](const auto& prepared) {
        for_parts(l.size(), [&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i) values[i] = pdf(prepared, l[i], v[i]);
        });
    });
    return densities;
}

inline Array albedo_rows(const PyBrdf& brdf, const Array& cosine) {
    Array albedos({py::ssize_t(rows(cosine)), py::ssize_t(3)});
    const auto cosines = span_of<float>(cosine);
    const auto values = mutable_span_of<Rgb>(albedos);
    for_parts(cosines.size(), [&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) values[i] = albedo(brdf.prepared(), cosines[i]);
    });
    return albedos;
}

/// The value at one pair of directions and the density of `sample` there: R, G, B, pdf [1/sr].
inline std::array<float, 4> value_at(const PyBrdf& brdf, const Vec3f& wl, const Vec3f& wv) {
    const ValuePdf both = value_pdf(brdf.prepared(), wl, wv);
    return {both.value.r, both.value.g, both.value.b, both.pdf};
}
/// One sample: direction, weight, pdf.
inline std::array<float, 7> sample_at(const PyBrdf& brdf, const Vec3f& wv, const Vec3f& u) {
    const LightSample light = sample(brdf.prepared(), wv, {u.x, u.y}, u.z);
    return {light.wl.x, light.wl.y, light.wl.z, light.weight.r, light.weight.g, light.weight.b, light.pdf};
}

/// The variation with azimuth of samples that are declared isotropic; otherwise 0.
inline double change_by_azimuth(const PyBrdf& brdf) {
    const auto* samples = brdf.measured() ? std::get_if<ScatteredSamples>(&brdf.measured()->table) : nullptr;
    if (!samples || !samples->isotropic) return 0;
    const py::gil_scoped_release released;
    return change_by_azimuth(*samples);
}

/// The samples that are finite and above the horizon, without an index for lookups.
inline ScatteredSamples valid_samples(const Array& wl, const Array& wv, const Array& f, bool isotropic) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    const py::gil_scoped_release released;
    return valid_samples(span_of<Vec3f>(wl), span_of<Vec3f>(wv), span_of<Rgb>(f), isotropic);
}

inline PyBrdf brdf_of_samples(const Array& wl, const Array& wv, const Array& f, bool isotropic) {
    ScatteredSamples samples = valid_samples(wl, wv, f, isotropic);
    if (samples.wl.empty())
        raise({"arrays",
               {},
               "samples",
               "some above the horizon",
               samples.notes.empty() ? "none" : samples.notes[0],
               ErrorCode::no_data});
    {
        const py::gil_scoped_release released;
        make_index(samples);
    }
    const std::uint64_t bytes = 36 * std::uint64_t(rows(wl));
    return PyBrdf(Measured{"arrays", "arrays", bytes, std::move(samples)});
}

inline py::bytes pickled(const PyBrdf& brdf) {
    ArchiveWriter writer;
    {
        const py::gil_scoped_release released;
        writer(brdf.content());
    }
    return writer.bytes;
}
inline PyBrdf unpickled(const py::bytes& bytes, bool exchanged) {
    const auto text = std::string_view(bytes);
    const py::gil_scoped_release released;
    return PyBrdf(ArchiveReader{text}.next<AnyBrdf>(), exchanged);
}
/// The members that determine the values: `pickled` without source and provenance.
inline py::bytes numbers(const PyBrdf& brdf) {
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

inline PyBrdf load_file(const std::string& path, const std::string& columns, const std::string& quantity, float floor) {
    const ReadOptions options{columns, quantity_named(quantity), floor};
    const py::gil_scoped_release released;
    Result<AnyBrdf> brdf = load_brdf(path, options);
    if (brdf) return PyBrdf(*std::move(brdf));
    const py::gil_scoped_acquire acquired;
    raise(brdf.error());
}

}  // namespace srbf
