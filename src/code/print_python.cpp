// The syntax tree in Python, for libraries of arrays such as Dr.Jit and NumPy.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "code/print_python.h"

namespace srbf::syntax {
namespace {

using EKind = Expression::Kind;
using SKind = Statement::Kind;

/// Names that Python has for something else.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> k_words{{{"min", "minimum"},
                                                                                {"max", "maximum"},
                                                                                {"int", "whole"},
                                                                                {"from", "from_"},
                                                                                {"true", "True"},
                                                                                {"false", "False"}}};
std::string named(const std::string& name) {
    for (const auto& [of, word] : k_words)
        if (name == of) return std::string(word);
    return name;
}

/// Everything but names and numbers is in parentheses, since comparisons of arrays are joined by & and |, which bind
/// more tightly than comparisons.
std::string text_of(const Expression& of, const Program& program) {
    const auto part = [&](std::size_t i) { return text_of(of.parts[i], program); };
    switch (of.kind) {
        case EKind::number:
        case EKind::name:
            return named(of.text);
        case EKind::member:
            return part(0) + "." + of.text;
        case EKind::index: {
            const bool is_table =
                of.parts[0].kind == EKind::name &&
                std::ranges::find(program.tables, of.parts[0].text, &Table::name) != program.tables.end();
            return is_table ? fmt::format("at({}, {})", part(0), part(1)) : fmt::format("{}[{}]", part(0), part(1));
        }
        case EKind::unary:
            return of.text == "!" ? fmt::format("({} == False)", part(0)) : fmt::format("(-{})", part(0));
        case EKind::binary: {
            const char* sign = of.text == "&&" ? "&" : of.text == "||" ? "|" : of.text.c_str();
            return fmt::format("({} {} {})", part(0), sign, part(1));
        }
        case EKind::conditional:
            return fmt::format("select({}, {}, {})", part(0), part(1), part(2));
        case EKind::call: {
            std::string arguments;
            for (const Expression& argument : of.parts)
                arguments += (arguments.empty() ? "" : ", ") + text_of(argument, program);
            return fmt::format("{}({})", named(of.text), arguments);
        }
    }
    return "";
}

/// The members of a structure that are arrays, to be filled.
std::string arrays_of(const Type& type, const Program& program) {
    std::string text;
    for (const Structure& structure : program.structures)
        for (const Variable& member : structure.members)
            if (structure.name == type.name && !member.type.size.empty())
                text += fmt::format("{}{}=[None] * {}", text.empty() ? "" : ", ", member.name, member.type.size);
    return text;
}

void print(const std::vector<Statement>& body, int depth, const Program& program, std::string& to) {
    const std::string indent(std::size_t(4 * depth), ' ');
    const auto line = [&](const std::string& text) { to += indent + text + "\n"; };
    const auto value = [&](const Statement& of, std::size_t i = 0) { return text_of(of.values[i], program); };
    for (const Statement& of : body) {
        switch (of.kind) {
            case SKind::declare:
                if (!of.values.empty())
                    line(fmt::format("{} = {}", named(of.name), value(of)));
                else if (!of.type.size.empty())
                    line(fmt::format("{} = [None] * {}", named(of.name), of.type.size));
                else
                    line(fmt::format("{} = Structure({})", named(of.name), arrays_of(of.type, program)));
                break;
            case SKind::assign:
                line(fmt::format("{} = {}", value(of), value(of, 1)));
                break;
            case SKind::result:
                line("return " + value(of));
                break;
            case SKind::loop:
                line(fmt::format("for {} in range({}, {}):", named(of.name), value(of), value(of, 1)));
                print(of.body, depth + 1, program, to);
                break;
            case SKind::branch: {
                const Statement& first = of.body[0];
                if (of.body.size() == 1 && of.otherwise.empty() && first.kind == SKind::assign) {
                    const std::string target = value(first);
                    line(fmt::format("{} = select({}, {}, {})", target, value(of), value(first, 1), target));
                    break;
                }
                line(fmt::format("if {}:", value(of)));
                print(of.body, depth + 1, program, to);
                if (of.otherwise.empty()) break;
                line("else:");
                print(of.otherwise, depth + 1, program, to);
                break;
            }
        }
    }
}

}  // namespace

std::string python_text(const Table& table) {
    std::string numbers;
    for (const float number : table.numbers) numbers += fmt::format("{}, ", number);
    std::string sources;
    for (const auto& [parameter, index] : table.sources) sources += fmt::format("(\"{}\", {}), ", parameter, index);
    return fmt::format("{} = table([{}]{})\n", table.name, numbers, sources.empty() ? "" : ", [" + sources + "]");
}

// A function that begins with `if (condition) return value` returns a selection, for conditions on arrays.
std::string python_text(const Function& function, const Program& program) {
    std::string parameters, text;
    for (const Variable& of : function.parameters) parameters += (parameters.empty() ? "" : ", ") + named(of.name);
    text = fmt::format("def {}({}):\n", function.name, parameters);
    std::vector<Statement> body = function.body;
    if (body.size() > 1 && body[0].kind == SKind::branch && body[0].body.size() == 1 &&
        body[0].body[0].kind == SKind::result && body.back().kind == SKind::result) {
        Expression& last = body.back().values[0];
        last = {EKind::conditional, "", {body[0].values[0], body[0].body[0].values[0], last}, last.type};
        body.erase(body.begin());
    }
    print(body, 1, program, text);
    return text;
}

}  // namespace srbf::syntax
