// BSDF data in the XML of WINDOW and of Radiance: matrices of patches and tensor trees.

#include <cctype>
#include <pugixml.hpp>

#include "base/floating_point.h"
#include "brdf/colour.h"
#include "extras/daylight/formats.h"
#include "extras/daylight/klems.h"
#include "extras/daylight/tensor_tree.h"
#include "fit/patch_fit.h"
#include "measured/samples.h"

namespace SRBF_NAMESPACE {

namespace {

/// A basis that a file may name without defining it (Radiance, bsdf_m.c): the bounds of its rings [degrees], and
/// the number of patches in each ring.
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

/// Limit on tags and attributes. The parser takes some hundred bytes for each, which may take only four bytes in
/// the file.
constexpr std::ptrdiff_t k_max_markup = 1 << 17;
constexpr std::string_view k_visible = "Visible";
constexpr std::size_t k_max_rings = 64, k_max_patches = 4096, k_max_blocks = 256;

/// `text` without surrounding white space.
std::string_view stripped(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    return text;
}

/// A name as a single line of at most `max_bytes` bytes. The name is the same after it is written and read again.
std::string name_in(std::string_view text, std::size_t max_bytes = 100) {
    std::string name(stripped(text));
    std::ranges::replace_if(
        name, [](unsigned char c) { return c < ' '; }, ' ');
    return std::string(stripped(std::string_view(name).substr(0, max_bytes)));
}

/// An element to read, with errors that state its position.
struct Element {
    pugi::xml_node node;
    const std::string* file_name;

