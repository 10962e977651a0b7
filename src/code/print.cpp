#include "code/print.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <utility>

#include "base/printable.h"

namespace SRBF_NAMESPACE::syntax {

using Word = std::pair<std::string_view, std::string_view>;

/// The properties of a language. The defaults are those of GLSL.
struct Language {
    std::string_view usage;          ///< a comment on the usage of a file
    std::vector<Word> words;         ///< the names of types and built-in functions, if they are not those of GLSL
    std::string_view function = {};  ///< precedes the definition of a function
    std::string_view table;  ///< the definition of a constant array: {0} is its name, {1} its size, {2} the numbers
    std::string_view suffix = {};   ///< the suffix of a number with a decimal point
    std::string_view opening = {};  ///< the definitions that all files require
    bool is_guarded = true;         ///< files have an include guard
    bool types_follow = false;  ///< WGSL's syntax: name: type, let and var, array<type, size>, select() instead of ?:
    bool is_c = false;          ///< typedef struct, casts, and numbers for true and false
    std::string_view vector = {};          ///< the constructor of Vec3, if it is not the type's name
    bool has_operators = true;             ///< vectors have operators; if not, there are functions, also for tables
    std::string_view functions = "srbf_";  ///< the prefix of these functions
    bool has_lanes = false;                ///< a number is a vector of numbers
    bool reads_buffers = true;             ///< functions can read data of the host without parameters for it
};

namespace {

using EKind = Expression::Kind;
using SKind = Statement::Kind;

constexpr std::size_t k_columns = 120;

constexpr const char* k_opening_of_c = R"(#include <math.h>
#include <string.h>

#ifndef SRBF_VEC3
#define SRBF_VEC3
#ifdef __CUDACC__
#define SRBF_FN __host__ __device__ static inline
#elif defined __GNUC__ && defined __OPTIMIZE_SIZE__
#define SRBF_FN static __attribute__((unused))
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
// The processor's instruction, without sqrtf's errno.
#if defined __SSE__ && !defined __CUDACC__
#include <xmmintrin.h>
SRBF_FN float srbf_sqrt(float x) { return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))); }
#else
SRBF_FN float srbf_sqrt(float x) { return sqrtf(x); }
#endif
SRBF_FN float srbf_inversesqrt(float x) { return 1.0f / srbf_sqrt(x); }
// True if no component is a NaN, infinite, or 2^50 and more: by bits, since fast math takes every number for finite.
SRBF_FN int srbf_is_finite(srbf_vec3 w) {
    unsigned bits[3];
    memcpy(bits, &w, sizeof bits);
    return bits[0] << 1 < 0xb1000000u && bits[1] << 1 < 0xb1000000u && bits[2] << 1 < 0xb1000000u;
}
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
                    {"sqrt", "srbf_sqrt"},
                    {"cos", "cosf"},
                    {"sin", "sinf"},
                    {"acos", "acosf"},
                    {"abs", "fabsf"},
                    {"is_finite", "srbf_is_finite"}},
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

const Language& lanes_of_c() {
    static const Language lanes = [] {
        Language row = row_of(CodeLanguage::c);
        row.words = {{"Real", "srbf_x"},
                     {"Vec3", "srbf_x_vec3"},
                     {"bool", "int"},
                     {"dot", "srbf_x_dot"},
                     {"min", "srbf_x_min"},
                     {"max", "srbf_x_max"},
                     {"exp", "srbf_x_exp"},
                     {"exp2", "srbf_x_exp2"},
                     {"log", "srbf_x_log"},
                     {"sqrt", "srbf_x_sqrt"},
                     {"inversesqrt", "srbf_x_inversesqrt"}};
        row.vector = "srbf_x_vec3_of";
        row.functions = "srbf_x_";
        row.has_lanes = true;
        return row;
    }();
    return lanes;
}

/// Names in the kernel that one of the languages reserves.
constexpr std::array<std::string_view, 6> k_reserved{"from", "of", "part", "half", "sample", "target"};

constexpr int k_conditional_level = 1, k_unary_level = 8, k_primary_level = 9;
int precedence(const Expression& expression) {
    if (expression.kind == EKind::conditional) return k_conditional_level;
    if (expression.kind == EKind::unary) return k_unary_level;
    if (expression.kind != EKind::binary) return k_primary_level;
    constexpr std::array<std::string_view, 6> levels{" || ", " && ", " == != ", " < > <= >= ", " + - ", " * / % "};
    const auto level = std::ranges::find_if(levels, [&](std::string_view operators) {
        return operators.find(" " + expression.text + " ") != operators.npos;
    });
    return k_conditional_level + 1 + int(level - levels.begin());
}

/// True if a condition depends on numbers, or is a host's bool that does.
bool is_of_lanes(const Expression& condition) {
    if (condition.kind == EKind::call) return condition.text == "pm_down";
    return condition.kind == EKind::binary && condition.parts[0].type.name == "Real";
}

