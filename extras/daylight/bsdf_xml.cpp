// BSDF data in the XML of WINDOW and of Radiance: matrices of patches and tensor trees.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <pugixml.hpp>

#include "base/floating_point.h"
#include "brdf/colour.h"
#include "extras/daylight/formats.h"
#include "extras/daylight/klems.h"
#include "extras/daylight/tensor_tree.h"
#include "measured/samples.h"

namespace srbf {

namespace {

/// The bases that a file may name without defining them (Radiance, bsdf_m.c): bounds of the rings [degrees], and their
/// numbers of patches.
struct KnownBasis {
    std::string_view name;
    std::vector<float> bounds;
    std::vector<std::uint32_t> azimuths;
};
const std::vector<KnownBasis>& known_bases() {
    static const std::vector<KnownBasis> bases{
        {"LBNL/Klems Full", {0, 5, 15, 25, 35, 45, 55, 65, 75, 90}, {1, 8, 16, 20, 24, 24, 24, 16, 12}},
        {"LBNL/Klems Half", {0, 6.5f, 19.5f, 32.5f, 45.5f, 58.5f, 71.5f, 90}, {1, 8, 12, 16, 20, 12, 8}},
        {"LBNL/Klems Quarter", {0, 9, 27, 45, 63, 90}, {1, 8, 12, 12, 8}}};
    return bases;
}

/// Limit on tags and attributes: the parser takes some hundred bytes for one, which may have four in the file.
constexpr std::ptrdiff_t k_most_markup = 1 << 17;
constexpr std::string_view k_visible = "Visible";
constexpr std::size_t k_most_rings = 64, k_most_patches = 4096, k_most_blocks = 256;

/// `text` without surrounding white space.
std::string_view stripped(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    return text;
}

/// A name as one line of at most that many bytes: of them that are written, the same are read.
std::string name_in(std::string_view text, std::size_t most = 100) {
    std::string name(stripped(text));
    std::ranges::replace_if(
        name, [](unsigned char c) { return c < ' '; }, ' ');
    return std::string(stripped(std::string_view(name).substr(0, most)));
}

/// An element to be read, with errors that say where it stands.
struct Element {
    pugi::xml_node node;
    const std::string* file_name;

