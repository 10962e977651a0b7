// Reads JSON of unknown origin, with bounded depth.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace SRBF_NAMESPACE {

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
    const JsonValue* find(std::string_view name) const;
};

/// Parses `text`. Returns JSON's null if it is not valid JSON, and no value if it has more than `deepest` levels below
/// the first. The last one of equal names in an object counts.
std::optional<JsonValue> parse_json(std::string_view text, int deepest);

/// A short text of a value, for error messages. Lists with more than `k_most_listed` entries are not shown.
std::string brief_text(const JsonValue& json);
inline constexpr std::size_t k_most_listed = 8;

/// A string in quotes. Bytes that are not UTF-8, as in names of files, are replaced.
std::string json_of(const std::string& text);

}  // namespace srbf
