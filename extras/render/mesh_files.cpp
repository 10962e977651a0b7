// Readers of `.ply` and `.obj`. tinyobjloader, the alternative in Debian, reads invalid numbers as 0 and reports no
// line numbers.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <map>

#include "base/text.h"
#include "extras/render/mesh.h"
#include "src/base/floating_point.h"

namespace SRBF_NAMESPACE {
namespace {

/// Maximum number of vertices and of corners.
constexpr std::uint64_t k_most_numbers = std::numeric_limits<std::uint32_t>::max();

bool is_finite(Vec3f p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Adds the triangle fan (first, k, k+1) of a polygon; nothing for fewer than three corners.
void add_polygon(const std::vector<std::uint32_t>& corners, std::vector<Triangle>& triangles) {
    for (std::size_t k = 2; k < corners.size(); ++k) triangles.push_back({corners[0], corners[k - 1], corners[k]});
}

/// The signed volume enclosed by the triangles, negative if they are clockwise seen from outside.
double signed_volume(const Mesh& mesh) {
    const Vec3d origin = to_double(bounds(mesh).least);
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](std::size_t k) { return to_double(mesh.positions[t[k]]) - origin; };
        sum += dot(corner(0), cross(corner(1), corner(2)));
    }
    return sum / 6;
}

/// Errors: coordinates or an extent that a scene must not have (mesh.h).
Result<Done> check_size(const Mesh& mesh, const std::string& file_name) {
    const Bounds box = bounds(mesh);
    const auto& [x0, y0, z0] = box.least;
    const auto& [x1, y1, z1] = box.most;
    const float furthest = std::max({-x0, -y0, -z0, x1, y1, z1}), extent = std::max({x1 - x0, y1 - y0, z1 - z0});
    if (furthest > k_furthest_vertex)
        return Error{file_name,
                     {},
                     "coordinates of the mesh",
                     fmt::format("at most {:g} from 0", k_furthest_vertex),
                     fmt::format("{:g}", furthest)};
    if (extent < k_least_extent)
        return Error{file_name,
                     {},
                     "extent of the mesh",
                     fmt::format("at least {:g}", k_least_extent),
                     fmt::format("{:g}", extent)};
    return Done{};
}

/// Completes a mesh with unit normals: its own where they exist, otherwise from its triangles. A surface without
/// normals may be inside out: its orientation is inverted if it encloses a negative volume.
Result<Mesh> complete_mesh(Mesh mesh, const std::string& file_name) {
    if (mesh.triangles.empty()) return Error{file_name, {}, "faces of the mesh", "one at least", "none"};
    if (const auto fits = check_size(mesh, file_name); !fits) return fits.error();
    if (mesh.normals.empty() && signed_volume(mesh) < 0) {
        for (auto& corners : mesh.triangles) std::swap(corners[1], corners[2]);
        for (auto& corners : mesh.texture) std::swap(corners[1], corners[2]);
    }
    const std::vector<Vec3f> computed = area_weighted_normals(mesh.positions, mesh.triangles);
    if (mesh.normals.empty()) {
        mesh.normals = computed;
        return mesh;
    }
    for (std::size_t i = 0; i < computed.size(); ++i) {
        const Vec3d n = to_double(mesh.normals[i]);
        mesh.normals[i] = dot(n, n) > 0 ? to_float(normalize(n)) : computed[i];
    }
    return mesh;
}

/// Converts texture coordinates of a file, whose v goes upwards.
Vec2f texture_coordinates(float u, float v) {
    return std::isfinite(u) && std::isfinite(v) ? Vec2f{u, 1 - v} : Vec2f{0, 0};
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
    const Type* type = nullptr;
    const Type* count = nullptr;  ///< for a list: the type of its length
};
struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};
enum class Encoding { ascii, little, big };
struct Header {
    Encoding encoding{};
    std::vector<Element> elements;
    std::size_t end = 0;  ///< offset of the data
};

constexpr std::size_t k_most_elements = 64, k_most_properties = 256;

