#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "code/syntax.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE::syntax {
namespace {

struct Token {
    enum class Kind { word, number, sign, comment, directive, end } kind = Kind::end;
    std::string text;
    int line = 0;
};

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }

std::vector<Token> tokenise(std::string_view text) {
    std::vector<Token> tokens;
    int line = 1;
    for (std::size_t begin = 0; begin < text.size();) {
        const auto add = [&](Token::Kind kind, std::size_t end) {
            tokens.push_back({kind, std::string(text.substr(begin, end - begin)), line});
            begin = end;
        };
        const auto end_of_run = [&](const auto& continues, std::size_t i) {
            while (i < text.size() && continues(text[i])) ++i;
            return i;
        };
        const char first = text[begin];
        const auto in_line = [](char c) { return c != '\n'; };
        if (first == '\n') ++line;
        if (std::isspace(static_cast<unsigned char>(first)))
            ++begin;
        else if (text.substr(begin, 2) == "//")
            add(Token::Kind::comment, end_of_run(in_line, begin));
        else if (first == '#')
            add(Token::Kind::directive, end_of_run(in_line, begin));
        else if (is_digit(first)) {
            std::size_t end = end_of_run([](char c) { return is_word(c) || c == '.'; }, begin);
            if (text[end - 1] == 'e') end = end_of_run(is_digit, end + 1);  // an exponent with a sign
            add(Token::Kind::number, end);
        } else if (is_word(first))
            add(Token::Kind::word, end_of_run(is_word, begin));
        else {
            constexpr std::array<std::string_view, 7> pairs{"<=", ">=", "==", "!=", "&&", "||", "++"};
            const bool is_pair = std::ranges::find(pairs, text.substr(begin, 2)) != pairs.end();
            add(Token::Kind::sign, begin + (is_pair ? 2 : 1));
        }
    }
    tokens.push_back({Token::Kind::end, "", line});
    return tokens;
}

class Parser {
  public:
    Parser(std::string_view text, Program& program, std::map<std::string, std::string>& defines, FunctionKind kind)
        : tokens_(tokenise(text)), program_(program), defines_(defines), kind_(kind) {}

    void parse() {
        for (;;) {
            std::string comment = comments();
            if (next().kind == Token::Kind::end) return;
            if (next().kind == Token::Kind::directive)
                directive();
            else if (next().text == "struct")
                structure(std::move(comment));
            else
                function(std::move(comment));
        }
    }

  private:
    [[noreturn]] void unexpected(std::string_view expected) const {
        misused(fmt::format("line {}: expected {}, found '{}'", next().line, expected, next().text));
    }
    const Token& next() const { return tokens_[next_]; }
    bool accept(std::string_view text) {
        if (next().text != text || next().kind == Token::Kind::comment) return false;
        ++next_;
        return true;
    }
    void expect(std::string_view text) {
        if (!accept(text)) unexpected(text);
    }
    std::string word() {
        if (next().kind != Token::Kind::word) unexpected("a name");
        return tokens_[next_++].text;
    }

    /// Reads the comment directly above the next token; other comments are skipped.
    std::string comments() {
        std::string lines;
        int last = 0;
        for (; next().kind == Token::Kind::comment; ++next_) {
            const bool trails = next_ > 0 && tokens_[next_ - 1].line == next().line;
            if (trails || (last > 0 && next().line > last + 1)) lines.clear();
            if (trails) continue;
            const std::string& text = next().text;
            lines += (lines.empty() ? "" : "\n") + text.substr(std::min<std::size_t>(text.size(), 3));
            last = next().line;
        }
        return next().line == last + 1 ? lines : "";
    }

    void directive() {
        const std::string text = tokens_[next_++].text;
        const std::string_view define = "#define ";
        const std::size_t space = text.find(' ', define.size());
        if (!text.starts_with(define) || space == text.npos) unexpected("#define NAME VALUE");
        defines_.emplace(text.substr(define.size(), space - define.size()), text.substr(space + 1));
    }

