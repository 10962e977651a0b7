// The formats of daylighting simulation.
#pragma once
#include "measured/formats/format_rows.h"
#include "srbf/daylight.h"

namespace SRBF_NAMESPACE {

bool is_xml(std::string_view text);
Result<Measured> read_as_bsdf_xml(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&);
Result<std::vector<std::byte>> write_as_bsdf_xml(const TableSource& source, const TableOptions& options);

inline constexpr std::string_view k_klems_bases[] = {"full", "half", "quarter"};  ///< names by `KlemsBasis`
inline constexpr WriterOption k_klems_option{
    "--basis", "XML: Klems' basis, with 145 (full), 77 (half) or 41 (quarter) patches", k_klems_bases};
inline constexpr Format k_daylight_formats[] = {
    {.name = "BSDF XML",
     .is_text = true,
     .recognise = in_text<is_xml>,
     .read = read_as_bsdf_xml,
     .extension = ".xml",
     .used_by = "WINDOW and Radiance",
     .anisotropic = true,
     .beams = true,
     .write = write_as_bsdf_xml,
     .option = &k_klems_option},
};

}  // namespace
