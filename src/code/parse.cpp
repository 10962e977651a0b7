#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "code/syntax.h"
#include "srbf/result.h"

namespace srbf::syntax {
namespace {

struct Token {
    enum class Kind { word, number, sign, comment, directive, end } kind = Kind::end;
    std::string text;
    int line = 0;
};

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }

std::vector<Token> tokens_of(std::string_view text) {
    std::vector<Token> tokens;
    int line = 1;
    for (std::size_t at = 0; at < text.size();) {
        const auto take = [&](Token::Kind kind, std::size_t end) {
            tokens.push_back({kind, std::string(text.substr(at, end - at)), line});
            at = end;
        };
        const auto until = [&](const auto& ends, std::size_t from) {
            while (from < text.size() && !ends(text[from])) ++from;
            return from;
        };
        const char c = text[at];
        const auto line_end = [](char of) { return of == '\n'; };
        if (c == '\n') ++line;
        if (std::isspace(static_cast<unsigned char>(c)))
            ++at;
        else if (text.substr(at, 2) == "//")
            take(Token::Kind::comment, until(line_end, at));
        else if (c == '#')
            take(Token::Kind::directive, until(line_end, at));
        else if (is_digit(c)) {
            std::size_t end = until([](char of) { return !is_word(of) && of != '.'; }, at);
            if (text[end - 1] == 'e')
                end = until([](char of) { return !is_digit(of); }, end + 1);  // an exponent's sign
            take(Token::Kind::number, end);
        } else if (is_word(c))
            take(Token::Kind::word, until([](char of) { return !is_word(of); }, at));
        else {
            constexpr std::array<std::string_view, 7> pairs{"<=", ">=", "==", "!=", "&&", "||", "++"};
            const bool is_pair = std::ranges::find(pairs, text.substr(at, 2)) != pairs.end();
            take(Token::Kind::sign, at + (is_pair ? 2 : 1));
        }
    }
    tokens.push_back({Token::Kind::end, "", line});
    return tokens;
}

class Parser {
  public:
    Parser(std::string_view text, Program& program, std::map<std::string, std::string>& defines, bool as_accessors)
        : tokens_(tokens_of(text)), program_(program), defines_(defines), as_accessors_(as_accessors) {}

    void parse() {
        for (;;) {
            std::string comment = comments();
            if (now().kind == Token::Kind::end) return;
            if (now().kind == Token::Kind::directive)
                directive();
            else if (now().text == "struct")
                structure(std::move(comment));
            else
                function(std::move(comment));
        }
    }

  private:
    [[noreturn]] void unexpected(std::string_view expected) const {
        misused(fmt::format("line {}: expected {}, found '{}'", now().line, expected, now().text));
    }
    const Token& now() const { return tokens_[at_]; }
    bool accept(std::string_view text) {
        if (now().text != text || now().kind == Token::Kind::comment) return false;
        ++at_;
        return true;
    }
    void expect(std::string_view text) {
        if (!accept(text)) unexpected(text);
    }
    std::string word() {
        if (now().kind != Token::Kind::word) unexpected("a name");
        return tokens_[at_++].text;
    }

    /// The lines directly above what follows; comments that are set apart belong to no one.
    std::string comments() {
        std::string lines;
        int last = 0;
        for (; now().kind == Token::Kind::comment; ++at_) {
            const bool trails = at_ > 0 && tokens_[at_ - 1].line == now().line;
            if (trails || (last > 0 && now().line > last + 1)) lines.clear();
            if (trails) continue;
            const std::string& text = now().text;
            lines += (lines.empty() ? "" : "\n") + text.substr(std::min<std::size_t>(text.size(), 3));
            last = now().line;
        }
        return now().line == last + 1 ? lines : "";
    }