/// Breaks a line before column `k_columns` at blanks after characters that `may_break` accepts, and indents the rest.
template <typename MayBreak>
std::string break_line(std::string line, const std::string& indent, const MayBreak& may_break) {
    std::string text;
    while (line.size() > k_columns) {
        std::size_t blank = line.rfind(' ', k_columns);
        while (blank != line.npos && blank > indent.size() && !may_break(line[blank - 1]))
            blank = line.rfind(' ', blank - 1);
        if (blank == line.npos || blank <= indent.size()) break;
        text += line.substr(0, blank) + "\n";
        line = indent + line.substr(blank + 1);
    }
    return text + line + "\n";
}

/// Breaks code after commas and operators.
std::string code_line(const std::string& line, int depth) {
    return break_line(line, std::string(std::size_t(4 * (depth + 2)), ' '),
                      [](char before) { return std::string_view(",+*?:=").find(before) != std::string_view::npos; });
}

}  // namespace

std::string are_finite(CodeLanguage language, std::initializer_list<std::string_view> directions) {
    const bool by_bits = language == CodeLanguage::c;
    const char* const between = by_bits ? " && " : " + ";
    std::string text;
    for (const std::string_view w : directions)
        text += fmt::format("{}{}", text.empty() ? "" : between,
                            by_bits ? fmt::format("is_finite({})", w) : fmt::format("dot({0}, {0})", w));
    return by_bits ? text : text + " < Real(1.0e30)";
}

Printer::Printer(CodeLanguage language, std::map<std::string, std::string> names)
    : Printer(row_of(language), std::move(names)) {}
Printer::Printer(const Language& language, std::map<std::string, std::string> names)
    : language_(language), names_(std::move(names)) {}
Printer Printer::for_lanes(std::map<std::string, std::string> names) { return {lanes_of_c(), std::move(names)}; }

std::string digits(float number) {
    std::string text = fmt::format("{}", number);
    if (text.find_first_of(".e") == text.npos) text += ".0";
    return text;
}

std::string comment_text(const std::string& lines, int depth) {
    const std::string begin = std::string(std::size_t(4 * depth), ' ') + "// ";
    std::string text;
    for (std::size_t first = 0; first < lines.size();) {
        const std::size_t end = std::min(lines.find('\n', first), lines.size());
        text += break_line(begin + in_comment(lines.substr(first, end - first)), begin, [](char) { return true; });
        first = end + 1;
    }
    return text;
}

std::string Printer::printed_name(const std::string& name) const {
    if (const auto found = names_.find(name); found != names_.end()) return found->second;
    return std::ranges::find(k_reserved, std::string_view(name)) == k_reserved.end() ? name : name + "_";
}

std::string Printer::type_text(const Type& type) const {
    const auto found = std::ranges::find(language_.words, std::string_view(type.name), &Word::first);
    const std::string name = found != language_.words.end() ? std::string(found->second) : printed_name(type.name);
    return language_.types_follow && !type.size.empty() ? fmt::format("array<{}, {}>", name, type.size) : name;
}

std::string Printer::declaration(const Type& type, const std::string& name) const {
    if (language_.types_follow) return fmt::format("{}: {}", printed_name(name), type_text(type));
    const std::string size = type.size.empty() ? "" : fmt::format("[{}]", type.size);
    return fmt::format("{} {}{}", type_text(type), printed_name(name), size);
}

std::string Printer::call_text(const Expression& call) {
    std::string arguments;
    for (const Expression& argument : call.parts)
        arguments += (arguments.empty() ? "" : ", ") + expression_text(argument);
    const std::string name = type_text({call.text, ""});
    if (language_.is_c && (call.text == "Real" || call.text == "int")) return fmt::format("({})({})", name, arguments);
    if (call.text == "Vec3" && !language_.vector.empty()) return fmt::format("{}({})", language_.vector, arguments);
    return fmt::format("{}({})", name, arguments);
}

std::string Printer::binary_text(const Expression& binary, int outer) {
    const Expression &left = binary.parts[0], &right = binary.parts[1];
    if (!language_.has_operators && binary.type.name == "Vec3") {
        std::string_view name = "scale";
        if (binary.text == "+") name = "add";
        if (binary.text == "-") name = "subtract";
        const bool is_swapped = binary.text == "*" && left.type.name == "Vec3";
        const Expression &first = is_swapped ? right : left, &second = is_swapped ? left : right;
        return fmt::format("{}{}({}, {})", language_.functions, name, expression_text(first), expression_text(second));
    }
    const int inner = precedence(binary);
    const std::string text =
        fmt::format("{} {} {}", expression_text(left, inner), binary.text, expression_text(right, inner + 1));
    return inner < outer ? "(" + text + ")" : text;
}

