#include "srbf/model.h"

#include <fmt/format.h>
#include <cassert>

#include <algorithm>

#include "base/floating_point.h"
#include "base/safetensors.h"
#include "brdf/values.h"
#include "models/bsdf/bsdf_file.h"
#include "models/ggx/ggx_file.h"
#include "models/library.h"
#include "models/openpbr/pbr_file.h"
#include "models/range.h"
#include "models/su/su_file.h"
#include "models/texel.h"
#include "srbf/colour.h"
#include "srbf/file.h"
#include "srbf/half.h"
#include "srbf/kernel.h"
#include "srbf/text.h"

namespace srbf {
namespace {

constexpr std::string_view k_version = "1", k_stack = "pm-stack";

static_assert(k_terms.size() == SRBF_TERMS);

/// Of −0 and 0, which are the same azimuth, the latter, so that what was read is written with the same bytes.
std::uint16_t without_sign_of_zero(std::uint16_t half) { return half == to_half(-0.f) ? 0 : half; }

/// The tensors of a model, with its numbers rounded to 16-bit floats.
std::map<std::string, Tensor16> encode(const PmModel& model, bool with_log_scale) {
    const auto J = std::uint64_t(model.lobes), N = std::uint64_t(model.variates);
    std::map<std::string, Tensor16> tensors;

    const std::uint64_t C = model.wavelength.empty() ? 3 : model.wavelength.size();
    Tensor16& coefficient = tensors["coefficient"] = {Type16::half, {J, C}, {}};
    const auto add_coefficient = [&](float beta) { coefficient.data.push_back(to_half(std::min(beta, k_half_max))); };
    if (model.wavelength.empty())
        for (const Rgb& beta : model.coefficient)
            for (int c = 0; c < 3; ++c) add_coefficient(beta[c]);
    for (const float beta : model.spectrum) add_coefficient(beta);

    if (with_log_scale) {
        Tensor16& log_scale = tensors["log_scale"] = {Type16::half, {J}, {}};
        for (const float s : model.log_scale) log_scale.data.push_back(to_half(std::clamp(s, -k_half_max, k_half_max)));
    }

    Tensor16& bandwidth = tensors["bandwidth"] = {Type16::half, {J, N}, {}};
    for (std::size_t i = 0; i < model.bandwidth.size(); ++i) {
        const float sign = model.axial && model.centre[i].z < 0 ? -1.f : 1.f;
        bandwidth.data.push_back(to_half(sign * std::min(model.bandwidth[i], k_half_max)));
    }

    if (!model.axial) {
        Tensor16& centre = tensors["centre"] = {Type16::half, {J, N, 2}, {}};
        for (const Vec3f& xi : model.centre) {
            const Angles<float> of_centre = angles(xi);
            centre.data.push_back(to_half(of_centre.theta));
            centre.data.push_back(without_sign_of_zero(to_half(of_centre.phi)));
        }
    }

    if (const auto F = std::uint64_t(features(model.form)); F > 0) {
        Tensor16& exponent = tensors["exponent"] = {Type16::half, {J, F}, {}};
        for (const float kappa : model.exponent)
            exponent.data.push_back(to_half(std::clamp(kappa, -k_half_max, k_half_max)));
    }

    Tensor16& parameterization = tensors["parameterization"] = {Type16::half, {N, 2}, {}};
    for (const Parameterization& p : model.parameterization) {
        // Only the direction of (a, b) matters: one outside of the range of 16-bit floats is normalised.
        const float largest = std::max(std::abs(p.a), std::abs(p.b));
        const float scale = largest > 1024 || largest < 1.f / 1024 ? 1 / largest : 1;
        parameterization.data.push_back(to_half(scale * p.a));
        parameterization.data.push_back(to_half(scale * p.b));
    }
    return tensors;
}

std::map<std::string, Tensor16> encode(const PmModel& model) { return encode(model, has_log_scale(model)); }

/// The tensors of a model with J lobes of N variates and C coefficients a lobe.
std::map<std::string, TensorShape> tensors_of(PmForm form, bool axial, bool with_log_scale, std::uint64_t J,
                                              std::uint64_t N, std::uint64_t C) {
    std::map<std::string, TensorShape> tensors{{"coefficient", {Type16::half, {J, C}}},
                                               {"bandwidth", {Type16::half, {J, N}}},
                                               {"parameterization", {Type16::half, {N, 2}}}};
    if (!axial) tensors["centre"] = {Type16::half, {J, N, 2}};
    if (const auto F = std::uint64_t(features(form)); F > 0) tensors["exponent"] = {Type16::half, {J, F}};
    if (with_log_scale) tensors["log_scale"] = {Type16::half, {J}};
    return tensors;
}

/// The model of these tensors, or an error.
Result<PmModel> decode(const std::map<std::string, Tensor16>& tensors, PmForm form, bool axial,
                       std::vector<float> wavelength, const std::string& file_name) {
    const auto fail = [&](std::string what, std::string expected, std::string found) {
        return Error{file_name, std::nullopt, std::move(what), std::move(expected), std::move(found)};
    };
    const auto shape =
        shape_of_bandwidths(tensors, {0, 0}, {k_most_lobes, k_most_variates},
                            fmt::format("[J, N] up to [{}, {}]", k_most_lobes, k_most_variates), file_name);
    if (!shape) return shape.error();
    const std::uint64_t J = (*shape)[0], N = (*shape)[1], C = wavelength.empty() ? 3 : wavelength.size();
    const auto F = std::uint64_t(features(form));
    const bool has_log_scale = tensors.contains("log_scale");
    const auto expected = tensors_of(form, axial, F > 0 || has_log_scale, J, N, C);
    if (const auto valid = check_tensors(tensors, expected, file_name); !valid) return valid.error();

    const auto number = [&](const char* name, std::size_t i) { return from_half(tensors.at(name).data[i]); };
    PmModel model;
    model.form = form;
    model.axial = axial;
    model.lobes = int(J);
    model.variates = int(N);
    for (std::size_t i = 0; i < J * C; ++i) {
        const float beta = number("coefficient", i);
        if (beta < 0) return fail("tensor 'coefficient'", "numbers of at least 0", fmt::format("{}", beta));
        if (!wavelength.empty())
            model.spectrum.push_back(beta);
        else if (i % 3 == 2)
            model.coefficient.push_back({number("coefficient", i - 2), number("coefficient", i - 1), beta});
    }
    if (!wavelength.empty()) model.coefficient = colours(model.spectrum, wavelength);
    model.wavelength = std::move(wavelength);
    for (std::size_t j = 0; j < J; ++j) model.log_scale.push_back(has_log_scale ? number("log_scale", j) : 0.f);
    for (std::size_t i = 0; i < J * N; ++i) {
        const float lambda = number("bandwidth", i);
        if (axial) {
            model.centre.push_back({0, 0, std::signbit(lambda) ? -1.f : 1.f});
            model.bandwidth.push_back(std::abs(lambda));
        } else {
            if (lambda < 0) return fail("tensor 'bandwidth'", "numbers of at least 0", fmt::format("{}", lambda));
            model.centre.push_back(spherical(number("centre", 2 * i), number("centre", 2 * i + 1)));
            model.bandwidth.push_back(lambda);
        }
    }
    for (std::size_t i = 0; i < J * F; ++i) {
        const float kappa = number("exponent", i);
        if (kappa < 0 && k_terms[i % F].least == 0)
            return fail("tensor 'exponent'", "numbers of at least 0", fmt::format("{}", kappa));
        model.exponent.push_back(kappa);
    }
    for (std::size_t n = 0; n < N; ++n) {
        const Parameterization p{number("parameterization", 2 * n), number("parameterization", 2 * n + 1)};
        if (p.a == 0 && p.b == 0) return fail("tensor 'parameterization'", "weights that are not both 0", "0, 0");
        model.parameterization.push_back(p);
    }
    return model;
}

/// Takes the value of `key` out of the metadata; the first that is not one of `known` becomes the error. The metadata
/// that remain are provenance.
std::string taken(std::map<std::string, std::string>& metadata, const char* key,
                  const std::vector<std::string_view>& known, const std::string& file_name,
                  std::optional<Error>& error) {
    const auto at = metadata.find(key);
    const std::string found = at == metadata.end() ? "" : at->second;
    if (std::find(known.begin(), known.end(), found) == known.end()) {
        if (!error)
            error = {file_name, 8, fmt::format("metadata '{}'", key), fmt::format("{}", fmt::join(known, " or ")),
                     at == metadata.end() ? "none" : fmt::format("{:.40}", found)};
    } else {
        metadata.erase(at);
    }
    return found;
}

std::vector<std::string_view> stored_forms() {
    std::vector<std::string_view> forms;
    for (const PmForm form : k_forms) forms.push_back(stored_name(form));
    return forms;
}

/// Wavelengths in the metadata of a file, separated by blanks.
Result<std::vector<float>> wavelengths_of(std::string_view text, const std::string& file_name) {
    std::vector<float> wavelengths;
    for (std::string_view rest = text; wavelengths.size() <= k_most_wavelengths;) {
        const std::string_view word = next_word(rest);
        if (word.empty()) break;
        wavelengths.push_back(to_number<float>(word).value_or(0));
    }
    if (are_wavelengths(wavelengths) && wavelengths.size() <= k_most_wavelengths) return wavelengths;
    return Error{file_name, 8, "metadata 'wavelengths'",
                 fmt::format("1 to {} increasing ones in nm, from 100 up", k_most_wavelengths), quoted(text)};
}

}  // namespace

Rgb value(const PmModel& model, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const Vec3f f = Kernel<float>::pm_value(model, wl, wv);
    return {f.x, f.y, f.z};
}

Rgb value(const Model& model, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& m) { return value(m, wl, wv); }, model.model);
}

