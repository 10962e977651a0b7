// Pairs of patches that isotropy makes equal, and beams in matrices: private to readers and fits.
#pragma once
#include <array>
#include <string_view>
#include <vector>

#include "srbf/daylight.h"

namespace srbf {

/// The band of a file in colour, which the file has as R, G and B.
constexpr std::string_view k_colours = "RGB";

template <typename Each> void members(AngleBasis& of, const Each& each) { each(of.name), each(of.rings); }
template <typename Each> void members(KlemsTable& of, const Each& each) {
    each(of.incident), each(of.outgoing), each(of.cells), each(of.beam), each(of.masked);
}

std::vector<TableLine> lines_about(const KlemsTable& table);

/// WINDOW's words for the parts, in the order of `Part`.
constexpr std::array<std::string_view, k_parts> k_window_names{"Reflection Front", "Reflection Back",
                                                               "Transmission Front", "Transmission Back"};
/// The directions of points of an incident and of an outgoing patch (daylight.h, `KlemsTable`).
inline Vec3f light_at(Vec3d p) { return to_float({p.x, -p.y, p.z}); }
inline Vec3f view_at(Vec3d p) { return to_float({-p.x, p.y, p.z}); }

/// Pairs of patches of the same rings whose azimuths differ by the same amount, one way or the other.
struct PatchClass {
    std::size_t outgoing, incident;   ///< patches of one of the pairs
    double weight = 0;                ///< Σ of the products of projected solid angles [sr²]
    Rgb mean;                         ///< of the cells [1/sr]
    double energy = 0, variance = 0;  ///< Σ weight |f|², Σ weight |f − mean|²
};
/// `isotropic`: classes as above; otherwise each pair is one. What is not measured is left out.
std::vector<PatchClass> patch_classes(const KlemsTable& table, bool isotropic);

/// True if a peak is one of a beam: it rises above the largest value about it by at least half of that, and by ten times
/// what that rises above a typical value. A lobe as wide as a patch would reach those about it.
bool is_peak_of_beam(double value, double about, double typical);
/// Moves what are beams from the cells of the parts' matrices, or null, to their `beam`: what is a beam through the surface
/// one way is one the other way. Returns the beams of the BSDF, united.
Beams separate_beams(const std::array<KlemsTable*, k_parts>& matrices);

}  // namespace srbf