std::string Printer::expression_text(const Expression& expression, int outer) {
    const std::vector<Expression>& parts = expression.parts;
    const auto part = [&](std::size_t i, int within = 0) { return expression_text(parts[i], within); };
    switch (expression.kind) {
        case EKind::number:
            if (expression.type.name == "bool" && language_.is_c) return expression.text == "true" ? "1" : "0";
            if (expression.type.name == "Real" && language_.has_lanes)
                return fmt::format("srbf_x_of({}{})", expression.text, language_.suffix);
            return expression.text + std::string(expression.type.name == "Real" ? language_.suffix : "");
        case EKind::name:
            return printed_name(expression.text);
        case EKind::call:
            return call_text(expression);
        case EKind::member:
            return part(0, k_primary_level) + "." + printed_name(expression.text);
        case EKind::index: {
            // In C a table is a function, since GPU programs may lack global arrays; so is a table of the host.
            const bool is_table = parts[0].kind == EKind::name && names_.contains(parts[0].text);
            const bool is_supplied = parts[0].type.size.empty();
            const char* brackets = is_table && (!language_.has_operators || is_supplied) ? "()" : "[]";
            return part(0, k_primary_level) + brackets[0] + part(1) + brackets[1];
        }
        case EKind::unary:
            if (!language_.has_operators && expression.type.name == "Vec3") {
                const Expression minus_one{EKind::number, "-1.0", {}, {"Real", ""}};
                return fmt::format("{}scale({}, {})", language_.functions, expression_text(minus_one), part(0));
            }
            return expression.text + part(0, k_unary_level);
        case EKind::binary:
            return binary_text(expression, outer);
        case EKind::conditional:
            if (language_.types_follow) return fmt::format("select({}, {}, {})", part(2), part(1), part(0));
            if (language_.has_lanes && is_of_lanes(parts[0]))
                return fmt::format("srbf_x_select({}, {}, {})", part(0), part(1), part(2));
            {
                const std::string text = fmt::format("{} ? {} : {}", part(0, 2), part(1, 1), part(2, 1));
                return outer > 1 ? "(" + text + ")" : text;
            }
    }
    return "";
}

void Printer::print_under(const std::string& head, const std::vector<Statement>& body,
                          const std::set<std::string>& changed, int depth, std::string& text) {
    const std::string indent(std::size_t(4 * depth), ' ');
    std::string inner;
    print(body, changed, depth + 1, inner);
    const std::string line = indent + head + " " + inner.substr(std::min(inner.size(), indent.size() + 4));
    const bool is_single =
        body.size() == 1 && body[0].comment.empty() && (body[0].kind == SKind::assign || body[0].kind == SKind::result);
    if (language_.types_follow || !is_single)
        text += code_line(indent + head + " {", depth) + inner + indent + "}\n";
    else if (line.size() <= k_columns + 1 && line.find('\n') + 1 == line.size())
        text += line;
    else
        text += code_line(indent + head, depth) + inner;
}

void Printer::print(const std::vector<Statement>& body, const std::set<std::string>& changed, int depth,
                    std::string& text) {
    const bool types_follow = language_.types_follow;
    const std::string indent(std::size_t(4 * depth), ' ');
    const auto add_line = [&](const std::string& line) { text += code_line(indent + line, depth); };
    for (const Statement& statement : body) {
        const auto value = [&](std::size_t i) { return expression_text(statement.values[i]); };
        text += comment_text(statement.comment, depth);
        switch (statement.kind) {
            case SKind::declare: {
                const bool is_variable = statement.values.empty() || changed.contains(statement.name);
                const std::string keyword = is_variable ? "var " : "let ";
                add_line((types_follow ? keyword : "") + declaration(statement.type, statement.name) +
                         (statement.values.empty() ? "" : " = " + value(0)) + ";");
                break;
            }
            case SKind::assign:
                add_line(fmt::format("{} = {};", value(0), value(1)));
                break;
            case SKind::result:
                add_line(fmt::format("return {};", value(0)));
                break;
            case SKind::branch: {
                print_under(fmt::format("if ({})", value(0)), statement.body, changed, depth, text);
                const std::vector<Statement>& otherwise = statement.otherwise;
                if (otherwise.empty()) break;
                std::string else_text;
                if (otherwise.size() == 1 && otherwise[0].kind == SKind::branch && otherwise[0].comment.empty()) {
                    print(otherwise, changed, depth, else_text);
                    else_text.insert(indent.size(), "else ");
                } else {
                    print_under("else", otherwise, changed, depth, else_text);
                }
                if (!text.ends_with("}\n")) {
                    text += else_text;
                } else {
                    text.back() = ' ';
                    text += else_text.substr(indent.size());
                }
                break;
            }
            case SKind::loop: {
                const std::string name = printed_name(statement.name);
                print_under(fmt::format("for ({} {} = {}; {} < {}; {})", types_follow ? "var" : "int", name, value(0),
                                        name, value(1), types_follow ? name + "++" : "++" + name),
                            statement.body, changed, depth, text);
                break;
            }
        }
    }
}

