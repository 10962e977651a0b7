// Readers of `.ply` and `.obj`. Of the alternatives in Debian, tinyobjloader reads invalid numbers as 0 and has no PLY,
// and assimp 5.2 writes beyond its buffers for some damaged files of both.

#include <bit>
#include <cstring>
#include <limits>
#include <map>

#include "base/errors.h"
#include "base/text.h"
#include "extras/render/mesh.h"
#include "src/base/floating_point.h"

namespace SRBF_NAMESPACE {
namespace {

/// Maximum number of vertices and of corners; as an index it stands for none.
constexpr std::uint32_t k_none = std::numeric_limits<std::uint32_t>::max();

bool is_finite(Vec3f p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Adds the triangle fan (first, k, k+1) of a polygon; nothing for fewer than three corners.
void add_polygon(const std::vector<std::uint32_t>& corners, std::vector<Triangle>& triangles) {
    for (std::size_t k = 2; k < corners.size(); ++k) triangles.push_back({corners[0], corners[k - 1], corners[k]});
}

/// Texture coordinates of a file, whose v goes upwards.
Vec2f texture_coordinates(float u, float v) {
    return std::isfinite(u) && std::isfinite(v) ? Vec2f{u, 1 - v} : Vec2f{0, 0};
}

/// The signed volume enclosed by the triangles, negative if they are clockwise seen from outside.
double signed_volume(const Mesh& mesh) {
    const Vec3d origin = to_double(bounds(mesh).min);
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](std::size_t k) { return to_double(mesh.positions[t[k]]) - origin; };
        sum += dot(corner(0), cross(corner(1), corner(2)));
    }
    return sum / 6;
}

/// Completes a mesh with unit normals: its own where they exist, otherwise from its triangles. A surface without
/// normals may be inside out: its orientation is inverted if it encloses a negative volume. Returns an error if there
/// are no triangles, or if coordinates or the extent are beyond the limits in mesh.h.
Result<Mesh> complete_mesh(Mesh mesh, const std::string& file_name) {
    if (mesh.triangles.empty()) return Error{file_name, {}, "faces of the mesh", "one at least", "none"};
    const auto& [min, max] = bounds(mesh);
    const float furthest = std::max({-min.x, -min.y, -min.z, max.x, max.y, max.z}),
                extent = std::max({max.x - min.x, max.y - min.y, max.z - min.z});
    if (furthest > k_furthest_vertex)
        return input_error(file_name, "coordinates of the mesh", fmt::format("at most {:g} from 0", k_furthest_vertex),
                           fmt::format("{:g}", furthest));
    if (extent < k_min_extent)
        return input_error(file_name, "extent of the mesh", fmt::format("at least {:g}", k_min_extent),
                           fmt::format("{:g}", extent));
    if (mesh.normals.empty() && signed_volume(mesh) < 0) {
        for (auto& corners : mesh.triangles) std::swap(corners[1], corners[2]);
        for (auto& corners : mesh.texture) std::swap(corners[1], corners[2]);
    }
    std::vector<Vec3f> normals = area_weighted_normals(mesh.positions, mesh.triangles);
    for (std::size_t i = 0; i < mesh.normals.size(); ++i)
        if (const Vec3d n = to_double(mesh.normals[i]); dot(n, n) > 0) normals[i] = to_float(normalize(n));
    mesh.normals = std::move(normals);
    return mesh;
}

// ---- .ply --------------------------------------------------------------------------------------------------------

/// A type of numbers, with its two names.
struct Type {
    std::array<std::string_view, 2> names;
    std::size_t size;
    bool is_whole;
    double (*number)(const std::byte* bytes);
};
template <typename T> constexpr Type type_of(std::string_view name, std::string_view other) {
    return {{name, other}, sizeof(T), std::is_integral_v<T>, [](const std::byte* bytes) {
                T number;
                std::memcpy(&number, bytes, sizeof number);
                return double(number);
            }};
}
constexpr std::array<Type, 8> k_types{
    type_of<std::int8_t>("char", "int8"),    type_of<std::uint8_t>("uchar", "uint8"),
    type_of<std::int16_t>("short", "int16"), type_of<std::uint16_t>("ushort", "uint16"),
    type_of<std::int32_t>("int", "int32"),   type_of<std::uint32_t>("uint", "uint32"),
    type_of<float>("float", "float32"),      type_of<double>("double", "float64")};
/// The type with this name, or nullptr.
const Type* type_named(std::string_view name) {
    const auto row =
        std::ranges::find_if(k_types, [&](const Type& type) { return type.names[0] == name || type.names[1] == name; });
    return row == k_types.end() ? nullptr : &*row;
}

struct Property {
    std::string name;
    const Type *type = nullptr, *length = nullptr;  ///< `length`: for a list
};
struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

constexpr std::size_t k_max_elements = 64, k_max_properties = 256;

/// The destination of a vertex property: a coordinate of the position (0 to 2), of the normal (3 to 5) or of the
/// texture (6, 7), or no destination (8).
constexpr std::size_t k_destinations = 9;
std::size_t destination_of(const std::string& name) {
    constexpr std::array<std::string_view, 8> names{"x", "y", "z", "nx", "ny", "nz", "s", "t"};
    if (name == "u" || name == "texture_u") return 6;
    if (name == "v" || name == "texture_v") return 7;
    return std::size_t(std::ranges::find(names, name) - names.begin());
}

class PlyReader {
  public:
    PlyReader(std::span<const std::byte> bytes, const std::string& file_name) : bytes_(bytes), file_name_(file_name) {}

