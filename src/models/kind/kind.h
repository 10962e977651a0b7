// The interface of a kind of model, and the conditions and the result of a fit.
#pragma once
#include "base/safetensors.h"
#include "models/kind/parameters.h"

namespace SRBF_NAMESPACE {

template <typename M> struct Kind;

/// A specialisation of `Kind` for each kind of model M, in src/models/NAME/NAME_kind.h, has these static members. A
/// kind that is a list of numbers inherits all that it does not have from `KindOfNumbers` (numbers.h). A kind that is
/// fitted to observations alone also has, with R its request,
///   Result<Fitted<M>> fit(const Observations&, const R&, const FitConditions&, const ProgressToken&)
template <typename M, typename K = Kind<M>>
concept ModelKind = requires(const M& model, Safetensors& content, std::string& text, ParameterReader& reader,
                             const NumberText& number) {
    std::string_view(K::name), std::string_view(K::words);  // the value of `model` in its file's metadata; in text
    { K::content(model) } -> std::same_as<Safetensors>;     // tensors, rounded to 16-bit floats, and metadata
    { K::read(content, text) } -> std::same_as<Result<M>>;  // the inverse; removes the metadata that it reads
    { K::largest(model) } -> std::same_as<double>;          // the largest number before `content` clamps it to 65504
    { K::summary(model) } -> std::same_as<std::string>;     // this and the next four as in models/kind/parameters.h
    K::add_rows(text, model);
    { K::members(model) } -> std::same_as<Parameters>;
    { K::parameters(model) } -> std::same_as<Parameters>;
    { K::formula_text(model, number) } -> std::same_as<std::string>;
    { K::matches(reader) } -> std::same_as<bool>;       // by a name that no kind before it in `AnyModel` has
    { K::from_parameters(reader) } -> std::same_as<M>;  // the inverse of `parameters`
};

struct FitConditions {
    bool is_isotropic = true;  ///< true if the measurement is isotropic
    int threads = 0;           ///< number of threads; 0: all of the machine. The result does not depend on it
};

/// The result of a fit.
template <typename M> struct Fitted {
    M model;                    ///< every number rounded to a 16-bit float
    M unrounded;                ///< before rounding
    double loss = 0;            ///< the loss of `model`
    double unrounded_loss = 0;  ///< the loss of `unrounded`, which the fit minimises
};

/// `model` rounded as in its file. It is an error only if the model is not valid.
template <typename M> Result<M> as_stored(const M& model, const std::string& file_name = {}) {
    Safetensors content = Kind<M>::content(model);
    return Kind<M>::read(content, file_name);
}
/// A valid model, rounded as in its file.
template <typename M>
requires requires { Kind<M>::name; }
M rounded(const M& model) { return *as_stored(model); }

}  // namespace
