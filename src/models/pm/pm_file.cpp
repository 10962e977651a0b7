// The multivariate model as tensors of a model file.
#include <fmt/format.h>

#include <cassert>

#include "base/floating_point.h"
#include "base/half.h"
#include "base/text.h"
#include "brdf/colour.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "models/pm/pm_functions.h"
#include "models/pm/pm_kind.h"

namespace SRBF_NAMESPACE {
namespace {

/// Maps −0 to 0, the same azimuth, so that a model that was read is written with the same bytes.
std::uint16_t without_sign_of_zero(std::uint16_t half) { return half == to_half(-0.f) ? 0 : half; }

/// The tensors of a model with J lobes of N variates and C coefficients per lobe.
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

/// The tensors of a model, with its numbers rounded to 16-bit floats.
std::map<std::string, Tensor16> encode(const PmModel& model, bool with_log_scale) {
    std::map<std::string, Tensor16> tensors;
    for (const auto& [name, layout] :
         tensors_of(model.form, model.axial, with_log_scale, std::uint64_t(model.lobes), std::uint64_t(model.variates),
                    model.wavelength.empty() ? 3 : model.wavelength.size()))
        tensors[name] = {layout.type, layout.shape, {}};
    const auto add = [&](const char* name, float x) {
        tensors.at(name).data.push_back(to_half(std::clamp(x, -k_half_max, k_half_max)));
    };
    if (model.wavelength.empty())
        for (const Rgb& beta : model.coefficient)
            for (int c = 0; c < 3; ++c) add("coefficient", beta[c]);
    for (const float beta : model.spectrum) add("coefficient", beta);
    for (const float s : model.log_scale)
        if (with_log_scale) add("log_scale", s);
    for (std::size_t i = 0; i < model.bandwidth.size(); ++i) {
        const bool is_down = model.axial && model.centre[i].z < 0;
        add("bandwidth", is_down ? -model.bandwidth[i] : model.bandwidth[i]);
        if (model.axial) continue;
        const Angles<float> direction = angles(model.centre[i]);
        add("centre", direction.theta);
        tensors.at("centre").data.push_back(without_sign_of_zero(to_half(direction.phi)));
    }
    for (const float kappa : model.exponent) add("exponent", kappa);
    for (const Parameterization& p : model.parameterization) {
        // Only the direction of (a, b) matters. If it is outside the range of 16-bit floats, it is normalised.
        const float largest = std::max(std::abs(p.a), std::abs(p.b));
        const float scale = largest > 1024 || largest < 1.f / 1024 ? 1 / largest : 1;
        add("parameterization", scale * p.a), add("parameterization", scale * p.b);
    }
    return tensors;
}

/// The model with these tensors, or an error.
Result<PmModel> decode(const std::map<std::string, Tensor16>& tensors, PmForm form, bool axial,
                       std::vector<float> wavelength, const std::string& file_name) {
    const auto fail = [&](std::string what, std::string expected, std::string found) {
        return Error{file_name, std::nullopt, std::move(what), std::move(expected), std::move(found)};
    };
    const auto shape =
        shape_of_bandwidths(tensors, {0, 0}, {k_max_lobes, k_max_variates},
                            fmt::format("[J, N] up to [{}, {}]", k_max_lobes, k_max_variates), file_name);
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
        if (kappa < 0 && k_terms[i % F].min == 0)
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

std::vector<std::string_view> stored_forms() {
    std::vector<std::string_view> forms;
    for (const PmForm form : k_forms) forms.push_back(stored_name(form));
    return forms;
}

/// Parses the wavelengths in the metadata of a file, separated by blanks.
Result<std::vector<float>> wavelengths_of(std::string_view text, const std::string& file_name) {
    std::vector<float> wavelengths;
    for (std::string_view remaining = text; wavelengths.size() <= k_max_wavelengths;) {
        const std::string_view word = next_word(remaining);
        if (word.empty()) break;
        wavelengths.push_back(to_number<float>(word).value_or(0));
    }
    if (are_wavelengths(wavelengths) && wavelengths.size() <= k_max_wavelengths) return wavelengths;
    return Error{file_name, 8, "metadata 'wavelengths'",
                 fmt::format("1 to {} increasing ones in nm, from 100 up", k_max_wavelengths), quoted(text)};
}

}  // namespace

Safetensors lobes_content(const PmModel& model, bool with_log_scale) {
    return {encode(model, with_log_scale),
            {{"form", std::string(stored_name(model.form))}, {"axial", model.axial ? "true" : "false"}}};
}

Safetensors Kind<PmModel>::content(const PmModel& model) {
    Safetensors content = lobes_content(model, has_log_scale(model));
    if (!model.wavelength.empty())
        content.metadata["wavelengths"] = fmt::format("{}", fmt::join(model.wavelength, " "));
    return content;
}

Result<PmModel> Kind<PmModel>::read(Safetensors& content, const std::string& file_name) {
    MetadataReader reader{content.metadata, file_name};
    const auto form = reader.take("form", stored_forms()), axial = reader.take("axial", {"true", "false"});
    if (reader.error) return *reader.error;
    std::vector<float> wavelength;
    if (const auto text = content.metadata.extract("wavelengths")) {
        auto parsed = wavelengths_of(text.mapped(), file_name);
        if (!parsed) return parsed.error();
        wavelength = *std::move(parsed);
    }
    return decode(content.tensors, *form_named(form), axial == "true", std::move(wavelength), file_name);
}

double Kind<PmModel>::largest(const PmModel& model) {
    double largest = 0;
    for (const Rgb& beta : model.coefficient) largest = std::max(largest, largest_of(beta));
    for (const float beta : model.spectrum) largest = std::max(largest, double(beta));
    return largest;
}

PmModel rounded(const PmModel& model) {
    const StandardArithmetic mode;
    Result<PmModel> decoded =
        decode(encode(model, has_log_scale(model)), model.form, model.axial, model.wavelength, "");
    assert(decoded.ok());  // a valid model can be encoded
    return *std::move(decoded);
}

}  // namespace
