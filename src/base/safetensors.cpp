#include "base/safetensors.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <variant>

#include "base/half.h"
#include "base/text.h"

namespace SRBF_NAMESPACE {
namespace {

struct JsonValue;
using JsonList = std::vector<JsonValue>;
using JsonObject = std::map<std::string, JsonValue, std::less<>>;

/// A value of JSON; std::monostate is null. Its destructor needs no memory, unlike nlohmann's, and cannot fail.
struct JsonValue {
    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, JsonList, JsonObject> content;

    /// The content if it is a T, otherwise null. A non-negative integer is a std::uint64_t.
    template <typename T> T* get() { return std::get_if<T>(&content); }
    template <typename T> const T* get() const { return std::get_if<T>(&content); }
    /// The entry of that name, or null if there is none or the value is not an object.
    const JsonValue* find(std::string_view name) const {
        const auto* object = get<JsonObject>();
        const auto entry = object ? object->find(name) : JsonObject::const_iterator();
        return object && entry != object->end() ? &entry->second : nullptr;
    }
};

using JsonLibrary = nlohmann::json;

/// Builds a value from the events of nlohmann's parser. A function that returns false stops the parser.
class JsonBuilder : public nlohmann::json_sax<JsonLibrary> {
  public:
    explicit JsonBuilder(int deepest) : deepest_(deepest) {}

    bool null() override { return add({}); }
    bool boolean(bool x) override { return add({x}); }
    bool number_integer(number_integer_t x) override { return add({x}); }
    bool number_unsigned(number_unsigned_t x) override { return add({x}); }
    bool number_float(number_float_t x, const string_t&) override { return add({x}); }
    bool string(string_t& text) override { return add({std::move(text)}); }
    bool binary(binary_t&) override { return false; }  // does not occur in text
    bool start_object(std::size_t) override { return open({JsonObject()}); }
    bool key(string_t& name) override { return name_ = std::move(name), true; }
    bool end_object() override { return open_.pop_back(), true; }
    bool start_array(std::size_t) override { return open({JsonList()}); }
    bool end_array() override { return open_.pop_back(), true; }
    bool parse_error(std::size_t, const std::string&, const JsonLibrary::exception&) override { return false; }

    JsonValue value;
    bool is_too_deep = false;

  private:
    /// Adds an entry to the innermost open list or object. Returns null if that is too deep.
    JsonValue* insert(JsonValue entry) {
        is_too_deep = int(open_.size()) > deepest_;
        if (is_too_deep) return nullptr;
        if (open_.empty()) return &(value = std::move(entry));
        if (auto* list = open_.back()->get<JsonList>()) return &list->emplace_back(std::move(entry));
        return &((*open_.back()->get<JsonObject>())[std::move(name_)] = std::move(entry));
    }
    bool add(JsonValue entry) { return insert(std::move(entry)) != nullptr; }
    bool open(JsonValue entry) {
        open_.push_back(insert(std::move(entry)));
        return open_.back() != nullptr;
    }

