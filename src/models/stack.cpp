// Stacks of multivariate models, one for each texel.
#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/half.h"
#include "base/safetensors.h"
#include "models/lobes_file.h"
#include "models/pm/pm_kind.h"
#include "models/texel.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

std::vector<std::byte> write_stack(const ModelStack& stack) {
    const StandardArithmetic mode;
    const std::uint64_t T = stack.models.size();
    Safetensors content{{}, stack.provenance};
    content.metadata["srbf"] = k_file_version;
    content.metadata["model"] = k_stack_kind;
    for (const PmModel& model : stack.models) {
        const Safetensors of_model = lobes_content(model);
        for (const auto& [key, text] : of_model.metadata) content.metadata[key] = text;
        for (const auto& [name, tensor] : of_model.tensors) {
            Tensor16& all = content.tensors[name];
            if (all.shape.empty()) {
                all.type = tensor.type;
                all.shape.push_back(T);
                all.shape.insert(all.shape.end(), tensor.shape.begin(), tensor.shape.end());
            }
            all.data.insert(all.data.end(), tensor.data.begin(), tensor.data.end());
        }
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
    LobesHeader header;
    Metadata provenance;
    std::string file_name;

    Result<PmModel> model(std::size_t texel) const {
        std::map<std::string, Tensor16> of;
        for (const auto& [name, tensor] : tensors) {
            const std::size_t count = tensor.data.size() / state.size();
            const auto begin = tensor.data.begin() + std::ptrdiff_t(count * texel);
            of[name] = {
                tensor.type, {tensor.shape.begin() + 1, tensor.shape.end()}, {begin, begin + std::ptrdiff_t(count)}};
        }
        return decode_lobes(of, header, file_name);
    }
};

Result<StackContent> read_stack_content(std::span<const std::byte> bytes, const std::string& file_name) {
    Result<Safetensors> content = read_safetensors(bytes, file_name);
    if (!content) return content.error();
    MetadataReader reader{content->metadata, file_name};
    reader.take("srbf", {k_file_version}), reader.take("model", {k_stack_kind});
    if (reader.error) return *reader.error;
    const auto header = take_lobes_header(content->metadata, file_name);
    if (!header) return header.error();
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
            return input_error(file_name, fmt::format("tensor '{:.80}': shape", name), fmt::format("[{}, ..]", T),
                               shape_text(tensor.shape));
    StackContent stack{std::move(tensors), own["aux.state"].data, {}, *header, std::move(content->metadata), file_name};
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
        return argument_error(file_name, "texel", fmt::format("0 to {}", count - 1), fmt::format("{}", texel));
    auto model = content->model(texel);
    if (!model) return model.error();
    auto& provenance = content->provenance;
    provenance["texel"] = fmt::format("{} of {}", texel, count);
    provenance["texel_state"] = fmt::format("{}", content->state[texel]);
    provenance["texel_error"] = fmt::format("{:.4g}", content->error[texel]);
    return Model{*std::move(model), std::move(provenance)};
}

}  // namespace srbf
