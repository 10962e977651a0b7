// Reading of any BRDF, and writing of any as a table.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "srbf/measured.h"
#include "srbf/model.h"
#include "srbf/progress.h"
#include "srbf/vec.h"

namespace [[gnu::visibility("default")]] srbf {

/// A measurement or a model.
using AnyBrdf = std::variant<Measured, Model>;
/// True if it is a BSDF, which answers on the front and the back (bsdf.h).
bool is_two_sided(const AnyBrdf& brdf);
/// True if a part of it is known, or answered by its counterpart; of a BRDF the front reflection alone.
bool has_part(const AnyBrdf& brdf, Part part);
/// Reads a measurement or a model, recognised by its content. "FILE#T" is texel T of a stack of models (model.h), unless
/// there is a file of that name. Errors: those of load_measured and load_model.
/// `options` are for measurements.
Result<AnyBrdf> load_brdf(const std::string& path, const ReadOptions& options = {});

/// The measurement or model that `load` and `fit` of srbf.h hold.
const AnyBrdf& content(const LoadedBrdf& brdf);
LoadedBrdf loaded_brdf(AnyBrdf content);

/// The formats of tables that can be written (convert.h).
enum class TableFormat { merl, rgl, mbsdf, csv, bsdf_xml, zemax, speos, openmaterial };
/// A format, the extension of its files, and its name in `Measured`.
struct TableFormatRow {
    TableFormat format;
    std::string_view extension, name;
};
inline constexpr TableFormatRow k_table_formats[] = {{TableFormat::merl, ".binary", "MERL"},
                                                     {TableFormat::zemax, ".zemax.bsdf", "Zemax"},
                                                     {TableFormat::rgl, ".bsdf", "RGL"},
                                                     {TableFormat::mbsdf, ".mbsdf", "MBSDF"},
                                                     {TableFormat::csv, ".csv", "CSV"},
                                                     {TableFormat::bsdf_xml, ".xml", "BSDF XML"},
                                                     {TableFormat::speos, ".anisotropicbsdf", "Speos"},
                                                     {TableFormat::openmaterial, ".xompt", "OpenMATERIAL"}};
/// The format of a file with that name, by its extension; null if it is none of these.
const TableFormatRow* table_format(std::string_view path);

struct TableOptions {
    std::string description;              ///< of the material
    int directions = 64;                  ///< CSV of tables and models: all pairs of this many directions
    double max_theta = 89 * k_degree;     ///< [rad], of these directions
    KlemsBasis basis = KlemsBasis::full;  ///< BSDF XML: its patches
    bool spectra = true;                  ///< RGL: spectra beside the colours, see `write_rgl`
    int threads = 0;                      ///< 0: as many as the machine has; the result does not depend on it
    ProgressToken progress = {};          ///< for cancellation
};
/// The bytes of a file of that format with the values of `brdf`. Scattered samples become CSV as they are. Of
/// a BSDF an MBSDF file has the parts of light from the front, CSV and BSDF XML have all of them. Errors: an anisotropic
/// measurement, except for CSV and BSDF XML; a BSDF, for MERL and RGL; it was cancelled.
Result<std::vector<std::byte>> table_file(const AnyBrdf& brdf, TableFormat format, const TableOptions& options = {});

}  // namespace srbf
