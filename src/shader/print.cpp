#include "shader/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace srbf::syntax {
namespace {

using EKind = Expression::Kind;
using SKind = Statement::Kind;
using Word = std::pair<std::string_view, std::string_view>;

constexpr std::size_t k_columns = 120;

/// What the built-in types and functions are called in a language, where not as in GLSL.
const std::vector<Word>& words(CodeLanguage language) {
    static const std::vector<Word> glsl{{"Real", "float"}, {"Vec3", "vec3"}},
        hlsl{{"Real", "float"}, {"Vec3", "float3"}, {"inversesqrt", "rsqrt"}},
        wgsl{{"Real", "f32"}, {"Vec3", "vec3f"}, {"int", "i32"}, {"inversesqrt", "inverseSqrt"}},
        c{{"Real", "float"}, {"exp", "expf"}, {"exp2", "exp2f"}, {"log", "logf"},
          {"sqrt", "sqrtf"}, {"cos", "cosf"}, {"sin", "sinf"},   {"abs", "fabsf"}};
    switch (language) {
        case CodeLanguage::glsl:
            return glsl;
        case CodeLanguage::hlsl:
        case CodeLanguage::msl:
            return hlsl;
        case CodeLanguage::wgsl:
            return wgsl;
        case CodeLanguage::c:
            return c;
    }
    return glsl;
}

/// Names of the kernel that one of the languages reserves.
constexpr std::array<std::string_view, 6> k_reserved{"from", "of", "part", "half", "sample", "target"};

int precedence(const Expression& of) {
    if (of.kind == EKind::conditional) return 1;
    if (of.kind == EKind::unary) return 8;
    if (of.kind != EKind::binary) return 9;
    constexpr std::array<Word, 13> levels{{{"||", "2"},
                                           {"&&", "3"},
                                           {"==", "4"},
                                           {"!=", "4"},
                                           {"<", "5"},
                                           {">", "5"},
                                           {"<=", "5"},
                                           {">=", "5"},
                                           {"+", "6"},
                                           {"-", "6"},
                                           {"*", "7"},
                                           {"/", "7"},
                                           {"%", "7"}}};
    return std::ranges::find(levels, std::string_view(of.text), &Word::first)->second[0] - '0';
}

/// The shortest digits that read as the same float, with a decimal point.
std::string digits(float number) {
    std::string text = fmt::format("{}", number);
    if (text.find_first_of(".e") == text.npos) text += ".0";
    return text;
}

/// A line, broken before column `k_columns` at blanks after which `may_break` lets a line begin with `indent`.
template <typename MayBreak>
std::string broken(std::string line, const std::string& indent, const MayBreak& may_break) {
    std::string text;
    while (line.size() > k_columns) {
        std::size_t at = line.rfind(' ', k_columns);
        while (at != line.npos && at > indent.size() && !may_break(line[at - 1])) at = line.rfind(' ', at - 1);
        if (at == line.npos || at <= indent.size()) break;
        text += line.substr(0, at) + "\n";
        line = indent + line.substr(at + 1);
    }
    return text + line + "\n";
}

/// Code is broken after commas and operators.
std::string code_line(const std::string& line, int depth) {
    return broken(line, std::string(std::size_t(4 * (depth + 2)), ' '),
                  [](char before) { return std::string_view(",+*?:=").find(before) != std::string_view::npos; });
}

/// The bodies of the helpers in C, after SRBF_FN, with @ for the prefix, each after those that it needs.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> k_helpers{{
    {"vec3_of", "@vec3 @vec3_of(float x, float y, float z) { @vec3 w; w.x = x; w.y = y; w.z = z; return w; }"},
    {"add", "@vec3 @add(@vec3 a, @vec3 b) { @vec3 w; w.x = a.x + b.x; w.y = a.y + b.y; w.z = a.z + b.z; return w; }"},
    {"subtract",
     "@vec3 @subtract(@vec3 a, @vec3 b) { @vec3 w; w.x = a.x - b.x; w.y = a.y - b.y; w.z = a.z - b.z; return w; }"},
    {"scale", "@vec3 @scale(float s, @vec3 a) { @vec3 w; w.x = s * a.x; w.y = s * a.y; w.z = s * a.z; return w; }"},
    {"dot", "float @dot(@vec3 a, @vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }"},
    {"min", "float @min(float a, float b) { return a < b ? a : b; }"},
    {"max", "float @max(float a, float b) { return a > b ? a : b; }"},
    {"inversesqrt", "float @inversesqrt(float x) { return 1.0f / sqrtf(x); }"},
}};

}  // namespace

std::string comment_text(const std::string& lines, int depth) {
    const std::string begin = std::string(std::size_t(4 * depth), ' ') + "// ";
    std::string text;
    for (std::size_t at = 0; at < lines.size();) {
        const std::size_t end = std::min(lines.find('\n', at), lines.size());
        std::string line = begin + lines.substr(at, end - at);
        // A backslash would continue the comment.
        std::erase_if(line, [](char c) { return c == '\\' || static_cast<unsigned char>(c) < ' '; });
        text += broken(line, begin, [](char) { return true; });
        at = end + 1;
    }
    return text;
}