/// Reads a line `property ...` of the header, without its first word.
Result<Property> read_property(std::string_view words, const std::string& file_name, std::uint64_t line) {
    Property property;
    std::string_view word = next_word(words);
    if (word == "list") {
        word = next_word(words);
        property.count = type_named(word);
        if (!property.count || !property.count->is_whole)
            return at_line(file_name, line, "type of a list's length", "a type of integers", quoted(word));
        word = next_word(words);
    }
    property.type = type_named(word);
    if (!property.type)
        return at_line(file_name, line, "type of a property", "char, uchar, short to double", quoted(word));
    property.name = next_word(words);
    return property;
}

Result<Header> read_header(std::span<const std::byte> bytes, const std::string& file_name) {
    const std::string_view text = as_text(bytes);
    constexpr std::string_view last = "\nend_header";
    const auto mark = text.find(last);
    const auto end = mark == text.npos ? mark : text.find('\n', mark + last.size());
    if (!text.starts_with("ply") || end == text.npos)
        return Error{file_name, 0, "header of a .ply", "lines from ply to end_header",
                     text.starts_with("ply") ? "no end_header" : quoted(trimmed(text.substr(0, text.find('\n'))))};
    Header header;
    header.end = end + 1;
    bool has_format = false;
    Lines lines(text.substr(0, mark));
    while (auto line = lines.next()) {
        const std::string_view keyword = next_word(*line);
        if (keyword == "format") {
            const std::string_view encoding = next_word(*line);
            has_format = true;
            if (encoding == "ascii")
                header.encoding = Encoding::ascii;
            else if (encoding == "binary_little_endian")
                header.encoding = Encoding::little;
            else if (encoding == "binary_big_endian")
                header.encoding = Encoding::big;
            else
                return at_line(file_name, lines.number(), "format of a .ply",
                               "ascii, binary_little_endian or binary_big_endian", quoted(encoding));
        } else if (keyword == "element") {
            Element element;
            element.name = next_word(*line).substr(0, 40);
            const std::string_view word = next_word(*line);
            const auto count = to_number<std::uint64_t>(word);
            if (!count || header.elements.size() == k_most_elements)
                return at_line(file_name, lines.number(), "element of a .ply",
                               fmt::format("at most {}, each with a count", k_most_elements), quoted(word));
            element.count = *count;
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty() || header.elements.back().properties.size() == k_most_properties)
                return at_line(file_name, lines.number(), "property of a .ply",
                               fmt::format("after its element, at most {}", k_most_properties), quoted(*line));
            auto property = read_property(*line, file_name, lines.number());
            if (!property) return property.error();
            header.elements.back().properties.push_back(*std::move(property));
        }
    }
    if (!has_format) return Error{file_name, 0, "header of a .ply", "a line that begins with format", "none"};
    return header;
}

/// Reads consecutive numbers of a file's data.
class Numbers {
  public:
    Numbers(std::span<const std::byte> bytes, std::size_t offset, Encoding encoding)
        : bytes_(bytes), offset_(offset), encoding_(encoding) {}
    std::size_t offset() const { return offset_; }
    /// The minimum size in bytes of a number of this type, including its separator.
    std::size_t least_bytes(const Type& type) const { return encoding_ == Encoding::ascii ? 2 : type.size; }
    /// True if `count` numbers of this type may follow; the last number of a text needs no separator.
    bool may_hold(std::uint64_t count, std::uint64_t bytes_each) const {
        return count == 0 || bytes_each == 0 || count <= (bytes_.size() - offset_ + 1) / bytes_each;
    }
    std::optional<double> next(const Type& type) {
        return encoding_ == Encoding::ascii ? next_text() : next_bytes(type);
    }
    /// The text at the current offset, for an error message.
    std::string text_here() const {
        if (offset_ >= bytes_.size() || encoding_ != Encoding::ascii) return "the end of the file";
        std::string_view rest = as_text(bytes_.subspan(offset_, std::min<std::size_t>(bytes_.size() - offset_, 60)));
        return quoted(next_word(rest, k_blanks));
    }

  private:
    static constexpr std::string_view k_blanks = " \t\r\n";

