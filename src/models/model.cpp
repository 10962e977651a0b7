#include "srbf/model.h"

#include <type_traits>

#include "base/errors.h"
#include "base/files.h"
#include "base/floating_point.h"
#include "base/half.h"
#include "brdf/values.h"
#include "generated/models/kinds.h"
#include "models/model_files.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

Safetensors content_of(const Model& model);
Result<Model> model_of(Safetensors content, bool is_part, const std::string& file_name);

/// The name of a surface of OpenPBR in earlier files.
constexpr std::string_view k_former_openpbr = "pbr";

template <typename M> using KindOf = Kind<std::remove_cvref_t<M>>;

double largest_number(const Model& model) {
    return std::visit([](const auto& brdf) { return KindOf<decltype(brdf)>::largest(brdf); }, model.model);
}

/// A model's tensors and metadata, without the version.
Safetensors content_of(const Model& model) {
    return std::visit(
        [&](const auto& brdf) {
            Safetensors content = KindOf<decltype(brdf)>::content(brdf);
            content.metadata["model"] = KindOf<decltype(brdf)>::name;
            content.metadata.insert(model.provenance.begin(), model.provenance.end());
            return content;
        },
        model.model);
}

/// Returns an error if storing changes a number by more than half: it is too large or too small for 16-bit floats.
std::optional<Error> lost_number(const Parameters& given, const Parameters& stored) {
    for (std::size_t i = 0; i < given.size(); ++i) {
        const auto *from = std::get_if<NumberArray>(&given[i].value), *to = std::get_if<NumberArray>(&stored[i].value);
        const bool is_direction = given[i].name == "centre" || given[i].name == "parameterization";
        for (std::size_t k = 0; from && to && !is_direction && k < from->numbers.size(); ++k)
            if (const float x = from->numbers[k], y = to->numbers[k]; !(std::abs(x - y) <= std::abs(x) / 2))
                return half_range_error({}, given[i].name, double(x));
    }
    return {};
}

/// The kinds of models: each alternative of `Model::model` needs a `Kind`.
template <typename> struct Kinds;
template <typename... M> struct Kinds<std::variant<M...>> {
    static_assert((ModelKind<M> && ...));
    static std::vector<std::string_view> names() { return {Kind<M>::name...}; }
    /// Reads the model of the kind `kind` from its tensors and metadata.
    static Result<Model> read(std::string_view kind, Safetensors& content, const std::string& file_name) {
        std::optional<Result<Model>> model;
        const auto read_one = [&]<typename K>(std::type_identity<K>) {
            if (kind != Kind<K>::name) return;
            auto read = Kind<K>::read(content, file_name);
            if (read)
                model.emplace(Model{*std::move(read), std::move(content.metadata)});
            else
                model.emplace(read.error());
        };
        (read_one(std::type_identity<M>()), ...);
        return *std::move(model);
    }
    /// The model of these parameters, whose names determine its kind.
    static Result<Model> from_parameters(ParameterReader reader) {
        std::optional<Result<Model>> model;
        const auto make_one = [&]<typename K>(std::type_identity<K>) {
            if (!model && Kind<K>::matches(reader)) model.emplace(rounded_of<K>(reader));
        };
        (make_one(std::type_identity<M>()), ...);
        if (model) return *std::move(model);
        return argument_error({}, "parameters", "the parameters of a model", {});
    }

  private:
    template <typename K> static Result<Model> rounded_of(ParameterReader& reader) {
        K given = Kind<K>::from_parameters(reader);
        if (const auto error = reader.error()) return *error;
        auto rounded = as_stored(given, "parameters");
        if (!rounded) return rounded.error();
        if (const auto lost = lost_number(Kind<K>::parameters(given), Kind<K>::parameters(*rounded))) return *lost;
        if constexpr (requires { given.centre; })
            for (std::size_t i = 0; i < given.centre.size(); ++i)
                if (const Vec3f apart = given.centre[i] - rounded->centre[i]; dot(apart, apart) < 1e-13f)
                    rounded->centre[i] = given.centre[i];
        if constexpr (requires { given.part; }) rounded->part = std::move(given.part);  // which are such models
        return Model{*std::move(rounded), {}};
    }
};
using AllKinds = Kinds<decltype(Model::model)>;

/// The model with this content. The part of a BSDF may not be a BSDF.
Result<Model> model_of(Safetensors content, bool is_part, const std::string& file_name) {
    auto kinds = AllKinds::names();
    if (is_part) std::erase(kinds, Kind<BsdfModel>::name);
    MetadataReader reader{content.metadata, file_name};
    if (const auto at = content.metadata.find("model"); at != content.metadata.end() && at->second == k_former_openpbr)
        at->second = Kind<OpenPbrModel>::name;
    const std::string kind = reader.take("model", kinds);
    if (reader.error) return *reader.error;
    return AllKinds::read(kind, content, file_name);
}

}  // namespace

Safetensors Kind<BsdfModel>::content(const BsdfModel& bsdf) {
    Safetensors content{encode_beams(bsdf.beam), {}};
    for (std::size_t p = 0; p < k_parts; ++p)
        if (bsdf.part[p]) add_part(content_of(*bsdf.part[p]), Part(p), content);
    return content;
}