std::string Printer::named(const std::string& name) const {
    if (const auto found = names_.find(name); found != names_.end()) return found->second;
    return std::ranges::find(k_reserved, std::string_view(name)) == k_reserved.end() ? name : name + "_";
}

std::string Printer::type_text(const Type& type) const {
    std::string name;
    if (type.name == "Vec3" && language_ == CodeLanguage::c)
        name = prefix_ + "vec3";
    else if (type.name == "bool" && language_ == CodeLanguage::c)
        name = "int";
    else {
        const auto& of = words(language_);
        const auto found = std::ranges::find(of, std::string_view(type.name), &Word::first);
        name = found != of.end() ? std::string(found->second) : named(type.name);
    }
    return language_ == CodeLanguage::wgsl && !type.size.empty() ? fmt::format("array<{}, {}>", name, type.size) : name;
}

std::string Printer::declaration(const Type& type, const std::string& name) const {
    if (language_ == CodeLanguage::wgsl) return fmt::format("{}: {}", named(name), type_text(type));
    const std::string size = type.size.empty() ? "" : fmt::format("[{}]", type.size);
    return fmt::format("{} {}{}", type_text(type), named(name), size);
}

std::string Printer::helper(const std::string& name) {
    used_.insert(name);
    return prefix_ + name;
}

std::string Printer::call_text(const Expression& of) {
    const bool is_c = language_ == CodeLanguage::c;
    std::string arguments;
    for (const Expression& argument : of.parts)
        arguments += (arguments.empty() ? "" : ", ") + expression_text(argument);
    if (is_c && (of.text == "Real" || of.text == "int"))
        return fmt::format("({})({})", type_text({of.text, ""}), arguments);
    std::string name;
    if (is_c && of.text == "Vec3")
        name = helper("vec3_of");
    else if (is_c && std::ranges::find(k_helpers, std::string_view(of.text), [](const auto& h) { return h.first; }) !=
                         k_helpers.end())
        name = helper(of.text);
    else
        name = type_text({of.text, ""});
    return fmt::format("{}({})", name, arguments);
}

std::string Printer::binary_text(const Expression& of, int outside) {
    const Expression &left = of.parts[0], &right = of.parts[1];
    if (language_ == CodeLanguage::c && of.type.name == "Vec3") {
        const char* name = of.text == "+" ? "add" : of.text == "-" ? "subtract" : "scale";
        const bool swapped = of.text == "*" && left.type.name == "Vec3";
        std::string first = expression_text(swapped ? right : left), second = expression_text(swapped ? left : right);
        return fmt::format("{}({}, {})", helper(name), first, second);
    }
    const int own = precedence(of);
    const std::string text =
        fmt::format("{} {} {}", expression_text(left, own), of.text, expression_text(right, own + 1));
    return own < outside ? "(" + text + ")" : text;
}

std::string Printer::expression_text(const Expression& of, int outside) {
    const auto part = [&](std::size_t i, int within = 0) { return expression_text(of.parts[i], within); };
    switch (of.kind) {
        case EKind::number: {
            if (of.type.name == "bool" && language_ == CodeLanguage::c) return of.text == "true" ? "1" : "0";
            const bool suffixed = language_ == CodeLanguage::c || language_ == CodeLanguage::msl;
            return of.text + (of.type.name == "Real" && suffixed ? "f" : "");
        }
        case EKind::name:
            return named(of.text);
        case EKind::call:
            return call_text(of);
        case EKind::member:
            return part(0, 9) + "." + named(of.text);
        case EKind::index: {
            // In C a table is a function, which a program for a GPU may have where it may not have global arrays.
            const bool is_table = of.parts[0].kind == EKind::name && names_.contains(of.parts[0].text);
            const char* brackets = is_table && language_ == CodeLanguage::c ? "()" : "[]";
            return part(0, 9) + brackets[0] + part(1) + brackets[1];
        }
        case EKind::unary:
            if (language_ == CodeLanguage::c && of.type.name == "Vec3")
                return fmt::format("{}(-1.0f, {})", helper("scale"), part(0));
            return of.text + part(0, 8);
        case EKind::binary:
            return binary_text(of, outside);
        case EKind::conditional:
            if (language_ == CodeLanguage::wgsl) return fmt::format("select({}, {}, {})", part(2), part(1), part(0));
            {
                const std::string text = fmt::format("{} ? {} : {}", part(0, 2), part(1, 1), part(2, 1));
                return outside > 1 ? "(" + text + ")" : text;
            }
    }
    return "";
}

