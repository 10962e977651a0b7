#include "python_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "code/model_program.h"
#include "models/kind/parameters.h"
#include "sampling/mixture.h"

namespace SRBF_NAMESPACE::syntax {
namespace {

using EKind = Expression::Kind;
using SKind = Statement::Kind;

/// Names of the kernel that mean something else in Python, and the names that replace them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> k_python_names{{{"min", "minimum"},
                                                                                       {"max", "maximum"},
                                                                                       {"int", "whole"},
                                                                                       {"from", "from_"},
                                                                                       {"true", "True"},
                                                                                       {"false", "False"}}};
std::string python_name(const std::string& name) {
    for (const auto& [kernel_name, python_name] : k_python_names)
        if (name == kernel_name) return std::string(python_name);
    return name;
}

/// Puts all but names and numbers in parentheses: & and | bind more tightly than the comparisons that they join.
std::string expression_code(const Expression& expression, const Program& program) {
    const auto part = [&](std::size_t i) { return expression_code(expression.parts[i], program); };
    switch (expression.kind) {
        case EKind::number:
        case EKind::name:
            return python_name(expression.text);
        case EKind::member:
            return part(0) + "." + expression.text;
        case EKind::index: {
            const Expression& array = expression.parts[0];
            const bool is_table = array.kind == EKind::name &&
                                  std::ranges::find(program.tables, array.text, &Table::name) != program.tables.end();
            return is_table ? fmt::format("at({}, {})", part(0), part(1)) : fmt::format("{}[{}]", part(0), part(1));
        }
        case EKind::unary:
            return expression.text == "!" ? fmt::format("({} == False)", part(0)) : fmt::format("(-{})", part(0));
        case EKind::binary: {
            const std::string& text = expression.text;
            const char* sign = text == "&&" ? "&" : text == "||" ? "|" : text.c_str();
            return fmt::format("({} {} {})", part(0), sign, part(1));
        }
        case EKind::conditional:
            return fmt::format("select({}, {}, {})", part(0), part(1), part(2));
        case EKind::call: {
            std::string arguments;
            for (const Expression& argument : expression.parts)
                arguments += (arguments.empty() ? "" : ", ") + expression_code(argument, program);
            return fmt::format("{}({})", python_name(expression.text), arguments);
        }
    }
    return "";
}

/// Empty arrays for the members of a structure that are arrays.
std::string arrays_of(const Type& type, const Program& program) {
    std::string text;
    for (const Structure& structure : program.structures)
        for (const Variable& member : structure.members)
            if (structure.name == type.name && !member.type.size.empty())
                text += fmt::format("{}{}=[None] * {}", text.empty() ? "" : ", ", member.name, member.type.size);
    return text;
}

void print(const std::vector<Statement>& body, int depth, const Program& program, std::string& text) {
    const std::string indent(std::size_t(4 * depth), ' ');
    const auto line = [&](const std::string& content) { text += indent + content + "\n"; };
    const auto value = [&](const Statement& owner, std::size_t i = 0) {
        return expression_code(owner.values[i], program);
    };
    for (const Statement& statement : body) {
        switch (statement.kind) {
            case SKind::declare:
                if (!statement.values.empty())
                    line(fmt::format("{} = {}", python_name(statement.name), value(statement)));
                else if (!statement.type.size.empty())
                    line(fmt::format("{} = [None] * {}", python_name(statement.name), statement.type.size));
                else
                    line(fmt::format("{} = Structure({})", python_name(statement.name),
                                     arrays_of(statement.type, program)));
                break;
            case SKind::assign:
                line(fmt::format("{} = {}", value(statement), value(statement, 1)));
                break;
            case SKind::result:
                line("return " + value(statement));
                break;
            case SKind::loop:
                line(fmt::format("for {} in range({}, {}):", python_name(statement.name), value(statement),
                                 value(statement, 1)));
                print(statement.body, depth + 1, program, text);
                break;
            case SKind::branch: {
                const Statement& first = statement.body[0];
                if (statement.body.size() == 1 && statement.otherwise.empty() && first.kind == SKind::assign) {
                    const std::string target = value(first);
                    line(fmt::format("{} = select({}, {}, {})", target, value(statement), value(first, 1), target));
                    break;
                }
                line(fmt::format("if {}:", value(statement)));
                print(statement.body, depth + 1, program, text);
                if (statement.otherwise.empty()) break;
                line("else:");
                print(statement.otherwise, depth + 1, program, text);
                break;
            }
        }
    }
}

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
    for (const Variable& parameter : function.parameters)
        parameters += (parameters.empty() ? "" : ", ") + python_name(parameter.name);
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

}  // namespace
}  // namespace srbf::syntax

namespace SRBF_NAMESPACE {

Result<std::string> python_code(const Model& model) {
    if (std::holds_alternative<SuModel>(model.model) || std::holds_alternative<BsdfModel>(model.model))
        return Error{"python code", {}, "model", "multivariate, or Lambert and GGX", "another", ErrorCode::argument};
    const syntax::Program program =
        program_of(model, {.sampling = true}, {"brdf", "chosen_lobe", "sample_of_lobe", "light_pdf"}, {},
                   ParameterStorage::tables);
    std::string text =
        fmt::format("components = {}\n", facets_of(model) ? MixtureProposal::k_components : MixtureProposal::k_lobes);
    for (const syntax::Table& table : program.tables) text += syntax::python_text(table);
    for (const syntax::Function& function : program.functions) text += "\n\n" + syntax::python_text(function, program);
    return text;
}

}  // namespace
