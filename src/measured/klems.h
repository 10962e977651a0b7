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

/// Moves what is a beam from the cells to `beam`. Rings are judged as a whole.
void separate_beam(KlemsTable& table);
/// The mean over the azimuths of one or two matrices.
Beam beam_of(std::span<const KlemsTable* const> tables);

}  // namespace srbf
