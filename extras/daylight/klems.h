// Classes of pairs of patches, and beams in matrices. Private to readers and fits.
#pragma once
#include <string_view>

#include "measured/tables.h"
#include "srbf/daylight.h"

namespace SRBF_NAMESPACE {

/// The name of a band in colour, which the file has as R, G and B.
constexpr std::string_view k_colours = "RGB";

template <typename Each> void members(AngleBasis& value, const Each& each) {
    each(value.name);
    each(value.rings);
}
template <typename Each> void members(KlemsTable& value, const Each& each) {
    each(value.incident);
    each(value.outgoing);
    each(value.cells);
    each(value.beam);
    each(value.masked);
}

std::vector<TableLine> lines_about(const KlemsTable& table);

/// WINDOW's names of the parts, in the order of `Part`.
constexpr std::array<std::string_view, k_parts> k_window_names{"Reflection Front", "Reflection Back",
                                                               "Transmission Front", "Transmission Back"};
/// The directions for points of an incident and of an outgoing patch (daylight.h, `KlemsTable`).
inline Vec3f light_at(Vec3d p) { return to_float({p.x, -p.y, p.z}); }
inline Vec3f view_at(Vec3d p) { return to_float({-p.x, p.y, p.z}); }

/// Pairs of patches in the same two rings whose azimuths differ by the same amount in either direction.
struct PatchClass {
    std::size_t outgoing, incident;   ///< patches of one of the pairs
    double weight = 0;                ///< Σ of products of projected solid angles [sr²]
    Rgb mean;                         ///< mean of the cells [1/sr]
    double energy = 0, variance = 0;  ///< Σ weight |f|², Σ weight |f − mean|²
};
/// `isotropic`: classes as above; otherwise each pair is a class. Cells that were not measured are left out.
std::vector<PatchClass> patch_classes(const KlemsTable& table, bool isotropic);

/// True if a peak comes from a beam. It must exceed the largest value around it by at least half of that value, and
/// by ten times as much as that value exceeds a typical value. A lobe as wide as a patch would reach the patches
/// around it.
bool is_peak_of_beam(double value, double around, double typical);
/// Moves beams from the cells of the matrices of the parts (or null) to their `beam`. A beam through the surface in
/// one direction is also one in the other. Returns the beams of the BSDF, merged.
Beams separate_beams(const std::array<KlemsTable*, k_parts>& matrices);

}  // namespace
