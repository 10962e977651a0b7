#include "base/safetensors.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/half.h"
#include "base/text.h"

namespace SRBF_NAMESPACE {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t k_length_bytes = 8;
constexpr std::size_t k_max_tensors = 64, k_max_extents = 8;
constexpr std::uint64_t k_max_header_bytes = std::uint64_t(1) << 20;
constexpr int k_deepest = 3;  ///< levels of JSON in a header: the numbers of a shape are deepest

/// The entries of a header, from the events of nlohmann's parser, and the members of each as texts. (Values of
/// nlohmann's need memory where they are destroyed.) The last one of equal names in an object counts.
class HeaderReader : public nlohmann::json_sax<Json> {
  public:
    struct Entry {
        bool is_object = false;
        std::map<std::string, std::string, std::less<>> members = {};
    };
    std::map<std::string, Entry> entries;
    bool is_object = false, is_too_deep = false;

    bool null() override { return add("null"); }
    bool boolean(bool x) override { return add(x ? "true" : "false"); }
    bool number_integer(number_integer_t x) override { return add(std::to_string(x)); }
    bool number_unsigned(number_unsigned_t x) override { return add(std::to_string(x)); }
    bool number_float(number_float_t, const string_t& text) override { return add(text); }
    bool string(string_t& text) override { return add('"' + text + '"'); }
    bool binary(binary_t&) override { return false; }  // does not occur in text
    bool start_object(std::size_t) override { return open(true); }
    bool key(string_t& name) override {
        if (depth_ <= 2) (depth_ == 1 ? entry_ : member_) = std::move(name);
        return true;
    }
    bool end_object() override { return --depth_ >= 0; }
    bool start_array(std::size_t) override { return open(false); }
    bool end_array() override {
        if (--depth_ == 2) entries[entry_].members[member_] += ']';
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const Json::exception&) override { return is_object = false; }

  private:
    bool add(const std::string& text) {
        is_too_deep = depth_ > k_deepest;
        if (depth_ == 1) entries[entry_] = {};
        if (depth_ == 2) entries[entry_].members[member_] = text;
        if (depth_ == 3) {
            std::string& list = entries[entry_].members[member_];
            list += (list == "[" ? "" : ", ") + text;
        }
        return !is_too_deep;
    }
    bool open(bool as_object) {
        if (!add(as_object ? "an object" : depth_ == 2 ? "[" : "a list")) return false;
        if (depth_ == 0) is_object = as_object;
        if (depth_ == 1) entries[entry_].is_object = as_object, member_.clear();
        return ++depth_ > 0;
    }

    int depth_ = 0;  ///< lists and objects that have not ended
    std::string entry_, member_;
};

/// A string in quotes. Bytes that are not UTF-8, as in names of files, are replaced.
std::string json_of(const std::string& text) { return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace); }

std::uint64_t little_endian_64(std::span<const std::byte> bytes) {
    std::uint64_t x = 0;
    for (int i = 7; i >= 0; --i) x = x << 8 | std::to_integer<std::uint64_t>(bytes[std::size_t(i)]);
    return x;
}

/// The counts in the text of a list, no more than extents of a shape; no value for any other text.
std::optional<std::vector<std::uint64_t>> counts_in(std::string_view text) {
    if (!text.starts_with('[')) return {};
    std::vector<std::uint64_t> counts;
    for (auto word = next_word(text, "[, ]"); !word.empty(); word = next_word(text, "[, ]")) {
        const auto count = to_number<std::uint64_t>(word);
        if (!count || counts.size() == k_max_extents) return {};
        counts.push_back(*count);
    }
    return counts;
}

constexpr const char* name_of(Type16 type) { return type == Type16::half ? "F16" : "U16"; }