    std::optional<double> next_text() {
        const std::string_view text = as_text(bytes_);
        const auto first = text.find_first_not_of(k_blanks, offset_);
        offset_ = std::min(first, text.size());
        const auto end = std::min(text.find_first_of(k_blanks, offset_), text.size());
        const auto number = to_number<double>(text.substr(offset_, end - offset_));
        if (number) offset_ = end;
        return number;
    }
    std::optional<double> next_bytes(const Type& type) {
        if (bytes_.size() - offset_ < type.size) return {};
        std::array<std::byte, 8> raw{};
        std::copy_n(&bytes_[offset_], type.size, raw.begin());
        offset_ += type.size;
        static_assert(std::endian::native == std::endian::little);
        if (encoding_ == Encoding::big) std::reverse(raw.begin(), raw.begin() + std::ptrdiff_t(type.size));
        return type.number(raw.data());
    }

    std::span<const std::byte> bytes_;
    std::size_t offset_;
    Encoding encoding_;
};

/// The nearest float, or NaN if x is out of range.
float to_float(double x) {
    constexpr float most = std::numeric_limits<float>::max();
    return std::abs(x) <= double(most) ? float(x) : std::numeric_limits<float>::quiet_NaN();
}

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
    PlyReader(std::span<const std::byte> bytes, const std::string& file_name, Header header)
        : file_name_(file_name), header_(std::move(header)), numbers_(bytes, header_.end, header_.encoding) {}

    Result<Mesh> read() && {
        bool has_vertices = false, has_faces = false;
        for (const Element& element : header_.elements) {
            if (auto fits = check_count(element); !fits) return fits.error();
            const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
            if ((is_vertex && has_vertices) || (is_face && has_faces))
                return Error{file_name_, 0, "elements of a .ply", "one " + element.name, "another"};
            auto done = is_vertex ? read_vertices(element) : read_rows(element, is_face ? index_property(element) : -1);
            if (!done) return done.error();
            has_vertices |= is_vertex;
            has_faces |= is_face;
        }
        if (!has_vertices) return Error{file_name_, 0, "elements of a .ply", "vertex", "none of that name"};
        for (const Triangle& triangle : mesh_.triangles)
            for (const std::uint32_t i : triangle)
                if (i >= mesh_.positions.size())
                    return Error{file_name_,
                                 {},
                                 "vertex index of a face",
                                 fmt::format("below {}", mesh_.positions.size()),
                                 std::to_string(i)};
        if (!texture_.empty())
            for (const Triangle& t : mesh_.triangles)
                mesh_.texture.push_back({texture_[t[0]], texture_[t[1]], texture_[t[2]]});
        return complete_mesh(std::move(mesh_), file_name_);
    }

  private:
    /// Checks that the file can hold the rows of an element. A row has at least its scalars and the lengths of its
    /// lists.
    Result<Done> check_count(const Element& element) const {
        std::uint64_t row = 0;
        for (const Property& property : element.properties)
            row += numbers_.least_bytes(property.count ? *property.count : *property.type);
        if (numbers_.may_hold(element.count, row) && element.count <= k_most_numbers) return Done{};
        return Error{file_name_, numbers_.offset(), fmt::format("number of elements {}", element.name),
                     "as many as the file's size can hold", std::to_string(element.count)};
    }

    Error no_number(const Element& element, std::uint64_t row) const {
        return Error{file_name_, numbers_.offset(), fmt::format("{} {} of {}", element.name, row + 1, element.count),
                     "a number", numbers_.text_here()};
    }

    static int index_property(const Element& element) {
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            const Property& property = element.properties[i];
            if (property.count && (property.name == "vertex_indices" || property.name == "vertex_index")) return int(i);
        }
        return -1;
    }

    Result<Done> read_vertices(const Element& element) {
        std::array<bool, k_destinations> has{};
        for (const Property& property : element.properties)
            if (!property.count) has[destination_of(property.name)] = true;
        if (!(has[0] && has[1] && has[2]))
            return Error{file_name_, 0, "properties of a vertex", "x, y and z", "not all of them"};
        const bool has_normals = has[3] && has[4] && has[5];
        mesh_.positions.resize(std::size_t(element.count));
        if (has_normals) mesh_.normals.resize(std::size_t(element.count));
        if (has[6] && has[7]) texture_.resize(std::size_t(element.count));
        for (std::uint64_t row = 0; row < element.count; ++row) {
            std::array<float, k_destinations> coordinates{};
            for (const Property& property : element.properties) {
                if (property.count) {
                    if (auto passed = read_list(element, row, property, nullptr); !passed) return passed.error();
                    continue;
                }
                const auto number = numbers_.next(*property.type);
                if (!number) return no_number(element, row);
                coordinates[destination_of(property.name)] = to_float(*number);
            }
            const Vec3f position{coordinates[0], coordinates[1], coordinates[2]},
                normal{coordinates[3], coordinates[4], coordinates[5]};
            if (!is_finite(position) || (has_normals && !is_finite(normal)))
                return Error{file_name_, numbers_.offset(), fmt::format("vertex {} of {}", row + 1, element.count),
                             "finite numbers", "others"};
            mesh_.positions[std::size_t(row)] = position;
            if (has_normals) mesh_.normals[std::size_t(row)] = normal;
            if (!texture_.empty()) texture_[std::size_t(row)] = texture_coordinates(coordinates[6], coordinates[7]);
        }
        return Done{};
    }

    /// Reads the list of a row into `list`, or skips it if `list` is null.
    Result<Done> read_list(const Element& element, std::uint64_t row, const Property& property,
                           std::vector<std::uint32_t>* list) {
        const auto length = numbers_.next(*property.count);
        if (!length) return no_number(element, row);
        if (!(*length >= 0) || *length != std::floor(*length) || *length > double(k_most_numbers) ||
            !numbers_.may_hold(std::uint64_t(*length), numbers_.least_bytes(*property.type)))
            return Error{file_name_, numbers_.offset(), fmt::format("length of a list of {} {}", element.name, row + 1),
                         "one that the file's size can hold", fmt::format("{:.12g}", *length)};
        for (std::uint64_t k = 0; k < std::uint64_t(*length); ++k) {
            const auto number = numbers_.next(*property.type);
            if (!number) return no_number(element, row);
            if (!list) continue;
            if (!(*number >= 0 && *number <= double(k_most_numbers)) || *number != std::floor(*number))
                return Error{file_name_, numbers_.offset(), fmt::format("vertex index of face {}", row + 1),
                             "a number from 0 on", fmt::format("{:.12g}", *number)};
            list->push_back(std::uint32_t(*number));
        }
        return Done{};
    }

    /// Skips the rows of an element, except that property `index`, unless it is −1, holds the corners of a face.
    Result<Done> read_rows(const Element& element, int index) {
        if (element.properties.empty()) return Done{};
        std::vector<std::uint32_t> corners;
        for (std::uint64_t row = 0; row < element.count; ++row)
            for (std::size_t i = 0; i < element.properties.size(); ++i) {
                const Property& property = element.properties[i];
                if (!property.count) {
                    if (!numbers_.next(*property.type)) return no_number(element, row);
                    continue;
                }
                corners.clear();
                auto done = read_list(element, row, property, int(i) == index ? &corners : nullptr);
                if (!done) return done.error();
                add_polygon(corners, mesh_.triangles);
            }
        return Done{};
    }

    const std::string& file_name_;
    Header header_;
    Numbers numbers_;
    Mesh mesh_;
    std::vector<Vec2f> texture_;  // of the vertices
};

