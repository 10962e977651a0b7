#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include "code/syntax.h"

namespace srbf::syntax {
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

std::optional<int> whole(const Expression& of) {
    if (of.kind != EKind::number || of.type.name != "int") return {};
    int number = 0;
    std::from_chars(of.text.data(), of.text.data() + of.text.size(), number);
    return number;
}
std::optional<bool> truth(const Expression& of) {
    if (of.kind != EKind::number || of.type.name != "bool") return {};
    return of.text == "true";
}
Expression whole_number(int number) {
    const Expression digits{EKind::number, std::to_string(std::abs(number)), {}, {"int", ""}};
    return number < 0 ? Expression{EKind::unary, "-", {digits}, digits.type} : digits;
}
Expression truth_of(bool holds) { return {EKind::number, holds ? "true" : "false", {}, {"bool", ""}}; }

std::optional<Expression> folded_pair(const Expression& of) {
    const Expression &left = of.parts[0], &right = of.parts[1];
    if (of.text == "&&" || of.text == "||") {
        const bool decides = of.text == "||";  // the truth of one side that decides
        for (const int i : {0, 1})
            if (const auto known = truth(of.parts[std::size_t(i)]))
                return *known == decides ? truth_of(decides) : of.parts[std::size_t(1 - i)];
        return {};
    }
    const auto a = whole(left), b = whole(right);
    if (a && b) {
        if (of.text == "+") return whole_number(*a + *b);
        if (of.text == "-") return whole_number(*a - *b);
        if (of.text == "*") return whole_number(*a * *b);
        if (of.text == "/" && *b != 0) return whole_number(*a / *b);
        if (of.text == "<") return truth_of(*a < *b);
        if (of.text == ">") return truth_of(*a > *b);
        if (of.text == "<=") return truth_of(*a <= *b);
        if (of.text == ">=") return truth_of(*a >= *b);
        if (of.text == "==") return truth_of(*a == *b);
    }
    if (of.text == "+" && b == 0) return left;
    if (of.text == "*" && b == 1) return left;
    if (of.text == "*" && a == 1) return right;
    return {};
}

void fold(Expression& of) {
    std::optional<Expression> simpler;
    if (of.kind == EKind::binary) simpler = folded_pair(of);
    if (of.kind == EKind::conditional)
        if (const auto known = truth(of.parts[0])) simpler = of.parts[*known ? 1 : 2];
    if (of.kind == EKind::member && of.parts[0].kind == EKind::call && of.parts[0].text == "Vec3")
        simpler = of.parts[0].parts[of.text == "x" ? 0 : of.text == "y" ? 1 : 2];
    if (of.kind == EKind::unary && of.text == "!")
        if (const auto known = truth(of.parts[0])) simpler = truth_of(!*known);
    if (simpler) of = Expression(*simpler);
}

void decide(Body& body) {
    Body decided;
    for (Statement& statement : body) {
        decide(statement.body);
        decide(statement.otherwise);
        if (statement.kind == SKind::branch) {
            if (const auto known = truth(statement.values[0])) {
                for (Statement& chosen : *known ? statement.body : statement.otherwise)
                    decided.push_back(std::move(chosen));
                continue;
            }
        }
        if (statement.kind == SKind::loop) {
            const auto first = whole(statement.values[0]), end = whole(statement.values[1]);
            if (statement.body.empty() || (first && end && *first >= *end)) continue;
        }
        decided.push_back(std::move(statement));
    }
    body = std::move(decided);
}

// ---- Functions ---------------------------------------------------------------------------------------------------

/// Replaces names by expressions.
void substitute(Expression& in, const std::vector<Variable>& names, const Expressions& by) {
    visit_expression(in, [&](Expression& of) {
        if (of.kind != EKind::name) return;
        const auto found = std::ranges::find(names, of.text, &Variable::name);
        if (found != names.end()) of = Expression(by[std::size_t(found - names.begin())]);
    });
}

/// Replaces calls of accessors by their values; an accessor may call those before it.
void replace_accessors(Program& program) {
    const auto replaced = [&](Expression& of) {
        if (of.kind != EKind::call) return;
        const Function* accessor = function_named(program, of.text);
        if (!accessor || !accessor->is_accessor) return;
        Expression value = accessor->body[0].values[0];
        substitute(value, accessor->parameters, of.parts);
        of = std::move(value);
    };
    for (Function& function : program.functions) visit_expressions(function.body, replaced);
    std::erase_if(program.functions, [](const Function& function) { return function.is_accessor; });
}

/// Parameters and arguments of structures that are handles.
void remove_handles(Program& program) {
    const auto is_handle = [&](const Type& type) {
        const auto found = std::ranges::find(program.structures, type.name, &Structure::name);
        return found != program.structures.end() && found->members.empty();
    };
    for (Function& function : program.functions) {
        std::erase_if(function.parameters, [&](const Variable& of) { return is_handle(of.type); });
        visit_expressions(function.body, [&](Expression& of) {
            if (of.kind != EKind::call) return;
            std::erase_if(of.parts, [&](const Expression& argument) { return is_handle(argument.type); });
        });
    }
    std::erase_if(program.structures, [](const Structure& of) { return of.members.empty(); });
}

/// Calls visit(call) for every call of the function.
template <typename Visit> void visit_calls(Program& program, const std::string& name, const Visit& visit) {
    for (Function& caller : program.functions)
        visit_expressions(caller.body, [&](Expression& of) {
            if (of.kind == EKind::call && of.text == name) visit(of);
        });
}

/// A parameter for which all calls pass the same number becomes that number.
void replace_constant_parameters(Program& program, const std::vector<std::string>& roots) {
    for (Function& function : program.functions) {
        if (std::ranges::find(roots, function.name) != roots.end()) continue;
        std::vector<Expression*> calls;
        visit_calls(program, function.name, [&](Expression& call) { calls.push_back(&call); });
        for (std::size_t i = function.parameters.size(); i-- > 0 && !calls.empty();) {
            const Expression argument = calls[0]->parts[i];
            if (argument.kind != EKind::number) continue;
            if (!std::ranges::all_of(calls, [&](const Expression* call) { return call->parts[i] == argument; }))
                continue;
            visit_expressions(function.body,
                              [&](Expression& of) { substitute(of, {function.parameters[i]}, {argument}); });
            function.parameters.erase(function.parameters.begin() + std::ptrdiff_t(i));
            for (Expression* call : calls) call->parts.erase(call->parts.begin() + std::ptrdiff_t(i));
        }
    }
}

void remove_unread_parameters(Program& program, const std::vector<std::string>& roots) {
    for (Function& function : program.functions) {
        if (std::ranges::find(roots, function.name) != roots.end()) continue;
        std::set<std::string> read;
        visit_expressions(function.body, [&](const Expression& of) {
            if (of.kind == EKind::name) read.insert(of.text);
        });
        for (std::size_t i = function.parameters.size(); i-- > 0;) {
            if (read.contains(function.parameters[i].name)) continue;
            const auto at = std::ptrdiff_t(i);
            function.parameters.erase(function.parameters.begin() + at);
            visit_calls(program, function.name, [at](Expression& call) { call.parts.erase(call.parts.begin() + at); });
        }
    }
}

/// Calls of functions that return their only parameter become the argument, also where a variable is between the two.
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

/// Removes variables that are never read, with what is assigned to them.
void remove_unread(Function& function) {
    std::set<std::string> read;
    const auto reads = [&](const Expression& of) {
        if (of.kind == EKind::name) read.insert(of.text);
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
        return statement.kind == SKind::assign && !read.contains(assigned(statement.values[0]));
    };
    std::erase_if(function.body, is_unread);
    visit_statements(function.body, [&](Statement& statement) {
        std::erase_if(statement.body, is_unread);
        std::erase_if(statement.otherwise, is_unread);
    });
}

/// Removes what no root reaches.
void remove_unreachable(Program& program, const std::vector<std::string>& roots) {
    std::set<std::string> reached(roots.begin(), roots.end());
    const auto needs = [&](const Type& type) { reached.insert(type.name); };
    for (std::size_t i = program.functions.size(); i-- > 0;) {  // what calls comes after what is called
        const Function& function = program.functions[i];
        if (!reached.contains(function.name)) continue;
        needs(function.type);
        for (const Variable& of : function.parameters) needs(of.type);
        visit_statements(function.body, [&](const Statement& of) { needs(of.type); });
        visit_expressions(function.body, [&](const Expression& of) {
            if (of.kind == EKind::call || of.kind == EKind::name) reached.insert(of.text);
        });
    }
    for (std::size_t i = program.structures.size(); i-- > 0;)
        if (reached.contains(program.structures[i].name))
            for (const Variable& member : program.structures[i].members) needs(member.type);
    const auto is_unreached = [&](const auto& of) { return !reached.contains(of.name); };
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
            decide(function.body);
            remove_unread(function);
        }
        remove_unreachable(program, roots);
    }
}

}  // namespace srbf::syntax
