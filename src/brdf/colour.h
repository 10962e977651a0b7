// Conversions between spectra, CIE XYZ and sRGB.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "srbf/vec.h"

SRBF_BEGIN

/// CIE 1931 tristimulus values (2° observer); Y of the perfect white reflector is 1.
struct Xyz {
    double x = 0, y = 0, z = 0;
};

/// Tristimulus values of the perfect white reflector under D65: (0.9504, 1, 1.0890).
Xyz white_point();

/// Converts to linear sRGB, by the matrix for which (1, 1, 1) is `white_point()` and the primaries have the
/// chromaticities (x, y) = (0.64, 0.33), (0.30, 0.60) and (0.15, 0.06) of IEC 61966-2-1.
Rgb to_rgb(const Xyz& colour);

/// The transfer function of sRGB (IEC 61966-2-1) on [0,1]: 12.92 x if x ≤ 0.0031308, otherwise 1.055 x^(1/2.4) − 0.055.
double srgb_encoded(double x);
double srgb_decoded(double x);  ///< its inverse
/// The neutral grey around the object of a picture (linear).
inline constexpr float k_background = 0.16f;

/// Weights that convert a reflectance spectrum to linear sRGB, one per sample of the spectrum. With R(λ) linear between
/// the samples at `wavelengths` [nm] (increasing, at least one) and constant beyond them,
///   X = ∫ R D65 x̄ dλ / ∫ D65 ȳ dλ,  Y and Z likewise,  (R, G, B) = M (X, Y, Z) = Σ_i R(λ_i) weight_i.
/// The weights sum to (1, 1, 1): the perfect reflector is white. x̄, ȳ, z̄ are CIE 1931 2° and D65 is CIE's, tabulated
/// every 5 nm from 360 to 830 nm (ISO/CIE 11664-1 and -2). Their products are interpolated linearly and summed every
/// 1 nm; sums every 5 nm differ by up to 1e-3 for smooth spectra.
std::vector<Rgb> rgb_weights(std::span<const float> wavelengths);

/// True for valid wavelengths [nm] of a spectrum: at least one, increasing, between 100 and 100,000.
bool are_wavelengths(std::span<const float> wavelengths);

/// Σ_i spectrum_i weight_i, without clamping: a saturated colour may have a negative channel.
Rgb to_rgb(std::span<const float> spectrum, std::span<const Rgb> weights);

/// A smooth spectrum of the colour, at the wavelengths `k_primary_wavelengths` [nm],
///   R(λ) = r R_r(λ) + g R_g(λ) + b R_b(λ),
/// whose `to_rgb` is the colour within 2e-6. The three spectra are the smoothest (least sum of squared differences)
/// that lie between 0 and 1, sum to 1 and have the colours (1,0,0), (0,1,0), (0,0,1), as in Mallett & Yuksel, "Spectral
/// primary decomposition for rendering with sRGB reflectance", 2019. White thus has the spectrum 1, and energy
/// conservation is preserved.
inline constexpr std::array<float, 18> k_primary_wavelengths{380, 400, 420, 440, 460, 480, 500, 520, 540,
                                                             560, 580, 600, 620, 640, 660, 680, 700, 720};
std::array<float, 18> reflectance_spectrum(const Rgb& colour);

SRBF_END