    Error error(std::string what, std::string expected, std::string found) const {
        return {*file_name, std::uint64_t(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), std::move(what),
                std::move(expected), std::move(found)};
    }
    Element child(const char* name) const { return {node.child(name), file_name}; }
    std::vector<Element> children(const char* name) const {
        std::vector<Element> found;
        for (const pugi::xml_node of : node.children(name)) found.push_back({of, file_name});
        return found;
    }
    std::string_view text() const { return stripped(node.child_value()); }
    Result<double> number(const char* name) const {
        const auto number = to_number<double>(child(name).text());
        if (number && std::isfinite(*number)) return *number;
        return error(fmt::format("element {}", name), "a number", quoted(child(name).text()));
    }
};

Result<AngleBasis> read_basis(const Element& of) {
    AngleBasis basis;
    basis.name = name_in(of.child("AngleBasisName").text());
    for (const Element& block : of.children("AngleBasisBlock")) {
        if (basis.rings.size() == k_most_rings)
            return block.error("angle basis", fmt::format("at most {} rings", k_most_rings), "more");
        const Element bounds = block.child("ThetaBounds");
        const auto theta = block.number("Theta"), from = bounds.number("LowerTheta"), to = bounds.number("UpperTheta"),
                   azimuths = block.number("nPhis");
        for (const auto* number : {&theta, &from, &to, &azimuths})
            if (!*number) return number->error();
        const double begins = basis.rings.empty() ? 0 : double(basis.rings.back().to) / k_degree;
        if (!(std::abs(*from - begins) <= 1e-3 && *to > *from + 1e-3 && *to <= 90 + 1e-3))
            return bounds.error("bounds of a ring",
                                fmt::format("rising ones that begin at {:g} and end at 90 at most", begins),
                                fmt::format("{:g} to {:g}", *from, *to));
        if (!(*azimuths >= 1 && *azimuths <= k_most_patches && *azimuths == std::floor(*azimuths)))
            return block.error("nPhis", fmt::format("1 to {}", k_most_patches), fmt::format("{:g}", *azimuths));
        basis.rings.push_back({float(std::clamp(*theta, 0.0, 90.0) * k_degree), float(begins * k_degree),
                               float(std::min(*to, 90.0) * k_degree), std::uint32_t(*azimuths)});
    }
    if (basis.rings.empty() || std::abs(double(basis.rings.back().to) / k_degree - 90) > 1e-3)
        return of.error("angle basis", "rings to 90 degrees", "others");
    if (basis.patches() > k_most_patches)
        return of.error("angle basis", fmt::format("at most {} patches", k_most_patches),
                        fmt::format("{}", basis.patches()));
    return basis;
}

AngleBasis made(const KnownBasis& known) {
    AngleBasis basis{std::string(known.name), {}};
    for (std::size_t r = 0; r < known.azimuths.size(); ++r) {
        const float from = known.bounds[r], to = known.bounds[r + 1], theta = r == 0 ? 0 : (from + to) / 2;
        const auto in_radians = [](float degrees) { return float(double(degrees) * k_degree); };
        basis.rings.push_back({in_radians(theta), in_radians(from), in_radians(to), known.azimuths[r]});
    }
    return basis;
}

}  // namespace

AngleBasis klems_basis(KlemsBasis of) { return made(known_bases()[std::size_t(of)]); }

namespace {

Result<AngleBasis> basis_named(const Element& of, const std::vector<AngleBasis>& defined) {
    const std::string name = name_in(of.text());
    for (const AngleBasis& basis : defined)
        if (same(basis.name, name)) return basis;
    for (const KnownBasis& known : known_bases())
        if (same(known.name, name)) return made(known);
    return of.error("angle basis", "one that the file defines, or one of Klems'", srbf::quoted(name));
}

/// The numbers of a matrix, separated by white space and commas.
Result<std::vector<float>> read_numbers(const Element& data, std::size_t count) {
    std::vector<float> numbers;
    std::string_view rest = data.node.child_value();
    for (;;) {
        const std::string_view word = next_word(rest, " \t\r\n,");
        if (word.empty()) break;
        const auto number = to_number<float>(word);
        if (!number || !std::isfinite(*number))
            return data.error(fmt::format("number {} of ScatteringData", numbers.size() + 1),
                              "one within the range of floats", quoted(word));
        if (numbers.size() == count) return data.error("ScatteringData", fmt::format("{} numbers", count), "more");
        numbers.push_back(*number);
    }
    if (numbers.size() < count)
        return data.error("ScatteringData", fmt::format("{} numbers", count), fmt::format("{}", numbers.size()));
    return numbers;
}

/// The definitions of a file before its matrices.
struct Definition {
    std::vector<AngleBasis> bases;
    int rank = 0;             ///< of tensor trees; 0: matrices
    bool is_in_rows = false;  ///< whether a row of a matrix, not a column, is of an incident patch
};

Result<Definition> read_definition(const Element& of) {
    Definition definition;
    const std::string_view structure = of.child("IncidentDataStructure").text();
    definition.rank = same(structure, "TensorTree3") ? 3 : same(structure, "TensorTree4") ? 4 : 0;
    if (definition.rank > 0) return definition;
    definition.is_in_rows = same(structure, "Rows");
    if (!definition.is_in_rows && !same(structure, "Columns"))
        return of.error("IncidentDataStructure", "Columns, Rows, TensorTree3 or TensorTree4", quoted(structure));
    for (const Element& basis_of : of.children("AngleBasis")) {
        if (definition.bases.size() == k_most_blocks) return of.error("angle bases", "fewer", "more");
        auto basis = read_basis(basis_of);
        if (!basis) return basis.error();
        definition.bases.push_back(*std::move(basis));
    }
    return definition;
}

/// The content of a block.
using XmlBlock = std::variant<KlemsTable, TreeTable>;
using XmlBlocks = std::array<std::optional<XmlBlock>, k_parts>;
using NamedXmlBlocks = std::pair<std::string, XmlBlocks>;

Result<XmlBlock> read_matrix(const Element& block, const Definition& definition) {
    const auto& bases = definition.bases;
    const bool rows = definition.is_in_rows;
    auto incident = basis_named(block.child("ColumnAngleBasis"), bases),
         outgoing = basis_named(block.child("RowAngleBasis"), bases);
    if (!incident) return incident.error();
    if (!outgoing) return outgoing.error();
    if (rows) std::swap(incident, outgoing);
    KlemsTable table{*std::move(incident), *std::move(outgoing), {}, {}, 0};
    const std::size_t I = table.incident.patches(), O = table.outgoing.patches();
    const auto numbers = read_numbers(block.child("ScatteringData"), I * O);
    if (!numbers) return numbers.error();
    table.cells.resize(I * O);
    for (std::size_t o = 0; o < O; ++o)
        for (std::size_t i = 0; i < I; ++i) {
            const float f = (*numbers)[rows ? i * O + o : o * I + i];
            table.cells[o * I + i] = {f, f, f};
        }
    return XmlBlock(std::move(table));
}

// ---- Files ----

/// Parses the text of a file; document types, with which entities are defined, are refused.
Result<Done> parse(std::span<const std::byte> bytes, const std::string& file_name, pugi::xml_document& document) {
    const auto refused = [&](std::string expected, std::string found) {
        return Error{file_name, {}, "XML", std::move(expected), std::move(found)};
    };
    if (bytes.size() > k_largest_xml)
        return refused(fmt::format("at most {} bytes", k_largest_xml), fmt::format("{}", bytes.size()));
    if (const auto at = as_text(bytes).find("<!DOCTYPE"); at != std::string_view::npos)
        return Error{file_name, at, "XML", "no document type, with which entities are defined", "one"};
    const auto markup = std::ranges::count_if(as_text(bytes), [](char c) { return c == '<' || c == '='; });
    if (markup > k_most_markup)
        return refused(fmt::format("at most {} tags and attributes", k_most_markup), fmt::format("{}", markup));
    const auto parsed = document.load_buffer(
        bytes.data(), bytes.size(), pugi::parse_minimal | pugi::parse_cdata | pugi::parse_escapes, pugi::encoding_utf8);
    if (parsed) return Done{};
    return Error{file_name, std::uint64_t(std::max<std::ptrdiff_t>(parsed.offset, 0)), "XML", "a well-formed file",
                 parsed.description()};
}

std::optional<Part> part_named(std::string_view text) {
    for (std::size_t p = 0; p < k_parts; ++p)
        if (same(text, k_window_names[p])) return Part(p);
    return {};
}

Result<XmlBlock> read_tree(const Element& block, int rank) {
    const std::string_view basis = block.child("AngleBasis").text();
    if (!same(basis, "LBNL/Shirley-Chiu"))
        return block.error("AngleBasis of a tensor tree", "LBNL/Shirley-Chiu", quoted(basis));
    const Element data = block.child("ScatteringData");
    auto tree = read_tensor_tree(data.node.child_value(), rank);
    if (tree) return XmlBlock(TreeTable{*std::move(tree), {}});
    Error error = tree.error();
    error.source = *data.file_name;
    error.offset =
        error.offset.value_or(0) + std::uint64_t(std::max<std::ptrdiff_t>(data.node.first_child().offset_debug(), 0));
    return error;
}

/// Reads what a block holds into its part and band.
Result<Done> read_block(const Element& block, const Definition& definition, const std::string& band,
                        std::vector<NamedXmlBlocks>& bands) {
    const std::string_view direction = block.child("WavelengthDataDirection").text();
    const auto part = part_named(direction);
    if (!part)
        return block.error("WavelengthDataDirection", "Transmission or Reflection, Front or Back", quoted(direction));
    auto of_band = std::ranges::find(bands, band, &NamedXmlBlocks::first);
    if (of_band == bands.end()) of_band = bands.insert(bands.end(), {band, {}});
    auto& of_part = of_band->second[std::size_t(*part)];
    if (of_part) return block.error(std::string(name(*part)), "one matrix or tree in a band", "another");
    auto table = definition.rank > 0 ? read_tree(block, definition.rank) : read_matrix(block, definition);
    if (!table) return table.error();
    of_part = *std::move(table);
    return Done{};
}

Result<std::vector<NamedXmlBlocks>> read_bands(const Element& layer, const Definition& definition) {
    std::vector<NamedXmlBlocks> bands;
    std::size_t blocks = 0;
    for (const Element& data : layer.children("WavelengthData")) {
        std::string band = name_in(data.child("Wavelength").text());
        if (band.empty()) band = k_visible;
        for (const Element& block : data.children("WavelengthDataBlock")) {
            if (++blocks > k_most_blocks)
                return block.error("matrices", fmt::format("at most {}", k_most_blocks), "more");
            if (const auto read = read_block(block, definition, band, bands); !read) return read.error();
        }
    }
    if (bands.empty()) return layer.error("Layer", "at least one WavelengthDataBlock", "none");
    return bands;
}

BsdfTable::Band band_of(std::string name, XmlBlocks&& blocks, const std::string& file_name) {
    BsdfTable::Band band;
    band.name = std::move(name);
    std::array<KlemsTable*, k_parts> matrices{};
    for (std::size_t p = 0; p < k_parts; ++p) matrices[p] = blocks[p] ? std::get_if<KlemsTable>(&*blocks[p]) : nullptr;
    band.beam = separate_beams(matrices);
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!blocks[p]) continue;
        const char* const format = std::holds_alternative<TreeTable>(*blocks[p]) ? "BSDF tree" : "BSDF XML";
        EvaluatedTable table = std::visit([](auto& of) { return evaluated(std::move(of)); }, *blocks[p]);
        band.part[p] = std::make_shared<const Measured>(Measured{file_name, format, 0, std::move(table)});
    }
    return band;
}