    Result<Mesh> read() && {
        if (const auto done = read_header(); !done) return done.error();
        for (std::size_t i = 0; i < elements_.size(); ++i) {
            const std::string& name = elements_[i].name;
            const auto first = std::ranges::find(elements_, name, &Element::name);
            if (first != elements_.begin() + std::ptrdiff_t(i) && (name == "vertex" || name == "face"))
                return Error{file_name_, 0, "elements of a .ply", "one " + name, "a second one"};
            if (const auto done = read_rows(elements_[i]); !done) return done.error();
        }
        if (std::ranges::find(elements_, "vertex", &Element::name) == elements_.end())
            return Error{file_name_, 0, "elements of a .ply", "vertex", "none of that name"};
        const auto count = mesh_.positions.size();
        for (const Triangle& t : mesh_.triangles) {
            for (const std::uint32_t i : t)
                if (i >= count)
                    return Error{
                        file_name_, {}, "vertex index of a face", fmt::format("below {}", count), std::to_string(i)};
            if (!texture_.empty()) mesh_.texture.push_back({texture_[t[0]], texture_[t[1]], texture_[t[2]]});
        }
        return complete_mesh(std::move(mesh_), file_name_);
    }

  private:
    static constexpr std::string_view k_blanks = " \t\r\n";
    enum class Encoding { ascii, little, big };

    Result<Done> read_header() {
        const std::string_view text = as_text(bytes_);
        constexpr std::string_view last = "\nend_header";
        const auto mark = text.find(last), end = mark == text.npos ? mark : text.find('\n', mark + last.size());
        if (!text.starts_with("ply") || end == text.npos)
            return Error{file_name_, 0, "header of a .ply", "lines from ply to end_header",
                         text.starts_with("ply") ? "no end_header" : quoted(trimmed(text.substr(0, text.find('\n'))))};
        offset_ = end + 1;
        bool has_format = false;
        Lines lines(text.substr(0, mark));
        while (auto line = lines.next()) {
            const auto fail = [&](const char* what, std::string expected, std::string_view found) {
                return at_line(file_name_, lines.number(), what, std::move(expected), quoted(found));
            };
            const std::string_view keyword = next_word(*line);
            if (keyword == "format") {
                constexpr std::array<std::string_view, 3> names{"ascii", "binary_little_endian", "binary_big_endian"};
                const std::string_view word = next_word(*line);
                const auto name = std::ranges::find(names, word);
                if (name == names.end())
                    return fail("format of a .ply", "ascii, binary_little_endian or binary_big_endian", word);
                encoding_ = Encoding(name - names.begin());
                has_format = true;
            } else if (keyword == "element") {
                Element element{std::string(next_word(*line).substr(0, 40)), 0, {}};
                const std::string_view word = next_word(*line);
                const auto count = to_number<std::uint64_t>(word);
                if (!count || elements_.size() == k_max_elements)
                    return fail("element of a .ply", fmt::format("at most {}, each with a count", k_max_elements),
                                word);
                element.count = *count;
                elements_.push_back(std::move(element));
            } else if (keyword == "property") {
                if (elements_.empty() || elements_.back().properties.size() == k_max_properties)
                    return fail("property of a .ply", fmt::format("after its element, at most {}", k_max_properties),
                                *line);
                Property property;
                std::string_view word = next_word(*line);
                if (word == "list") {
                    word = next_word(*line);
                    property.length = type_named(word);
                    if (!property.length || !property.length->is_whole)
                        return fail("type of a list's length", "a type of integers", word);
                    word = next_word(*line);
                }
                property.type = type_named(word);
                if (!property.type) return fail("type of a property", "char, uchar, short to double", word);
                property.name = next_word(*line);
                elements_.back().properties.push_back(std::move(property));
            }
        }
        if (!has_format) return Error{file_name_, 0, "header of a .ply", "a line that begins with format", "none"};
        return Done{};
    }