    Type type() {
        accept("SRBF_FN");
        accept("const");
        const std::string name = word();
        return {name == "Bool" ? "bool" : name, ""};
    }
    void array_size(Type& type) {
        if (!accept("[")) return;
        type.size = primary().text;
        expect("]");
    }

    void structure(std::string comment) {
        expect("struct");
        Structure structure{std::move(comment), word(), {}};
        expect("{");
        for (comments(); !accept("}"); comments()) {
            Variable& member = structure.members.emplace_back();
            member.type = type();
            member.name = word();
            array_size(member.type);
            expect(";");
        }
        expect(";");
        program_.structures.push_back(std::move(structure));
    }

    void function(std::string comment) {
        Function function;
        function.is_accessor = kind_ == FunctionKind::accessor;
        function.comment = std::move(comment);
        function.type = type();
        function.name = word();
        expect("(");
        while (!accept(")")) {
            accept(",");
            Type parameter = type();
            function.parameters.push_back({parameter, word()});
        }
        scope_ = function.parameters;
        if (!accept(";")) function.body = block();
        program_.functions.push_back(std::move(function));
    }

    std::vector<Statement> block() {
        std::vector<Statement> statements;
        const std::size_t outside = scope_.size();
        if (!accept("{")) {
            statements.push_back(statement(comments()));
        } else {
            for (std::string comment = comments(); !accept("}"); comment = comments())
                statements.push_back(statement(std::move(comment)));
        }
        scope_.resize(outside);
        return statements;
    }

    Statement statement(std::string comment) {
        Statement result;
        result.comment = std::move(comment);
        if (accept("return")) {
            result.kind = Statement::Kind::result;
            result.values.push_back(expression());
        } else if (accept("if")) {
            result.kind = Statement::Kind::branch;
            expect("(");
            result.values.push_back(expression());
            expect(")");
            result.body = block();
            comments();
            if (accept("else")) result.otherwise = block();
            return result;
        } else if (accept("for")) {
            result.kind = Statement::Kind::loop;
            expect("(");
            result.type = type();
            result.name = word();
            const std::size_t outside = scope_.size();
            scope_.push_back({result.type, result.name});
            expect("=");
            result.values.push_back(expression());
            expect(";");
            expect(result.name);
            expect("<");
            result.values.push_back(expression());
            for (const char* text : {";", "++", result.name.c_str(), ")"}) expect(text);
            result.body = block();
            scope_.resize(outside);
            return result;
        } else if (tokens_[next_ + 1].kind == Token::Kind::word) {
            result.kind = Statement::Kind::declare;
            result.type = type();
            result.name = word();
            array_size(result.type);
            if (accept("=")) result.values.push_back(expression());
            scope_.push_back({result.type, result.name});
        } else {
            result.kind = Statement::Kind::assign;
            result.values.push_back(postfix());
            expect("=");
            result.values.push_back(expression());
        }
        expect(";");
        return result;
    }

    Expression expression() {
        Expression condition = binary(0);
        if (!accept("?")) return condition;
        Expression first = expression();
        expect(":");
        Expression second = expression();
        Type type = first.type;
        return {Expression::Kind::conditional, "", {std::move(condition), std::move(first), std::move(second)}, type};
    }

    Expression binary(std::size_t level) {
        constexpr std::size_t k_sums = 4;  // operators of lower levels have truth values
        static const std::array<std::vector<std::string_view>, 6> levels{
            {{"||"}, {"&&"}, {"==", "!="}, {"<", ">", "<=", ">="}, {"+", "-"}, {"*", "/", "%"}}};
        if (level == levels.size()) return unary();
        Expression left = binary(level + 1);
        for (;;) {
            const auto found = std::ranges::find(levels[level], std::string_view(next().text));
            if (found == levels[level].end()) return left;
            const std::string sign = tokens_[next_++].text;
            Expression right = binary(level + 1);
            Type type = left.type.name == "Vec3" ? left.type : right.type;
            if (level < k_sums) type = {"bool", ""};
            left = {Expression::Kind::binary, sign, {std::move(left), std::move(right)}, type};
        }
    }

