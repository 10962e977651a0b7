// JSON with rows of numbers. Private to its readers.
#pragma once
#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace SRBF_NAMESPACE {

/// Passes numbers and texts to a reader, which identifies its position by the keys of the open objects and arrays.
struct JsonRows : nlohmann::json_sax<nlohmann::json> {
    std::vector<std::string> path;  ///< the key of each open object and array
    std::string last_key, wrong;
    static constexpr std::size_t k_deepest = 64;

    /// Receives a number; null and truth values are NaN.
    virtual bool take(double x) = 0;
    virtual bool take_text(const std::string& text) = 0;
    /// Called before an object or array is opened, and before one is closed.
    virtual bool open(bool is_array) = 0;
    virtual bool close(bool is_array) = 0;
    bool refuse(std::string what) { return wrong = std::move(what), false; }

    bool null() override { return take(double(std::numeric_limits<float>::quiet_NaN())); }
    bool boolean(bool) override { return null(); }
    bool number_integer(number_integer_t x) override { return take(double(x)); }
    bool number_unsigned(number_unsigned_t x) override { return take(double(x)); }
    bool number_float(number_float_t x, const string_t&) override { return take(x); }
    bool string(string_t& text) override { return take_text(text); }
    bool binary(binary_t&) override { return refuse("bytes"); }
    bool key(string_t& text) override { return last_key = text.substr(0, 100), true; }
    bool start_object(std::size_t) override { return start(false); }
    bool end_object() override { return end(false); }
    bool start_array(std::size_t) override { return start(true); }
    bool end_array() override { return end(true); }
    bool parse_error(std::size_t offset, const std::string&, const nlohmann::detail::exception&) override {
        return refuse(fmt::format("a mistake at byte {}", offset));
    }

  private:
    bool start(bool is_array) {
        if (path.size() == k_deepest) return refuse("more than 64 levels");
        if (!open(is_array)) return false;
        path.push_back(last_key);
        return true;
    }
    bool end(bool is_array) {
        const bool continues = close(is_array);
        path.pop_back();
        return continues;
    }
};

}  // namespace