    int deepest_;
    std::vector<JsonValue*> open_;  ///< lists and objects that have not ended, from the outermost
    std::string name_;
};

/// Parses `text`. Returns JSON's null if it is not valid JSON, and no value if it has more than `deepest` levels below
/// the first. The last one of equal names in an object counts.
std::optional<JsonValue> parse_json(std::string_view text, int deepest) {
    JsonBuilder builder(deepest);
    const bool is_complete = JsonLibrary::sax_parse(text.begin(), text.end(), &builder);
    if (builder.is_too_deep) return std::nullopt;
    return is_complete ? std::move(builder.value) : JsonValue();
}

/// A string in quotes. Bytes that are not UTF-8, as in names of files, are replaced.
std::string json_of(const std::string& text) {
    return JsonLibrary(text).dump(-1, ' ', false, JsonLibrary::error_handler_t::replace);
}

/// A short text of a value, for error messages. Lists with more than `k_most_listed` entries are not shown.
constexpr std::size_t k_most_listed = 8;
std::string brief_text(const JsonValue& json) {
    constexpr std::size_t k_longest = 40;
    const auto text_of = [](const auto& content) -> std::string {
        using T = std::decay_t<decltype(content)>;
        if constexpr (std::is_same_v<T, std::monostate>) return "null";
        if constexpr (std::is_same_v<T, std::string>) return json_of(content);
        if constexpr (std::is_arithmetic_v<T>) return fmt::format("{}", content);
        return "something else";
    };
    if (const auto* list = json.get<JsonList>()) {
        const bool is_shown = list->size() <= k_most_listed && std::ranges::none_of(*list, [](const JsonValue& entry) {
                                  return entry.get<JsonList>() || entry.get<JsonObject>();
                              });
        if (!is_shown) return "something else";
        std::vector<std::string> entries;
        for (const JsonValue& entry : *list) entries.push_back(brief_text(entry));
        return fmt::format("[{}]", fmt::join(entries, ", "));
    }
    return std::visit(text_of, json.content).substr(0, k_longest);
}

constexpr std::uint64_t k_length_bytes = 8;
constexpr std::size_t k_most_tensors = 64;
constexpr std::uint64_t k_most_header_bytes = std::uint64_t(1) << 20;
constexpr int k_deepest = 3;  ///< levels of JSON in a header: the numbers of a shape are deepest

std::uint64_t little_endian_64(std::span<const std::byte> bytes) {
    std::uint64_t x = 0;
    for (int i = 7; i >= 0; --i) x = x << 8 | std::to_integer<std::uint64_t>(bytes[std::size_t(i)]);
    return x;
}

/// Reads the extents of a shape. No value if one is not a positive integer or their product exceeds `most`.
std::optional<std::vector<std::uint64_t>> shape_within(const JsonValue& json, std::uint64_t most) {
    const auto* entries = json.get<JsonList>();
    if (!entries || entries->size() > k_most_listed) return std::nullopt;
    std::vector<std::uint64_t> shape;
    std::uint64_t product = 1;
    for (const JsonValue& entry : *entries) {
        const auto* extent = entry.get<std::uint64_t>();
        if (!extent || *extent == 0 || *extent > most / product) return std::nullopt;
        product *= *extent;
        shape.push_back(*extent);
    }
    return shape;
}

constexpr const char* name_of(Type16 type) { return type == Type16::half ? "F16" : "U16"; }

Result<JsonObject> parse_header(std::string_view text, const std::string& file_name) {
    auto header = parse_json(text, k_deepest);
    if (!header)
        return Error{file_name, k_length_bytes, "header", fmt::format("at most {} levels of JSON", k_deepest), "more"};
    auto* object = header->get<JsonObject>();
    if (!object) return Error{file_name, k_length_bytes, "header", "a JSON object", "something else"};
    if (object->size() > k_most_tensors)
        return Error{file_name, k_length_bytes, "number of tensors", fmt::format("at most {}", k_most_tensors),
                     fmt::format("{}", object->size())};
    return std::move(*object);
}

Result<std::map<std::string, std::string>> read_metadata(const JsonValue& entry, const std::string& file_name) {
    const auto* object = entry.get<JsonObject>();
    if (!object) return Error{file_name, k_length_bytes, "metadata", "an object of strings", "something else"};
    std::map<std::string, std::string> metadata;
    for (const auto& [name, value] : *object) {
        const auto* text = value.get<std::string>();
        if (!text)
            return Error{file_name, k_length_bytes, fmt::format("metadata {:.80}", name), "a string", "something else"};
        metadata[name] = *text;
    }
    return metadata;
}

/// The bytes of a tensor within the data.
struct Range {
    std::uint64_t begin, end;
    friend auto operator<=>(const Range&, const Range&) = default;
};

struct LocatedTensor {
    Range range;
    Tensor16 tensor;
};

/// Reads the tensor `name`, which `entry` of the header describes, from `data`.
Result<LocatedTensor> read_tensor(const std::string& name, const JsonValue& entry, std::span<const std::byte> data,
                                  const std::string& file_name) {
    const auto refuse = [&](const char* part, std::string expected, std::string found) {
        return Error{file_name, k_length_bytes, fmt::format("tensor '{:.80}'{}", name, part), std::move(expected),
                     std::move(found)};
    };
    const JsonValue *dtype = entry.find("dtype"), *extents = entry.find("shape"), *offsets = entry.find("data_offsets");
    if (!dtype || !extents || !offsets) return refuse("", "dtype, shape and data_offsets", "one is missing");
    const auto* type = dtype->get<std::string>();
    if (!type || (*type != name_of(Type16::half) && *type != name_of(Type16::count)))
        return refuse(": dtype", "\"F16\" or \"U16\"", brief_text(*dtype));
    const auto shape = shape_within(*extents, data.size() / 2);
    if (!shape)
        return refuse(": shape", fmt::format("counts, at most {} numbers", data.size() / 2), brief_text(*extents));
    const auto* ends = offsets->get<JsonList>();
    const auto* begin = ends && ends->size() == 2 ? (*ends)[0].get<std::uint64_t>() : nullptr;
    const auto* end = begin ? (*ends)[1].get<std::uint64_t>() : nullptr;
    if (!end) return refuse(": data_offsets", "two counts", brief_text(*offsets));
    const Range range{*begin, *end};
    const auto size = std::accumulate(shape->begin(), shape->end(), std::uint64_t(2), std::multiplies());
    if (range.end > data.size() || range.begin > range.end || range.end - range.begin != size)
        return refuse(": data_offsets", fmt::format("{} bytes within {}", size, data.size()),
                      fmt::format("[{}, {}]", range.begin, range.end));
    Tensor16 tensor{*type == name_of(Type16::count) ? Type16::count : Type16::half, *shape, {}};
    tensor.data.reserve(std::size_t(size / 2));
    for (std::uint64_t i = range.begin; i < range.end; i += 2)
        tensor.data.push_back(std::uint16_t(std::to_integer<unsigned>(data[std::size_t(i)]) |
                                            std::to_integer<unsigned>(data[std::size_t(i + 1)]) << 8));
    return LocatedTensor{range, std::move(tensor)};
}

/// Returns an error unless the ranges cover all `size` bytes of the data, which begin at `data_offset` in the file.
Result<Done> check_covered(std::vector<Range> ranges, std::uint64_t size, std::uint64_t data_offset,
                           const std::string& file_name) {
    std::sort(ranges.begin(), ranges.end());
    std::uint64_t covered = 0;
    for (const Range& range : ranges) {
        if (range.begin != covered)
            return Error{file_name, data_offset + covered, "data", "tensors without gap or overlap",
                         fmt::format("one that begins at {}", range.begin)};
        covered = range.end;
    }
    if (covered == size) return Done{};
    return Error{file_name, data_offset + covered, "data", fmt::format("{} bytes", covered),
                 fmt::format("{} bytes", size)};
}

}  // namespace

Result<std::uint64_t> header_length(std::span<const std::byte> bytes, const std::string& file_name) {
    if (bytes.size() < k_length_bytes)
        return Error{file_name, 0, "header length", "8 bytes", fmt::format("{} bytes", bytes.size())};
    if (as_text(bytes).starts_with("tensor_file"))
        return Error{
            file_name, {}, "input", "a fitted model", "a measurement (RGL tensor file)", ErrorCode::wrong_kind};
    const std::uint64_t length = little_endian_64(bytes),
                        most = std::min<std::uint64_t>(bytes.size() - k_length_bytes, k_most_header_bytes);
    if (length <= most) return length;
    return Error{file_name, 0, "header length", fmt::format("at most {}", most), fmt::format("{}", length)};
}

std::string shape_text(const std::vector<std::uint64_t>& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

Result<Done> check_tensors(const std::map<std::string, Tensor16>& tensors,
                           const std::map<std::string, TensorShape>& expected, const std::string& file_name) {
    const auto fail = [&](std::string what, std::string wanted, std::string found) {
        return Error{file_name, std::nullopt, std::move(what), std::move(wanted), std::move(found)};
    };
    for (const auto& [name, wanted] : expected) {
        const auto entry = tensors.find(name);
        if (entry == tensors.end()) return fail(fmt::format("tensor '{}'", name), "present", "none");
        const Tensor16& tensor = entry->second;
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

Result<Shape2> shape_of_bandwidths(const std::map<std::string, Tensor16>& tensors, Shape2 least, Shape2 most,
                                   const std::string& expected, const std::string& file_name) {
    const auto bandwidth = tensors.find("bandwidth");
    if (bandwidth == tensors.end()) return Error{file_name, {}, "tensor 'bandwidth'", "present", "none"};
    const auto& shape = bandwidth->second.shape;
    if (shape.size() == 2 && shape[0] >= least[0] && shape[1] >= least[1] && shape[0] <= most[0] && shape[1] <= most[1])
        return Shape2{shape[0], shape[1]};
    return Error{file_name, {}, "tensor 'bandwidth': shape", expected, shape_text(shape)};
}

std::vector<std::byte> write_safetensors(const Safetensors& content, const std::vector<std::string>& last) {
    std::vector<std::string> names;
    for (const auto& [name, tensor] : content.tensors)
        if (std::ranges::find(last, name) == last.end()) names.push_back(name);
    names.insert(names.end(), last.begin(), last.end());
    std::map<std::string, std::string> header;
    if (!content.metadata.empty()) {
        std::vector<std::string> entries;
        for (const auto& [name, text] : content.metadata) entries.push_back(json_of(name) + ":" + json_of(text));
        header["__metadata__"] = fmt::format("{{{}}}", fmt::join(entries, ","));
    }
    std::uint64_t end = 0;
    for (const std::string& name : names) {
        const Tensor16& tensor = content.tensors.at(name);
        const std::uint64_t begin = end;
        end += std::accumulate(tensor.shape.begin(), tensor.shape.end(), std::uint64_t(2), std::multiplies());
        header[name] = fmt::format(R"({{"data_offsets":[{},{}],"dtype":"{}","shape":[{}]}})", begin, end,
                                   name_of(tensor.type), fmt::join(tensor.shape, ","));
    }
    std::string text = "{";
    for (const auto& [name, entry] : header)
        text += fmt::format("{}{}:{}", text.size() > 1 ? "," : "", json_of(name), entry);
    text += "}";
    text.append((8 - text.size() % 8) % 8, ' ');

    std::vector<std::byte> bytes;
    bytes.reserve(k_length_bytes + text.size() + end);
    for (unsigned i = 0; i < k_length_bytes; ++i)
        bytes.push_back(std::byte(std::uint64_t(text.size()) >> 8 * i & 0xff));
    for (const char c : text) bytes.push_back(std::byte(c));
    for (const auto& [name, tensor] : content.tensors)
        for (const std::uint16_t number : tensor.data) {
            bytes.push_back(std::byte(number & 0xff));
            bytes.push_back(std::byte(number >> 8));
        }
    return bytes;
}

Result<Safetensors> read_safetensors(std::span<const std::byte> bytes, const std::string& file_name) {
    const auto length = header_length(bytes, file_name);
    if (!length) return length.error();
    const auto header = parse_header(as_text(bytes).substr(k_length_bytes, std::size_t(*length)), file_name);
    if (!header) return header.error();
    const std::uint64_t data_offset = k_length_bytes + *length;
    const std::span<const std::byte> data = bytes.subspan(std::size_t(data_offset));
    Safetensors content;
    std::vector<Range> ranges;
    for (const auto& [key, entry] : *header) {
        if (key == "__metadata__") {
            auto metadata = read_metadata(entry, file_name);
            if (!metadata) return metadata.error();
            content.metadata = *std::move(metadata);
            continue;
        }
        auto located = read_tensor(key, entry, data, file_name);
        if (!located) return located.error();
        ranges.push_back(located->range);
        content.tensors.emplace(key, std::move(located->tensor));
    }
    if (const auto covered = check_covered(std::move(ranges), data.size(), data_offset, file_name); !covered)
        return covered.error();
    return content;
}

std::string MetadataReader::take(const char* key, const std::vector<std::string_view>& known) {
    const auto entry = metadata.find(key);
    const std::string found = entry == metadata.end() ? "" : entry->second;
    if (std::ranges::find(known, found) == known.end()) {
        if (!error)
            error = {file_name, k_length_bytes, fmt::format("metadata '{}'", key),
                     fmt::format("{}", fmt::join(known, " or ")),
                     entry == metadata.end() ? "none" : fmt::format("{:.40}", found)};
    } else {
        metadata.erase(entry);
    }
    return found;
}

}  // namespace srbf
