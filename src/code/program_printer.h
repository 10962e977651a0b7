// Prints the programs of several models as one text.
#pragma once
#include <set>

#include "code/defined_names.h"
#include "code/syntax.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {

/// Names of definitions: in the kernel's language, and in the code.
using Names = std::map<std::string, std::string>;

/// The program of a model, with its name and description.
struct NamedProgram {
    std::string name, description;
    syntax::Program program;
};

/// Prints several programs, and definitions that they share once.
class ProgramPrinter {
  public:
    /// Names of shared definitions begin with `prefix`, names of other definitions with the name of their model.
    /// `entries` have names of their own.
    ProgramPrinter(std::vector<NamedProgram> programs, std::string_view prefix, CodeLanguage language, Names entries);

    /// Adds the names of all definitions that are not shared.
    Result<Done> add_names(DefinedNames& defined) const;
    std::string text() const;

  private:
    Names names(std::size_t i) const;
    /// Marks definitions that differ between models, or use such ones, as a model's own. Returns true if it marked any.
    bool separate();

    std::vector<NamedProgram> programs_;
    std::string prefix_;
    CodeLanguage language_;
    Names entries_;
    std::set<std::string> own_;  ///< definitions that are not shared
};

}  // namespace
