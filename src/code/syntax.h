// kernel.glsl as a syntax tree, from which shading code in several languages is printed.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace SRBF_NAMESPACE::syntax {

// The language is the subset of GLSL that kernel.glsl uses: numbers, vectors of three and fixed arrays of them,
// structures, functions without side effects, declarations, assignments, `if`, loops
// `for (int i = first; i < end; ++i)` and `return`.

struct Type {
    std::string name;  ///< "Real", "Vec3", "int", "bool", "void" or the name of a structure
    std::string size;  ///< the number of elements of an array; otherwise empty
    friend bool operator==(const Type&, const Type&) = default;
};

struct Expression {
    enum class Kind {
        number,       ///< `text`; also "true" and "false"
        name,         ///< the variable, parameter or table `text`
        call,         ///< a call of the function or the constructor `text`
        member,       ///< parts[0].text
        index,        ///< parts[0][parts[1]]
        unary,        ///< the operator `text`
        binary,       ///< the operator `text`
        conditional,  ///< parts[0] ? parts[1] : parts[2]
    };
    Kind kind = Kind::number;
    std::string text;
    std::vector<Expression> parts;
    Type type;
    friend bool operator==(const Expression&, const Expression&) = default;
};

struct Statement {
    enum class Kind {
        declare,  ///< `type` `name` = values[0], if there is a value
        assign,   ///< values[0] = values[1]
        branch,   ///< if (values[0]) body else otherwise
        loop,     ///< for (int `name` = values[0]; `name` < values[1]; ++`name`) body
        result,   ///< return values[0]
    };
    Kind kind = Kind::result;
    std::string comment;  ///< the comment above the statement, without slashes
    Type type;
    std::string name;
    std::vector<Expression> values;
    std::vector<Statement> body, otherwise;
};

struct Variable {
    Type type;
    std::string name;
};

struct Structure {
    std::string comment, name;
    std::vector<Variable> members;
};

/// Constant numbers. The host supplies the numbers of an empty table by a function of that name.
struct Table {
    std::string comment, name;
    std::vector<float> numbers;
    std::size_t columns = 8;  ///< numbers in a printed line
    /// For each of a model's numbers, the name of its parameter (models/kind/parameters.h), which follows a minus if
    /// the number is negated, and the index. The name is empty if the number depends on several parameters.
    std::vector<std::pair<std::string, std::size_t>> sources = {};

    void add(float x, std::string_view parameter, std::size_t index) {
        numbers.push_back(x);
        sources.emplace_back(parameter, index);
    }
};

struct Function {
    std::string comment, name;
    Type type;
    std::vector<Variable> parameters;
    std::vector<Statement> body;  ///< empty for a root that the host supplies
    bool is_accessor = false;     ///< calls are replaced by the value that the function returns
    /// The definition in the printed language instead of a body, with @NAME@ for the name of a function.
    std::string native = {};
};

/// A program, in which everything is defined before its use.
struct Program {
    std::vector<Structure> structures;
    std::vector<Table> tables;
    std::vector<Function> functions;
};

enum class FunctionKind { called, accessor };
/// Adds the definitions of `text` to `program`. A `#define NAME VALUE` is added to `defines` unless that has the name.
/// Text that is not in the language is an error of the programmer.
void parse(std::string_view text, Program& program, std::map<std::string, std::string>& defines,
           FunctionKind kind = FunctionKind::called);

/// Reduces `program` to the definitions that the functions `roots` need. Replaces accessors and constant arguments by
/// their values, decides conditions on constants, and removes variables that nothing reads, functions that nothing
/// calls, and handles: structures without members, which stand for a model whose numbers are tables.
void specialise(Program& program, const std::vector<std::string>& roots);

/// The name of the variable that an assignment to `target` changes.
inline const std::string& assigned_variable(const Expression& target) {
    return target.kind == Expression::Kind::name ? target.text : assigned_variable(target.parts[0]);
}

/// Calls visit(expression) for every expression; for its parts first.
template <typename E, typename Visit> void visit_expression(E& expression, const Visit& visit) {
    for (auto& part : expression.parts) visit_expression(part, visit);
    visit(expression);
}
template <typename Body, typename Visit> void visit_expressions(Body& body, const Visit& visit) {
    for (auto& statement : body) {
        for (auto& value : statement.values) visit_expression(value, visit);
        visit_expressions(statement.body, visit);
        visit_expressions(statement.otherwise, visit);
    }
}
template <typename Body, typename Visit> void visit_statements(Body& body, const Visit& visit) {
    for (auto& statement : body) {
        visit(statement);
        visit_statements(statement.body, visit);
        visit_statements(statement.otherwise, visit);
    }
}

}  // namespace srbf::syntax
