// Reads the numbers of a model by their names, and checks them.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "srbf/parameters.h"
#include "srbf/vec.h"

namespace srbf {

/// Rows of vectors as an array of that shape.
template <typename T> NumberArray array_of(std::vector<std::size_t> shape, const std::vector<T>& rows) {
    const auto* numbers = reinterpret_cast<const float*>(rows.data());
    return {std::move(shape), {numbers, numbers + rows.size() * sizeof(T) / sizeof(float)}};
}

/// The inverse.
template <typename T> std::vector<T> rows_of(const std::vector<float>& numbers) {
    const auto* rows = reinterpret_cast<const T*>(numbers.data());
    return {rows, rows + numbers.size() * sizeof(float) / sizeof(T)};
}

/// Takes parameters one by one; of what is wrong the first stays, and what is then read is empty or the preset.
class ParameterReader {
  public:
    explicit ParameterReader(const Parameters& all) : all_(all) {}

    bool has(std::string_view name) const { return find(name) != nullptr; }
    /// Finite numbers of this shape, a character an axis: a digit is its length, a letter stands for the same in all arrays.
    std::vector<float> numbers(std::string_view name, std::string_view shape);
    /// An array of vectors or colours; the last axis is 3.
    template <typename T> std::vector<T> vectors(std::string_view name, std::string_view shape) {
        return rows_of<T>(numbers(name, shape));
    }
    /// Vectors of length 1, within 1e-3 of its square.
    std::vector<Vec3f> units(std::string_view name, std::string_view shape);
    std::string word(std::string_view name, const std::vector<std::string_view>& known, std::string_view preset);
    bool flag(std::string_view name, bool preset);
    int whole(std::string_view name, int least, int most, int preset);
    /// The values of a part; null if there are none.
    const Parameters* part(std::string_view name);

    /// The length for which a letter of shapes stands; 0: none was read.
    std::size_t length(char letter) const;
    void refuse(std::string_view name, std::string expected, std::string found);
    void refuse(const Error& error);
    /// The error, if any: also names that were not asked for.
    std::optional<Error> error() const;

  private:
    const Parameter* find(std::string_view name) const;
    /// The value if it is a T; null if there is none, or if it is another, which is refused.
    template <typename T> const T* value(std::string_view name, const char* expected);

    const Parameters& all_;
    std::vector<std::string> asked_;
    std::map<char, std::size_t> lengths_;
    std::optional<Error> error_;
};

}  // namespace srbf