    Expression unary() {
        for (const char* sign : {"-", "!"})
            if (accept(sign)) {
                Expression operand = unary();
                Type type = operand.type;
                return {Expression::Kind::unary, sign, {std::move(operand)}, type};
            }
        return postfix();
    }

    Expression postfix() {
        Expression left = primary();
        for (;;) {
            if (accept("[")) {
                Expression index = expression();
                expect("]");
                Type type{left.type.name, ""};
                left = {Expression::Kind::index, "", {std::move(left), std::move(index)}, type};
            } else if (accept(".")) {
                const std::string member = word();
                Type type = member_type(left.type.name, member);
                left = {Expression::Kind::member, member, {std::move(left)}, type};
            } else {
                return left;
            }
        }
    }

    Expression primary() {
        if (accept("(")) {
            Expression inner = expression();
            expect(")");
            return inner;
        }
        if (next().kind == Token::Kind::number) return number(tokens_[next_++].text);
        const std::string name = word();
        if (name == "true" || name == "false") return {Expression::Kind::number, name, {}, {"bool", ""}};
        if (const auto define = defines_.find(name); define != defines_.end()) return number(define->second);
        if (!accept("(")) return {Expression::Kind::name, name, {}, variable_type(name)};
        std::vector<Expression> arguments;
        while (!accept(")")) {
            accept(",");
            arguments.push_back(expression());
        }
        if (name == "select") {
            Type type = arguments[1].type;
            return {Expression::Kind::conditional, "", std::move(arguments), type};
        }
        // Real(x) of a Real is x.
        if (name == "Real" && arguments[0].type.name == "Real") return std::move(arguments[0]);
        Type type = call_type(name, arguments);
        return {Expression::Kind::call, name, std::move(arguments), type};
    }

    static Expression number(const std::string& text) {
        const bool is_real = text.find_first_of(".e") != text.npos;
        return {Expression::Kind::number, text, {}, {is_real ? "Real" : "int", ""}};
    }

    Type variable_type(const std::string& name) const {
        for (std::size_t i = scope_.size(); i-- > 0;)
            if (scope_[i].name == name) return scope_[i].type;
        for (const Table& table : program_.tables)
            if (table.name == name) return {"Real", table.numbers.empty() ? "" : std::to_string(table.numbers.size())};
        unexpected("a variable instead of " + name);
    }
    Type member_type(const std::string& structure, const std::string& member) const {
        if (structure == "Vec3") return {"Real", ""};
        for (const Structure& known : program_.structures)
            if (known.name == structure)
                for (const Variable& candidate : known.members)
                    if (candidate.name == member) return candidate.type;
        unexpected("a member instead of " + member);
    }
    Type call_type(const std::string& name, const std::vector<Expression>& arguments) const {
        for (const char* type : {"Real", "Vec3", "int"})
            if (name == type) return {name, ""};
        for (const Function& function : program_.functions)
            if (function.name == name) return function.type;
        if (name == "dot") return {"Real", ""};
        if (name == "is_finite") return {"bool", ""};  // only code in C calls it
        for (const char* built_in :
             {"exp", "exp2", "log", "sqrt", "inversesqrt", "cos", "sin", "acos", "min", "max", "abs"})
            if (name == built_in) return arguments[0].type;
        unexpected("a function instead of " + name);
    }

    std::vector<Token> tokens_;
    std::size_t next_ = 0;
    Program& program_;
    std::map<std::string, std::string>& defines_;
    FunctionKind kind_;
    std::vector<Variable> scope_;
};

}  // namespace

void parse(std::string_view text, Program& program, std::map<std::string, std::string>& defines, FunctionKind kind) {
    Parser(text, program, defines, kind).parse();
}

}  // namespace srbf::syntax
