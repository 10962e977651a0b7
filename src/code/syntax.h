// kernel.glsl as a syntax tree, from which shading code in several languages is printed.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace srbf::syntax {

/// The language is what kernel.glsl uses of GLSL: numbers, vectors of three and fixed arrays of them, structures,
/// functions without side effects, declarations, assignments, `if`, loops `for (int i = first; i < end; ++i)` and
/// `return`.
struct Type {
    std::string name;  ///< "Real", "Vec3", "int", "bool", "void" or that of a structure
    std::string size;  ///< of an array: a number; otherwise empty
    friend bool operator==(const Type&, const Type&) = default;
};

struct Expression {
    enum class Kind {
        number,       ///< `text` as written; "true" and "false" too
        name,         ///< of a variable, a parameter or a table
        call,         ///< of the function `text`, or of a type as constructor
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
        declare,  ///< variable `name` of `type`, with values[0] if there is one
        assign,   ///< values[0] = values[1]
        branch,   ///< if (values[0]) body else otherwise
        loop,     ///< for (int `name` = values[0]; `name` < values[1]; ++`name`) body
        result,   ///< return values[0]
    };
    Kind kind = Kind::result;
    std::string comment;  ///< the lines above it, without slashes
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

/// Constant numbers; without any, those that the host supplies by a function of that name.
struct Table {
    std::string comment, name;
    std::vector<float> numbers;
    std::size_t columns = 8;  ///< numbers of a printed line
    /// Of a model's numbers the parameter (base/parameters.h), after a minus for its negative, and the index; without a name it
    /// follows from several.
    std::vector<std::pair<std::string, std::size_t>> sources = {};

    void add(float x, std::string_view parameter, std::size_t index) {
        numbers.push_back(x), sources.emplace_back(parameter, index);
    }
};

struct Function {
    std::string comment, name;
    Type type;
    std::vector<Variable> parameters;
    std::vector<Statement> body;  ///< empty: the host supplies it, and it must be a root
    bool is_accessor = false;     ///< to be replaced by the value that it returns
};

/// Everything is defined before its use.
struct Program {
    std::vector<Structure> structures;
    std::vector<Table> tables;
    std::vector<Function> functions;
};

/// Adds the definitions of `text` to `program`. A `#define NAME VALUE` has no effect if `defines` has the name, and is
/// added to it otherwise. A text that is not in the language is an error of the programmer.
void parse(std::string_view text, Program& program, std::map<std::string, std::string>& defines,
           bool as_accessors = false);

/// Reduces `program` to what the functions `roots` need: accessors and constant arguments are replaced by their values,
/// conditions on constants decided, variables that nothing reads and functions that nothing calls removed. Parameters
/// of the structures without members, handles of a model whose numbers are tables, are removed.
void specialise(Program& program, const std::vector<std::string>& roots);

/// The variable that an assignment to `target` changes.
inline const std::string& assigned(const Expression& target) {
    return target.kind == Expression::Kind::name ? target.text : assigned(target.parts[0]);
}

/// Calls visit(expression) for every expression, the parts of an expression before itself.
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