    /// The minimum size in bytes of a number, including the separator of a text.
    std::size_t min_bytes(const Type& type) const { return encoding_ == Encoding::ascii ? 2 : type.size; }
    /// True if the remaining bytes can hold as many; the last number of a text needs no separator.
    bool may_hold(std::uint64_t count, std::uint64_t bytes_each) const {
        return count == 0 || bytes_each == 0 || count <= (bytes_.size() - offset_ + 1) / bytes_each;
    }

    std::optional<double> next(const Type& type) {
        if (encoding_ == Encoding::ascii) {
            const std::string_view text = as_text(bytes_);
            offset_ = std::min(text.find_first_not_of(k_blanks, offset_), text.size());
            const auto end = std::min(text.find_first_of(k_blanks, offset_), text.size());
            const auto number = to_number<double>(text.substr(offset_, end - offset_));
            if (number) offset_ = end;
            return number;
        }
        if (bytes_.size() - offset_ < type.size) return {};
        std::array<std::byte, 8> raw{};
        std::copy_n(&bytes_[offset_], type.size, raw.begin());
        offset_ += type.size;
        static_assert(std::endian::native == std::endian::little);
        if (encoding_ == Encoding::big) std::reverse(raw.begin(), raw.begin() + std::ptrdiff_t(type.size));
        return type.number(raw.data());
    }

    Error fail(std::string what, std::string expected, std::string found) const {
        return {file_name_, offset_, std::move(what), std::move(expected), std::move(found)};
    }
    Error no_number(const Element& element, std::uint64_t row) const {
        std::string_view rest = as_text(bytes_.subspan(offset_, std::min<std::size_t>(bytes_.size() - offset_, 60)));
        return fail(
            fmt::format("{} {} of {}", element.name, row + 1, element.count), "a number",
            rest.empty() || encoding_ != Encoding::ascii ? "the end of the file" : quoted(next_word(rest, k_blanks)));
    }

    /// Reads the rows of an element: vertices, the corners of faces, or rows to skip.
    Result<Done> read_rows(const Element& element) {
        const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
        std::uint64_t min_row = 0;  // its scalars and the lengths of its lists
        std::array<bool, k_destinations> has{};
        const Property* indices = nullptr;
        for (const Property& property : element.properties) {
            min_row += min_bytes(property.length ? *property.length : *property.type);
            if (!property.length) has[destination_of(property.name)] = true;
            if (is_face && !indices && property.length &&
                (property.name == "vertex_indices" || property.name == "vertex_index"))
                indices = &property;
        }
        if (!may_hold(element.count, min_row) || element.count > k_none)
            return fail(fmt::format("number of elements {}", element.name), "as many as the file's size can hold",
                        std::to_string(element.count));
        if (is_vertex && !(has[0] && has[1] && has[2]))
            return Error{file_name_, 0, "properties of a vertex", "x, y and z", "not all of them"};
        if (element.properties.empty()) return Done{};
        const bool has_normals = has[3] && has[4] && has[5], has_texture = has[6] && has[7];
        std::vector<std::uint32_t> corners;
        for (std::uint64_t row = 0; row < element.count; ++row) {
            std::array<float, k_destinations> x{};
            for (const Property& property : element.properties) {
                if (property.length) {
                    corners.clear();
                    const auto done = read_list(element, row, property, &property == indices ? &corners : nullptr);
                    if (!done) return done.error();
                    add_polygon(corners, mesh_.triangles);
                } else if (const auto number = next(*property.type)) {
                    constexpr double max = std::numeric_limits<float>::max();
                    x[destination_of(property.name)] =
                        std::abs(*number) <= max ? float(*number) : std::numeric_limits<float>::quiet_NaN();
                } else {
                    return no_number(element, row);
                }
            }
            if (!is_vertex) continue;
            const Vec3f position{x[0], x[1], x[2]}, normal{x[3], x[4], x[5]};
            if (!is_finite(position) || (has_normals && !is_finite(normal)))
                return fail(fmt::format("vertex {} of {}", row + 1, element.count), "finite numbers", "");
            mesh_.positions.push_back(position);
            if (has_normals) mesh_.normals.push_back(normal);
            if (has_texture) texture_.push_back(texture_coordinates(x[6], x[7]));
        }
        return Done{};
    }

    /// Reads the list of a row into `list`, or skips it if `list` is null.
    Result<Done> read_list(const Element& element, std::uint64_t row, const Property& property,
                           std::vector<std::uint32_t>* list) {
        const auto is_count = [](double x) { return x >= 0 && x <= double(k_none) && x == std::floor(x); };
        const auto length = next(*property.length);
        if (!length) return no_number(element, row);
        if (!is_count(*length) || !may_hold(std::uint64_t(*length), min_bytes(*property.type)))
            return fail(fmt::format("length of a list of {} {}", element.name, row + 1),
                        "one that the file's size can hold", fmt::format("{:.12g}", *length));
        for (auto k = std::uint64_t(*length); k > 0; --k) {
            const auto number = next(*property.type);
            if (!number) return no_number(element, row);
            if (!list) continue;
            if (!is_count(*number))
                return fail(fmt::format("vertex index of face {}", row + 1), "a number from 0 on",
                            fmt::format("{:.12g}", *number));
            list->push_back(std::uint32_t(*number));
        }
        return Done{};
    }

