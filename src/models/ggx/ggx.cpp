#include "srbf/models/ggx.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/floating_point.h"
#include "base/half.h"
#include "brdf/values.h"
#include "models/ggx/ggx_functions.h"
#include "models/ggx/ggx_kind.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

using Formula = Kernel<float>;

Formula::GgxLobe kernel_lobe(const GgxModel& model, std::size_t i) {
    if (i >= model.lobes.size()) return {1, {0, 0, 0}, 0};
    const GgxModel::Lobe& lobe = model.lobes[i];
    return {lobe.roughness, {lobe.f0.r, lobe.f0.g, lobe.f0.b}, lobe.f90};
}

}  // namespace

Rgb value(const GgxModel& model, Vec3f wl, Vec3f wv) {
    Rgb f;
    evaluate(model, {&wl, 1}, {&wv, 1}, {&f, 1});
    return f;
}

void evaluate(const GgxModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    const Vec3f diffuse{model.diffuse.r, model.diffuse.g, model.diffuse.b};
    const auto first = kernel_lobe(model, 0), second = kernel_lobe(model, 1);
    for (std::size_t i = 0; i < f.size(); ++i) {
        const Vec3f rho = Formula::ggx_value(diffuse, first, second, wl[i], wv[i]);
        f[i] = above_horizon(wl[i], wv[i]) ? Rgb{rho.x, rho.y, rho.z} : Rgb{};
    }
}

Evaluate evaluator(const GgxModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

GgxModel rounded(const GgxModel& model) { return as_stored(model); }

Safetensors Kind<GgxModel>::content(const GgxModel& model) {
    const auto L = std::uint64_t(model.lobes.size());
    Tensor16 diffuse{Type16::half, {3}, {}}, roughness{Type16::half, {L}, {}}, f0{Type16::half, {L, 3}, {}},
        f90{Type16::half, {L}, {}};
    const auto add = [](Tensor16& tensor, float x) { tensor.data.push_back(to_half(std::min(x, k_half_max))); };
    for (int c = 0; c < 3; ++c) add(diffuse, model.diffuse[c]);
    for (const GgxModel::Lobe& lobe : model.lobes) {
        add(roughness, std::clamp(lobe.roughness, k_least_roughness, 1.f));
        for (int c = 0; c < 3; ++c) add(f0, lobe.f0[c]);
        add(f90, lobe.f90);
    }
    return {{{"diffuse", diffuse}, {"roughness", roughness}, {"facing", f0}, {"grazing", f90}}, {}};
}

Result<GgxModel> Kind<GgxModel>::read(Safetensors& content, const std::string& file_name) {
    const auto& tensors = content.tensors;
    const auto fail = [&](std::string what, std::string expected, std::string found) {
        return Error{file_name, std::nullopt, std::move(what), std::move(expected), std::move(found)};
    };
    const auto tensor = tensors.find("roughness");
    if (tensor == tensors.end()) return fail("tensor 'roughness'", "present", "none");
    const auto& extent = tensor->second.shape;
    if (extent.size() != 1 || extent[0] < 1 || extent[0] > k_most_ggx_lobes)
        return fail("tensor 'roughness': shape", fmt::format("[1] or [{}]", k_most_ggx_lobes), shape_text(extent));
    const std::uint64_t L = extent[0];
    const std::map<std::string, TensorShape> expected{{"diffuse", {Type16::half, {3}}},
                                                      {"roughness", {Type16::half, {L}}},
                                                      {"facing", {Type16::half, {L, 3}}},
                                                      {"grazing", {Type16::half, {L}}}};
    if (const auto valid = check_tensors(tensors, expected, file_name); !valid) return valid.error();

    for (const char* name : {"diffuse", "facing", "grazing"})
        for (const std::uint16_t x : tensors.at(name).data)
            if (from_half(x) < 0)
                return fail(fmt::format("tensor '{}'", name), "numbers of at least 0", fmt::format("{}", from_half(x)));
    const auto number = [&](const char* name, std::size_t i) { return from_half(tensors.at(name).data[i]); };
    const auto colour = [&](const char* name, std::size_t i) {
        return Rgb{number(name, 3 * i), number(name, 3 * i + 1), number(name, 3 * i + 2)};
    };
    GgxModel model{colour("diffuse", 0), {}};
    for (std::size_t i = 0; i < L; ++i) {
        const float alpha = number("roughness", i);
        if (!(alpha >= k_least_roughness && alpha <= 1))
            return fail("tensor 'roughness'", fmt::format("{} to 1", k_least_roughness), fmt::format("{}", alpha));
        model.lobes.push_back({alpha, colour("facing", i), number("grazing", i)});
    }
    return model;
}

double Kind<GgxModel>::largest(const GgxModel& model) {
    double largest = largest_of(model.diffuse);
    for (const GgxModel::Lobe& lobe : model.lobes) largest = std::max({largest, largest_of(lobe.f0), double(lobe.f90)});
    return largest;
}

}  // namespace srbf