    void directive() {
        const std::string text = tokens_[at_++].text;
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
    void array_size(Type& of) {
        if (!accept("[")) return;
        of.size = primary().text;
        expect("]");
    }

    void structure(std::string comment) {
        expect("struct");
        Structure made{std::move(comment), word(), {}};
        expect("{");
        while (comments(), !accept("}")) {
            Variable& member = made.members.emplace_back();
            member.type = type();
            member.name = word();
            array_size(member.type);
            expect(";");
        }
        expect(";");
        program_.structures.push_back(std::move(made));
    }

    void function(std::string comment) {
        Function made;
        made.is_accessor = as_accessors_;
        made.comment = std::move(comment);
        made.type = type();
        made.name = word();
        expect("(");
        while (!accept(")")) {
            accept(",");
            Type of = type();
            made.parameters.push_back({of, word()});
        }
        scope_ = made.parameters;
        if (!accept(";")) made.body = block();
        program_.functions.push_back(std::move(made));
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
        Statement made;
        made.comment = std::move(comment);
        if (accept("return")) {
            made.kind = Statement::Kind::result;
            made.values.push_back(expression());
        } else if (accept("if")) {
            made.kind = Statement::Kind::branch;
            expect("(");
            made.values.push_back(expression());
            expect(")");
            made.body = block();
            comments();
            if (accept("else")) made.otherwise = block();
            return made;
        } else if (accept("for")) {
            made.kind = Statement::Kind::loop;
            expect("(");
            made.type = type();
            made.name = word();
            const std::size_t outside = scope_.size();
            scope_.push_back({made.type, made.name});
            expect("=");
            made.values.push_back(expression());
            expect(";");
            expect(made.name);
            expect("<");
            made.values.push_back(expression());
            for (const char* text : {";", "++", made.name.c_str(), ")"}) expect(text);
            made.body = block();
            scope_.resize(outside);
            return made;
        } else if (tokens_[at_ + 1].kind == Token::Kind::word) {
            made.kind = Statement::Kind::declare;
            made.type = type();
            made.name = word();
            array_size(made.type);
            if (accept("=")) made.values.push_back(expression());
            scope_.push_back({made.type, made.name});
        } else {
            made.kind = Statement::Kind::assign;
            made.values.push_back(postfix());
            expect("=");
            made.values.push_back(expression());
        }
        expect(";");
        return made;
    }

    Expression expression() {
        Expression condition = binary(0);
        if (!accept("?")) return condition;
        Expression first = expression();
        expect(":");
        Expression second = expression();
        Type of = first.type;
        return {Expression::Kind::conditional, "", {std::move(condition), std::move(first), std::move(second)}, of};
    }

    Expression binary(std::size_t level) {
        static const std::array<std::vector<std::string_view>, 6> levels{
            {{"||"}, {"&&"}, {"==", "!="}, {"<", ">", "<=", ">="}, {"+", "-"}, {"*", "/", "%"}}};
        if (level == levels.size()) return unary();
        Expression left = binary(level + 1);
        for (;;) {
            const auto found = std::ranges::find(levels[level], std::string_view(now().text));
            if (found == levels[level].end()) return left;
            const std::string sign = tokens_[at_++].text;
            Expression right = binary(level + 1);
            Type of = left.type.name == "Vec3" ? left.type : right.type;
            if (level < 4) of = {"bool", ""};
            left = {Expression::Kind::binary, sign, {std::move(left), std::move(right)}, of};
        }
    }

    Expression unary() {
        for (const char* sign : {"-", "!"})
            if (accept(sign)) {
                Expression of = unary();
                Type type = of.type;
                return {Expression::Kind::unary, sign, {std::move(of)}, type};
            }
        return postfix();
    }

    Expression postfix() {
        Expression made = primary();
        for (;;) {
            if (accept("[")) {
                Expression index = expression();
                expect("]");
                Type of{made.type.name, ""};
                made = {Expression::Kind::index, "", {std::move(made), std::move(index)}, of};
            } else if (accept(".")) {
                const std::string member = word();
                Type of = member_type(made.type.name, member);
                made = {Expression::Kind::member, member, {std::move(made)}, of};
            } else {
                return made;
            }
        }
    }

    Expression primary() {
        if (accept("(")) {
            Expression inside = expression();
            expect(")");
            return inside;
        }
        if (now().kind == Token::Kind::number) return number(tokens_[at_++].text);
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
            Type of = arguments[1].type;
            return {Expression::Kind::conditional, "", std::move(arguments), of};
        }
        // A Real of a Real is itself.
        if (name == "Real" && arguments[0].type.name == "Real") return std::move(arguments[0]);
        Type of = call_type(name, arguments);
        return {Expression::Kind::call, name, std::move(arguments), of};
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
        for (const Structure& of : program_.structures)
            if (of.name == structure)
                for (const Variable& candidate : of.members)
                    if (candidate.name == member) return candidate.type;
        unexpected("a member instead of " + member);
    }
    Type call_type(const std::string& name, const std::vector<Expression>& arguments) const {
        for (const char* type : {"Real", "Vec3", "int"})
            if (name == type) return {name, ""};
        for (const Function& function : program_.functions)
            if (function.name == name) return function.type;
        if (name == "dot") return {"Real", ""};
        for (const char* built_in :
             {"exp", "exp2", "log", "sqrt", "inversesqrt", "cos", "sin", "acos", "min", "max", "abs"})
            if (name == built_in) return arguments[0].type;
        unexpected("a function instead of " + name);
    }

    std::vector<Token> tokens_;
    std::size_t at_ = 0;
    Program& program_;
    std::map<std::string, std::string>& defines_;
    bool as_accessors_;
    std::vector<Variable> scope_;
};

}  // namespace

void parse(std::string_view text, Program& program, std::map<std::string, std::string>& defines, bool as_accessors) {
    Parser(text, program, defines, as_accessors).parse();
}

}  // namespace srbf::syntax
