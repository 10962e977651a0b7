// The parameters of a model by name.
#pragma once
#include <functional>

#include "srbf/model.h"
#include "srbf/result.h"
#include "srbf/vec.h"

SRBF_BEGIN

/// An array of numbers in row-major order; a single number has an empty shape.
struct NumberArray {
    std::vector<std::size_t> shape;
    std::vector<float> numbers;
};
/// A named value: nothing, a flag, an integer, a word, numbers, or the parameters of a part.
struct Parameter;
using Parameters = std::vector<Parameter>;
struct Parameter {
    std::string name;
    std::variant<std::monostate, bool, int, std::string, NumberArray, Parameters> value;
};

/// The parameters of the model's formula, by the names of docs/formats.md; centres are unit vectors.
Parameters parameters(const Model& model);
/// The inverse of `parameters`. Rounds to the 16-bit floats of model files, except for centres that are exact already,
/// since conversion to vectors rounds their angles twice. A multivariate model may lack `log_scale` (0), `centre` (+z),
/// `exponent` (none), and `form` and `axial`, which follow from the others. Returns an error if a name is missing or
/// unknown, if a shape differs, if numbers are not finite or out of range, or if vectors do not have length 1.
Result<Model> model_from(const Parameters& parameters, std::map<std::string, std::string> provenance = {});

/// The kind of a model in words: "surface of OpenPBR".
std::string_view kind_words(const Model& model);
/// The text of "exchanged" in the provenance of a model of exchanged data.
inline constexpr std::string_view k_exchanged = "light and viewer of the source";
/// Describes a model in a line: "pm, form gaussian, 8 lobes, 4 variates, axial".
std::string summary(const Model& model);
/// Describes a model in rows, with its parameters, as `srbf info` prints them.
std::string rows_text(const Model& model);
/// The members that describe a model in the report of its fit: "form", "lobes", "variates", "axial", and others for
/// some kinds.
Parameters report_members(const Model& model);

/// Writes number x of a model in code: element `index` of `parameter`, which is empty if x depends on several.
using NumberText = std::function<std::string(float x, std::string_view parameter, std::size_t index)>;
/// Statements in the language of kernel.glsl that return a model's value for wl and wv, with its numbers. The host
/// supplies the numbers of lobes, as `pm` or `su`. Empty for a BSDF, whose parts have such texts.
std::string formula_text(const Model& model, const NumberText& number);

/// Vectors as an array of numbers with the given shape.
template <typename T> NumberArray array_of(std::vector<std::size_t> shape, const std::vector<T>& rows) {
    const auto* numbers = reinterpret_cast<const float*>(rows.data());
    return {std::move(shape), {numbers, numbers + rows.size() * sizeof(T) / sizeof(float)}};
}

/// The inverse of `array_of`.
template <typename T> std::vector<T> split_rows(const std::vector<float>& numbers) {
    const auto* rows = reinterpret_cast<const T*>(numbers.data());
    return {rows, rows + numbers.size() * sizeof(float) / sizeof(T)};
}

/// Reads parameters by name. It keeps the first error, after which results are empty or the preset.
class ParameterReader {
  public:
    explicit ParameterReader(const Parameters& all) : all_(all) {}

    bool has(std::string_view name) const { return find(name) != nullptr; }
    /// Reads finite numbers. `shape` has a character for each axis: a digit is its length, a letter stands for the same
    /// length in all arrays.
    std::vector<float> numbers(std::string_view name, std::string_view shape);
    /// Reads vectors or colours; the last axis is 3.
    template <typename T> std::vector<T> vectors(std::string_view name, std::string_view shape) {
        return split_rows<T>(numbers(name, shape));
    }
    /// Reads vectors of length 1; its square may differ by 1e-3.
    std::vector<Vec3f> units(std::string_view name, std::string_view shape);
    std::string word(std::string_view name, const std::vector<std::string_view>& known, std::string_view preset);
    bool flag(std::string_view name, bool preset);
    int integer(std::string_view name, int min, int max, int preset);
    /// The values of a part; null if there are none.
    const Parameters* part(std::string_view name);

    /// The length that a letter of shapes stands for; 0 if no array with it was read.
    std::size_t length(char letter) const;
    void refuse(std::string_view name, std::string expected, std::string found);
    void refuse(const Error& error);
    /// The first error, if any. A parameter that was not read is an error.
    std::optional<Error> error() const;

  private:
    const Parameter* find(std::string_view name) const;
    /// The value if it is a T, otherwise null; a value of another type is an error.
    template <typename T> const T* value(std::string_view name, const char* expected);

    const Parameters& all_;
    std::vector<std::string> requested_;
    std::map<char, std::size_t> lengths_;
    std::optional<Error> error_;
};

/// Returns an error if a coefficient of the model, or a reflectance of its facets, is above the largest 16-bit float,
/// 65504, which `write_model` stores instead. `source` becomes `Error::source`.
Result<Done> check_range(const Model& model, const std::string& source);

SRBF_END
