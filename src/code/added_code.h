// The interface by which extras add to the code of models.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "code/offered_code.h"
#include "code/syntax.h"
#include "srbf/prepared.h"
#include "srbf/shading_code.h"

namespace srbf {

/// Functions beside those of the core, for each model.
struct AddedCode {
    std::map<std::string, std::string> entries;  ///< by their names in the kernel's language: those in the code
    bool sampling = false, albedo = false;       ///< whether they call the core's functions of these
    std::string albedo_node = {};                ///< the text of that function; empty: a table's
    /// Their text, which follows albedo.glsl. Tables go into the program, and what the text calls numbers of the model
    /// into `defines`. `of_basis`: the coefficients of the model's lobes are arguments.
    std::function<std::string(const Model& model, bool of_basis, syntax::Program& program,
                              std::map<std::string, std::string>& defines)>
        text = {};
};

/// The features and modules that an extra offers.
struct CodeExtra {
    std::vector<CodeFeature> features;
    std::vector<CodeModule> modules;
    AddedCode (*functions)(const CodeOptions& options);  ///< for those of `features` that the options name
};

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& options, const AddedCode& added);
Result<std::string> map_code(const Library& map, std::string_view name, const CodeOptions& options,
                             const AddedCode& added);

/// The albedo of a node's view; the one at the horizon is that just above it.
Rgb albedo_of_node(const PreparedBrdf& brdf, double cosine);
/// Lobe j with coefficient 1.
Model lobe_alone(PmModel basis, std::size_t j);

}  // namespace srbf
