// The numbers of any model by their names, for programs; what people are told of it; and its formula as text.
#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

struct Model;

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

/// The numbers of the model's formula, by the names of docs/formats.md; centres as unit vectors.
Parameters parameters(const Model& model);
/// The inverse: the model of these numbers, rounded to the 16-bit floats of its file. Centres that are so already stay as
/// they are, since angles are rounded twice where they go through vectors. Some may be left out: of a multivariate model
/// `log_scale` (0), `centre` (+z), `exponent` (none), and `form` and `axial`, which follow. Errors: a name that is missing or
/// unknown, another shape, numbers that are not finite, or out of their range; vectors that are not of length 1.
Result<Model> model_from(const Parameters& parameters, std::map<std::string, std::string> provenance = {});

/// Describes a model in a line: "pm, form gaussian, 8 lobes, 4 variates, axial".
std::string summary(const Model& model);
/// Describes a model in rows, with its parameters, as `srbf info` prints them.
std::string rows_text(const Model& model);
/// The members that the report of its fit has of it: "form", "lobes", "variates", "axial" of every model, and others.
Parameters report_members(const Model& model);

/// Models of one term each whose sum is `model`, at most `most`: lobes, of a multivariate model those with the largest
/// coefficients; the diffuse term and each lobe of Lambert and GGX. Layers of a surface are no terms: `model`, then without
/// fuzz, then without a coat. Of a BSDF those of the front reflection.
std::vector<Model> terms_of(const Model& model, std::size_t most = 64);

/// The text of a number of a model in code, of x: number `index` of that parameter; if the name is empty it follows from
/// several.
using NumberText = std::function<std::string(float x, std::string_view parameter, std::size_t index)>;
/// Statements in the language of kernel.glsl that return a model's value for wl and wv, with its numbers in the text; those
/// of lobes are the host's, of `pm` or `su`. Of a BSDF none, since its parts have theirs.
std::string formula_text(const Model& model, const NumberText& number);

}  // namespace srbf
