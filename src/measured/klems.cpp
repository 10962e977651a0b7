// Matrices of patches, and the XML in which WINDOW and Radiance keep them.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <pugixml.hpp>

#include "measured/klems.h"
#include "measured/samples.h"
#include "srbf/elementary.h"

namespace srbf {

// ---- Patches ----

std::size_t AngleBasis::first_of(std::size_t ring) const {
    std::size_t first = 0;
    for (std::size_t r = 0; r < ring; ++r) first += rings[r].azimuths;
    return first;
}
std::size_t AngleBasis::patches() const { return first_of(rings.size()); }

std::size_t AngleBasis::ring_of(std::size_t patch) const {
    std::size_t ring = 0;
    for (std::size_t first = rings[0].azimuths; patch >= first; first += rings[ring].azimuths) ++ring;
    return ring;
}

std::size_t AngleBasis::patch_of(Vec3f w) const {
    const Angles<float> at = angles(w);
    std::size_t ring = 0;
    while (ring + 1 < rings.size() && at.theta >= rings[ring].to) ++ring;
    const std::uint32_t n = rings[ring].azimuths;
    const double turn = double(at.phi) / (2 * k_pi) * n + 0.5;
    const auto k = std::int64_t(std::floor(turn)) % std::int64_t(n);
    return first_of(ring) + std::size_t(k < 0 ? k + n : k);
}

double AngleBasis::azimuth_of(std::size_t patch) const {
    const std::size_t ring = ring_of(patch);
    return 2 * k_pi * double(patch - first_of(ring)) / rings[ring].azimuths;
}

double AngleBasis::projected_solid_angle(std::size_t ring) const {
    const auto squared_sine = [](float theta) { return elementary::square(elementary::sin(double(theta))); };
    const Ring& of = rings[ring];
    return k_pi * (squared_sine(of.to) - squared_sine(of.from)) / of.azimuths;
}

Vec3d AngleBasis::point_of(std::size_t patch, double s, double t) const {
    const Ring& ring = rings[ring_of(patch)];
    const double from = elementary::square(elementary::cos(double(ring.from))),
                 to = elementary::square(elementary::cos(double(ring.to)));
    const double squared = std::max(from + s * (to - from), 0.0), r = std::sqrt(1 - squared);
    const double phi = azimuth_of(patch) + 2 * k_pi * (t - 0.5) / ring.azimuths;
    return {r * elementary::cos(phi), r * elementary::sin(phi), std::sqrt(squared)};
}

Rgb signed_value(const KlemsTable& table, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    return table.cell(table.outgoing.patch_of({-wv.x, wv.y, wv.z}), table.incident.patch_of({wl.x, -wl.y, wl.z}));
}

Rgb value(const KlemsTable& table, Vec3f wl, Vec3f wv) {
    Rgb f = signed_value(table, wl, wv);
    for (int c = 0; c < 3; ++c) f[c] = f[c] < 0 ? 0 : f[c];  // a NaN is kept
    return f;
}

std::vector<PatchClass> patch_classes(const KlemsTable& table, bool isotropic) {
    const AngleBasis &in = table.incident, &out = table.outgoing;
    struct Sums {
        PatchClass of;
        std::array<double, 3> sum{};
    };
    std::vector<Sums> all;
    for (std::size_t ri = 0; ri < in.rings.size(); ++ri)
        for (std::size_t ro = 0; ro < out.rings.size(); ++ro) {
            const std::size_t n_i = in.rings[ri].azimuths, n_o = out.rings[ro].azimuths, turn = n_i * n_o;
            const double weight = in.projected_solid_angle(ri) * out.projected_solid_angle(ro);
            std::map<std::size_t, std::size_t> known;  // the class of each difference of azimuths
            for (std::size_t i = 0; i < n_i; ++i)
                for (std::size_t o = 0; o < n_o; ++o) {
                    const std::size_t pi = in.first_of(ri) + i, po = out.first_of(ro) + o;
                    const Rgb f = table.cell(po, pi);
                    if (!is_finite(f)) continue;
                    const std::size_t apart = (i * n_o + turn - o * n_i) % turn, either = std::min(apart, turn - apart);
                    const auto [at, is_new] = known.try_emplace(isotropic ? either : i * n_o + o, all.size());
                    if (is_new) all.push_back({{po, pi, 0, {}, 0, 0}, {}});
                    Sums& sums = all[at->second];
                    sums.of.weight += weight;
                    for (int c = 0; c < 3; ++c) {
                        sums.sum[std::size_t(c)] += weight * double(f[c]);
                        sums.of.energy += weight * elementary::square(double(f[c]));
                    }
                }
        }
    std::vector<PatchClass> classes;
    for (Sums& sums : all) {
        double of_mean = 0;
        for (int c = 0; c < 3; ++c) {
            const double mean = sums.sum[std::size_t(c)] / sums.of.weight;
            sums.of.mean[c] = float(mean);
            of_mean += sums.of.weight * mean * mean;
        }
        sums.of.variance = std::max(sums.of.energy - of_mean, 0.0);
        classes.push_back(sums.of);
    }
    return classes;
}

bool is_isotropic(const KlemsTable& table) {
    constexpr double most = 1e-4;
    double energy = 0, variance = 0;
    for (const PatchClass& of : patch_classes(table, true)) energy += of.energy, variance += of.variance;
    return variance <= most * energy;
}

namespace {

// ---- XML ----

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
constexpr std::size_t k_most_rings = 64, k_most_patches = 4096, k_most_blocks = 256;

bool same(std::string_view a, std::string_view b) {
    return std::ranges::equal(
        a, b, {}, [](unsigned char c) { return std::tolower(c); }, [](unsigned char c) { return std::tolower(c); });
}

/// `text` without surrounding white space.
std::string_view stripped(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    return text;
}

/// What an element is for: to be read, with errors that state where.
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
    basis.name = of.child("AngleBasisName").text().substr(0, 100);
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

Result<AngleBasis> basis_named(const Element& name, const std::vector<AngleBasis>& defined) {
    for (const AngleBasis& basis : defined)
        if (same(basis.name, name.text())) return basis;
    for (const KnownBasis& known : known_bases())
        if (same(known.name, name.text())) return made(known);
    return name.error("angle basis", "one that the file defines, or one of Klems'", quoted(name.text()));
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

/// What a file defines before its matrices.
struct Definition {
    std::vector<AngleBasis> bases;
    bool is_in_rows = false;  ///< whether a row of a matrix, not a column, is of an incident patch
};

Result<Definition> read_definition(const Element& of) {
    Definition definition;
    const std::string_view structure = of.child("IncidentDataStructure").text();
    if (structure.starts_with("TensorTree"))
        return of.error("IncidentDataStructure", "Columns or Rows: matrices of patches", "a tensor tree");
    definition.is_in_rows = same(structure, "Rows");
    if (!definition.is_in_rows && !same(structure, "Columns"))
        return of.error("IncidentDataStructure", "Columns or Rows", quoted(structure));
    for (const Element& basis_of : of.children("AngleBasis")) {
        if (definition.bases.size() == k_most_blocks) return of.error("angle bases", "fewer", "more");
        auto basis = read_basis(basis_of);
        if (!basis) return basis.error();
        definition.bases.push_back(*std::move(basis));
    }
    return definition;
}

Result<KlemsTable> read_matrix(const Element& block, const Definition& definition) {
    const auto& [bases, rows] = definition;
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
    return table;
}

// ---- Beams ----

/// A peak is one of a beam if it rises above the patches about it by at least this share of what these see, and by so
/// many times what these rise above the rest: a lobe as wide as a patch would reach them.
constexpr float k_least_rise = 0.5f, k_narrow = 10;

/// The patches that touch a patch: those of its ring, of a ring of one those of the next; and those of other rings at
/// its azimuth.
struct Neighbours {
    std::vector<std::size_t> of_ring, all;
};
Neighbours neighbours(const AngleBasis& basis, std::size_t patch) {
    const std::size_t ring = basis.ring_of(patch), first = basis.first_of(ring), n = basis.rings[ring].azimuths;
    Neighbours found;
    const std::size_t next = ring + 1 < basis.rings.size() ? ring + 1 : ring > 0 ? ring - 1 : ring;
    if (n >= 3)
        found.of_ring = {first + (patch - first + 1) % n, first + (patch - first + n - 1) % n};
    else
        for (std::size_t k = 0; k < basis.rings[next].azimuths; ++k) found.of_ring.push_back(basis.first_of(next) + k);
    found.all = found.of_ring;
    for (const std::size_t other : {ring + 1, ring - 1})
        if (other < basis.rings.size())
            found.all.push_back(
                basis.patch_of(to_float(spherical(double(basis.rings[other].theta), basis.azimuth_of(patch)))));
    return found;
}

/// Moves what is a beam from the cells to `beam`. Rings are judged as a whole.
void separate_beam(KlemsTable& table) {
    const AngleBasis &in = table.incident, &out = table.outgoing;
    const std::size_t I = in.patches();
    std::vector<Rgb> beam(I);
    bool any = false;
    for (std::size_t ring = 0; ring < in.rings.size(); ++ring) {
        struct Peak {
            std::size_t patch;
            float around;
        };
        std::vector<Peak> peaks;
        double peak = 0, around = 0, typical = 0;
        for (std::size_t i = in.first_of(ring); i < in.first_of(ring + 1); ++i) {
            const auto [theta, phi] = std::pair(double(in.rings[ring].theta), in.azimuth_of(i));
            const std::size_t o = out.patch_of(to_float(spherical(theta, phi)));
            float most = 0, sum = 0;
            const auto near = neighbours(out, o);
            for (const std::size_t n : near.all) most = std::max(most, table.cell(n, i).g);
            for (const std::size_t n : near.of_ring) sum += table.cell(n, i).g;
            std::vector<float> column;
            for (std::size_t k = 0; k < out.patches(); ++k) column.push_back(table.cell(k, i).g);
            std::ranges::nth_element(column, column.begin() + std::ptrdiff_t(column.size() / 2));
            peak += double(table.cell(o, i).g), around += double(most), typical += double(column[column.size() / 2]);
            peaks.push_back({o, sum / float(near.of_ring.size())});
        }
        const double rise = peak - around;
        if (!(rise > double(k_least_rise) * std::max(around, 0.0)) ||
            !(rise > double(k_narrow) * std::max(around - typical, 0.0)))
            continue;
        any = true;
        for (std::size_t k = 0; k < peaks.size(); ++k) {
            const std::size_t i = in.first_of(ring) + k, o = peaks[k].patch;
            Rgb& cell = table.cells[o * I + i];
            const float of_patch = float(out.projected_solid_angle(out.ring_of(o)));
            for (int c = 0; c < 3; ++c) {
                beam[i][c] = std::clamp((cell[c] - peaks[k].around) * of_patch, 0.f, 1.f);
                cell[c] -= beam[i][c] / of_patch;
            }
        }
    }
    if (any) table.beam = std::move(beam);
}

/// The mean over the azimuths of one or two matrices.
Beam beam_of(std::span<const KlemsTable* const> tables) {
    Beam beam;
    for (const KlemsTable* table : tables) {
        if (table->beam.empty()) continue;
        const AngleBasis& basis = table->incident;
        for (std::size_t ring = 0; ring < basis.rings.size(); ++ring) {
            std::array<double, 3> sum{};
            for (std::size_t i = basis.first_of(ring); i < basis.first_of(ring + 1); ++i)
                for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += double(table->beam[i][c]);
            const double n = basis.rings[ring].azimuths;
            Rgb mean{float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
            const float theta = basis.rings[ring].theta;
            const auto at = std::ranges::lower_bound(beam.theta, theta);
            const auto k = at - beam.theta.begin();
            if (at != beam.theta.end() && *at == theta) {
                for (int c = 0; c < 3; ++c)
                    beam.share[std::size_t(k)][c] = 0.5f * (beam.share[std::size_t(k)][c] + mean[c]);
            } else {
                beam.theta.insert(at, theta);
                beam.share.insert(beam.share.begin() + k, mean);
            }
        }
    }
    return beam;
}

// ---- Files ----

/// Parses the text of a file; entities and document types are not looked at, since all that is read is names and
/// numbers.
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
    const auto parsed =
        document.load_buffer(bytes.data(), bytes.size(), pugi::parse_minimal | pugi::parse_cdata, pugi::encoding_utf8);
    if (parsed) return Done{};
    return Error{file_name, std::uint64_t(std::max<std::ptrdiff_t>(parsed.offset, 0)), "XML", "a well-formed file",
                 parsed.description()};
}

/// WINDOW's words for the parts.
std::optional<Part> part_named(std::string_view text) {
    constexpr std::array<std::string_view, k_parts> names{"Reflection Front", "Reflection Back", "Transmission Front",
                                                          "Transmission Back"};
    for (std::size_t p = 0; p < k_parts; ++p)
        if (same(text, names[p])) return Part(p);
    return {};
}

using Matrices = std::array<std::optional<KlemsTable>, k_parts>;
using NamedMatrices = std::pair<std::string, Matrices>;

/// Reads the matrix of a block into that of its part and band.
Result<Done> read_block(const Element& block, const Definition& definition, const std::string& band,
                        std::vector<NamedMatrices>& bands) {
    const std::string_view direction = block.child("WavelengthDataDirection").text();
    const auto part = part_named(direction);
    if (!part)
        return block.error("WavelengthDataDirection", "Transmission or Reflection, Front or Back", quoted(direction));
    auto of_band = std::ranges::find(bands, band, &NamedMatrices::first);
    if (of_band == bands.end()) of_band = bands.insert(bands.end(), {band, {}});
    auto& matrix = of_band->second[std::size_t(*part)];
    if (matrix) return block.error(std::string(name(*part)), "one matrix in a band", "another");
    auto table = read_matrix(block, definition);
    if (!table) return table.error();
    matrix = *std::move(table);
    return Done{};
}

Result<std::vector<NamedMatrices>> read_bands(const Element& layer, const Definition& definition) {
    std::vector<NamedMatrices> bands;
    std::size_t blocks = 0;
    for (const Element& data : layer.children("WavelengthData")) {
        const std::string band(data.child("Wavelength").text().substr(0, 100));
        for (const Element& block : data.children("WavelengthDataBlock")) {
            if (++blocks > k_most_blocks)
                return block.error("matrices", fmt::format("at most {}", k_most_blocks), "more");
            if (const auto read = read_block(block, definition, band, bands); !read) return read.error();
        }
    }
    if (bands.empty()) return layer.error("Layer", "at least one WavelengthDataBlock", "none");
    return bands;
}

BsdfTable::Band band_of(std::string name, Matrices&& matrices, const std::string& file_name) {
    BsdfTable::Band band;
    band.name = std::move(name);
    std::array<std::vector<const KlemsTable*>, 3> with_beams;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!matrices[p]) continue;
        separate_beam(*matrices[p]);
        Measured part{file_name, "BSDF XML", 0, *std::move(matrices[p])};
        band.part[p] = std::make_shared<const Measured>(std::move(part));
        with_beams[beam_of(Part(p))].push_back(&std::get<KlemsTable>(band.part[p]->table));
    }
    for (std::size_t b = 0; b < band.beam.size(); ++b) band.beam[b] = beam_of(std::span(with_beams[b]));
    return band;
}

}  // namespace

bool is_xml(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    const std::string_view rest = stripped(text.substr(0, 4096));
    return rest.starts_with("<?xml") || rest.starts_with("<WindowElement") || rest.starts_with("<!");
}

Result<BsdfTable> read_bsdf_xml(std::span<const std::byte> bytes, const std::string& file_name) {
    pugi::xml_document document;
    if (const auto parsed = parse(bytes, file_name, document); !parsed) return parsed.error();
    const Element file{document, &file_name}, root = file.child("WindowElement");
    if (!root.node) return Error{file_name, {}, "XML", "an element WindowElement", "none"};
    const Element layer = root.child("Optical").child("Layer");
    if (!layer.node) return root.error("WindowElement", "an element Optical with a Layer", "none");
    const auto definition = read_definition(layer.child("DataDefinition"));
    if (!definition) return definition.error();
    auto bands = read_bands(layer, *definition);
    if (!bands) return bands.error();

    BsdfTable table;
    table.description = layer.child("Material").child("Name").text().substr(0, 200);
    for (auto& [name, matrices] : *bands) {
        if (same(name, "Visible")) table.chosen = table.bands.size();
        table.bands.push_back(band_of(name, std::move(matrices), file_name));
    }
    return table;
}

}  // namespace srbf
