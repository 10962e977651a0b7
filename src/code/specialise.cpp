#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include "code/syntax.h"

namespace SRBF_NAMESPACE::syntax {
namespace {

using Expressions = std::vector<Expression>;
using Body = std::vector<Statement>;
using EKind = Expression::Kind;
using SKind = Statement::Kind;

Function* function_named(Program& program, const std::string& name) {
    const auto found = std::ranges::find(program.functions, name, &Function::name);
    return found == program.functions.end() ? nullptr : &*found;
}

// ---- Constants ---------------------------------------------------------------------------------------------------

std::optional<int> integer_value(const Expression& expression) {
    if (expression.kind != EKind::number || expression.type.name != "int") return {};
    int number = 0;
    std::from_chars(expression.text.data(), expression.text.data() + expression.text.size(), number);
    return number;
}
std::optional<bool> truth_value(const Expression& expression) {
    if (expression.kind != EKind::number || expression.type.name != "bool") return {};
    return expression.text == "true";
}
Expression integer(int number) {
    const Expression digits{EKind::number, std::to_string(std::abs(number)), {}, {"int", ""}};
    return number < 0 ? Expression{EKind::unary, "-", {digits}, digits.type} : digits;
}
Expression truth(bool value) { return {EKind::number, value ? "true" : "false", {}, {"bool", ""}}; }

std::optional<Expression> fold_binary(const Expression& binary) {
    const Expression &left = binary.parts[0], &right = binary.parts[1];
    const std::string& sign = binary.text;
    if (sign == "&&" || sign == "||") {
        const bool deciding = sign == "||";  // the value of one operand that decides the result
        for (const int i : {0, 1})
            if (const auto known = truth_value(binary.parts[std::size_t(i)]))
                return *known == deciding ? truth(deciding) : binary.parts[std::size_t(1 - i)];
        return {};
    }
    const auto a = integer_value(left), b = integer_value(right);
    if (a && b) {
        if (sign == "+") return integer(*a + *b);
        if (sign == "-") return integer(*a - *b);
        if (sign == "*") return integer(*a * *b);
        if (sign == "/" && *b != 0) return integer(*a / *b);
        if (sign == "<") return truth(*a < *b);
        if (sign == ">") return truth(*a > *b);
        if (sign == "<=") return truth(*a <= *b);
        if (sign == ">=") return truth(*a >= *b);
        if (sign == "==") return truth(*a == *b);
    }
    if (sign == "+" && b == 0) return left;
    if (sign == "*" && b == 1) return left;
    if (sign == "*" && a == 1) return right;
    return {};
}

/// Replaces an expression by a simpler one, if its parts are known.
void fold(Expression& expression) {
    const Expressions& parts = expression.parts;
    std::optional<Expression> simpler;
    if (expression.kind == EKind::binary) simpler = fold_binary(expression);
    if (expression.kind == EKind::conditional)
        if (const auto known = truth_value(parts[0])) simpler = parts[*known ? 1 : 2];
    if (expression.kind == EKind::member && parts[0].kind == EKind::call && parts[0].text == "Vec3")
        simpler = parts[0].parts[std::size_t(expression.text[0] - 'x')];
    if (expression.kind == EKind::unary && expression.text == "!")
        if (const auto known = truth_value(parts[0])) simpler = truth(!*known);
    if (simpler) expression = Expression(*simpler);
}

/// Replaces branches on known conditions by their statements, and removes empty loops.
void decide_branches(Body& body) {
    Body result;
    for (Statement& statement : body) {
        decide_branches(statement.body);
        decide_branches(statement.otherwise);
        if (statement.kind == SKind::branch) {
            if (const auto known = truth_value(statement.values[0])) {
                for (Statement& chosen : *known ? statement.body : statement.otherwise)
                    result.push_back(std::move(chosen));
                continue;
            }
        }
        if (statement.kind == SKind::loop) {
            const auto first = integer_value(statement.values[0]), end = integer_value(statement.values[1]);
            if (statement.body.empty() || (first && end && *first >= *end)) continue;
        }
        result.push_back(std::move(statement));
    }
    body = std::move(result);
}

// ---- Functions ---------------------------------------------------------------------------------------------------

/// Replaces names in an expression by values.
void substitute(Expression& expression, const std::vector<Variable>& names, const Expressions& values) {
    visit_expression(expression, [&](Expression& part) {
        if (part.kind != EKind::name) return;
        const auto found = std::ranges::find(names, part.text, &Variable::name);
        if (found != names.end()) part = Expression(values[std::size_t(found - names.begin())]);
    });
}

/// Replaces calls of accessors by their values. An accessor may call earlier ones.
void replace_accessors(Program& program) {
    const auto replace = [&](Expression& call) {
        if (call.kind != EKind::call) return;
        const Function* accessor = function_named(program, call.text);
        if (!accessor || !accessor->is_accessor) return;
        Expression value = accessor->body[0].values[0];
        substitute(value, accessor->parameters, call.parts);
        call = std::move(value);
    };
    for (Function& function : program.functions) visit_expressions(function.body, replace);
    std::erase_if(program.functions, [](const Function& function) { return function.is_accessor; });
}

/// Removes handles from parameters and arguments.
void remove_handles(Program& program) {
    const auto is_handle = [&](const Type& type) {
        const auto found = std::ranges::find(program.structures, type.name, &Structure::name);
        return found != program.structures.end() && found->members.empty();
    };
    for (Function& function : program.functions) {
        std::erase_if(function.parameters, [&](const Variable& parameter) { return is_handle(parameter.type); });
        visit_expressions(function.body, [&](Expression& call) {
            if (call.kind != EKind::call) return;
            std::erase_if(call.parts, [&](const Expression& argument) { return is_handle(argument.type); });
        });
    }
    std::erase_if(program.structures, [](const Structure& structure) { return structure.members.empty(); });
}

/// Calls visit(call) for every call of the function.
template <typename Visit> void visit_calls(Program& program, const std::string& name, const Visit& visit) {
    for (Function& caller : program.functions)
        visit_expressions(caller.body, [&](Expression& expression) {
            if (expression.kind == EKind::call && expression.text == name) visit(expression);
        });
}

/// Replaces parameters for which all calls pass the same number by that number.
void replace_constant_parameters(Program& program, const std::vector<std::string>& roots) {
    for (Function& function : program.functions) {
        if (std::ranges::find(roots, function.name) != roots.end() || !function.native.empty()) continue;
        std::vector<Expression*> calls;
        visit_calls(program, function.name, [&](Expression& call) { calls.push_back(&call); });
        for (std::size_t i = function.parameters.size(); i-- > 0 && !calls.empty();) {
            const Expression argument = calls[0]->parts[i];
            if (argument.kind != EKind::number) continue;
            if (!std::ranges::all_of(calls, [&](const Expression* call) { return call->parts[i] == argument; }))
                continue;
            visit_expressions(function.body,
                              [&](Expression& part) { substitute(part, {function.parameters[i]}, {argument}); });
            function.parameters.erase(function.parameters.begin() + std::ptrdiff_t(i));
            for (Expression* call : calls) call->parts.erase(call->parts.begin() + std::ptrdiff_t(i));
        }
    }
}

void remove_unread_parameters(Program& program, const std::vector<std::string>& roots) {
    for (Function& function : program.functions) {
        if (std::ranges::find(roots, function.name) != roots.end() || !function.native.empty()) continue;
        std::set<std::string> read;
        visit_expressions(function.body, [&](const Expression& part) {
            if (part.kind == EKind::name) read.insert(part.text);
        });
        for (auto i = std::ptrdiff_t(function.parameters.size()); i-- > 0;) {
            if (read.contains(function.parameters[std::size_t(i)].name)) continue;
            function.parameters.erase(function.parameters.begin() + i);
            visit_calls(program, function.name, [i](Expression& call) { call.parts.erase(call.parts.begin() + i); });
        }
    }
}

/// Replaces calls of functions that return their only parameter, directly or through a variable, by the argument.
void remove_identities(Program& program, const std::vector<std::string>& roots) {
    for (Function& function : program.functions) {
        Body& body = function.body;
        if (body.size() == 2 && body[0].kind == SKind::declare && body[0].values.size() == 1 &&
            body[1].kind == SKind::result && body[1].values[0].kind == EKind::name &&
            body[1].values[0].text == body[0].name) {
            body[1].values = body[0].values;
            body.erase(body.begin());
        }
        if (function.parameters.size() != 1 || body.size() != 1 || body[0].values[0].kind != EKind::name ||
            body[0].values[0].text != function.parameters[0].name ||
            std::ranges::find(roots, function.name) != roots.end())
            continue;
        visit_calls(program, function.name, [](Expression& call) { call = Expression(call.parts[0]); });
    }
}

/// Removes variables that are never read, and assignments to them.
void remove_unread_variables(Function& function) {
    std::set<std::string> read;
    const auto reads = [&](const Expression& part) {
        if (part.kind == EKind::name) read.insert(part.text);
    };
    visit_statements(function.body, [&](const Statement& statement) {
        for (std::size_t i = statement.kind == SKind::assign ? 1 : 0; i < statement.values.size(); ++i)
            visit_expression(statement.values[i], reads);
        if (statement.kind == SKind::assign) {
            const Expression* target = &statement.values[0];
            for (; target->kind != EKind::name; target = &target->parts[0])
                if (target->kind == EKind::index) visit_expression(target->parts[1], reads);
        }
    });
    const auto is_unread = [&](const Statement& statement) {
        if (statement.kind == SKind::declare) return !read.contains(statement.name);
        return statement.kind == SKind::assign && !read.contains(assigned_variable(statement.values[0]));
    };
    std::erase_if(function.body, is_unread);
    visit_statements(function.body, [&](Statement& statement) {
        std::erase_if(statement.body, is_unread);
        std::erase_if(statement.otherwise, is_unread);
    });
}

/// Removes definitions that no root needs.
void remove_unreachable(Program& program, const std::vector<std::string>& roots) {
    std::set<std::string> reached(roots.begin(), roots.end());
    const auto needs = [&](const Type& type) { reached.insert(type.name); };
    for (std::size_t i = program.functions.size(); i-- > 0;) {  // callers follow the functions that they call
        const Function& function = program.functions[i];
        if (!reached.contains(function.name)) continue;
        needs(function.type);
        for (const Variable& parameter : function.parameters) needs(parameter.type);
        visit_statements(function.body, [&](const Statement& statement) { needs(statement.type); });
        visit_expressions(function.body, [&](const Expression& part) {
            if (part.kind == EKind::call || part.kind == EKind::name) reached.insert(part.text);
        });
    }
    for (std::size_t i = program.structures.size(); i-- > 0;)
        if (reached.contains(program.structures[i].name))
            for (const Variable& member : program.structures[i].members) needs(member.type);
    const auto is_unreached = [&](const auto& definition) { return !reached.contains(definition.name); };
    std::erase_if(program.functions, is_unreached);
    std::erase_if(program.structures, is_unreached);
    std::erase_if(program.tables, is_unreached);
}

std::size_t size_of(Program& program) {
    std::size_t size = program.structures.size() + program.tables.size();
    for (Function& function : program.functions) {
        size += 1 + function.parameters.size();
        visit_statements(function.body, [&](const Statement&) { ++size; });
        visit_expressions(function.body, [&](const Expression&) { ++size; });
    }
    return size;
}

}  // namespace

void specialise(Program& program, const std::vector<std::string>& roots) {
    for (Function& function : program.functions)
        if (function.is_accessor) visit_expressions(function.body, fold);
    replace_accessors(program);
    remove_handles(program);
    for (std::size_t before = 0; before != size_of(program);) {
        before = size_of(program);
        replace_constant_parameters(program, roots);
        remove_unread_parameters(program, roots);
        remove_identities(program, roots);
        for (Function& function : program.functions) {
            visit_expressions(function.body, fold);
            decide_branches(function.body);
            remove_unread_variables(function);
        }
        remove_unreachable(program, roots);
    }
}

}  // namespace srbf::syntax
