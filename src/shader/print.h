// The syntax tree in the languages of renderers: level 4.
#pragma once
#include <map>
#include <set>
#include <string>

#include "shader/syntax.h"
#include "srbf/shading_code.h"

namespace srbf::syntax {

/// Prints definitions in one language. Names of functions, structures and tables are printed as `names` has them; those
/// of helpers, which C needs in place of operators on vectors, begin with `prefix`.
class Printer {
  public:
    Printer(CodeLanguage language, std::string prefix, std::map<std::string, std::string> names)
        : language_(language), prefix_(std::move(prefix)), names_(std::move(names)) {}

    std::string text(const Structure& structure);
    std::string text(const Table& table);
    std::string text(const Function& function);
    /// The helpers that what was printed so far calls.
    const std::set<std::string>& used() const { return used_; }

  private:
    std::string named(const std::string& name) const;
    std::string type_text(const Type& type) const;
    std::string declaration(const Type& type, const std::string& name) const;
    std::string helper(const std::string& name);
    std::string call_text(const Expression& of);
    std::string binary_text(const Expression& of, int outside);
    std::string expression_text(const Expression& of, int outside = 0);
    void print(const std::vector<Statement>& body, const std::set<std::string>& changed, int depth, std::string& to);

    CodeLanguage language_;
    std::string prefix_;
    std::map<std::string, std::string> names_;
    std::set<std::string> used_;
};

/// The definitions of those helpers, and of the vector.
std::string helpers_text(CodeLanguage language, const std::string& prefix, const std::set<std::string>& used);
/// A comment of those lines, which may hold any text.
std::string comment_text(const std::string& lines, int depth = 0);

}  // namespace srbf::syntax
