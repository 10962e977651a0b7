#include "srbf/library.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/floating_point.h"
#include "base/half.h"
#include "base/safetensors.h"
#include "base/text.h"
#include "models/library_file.h"
#include "models/lobes_file.h"
#include "models/pm/pm_kind.h"

namespace SRBF_NAMESPACE {
namespace {

/// `model` with the lobes of these indices only, and coefficients 0.
PmModel some_lobes(const PmModel& model, std::span<const std::size_t> which) {
    const auto N = std::size_t(model.variates), F = std::size_t(features(model.form));
    PmModel some = model;
    some.lobes = int(which.size());
    some.coefficient.assign(which.size(), {});
    some.log_scale.clear(), some.centre.clear(), some.bandwidth.clear(), some.exponent.clear();
    for (const std::size_t j : which) {
        some.log_scale.push_back(model.log_scale[j]);
        for (std::size_t n = j * N; n < (j + 1) * N; ++n)
            some.centre.push_back(model.centre[n]), some.bandwidth.push_back(model.bandwidth[n]);
        for (std::size_t k = j * F; k < (j + 1) * F; ++k) some.exponent.push_back(model.exponent[k]);
    }
    return some;
}

bool is_black(const Rgb& beta) { return !(beta.r > 0 || beta.g > 0 || beta.b > 0); }

Error wrong_tensor(const std::string& file_name, const char* tensor, std::string expected, std::string found) {
    return {file_name, {}, fmt::format("tensor '{}'", tensor), std::move(expected), std::move(found)};
}

/// Splits at line breaks; of an empty text nothing.
std::vector<std::string> lines_of(std::string_view text) {
    std::vector<std::string> lines;
    while (!text.empty()) {
        const auto end = std::min(text.find('\n'), text.size());
        lines.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

/// Takes the tensors of the materials out of `content`.
Result<Done> take_materials(Safetensors& content, Library& library, const std::string& file_name) {
    const auto at = content.tensors.find("coefficient");
    const auto J =
        content.tensors.contains("bandwidth") ? content.tensors["bandwidth"].shape : decltype(at->second.shape){};
    if (at == content.tensors.end() || at->second.shape.size() != 3 || at->second.shape[2] != 3 || J.empty())
        return wrong_tensor(file_name, "coefficient", "of shape [T, K, 3], beside lobes",
                            at == content.tensors.end() ? "none" : shape_text(at->second.shape));
    const std::uint64_t T = at->second.shape[0], K = at->second.shape[1];
    const bool sparse = content.tensors.contains("index");
    if (T == 0 || K == 0 || K > J[0] || (!sparse && K != J[0]))
        return wrong_tensor(file_name, "coefficient",
                            fmt::format("of shape [T, {}{}, 3], T at least 1", sparse ? "1 to " : "", J[0]),
                            shape_text(at->second.shape));
    std::map<std::string, TensorShape> expected{{"coefficient", {Type16::half, {T, K, 3}}},
                                                {"aux.error", {Type16::half, {T}}}};
    if (sparse) expected["index"] = {Type16::count, {T, K}};
    std::map<std::string, Tensor16> own;
    for (const auto& [name, shape] : expected)
        if (auto node = content.tensors.extract(name)) own.insert(std::move(node));
    if (const auto valid = check_tensors(own, expected, file_name); !valid) return valid.error();
    library.stored = int(K);
    if (sparse) library.index = std::move(own["index"].data);
    for (const std::uint16_t j : library.index)
        if (j >= J[0])
            return wrong_tensor(file_name, "index", fmt::format("numbers below {}", J[0]), fmt::format("{}", j));
    const auto& half = own["coefficient"].data;
    for (const std::uint16_t of : half)
        if (from_half(of) < 0)
            return wrong_tensor(file_name, "coefficient", "numbers of at least 0", fmt::format("{}", from_half(of)));
    for (std::size_t i = 0; i < half.size(); i += 3)
        library.coefficient.push_back({from_half(half[i]), from_half(half[i + 1]), from_half(half[i + 2])});
    for (const std::uint16_t of : own["aux.error"].data) library.error.push_back(from_half(of));
    Tensor16& ones = content.tensors["coefficient"] = {Type16::half, {J[0], 3}, {}};
    ones.data.assign(J[0] * 3, to_half(1.f));
    return Done{};
}

}  // namespace

Model material(const Library& library, std::size_t t) {
    const auto K = std::size_t(library.stored);
    std::vector<std::size_t> which;
    std::vector<Rgb> beta;
    for (std::size_t i = t * K; i < (t + 1) * K; ++i) {
        const Rgb& of = library.coefficient[i];
        if (!library.dense() && is_black(of) && i > t * K) continue;
        which.push_back(library.dense() ? i - t * K : library.index[i]);
        beta.push_back(of);
    }
    Model model{some_lobes(library.basis, which), library.provenance};
    std::get<PmModel>(model.model).coefficient = std::move(beta);
    model.provenance["material"] = library.names.empty() ? fmt::format("{}", t) : library.names[t];
    model.provenance["material_error"] = fmt::format("{:.4g}", library.error[t]);
    return model;
}

std::optional<std::size_t> find_material(const Library& library, std::string_view name) {
    const auto at = std::ranges::find(library.names, name);
    if (at != library.names.end()) return std::size_t(at - library.names.begin());
    if (const auto comma = name.find(','); comma != name.npos && library.width > 0) {
        const auto x = to_number<std::uint64_t>(name.substr(0, comma)),
                   y = to_number<std::uint64_t>(name.substr(comma + 1));
        if (!x || !y || *x >= library.width || *y >= library.count() / library.width) return {};
        return std::size_t(*y * library.width + *x);
    }
    const auto t = to_number<std::uint64_t>(name);
    if (!t || *t >= library.count()) return {};
    return std::size_t(*t);
}

std::size_t basis_bytes(const Library& library) {
    return payload_bytes(library.basis) - 6 * std::size_t(library.basis.lobes);
}
std::size_t material_bytes(const Library& library) { return std::size_t(library.stored) * (library.dense() ? 6 : 8); }

Library rounded(Library library) {
    library.basis = rounded(library.basis);
    for (Rgb& beta : library.coefficient)
        for (int c = 0; c < 3; ++c) beta[c] = round_to_half(std::min(beta[c], k_half_max));
    for (float& error : library.error) error = round_to_half(std::clamp(error, 0.f, k_half_max));
    return library;
}

namespace {
/// The file's content, with the shapes of the tensors of T materials, but not with their data.
Safetensors content_without_materials(const Library& library, std::uint64_t T) {
    Safetensors content = lobes_content(library.basis);
    content.metadata["srbf"] = k_file_version;
    content.metadata["model"] = k_library_kind;
    const auto K = std::uint64_t(library.stored);
    content.metadata.insert(library.provenance.begin(), library.provenance.end());
    if (!library.names.empty()) content.metadata["names"] = fmt::format("{}", fmt::join(library.names, "\n"));
    if (library.width > 0) content.metadata["width"] = fmt::format("{}", library.width);
    content.tensors["coefficient"] = {Type16::half, {T, K, 3}, {}};
    if (!library.dense()) content.tensors["index"] = {Type16::count, {T, K}, library.index};
    content.tensors["aux.error"] = {Type16::half, {T}, {}};
    return content;
}
}  // namespace

std::vector<std::byte> write_library(const Library& library) {
    const StandardArithmetic mode;
    Safetensors content = content_without_materials(library, library.count());
    auto& coefficient = content.tensors["coefficient"].data;
    for (const Rgb& beta : library.coefficient)
        for (int c = 0; c < 3; ++c) coefficient.push_back(to_half(std::min(beta[c], k_half_max)));
    for (const float of : library.error)
        content.tensors["aux.error"].data.push_back(to_half(std::clamp(of, 0.f, k_half_max)));
    return write_safetensors(content);
}

LibraryParts parts_of_library(const Library& library, std::size_t texels) {
    const Safetensors content = content_without_materials(library, texels);
    const std::vector<std::byte> bytes = write_safetensors(content);
    auto from = bytes.begin(), to = from + std::ptrdiff_t(8 + *header_length(bytes, ""));
    LibraryParts parts;
    std::vector<std::byte>* part = &parts.head;
    for (const auto& [name, tensor] : content.tensors) {
        if (tensor.data.empty()) {
            part->assign(from, to);
            part = part == &parts.head ? &parts.middle : &parts.tail, from = to;
        }
        to += std::ptrdiff_t(2 * tensor.data.size());
    }
    part->assign(from, to);
    return parts;
}

Result<Library> read_library(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    auto content = read_safetensors(bytes, file_name);
    if (!content) return content.error();
    Library library;
    if (const auto taken = take_materials(*content, library, file_name); !taken) return taken.error();
    MetadataReader reader{content->metadata, file_name};
    reader.take("srbf", {k_file_version}), reader.take("model", {k_library_kind});
    if (reader.error) return *reader.error;
    const auto header = take_lobes_header(content->metadata, file_name);
    if (!header) return header.error();
    auto basis = decode_lobes(content->tensors, *header, file_name);
    if (!basis) return basis.error();
    library.basis = *std::move(basis);
    if (auto names = content->metadata.extract("names")) {
        library.names = lines_of(names.mapped());
        if (library.names.size() != library.count())
            return Error{file_name, 8, "metadata 'names'", fmt::format("{} lines", library.count()),
                         fmt::format("{}", library.names.size())};
    }
    if (auto width = content->metadata.extract("width")) {
        library.width = to_number<std::uint64_t>(width.mapped()).value_or(0);
        if (library.width == 0 || library.count() % library.width != 0)
            return Error{file_name, 8, "metadata 'width'", fmt::format("a divisor of {}", library.count()),
                         fmt::format("{:.40}", width.mapped())};
    }
    library.provenance = std::move(content->metadata);
    return library;
}

bool is_library(std::span<const std::byte> bytes) {
    const auto content = read_safetensors(bytes, "");
    if (!content) return false;
    const auto kind = content->metadata.find("model");
    return kind != content->metadata.end() && kind->second == k_library_kind;
}

}  // namespace srbf
