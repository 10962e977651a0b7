#include "srbf/map.h"

#include <fmt/format.h>

#include "base/floating_point.h"
#include "base/half.h"
#include "base/safetensors.h"
#include "base/text.h"
#include "models/model_files.h"
#include "models/pm/pm_kind.h"

namespace SRBF_NAMESPACE {

Model texel(const TexelMap& map, std::size_t t) {
    const auto J = std::ptrdiff_t(map.basis.lobes);
    Model model{map.basis, map.provenance};
    const auto first = map.coefficient.begin() + std::ptrdiff_t(t) * J;
    std::get<PmModel>(model.model).coefficient.assign(first, first + J);
    model.provenance["texel"] = fmt::format("{}", t);
    model.provenance["texel_error"] = fmt::format("{:.4g}", map.error[t]);
    return model;
}

Model mean_texel(const TexelMap& map) {
    PmModel model = map.basis;
    const std::size_t J = model.coefficient.size();
    std::vector<double> sum(3 * J);
    for (std::size_t i = 0; i < map.coefficient.size(); ++i)
        for (int c = 0; c < 3; ++c) sum[3 * (i % J) + std::size_t(c)] += double(map.coefficient[i][c]);
    for (std::size_t i = 0; i < sum.size(); ++i)
        model.coefficient[i / 3][int(i % 3)] = float(sum[i] / double(std::max<std::size_t>(map.count(), 1)));
    return {std::move(model), {}};
}

Model lobe_alone(PmModel basis, std::size_t j) {
    basis.coefficient.assign(std::size_t(basis.lobes), Rgb{}), basis.coefficient[j] = {1, 1, 1};
    return {std::move(basis), {}};
}

std::optional<std::size_t> find_texel(const TexelMap& map, std::string_view name) {
    const auto comma = name.find(',');
    const auto x = to_number<std::size_t>(name.substr(0, comma));
    if (comma == name.npos) return x && *x < map.count() ? x : std::nullopt;
    const auto y = to_number<std::size_t>(name.substr(comma + 1));
    if (!x || !y || *x >= map.width || *y >= map.height()) return {};
    return *y * map.width + *x;
}

TexelMap rounded(TexelMap map) {
    map.basis = rounded(map.basis);
    for (Rgb& beta : map.coefficient)
        for (int c = 0; c < 3; ++c) beta[c] = round_to_half(std::min(beta[c], k_half_max));
    for (float& error : map.error) error = round_to_half(std::clamp(error, 0.f, k_half_max));
    return map;
}

std::vector<std::byte> beginning_of_map(const TexelMap& map, std::uint64_t texels) {
    Safetensors content = lobes_content(map.basis);
    content.metadata.insert(map.provenance.begin(), map.provenance.end());
    content.metadata["srbf"] = k_file_version;
    content.metadata["model"] = k_map_kind;
    content.metadata["width"] = fmt::format("{}", map.width);
    content.tensors["coefficient"] = {Type16::half, {texels, std::uint64_t(map.basis.lobes), 3}, {}};
    content.tensors["aux.error"] = {Type16::half, {texels}, {}};
    return write_safetensors(content, {"coefficient", "aux.error"});
}

std::vector<std::byte> write_map(const TexelMap& map) {
    const StandardArithmetic mode;
    std::vector<std::byte> file = beginning_of_map(map, map.count());
    const auto add = [&](float number) {
        const std::uint16_t half = to_half(std::clamp(number, 0.f, k_half_max));
        file.insert(file.end(), {std::byte(half & 0xff), std::byte(half >> 8)});
    };
    for (const Rgb& beta : map.coefficient)
        for (int c = 0; c < 3; ++c) add(beta[c]);
    for (const float error : map.error) add(error);
    return file;
}

namespace {

/// Takes the tensors of texels out of `content`, which keeps the tensors of a model with coefficients 1.
Result<Done> take_texels(Safetensors& content, TexelMap& map, const std::string& file_name) {
    auto& tensors = content.tensors;
    const auto extent = [&](const char* name) {
        const auto at = tensors.find(name);
        return at == tensors.end() || at->second.shape.empty() ? 0 : at->second.shape[0];
    };
    const std::uint64_t J = extent("bandwidth"), T = extent("coefficient");
    const auto refuse = [&](std::string expected, std::string found) {
        return Error{file_name, {}, "tensor 'coefficient'", std::move(expected), std::move(found)};
    };
    if (J == 0 || T == 0) return refuse("of shape [T, J, 3], beside J lobes", T == 0 ? "none" : "no lobes");
    std::map<std::string, Tensor16> stored;
    for (const char* name : {"coefficient", "aux.error"})
        if (auto node = tensors.extract(name)) stored.insert(std::move(node));
    const auto valid = check_tensors(
        stored, {{"coefficient", {Type16::half, {T, J, 3}}}, {"aux.error", {Type16::half, {T}}}}, file_name);
    if (!valid) return valid;
    const auto& half = stored["coefficient"].data;
    map.coefficient.resize(T * J);
    for (std::size_t i = 0; i < half.size(); ++i) {
        const float number = from_half(half[i]);
        if (number < 0) return refuse("numbers of at least 0", fmt::format("{}", number));
        map.coefficient[i / 3][int(i % 3)] = number;
    }
    for (const std::uint16_t error : stored["aux.error"].data) map.error.push_back(from_half(error));
    tensors["coefficient"] = {Type16::half, {J, 3}, std::vector<std::uint16_t>(3 * J, to_half(1.f))};
    return Done{};
}

}  // namespace

Result<TexelMap> read_map(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    auto content = read_safetensors(bytes, file_name);
    if (!content) return content.error();
    MetadataReader reader{content->metadata, file_name};
    reader.take("srbf", {k_file_version}), reader.take("model", {k_map_kind});
    if (reader.error) return *reader.error;
    if (content->tensors.contains("index"))
        return Error{file_name,
                     {},
                     "input",
                     "texels with a coefficient of each lobe",
                     "a library of version 0.1 whose materials have lobes of their own; fit each material by srbf fit",
                     ErrorCode::wrong_kind};
    TexelMap map;
    if (const auto taken = take_texels(*content, map, file_name); !taken) return taken.error();
    auto unused = content->metadata.extract("wavelengths");  // provenance, as coefficients are colours
    auto basis = Kind<PmModel>::read(*content, file_name);
    if (!basis) return basis.error();
    content->metadata.insert(std::move(unused));
    map.basis = *std::move(basis);
    map.width = map.count();
    if (auto width = content->metadata.extract("width")) {
        map.width = to_number<std::size_t>(width.mapped()).value_or(0);
        if (map.width == 0 || map.count() % map.width != 0)
            return Error{file_name, 8, "metadata 'width'", fmt::format("a divisor of {}", map.count()),
                         fmt::format("{:.40}", width.mapped())};
    }
    map.provenance = std::move(content->metadata);
    return map;
}

bool is_map_file(std::span<const std::byte> bytes) {
    const auto content = read_safetensors(bytes, "");
    if (!content) return false;
    const auto kind = content->metadata.find("model");
    return kind != content->metadata.end() && kind->second == k_map_kind;
}

}  // namespace
