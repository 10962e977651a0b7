// The interface of a kind of model, and the conditions and the result of a fit.
#pragma once
#include "base/safetensors.h"
#include "models/kind/parameters.h"

namespace SRBF_NAMESPACE {

/// A specialisation for each kind of model M, in src/models/NAME/NAME_kind.h, has
///   std::string_view name, words                       the value of `model` in its file's metadata; its name in text
///   Safetensors content(const M&)                      tensors, rounded to 16-bit floats, and metadata
///   Result<M> read(Safetensors&, const std::string& file_name)   the inverse; removes the metadata that it reads
///   double largest(const M&)                           the largest number before `content` clamps it to 65504
///   std::string summary(const M&), void add_rows(std::string& text, const M&), Parameters members(const M&),
///   Parameters parameters(const M&), std::string formula_text(const M&, const NumberText&)   as in
///                                                      models/kind/parameters.h
///   bool matches(const ParameterReader&)               true if the parameters are of this kind, by a name that no
///                                                      kind before it in `AnyModel` has
///   M from_parameters(ParameterReader&)                the inverse of `parameters`
/// A kind that is a list of numbers inherits all of these that it does not have from `KindOfNumbers` (numbers.h).
/// A kind that is fitted to observations alone also has, with R its request,
///   Result<Fitted<M>> fit(const Observations&, const R&, const FitConditions&, const ProgressToken&)
template <typename M> struct Kind;

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
