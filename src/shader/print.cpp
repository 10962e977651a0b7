#include "shader/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
        c{{"Real", "float"},   {"Vec3", "srbf_vec3"}, {"dot", "srbf_dot"},
          {"min", "srbf_min"}, {"max", "srbf_max"},   {"inversesqrt", "srbf_inversesqrt"},
          {"exp", "expf"},     {"exp2", "exp2f"},     {"log", "logf"},
          {"sqrt", "sqrtf"},   {"cos", "cosf"},       {"sin", "sinf"},
          {"abs", "fabsf"}};
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
    using Level = std::pair<std::string_view, int>;
    constexpr std::array<Level, 13> levels{{{"||", 2},
                                            {"&&", 3},
                                            {"==", 4},
                                            {"!=", 4},
                                            {"<", 5},
                                            {">", 5},
                                            {"<=", 5},
                                            {">=", 5},
                                            {"+", 6},
                                            {"-", 6},
                                            {"*", 7},
                                            {"/", 7},
                                            {"%", 7}}};
    return std::ranges::find(levels, std::string_view(of.text), &Level::first)->second;
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

/// C has no operators on structures. A table is a function, see `Printer::text`.
constexpr const char* k_opening_of_c = R"(#include <math.h>

#ifndef SRBF_VEC3
#define SRBF_VEC3
#ifdef __CUDACC__
#define SRBF_FN __host__ __device__ static inline
#else
#define SRBF_FN static inline
#endif
typedef struct {
    float x, y, z;
} srbf_vec3;
SRBF_FN srbf_vec3 srbf_vec3_of(float x, float y, float z) { srbf_vec3 w = {x, y, z}; return w; }
SRBF_FN srbf_vec3 srbf_add(srbf_vec3 a, srbf_vec3 b) { return srbf_vec3_of(a.x + b.x, a.y + b.y, a.z + b.z); }
SRBF_FN srbf_vec3 srbf_subtract(srbf_vec3 a, srbf_vec3 b) { return srbf_vec3_of(a.x - b.x, a.y - b.y, a.z - b.z); }
SRBF_FN srbf_vec3 srbf_scale(float s, srbf_vec3 a) { return srbf_vec3_of(s * a.x, s * a.y, s * a.z); }
SRBF_FN float srbf_dot(srbf_vec3 a, srbf_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SRBF_FN float srbf_min(float a, float b) { return a < b ? a : b; }
SRBF_FN float srbf_max(float a, float b) { return a > b ? a : b; }
SRBF_FN float srbf_inversesqrt(float x) { return 1.0f / sqrtf(x); }
#endif

)";

}  // namespace

std::string digits(float number) {
    std::string text = fmt::format("{}", number);
    if (text.find_first_of(".e") == text.npos) text += ".0";
    return text;
}

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
    if (type.name == "bool" && language_ == CodeLanguage::c)
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

std::string Printer::call_text(const Expression& of) {
    const bool is_c = language_ == CodeLanguage::c;
    std::string arguments;
    for (const Expression& argument : of.parts)
        arguments += (arguments.empty() ? "" : ", ") + expression_text(argument);
    if (is_c && (of.text == "Real" || of.text == "int"))
        return fmt::format("({})({})", type_text({of.text, ""}), arguments);
    const std::string name = type_text({of.text, ""}) + (is_c && of.text == "Vec3" ? "_of" : "");
    return fmt::format("{}({})", name, arguments);
}

std::string Printer::binary_text(const Expression& of, int outside) {
    const Expression &left = of.parts[0], &right = of.parts[1];
    if (language_ == CodeLanguage::c && of.type.name == "Vec3") {
        const char* name = of.text == "+" ? "add" : of.text == "-" ? "subtract" : "scale";
        const bool swapped = of.text == "*" && left.type.name == "Vec3";
        std::string first = expression_text(swapped ? right : left), second = expression_text(swapped ? left : right);
        return fmt::format("srbf_{}({}, {})", name, first, second);
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
            // In C a table is a function, which a program for a GPU may have where it may not have global arrays. What
            // the host supplies is one in every language.
            const bool is_table = of.parts[0].kind == EKind::name && names_.contains(of.parts[0].text);
            const bool is_supplied = of.parts[0].type.size.empty();
            const char* brackets = is_table && (language_ == CodeLanguage::c || is_supplied) ? "()" : "[]";
            return part(0, 9) + brackets[0] + part(1) + brackets[1];
        }
        case EKind::unary:
            if (language_ == CodeLanguage::c && of.type.name == "Vec3")
                return fmt::format("srbf_scale(-1.0f, {})", part(0));
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
    if (table.numbers.empty()) return comment_text(fmt::format("{}(i): {}", named(table.name), table.comment));
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
        if (of.kind == SKind::assign) changed.insert(assigned(of.values[0]));
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

std::string opening(CodeLanguage language) {
    if (language == CodeLanguage::msl) return "#include <metal_stdlib>\nusing namespace metal;\n\n";
    return language == CodeLanguage::c ? k_opening_of_c : "";
}

}  // namespace srbf::syntax
