// Prints the syntax tree in the languages of renderers.
#pragma once
#include <initializer_list>
#include <set>

#include "code/syntax.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE::syntax {

struct Language;

/// The condition that no component of these directions is a NaN or infinite, which C finds by their bits.
std::string are_finite(CodeLanguage language, std::initializer_list<std::string_view> directions);

/// Prints definitions in one language. `names` maps names of functions, structures and tables to printed names.
class Printer {
  public:
    Printer(CodeLanguage language, std::map<std::string, std::string> names);
    /// C whose numbers are srbf_x (code/runtime/runtime_lanes.h): conditions on them choose lane by lane.
    static Printer for_lanes(std::map<std::string, std::string> names);

    std::string text(const Structure& structure);
    std::string text(const Table& table);
    std::string text(const Function& function);

  private:
    Printer(const Language& language, std::map<std::string, std::string> names);
    std::string printed_name(const std::string& name) const;
    std::string native_text(const std::string& native) const;
    std::string type_text(const Type& type) const;
    std::string declaration(const Type& type, const std::string& name) const;
    std::string call_text(const Expression& call);
    /// `outer` is the precedence of the surrounding expression, which decides about parentheses.
    std::string binary_text(const Expression& binary, int outer);
    std::string expression_text(const Expression& expression, int outer = 0);
    /// `head` and the statements that it governs, in braces unless it is a single one.
    void print_under(const std::string& head, const std::vector<Statement>& body, const std::set<std::string>& changed,
                     int depth, std::string& text);
    /// `changed` are the variables that are assigned after their declaration.
    void print(const std::vector<Statement>& body, const std::set<std::string>& changed, int depth, std::string& text);

    const Language& language_;
    std::map<std::string, std::string> names_;
};

/// A file of printed definitions: a comment with its usage and a `list` of its functions, and definitions that the
/// language requires. In C these are a vector and functions instead of operators, the same ones in every file.
std::string whole_text(CodeLanguage language, const std::string& list, std::string guard,
                       const std::string& definitions);
/// Every text in C begins with these definitions: its vector, and functions instead of operators.
std::string definitions_of_c();
/// True if a function without parameters may read numbers that the host supplies.
bool reads_buffers(CodeLanguage language);
/// The shortest decimal number with a point that reads as the same float.
std::string digits(float number);
/// A comment with the given lines, which may hold any text.
std::string comment_text(const std::string& lines, int depth = 0);

}  // namespace srbf::syntax
