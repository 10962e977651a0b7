// `Kind` of BSDFs, and the tensors of their parts and beams in a model file.
#pragma once
#include "models/bsdf/bsdf_functions.h"
#include "models/kind/kind.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

/// Adds a part's tensors and metadata to `content`, with the part's name as prefix.
void add_part(const Safetensors& tensors, Part part, Safetensors& content);
/// Removes a part's tensors and metadata from `content`, and returns them without prefix.
Safetensors take_part(Safetensors& content, Part part);

/// The tensors of the beams, rounded to 16-bit floats.
std::map<std::string, Tensor16> encode_beams(const Beams& beams);
/// The inverse. Returns an error if there are other tensors or invalid numbers.
Result<Beams> decode_beams(const std::map<std::string, Tensor16>& tensors, const std::string& file_name);

// A BSDF holds models; model.cpp writes and reads them.
template <> struct Kind<BsdfModel> {
    static constexpr std::string_view name = "bsdf", words = "reflection and transmission";
    static Safetensors content(const BsdfModel& bsdf);
    static Result<BsdfModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const BsdfModel& model);
    static std::string summary(const BsdfModel& model);
    static void add_rows(std::string& text, const BsdfModel& model);
    static Parameters members(const BsdfModel& model);
    static Parameters parameters(const BsdfModel& model);
    static std::string formula_text(const BsdfModel& model, const NumberText& number);
    static bool matches(const ParameterReader& reader);
    static BsdfModel from_parameters(ParameterReader& reader);
};

}  // namespace