std::string Printer::text(const Structure& structure) {
    std::string text = comment_text(structure.comment, 0);
    text += fmt::format("{}{{\n", language_.is_c ? "typedef struct " : "struct " + printed_name(structure.name) + " ");
    const Type* type = nullptr;
    for (const Variable& member : structure.members) {
        if (type && !language_.types_follow && member.type.size.empty() && *type == member.type) {
            text.insert(text.size() - 2, ", " + printed_name(member.name));
        } else {
            text +=
                fmt::format("    {}{}\n", declaration(member.type, member.name), language_.types_follow ? "," : ";");
        }
        type = &member.type;
    }
    if (language_.types_follow) return text + "}\n";
    return text + (language_.is_c ? fmt::format("}} {};\n", printed_name(structure.name)) : "};\n");
}

std::string Printer::text(const Table& table) {
    if (table.numbers.empty()) return comment_text(fmt::format("{}(i): {}", printed_name(table.name), table.comment));
    const std::string name = printed_name(table.name);
    const std::size_t size = table.numbers.size();
    std::string numbers;
    for (std::size_t i = 0; i < size; ++i) {
        numbers += i % table.columns == 0 ? "    " : " ";
        numbers += fmt::format("{}{}{}", digits(table.numbers[i]), language_.suffix, i + 1 < size ? "," : "");
        if ((i + 1) % table.columns == 0 || i + 1 == size) numbers += "\n";
    }
    return comment_text(table.comment, 0) + fmt::format(fmt::runtime(language_.table), name, size, numbers);
}

std::string Printer::native_text(const std::string& native) const {
    std::string text;
    for (std::size_t begin = 0; begin < native.size();) {
        const std::size_t mark = std::min(native.find('@', begin), native.size()), end = native.find('@', mark + 1);
        text += native.substr(begin, mark - begin);
        if (mark < native.size()) text += printed_name(native.substr(mark + 1, end - mark - 1));
        begin = mark < native.size() ? end + 1 : mark;
    }
    return text;
}

std::string Printer::text(const Function& function) {
    if (!function.native.empty()) return comment_text(function.comment, 0) + native_text(function.native);
    std::set<std::string> changed;
    visit_statements(function.body, [&](const Statement& statement) {
        if (statement.kind == SKind::assign) changed.insert(assigned_variable(statement.values[0]));
    });
    std::string parameters;
    for (const auto& [parameter_type, parameter] : function.parameters)
        parameters += (parameters.empty() ? "" : ", ") + declaration(parameter_type, parameter);
    if (parameters.empty() && language_.is_c) parameters = "void";  // otherwise C accepts any arguments
    const std::string name = printed_name(function.name), type = type_text(function.type);
    if (function.body.empty()) {
        const std::string comment = comment_text(fmt::format("{}: {}", name, function.comment));
        if (language_.types_follow) return comment;  // WGSL needs no declaration
        const char* modifiers = language_.is_c ? "static " : "";
        return comment + fmt::format("#ifndef {1}\n{3}{0} {1}({2});\n#endif\n", type, name, parameters, modifiers);
    }
    const std::string head = language_.types_follow
                                 ? fmt::format("{}{}({}) -> {} {{", language_.function, name, parameters, type)
                                 : fmt::format("{}{} {}({}) {{", language_.function, type, name, parameters);
    std::string body;
    print(function.body, changed, 1, body);
    const std::string line = head + " " + body.substr(std::min<std::size_t>(body.size(), 4));
    if (function.body.size() == 1 && line.size() + 1 <= k_columns && line.find('\n') + 1 == line.size())
        return comment_text(function.comment, 0) + line.substr(0, line.size() - 1) + " }\n";
    return comment_text(function.comment, 0) + code_line(head, 0) + body + "}\n";
}

std::string whole_text(CodeLanguage language, const std::string& list, std::string guard,
                       const std::string& definitions) {
    const Language& row = row_of(language);
    const std::string head =
        fmt::format("// {}: {}.\n// Written by srbf; the text is under the MIT License.\n\n", row.usage, list);
    if (!row.is_guarded) return fmt::format("{}{}{}", head, row.opening, definitions);
    for (char& c : guard) c = char(std::toupper(static_cast<unsigned char>(c)));
    return fmt::format("{0}#ifndef {1}\n#define {1}\n\n{2}{3}#endif\n", head, guard, row.opening, definitions);
}

std::string definitions_of_c() { return k_opening_of_c; }

bool reads_buffers(CodeLanguage language) { return row_of(language).reads_buffers; }

}  // namespace srbf::syntax