Result<BsdfModel> Kind<BsdfModel>::read(Safetensors& content, const std::string& file_name) {
    BsdfModel bsdf;
    for (std::size_t p = 0; p < k_parts; ++p) {
        Safetensors part_content = take_part(content, Part(p));
        if (part_content.tensors.empty() && part_content.metadata.empty()) continue;
        auto part = model_of(std::move(part_content), true, file_name);
        if (!part) {
            Error error = part.error();
            error.what = fmt::format("{}: {}", k_part_names[p], error.what);
            return error;
        }
        bsdf.part[p] = std::make_shared<const Model>(*std::move(part));
    }
    auto beams = decode_beams(content.tensors, file_name);
    if (!beams) return beams.error();
    bsdf.beam = *std::move(beams);
    return bsdf;
}

double Kind<BsdfModel>::largest(const BsdfModel& model) {
    double largest = 0;
    for (const auto& part : model.part)
        if (part) largest = std::max(largest, largest_number(*part));
    return largest;
}

std::string_view kind(const Model& model) {
    return std::visit([](const auto& m) { return KindOf<decltype(m)>::name; }, model.model);
}

std::string_view kind_words(const Model& model) {
    return std::visit([](const auto& m) { return KindOf<decltype(m)>::words; }, model.model);
}

std::string summary(const Model& model) {
    return std::visit([](const auto& m) { return KindOf<decltype(m)>::summary(m); }, model.model);
}

std::string rows_text(const Model& model) {
    std::string text;
    std::visit([&](const auto& m) { KindOf<decltype(m)>::add_rows(text, m); }, model.model);
    return text;
}

Parameters report_members(const Model& model) {
    return std::visit([](const auto& m) { return KindOf<decltype(m)>::members(m); }, model.model);
}

Parameters parameters(const Model& model) {
    return std::visit([](const auto& m) { return KindOf<decltype(m)>::parameters(m); }, model.model);
}

std::string formula_text(const Model& model, const NumberText& number) {
    return std::visit([&](const auto& m) { return KindOf<decltype(m)>::formula_text(m, number); }, model.model);
}

Result<Model> model_from(const Parameters& parameters, std::map<std::string, std::string> provenance) {
    auto model = AllKinds::from_parameters(ParameterReader(parameters));
    if (model) model->provenance = std::move(provenance);
    return model;
}

Rgb value(const Model& model, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& m) { return value(m, wl, wv); }, model.model);
}

void evaluate(const Model& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    std::visit([&](const auto& m) { evaluate(m, wl, wv, f); }, model.model);
}

Evaluate evaluator(const Model& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

std::size_t payload_bytes(const Model& model) {
    return std::visit([](const auto& m) { return payload_bytes(m); }, model.model);
}

std::size_t auxiliary_bytes(const Model& model) {
    return std::visit([](const auto& m) { return auxiliary_bytes(m); }, model.model);
}

bool is_isotropic(const Model& model) {
    return std::visit([](const auto& m) { return is_isotropic(m); }, model.model);
}

void exchange(Model& model) {
    std::visit([](auto& m) { exchange(m); }, model.model);
    if (model.provenance.erase("exchanged") == 0) model.provenance["exchanged"] = k_exchanged;
}

std::span<const float> wavelengths(const Model& model) {
    if (const auto* pm = std::get_if<PmModel>(&model.model)) return pm->wavelength;
    return {};
}

Channels channels(const Model& model) {
    if (wavelengths(model).empty()) return rgb_channels(evaluator(model));
    return spectra(std::get<PmModel>(model.model));
}

std::vector<std::byte> write_model(const Model& model) {
    const StandardArithmetic mode;
    Safetensors content = content_of(model);
    content.metadata["srbf"] = k_file_version;
    return write_safetensors(content);
}

Error map_error(const std::string& file) {
    return {
        file, {}, "input", "a model", fmt::format("a map of texels, which {}#X,Y names", file), ErrorCode::wrong_kind};
}

Result<Model> read_model(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    Result<Safetensors> content = read_safetensors(bytes, file_name);
    if (!content) return content.error();
    const auto version = content->metadata.find("srbf");
    if (version == content->metadata.end() || version->second != k_file_version)
        return Error{file_name, 8, "metadata 'srbf'", std::string(k_file_version),
                     version == content->metadata.end() ? "none" : fmt::format("{:.40}", version->second)};
    content->metadata.erase(version);
    const auto kind = content->metadata.find("model");
    if (kind != content->metadata.end() && kind->second == k_map_kind) return map_error(file_name);
    if (kind != content->metadata.end() && kind->second == k_stack_kind)
        return Error{file_name,
                     {},
                     "input",
                     "a model or a map",
                     "texels with lobes of their own, of version 0.1; srbf map fits lobes that texels share",
                     ErrorCode::wrong_kind};
    return model_of(*std::move(content), false, file_name);
}

Result<Done> check_range(const Model& model, const std::string& source) {
    const double largest = largest_number(model);
    if (!(largest > double(k_half_max))) return Done{};
    return input_error(source, "coefficient", fmt::format("at most {:g}, the largest 16-bit float", k_half_max),
                       fmt::format("{:.6g}", largest));
}

Result<Done> save_model(const Model& model, const std::string& path) {
    if (const auto within = check_range(model, path); !within) return within;
    const std::vector<std::byte> bytes = write_model(model);
    if (const auto readable = header_length(bytes, path); !readable) return readable.error();  // long provenance
    return write_file(path, bytes);
}

Result<Model> load_model(const std::string& path) {
    return within_memory(path, [&]() -> Result<Model> {
        const auto bytes = read_file(path, all_if(is_safetensors));
        if (!bytes) return bytes.error();
        return read_model(*bytes, path);
    });
}

}  // namespace
