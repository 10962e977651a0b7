// The numbers of a model by their names, as they are read and checked.
#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "srbf/result.h"
#include "srbf/vec.h"

namespace [[gnu::visibility("default")]] srbf {

/// Numbers in rows, as many as the product of the shape; without a shape one number.
struct NumberArray {
    std::vector<std::size_t> shape;
    std::vector<float> numbers;
};
/// A value by its name: nothing, a flag, a whole number, a word, numbers, or values of a part.
struct Parameter;
using Parameters = std::vector<Parameter>;
struct Parameter {
    std::string name;
    std::variant<std::monostate, bool, int, std::string, NumberArray, Parameters> value;
};

struct Model;
/// The numbers of the model's formula, by the names of docs/formats.md; centres as unit vectors.
Parameters parameters(const Model& model);
/// The inverse: the model of these numbers, rounded to the 16-bit floats of its file. Centres that are so already stay as
/// they are, since angles are rounded twice where they go through vectors. Some may be left out: of a multivariate model
/// `log_scale` (0), `centre` (+z), `exponent` (none), and `form` and `axial`, which follow. Errors: a name that is missing or
/// unknown, another shape, numbers that are not finite, or out of their range; vectors that are not of length 1.
Result<Model> model_from(const Parameters& parameters, std::map<std::string, std::string> provenance = {});

/// The kind of a model in words: "surface of OpenPBR".
std::string_view kind_words(const Model& model);
/// "exchanged" of the provenance of a model of exchanged data.
inline constexpr std::string_view k_exchanged = "light and viewer of the source";
/// Describes a model in a line: "pm, form gaussian, 8 lobes, 4 variates, axial".
std::string summary(const Model& model);
/// Describes a model in rows, with its parameters, as `srbf info` prints them.
std::string rows_text(const Model& model);
/// The members that the report of its fit has of it: "form", "lobes", "variates", "axial" of every model, and others.
Parameters report_members(const Model& model);

/// Models of one term each whose sum is `model`, at most `max_count`: lobes, for a multivariate model those with the largest
/// coefficients; the diffuse term and each lobe of Lambert and GGX. The layers of a surface are not terms of a sum: the
/// result is `model`, then the surface without fuzz, then the one without fuzz and coat. For a BSDF these are the terms of
/// the front reflection.
std::vector<Model> terms_of(const Model& model, std::size_t max_count = 64);

/// The text of number x of a model in code: number `index` of that parameter; the name is empty if it follows from several.
using NumberText = std::function<std::string(float x, std::string_view parameter, std::size_t index)>;
/// Statements in the language of kernel.glsl that return a model's value for wl and wv, with its numbers in the text; the
/// host has the numbers of lobes, as `pm` or `su`. Empty for a BSDF, whose parts have such texts.
std::string formula_text(const Model& model, const NumberText& number);

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
