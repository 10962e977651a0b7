// Values of the tables of each format, and functions that a format alone has for its table.
#pragma once
#include <optional>

#include "srbf/brdf.h"
#include "srbf/measured.h"

SRBF_BEGIN

// f_r [1/sr] of unit vectors, which is not checked: 0 if wl.z ≤ 0 or wv.z ≤ 0, and otherwise finite, or NaN in every
// channel where each function says so. Negative channels occur where a saturated colour lies outside of the gamut.
/// f_r by trilinear interpolation over the measured ones of the eight surrounding nodes, not negative; NaN if none was
/// measured.
Rgb signed_value(const MerlTable& table, Vec3f wl, Vec3f wv);
/// f_r. Never NaN.
Rgb signed_value(const RglTable& table, Vec3f wl, Vec3f wv);
/// f_r by linear interpolation; NaN where one of the samples is masked.
Rgb signed_value(const MbsdfTable& table, Vec3f wl, Vec3f wv);
/// f_r by interpolation. Never NaN: masked samples are left out.
Rgb signed_value(const ScatteredSamples& samples, Vec3f wl, Vec3f wv);
/// f_r by the function of the table.
Rgb signed_value(const EvaluatedTable& table, Vec3f wl, Vec3f wv);
/// f of the chosen band on either side: `value` of the part, or of its counterpart if the part is missing; 0 without
/// both.
Rgb signed_value(const BsdfTable& table, Vec3f wl, Vec3f wv);

/// f[i] = signed_value(table, wl[i], wv[i]). The spans have the same length. Isotropic tables use the widest SIMD
/// instructions of the machine, within 1e-4 relative or 1e-5 of the table's largest colour over cosθv.
void evaluate_signed(const RglTable& table, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `evaluate_signed` of a MERL table: the bits of `signed_value`.
void evaluate_signed(const MerlTable& table, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);

/// f[c] = f_r at wavelength c of a spectral measurement, with the look-up of the colours: its colour is `signed_value`.
void signed_spectrum(const RglTable& table, Vec3f wl, Vec3f wv, std::span<float> f);
void signed_spectrum(const ScatteredSamples& samples, Vec3f wl, Vec3f wv, std::span<float> f);

/// The change of samples with the azimuth, √(Σ |g_i − g_k|² / Σ |g_i|²) of g = f cosθl cosθv, over pairs of samples
/// that a turn about the normal by more than 15° takes to each other, within 0.1° or 10°. Returns 0 without such pairs
/// (lights or viewers are at one azimuth, or in one plane, whose halves may differ), if the change is at most 14 %
/// (noise), or 1 % where turns near 180° change less, and if smaller turns change more than 0.4 of it.
double change_by_azimuth(const ScatteredSamples& samples);

/// `signed_spectrum` on arrays of pairs. It keeps a reference to `measured`.
Channels signed_spectra(const Measured& measured);
Channels signed_spectra(const Measured&&) = delete;

/// True if f(Rωl, Rωv) = f(ωl, ωv) for rotations R about the normal, up to rounding or noise, over θ ≤ max_theta [rad]:
/// the mean squared change of f cosθl cosθv under random rotations is at most 1e-6 of the mean square of f cosθl cosθv,
/// or at most 2 % of it and at most 2.5 times the change under rotation by 15°. The change that independent noise with
/// the standard deviation `noise` [1/sr] of each channel causes is subtracted.
bool is_isotropic(const Evaluate& f, double max_theta, const Rgb& noise = {});

/// True if two fractions of a beam are equal within the accuracy of a fit: 1 % of their mean, or 0.001.
bool are_same_fraction(const Rgb& a, const Rgb& b);
Rgb mean_fraction(std::span<const Rgb> fractions);
/// If the beams of both transmissions are reciprocal, sets the front's to their mean, and the back's to none.
void unite_transmissions(Beams& beams);

/// A part of a BSDF without the light that its table keeps as a peak though it is not scattered.
struct SeparatedBeam {
    Evaluate rest;  ///< f with the peak cut off at the level about it
    Beam beam;      ///< the fraction that is cut off
};
/// A line that `srbf info` prints about a table: a text, or the ranges of colours, channel by channel.
struct TableLine {
    std::string name, text;
    std::span<const Rgb> colours = {};
};

/// The functions that a format provides for its tables.
struct TableFunctions {
    std::function<std::vector<TableLine>()> lines;
    /// The part without its peaks of unscattered light, if it has any; null: it has none.
    std::function<std::optional<SeparatedBeam>()> separated_beam = {};
};

SRBF_END
