#include "code/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "base/printable.h"

namespace srbf::syntax {

using Word = std::pair<std::string_view, std::string_view>;

/// A language, where it is not as GLSL.
struct Language {
    std::string_view usage;          ///< how a text is used
    std::vector<Word> words;         ///< what the types and built-in functions are called
    std::string_view function = {};  ///< begins a definition of a function
    std::string_view table;          ///< a constant array, of {0} name, {1} size, {2} numbers
    std::string_view suffix = {};    ///< of a number with a decimal point
    std::string_view opening = {};   ///< what definitions require
    bool is_guarded = true;          ///< by #ifndef
    bool types_follow = false;       ///< name: type, let and var, array<type, size>, and select() for ?:
    bool is_c = false;               ///< typedef struct, casts, and numbers for true and false
    std::string_view vector = {};    ///< makes a Vec3, if its name does not
    bool has_operators = true;       ///< on vectors; if not, functions, and a table is one too
    bool reads_buffers = true;       ///< a function without parameters may read what the host supplies
};

namespace {

using EKind = Expression::Kind;
using SKind = Statement::Kind;

constexpr std::size_t k_columns = 120;

/// C has no operators on structures.
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

const Language& row_of(CodeLanguage language) {
    static const std::vector<Word> floats{{"Real", "float"}, {"Vec3", "float3"}, {"inversesqrt", "rsqrt"}};
    static const std::map<CodeLanguage, Language> rows{
        {CodeLanguage::glsl,
         {.usage = "GLSL, to follow the version (300 es or later)",
          .words = {{"Real", "float"}, {"Vec3", "vec3"}},
          .table = "const float {0}[{1}] = float[{1}](\n{2});\n",
          .opening = "#ifdef GL_ES\nprecision highp float;\nprecision highp int;\n#endif\n\n"}},
        {CodeLanguage::hlsl, {.usage = "HLSL", .words = floats, .table = "static const float {0}[{1}] = {{\n{2}}};\n"}},
        {CodeLanguage::wgsl,
         {.usage = "WGSL",
          .words = {{"Real", "f32"}, {"Vec3", "vec3f"}, {"int", "i32"}, {"inversesqrt", "inverseSqrt"}},
          .function = "fn ",
          .table = "const {0} = array<f32, {1}>(\n{2});\n",
          .is_guarded = false,
          .types_follow = true}},
        {CodeLanguage::msl,
         {.usage = "Metal",
          .words = floats,
          .function = "inline ",
          .table = "constant float {0}[{1}] = {{\n{2}}};\n",
          .suffix = "f",
          .opening = "#include <metal_stdlib>\nusing namespace metal;\n\n",
          .reads_buffers = false}},
        {CodeLanguage::c,
         {.usage = "C99, C++ and CUDA",
          .words = {{"Real", "float"},
                    {"Vec3", "srbf_vec3"},
                    {"bool", "int"},
                    {"dot", "srbf_dot"},
                    {"min", "srbf_min"},
                    {"max", "srbf_max"},
                    {"inversesqrt", "srbf_inversesqrt"},
                    {"exp", "expf"},
                    {"exp2", "exp2f"},
                    {"log", "logf"},
                    {"sqrt", "sqrtf"},
                    {"cos", "cosf"},
                    {"sin", "sinf"},
                    {"acos", "acosf"},
                    {"abs", "fabsf"}},
          .function = "SRBF_FN ",
          .table = "SRBF_FN float {0}(int i) {{\n    static const float numbers[{1}] = {{\n{2}    }};\n"
                   "    return numbers[i];\n}}\n",
          .suffix = "f",
          .opening = k_opening_of_c,
          .is_c = true,
          .vector = "srbf_vec3_of",
          .has_operators = false}},
    };
    return rows.at(language);
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

}  // namespace

Printer::Printer(CodeLanguage language, std::map<std::string, std::string> names)
    : language_(row_of(language)), names_(std::move(names)) {}

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
        text += broken(begin + in_comment(lines.substr(at, end - at)), begin, [](char) { return true; });
        at = end + 1;
    }
    return text;
}

std::string Printer::named(const std::string& name) const {
    if (const auto found = names_.find(name); found != names_.end()) return found->second;
    return std::ranges::find(k_reserved, std::string_view(name)) == k_reserved.end() ? name : name + "_";
}

std::string Printer::type_text(const Type& type) const {
    const auto found = std::ranges::find(language_.words, std::string_view(type.name), &Word::first);
    const std::string name = found != language_.words.end() ? std::string(found->second) : named(type.name);
    return language_.types_follow && !type.size.empty() ? fmt::format("array<{}, {}>", name, type.size) : name;
}

std::string Printer::declaration(const Type& type, const std::string& name) const {
    if (language_.types_follow) return fmt::format("{}: {}", named(name), type_text(type));
    const std::string size = type.size.empty() ? "" : fmt::format("[{}]", type.size);
    return fmt::format("{} {}{}", type_text(type), named(name), size);
}

std::string Printer::call_text(const Expression& of) {
    std::string arguments;
    for (const Expression& argument : of.parts)
        arguments += (arguments.empty() ? "" : ", ") + expression_text(argument);
    const std::string name = type_text({of.text, ""});
    if (language_.is_c && (of.text == "Real" || of.text == "int")) return fmt::format("({})({})", name, arguments);
    if (of.text == "Vec3" && !language_.vector.empty()) return fmt::format("{}({})", language_.vector, arguments);
    return fmt::format("{}({})", name, arguments);
}

