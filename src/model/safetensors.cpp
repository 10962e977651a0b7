#include "model/safetensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "srbf/half.h"

namespace srbf {
namespace {

using Json = nlohmann::json;
constexpr std::uint64_t k_length_bytes = 8;
constexpr std::size_t k_most_tensors = 64;

std::uint64_t little_endian_64(std::span<const std::byte> bytes) {
    std::uint64_t x = 0;
    for (int i = 7; i >= 0; --i) x = x << 8 | std::to_integer<std::uint64_t>(bytes[std::size_t(i)]);
    return x;
}

/// A short text of a JSON value for error messages. Not recursive, since the file determines the depth.
std::string brief(const Json& json) {
    if (json.is_array() && json.size() <= 8 &&
        std::none_of(json.begin(), json.end(), [](const Json& entry) { return entry.is_structured(); })) {
        std::string list;
        for (const Json& entry : json) list += (list.empty() ? "" : ", ") + brief(entry);
        return fmt::format("[{}]", list);
    }
    return json.is_structured() ? "something else" : fmt::format("{:.40}", json.dump());
}

/// The product of a JSON shape, or nothing if an entry is not a non-negative integer or the product exceeds `most`.
std::optional<std::vector<std::uint64_t>> shape_within(const Json& json, std::uint64_t most) {
    if (!json.is_array() || json.size() > 8) return std::nullopt;
    std::vector<std::uint64_t> shape;
    std::uint64_t product = 1;
    for (const Json& entry : json) {
        if (!entry.is_number_unsigned()) return std::nullopt;
        const auto extent = entry.get<std::uint64_t>();
        if (extent == 0 || extent > most / product) return std::nullopt;
        product *= extent;
        shape.push_back(extent);
    }
    return shape;
}

constexpr const char* name_of(Type16 type) { return type == Type16::half ? "F16" : "U16"; }

}  // namespace

std::string shape_text(const std::vector<std::uint64_t>& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

Result<Done> check_tensors(const std::map<std::string, Tensor16>& tensors,
                           const std::map<std::string, TensorShape>& expected, const std::string& file_name) {
    const auto fail = [&](std::string what, std::string wanted, std::string found) {
        return Error{file_name, std::nullopt, std::move(what), std::move(wanted), std::move(found)};
    };
    for (const auto& [name, wanted] : expected) {
        const auto at = tensors.find(name);
        if (at == tensors.end()) return fail(fmt::format("tensor '{}'", name), "present", "none");
        const Tensor16& tensor = at->second;
        if (tensor.type != wanted.type)
            return fail(fmt::format("tensor '{}': dtype", name), name_of(wanted.type), name_of(tensor.type));
        if (tensor.shape != wanted.shape)
            return fail(fmt::format("tensor '{}': shape", name), shape_text(wanted.shape), shape_text(tensor.shape));
        if (tensor.type != Type16::half) continue;
        for (const std::uint16_t half : tensor.data)
            if (!std::isfinite(from_half(half)))
                return fail(fmt::format("tensor '{}'", name), "finite numbers", fmt::format("{}", from_half(half)));
    }
    for (const auto& [name, tensor] : tensors)
        if (!expected.contains(name)) return fail(fmt::format("tensor '{:.80}'", name), "none of that name", "one");
    return Done{};
}

std::vector<std::byte> write_safetensors(const Safetensors& content) {
    Json header = Json::object();
    if (!content.metadata.empty()) header["__metadata__"] = content.metadata;
    std::vector<std::byte> data;
    for (const auto& [name, tensor] : content.tensors) {
        const std::size_t begin = data.size();
        for (const std::uint16_t number : tensor.data) {
            data.push_back(std::byte(number & 0xff));
            data.push_back(std::byte(number >> 8));
        }
        header[name] = {
            {"dtype", name_of(tensor.type)}, {"shape", tensor.shape}, {"data_offsets", {begin, data.size()}}};
    }
    // Metadata contain file names, which need not be UTF-8.
    std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.append((8 - text.size() % 8) % 8, ' ');

    std::vector<std::byte> bytes;
    bytes.reserve(k_length_bytes + text.size() + data.size());
    for (unsigned i = 0; i < k_length_bytes; ++i)
        bytes.push_back(std::byte(std::uint64_t(text.size()) >> 8 * i & 0xff));
    for (const char c : text) bytes.push_back(std::byte(c));
    bytes.insert(bytes.end(), data.begin(), data.end());
    return bytes;
}

Result<Safetensors> read_safetensors(std::span<const std::byte> bytes, const std::string& file_name) {
    const auto fail = [&](std::uint64_t offset, std::string what, std::string expected, std::string found) {
        return Error{file_name, offset, std::move(what), std::move(expected), std::move(found)};
    };
    if (bytes.size() < k_length_bytes)
        return fail(0, "header length", "8 bytes", fmt::format("{} bytes", bytes.size()));
    constexpr std::string_view k_tensor_file = "tensor_file";
    if (std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).starts_with(k_tensor_file))
        return Error{
            file_name, {}, "input", "a fitted model", "a measurement (RGL tensor file)", ErrorCode::wrong_kind};
    const std::uint64_t length = little_endian_64(bytes);
    if (length > bytes.size() - k_length_bytes)
        return fail(0, "header length", fmt::format("at most {}", bytes.size() - k_length_bytes),
                    fmt::format("{}", length));

    const auto* text = reinterpret_cast<const char*>(bytes.data() + k_length_bytes);
    const Json header = Json::parse(text, text + length, nullptr, false);
    if (!header.is_object()) return fail(k_length_bytes, "header", "a JSON object", "something else");
    if (header.size() > k_most_tensors)
        return fail(k_length_bytes, "number of tensors", fmt::format("at most {}", k_most_tensors),
                    fmt::format("{}", header.size()));

    const std::span<const std::byte> data = bytes.subspan(std::size_t(k_length_bytes + length));
    Safetensors content;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
    for (const auto& [key, entry] : header.items()) {
        if (key == "__metadata__") {
            if (!entry.is_object()) return fail(k_length_bytes, "metadata", "an object of strings", "something else");
            for (const auto& [name, text_value] : entry.items()) {
                if (!text_value.is_string())
                    return fail(k_length_bytes, fmt::format("metadata {:.80}", name), "a string", "something else");
                content.metadata[name] = text_value.get<std::string>();
            }
            continue;
        }
        const std::string what = fmt::format("tensor '{:.80}'", key);
        if (!entry.is_object() || !entry.contains("dtype") || !entry.contains("shape") ||
            !entry.contains("data_offsets"))
            return fail(k_length_bytes, what, "dtype, shape and data_offsets", "one is missing");
        const Json& dtype = entry["dtype"];
        if (dtype != "F16" && dtype != "U16")
            return fail(k_length_bytes, what + ": dtype", "\"F16\" or \"U16\"", brief(dtype));
        const auto shape = shape_within(entry["shape"], data.size() / 2);
        if (!shape)
            return fail(k_length_bytes, what + ": shape", fmt::format("counts, at most {} numbers", data.size() / 2),
                        brief(entry["shape"]));
        const Json& offsets = entry["data_offsets"];
        if (!offsets.is_array() || offsets.size() != 2 || !offsets[0].is_number_unsigned() ||
            !offsets[1].is_number_unsigned())
            return fail(k_length_bytes, what + ": data_offsets", "two counts", brief(offsets));
        const auto begin = offsets[0].get<std::uint64_t>(), end = offsets[1].get<std::uint64_t>();
        std::uint64_t count = 1;
        for (const std::uint64_t extent : *shape) count *= extent;
        if (end > data.size() || begin > end || end - begin != 2 * count)
            return fail(k_length_bytes, what + ": data_offsets",
                        fmt::format("{} bytes within {}", 2 * count, data.size()), fmt::format("[{}, {}]", begin, end));
        Tensor16 tensor{dtype == "U16" ? Type16::count : Type16::half, *shape, {}};
        tensor.data.reserve(std::size_t(count));
        for (std::uint64_t at = begin; at < end; at += 2)
            tensor.data.push_back(std::uint16_t(std::to_integer<unsigned>(data[std::size_t(at)]) |
                                                std::to_integer<unsigned>(data[std::size_t(at + 1)]) << 8));
        ranges.emplace_back(begin, end);
        content.tensors.emplace(key, std::move(tensor));
    }

    std::sort(ranges.begin(), ranges.end());
    std::uint64_t covered = 0;
    for (const auto& [begin, end] : ranges) {
        if (begin != covered)
            return fail(k_length_bytes + length + covered, "data", "tensors without gap or overlap",
                        fmt::format("one that begins at {}", begin));
        covered = end;
    }
    if (covered != data.size())
        return fail(k_length_bytes + length + covered, "data", fmt::format("{} bytes", covered),
                    fmt::format("{} bytes", data.size()));
    return content;
}

}  // namespace srbf
