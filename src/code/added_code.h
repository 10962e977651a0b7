// The interface by which extras add functions to the code of models.
#pragma once
#include "code/offered_code.h"
#include "code/syntax.h"
#include "srbf/prepared.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {

/// Functions that an extra adds to the code of each model.
struct AddedCode {
    std::map<std::string, std::string> entries;  ///< names in the kernel's language, and in the code
    bool sampling = false, albedo = false;       ///< true if the functions call the core's functions for these
    /// Changes the specialised program, whose functions these call; null: it is printed as it is.
    void (*rewrite)(syntax::Program& program, const std::vector<std::string>& roots) = nullptr;
    std::string albedo_node = {};  ///< the text of `albedo_node`; empty for one that reads a table
    /// The text of the functions, which follows albedo.glsl. It adds its tables to `program`, and its numbers of the
    /// model to `defines`. If `is_basis`, the lobes' coefficients are arguments, and those of `model` are their means.
    std::function<std::string(const Model& model, bool is_basis, syntax::Program& program,
                              std::map<std::string, std::string>& defines)>
        text = {};
};

struct CodeExtra {
    std::vector<CodeFeature> features;
    std::vector<CodeModule> modules;
    AddedCode (*functions)(const CodeOptions& options);  ///< the functions of the features that the options name
};

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& options, const AddedCode& added);
Result<std::string> map_code(const TexelMap& map, std::string_view name, const CodeOptions& options,
                             const AddedCode& added);

/// The albedo for the view of a node; at the horizon, for a view just above it.
Rgb albedo_of_node(const PreparedBrdf& brdf, double cosine);

}  // namespace
