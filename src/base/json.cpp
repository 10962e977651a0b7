#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace SRBF_NAMESPACE {
namespace {

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

}  // namespace

const JsonValue* JsonValue::find(std::string_view name) const {
    const auto* object = get<JsonObject>();
    if (!object) return nullptr;
    const auto entry = object->find(name);
    return entry == object->end() ? nullptr : &entry->second;
}

std::optional<JsonValue> parse_json(std::string_view text, int deepest) {
    JsonBuilder builder(deepest);
    const bool is_complete = JsonLibrary::sax_parse(text.begin(), text.end(), &builder);
    if (builder.is_too_deep) return std::nullopt;
    return is_complete ? std::move(builder.value) : JsonValue();
}

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

std::string json_of(const std::string& text) {
    return JsonLibrary(text).dump(-1, ' ', false, JsonLibrary::error_handler_t::replace);
}

}  // namespace srbf
