// The BRDF or BSDF that an srbf.Brdf of Python holds, with its functions.
#pragma once
#include <limits>
#include <memory>
#include <mutex>

#include "arrays.h"
#include "base/files.h"
#include "brdf/values.h"
#include "measured/readers.h"
#include "measured/tables.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/prepared_bsdf.h"

namespace srbf {

/// The bytes that a measurement was read from, for copies in other processes and for comparison.
struct Origin {
    std::string path;
    std::vector<std::byte> bytes;  ///< of the file; of arrays the rows of wl, wv and f
    ReadOptions options;
    std::optional<bool> isotropic = {};  ///< of arrays
};

/// A measurement or a model. What sampling needs is prepared at the first use.
class PyBrdf {
  public:
    explicit PyBrdf(Model model) : content_(std::make_shared<const AnyBrdf>(std::move(model))) {}
    PyBrdf(AnyBrdf content, std::shared_ptr<const Origin> origin, bool exchanged = false)
        : content_(std::make_shared<const AnyBrdf>(std::move(content))),
          origin_(std::move(origin)),
          exchanged_(exchanged) {}

    const AnyBrdf& content() const { return *content_; }
    const Model* model() const { return std::get_if<Model>(content_.get()); }
    const Measured* measured() const { return std::get_if<Measured>(content_.get()); }
    const Origin& origin() const { return *origin_; }  ///< of a measurement
    const Model& require_model() const {
        if (!model()) raise({"srbf", {}, "brdf", "a model", "a measurement", ErrorCode::wrong_kind});
        return *model();
    }
    /// True if light and viewer are exchanged, compared with the file or with the data of a model.
    bool is_exchanged() const { return model() ? model()->provenance.contains("exchanged") : exchanged_; }
    PyBrdf exchanged() const {
        AnyBrdf content = *content_;
        std::visit([](auto& brdf) { exchange(brdf); }, content);
        return {std::move(content), origin_, !exchanged_};
    }
    bool isotropic() const {
        return std::visit([](const auto& brdf) { return is_isotropic(brdf); }, *content_);
    }
    /// True if values are interpolated among samples, slices or patches: up to twelve times as slow as in a table.
    bool is_slow() const {
        if (!measured()) return false;
        const auto& table = measured()->table;
        return !std::holds_alternative<MerlTable>(table) && !std::holds_alternative<RglTable>(table) &&
               !std::holds_alternative<MbsdfTable>(table);
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
    Channels channels() const {
        if (model()) return srbf::channels(*model());
        return wavelengths(*measured()).empty() ? rgb_channels(evaluate()) : spectra(*measured());
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
    template <typename Prepared> struct AtFirstUse {
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
    std::shared_ptr<const Origin> origin_;
    bool exchanged_ = false;
    std::shared_ptr<AtFirstUse<PreparedBrdf>> front_ = std::make_shared<AtFirstUse<PreparedBrdf>>();
    std::shared_ptr<AtFirstUse<PreparedBsdf>> sides_ = std::make_shared<AtFirstUse<PreparedBsdf>>();
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
    const Channels channels = brdf.channels();
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

/// Calls use(prepared) with the BRDF or BSDF, which is prepared for sampling without the interpreter's lock.
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
                directions[i] = has_direction ? light.wl : Vec3f(0, 0, -1);
                weights[i] = light.weight;
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

/// The measurement of arrays, whose rows are in `origin`.
inline PyBrdf brdf_of_arrays(Origin origin) {
    const std::size_t n = origin.bytes.size() / (9 * sizeof(float));
    const auto* rows = reinterpret_cast<const Vec3f*>(origin.bytes.data());
    const auto* f = reinterpret_cast<const Rgb*>(rows + 2 * n);
    ScatteredSamples samples =
        valid_samples(std::span(rows, n), std::span(rows + n, n), std::span(f, n), *origin.isotropic);
    if (samples.wl.empty())
        raise({"arrays",
               {},
               "samples",
               "some above the horizon",
               samples.notes.empty() ? "none" : samples.notes[0],
               ErrorCode::no_data});
    const py::gil_scoped_release released;
    make_index(samples);
    return {Measured{origin.path, "arrays", origin.bytes.size(), std::move(samples)},
            std::make_shared<const Origin>(std::move(origin))};
}
inline PyBrdf brdf_of_samples(const Array& wl, const Array& wv, const Array& f, bool isotropic) {
    require_unit(wl, "wl");
    require_unit(wv, "wv");
    Origin origin{"arrays", {}, {}, isotropic};
    for (const Array* array : {&wl, &wv, &f}) {
        const auto bytes = std::as_bytes(std::span(array->data(), std::size_t(array->size())));
        origin.bytes.insert(origin.bytes.end(), bytes.begin(), bytes.end());
    }
    return brdf_of_arrays(std::move(origin));
}

inline Result<PyBrdf> brdf_of_file(Origin origin) {
    auto measured = read_measured(origin.bytes, origin.path, origin.options);
    if (!measured) return measured.error();
    return PyBrdf(*std::move(measured), std::make_shared<const Origin>(std::move(origin)));
}

inline py::bytes to_bytes(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
/// The file of a model, or what a measurement was read from.
inline py::bytes file_bytes(const PyBrdf& brdf, bool has_provenance) {
    if (!brdf.model()) return to_bytes(brdf.origin().bytes);
    return to_bytes(has_provenance ? write_model(*brdf.model()) : write_model({brdf.model()->model, {}}));
}
/// How the bytes of a measurement are read: path, columns, quantity, floor, and of arrays whether they are isotropic.
inline py::tuple reading(const PyBrdf& brdf) {
    if (brdf.model()) return py::tuple();
    const Origin& origin = brdf.origin();
    const auto stated = std::size_t(origin.options.quantity);
    return py::make_tuple(py::bytes(origin.path), origin.options.columns, stated == 0 ? "" : k_quantities[stated - 1],
                          origin.options.floor, origin.isotropic);
}
/// The inverse of `file_bytes` and `reading`.
inline PyBrdf unpickled(const std::string& bytes, const py::tuple& reading) {
    const auto content = std::as_bytes(std::span(bytes));
    if (reading.empty()) return PyBrdf(required(read_model(content, "pickled BRDF")));
    Origin origin{
        reading[0].cast<std::string>(),
        {content.begin(), content.end()},
        {reading[1].cast<std::string>(), quantity_named(reading[2].cast<std::string>()), reading[3].cast<float>()},
        reading[4].cast<std::optional<bool>>()};
    return origin.isotropic ? brdf_of_arrays(std::move(origin)) : required(brdf_of_file(std::move(origin)));
}

inline PyBrdf load_file(const std::string& path, const std::string& columns, const std::string& quantity, float floor) {
    const ReadOptions options{columns, quantity_named(quantity), floor};
    return required([&]() -> Result<PyBrdf> {
        const py::gil_scoped_release released;
        return within_memory(path, [&]() -> Result<PyBrdf> {
            auto bytes = read_input(path, options);
            if (bytes && !is_safetensors(*bytes)) return brdf_of_file({path, *std::move(bytes), options});
            auto model = load_brdf(path, options);
            if (!model) return model.error();
            return PyBrdf(std::get<Model>(*std::move(model)));
        });
    }());
}

}  // namespace srbf
