// Matrices of patches computed from any BSDF, and their XML.
#include <fmt/format.h>

#include "base/parallel.h"
#include "base/printable.h"
#include "base/r_sequence.h"
#include "brdf/parts.h"
#include "brdf/values.h"
#include "extras/daylight/formats.h"
#include "extras/daylight/klems.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

/// Points in each pair of patches. There are more if the outgoing patch touches or nearly touches the patch of the
/// mirror direction, since lobes may be narrower than a patch.
constexpr std::size_t k_pair_points = 256, k_mirror_pair_points = 4096;
/// The distance of the middles of two touching patches is at most this fraction of the sum of their widths, with
/// some margin.
constexpr double k_touching = 0.6;

/// The larger of the two angular widths of a patch [rad].
double width_of(const AngleBasis& basis, std::size_t patch) {
    const AngleBasis::Ring& ring = basis.rings[basis.ring_of(patch)];
    if (ring.azimuths == 1) return 2 * double(ring.to);
    return std::max(double(ring.to) - double(ring.from),
                    2 * k_pi / ring.azimuths * elementary::sin(double(ring.theta)));
}

bool are_near(const AngleBasis& basis, std::size_t a, std::size_t b) {
    const double max_angle = std::min(k_touching * (width_of(basis, a) + width_of(basis, b)), k_pi);
    return dot(basis.middle_of(a), basis.middle_of(b)) > elementary::cos(max_angle);
}

/// Degrees with the precision that files have.
std::string degrees_of(float radians) { return fmt::format("{:.7g}", double(radians) / k_degree); }

std::string basis_text(const AngleBasis& basis) {
    std::string text =
        fmt::format("\t\t<AngleBasis>\n\t\t\t<AngleBasisName>{}</AngleBasisName>\n", html_escaped(basis.name));
    for (const AngleBasis::Ring& ring : basis.rings)
        text += fmt::format(
            "\t\t\t<AngleBasisBlock>\n\t\t\t\t<Theta>{}</Theta>\n\t\t\t\t<ThetaBounds>\n\t\t\t\t\t<LowerTheta>{}</"
            "LowerTheta>\n"
            "\t\t\t\t\t<UpperTheta>{}</UpperTheta>\n\t\t\t\t</ThetaBounds>\n\t\t\t\t<nPhis>{}</nPhis>\n"
            "\t\t\t</AngleBasisBlock>\n",
            degrees_of(ring.theta), degrees_of(ring.from), degrees_of(ring.to), ring.azimuths);
    return text + "\t\t</AngleBasis>\n";
}

/// The number that is written for a colour.
using ColourToNumber = double (*)(const Rgb&);

/// The mean over a pair of patches, including the beam.
double cell_with_beam(const KlemsTable& table, std::size_t o, std::size_t i, ColourToNumber number_of) {
    double f = number_of(table.cell(o, i));
    if (table.beam.empty()) return f;
    if (o == table.straight_ahead(i))
        f += number_of(table.beam[i]) / table.outgoing.projected_solid_angle(table.outgoing.ring_of(o));
    return f;
}

std::string block_text(const std::string& band, Part part, const KlemsTable& table, ColourToNumber number_of) {
    const bool is_solar = band == "Solar";
    std::string text = fmt::format(
        "\t<WavelengthData>\n\t\t<LayerNumber>System</LayerNumber>\n\t\t<Wavelength unit=\"Integral\">{}</Wavelength>\n"
        "\t\t<SourceSpectrum>{}</SourceSpectrum>\n\t\t<DetectorSpectrum>{}</"
        "DetectorSpectrum>\n\t\t<WavelengthDataBlock>\n"
        "\t\t\t<WavelengthDataDirection>{}</WavelengthDataDirection>\n\t\t\t<ColumnAngleBasis>{}</ColumnAngleBasis>\n"
        "\t\t\t<RowAngleBasis>{}</RowAngleBasis>\n\t\t\t<ScatteringDataType>{}</ScatteringDataType>\n"
        "\t\t\t<ScatteringData>\n",
        html_escaped(band), is_solar ? "NFRC 300" : "CIE Illuminant D65 1nm.ssp",
        is_solar ? "None" : "ASTM E308 1931 Y.dsp", k_window_names[std::size_t(part)],
        html_escaped(table.incident.name), html_escaped(table.outgoing.name), is_transmission(part) ? "BTDF" : "BRDF");
    const std::size_t n_in = table.incident.patches(), n_out = table.outgoing.patches();
    for (std::size_t o = 0; o < n_out; ++o) {
        for (std::size_t i = 0; i < n_in; ++i)
            fmt::format_to(std::back_inserter(text), "{:.6g},{}", cell_with_beam(table, o, i, number_of),
                           i + 1 < n_in ? " " : "\n");
    }
    return text + "\t\t\t</ScatteringData>\n\t\t</WavelengthDataBlock>\n\t</WavelengthData>\n";
}

/// The basis that the options choose.
AngleBasis basis_of(const TableOptions& options) {
    const auto* const basis_name = std::ranges::find(k_klems_bases, options.choice);
    return klems_basis(basis_name == std::end(k_klems_bases) ? KlemsBasis::full
                                                             : KlemsBasis(basis_name - std::begin(k_klems_bases)));
}

/// A part as a matrix in the chosen basis. A measured matrix in that basis is used unchanged.
KlemsTable klems_of(const Measured* measured, const TableSource& source, Part part, const TableOptions& options) {
    const AngleBasis basis = basis_of(options);
    const auto* matrix = measured ? table_as<KlemsTable>(*measured) : nullptr;
    if (matrix && matrix->incident.name == basis.name && matrix->outgoing.name == basis.name) return *matrix;
    const auto values = [evaluate = part_of(non_negative(source.values), part), &options](auto wl, auto wv, auto f) {
        if (!options.progress.cancelled()) evaluate(wl, wv, f);
    };
    KlemsTable table = to_klems(values, basis, options.threads);
    add_beam(table, source.beams, part);
    return table;
}

