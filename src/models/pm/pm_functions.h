// Spectra, reciprocity and sizes of multivariate models.
#pragma once
#include "srbf/models/pm.h"

SRBF_BEGIN

/// The colour (`to_rgb`) of each of the spectra, which are stored contiguously.
std::vector<Rgb> colours(std::span<const float> spectra, std::span<const float> wavelengths);

/// ρ at the wavelengths of a spectral model, evaluated three at a time like R, G, B in `evaluate`. It keeps a reference
/// to `model`.
Channels spectra(const PmModel& model);
Channels spectra(const PmModel&&) = delete;

/// True if f(ωl, ωv) = f(ωv, ωl) by construction: the form is reciprocal; or, up to rounding, each variate (a, b) with
/// a ≠ b has a partner (b, a) with the same centres and bandwidths in all lobes.
bool is_reciprocal(const PmModel& model);

/// True if a log scale is stored: the form has further features, or some s_j does not round to 0 in half precision.
bool has_log_scale(const PmModel& model);
/// Size of the stored numbers of any model of that kind, two bytes each.
constexpr std::size_t payload_bytes(PmForm form, bool axial, bool log_scale, int lobes, int variates,
                                    int channels = 3) {
    const int lobe_numbers = channels + (axial ? 1 : 3) * variates + int(log_scale) + features(form);
    return 2 * std::size_t(lobes * lobe_numbers + 2 * variates);
}

SRBF_END
