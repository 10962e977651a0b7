// Spectra of the lobes of a fit to colours.
#pragma once
#include "models/pm/solve/lobes.h"
#include "observe/observations.h"
#include "srbf/models/pm.h"

namespace SRBF_NAMESPACE {

/// `model`, a fit to the colours of these spectral observations, with a coefficient ≥ 0 for each wavelength. Lobes and
/// colours remain: with the fundamental of a lobe's spectrum, which is its component that has a colour, only the other
/// component, the metameric black (Cohen & Kappauf 1982), is fitted to the spectra.
PmModel with_spectra(PmModel model, const LobeShape& shape, const Observations& observations);

}  // namespace srbf