    std::span<const std::byte> bytes_;
    const std::string& file_name_;
    std::size_t offset_ = 0;
    Encoding encoding_{};
    std::vector<Element> elements_;
    Mesh mesh_;
    std::vector<Vec2f> texture_;  // texture coordinates of the vertices
};

// ---- .obj --------------------------------------------------------------------------------------------------------

/// An index into `count` elements, counted from 1 or, if negative, from the end. The result is counted from 0.
std::uint32_t read_index(std::string_view word, std::size_t count) {
    const auto number = to_number<std::int64_t>(word);
    if (!number || *number == 0) return k_none;
    const std::int64_t index = *number > 0 ? *number - 1 : std::int64_t(count) + *number;
    return index >= 0 && index < std::int64_t(count) ? std::uint32_t(index) : k_none;
}

/// A corner of a face: indices of its position, its normal and its texture coordinates; k_none if missing.
struct Corner {
    std::uint32_t position = k_none, normal = k_none, texture = k_none;
};

}  // namespace

Result<Mesh> read_ply(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    return PlyReader(bytes, file_name).read();
}

Result<Mesh> read_obj(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    std::vector<Vec3f> positions, normals;
    std::vector<Vec2f> texture;
    std::vector<Corner> corners;
    std::vector<Triangle> triangles;  // indices of corners
    bool all_have_normals = true, all_have_texture = true;
    Lines lines(as_text(bytes));
    while (auto line = lines.next()) {
        const std::string_view keyword = next_word(*line);
        if (keyword == "v" || keyword == "vn") {  // further numbers (a weight, a colour) are ignored
            const std::string_view numbers = *line;
            const auto x = to_number<float>(next_word(*line)), y = to_number<float>(next_word(*line)),
                       z = to_number<float>(next_word(*line));
            if (!x || !y || !z || !is_finite(Vec3f{*x, *y, *z}))
                return at_line(file_name, lines.number(), std::string(keyword), "three numbers", quoted(numbers));
            (keyword == "v" ? positions : normals).push_back({*x, *y, *z});
        } else if (keyword == "vt") {
            const auto u = to_number<float>(next_word(*line)), v = to_number<float>(next_word(*line));
            texture.push_back(texture_coordinates(u.value_or(0), v.value_or(0)));
        } else if (keyword == "f") {
            std::vector<std::uint32_t> polygon;
            for (auto word = next_word(*line); !word.empty() && word[0] != '#'; word = next_word(*line)) {
                const auto slash = word.find('/'), second = slash == word.npos ? slash : word.find('/', slash + 1);
                Corner corner{read_index(word.substr(0, slash), positions.size())};
                if (slash != word.npos)
                    corner.texture = read_index(word.substr(slash + 1, second - slash - 1), texture.size());
                if (second != word.npos) corner.normal = read_index(word.substr(second + 1), normals.size());
                if (corner.position == k_none || (second != word.npos && corner.normal == k_none) ||
                    corners.size() >= k_none)
                    return at_line(
                        file_name, lines.number(), "corner of a face",
                        fmt::format("one of the {} vertices and {} normals so far", positions.size(), normals.size()),
                        quoted(word));
                all_have_normals &= corner.normal != k_none;
                all_have_texture &= corner.texture != k_none;
                polygon.push_back(std::uint32_t(corners.size()));
                corners.push_back(corner);
            }
            add_polygon(polygon, triangles);
        }
    }

    // One vertex for each pair of position and normal.
    all_have_normals &= !normals.empty();
    Mesh mesh;
    if (!all_have_normals) mesh.positions = std::move(positions);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> vertex_of;
    for (const Triangle& t : triangles) {
        Triangle& triangle = mesh.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const Corner& corner = corners[t[k]];
            triangle[k] = corner.position;
            if (!all_have_normals) continue;
            const auto next = std::uint32_t(mesh.positions.size());
            const auto [vertex, is_new] = vertex_of.emplace(std::pair(corner.position, corner.normal), next);
            triangle[k] = vertex->second;
            if (is_new) {
                mesh.positions.push_back(positions[corner.position]);
                mesh.normals.push_back(normals[corner.normal]);
            }
        }
        const auto place = [&](std::size_t k) { return texture[corners[t[k]].texture]; };
        if (all_have_texture) mesh.texture.push_back({place(0), place(1), place(2)});
    }
    return complete_mesh(std::move(mesh), file_name);
}

}  // namespace
