// The syntax tree in the languages of renderers.
#pragma once
#include <map>
#include <set>
#include <string>

#include "code/syntax.h"
#include "srbf/shading_code.h"

namespace srbf::syntax {

struct Language;

/// Prints definitions in one language. Names of functions, structures and tables are printed as `names` has them.
class Printer {
  public:
    Printer(CodeLanguage language, std::map<std::string, std::string> names);

    std::string text(const Structure& structure);
    std::string text(const Table& table);
    std::string text(const Function& function);

  private:
    std::string named(const std::string& name) const;
    std::string type_text(const Type& type) const;
    std::string declaration(const Type& type, const std::string& name) const;
    std::string call_text(const Expression& of);
    std::string binary_text(const Expression& of, int outside);
    std::string expression_text(const Expression& of, int outside = 0);
    void print(const std::vector<Statement>& body, const std::set<std::string>& changed, int depth, std::string& to);

    const Language& language_;
    std::map<std::string, std::string> names_;
};

/// A file of printed definitions: how it is used, with a `list` of its functions, then what they require in that
/// language (in C a vector and functions in place of operators on it, the same ones in every file).
std::string whole_text(CodeLanguage language, const std::string& list, std::string guard,
                       const std::string& definitions);
/// True if a function without parameters may read numbers that the host supplies.
bool reads_buffers(CodeLanguage language);
/// The shortest digits that read as the same float, with a decimal point.
std::string digits(float number);
/// A comment of those lines, which may hold any text.
std::string comment_text(const std::string& lines, int depth = 0);

}  // namespace srbf::syntax