/// A band of matrices that include the beams of their parts.
BsdfTable::Band patches_of(std::string name, const TableSource& source, const TableOptions& options) {
    const auto* bsdf =
        source.measured && !source.measured->is_exchanged ? std::get_if<BsdfTable>(&source.measured->table) : nullptr;
    BsdfTable::Band band{std::move(name), {}, {}};
    for (std::size_t p = 0; p < k_parts; ++p)
        if (source.has[p])
            band.part[p] = std::make_shared<const Measured>(Measured{
                {},
                {},
                0,
                as_evaluated_table(klems_of(bsdf ? bsdf->band().part[p].get() : nullptr, source, Part(p), options))});
    return band;
}

}  // namespace

KlemsTable to_klems(const Evaluate& part, const AngleBasis& basis, int threads) {
    const StandardArithmetic mode;
    const std::size_t n = basis.patches();
    KlemsTable table{basis, basis, std::vector<Rgb>(n * n), {}, 0};
    parallel_for(n, threads, [&](std::size_t i) {
        std::vector<Vec3f> wl, wv;
        std::vector<Rgb> f;
        for (std::size_t o = 0; o < n; ++o) {
            const bool is_near = are_near(basis, i, o);
            wl.clear(), wv.clear();
            RSequence<4> points;
            for (std::size_t k = is_near ? k_mirror_pair_points : k_pair_points; k > 0; --k) {
                const auto u = points.next();
                wl.push_back(light_at(basis.point_of(i, u[0], u[1])));
                wv.push_back(view_at(basis.point_of(o, u[2], u[3])));
            }
            f.resize(wl.size());
            part(wl, wv, f);
            std::array<double, 3> sum{};
            std::size_t count = 0;
            for (const Rgb& value : f) {
                if (!is_finite(value)) continue;
                ++count;
                for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += double(value[c]);
            }
            for (int c = 0; c < 3 && count > 0; ++c)
                table.cells[o * n + i][c] = float(std::max(sum[std::size_t(c)] / double(count), 0.0));
        }
    });
    return table;
}

void add_beam(KlemsTable& table, const Beams& beams, Part part) {
    if (beams[std::size_t(part)].empty() && !(is_transmission(part) && !beams[std::size_t(counterpart(part))].empty()))
        return;
    table.beam.clear();
    for (std::size_t i = 0; i < table.incident.patches(); ++i)
        table.beam.push_back(fraction_at(beams, part, light_at(table.incident.middle_of(i))));
}

std::string write_bsdf_xml(const BsdfTable& table) {
    std::vector<AngleBasis> bases;
    std::string blocks;
    for (const BsdfTable::Band& band : table.bands)
        for (const Part part :
             {Part::transmission_front, Part::transmission_back, Part::reflection_front, Part::reflection_back}) {
            const auto& measured_part = band.part[std::size_t(part)];
            if (!measured_part) continue;
            const KlemsTable& matrix = *table_as<KlemsTable>(*measured_part);
            for (const AngleBasis* basis : {&matrix.incident, &matrix.outgoing})
                if (std::ranges::find(bases, basis->name, &AngleBasis::name) == bases.end()) bases.push_back(*basis);
            if (band.name == k_colours) {
                blocks += block_text("R", part, matrix, [](const Rgb& f) { return double(f.r); }) +
                          block_text("G", part, matrix, [](const Rgb& f) { return double(f.g); }) +
                          block_text("B", part, matrix, [](const Rgb& f) { return double(f.b); });
                continue;
            }
            blocks += block_text(band.name.empty() ? "Visible" : band.name, part, matrix,
                                 [](const Rgb& f) { return f.r == f.g && f.g == f.b ? double(f.g) : luminance(f); });
        }
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WindowElement xmlns=\"http://windows.lbl.gov\" "
        "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
        "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
        "<WindowElementType>System</WindowElementType>\n<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n";
    // WINDOW's parser requires a manufacturer and a thickness, which a BSDF does not have.
    text += fmt::format(
        "\t<Material>\n\t\t<Name>{}</Name>\n\t\t<Manufacturer>unknown</Manufacturer>\n"
        "\t\t<Thickness unit=\"Millimeter\">1</Thickness>\n\t\t<DeviceType>Other</DeviceType>\n\t</Material>\n"
        "\t<DataDefinition>\n\t\t<IncidentDataStructure>Columns</IncidentDataStructure>\n",
        table.description.empty() ? "BSDF" : html_escaped(table.description));
    for (const AngleBasis& basis : bases) text += basis_text(basis);
    return text + "\t</DataDefinition>\n" + blocks + "</Layer>\n</Optical>\n</WindowElement>\n";
}

Result<std::vector<std::byte>> write_as_bsdf_xml(const TableSource& source, const TableOptions& options) {
    BsdfTable matrices;
    matrices.description = options.description;
    const auto* bsdf = source.measured ? std::get_if<BsdfTable>(&source.measured->table) : nullptr;
    if (!bsdf) matrices.bands.push_back(patches_of("Visible", source, options));
    for (std::size_t b = 0; bsdf && b < bsdf->bands.size(); ++b) {
        Measured in_band = *source.measured;
        std::get<BsdfTable>(in_band.table).chosen = b;
        matrices.bands.push_back(patches_of(bsdf->bands[b].name, table_source(in_band), options));
    }
    return bytes_of(write_bsdf_xml(matrices));
}

}  // namespace
