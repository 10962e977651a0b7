// The interface of a kind of model to the library and to fronts, and what its fit is given and gives.
#pragma once
#include "base/parameters.h"
#include "base/safetensors.h"

namespace srbf {

/// A specialisation for each kind of model M, in src/models/NAME/NAME_kind.h, has
///   std::string_view name, words                       the metadata `model` of its file, and what people call it
///   Safetensors content(const M&)                      its tensors, of numbers rounded to 16-bit floats, and metadata
///   Result<M> read(Safetensors&, const std::string& file_name)   the inverse, which takes its metadata out of all
///   double largest(const M&)                           the largest of the numbers that `content` clamps to 65504
///   std::string summary(const M&), void add_rows(std::string& text, const M&), Parameters members(const M&),
///   Parameters parameters(const M&), std::vector<Model> terms(const M&, std::size_t most),
///   std::string formula_text(const M&, const NumberText&)   as in base/parameters.h
///   void for_members(M&, const Each& each)             calls each(member) for all members, for exact copies as bytes
///   const char* not_for_radiance                       what it is, unless src/code/radiance.cpp has its formula
///   bool is_of(const ParameterReader&), M made_of(ParameterReader&)   whether parameters are its own, by a name that no kind
///                                                      before it in `AnyModel` has; and the inverse of `parameters`
/// and unless it is fitted to more than observations, with R the request for it
///   Result<Fitted<M>> fit(const Observations&, const R&, const FitConditions&, const ProgressToken&)
template <typename M> struct Kind;

struct FitConditions {
    bool is_isotropic = true;  ///< what was measured
    int threads = 0;           ///< 0: as many as the machine has; the result does not depend on it
};

/// A model of a fit.
template <typename M> struct Fitted {
    M model;                    ///< every number rounded to a 16-bit float
    M unrounded;                ///< before rounding
    double loss = 0;            ///< of `model`: what the fit minimises
    double unrounded_loss = 0;  ///< of `unrounded`
};

/// `model` as its file has it.
template <typename M> M as_stored(const M& model) {
    Safetensors content = Kind<M>::content(model);
    return *Kind<M>::read(content, "");  // a valid model can be encoded
}

}  // namespace srbf