    Error error(std::string what, std::string expected, std::string found) const {
        return {*file_name, std::uint64_t(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), std::move(what),
                std::move(expected), std::move(found)};
    }
    Element child(const char* name) const { return {node.child(name), file_name}; }
    std::vector<Element> children(const char* name) const {
        std::vector<Element> elements;
        for (const pugi::xml_node child : node.children(name)) elements.push_back({child, file_name});
        return elements;
    }
    std::string_view text() const { return stripped(node.child_value()); }
    Result<double> number(const char* name) const {
        const auto number = to_number<double>(child(name).text());
        if (number && std::isfinite(*number)) return *number;
        return error(fmt::format("element {}", name), "a number", quoted(child(name).text()));
    }
};

Result<AngleBasis> read_basis(const Element& element) {
    AngleBasis basis;
    basis.name = name_in(element.child("AngleBasisName").text());
    for (const Element& block : element.children("AngleBasisBlock")) {
        if (basis.rings.size() == k_max_rings)
            return block.error("angle basis", fmt::format("at most {} rings", k_max_rings), "more");
        const Element bounds = block.child("ThetaBounds");
        const auto theta = block.number("Theta"), lower = bounds.number("LowerTheta"),
                   upper = bounds.number("UpperTheta"), azimuths = block.number("nPhis");
        for (const auto* number : {&theta, &lower, &upper, &azimuths})
            if (!*number) return number->error();
        const double expected_lower = basis.rings.empty() ? 0 : double(basis.rings.back().to) / k_degree;
        if (!(std::abs(*lower - expected_lower) <= 1e-3 && *upper > *lower + 1e-3 && *upper <= 90 + 1e-3))
            return bounds.error("bounds of a ring",
                                fmt::format("an interval that begins at {:g} and ends at 90 or less", expected_lower),
                                fmt::format("{:g} to {:g}", *lower, *upper));
        if (!(*azimuths >= 1 && *azimuths <= k_max_patches && *azimuths == std::floor(*azimuths)))
            return block.error("nPhis", fmt::format("1 to {}", k_max_patches), fmt::format("{:g}", *azimuths));
        basis.rings.push_back({float(std::clamp(*theta, 0.0, 90.0) * k_degree), float(expected_lower * k_degree),
                               float(std::min(*upper, 90.0) * k_degree), std::uint32_t(*azimuths)});
    }
    if (basis.rings.empty() || std::abs(double(basis.rings.back().to) / k_degree - 90) > 1e-3)
        return element.error(
            "angle basis", "rings to 90 degrees",
            basis.rings.empty() ? "none" : fmt::format("an end at {:g}", double(basis.rings.back().to) / k_degree));
    if (basis.patches() > k_max_patches)
        return element.error("angle basis", fmt::format("at most {} patches", k_max_patches),
                             fmt::format("{}", basis.patches()));
    return basis;
}

AngleBasis basis_of(const KnownBasis& known) {
    AngleBasis basis{std::string(known.name), {}};
    for (std::size_t r = 0; r < known.azimuths.size(); ++r) {
        const float lower = known.bounds[r], upper = known.bounds[r + 1], theta = r == 0 ? 0 : (lower + upper) / 2;
        const auto in_radians = [](float degrees) { return float(double(degrees) * k_degree); };
        basis.rings.push_back({in_radians(theta), in_radians(lower), in_radians(upper), known.azimuths[r]});
    }
    return basis;
}

Result<AngleBasis> basis_named(const Element& element, const std::vector<AngleBasis>& defined) {
    const std::string name = name_in(element.text());
    for (const AngleBasis& basis : defined)
        if (equal_ignoring_case(basis.name, name)) return basis;
    for (const KnownBasis& known : known_bases())
        if (equal_ignoring_case(known.name, name)) return basis_of(known);
    return element.error("angle basis", "one that the file defines, or one of Klems'", srbf::quoted(name));
}

/// Reads the numbers of a matrix, which are separated by white space and commas.
Result<std::vector<float>> read_numbers(const Element& data, std::size_t count) {
    std::vector<float> numbers;
    std::string_view remaining = data.node.child_value();
    for (;;) {
        const std::string_view word = next_word(remaining, " \t\r\n,");
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

/// The definitions before the matrices of a file.
struct Definition {
    std::vector<AngleBasis> bases;
    int rank = 0;             ///< rank of tensor trees; 0: matrices
    bool is_in_rows = false;  ///< true if each row, not each column, of a matrix belongs to an incident patch
};

Result<Definition> read_definition(const Element& element) {
    Definition definition;
    const std::string_view structure = element.child("IncidentDataStructure").text();
    definition.rank = equal_ignoring_case(structure, "TensorTree3")   ? 3
                      : equal_ignoring_case(structure, "TensorTree4") ? 4
                                                                      : 0;
    if (definition.rank > 0) return definition;
    definition.is_in_rows = equal_ignoring_case(structure, "Rows");
    if (!definition.is_in_rows && !equal_ignoring_case(structure, "Columns"))
        return element.error("IncidentDataStructure", "Columns, Rows, TensorTree3 or TensorTree4", quoted(structure));
    for (const Element& basis_element : element.children("AngleBasis")) {
        if (definition.bases.size() == k_max_blocks) return element.error("angle bases", "fewer", "more");
        auto basis = read_basis(basis_element);
        if (!basis) return basis.error();
        definition.bases.push_back(*std::move(basis));
    }
    return definition;
}

/// The content of a block: a matrix or a tensor tree.
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

/// Parses the text of a file. Document types, which can define entities, are refused.
Result<Done> parse(std::span<const std::byte> bytes, const std::string& file_name, pugi::xml_document& document) {
    const auto refused = [&](std::string expected, std::string found) {
        return Error{file_name, {}, "XML", std::move(expected), std::move(found)};
    };
    if (bytes.size() > k_largest_xml)
        return refused(fmt::format("at most {} bytes", k_largest_xml), fmt::format("{}", bytes.size()));
    if (const auto offset = as_text(bytes).find("<!DOCTYPE"); offset != std::string_view::npos)
        return Error{file_name, offset, "XML", "no document type, which can define entities", "one"};
    const auto markup = std::ranges::count_if(as_text(bytes), [](char c) { return c == '<' || c == '='; });
    if (markup > k_max_markup)
        return refused(fmt::format("at most {} tags and attributes", k_max_markup), fmt::format("{}", markup));
    const auto parsed = document.load_buffer(
        bytes.data(), bytes.size(), pugi::parse_minimal | pugi::parse_cdata | pugi::parse_escapes, pugi::encoding_utf8);
    if (parsed) return Done{};
    return Error{file_name, std::uint64_t(std::max<std::ptrdiff_t>(parsed.offset, 0)), "XML", "a well-formed file",
                 parsed.description()};
}

std::optional<Part> part_named(std::string_view text) {
    for (std::size_t p = 0; p < k_parts; ++p)
        if (equal_ignoring_case(text, k_window_names[p])) return Part(p);
    return {};
}

Result<XmlBlock> read_tree(const Element& block, int rank) {
    const std::string_view basis = block.child("AngleBasis").text();
    if (!equal_ignoring_case(basis, "LBNL/Shirley-Chiu"))
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

/// Reads the table in a block, and adds it to its part and band.
Result<Done> read_block(const Element& block, const Definition& definition, const std::string& band,
                        std::vector<NamedXmlBlocks>& bands) {
    const std::string_view direction = block.child("WavelengthDataDirection").text();
    const auto part = part_named(direction);
    if (!part)
        return block.error("WavelengthDataDirection", "Transmission or Reflection, Front or Back", quoted(direction));
    auto band_blocks = std::ranges::find(bands, band, &NamedXmlBlocks::first);
    if (band_blocks == bands.end()) band_blocks = bands.insert(bands.end(), {band, {}});
    auto& part_block = band_blocks->second[std::size_t(*part)];
    if (part_block) return block.error(std::string(name(*part)), "one matrix or tree in a band", "a second one");
    auto table = definition.rank > 0 ? read_tree(block, definition.rank) : read_matrix(block, definition);
    if (!table) return table.error();
    part_block = *std::move(table);
    return Done{};
}

Result<std::vector<NamedXmlBlocks>> read_bands(const Element& layer, const Definition& definition) {
    std::vector<NamedXmlBlocks> bands;
    std::size_t blocks = 0;
    for (const Element& data : layer.children("WavelengthData")) {
        std::string band = name_in(data.child("Wavelength").text());
        if (band.empty()) band = k_visible;
        for (const Element& block : data.children("WavelengthDataBlock")) {
            if (++blocks > k_max_blocks)
                return block.error("matrices", fmt::format("at most {}", k_max_blocks), "more");
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
    std::array<Evaluate, k_parts> values;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!blocks[p]) continue;
        const char* const format = std::holds_alternative<TreeTable>(*blocks[p]) ? "BSDF tree" : "BSDF XML";
        EvaluatedTable table =
            std::visit([](auto& table_content) { return as_evaluated_table(std::move(table_content)); }, *blocks[p]);
        band.part[p] = std::make_shared<const Measured>(Measured{file_name, format, 0, std::move(table)});
        values[p] = evaluator(*band.part[p]);
    }
    end_mirrors(band.beam, values);
    return band;
}

NamedXmlBlocks* band_named(std::vector<NamedXmlBlocks>& bands, std::string_view name) {
    const auto band = std::ranges::find_if(
        bands, [&](const NamedXmlBlocks& named) { return equal_ignoring_case(named.first, name); });
    return band == bands.end() ? nullptr : &*band;
}

/// Joins Radiance's bands of chromaticity, CIE-u and CIE-v, to the trees of "Visible".
void join_chromaticity(std::vector<NamedXmlBlocks>& bands) {
    auto *y = band_named(bands, k_visible), *u = band_named(bands, "CIE-u"), *v = band_named(bands, "CIE-v");
    if (!y || !u || !v) return;
    const auto tree = [](std::optional<XmlBlock>& block) { return block ? std::get_if<TreeTable>(&*block) : nullptr; };
    for (std::size_t p = 0; p < k_parts; ++p) {
        TreeTable *tree_y = tree(y->second[p]), *tree_u = tree(u->second[p]), *tree_v = tree(v->second[p]);
        if (!tree_y || !tree_u || !tree_v) continue;
        tree_y->chromaticity.push_back(std::move(tree_u->y));
        tree_y->chromaticity.push_back(std::move(tree_v->y));
    }
    std::erase_if(bands, [](const NamedXmlBlocks& band) {
        return equal_ignoring_case(band.first, "CIE-u") || equal_ignoring_case(band.first, "CIE-v");
    });
}

/// Replaces the matrices in these bands by one band of colours, Σ weight × matrix, if all have the same parts and
/// patches. The new band becomes the first; `keep` retains the original ones.
void join_matrices(std::vector<NamedXmlBlocks>& bands, const std::vector<NamedXmlBlocks*>& sources,
                   const std::vector<Rgb>& weights, std::string name, bool keep) {
    const auto matrix = [](std::optional<XmlBlock>& block) {
        return block ? std::get_if<KlemsTable>(&*block) : nullptr;
    };
    for (std::size_t p = 0; p < k_parts; ++p)
        for (NamedXmlBlocks* band : sources) {
            const KlemsTable *first = matrix(sources[0]->second[p]), *other = matrix(band->second[p]);
            if (!first != !other || sources[0]->second[p].has_value() != band->second[p].has_value()) return;
            if (!other) continue;
            if (other->incident.rings != first->incident.rings || other->outgoing.rings != first->outgoing.rings)
                return;
        }
    NamedXmlBlocks joined{std::move(name), sources[0]->second};
    for (std::size_t p = 0; p < k_parts; ++p) {
        KlemsTable* table = matrix(joined.second[p]);
        if (!table) continue;
        for (std::size_t i = 0; i < table->cells.size(); ++i) {
            std::array<double, 3> sum{};
            for (std::size_t b = 0; b < sources.size(); ++b)
                for (int c = 0; c < 3; ++c)
                    sum[std::size_t(c)] += double(weights[b][c]) * double(matrix(sources[b]->second[p])->cells[i].g);
            table->cells[i] = {float(sum[0]), float(sum[1]), float(sum[2])};
        }
    }
    std::vector<NamedXmlBlocks> result{std::move(joined)};
    for (NamedXmlBlocks& band : bands)
        if (keep || std::ranges::find(sources, &band) == sources.end()) result.push_back(std::move(band));
    bands = std::move(result);
}

/// Joins the bands of a coloured BSDF: Visible with CIE-X and CIE-Z, whose equal values are white, as in Radiance;
/// R, G and B; or wavelengths [nm or μm] that determine a colour.
void join_colours(std::vector<NamedXmlBlocks>& bands) {
    join_chromaticity(bands);
    const auto join = [&](const std::array<std::string_view, 3>& names, const std::vector<Rgb>& weights,
                          std::string_view name) {
        std::vector<NamedXmlBlocks*> sources;
        for (const std::string_view band_name : names)
            if (auto* band = band_named(bands, band_name)) sources.push_back(band);
        if (sources.size() == names.size()) join_matrices(bands, sources, weights, std::string(name), false);
    };
    const Xyz white = white_point();
    join({k_visible, "CIE-X", "CIE-Z"}, {to_rgb(Xyz{0, 1, 0}), to_rgb(Xyz{white.x, 0, 0}), to_rgb(Xyz{0, 0, white.z})},
         k_visible);
    const std::vector<Rgb> primaries{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    join({"R", "G", "B"}, primaries, k_colours);
    join({"Red", "Green", "Blue"}, primaries, k_colours);
    std::vector<std::pair<float, NamedXmlBlocks*>> sorted;
    for (NamedXmlBlocks& band : bands)
        if (const auto number = to_number<float>(band.first))
            sorted.push_back({*number < 100 ? 1000 * *number : *number, &band});
    std::ranges::sort(sorted);
    std::vector<float> wavelengths;
    std::vector<NamedXmlBlocks*> sources;
    for (const auto& [nm, band] : sorted) {
        wavelengths.push_back(nm);
        sources.push_back(band);
    }
    if (!band_named(bands, k_colours) && are_wavelengths(wavelengths) && has_colours(wavelengths))
        join_matrices(bands, sources, rgb_weights(wavelengths), std::string(k_colours), true);
}

}  // namespace

AngleBasis klems_basis(KlemsBasis basis) { return basis_of(known_bases()[std::size_t(basis)]); }

bool is_xml(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    const std::string_view start = stripped(text.substr(0, 4096));
    return start.starts_with("<?xml") || start.starts_with("<WindowElement") || start.starts_with("<!");
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
        // Memory holds the text twice and then the trees, in all at most four times the file and 64 MB.
        constexpr std::size_t slack = 32 << 20;
        std::size_t tree_bytes = 0;
        for (const Element& data : layer.children("WavelengthData"))
            for (const Element& block : data.children("WavelengthDataBlock"))
                tree_bytes += max_tree_bytes(block.node.child("ScatteringData").child_value());
        if (tree_bytes > 2 * bytes.size() + slack)
            return layer.error("tensor trees", fmt::format("at most {} bytes of nodes", 2 * bytes.size() + slack),
                               fmt::format("{}", tree_bytes));
    }
    auto bands = read_bands(layer, *definition);
    if (!bands) return bands.error();
    join_colours(*bands);

    BsdfTable table;
    table.description = name_in(layer.child("Material").child("Name").text(), 200);
    for (auto& [name, blocks] : *bands) {
        const bool is_first_visible = equal_ignoring_case(name, k_visible) && !band_named(*bands, k_colours);
        if (is_first_visible || name == k_colours) table.chosen = table.bands.size();
        table.bands.push_back(band_of(name, std::move(blocks), file_name));
    }
    return table;
}

Result<Measured> read_as_bsdf_xml(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&) {
    auto measured = measurement_of(read_bsdf_xml(bytes, file_name));
    if (!measured) return measured;
    const auto& parts = std::get<BsdfTable>(measured->table).band().part;
    if (std::ranges::any_of(parts, [](const auto& part) { return part && table_as<TreeTable>(*part); }))
        measured->format = "BSDF tree";
    return measured;
}

}  // namespace
