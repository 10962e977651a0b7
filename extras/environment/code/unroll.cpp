// Loops of known lengths as the statements that they repeat, with numbers of tables in place of their indices.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "code/print.h"
#include "extras/environment/code/unroll.h"

namespace SRBF_NAMESPACE::syntax {
namespace {

using EKind = Expression::Kind;
using SKind = Statement::Kind;

/// The statements of longer loops stay in the loop.
constexpr int k_max_repeated = 32;

std::optional<double> literal(const Expression& expression) {
    if (expression.kind == EKind::unary && expression.text == "-")
        if (const auto positive = literal(expression.parts[0])) return -*positive;
    if (expression.kind != EKind::number || expression.type.name == "bool") return {};
    return std::strtod(expression.text.c_str(), nullptr);
}
Expression number(double x, const std::string& type) {
    const std::string text = type == "int" ? std::to_string(int(std::abs(x))) : digits(float(std::abs(x)));
    const Expression positive{EKind::number, text, {}, {type, ""}};
    return x < 0 ? Expression{EKind::unary, "-", {positive}, positive.type} : positive;
}

void replace_names(Expression& expression, const std::map<std::string, Expression>& by) {
    visit_expression(expression, [&](Expression& part) {
        if (part.kind != EKind::name) return;
        if (const auto found = by.find(part.text); found != by.end()) part = Expression(found->second);
    });
}
std::size_t uses_of(const std::string& name, const Expression& expression) {
    std::size_t uses = 0;
    visit_expression(expression,
                     [&](const Expression& part) { uses += part.kind == EKind::name && part.text == name; });
    return uses;
}

/// The statements of a loop's body for one index. What they declare gets the index as a suffix.
std::vector<Statement> repetition(const Statement& loop, int index) {
    std::map<std::string, Expression> names{{loop.name, number(index, "int")}};
    std::vector<Statement> body = loop.body;
    visit_statements(body, [&](Statement& statement) {
        if (statement.kind == SKind::declare) {
            const std::string id = statement.name + (statement.name.ends_with('_') ? "" : "_") + std::to_string(index);
            names[statement.name] = {EKind::name, id, {}, statement.type};
            statement.name = id;
        }
    });
    visit_statements(body, [&](Statement& statement) {
        for (Expression& value : statement.values) replace_names(value, names);
    });
    return body;
}
/// True if a loop's variable is part of an index.
bool indexes(const Statement& loop) {
    bool is_index = false;
    visit_expressions(loop.body, [&](const Expression& part) {
        if (part.kind == EKind::index && uses_of(loop.name, part.parts[1]) > 0) is_index = true;
    });
    return is_index;
}
void unroll_loops(std::vector<Statement>& body) {
    std::vector<Statement> result;
    for (Statement& statement : body) {
        unroll_loops(statement.body);
        unroll_loops(statement.otherwise);
        std::optional<double> first, end;
        if (statement.kind == SKind::loop) {
            first = literal(statement.values[0]);
            end = literal(statement.values[1]);
        }
        if (!first || !end || *end - *first > k_max_repeated || !indexes(statement)) {
            result.push_back(std::move(statement));
            continue;
        }
        for (int i = int(*first); i < int(*end); ++i) {
            for (Statement& repeated : repetition(statement, i)) result.push_back(std::move(repeated));
            visit_statements(statement.body, [](Statement& repeated) { repeated.comment.clear(); });
        }
    }
    body = std::move(result);
}

/// Joins statements that set a variable and then change it once: v = a; v = v + b; becomes v = a + b.
void join_sums(std::vector<Statement>& body) {
    const auto variable = [](const Statement& statement) -> std::string {
        if (statement.kind == SKind::declare && !statement.values.empty()) return statement.name;
        const bool sets = statement.kind == SKind::assign && statement.values[0].kind == EKind::name;
        return sets ? statement.values[0].text : "";
    };
    std::vector<Statement> result;
    for (Statement& statement : body) {
        join_sums(statement.body);
        join_sums(statement.otherwise);
        const std::string name = variable(statement);
        const bool follows = statement.kind == SKind::assign && !name.empty() && !result.empty() &&
                             variable(result.back()) == name && uses_of(name, statement.values[1]) == 1;
        if (!follows) {
            result.push_back(std::move(statement));
            continue;
        }
        const Expression before = result.back().values.back();
        replace_names(statement.values[1], {{name, before}});
        result.back().values.back() = std::move(statement.values[1]);
    }
    body = std::move(result);
}

/// Replaces numbers of tables, and products and comparisons of numbers, by their values.
void evaluate(const Program& program, Expression& expression) {
    const std::vector<Expression>& parts = expression.parts;
    std::vector<double> values;
    for (const Expression& part : parts)
        if (const auto value = literal(part)) values.push_back(*value);
    if (expression.kind == EKind::index && values.size() == 1) {
        const auto table = std::ranges::find(program.tables, parts[0].text, &Table::name);
        if (parts[0].kind == EKind::name && table != program.tables.end() && !table->numbers.empty())
            expression = number(double(table->numbers[std::size_t(values[0])]), "Real");
    } else if (expression.kind == EKind::call && expression.text == "abs" && values.size() == 1) {
        expression = number(std::abs(values[0]), "Real");
    } else if (expression.kind == EKind::binary && values.size() == 2) {
        const std::string type = expression.type.name;
        if (expression.text == "*") expression = number(values[0] * values[1], type);
        if (expression.text == "+") expression = number(values[0] + values[1], type);
        if (expression.text == "<")
            expression = {EKind::number, values[0] < values[1] ? "true" : "false", {}, {"bool", ""}};
    } else if (expression.kind == EKind::binary && values.size() == 1 && values[0] == 0) {
        const bool is_left = literal(parts[0]).has_value();
        if (expression.text == "*" && expression.type.name == "Real")
            expression = number(0, "Real");
        else if (!is_left && (expression.text == "+" || expression.text == "-"))
            expression = Expression(parts[0]);
    }
}

/// Replaces calls of functions that only return a value by that value, if an argument is a number of the text.
void replace_calls(Program& program) {
    for (Function& caller : program.functions)
        visit_expressions(caller.body, [&](Expression& call) {
            const auto function = std::ranges::find(program.functions, call.text, &Function::name);
            const bool is_fixed = std::ranges::any_of(
                call.parts, [](const Expression& part) { return part.type.name == "int" && literal(part); });
            if (call.kind != EKind::call || !is_fixed || function == program.functions.end() ||
                function->body.size() != 1 || function->body[0].kind != SKind::result)
                return;
            Expression value = function->body[0].values[0];
            std::map<std::string, Expression> arguments;
            for (std::size_t i = 0; i < call.parts.size(); ++i) {
                const std::string& name = function->parameters[i].name;
                if (!call.parts[i].parts.empty() && uses_of(name, value) > 1) return;
                arguments[name] = call.parts[i];
            }
            replace_names(value, arguments);
            call = std::move(value);
        });
}

}  // namespace

void unroll(Program& program, const std::vector<std::string>& roots) {
    for (Function& function : program.functions) {
        unroll_loops(function.body);
        join_sums(function.body);
    }
    specialise(program, roots);
    replace_calls(program);
    specialise(program, roots);
    for (Function& function : program.functions)
        visit_expressions(function.body, [&](Expression& part) { evaluate(program, part); });
    specialise(program, roots);
}

}  // namespace srbf::syntax
