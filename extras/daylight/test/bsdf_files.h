// BSDF XML made for tests.
#pragma once
#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

#include "srbf/daylight.h"

namespace srbf {

/// A basis as an XML element.
inline std::string basis_xml(const std::string& name, const std::vector<double>& bounds,
                             const std::vector<int>& azimuths) {
    std::string text = fmt::format("<AngleBasis><AngleBasisName>{}</AngleBasisName>\n", name);
    for (std::size_t r = 0; r < azimuths.size(); ++r)
        text += fmt::format(
            "<AngleBasisBlock><Theta>{}</Theta><ThetaBounds><LowerTheta>{}</LowerTheta><UpperTheta>{}</UpperTheta>"
            "</ThetaBounds><nPhis>{}</nPhis></AngleBasisBlock>\n",
            r == 0 ? 0 : (bounds[r] + bounds[r + 1]) / 2, bounds[r], bounds[r + 1], azimuths[r]);
    return text + "</AngleBasis>\n";
}

/// A basis of nine patches.
inline AngleBasis small_basis() {
    AngleBasis basis{"small", {}};
    const double bounds[] = {0, 20, 60, 90};
    const std::uint32_t azimuths[] = {1, 4, 4};
    for (std::size_t r = 0; r < 3; ++r)
        basis.rings.push_back({float((r == 0 ? 0 : (bounds[r] + bounds[r + 1]) / 2) * k_degree),
                               float(bounds[r] * k_degree), float(bounds[r + 1] * k_degree), azimuths[r]});
    return basis;
}

/// A matrix as an XML element, with f(o, i) for outgoing patch o and incident patch i.
inline std::string matrix_xml(const std::string& direction, const std::string& basis, std::size_t patches,
                              const std::function<double(std::size_t, std::size_t)>& f,
                              const std::string& band = "Visible") {
    std::string numbers;
    for (std::size_t o = 0; o < patches; ++o)
        for (std::size_t i = 0; i < patches; ++i)
            numbers += fmt::format("{:.7g},{}", f(o, i), i + 1 < patches ? " " : "\n");
    return fmt::format(
        "<WavelengthData><LayerNumber>System</LayerNumber><Wavelength unit=\"Integral\">{}</Wavelength>\n"
        "<WavelengthDataBlock><WavelengthDataDirection>{}</WavelengthDataDirection>\n"
        "<ColumnAngleBasis>{}</ColumnAngleBasis><RowAngleBasis>{}</RowAngleBasis>\n"
        "<ScatteringDataType>BTDF</ScatteringDataType><ScatteringData>\n{}</ScatteringData>\n"
        "</WavelengthDataBlock></WavelengthData>\n",
        band, direction, basis, basis, numbers);
}

/// A file with these bases and matrices.
inline std::string bsdf_xml(const std::string& bases, const std::string& matrices,
                            const std::string& structure = "Columns") {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WindowElement xmlns=\"http://windows.lbl.gov\">\n"
        "<WindowElementType>System</WindowElementType><Optical><Layer>\n<Material><Name>A shade</Name></Material>\n"
        "<DataDefinition><IncidentDataStructure>{}</IncidentDataStructure>\n{}</DataDefinition>\n{}"
        "</Layer></Optical></WindowElement>\n",
        structure, bases, matrices);
}

inline std::string small_basis_xml() { return basis_xml("small", {0, 20, 60, 90}, {1, 4, 4}); }

/// A shade in `small_basis`. In reflection f is 0.5 (0.1 + 0.02 o + 0.001 i) at the front and twice that at the
/// back; in transmission f is 0.05, with a beam of 0.08 cosθ.
inline std::string small_shade() {
    const AngleBasis basis = small_basis();
    const std::size_t n = basis.patches();
    const auto through = [&](std::size_t o, std::size_t i) {
        const std::size_t ring = basis.ring_of(i);
        const double beam = 0.08 * elementary::cos(double(basis.rings[ring].theta));
        return 0.05 + (o == i ? beam / basis.projected_solid_angle(ring) : 0);
    };
    const auto back = [](std::size_t o, std::size_t i) { return 0.1 + 0.02 * double(o) + 0.001 * double(i); };
    std::string matrices;
    for (const double scale : {1.0, 0.5}) {
        const std::string band = scale == 1 ? "Visible" : "Solar";
        matrices += matrix_xml(
            "Transmission Front", "small", n, [&](auto o, auto i) { return scale * through(o, i); }, band);
        matrices += matrix_xml(
            "Transmission Back", "small", n, [&](auto o, auto i) { return scale * through(o, i); }, band);
        matrices += matrix_xml(
            "Reflection Front", "small", n, [&](auto o, auto i) { return 0.5 * scale * back(o, i); }, band);
        matrices += matrix_xml(
            "Reflection Back", "small", n, [&](auto o, auto i) { return scale * back(o, i); }, band);
    }
    return bsdf_xml(small_basis_xml(), matrices);
}

}  // namespace srbf
