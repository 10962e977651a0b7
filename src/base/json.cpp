#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace srbf {
namespace {

using JsonLibrary = nlohmann::json;

/// Makes a value of what the library's parser finds; `false` ends it.
class JsonMaker : public nlohmann::json_sax<JsonLibrary> {
  public:
    explicit JsonMaker(int deepest) : deepest_(deepest) {}

    bool null() override { return add({}); }
    bool boolean(bool of) override { return add({of}); }
    bool number_integer(number_integer_t of) override { return add({of}); }
    bool number_unsigned(number_unsigned_t of) override { return add({of}); }
    bool number_float(number_float_t of, const string_t&) override { return add({of}); }
    bool string(string_t& of) override { return add({std::move(of)}); }
    bool binary(binary_t&) override { return false; }  // not in text
    bool start_object(std::size_t) override { return open({JsonObject()}); }
    bool key(string_t& of) override { return name_ = std::move(of), true; }
    bool end_object() override { return open_.pop_back(), true; }
    bool start_array(std::size_t) override { return open({JsonList()}); }
    bool end_array() override { return open_.pop_back(), true; }
    bool parse_error(std::size_t, const std::string&, const JsonLibrary::exception&) override { return false; }

    JsonValue value;
    bool is_too_deep = false;

  private:
    /// Puts it where it belongs; nothing, if that is too deep.
    JsonValue* put(JsonValue of) {
        is_too_deep = int(open_.size()) > deepest_;
        if (is_too_deep) return nullptr;
        if (open_.empty()) return &(value = std::move(of));
        if (auto* list = open_.back()->get<JsonList>()) return &list->emplace_back(std::move(of));
        return &((*open_.back()->get<JsonObject>())[std::move(name_)] = std::move(of));
    }
    bool add(JsonValue of) { return put(std::move(of)) != nullptr; }
    bool open(JsonValue of) {
        open_.push_back(put(std::move(of)));
        return open_.back() != nullptr;
    }

    int deepest_;
    std::vector<JsonValue*> open_;  ///< the value, an entry of it, an entry of that, ...: only to the last is added
    std::string name_;
};

}  // namespace

const JsonValue* JsonValue::find(std::string_view name) const {
    const auto* object = get<JsonObject>();
    if (!object) return nullptr;
    const auto at = object->find(name);
    return at == object->end() ? nullptr : &at->second;
}

std::optional<JsonValue> parse_json(std::string_view text, int deepest) {
    JsonMaker maker(deepest);
    const bool is_whole = JsonLibrary::sax_parse(text.begin(), text.end(), &maker);
    if (maker.is_too_deep) return std::nullopt;
    return is_whole ? std::move(maker.value) : JsonValue();
}

std::string brief(const JsonValue& json) {
    constexpr std::size_t k_longest = 40;
    const auto shown = [](const auto& of) -> std::string {
        using T = std::decay_t<decltype(of)>;
        if constexpr (std::is_same_v<T, std::monostate>) return "null";
        if constexpr (std::is_same_v<T, std::string>) return json_of(of);
        if constexpr (std::is_arithmetic_v<T>) return fmt::format("{}", of);
        return "something else";
    };
    if (const auto* list = json.get<JsonList>()) {
        const bool is_shown = list->size() <= k_most_brief && std::ranges::none_of(*list, [](const JsonValue& entry) {
                                  return entry.get<JsonList>() || entry.get<JsonObject>();
                              });
        if (!is_shown) return "something else";
        std::vector<std::string> entries;
        for (const JsonValue& entry : *list) entries.push_back(brief(entry));
        return fmt::format("[{}]", fmt::join(entries, ", "));
    }
    return std::visit(shown, json.content).substr(0, k_longest);
}

std::string json_of(const std::string& text) {
    return JsonLibrary(text).dump(-1, ' ', false, JsonLibrary::error_handler_t::replace);
}

}  // namespace srbf