// ---- .obj --------------------------------------------------------------------------------------------------------

/// The three numbers of a line `v` or `vn`. Further numbers (a weight, a colour) are ignored.
std::optional<Vec3f> read_vector(std::string_view words) {
    const auto x = to_number<float>(next_word(words)), y = to_number<float>(next_word(words)),
               z = to_number<float>(next_word(words));
    if (!x || !y || !z || !is_finite(Vec3f{*x, *y, *z})) return {};
    return Vec3f{*x, *y, *z};
}

/// An index into `count` elements, counted from 1 or, if negative, from the end. The result is counted from 0.
std::optional<std::uint32_t> read_index(std::string_view word, std::size_t count) {
    const auto number = to_number<std::int64_t>(word);
    if (!number || *number == 0) return {};
    const std::int64_t index = *number > 0 ? *number - 1 : std::int64_t(count) + *number;
    return index >= 0 && index < std::int64_t(count) ? std::optional(std::uint32_t(index)) : std::nullopt;
}

constexpr std::uint32_t k_none = std::numeric_limits<std::uint32_t>::max();
/// A corner of a face: indices of its position, its normal and its texture coordinates; k_none if missing.
struct Corner {
    std::uint32_t position, normal = k_none, texture = k_none;
};

/// No value if the position or the normal does not exist.
std::optional<Corner> read_corner(std::string_view word, std::size_t positions, std::size_t normals,
                                  std::size_t texture) {
    const auto slash = word.find('/'), second = slash == word.npos ? slash : word.find('/', slash + 1);
    const auto position = read_index(word.substr(0, slash), positions);
    if (!position) return {};
    Corner corner{*position};
    if (slash != word.npos)
        corner.texture = read_index(word.substr(slash + 1, second - slash - 1), texture).value_or(k_none);
    if (second == word.npos) return corner;
    const auto normal = read_index(word.substr(second + 1), normals);
    if (!normal) return {};
    corner.normal = *normal;
    return corner;
}