std::string Printer::binary_text(const Expression& of, int outside) {
    const Expression &left = of.parts[0], &right = of.parts[1];
    if (!language_.has_operators && of.type.name == "Vec3") {
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
        case EKind::number:
            if (of.type.name == "bool" && language_.is_c) return of.text == "true" ? "1" : "0";
            return of.text + std::string(of.type.name == "Real" ? language_.suffix : "");
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
            const char* brackets = is_table && (!language_.has_operators || is_supplied) ? "()" : "[]";
            return part(0, 9) + brackets[0] + part(1) + brackets[1];
        }
        case EKind::unary:
            if (!language_.has_operators && of.type.name == "Vec3")
                return fmt::format("srbf_scale(-1.0f, {})", part(0));
            return of.text + part(0, 8);
        case EKind::binary:
            return binary_text(of, outside);
        case EKind::conditional:
            if (language_.types_follow) return fmt::format("select({}, {}, {})", part(2), part(1), part(0));
            {
                const std::string text = fmt::format("{} ? {} : {}", part(0, 2), part(1, 1), part(2, 1));
                return outside > 1 ? "(" + text + ")" : text;
            }
    }
    return "";
}

void Printer::print(const std::vector<Statement>& body, const std::set<std::string>& changed, int depth,
                    std::string& to) {
    const bool types_follow = language_.types_follow;
    const std::string indent(std::size_t(4 * depth), ' ');
    const auto line = [&](const std::string& text) { to += code_line(indent + text, depth); };
    const auto value = [&](const Statement& of, std::size_t i = 0) { return expression_text(of.values[i]); };
    for (const Statement& of : body) {
        to += comment_text(of.comment, depth);
        switch (of.kind) {
            case SKind::declare: {
                std::string text = declaration(of.type, of.name);
                if (types_follow) text = (of.values.empty() || changed.contains(of.name) ? "var " : "let ") + text;
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
                line(fmt::format("for ({} {} = {}; {} < {}; {}) {{", types_follow ? "var" : "int", name, value(of),
                                 name, value(of, 1), types_follow ? name + "++" : "++" + name));
                print(of.body, changed, depth + 1, to);
                line("}");
                break;
            }
        }
    }
}

std::string Printer::text(const Structure& structure) {
    std::string text = comment_text(structure.comment, 0);
    text += fmt::format("{}{{\n", language_.is_c ? "typedef struct " : "struct " + named(structure.name) + " ");
    for (const Variable& member : structure.members)
        text += fmt::format("    {}{}\n", declaration(member.type, member.name), language_.types_follow ? "," : ";");
    if (language_.types_follow) return text + "}\n";
    return text + (language_.is_c ? fmt::format("}} {};\n", named(structure.name)) : "};\n");
}

std::string Printer::text(const Table& table) {
    if (table.numbers.empty()) return comment_text(fmt::format("{}(i): {}", named(table.name), table.comment));
    const std::string name = named(table.name);
    const std::size_t size = table.numbers.size();
    std::string numbers;
    for (std::size_t i = 0; i < size; ++i) {
        numbers += i % table.columns == 0 ? "    " : " ";
        numbers += fmt::format("{}{}{}", digits(table.numbers[i]), language_.suffix, i + 1 < size ? "," : "");
        if ((i + 1) % table.columns == 0 || i + 1 == size) numbers += "\n";
    }
    return comment_text(table.comment, 0) + fmt::format(fmt::runtime(language_.table), name, size, numbers);
}

std::string Printer::text(const Function& function) {
    std::set<std::string> changed;
    visit_statements(function.body, [&](const Statement& of) {
        if (of.kind == SKind::assign) changed.insert(assigned(of.values[0]));
    });
    std::string parameters;
    for (const Variable& of : function.parameters)
        parameters += (parameters.empty() ? "" : ", ") + declaration(of.type, of.name);
    if (parameters.empty() && language_.is_c) parameters = "void";  // without it C would take any arguments
    const std::string name = named(function.name), type = type_text(function.type);
    if (function.body.empty()) {
        const std::string comment = comment_text(fmt::format("{}: {}", name, function.comment));
        if (language_.types_follow) return comment;  // which needs no declaration
        const char* modifiers = language_.is_c ? "static " : "";
        return comment + fmt::format("#ifndef {1}\n{3}{0} {1}({2});\n#endif\n", type, name, parameters, modifiers);
    }
    const std::string head = language_.types_follow
                                 ? fmt::format("{}{}({}) -> {} {{", language_.function, name, parameters, type)
                                 : fmt::format("{}{} {}({}) {{", language_.function, type, name, parameters);
    std::string text = comment_text(function.comment, 0) + code_line(head, 0);
    print(function.body, changed, 1, text);
    return text + "}\n";
}

std::string whole_text(CodeLanguage language, const std::string& list, std::string guard,
                       const std::string& definitions) {
    const Language& of = row_of(language);
    const std::string head =
        fmt::format("// {}: {}.\n// Written by srbf; the text is under the MIT License.\n\n", of.usage, list);
    if (!of.is_guarded) return fmt::format("{}{}{}", head, of.opening, definitions);
    for (char& c : guard) c = char(std::toupper(static_cast<unsigned char>(c)));
    return fmt::format("{0}#ifndef {1}\n#define {1}\n\n{2}{3}#endif\n", head, guard, of.opening, definitions);
}

bool reads_buffers(CodeLanguage language) { return row_of(language).reads_buffers; }

}  // namespace srbf::syntax
