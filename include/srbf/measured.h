// Measured BRDFs, as their files hold them: level 3.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/result.h"

namespace srbf {

/// A table of MERL's layout ("A data-driven reflectance model", Matusik et al. 2003): isotropic, in
/// Rusinkiewicz' half and difference angles. Node (h, d, p) lies at θ_h = (h/n_h)² π/2, θ_d = d/n_d π/2, φ_d
/// = p/n_p π, with φ_d periodic in π.
struct MerlTable {
    std::array<std::uint32_t, 3> size{};  ///< n_h, n_d, n_p: 90, 90, 180 in the database
    std::vector<Rgb> cells;               ///< f_r [1/sr], p fastest, then d, then h; NaN: not measured
    std::uint64_t masked = 0;             ///< cells without a measurement
};

/// A measurement in the adaptive parameterization of Dupuy & Jakob, "An adaptive parameterization for
/// efficient material acquisition and rendering" (2018). A polar angle θ is stored as u(θ) = √(2θ/π), an
/// azimuth φ as (φ + π)/2π; with h = ωl + ωv, θ_h its polar angle and φ its azimuth from that of ωl,
///   f_r cosθ_v = colour(w) ndf(u(θ_h)) / (4 sigma(u(θ_l))) [1/sr],  w = warp⁻¹(u(θ_h), (φ + π)/2π),
/// where the warp takes the unit square to itself with the density of `visible`. `colour` and `visible` are
/// linear in θ_l between their slices. Anisotropic ones have slices for azimuths φ_l of the light too, count
/// the azimuth of h from +x, and have ndf and sigma also depend on azimuth. Without `jacobian` the colour is f_r
/// cosθ_v itself.
struct RglTable {
    /// The density of visible normals on the unit square, x along θ_h, y along φ: bilinear between nodes at
    /// i/(width−1), j/(height−1). It is stored with the running integrals that the warp needs. Lengths count
    /// in cells, of which a slice has (width−1)(height−1): so its density integrates to 1.
    struct VisibleNormals {
        struct Node {
            float density;
            float left;  ///< ∫ of the density along the row, from x = 0 to the node
        };
        struct Row {
            float whole;  ///< ∫ of the density along the whole row
            float below;  ///< ∫ of that from y = 0 to the row
        };
        std::uint32_t width = 0, height = 0;
        std::vector<Node> nodes;  ///< slices × height × width
        std::vector<Row> rows;    ///< slices × height
    };
    /// The measured colours on the unit square, bilinear between nodes at i/(width−1), j/(height−1); a
    /// channel is negative where a colour leaves the gamut.
    struct Colours {
        std::uint32_t width = 0, height = 0;
        std::vector<Rgb> nodes;  ///< slices × height × width
    };
    /// A function of a direction, bilinear between nodes u(θ) = i/(width−1) and azimuths j/(height−1); of one row where it is
    /// isotropic.
    struct Profile {
        std::uint32_t width = 0, height = 0;
        std::vector<float> nodes;
    };
    std::string description;
    std::vector<float> wavelengths;  ///< [nm], of a spectral file, whose colours these are; else empty
    std::vector<float> spectra;  ///< likewise, as the file has them: slices × wavelengths × height × width of `colour`
    std::vector<float> phi_l;    ///< [rad], increasing, slices for each; empty: isotropic
    /// How often the azimuths that were measured fit around: 1, 2 (the other half turned by π), 4 (mirrored at both axes).
    int symmetry = 1;
    bool jacobian = true;
    std::vector<float> theta_l;  ///< [rad], increasing, a slice for each
    Profile ndf;                 ///< microfacet distribution
    Profile sigma;               ///< projected area
    VisibleNormals visible;      ///< slices: φ_l × θ_l
    Colours colour;              ///< likewise
};

/// A table of UTIA's layout (Filip & Vávra, "Template-based sampling of anisotropic BRDFs", 2014): θ_l and θ_v at 0, 15, .. 75°,
/// φ_l and φ_v at 0, 7.5, .. 352.5°.
struct UtiaTable {
    static constexpr std::uint32_t k_polar = 6, k_azimuths = 48, k_directions = k_polar * k_azimuths;
    std::vector<Rgb>
        cells;  ///< f_r [1/sr], φ_v fastest, then θ_v, φ_l, θ_l, before negative channels are clamped; NaN: not measured
    std::uint64_t masked = 0;  ///< cells without a measurement
};

class SampleIndex;

/// Samples at pairs of directions that form no table: what a fit takes as they are. Between them `value` interpolates: with
///   x = (log(1 + 20 θ_h) / log(1 + 10 π) π/2, θ_l, θ_v),  θ_h of the half-way vector,
/// and the K = 8 samples nearest to it in x, d_k away, R the distance of the ninth (Shepard 1968, Franke & Little's weights),
///   f_r cosθl cosθv = Σ_k w_k f_k cosθl_k cosθv_k / Σ_k w_k,  w_k = ((R − d_k) / (R d_k))²:
/// at a sample its own value (the mean of those at one x), never beyond the range of f cosθl cosθv that was measured, and continuous but
/// where distances tie. Isotropic samples at azimuths Δφ and −Δφ thus count as the same. Where directions are not isotropic, θ_l and θ_v
/// stand for the plane vectors (θ cosφ, θ sinφ). The measured gaps are wide: leaving one sample out, the squared error ratio on Cornell's
/// paints is 0.05 to 0.3, of the cube root 0.01.
struct Scattered {
    std::string description;
    bool isotropic = true;           ///< f_r depends on the difference of the azimuths alone
    std::vector<float> wavelengths;  ///< [nm], increasing, of a spectral measurement; else empty
    std::vector<Vec3f> wl, wv;       ///< unit vectors, above the horizon
    std::vector<Rgb> colour;         ///< f_r [1/sr] of each sample, before negative channels are clamped
    std::vector<float> spectrum;     ///< f_r [1/sr], samples × wavelengths
    std::uint64_t masked = 0;        ///< samples of the file that are left out: not finite, or below the horizon
    std::shared_ptr<const SampleIndex> index;  ///< for `value`; `make_index` makes it of wl, wv and colour
};

/// Makes what `value` looks samples up in; needed again after samples were changed.
void make_index(Scattered& samples);

/// Any measurement.
struct Measured {
    std::string source;       ///< the file it came from
    std::string format;       ///< "MERL", "RGL", "UTIA", "Cornell", "ASTM E1392", "ALTA" or "CSV"
    std::uint64_t bytes = 0;  ///< size of the file
    std::variant<MerlTable, RglTable, UtiaTable, Scattered> table;
};
/// Whether f_r depends on the difference of the azimuths alone.
bool is_isotropic(const Measured& measured);

/// f_r by trilinear interpolation over the valid ones of the eight surrounding nodes; NaN where none is
/// valid.
Rgb value(const MerlTable& table, Vec3f wl, Vec3f wv);
/// f_r at the nearest node.
Rgb nearest(const MerlTable& table, Vec3f wl, Vec3f wv);
/// f_r, negative values clamped to 0.
Rgb value(const RglTable& table, Vec3f wl, Vec3f wv);
/// f_r, linear in all four angles between the nodes, as the database's own code looks it up; between 75 and 90° it goes on as
/// between 60 and 75°. Negative values clamped to 0; NaN where one of the nodes was not measured.
Rgb value(const UtiaTable& table, Vec3f wl, Vec3f wv);
/// f_r by interpolation, negative values clamped to 0.
Rgb value(const Scattered& samples, Vec3f wl, Vec3f wv);
Rgb value(const Measured& measured, Vec3f wl, Vec3f wv);

/// f_r before negative channels are clamped: below 0 where a saturated colour leaves the gamut.
Rgb signed_value(const MerlTable& table, Vec3f wl, Vec3f wv);
Rgb signed_value(const RglTable& table, Vec3f wl, Vec3f wv);
Rgb signed_value(const UtiaTable& table, Vec3f wl, Vec3f wv);
Rgb signed_value(const Scattered& samples, Vec3f wl, Vec3f wv);
Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv);
/// f[i] = signed_value(table, wl[i], wv[i]) for spans of one length; isotropic tables in SIMD as wide as the machine has it, within
/// 1e-4 relative or 1e-5 of the table's largest colour over cosθv.
void evaluate_signed(const RglTable& table, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// signed_value on arrays of pairs: what a fit observes. It refers to `measured`.
Evaluate signed_evaluator(const Measured& measured);
Evaluate signed_evaluator(const Measured&&) = delete;
/// `value` likewise.
Evaluate evaluator(const Measured& measured);

/// The wavelengths [nm] of a spectral measurement; else empty.
std::span<const float> wavelengths(const Measured& measured);
/// f[c] = f_r at wavelength c of a spectral measurement, looked up as its colours are: their colour is `signed_value`.
void signed_spectrum(const RglTable& table, Vec3f wl, Vec3f wv, std::span<float> f);
void signed_spectrum(const Scattered& samples, Vec3f wl, Vec3f wv, std::span<float> f);
/// The same on arrays of pairs. It refers to `measured`.
Channels signed_spectra(const Measured& measured);
Channels signed_spectra(const Measured&&) = delete;
/// The same, negative values clamped to 0.
Channels spectra(const Measured& measured);
Channels spectra(const Measured&&) = delete;

/// Reads the bytes of a MERL `.binary`: int32 dimensions, then three planes (R, G, B) of n_h n_d n_p doubles;
/// a channel is scaled by 1/1500, 1.15/1500, 1.66/1500. Negative or not finite: not measured. `source` is for
/// errors alone.
Result<MerlTable> read_merl(std::span<const std::byte> bytes, const std::string& source);
/// Reads the bytes of an RGL `.bsdf` tensor file, RGB or spectral, isotropic or anisotropic. The field `valid`, which tells
/// measured nodes from extrapolated ones, is left aside, as the authors' own loader does.
Result<RglTable> read_rgl(std::span<const std::byte> bytes, const std::string& source);

/// Reads the bytes of a UTIA `.bin`: three planes (R, G, B) of doubles, 288 lights × 288 viewers. Not finite: not measured.
Result<UtiaTable> read_utia(std::span<const std::byte> bytes, const std::string& source);
/// Reads a `.brdf` of Cornell's Program of Computer Graphics: the number of wavelengths, the wavelengths [nm], then for each sample
/// θ_i φ_i θ_s φ_s [rad] of the light and the viewer and the spectrum of f_r; '#' opens a comment.
Result<Scattered> read_cornell(std::span<const std::byte> bytes, const std::string& source);
/// Reads an ASTM E1392 file (`.astm`): lines of a key and its text, VARS last, which names the columns of the rows that follow:
/// theta_i, phi_i, theta_s, phi_s [rad] and the values: R, G, B, X, Y, Z or one of any name.
Result<Scattered> read_astm(std::span<const std::byte> bytes, const std::string& source);
/// Reads ALTA's text format: `#DIM nX nY`, `#PARAM_IN` with one of sixteen parameterizations (docs/formats.md),
/// `#PARAM_OUT`, `#VS` (error bars, which are left aside), then rows of nX + nY numbers.
Result<Scattered> read_alta(std::span<const std::byte> bytes, const std::string& source);
/// Reads CSV whose first line names its columns: directions as wl_x, wl_y, wl_z, wv_x, wv_y, wv_z, or as theta_l, phi_l, theta_v, phi_v
/// with the unit stated: names that end in _deg or _rad. Values [1/sr]: r, g, b, or x, y, z, or one column `value`, or a spectrum in
/// columns named by wavelength (450nm or nm450). Lines that begin with '#' are comments; one that reads `# isotropic` states that.
Result<Scattered> read_csv(std::span<const std::byte> bytes, const std::string& source);

/// Reads a measurement of any known format, told by its content. Errors: those of the formats; `wrong_kind`: a fitted model.
Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& source);
/// The same of bytes that are let go before samples are indexed.
Result<Measured> read_measured(std::vector<std::byte>&& bytes, const std::string& source);
Result<Measured> load_measured(const std::string& path);

}  // namespace srbf