bool is_reciprocal(const PmModel& model) {
    const auto J = std::size_t(model.lobes), N = std::size_t(model.variates);
    std::vector<bool> matched(N, false);
    const auto swapped = [&](std::size_t n, std::size_t m) {
        const Parameterization p = model.parameterization[n], q = model.parameterization[m];
        bool same = p.a == q.b && p.b == q.a;
        for (std::size_t j = 0; j < J; ++j)
            same = same && model.bandwidth[j * N + n] == model.bandwidth[j * N + m] &&
                   model.centre[j * N + n] == model.centre[j * N + m];
        return same;
    };
    for (std::size_t n = 0; n < N; ++n)
        for (std::size_t m = n; m < N && !matched[n]; ++m)
            if (!matched[m] && swapped(n, m)) matched[n] = matched[m] = true;
    return std::all_of(matched.begin(), matched.end(), [](bool x) { return x; });
}

bool has_log_scale(const PmModel& model) {
    return features(model.form) > 0 ||
           std::any_of(model.log_scale.begin(), model.log_scale.end(), [](float s) { return round_to_half(s) != 0; });
}

std::size_t payload_bytes(const Model& model) {
    return std::visit([](const auto& m) { return payload_bytes(m); }, model.model);
}

std::size_t auxiliary_bytes(const Model& model) {
    return std::visit([](const auto& m) { return auxiliary_bytes(m); }, model.model);
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

bool is_isotropic(const Model& model) {
    const auto* pm = std::get_if<PmModel>(&model.model);
    const auto* bsdf = std::get_if<BsdfModel>(&model.model);
    if (bsdf) return std::ranges::all_of(bsdf->part, [](const auto& part) { return !part || is_isotropic(*part); });
    const auto* pbr = std::get_if<PbrModel>(&model.model);
    return pbr ? pbr->specular_roughness_anisotropy == 0 : !pm || pm->axial;
}

void exchange(Model& model) {
    if (auto* pm = std::get_if<PmModel>(&model.model))
        for (Parameterization& of : pm->parameterization) std::swap(of.a, of.b);  // all else is symmetric
    if (auto* su = std::get_if<SuModel>(&model.model))
        su->discretise = su->discretise == Discretise::view ? Discretise::light : Discretise::view;
    if (auto* pbr = std::get_if<PbrModel>(&model.model)) pbr->is_exchanged = !pbr->is_exchanged;
    if (auto* bsdf = std::get_if<BsdfModel>(&model.model)) {
        for (auto& part : bsdf->part) {
            if (!part) continue;
            Model copy = *part;
            exchange(copy);
            part = std::make_shared<const Model>(std::move(copy));
        }
        std::swap(bsdf->part[std::size_t(Part::transmission_front)], bsdf->part[std::size_t(Part::transmission_back)]);
    }
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

PmModel rounded(const PmModel& model) {
    const StandardArithmetic mode;
    Result<PmModel> decoded = decode(encode(model), model.form, model.axial, model.wavelength, "");
    assert(decoded.ok());  // a valid model can be encoded
    return *std::move(decoded);
}

namespace {

/// A model's tensors and metadata, without the version.
Safetensors content_of(const Model& model) {
    Safetensors content{{}, model.provenance};
    auto& metadata = content.metadata;
    if (const auto* pm = std::get_if<PmModel>(&model.model)) {
        content.tensors = encode(*pm);
        metadata["model"] = "pm";
        metadata["form"] = stored_name(pm->form);
        metadata["axial"] = pm->axial ? "true" : "false";
        if (!pm->wavelength.empty()) metadata["wavelengths"] = fmt::format("{}", fmt::join(pm->wavelength, " "));
    } else if (const auto* su = std::get_if<SuModel>(&model.model)) {
        content.tensors = encode_su(*su);
        metadata["model"] = "su";
        metadata["discretise"] = name(su->discretise);
        metadata["interpolation"] = name(su->interpolation);
        metadata["neighbours"] = std::to_string(su->neighbours);
    } else if (const auto* ggx = std::get_if<GgxModel>(&model.model)) {
        content.tensors = encode_ggx(*ggx);
        metadata["model"] = "ggx";
    } else if (const auto* pbr = std::get_if<PbrModel>(&model.model)) {
        content.tensors = encode_pbr(*pbr);
        metadata["model"] = "pbr";
        metadata["exchanged_surface"] = pbr->is_exchanged ? "true" : "false";
    } else {
        const auto& bsdf = std::get<BsdfModel>(model.model);
        content.tensors = encode_beams(bsdf.beam);
        for (std::size_t p = 0; p < k_parts; ++p)
            if (bsdf.part[p]) add_part(content_of(*bsdf.part[p]), Part(p), content);
        metadata["model"] = "bsdf";
    }
    return content;
}

/// Of both sides, whose parts are taken out of the content.
Result<Model> model_of(Safetensors content, bool may_be_bsdf, const std::string& file_name);
Result<Model> bsdf_of(Safetensors content, const std::string& file_name) {
    BsdfModel bsdf;
    for (std::size_t p = 0; p < k_parts; ++p) {
        Safetensors of_part = take_part(content, Part(p));
        if (of_part.tensors.empty() && of_part.metadata.empty()) continue;
        auto part = model_of(std::move(of_part), false, file_name);
        if (!part) {
            Error of = part.error();
            of.what = fmt::format("{}: {}", k_part_names[p], of.what);
            return of;
        }
        bsdf.part[p] = std::make_shared<const Model>(*std::move(part));
    }
    auto beams = decode_beams(content.tensors, file_name);
    if (!beams) return beams.error();
    bsdf.beam = *std::move(beams);
    return Model{std::move(bsdf), std::move(content.metadata)};
}

/// The model of these; `may_be_bsdf`: a part may not.
Result<Model> model_of(Safetensors content, bool may_be_bsdf, const std::string& file_name) {
    auto& metadata = content.metadata;
    // The metadata that determine the meaning of the tensors; all other metadata are provenance. The first unknown
    // value is reported.
    std::optional<Error> error;
    const auto take = [&](const char* key, const std::vector<std::string_view>& known) {
        return taken(metadata, key, known, file_name, error);
    };
    std::vector<std::string_view> kinds{"pm", "su", "ggx", "pbr"};
    if (may_be_bsdf) kinds.push_back("bsdf");
    const std::string kind = take("model", kinds);
    if (error) return *error;
    if (kind == "bsdf") return bsdf_of(std::move(content), file_name);
    if (kind == "su") {
        const auto discretise = take("discretise", {name(Discretise::view), name(Discretise::light)}),
                   interpolation =
                       take("interpolation", {name(SuInterpolation::rotated), name(SuInterpolation::plain)}),
                   neighbours = take("neighbours", {"1", "2", "3", "4", "5", "6", "7"});
        if (error) return *error;
        Result<SuModel> su = decode_su(
            content.tensors, {*discretise_named(discretise), *interpolation_named(interpolation), neighbours[0] - '0'},
            file_name);
        if (!su) return su.error();
        return Model{*std::move(su), std::move(metadata)};
    }
    if (kind == "ggx") {
        Result<GgxModel> ggx = decode_ggx(content.tensors, file_name);
        if (!ggx) return ggx.error();
        return Model{*std::move(ggx), std::move(metadata)};
    }
    if (kind == "pbr") {
        const std::string is_exchanged = take("exchanged_surface", {"true", "false"});
        if (error) return *error;
        Result<PbrModel> pbr = decode_pbr(content.tensors, is_exchanged == "true", file_name);
        if (!pbr) return pbr.error();
        return Model{*std::move(pbr), std::move(metadata)};
    }
    const auto form = take("form", stored_forms()), axial = take("axial", {"true", "false"});
    if (error) return *error;
    std::vector<float> wavelength;
    if (const auto at = metadata.find("wavelengths"); at != metadata.end()) {
        auto known = wavelengths_of(at->second, file_name);
        if (!known) return known.error();
        wavelength = *std::move(known);
        metadata.erase(at);
    }
    Result<PmModel> pm = decode(content.tensors, *form_named(form), axial == "true", std::move(wavelength), file_name);
    if (!pm) return pm.error();
    return Model{*std::move(pm), std::move(metadata)};
}

}  // namespace

std::vector<std::byte> write_model(const Model& model) {
    const StandardArithmetic mode;
    Safetensors content = content_of(model);
    content.metadata["srbf"] = k_version;
    return write_safetensors(content);
}

Safetensors lobes_content(const PmModel& model, std::string_view kind) {
    Safetensors content{encode(model, true), {}};
    content.metadata["srbf"] = k_version;
    content.metadata["model"] = kind;
    content.metadata["form"] = stored_name(model.form);
    content.metadata["axial"] = model.axial ? "true" : "false";
    return content;
}

Result<PmModel> take_lobes(Safetensors& content, std::string_view kind, const std::string& file_name) {
    std::optional<Error> error;
    const auto take = [&](const char* key, const std::vector<std::string_view>& known) {
        return taken(content.metadata, key, known, file_name, error);
    };
    take("srbf", {k_version}), take("model", {kind});
    const auto form = take("form", stored_forms()), axial = take("axial", {"true", "false"});
    if (error) return *error;
    return decode(content.tensors, *form_named(form), axial == "true", {}, file_name);
}

Result<Model> read_model(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    Result<Safetensors> content = read_safetensors(bytes, file_name);
    if (!content) return content.error();
    const auto version = content->metadata.find("srbf");
    if (version == content->metadata.end() || version->second != k_version)
        return Error{file_name, 8, "metadata 'srbf'", std::string(k_version),
                     version == content->metadata.end() ? "none" : fmt::format("{:.40}", version->second)};
    content->metadata.erase(version);
    if (const auto kind = content->metadata.find("model"); kind != content->metadata.end() && kind->second == k_stack)
        return Error{file_name,
                     {},
                     "input",
                     "a model",
                     fmt::format("a stack of them, which {0}#0, {0}#1, .. name", file_name),
                     ErrorCode::wrong_kind};
    if (const auto kind = content->metadata.find("model");
        kind != content->metadata.end() && kind->second == k_library_kind)
        return Error{file_name,
                     {},
                     "input",
                     "a model",
                     fmt::format("a library of them, which {0}#NAME names", file_name),
                     ErrorCode::wrong_kind};
    return model_of(*std::move(content), true, file_name);
}

std::vector<std::byte> write_stack(const ModelStack& stack) {
    const StandardArithmetic mode;
    const std::uint64_t T = stack.models.size();
    Safetensors content{{}, stack.provenance};
    content.metadata["srbf"] = k_version;
    content.metadata["model"] = k_stack;
    content.metadata["form"] = stored_name(stack.models[0].form);
    content.metadata["axial"] = stack.models[0].axial ? "true" : "false";
    for (const PmModel& model : stack.models)
        for (auto& [name, tensor] : encode(model, true)) {
            Tensor16& all = content.tensors[name];
            if (all.shape.empty()) {
                all.type = tensor.type;
                all.shape.push_back(T);
                all.shape.insert(all.shape.end(), tensor.shape.begin(), tensor.shape.end());
            }
            all.data.insert(all.data.end(), tensor.data.begin(), tensor.data.end());
        }
    Tensor16& error = content.tensors["aux.error"] = {Type16::half, {T}, {}};
    for (const float of : stack.error) error.data.push_back(to_half(std::clamp(of, 0.f, k_half_max)));
    content.tensors["aux.state"] = {Type16::count, {T}, stack.state};
    return write_safetensors(content);
}

namespace {

/// The content of a stack's file, of which every tensor has T entries.
struct StackContent {
    std::map<std::string, Tensor16> tensors;  ///< of the models
    std::vector<std::uint16_t> state;
    std::vector<float> error;
    PmForm form;
    bool axial;
    std::map<std::string, std::string> provenance;
    std::string file_name;

    Result<PmModel> model(std::size_t texel) const {
        std::map<std::string, Tensor16> of;
        for (const auto& [name, tensor] : tensors) {
            const std::size_t count = tensor.data.size() / state.size();
            const auto begin = tensor.data.begin() + std::ptrdiff_t(count * texel);
            of[name] = {
                tensor.type, {tensor.shape.begin() + 1, tensor.shape.end()}, {begin, begin + std::ptrdiff_t(count)}};
        }
        return decode(of, form, axial, {}, file_name);
    }
};

Result<StackContent> read_stack_content(std::span<const std::byte> bytes, const std::string& file_name) {
    Result<Safetensors> content = read_safetensors(bytes, file_name);
    if (!content) return content.error();
    std::optional<Error> error;
    const auto take = [&](const char* key, const std::vector<std::string_view>& known) {
        return taken(content->metadata, key, known, file_name, error);
    };
    take("srbf", {k_version}), take("model", {k_stack});
    const auto form = take("form", stored_forms()), axial = take("axial", {"true", "false"});
    if (error) return *error;
    auto& tensors = content->tensors;
    const auto state_at = tensors.find("aux.state");
    if (state_at == tensors.end() || state_at->second.shape.size() != 1)
        return Error{file_name, {}, "tensor 'aux.state'", "of one dimension", "none"};
    const std::uint64_t T = state_at->second.shape[0];
    std::map<std::string, Tensor16> own{{"aux.state", state_at->second}};
    if (const auto at = tensors.find("aux.error"); at != tensors.end()) own.insert(*at);
    if (const auto valid =
            check_tensors(own, {{"aux.state", {Type16::count, {T}}}, {"aux.error", {Type16::half, {T}}}}, file_name);
        !valid)
        return valid.error();
    for (const auto& [name, tensor] : own) tensors.erase(name);
    for (const auto& [name, tensor] : tensors)
        if (tensor.shape.size() < 2 || tensor.shape[0] != T)
            return Error{file_name,
                         {},
                         fmt::format("tensor '{:.80}': shape", name),
                         fmt::format("[{}, ..]", T),
                         shape_text(tensor.shape)};
    StackContent stack{std::move(tensors), own["aux.state"].data,        {},       *form_named(form),
                       axial == "true",    std::move(content->metadata), file_name};
    for (const std::uint16_t half : own["aux.error"].data) stack.error.push_back(from_half(half));
    return stack;
}

}  // namespace

Result<ModelStack> read_stack(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    auto content = read_stack_content(bytes, file_name);
    if (!content) return content.error();
    ModelStack stack{{}, content->error, content->state, content->provenance};
    for (std::size_t t = 0; t < content->state.size(); ++t) {
        auto model = content->model(t);
        if (!model) return model.error();
        stack.models.push_back(*std::move(model));
    }
    return stack;
}

Result<Model> read_texel(std::span<const std::byte> bytes, std::uint64_t texel, const std::string& file_name) {
    const StandardArithmetic mode;
    auto content = read_stack_content(bytes, file_name);
    if (!content) return content.error();
    const std::size_t count = content->state.size();
    if (texel >= count)
        return Error{file_name,          {}, "texel", fmt::format("0 to {}", count - 1), fmt::format("{}", texel),
                     ErrorCode::argument};
    auto model = content->model(texel);
    if (!model) return model.error();
    auto& provenance = content->provenance;
    provenance["texel"] = fmt::format("{} of {}", texel, count);
    provenance["texel_state"] = fmt::format("{}", content->state[texel]);
    provenance["texel_error"] = fmt::format("{:.4g}", content->error[texel]);
    return Model{*std::move(model), std::move(provenance)};
}

namespace {

double largest_number(const PmModel& model) {
    double largest = 0;
    for (const Rgb& beta : model.coefficient) largest = std::max(largest, largest_of(beta));
    for (const float beta : model.spectrum) largest = std::max(largest, double(beta));
    return largest;
}
double largest_number(const SuModel& model) {
    double largest = 0;
    for (const Rgb& beta : model.coefficient) largest = std::max(largest, largest_of(beta));
    return largest;
}
double largest_number(const GgxModel& model) {
    double largest = largest_of(model.diffuse);
    for (const GgxModel::Lobe& lobe : model.lobes) largest = std::max({largest, largest_of(lobe.f0), double(lobe.f90)});
    return largest;
}
double largest_number(const PbrModel&) { return 0; }  // its parameters have limits of their own
double largest_number(const BsdfModel& model) {
    double largest = 0;
    for (const auto& part : model.part)
        if (part)
            largest = std::max(largest, std::visit([](const auto& of) { return largest_number(of); }, part->model));
    return largest;
}

}  // namespace

Result<Done> check_range(const Model& model, const std::string& source) {
    const double largest = std::visit([](const auto& of) { return largest_number(of); }, model.model);
    if (!(largest > double(k_half_max))) return Done{};
    return Error{source,
                 {},
                 "coefficient",
                 fmt::format("at most {:g}, the largest 16-bit float", k_half_max),
                 fmt::format("{:.6g}", largest)};
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

}  // namespace srbf