NamedXmlBlocks* band_named(std::vector<NamedXmlBlocks>& bands, std::string_view name) {
    const auto band = std::ranges::find_if(bands, [&](const NamedXmlBlocks& of) { return same(of.first, name); });
    return band == bands.end() ? nullptr : &*band;
}

/// Radiance's bands of chromaticity of trees, CIE-u and CIE-v, belong to "Visible".
void join_chromaticity(std::vector<NamedXmlBlocks>& bands) {
    auto *y = band_named(bands, k_visible), *u = band_named(bands, "CIE-u"), *v = band_named(bands, "CIE-v");
    if (!y || !u || !v) return;
    const auto tree = [](std::optional<XmlBlock>& of) { return of ? std::get_if<TreeTable>(&*of) : nullptr; };
    for (std::size_t p = 0; p < k_parts; ++p) {
        TreeTable *of_y = tree(y->second[p]), *of_u = tree(u->second[p]), *of_v = tree(v->second[p]);
        if (!of_y || !of_u || !of_v) continue;
        of_y->chromaticity.push_back(std::move(of_u->y));
        of_y->chromaticity.push_back(std::move(of_v->y));
    }
    std::erase_if(bands,
                  [](const NamedXmlBlocks& band) { return same(band.first, "CIE-u") || same(band.first, "CIE-v"); });
}