Result<std::map<std::string, HeaderReader::Entry>> parse_header(std::string_view text, const std::string& file_name) {
    const auto refuse = [&](const char* what, std::string expected, std::string found) {
        return Error{file_name, k_length_bytes, what, std::move(expected), std::move(found)};
    };
    HeaderReader header;
    const bool is_complete = Json::sax_parse(text.begin(), text.end(), &header);
    if (header.is_too_deep) return refuse("header", fmt::format("at most {} levels of JSON", k_deepest), "more");
    if (!is_complete || !header.is_object) return refuse("header", "a JSON object", "something else");
    if (header.entries.size() > k_max_tensors)
        return refuse("number of tensors", fmt::format("at most {}", k_max_tensors),
                      fmt::format("{}", header.entries.size()));
    return std::move(header.entries);
}

Result<Metadata> read_metadata(const HeaderReader::Entry& entry, const std::string& file_name) {
    if (!entry.is_object) return Error{file_name, k_length_bytes, "metadata", "an object of strings", "something else"};
    Metadata metadata;
    for (const auto& [name, text] : entry.members) {
        if (!text.starts_with('"'))
            return Error{file_name, k_length_bytes, fmt::format("metadata {:.80}", name), "a string", "something else"};
        metadata[name] = text.substr(1, text.size() - 2);
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
Result<LocatedTensor> read_tensor(const std::string& name, const HeaderReader::Entry& entry,
                                  std::span<const std::byte> data, const std::string& file_name) {
    const auto refuse = [&](const char* part, std::string expected, std::string found) {
        return Error{file_name, k_length_bytes, fmt::format("tensor '{:.80}'{}", name, part), std::move(expected),
                     std::move(found)};
    };
    const auto text = [&](std::string_view member) {
        const auto found = entry.members.find(member);
        return found == entry.members.end() ? std::string() : found->second;
    };
    const std::string dtype = text("dtype"), extents = text("shape"), offsets = text("data_offsets");
    if (dtype.empty() || extents.empty() || offsets.empty())
        return refuse("", "dtype, shape and data_offsets", "one is missing");
    constexpr std::size_t k_longest = 40;
    if (dtype != "\"F16\"" && dtype != "\"U16\"")
        return refuse(": dtype", "\"F16\" or \"U16\"", dtype.substr(0, k_longest));
    const auto shape = counts_in(extents), ends = counts_in(offsets);
    std::uint64_t left = data.size() / 2;  // over the extents so far
    const bool fits =
        shape && std::ranges::all_of(*shape, [&](std::uint64_t extent) { return extent > 0 && (left /= extent) > 0; });
    if (!fits)
        return refuse(": shape", fmt::format("counts, at most {} numbers", data.size() / 2),
                      extents.substr(0, k_longest));
    if (!ends || ends->size() != 2) return refuse(": data_offsets", "two counts", offsets.substr(0, k_longest));
    const Range range{(*ends)[0], (*ends)[1]};
    const auto size = std::accumulate(shape->begin(), shape->end(), std::uint64_t(2), std::multiplies());
    if (range.end > data.size() || range.begin > range.end || range.end - range.begin != size)
        return refuse(": data_offsets", fmt::format("{} bytes within {}", size, data.size()),
                      fmt::format("[{}, {}]", range.begin, range.end));
    Tensor16 tensor{dtype == "\"U16\"" ? Type16::count : Type16::half, *shape, {}};
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
                        max = std::min<std::uint64_t>(bytes.size() - k_length_bytes, k_max_header_bytes);
    if (length <= max) return length;
    return Error{file_name, 0, "header length", fmt::format("at most {}", max), fmt::format("{}", length)};
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

Result<Shape2> shape_of_bandwidths(const std::map<std::string, Tensor16>& tensors, Shape2 min, Shape2 max,
                                   const std::string& expected, const std::string& file_name) {
    const auto bandwidth = tensors.find("bandwidth");
    if (bandwidth == tensors.end()) return Error{file_name, {}, "tensor 'bandwidth'", "present", "none"};
    const auto& shape = bandwidth->second.shape;
    if (shape.size() == 2 && shape[0] >= min[0] && shape[1] >= min[1] && shape[0] <= max[0] && shape[1] <= max[1])
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

}  // namespace
