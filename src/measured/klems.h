// Pairs of patches that isotropy makes equal, and beams in matrices: private to readers and fits.
#pragma once
#include <span>
#include <vector>

#include "srbf/measured.h"

namespace srbf {

/// Pairs of patches of the same rings whose azimuths differ by the same amount, one way or the other.
struct PatchClass {
    std::size_t outgoing, incident;   ///< patches of one of the pairs
    double weight = 0;                ///< Σ of the products of projected solid angles [sr²]
    Rgb mean;                         ///< of the cells [1/sr]
    double energy = 0, variance = 0;  ///< Σ weight |f|², Σ weight |f − mean|²
};
/// `isotropic`: classes as above; otherwise each pair is one. What is not measured is left out.
std::vector<PatchClass> patch_classes(const KlemsTable& table, bool isotropic);

/// Whether a peak is one of a beam: it rises above the largest value about it by at least half of that, and by ten times
/// what that rises above a typical value. A lobe as wide as a patch would reach those about it.
bool is_peak_of_beam(double value, double about, double typical);
/// Which incident patches have a beam: a ring is judged as a whole, and each of its patches alone.
std::vector<bool> beam_patches(const KlemsTable& table);
/// Moves the beams of these incident patches from the cells to `beam`.
void separate_beam(KlemsTable& table, const std::vector<bool>& patches);
/// The same of both transmissions: what is a beam one way is one the other way.
void separate_beams(KlemsTable& front, KlemsTable& back);
/// The beam of a matrix: a node for each incident patch, or one for a ring whose nodes hardly differ.
Beam beam_of(const KlemsTable& table);
/// If the beams of both transmissions are one by reciprocity, their mean is that of the front, and the back's is empty.
void unite_transmissions(Beams& beams);

}  // namespace srbf
