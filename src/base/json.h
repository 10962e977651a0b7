// JSON of files of unknown origin, of bounded depth.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace srbf {

struct JsonValue;
using JsonList = std::vector<JsonValue>;
using JsonObject = std::map<std::string, JsonValue, std::less<>>;

/// A value of JSON; nothing: null. Unlike that of nlohmann's trees its destructor needs no memory, and cannot fail.
struct JsonValue {
    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, JsonList, JsonObject> content;

    /// Its content if that is a T; a number that is whole and not negative is a std::uint64_t.
    template <typename T> T* get() { return std::get_if<T>(&content); }
    template <typename T> const T* get() const { return std::get_if<T>(&content); }
    /// The entry of that name, if it is an object that has one.
    const JsonValue* find(std::string_view name) const;
};

/// The value that `text` holds; null where it is not JSON. Nothing where it has more than `deepest` levels below the
/// first. Of equal names the last one counts.
std::optional<JsonValue> parse_json(std::string_view text, int deepest);

/// A short text of a value, for error messages.
std::string brief(const JsonValue& json);
inline constexpr std::size_t k_most_brief = 8;  ///< entries of a list that is shown

/// A string in quotes; what is not UTF-8 in it, as in names of files, is replaced.
std::string json_of(const std::string& text);

}  // namespace srbf