/// Makes matrices of these bands one band of colours, Σ weight × matrix, if all have the same parts and patches. It is the
/// first; those that it is made of are kept on request.
void join_matrices(std::vector<NamedXmlBlocks>& bands, const std::vector<NamedXmlBlocks*>& of,
                   const std::vector<Rgb>& weights, std::string name, bool keep) {
    const auto matrix = [](std::optional<XmlBlock>& block) {
        return block ? std::get_if<KlemsTable>(&*block) : nullptr;
    };
    for (std::size_t p = 0; p < k_parts; ++p)
        for (NamedXmlBlocks* band : of) {
            const KlemsTable *first = matrix(of[0]->second[p]), *here = matrix(band->second[p]);
            if (!first != !here || of[0]->second[p].has_value() != band->second[p].has_value()) return;
            if (!here) continue;
            if (here->incident.rings != first->incident.rings || here->outgoing.rings != first->outgoing.rings) return;
        }
    NamedXmlBlocks joined{std::move(name), of[0]->second};
    for (std::size_t p = 0; p < k_parts; ++p) {
        KlemsTable* table = matrix(joined.second[p]);
        if (!table) continue;
        for (std::size_t i = 0; i < table->cells.size(); ++i) {
            std::array<double, 3> sum{};
            for (std::size_t b = 0; b < of.size(); ++b)
                for (int c = 0; c < 3; ++c)
                    sum[std::size_t(c)] += double(weights[b][c]) * double(matrix(of[b]->second[p])->cells[i].g);
            table->cells[i] = {float(sum[0]), float(sum[1]), float(sum[2])};
        }
    }
    std::vector<NamedXmlBlocks> kept{std::move(joined)};
    for (NamedXmlBlocks& band : bands)
        if (keep || std::ranges::find(of, &band) == of.end()) kept.push_back(std::move(band));
    bands = std::move(kept);
}