void Printer::print(const std::vector<Statement>& body, const std::set<std::string>& changed, int depth,
                    std::string& to) {
    const bool is_wgsl = language_ == CodeLanguage::wgsl;
    const std::string indent(std::size_t(4 * depth), ' ');
    const auto line = [&](const std::string& text) { to += code_line(indent + text, depth); };
    const auto value = [&](const Statement& of, std::size_t i = 0) { return expression_text(of.values[i]); };
    for (const Statement& of : body) {
        to += comment_text(of.comment, depth);
        switch (of.kind) {
            case SKind::declare: {
                std::string text = declaration(of.type, of.name);
                if (is_wgsl) text = (of.values.empty() || changed.contains(of.name) ? "var " : "let ") + text;
                if (!of.values.empty()) text += " = " + value(of);
                line(text + ";");
                break;
            }
            case SKind::assign:
                line(fmt::format("{} = {};", value(of), value(of, 1)));
                break;
            case SKind::result:
                line(fmt::format("return {};", value(of)));
                break;
            case SKind::branch:
                line(fmt::format("if ({}) {{", value(of)));
                print(of.body, changed, depth + 1, to);
                if (!of.otherwise.empty()) {
                    line("} else {");
                    print(of.otherwise, changed, depth + 1, to);
                }
                line("}");
                break;
            case SKind::loop: {
                const std::string name = named(of.name);
                line(fmt::format("for ({} {} = {}; {} < {}; {}) {{", is_wgsl ? "var" : "int", name, value(of), name,
                                 value(of, 1), is_wgsl ? name + "++" : "++" + name));
                print(of.body, changed, depth + 1, to);
                line("}");
                break;
            }
        }
    }
}

std::string Printer::text(const Structure& structure) {
    const bool is_wgsl = language_ == CodeLanguage::wgsl, is_c = language_ == CodeLanguage::c;
    std::string text = comment_text(structure.comment, 0);
    text += fmt::format("{}{{\n", is_c ? "typedef struct " : "struct " + named(structure.name) + " ");
    for (const Variable& member : structure.members)
        text += fmt::format("    {}{}\n", declaration(member.type, member.name), is_wgsl ? "," : ";");
    return text + (is_wgsl ? "}\n" : is_c ? fmt::format("}} {};\n", named(structure.name)) : "};\n");
}

std::string Printer::text(const Table& table) {
    const std::string name = named(table.name);
    const std::size_t size = table.numbers.size();
    std::string numbers;
    for (std::size_t i = 0; i < size; ++i) {
        const bool suffixed = language_ == CodeLanguage::c || language_ == CodeLanguage::msl;
        numbers += i % table.columns == 0 ? "    " : " ";
        numbers += digits(table.numbers[i]) + (suffixed ? "f" : "") + (i + 1 < size ? "," : "");
        if ((i + 1) % table.columns == 0 || i + 1 == size) numbers += "\n";
    }
    const std::string comment = comment_text(table.comment, 0);
    switch (language_) {
        case CodeLanguage::glsl:
            return fmt::format("{}const float {}[{}] = float[{}](\n{});\n", comment, name, size, size, numbers);
        case CodeLanguage::hlsl:
            return fmt::format("{}static const float {}[{}] = {{\n{}}};\n", comment, name, size, numbers);
        case CodeLanguage::wgsl:
            return fmt::format("{}const {} = array<f32, {}>(\n{});\n", comment, name, size, numbers);
        case CodeLanguage::msl:
            return fmt::format("{}constant float {}[{}] = {{\n{}}};\n", comment, name, size, numbers);
        case CodeLanguage::c:
            return fmt::format(
                "{}SRBF_FN float {}(int i) {{\n    static const float numbers[{}] = {{\n{}    }};\n"
                "    return numbers[i];\n}}\n",
                comment, name, size, numbers);
    }
    return "";
}

std::string Printer::text(const Function& function) {
    std::set<std::string> changed;
    visit_statements(function.body, [&](const Statement& of) {
        if (of.kind != SKind::assign) return;
        const Expression* target = &of.values[0];
        while (target->kind != EKind::name) target = &target->parts[0];
        changed.insert(target->text);
    });
    std::string parameters;
    for (const Variable& of : function.parameters)
        parameters += (parameters.empty() ? "" : ", ") + declaration(of.type, of.name);
    const std::string name = named(function.name), type = type_text(function.type);
    std::string head;
    switch (language_) {
        case CodeLanguage::wgsl:
            head = fmt::format("fn {}({}) -> {} {{", name, parameters, type);
            break;
        case CodeLanguage::c:
            head = fmt::format("SRBF_FN {} {}({}) {{", type, name, parameters);
            break;
        case CodeLanguage::msl:
            head = fmt::format("inline {} {}({}) {{", type, name, parameters);
            break;
        default:
            head = fmt::format("{} {}({}) {{", type, name, parameters);
    }
    std::string text = comment_text(function.comment, 0) + code_line(head, 0);
    print(function.body, changed, 1, text);
    return text + "}\n";
}

std::string helpers_text(CodeLanguage language, const std::string& prefix, const std::set<std::string>& used) {
    if (language != CodeLanguage::c) return "";
    std::string text = fmt::format("typedef struct {{\n    float x, y, z;\n}} {}vec3;\n", prefix);
    for (const auto& [name, body] : k_helpers) {
        if (!used.contains(std::string(name))) continue;
        std::string line = "SRBF_FN " + std::string(body);
        for (std::size_t at = 0; (at = line.find('@', at)) != line.npos;) line.replace(at, 1, prefix);
        text += line + "\n";
    }
    return text + "\n";
}

}  // namespace srbf::syntax