/// Adds the triangles, which index corners, with one vertex for each pair of position and normal.
void add_vertices(std::span<const Triangle> triangles, std::span<const Corner> corners,
                  std::span<const Vec3f> positions, std::span<const Vec3f> normals, Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> vertex_of;
    for (const Triangle& t : triangles) {
        Triangle& triangle = mesh.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const Corner& corner = corners[t[k]];
            const auto [vertex, is_new] =
                vertex_of.emplace(std::pair(corner.position, corner.normal), std::uint32_t(mesh.positions.size()));
            triangle[k] = vertex->second;
            if (!is_new) continue;
            mesh.positions.push_back(positions[corner.position]);
            mesh.normals.push_back(normals[corner.normal]);
        }
    }
}

}  // namespace

Result<Mesh> read_ply(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    auto header = read_header(bytes, file_name);
    if (!header) return header.error();
    return PlyReader(bytes, file_name, *std::move(header)).read();
}

Result<Mesh> read_obj(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    std::vector<Vec3f> positions, normals;
    std::vector<Vec2f> texture;
    std::vector<Corner> corners;
    std::vector<Triangle> triangles;  // indices of corners
    bool every_corner_has_a_normal = true, every_corner_has_texture = true;
    Lines lines(as_text(bytes));
    while (auto line = lines.next()) {
        const std::string_view keyword = next_word(*line);
        if (keyword == "v" || keyword == "vn") {
            const auto vector = read_vector(*line);
            if (!vector)
                return at_line(file_name, lines.number(), std::string(keyword), "three numbers", quoted(*line));
            (keyword == "v" ? positions : normals).push_back(*vector);
        } else if (keyword == "vt") {
            const auto u = to_number<float>(next_word(*line)), v = to_number<float>(next_word(*line));
            texture.push_back(texture_coordinates(u.value_or(0), v.value_or(0)));
        } else if (keyword == "f") {
            std::vector<std::uint32_t> polygon;
            for (auto word = next_word(*line); !word.empty() && word[0] != '#'; word = next_word(*line)) {
                const auto corner = read_corner(word, positions.size(), normals.size(), texture.size());
                if (!corner || corners.size() >= k_none)
                    return at_line(
                        file_name, lines.number(), "corner of a face",
                        fmt::format("one of the {} vertices and {} normals so far", positions.size(), normals.size()),
                        quoted(word));
                every_corner_has_a_normal &= corner->normal != k_none;
                every_corner_has_texture &= corner->texture != k_none;
                polygon.push_back(std::uint32_t(corners.size()));
                corners.push_back(*corner);
            }
            add_polygon(polygon, triangles);
        }
    }

    Mesh mesh;
    if (every_corner_has_texture)
        for (const Triangle& t : triangles) {
            const auto corner = [&](std::size_t k) { return texture[corners[t[k]].texture]; };
            mesh.texture.push_back({corner(0), corner(1), corner(2)});
        }
    if (!every_corner_has_a_normal || normals.empty()) {
        mesh.positions = std::move(positions);
        for (const Triangle& t : triangles)
            mesh.triangles.push_back({corners[t[0]].position, corners[t[1]].position, corners[t[2]].position});
    } else {
        add_vertices(triangles, corners, positions, normals, mesh);
    }
    return complete_mesh(std::move(mesh), file_name);
}

}  // namespace srbf
