// Pairs of patches that isotropy makes equal, and beams in matrices: private to readers and fits.
#pragma once
#include <array>
#include <string_view>
#include <vector>

#include "srbf/measured.h"

namespace srbf {

/// The band of a file in colour, which the file has as R, G and B.
constexpr std::string_view k_colours = "RGB";

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
/// If the beams of both transmissions are one by reciprocity, their mean is that of the front, and the back's is empty.
void unite_transmissions(Beams& beams);

}  // namespace srbf