/// Bands that are one in colour: Visible with CIE-X and CIE-Z, whose equal values are white, as in Radiance; R, G and B;
/// and wavelengths [nm, or μm] that tell of a colour.
void join_colours(std::vector<NamedXmlBlocks>& bands) {
    join_chromaticity(bands);
    const auto join = [&](const std::array<std::string_view, 3>& names, const std::vector<Rgb>& weights,
                          std::string_view name) {
        std::vector<NamedXmlBlocks*> of;
        for (const std::string_view each : names)
            if (auto* band = band_named(bands, each)) of.push_back(band);
        if (of.size() == names.size()) join_matrices(bands, of, weights, std::string(name), false);
    };
    const Xyz white = white_point();
    join({k_visible, "CIE-X", "CIE-Z"}, {to_rgb(Xyz{0, 1, 0}), to_rgb(Xyz{white.x, 0, 0}), to_rgb(Xyz{0, 0, white.z})},
         k_visible);
    const std::vector<Rgb> primaries{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    join({"R", "G", "B"}, primaries, k_colours);
    join({"Red", "Green", "Blue"}, primaries, k_colours);
    std::vector<std::pair<float, NamedXmlBlocks*>> by_wavelength;
    for (NamedXmlBlocks& band : bands)
        if (const auto number = to_number<float>(band.first))
            by_wavelength.push_back({*number < 100 ? 1000 * *number : *number, &band});
    std::ranges::sort(by_wavelength);
    std::vector<float> wavelengths;
    std::vector<NamedXmlBlocks*> of;
    for (const auto& [nm, band] : by_wavelength) wavelengths.push_back(nm), of.push_back(band);
    if (!band_named(bands, k_colours) && are_wavelengths(wavelengths) && has_colours(wavelengths))
        join_matrices(bands, of, rgb_weights(wavelengths), std::string(k_colours), true);
}

}  // namespace

bool is_xml(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    const std::string_view rest = stripped(text.substr(0, 4096));
    return rest.starts_with("<?xml") || rest.starts_with("<WindowElement") || rest.starts_with("<!");
}

Result<BsdfTable> read_bsdf_xml(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    pugi::xml_document document;
    if (const auto parsed = parse(bytes, file_name, document); !parsed) return parsed.error();
    const Element file{document, &file_name}, root = file.child("WindowElement");
    if (!root.node) return Error{file_name, {}, "XML", "an element WindowElement", "none"};
    const Element layer = root.child("Optical").child("Layer");
    if (!layer.node) return root.error("WindowElement", "an element Optical with a Layer", "none");
    const auto definition = read_definition(layer.child("DataDefinition"));
    if (!definition) return definition.error();
    if (definition->rank > 0) {
        // Memory holds the text twice, then the trees: within four times the file and 64 MB.
        constexpr std::size_t slack = 32 << 20;
        std::size_t taken = 0;
        for (const Element& data : layer.children("WavelengthData"))
            for (const Element& block : data.children("WavelengthDataBlock"))
                taken += most_tree_bytes(block.node.child("ScatteringData").child_value());
        if (taken > 2 * bytes.size() + slack)
            return layer.error("tensor trees", fmt::format("at most {} bytes of nodes", 2 * bytes.size() + slack),
                               fmt::format("{}", taken));
    }
    auto bands = read_bands(layer, *definition);
    if (!bands) return bands.error();
    join_colours(*bands);

    BsdfTable table;
    table.description = name_in(layer.child("Material").child("Name").text(), 200);
    for (auto& [name, blocks] : *bands) {
        const bool is_first_visible = same(name, k_visible) && !band_named(*bands, k_colours);
        if (is_first_visible || name == k_colours) table.chosen = table.bands.size();
        table.bands.push_back(band_of(name, std::move(blocks), file_name));
    }
    return table;
}

Result<Measured> read_as_bsdf_xml(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&) {
    auto measured = measurement_of(read_bsdf_xml(bytes, file_name));
    if (!measured) return measured;
    const auto& parts = std::get<BsdfTable>(measured->table).band().part;
    if (std::ranges::any_of(parts, [](const auto& part) { return part && own_table<TreeTable>(*part); }))
        measured->format = "BSDF tree";
    return measured;
}

}  // namespace srbf
