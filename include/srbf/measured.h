// Measured BRDFs in the form of their files.
#pragma once
#include <any>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/bsdf.h"
#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

/// A table with the layout of MERL ("A data-driven reflectance model", Matusik et al. 2003): isotropic, in Rusinkiewicz
/// coordinates. Node (h, d, p) lies at θ_h = (h/n_h)² π/2, θ_d = d/n_d π/2, φ_d = p/n_p π. φ_d is periodic in π.
struct MerlTable {
    std::array<std::uint32_t, 3> size{};  ///< n_h, n_d, n_p: 90, 90, 180 in the database
    std::vector<Rgb> cells;               ///< f_r [1/sr]; p varies fastest, then d, then h. NaN: not measured
    std::uint64_t masked = 0;             ///< cells without a measurement
};

/// A measurement in the adaptive parameterization of Dupuy & Jakob, "An adaptive parameterization for efficient
/// material acquisition and rendering" (2018). A polar angle θ is stored as u(θ) = √(2θ/π), an azimuth φ as (φ + π)/2π.
/// With h = ωl + ωv, θ_h its polar angle and φ its azimuth relative to ωl,
///   f_r cosθ_v = colour(w) ndf(u(θ_h)) / (4 sigma(u(θ_l))) [1/sr],  w = warp⁻¹(u(θ_h), (φ + π)/2π),
/// where the warp maps the unit square to itself with the density of `visible`. `colour` and `visible` are linear in
/// θ_l between their slices. An anisotropic measurement also has slices for azimuths φ_l of the light. Its azimuth of h
/// is relative to +x, and its ndf and sigma depend on azimuth too. Without `jacobian` the colour is f_r cosθ_v itself.
struct RglTable {
    /// The density of visible normals on the unit square, x along θ_h, y along φ, bilinear between nodes at
    /// i/(width−1), j/(height−1). It is stored with the running integrals that the warp needs. The unit of length is a
    /// cell; a slice has (width−1)(height−1) cells. In the unit square the density integrates to 1.
    struct VisibleNormals {
        struct Node {
            float density;
            float left;  ///< ∫ of the density along the row, from x = 0 to the node
        };
        struct Row {
            float whole;  ///< ∫ of the density along the whole row
            float below;  ///< ∫ of `whole` from y = 0 to the row
        };
        std::uint32_t width = 0, height = 0;
        std::vector<Node> nodes;  ///< slices × height × width
        std::vector<Row> rows;    ///< slices × height
    };
    /// The measured colours on the unit square, bilinear between nodes at i/(width−1), j/(height−1). A channel is
    /// negative where a colour lies outside of the gamut.
    struct Colours {
        std::uint32_t width = 0, height = 0;
        std::vector<Rgb> nodes;  ///< slices × height × width
    };
    /// A function of direction, bilinear between nodes u(θ) = i/(width−1) and azimuths j/(height−1). An isotropic one
    /// has a single row.
    struct Profile {
        std::uint32_t width = 0, height = 0;
        std::vector<float> nodes;
    };
    std::string description;
    std::vector<float> wavelengths;  ///< [nm], of a spectral file; the colours follow from its spectra. Otherwise empty
    /// of a spectral file, in the file's layout: slices × wavelengths × height × width of `colour`
    std::vector<float> spectra;
    std::vector<float> phi_l;  ///< [rad], increasing; there are slices for each. Empty: isotropic
    /// Symmetry of the measured azimuths: 1 (full circle), 2 (the other half is rotated by π), 4 (mirrored at both
    /// axes).
    int symmetry = 1;
    bool jacobian = true;
    std::vector<float> theta_l;  ///< [rad], increasing; a slice for each
    Profile ndf;                 ///< microfacet distribution
    Profile sigma;               ///< projected area
    VisibleNormals visible;      ///< slices: φ_l × θ_l
    Colours colour;              ///< slices: φ_l × θ_l
};

/// A table with the layout of UTIA (Filip & Vávra, "Template-based sampling of anisotropic BRDFs", 2014): θ_l and θ_v
/// at 0, 15, .. 75°, φ_l and φ_v at 0, 7.5, .. 352.5°.
struct UtiaTable {
    static constexpr std::uint32_t k_polar = 6, k_azimuths = 48, k_directions = k_polar * k_azimuths;
    std::vector<Rgb>
        /// f_r [1/sr]; φ_v varies fastest, then θ_v, φ_l, θ_l; negative channels not yet clamped. NaN: not measured
        cells;
    std::uint64_t masked = 0;  ///< cells without a measurement
};

/// A table of the reflection in an MBSDF file ("NVIDIA Material Definition Language", appendix "MBSDF file format"):
/// isotropic. Sample (i, j, k) is f_r at θ_l = i/n_θ π/2, θ_v = j/n_θ π/2 and |φ_l − φ_v| = k/(n_φ − 1) π. Look-up is
/// linear in these three; beyond the last θ it is constant.
struct MbsdfTable {
    /// A line key="value" of the header. A key is not empty and has neither '=' nor control characters.
    struct Entry {
        std::string key, value;
        friend bool operator==(const Entry&, const Entry&) = default;
    };
    std::uint32_t polar = 0;     ///< n_θ
    std::uint32_t azimuths = 0;  ///< n_φ
    bool grey = false;           ///< one number a sample in the file: the channels are equal
    std::vector<Rgb> cells;    ///< f_r [1/sr]; k varies fastest, then j; negative channels not yet clamped. NaN: masked
    std::uint64_t masked = 0;  ///< samples that are not finite
    std::vector<Entry> metadata;    ///< in the order of the file
    bool has_transmission = false;  ///< the file also has a block of transmission (`read_mbsdf_of_both_sides`)
};

class SampleIndex;

/// Samples at pairs of directions without a grid. A fit uses the samples themselves. `value` interpolates between them:
/// with
///   x = (log(1 + 20 θ_h) / log(1 + 10 π) π/2, θ_l, θ_v),  θ_h of the half vector,
/// and the K = 8 samples nearest to it in x, at distances d_k, and the distance R of the ninth (Shepard 1968, with the
/// weights of Franke & Little),
///   f_r cosθl cosθv = Σ_k w_k f_k cosθl_k cosθv_k / Σ_k w_k,  w_k = ((R − d_k) / (R d_k))²:
/// At a sample this is the sample's own value (the mean of samples at the same x). It never leaves the range of the
/// measured f cosθl cosθv, and is continuous except where distances tie. Isotropic samples at azimuths Δφ and −Δφ count
/// as the same. For anisotropic samples the plane vectors (θ cosφ, θ sinφ) replace θ_l and θ_v. Interpolation is
/// inaccurate in wide gaps: leaving one sample out, the squared error ratio on Cornell's paints is 0.05 to 0.3, and
/// 0.01 for the cube root.
struct ScatteredSamples {
    std::string description;
    bool isotropic = true;           ///< f_r depends only on the difference of the azimuths
    std::vector<float> wavelengths;  ///< [nm], increasing, of a spectral measurement; else empty
    std::vector<Vec3f> wl, wv;       ///< unit vectors, above the horizon
    std::vector<Rgb> colour;         ///< f_r [1/sr] of each sample, negative channels not yet clamped
    std::vector<float> spectrum;     ///< f_r [1/sr], samples × wavelengths
    /// what each counts in a fit, by its uncertainty; empty: 1
    std::vector<float> weight;
    /// samples of the file that were dropped: not finite, below the horizon, or −999 and its like
    std::uint64_t masked = 0;
    /// search structure for `value`; `make_index` builds it from wl, wv and colour
    std::shared_ptr<const SampleIndex> index;
    /// what its reader masked or assumed beyond the format, a line each, for people
    std::vector<std::string> notes;
};

/// Builds the search structure of `value`. Call it again after any change of the samples.
void make_index(ScatteredSamples& samples);

/// A part of a BSDF without the light that its table keeps as a peak though it is not scattered.
struct SeparatedBeam {
    Evaluate rest;  ///< f with the peak cut off at the level about it
    Beam beam;      ///< the share that is cut off
};
/// A line of what `srbf info` says about a table: a text, or the ranges of colours, channel by channel.
struct TableLine {
    std::string name, text;
    std::span<const Rgb> colours = {};
};
struct OwnFit;  // fit_bsdf.h

/// A table whose layout the files of its format alone know: its values, and what else is asked of any table.
struct EvaluatedTable {
    /// f_r [1/sr] as `signed_value` has it: 0 below the horizon, NaN in every channel where nothing was measured
    Evaluate values;
    bool isotropic = true;
    std::function<std::vector<TableLine>()> lines;
    /// The part without its peaks of unscattered light, if it has any; null: it has none.
    std::function<std::optional<SeparatedBeam>()> separated_beam = {};
    std::shared_ptr<const OwnFit> own_fit = {};  ///< how a part of a BSDF is fitted; null: to its values
    std::any own = {};                           ///< a std::shared_ptr<const T> of the format's own table
    std::string_view format = {};                ///< the name of the format that has `unpack` for `packed`
    std::function<std::string()> packed = {};    ///< the table as bytes, for copies in other processes
};

struct Measured;

/// A two-sided measurement, in bands of wavelengths. Each part is a measurement of its own, in the frame of
/// the part.
struct BsdfTable {
    struct Band {
        std::string name;  ///< "Visible", "Solar"; empty: colours
        Parts<Measured> part;
        Beams beam;
    };
    std::vector<Band> bands;  ///< at least one
    std::size_t chosen = 0;   ///< the one that all functions look up
    std::string description;
    const Band& band() const { return bands[chosen]; }
};

/// Any measurement.
struct Measured {
    std::string source;       ///< the file name
    std::string format;       ///< the name of one of `formats()` (measured/formats.h), unless its reader gives another
    std::uint64_t bytes = 0;  ///< size of the file
    std::variant<MerlTable, RglTable, UtiaTable, MbsdfTable, ScatteredSamples, EvaluatedTable, BsdfTable> table;
    bool exchanged = false;  ///< all functions of a `Measured` look up the table at (wv, wl)
};
/// Exchanges light and viewer: f_r(wl, wv) of the result is f_r(wv, wl) of the argument.
void exchange(Measured& measured);
/// The format's own table of a measurement, if it is a `T`; otherwise null.
template <typename T> const T* own_table(const Measured& measured) {
    const auto* table = std::get_if<EvaluatedTable>(&measured.table);
    const auto* own = table ? std::any_cast<std::shared_ptr<const T>>(&table->own) : nullptr;
    return own ? own->get() : nullptr;
}
/// True if f_r depends only on the difference of the azimuths.
bool is_isotropic(const Measured& measured);
/// A line for each thing that the reader masked or assumed beyond the format.
std::vector<std::string> notes(const Measured& measured);
/// How far samples change with the azimuth, which isotropic ones do not: √(Σ |g_i − g_k|² / Σ |g_i|²) of g = f cosθl cosθv,
/// over pairs of samples that a turn about the normal by more than 15° takes to each other, as nearly as samples lie
/// (within 0.1°, or else 10°, of θl, θv and θh). 0 if there are none, up to 14 % (noise), and if smaller turns change them
/// by more than 0.4 of it: then they differ by noise, or by their distance.
double change_by_azimuth(const ScatteredSamples& samples);

// f_r [1/sr] of unit vectors, which is not checked: 0 if wl.z ≤ 0 or wv.z ≤ 0, and otherwise finite, or NaN in every channel
// where each function says so. Negative channels occur where a saturated colour lies outside of the gamut.
/// f_r by trilinear interpolation over the measured ones of the eight surrounding nodes, not negative; NaN if none was
/// measured.
Rgb signed_value(const MerlTable& table, Vec3f wl, Vec3f wv);
/// f_r at the nearest node.
Rgb nearest(const MerlTable& table, Vec3f wl, Vec3f wv);
/// f_r. Never NaN.
Rgb signed_value(const RglTable& table, Vec3f wl, Vec3f wv);
/// f_r, linear in all four angles between the nodes, like the look-up of the database's own code. Between 75 and 90° it
/// is extrapolated from 60 to 75°. NaN where one of the nodes was not measured.
Rgb signed_value(const UtiaTable& table, Vec3f wl, Vec3f wv);
/// f_r by linear interpolation; NaN where one of the samples is masked.
Rgb signed_value(const MbsdfTable& table, Vec3f wl, Vec3f wv);
/// f_r by interpolation. Never NaN: masked samples are left out.
Rgb signed_value(const ScatteredSamples& samples, Vec3f wl, Vec3f wv);
/// f_r of its function.
Rgb signed_value(const EvaluatedTable& table, Vec3f wl, Vec3f wv);
/// f of the chosen band on either side: `value` of the part, or of its counterpart if the part is missing; 0 without
/// both.
Rgb signed_value(const BsdfTable& table, Vec3f wl, Vec3f wv);
/// `signed_value` of the table, with light and viewer exchanged if `exchanged`.
Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv);

/// `signed_value` of a table or a measurement, with negative channels set to 0.
template <typename Table>
requires requires(const Table& table, Vec3f w) { signed_value(table, w, w); }
Rgb value(const Table& table, Vec3f wl, Vec3f wv) { return non_negative(signed_value(table, wl, wv)); }

/// f[i] = signed_value(table, wl[i], wv[i]). The spans have the same length. Isotropic tables use the widest SIMD
/// instructions of the machine, within 1e-4 relative or 1e-5 of the table's largest colour over cosθv.
void evaluate_signed(const RglTable& table, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `evaluate_signed` of a MERL table: the bits of `signed_value`.
void evaluate_signed(const MerlTable& table, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `signed_value` as an `Evaluate`, the input of a fit. It keeps a reference to `measured`.
Evaluate signed_evaluator(const Measured& measured);
Evaluate signed_evaluator(const Measured&&) = delete;
/// `value` as an `Evaluate`. It keeps a reference to `measured`.
Evaluate evaluator(const Measured& measured);

/// The wavelengths [nm] of a spectral measurement; otherwise empty.
std::span<const float> wavelengths(const Measured& measured);
/// f[c] = f_r at wavelength c of a spectral measurement, with the look-up of the colours: its colour is `signed_value`.
void signed_spectrum(const RglTable& table, Vec3f wl, Vec3f wv, std::span<float> f);
void signed_spectrum(const ScatteredSamples& samples, Vec3f wl, Vec3f wv, std::span<float> f);
/// `signed_spectrum` on arrays of pairs. It keeps a reference to `measured`.
Channels signed_spectra(const Measured& measured);
Channels signed_spectra(const Measured&&) = delete;
/// `signed_spectra`, with negative values clamped to 0.
Channels spectra(const Measured& measured);
Channels spectra(const Measured&&) = delete;

/// Reads the bytes of a MERL `.binary`: int32 dimensions, then three planes (R, G, B) of n_h n_d n_p doubles. The
/// channels are scaled by 1/1500, 1.15/1500, 1.66/1500. A negative or non-finite value means not measured. `file_name`
/// appears in errors only.
Result<MerlTable> read_merl(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads the bytes of an RGL `.bsdf` tensor file, RGB or spectral, isotropic or anisotropic. Ignores the field `valid`,
/// which distinguishes measured nodes from extrapolated ones, as the authors' own loader does.
Result<RglTable> read_rgl(std::span<const std::byte> bytes, const std::string& file_name);

/// Reads the bytes of a UTIA `.bin`: three planes (R, G, B) of doubles, 288 lights × 288 viewers. A non-finite value
/// means not measured.
Result<UtiaTable> read_utia(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads the bytes of an MBSDF file, version 1: lines key="value", then a block of reflection: type (grey or RGB), n_θ,
/// n_φ, and n_θ n_θ n_φ samples. A block of transmission may follow; its size is checked, and it is left out. A sample
/// that is not finite is masked.
Result<MbsdfTable> read_mbsdf(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads CSV (see `read_csv`) of two-sided samples, for each part its own.
Result<BsdfTable> read_csv_of_both_sides(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads both blocks of an MBSDF file as reflection and transmission of light from the front, whose frame is that of
/// the parts. Errors: those of `read_mbsdf`, or it has no block of transmission.
Result<BsdfTable> read_mbsdf_of_both_sides(std::span<const std::byte> bytes, const std::string& file_name);
/// Chooses the band with that name, whatever the case of its letters. Errors: it has no such band.
Result<Done> choose_band(Measured& measured, std::string_view name);

/// Reads a `.brdf` of Cornell's Program of Computer Graphics: the number of wavelengths, the wavelengths [nm], then for
/// each sample θ_i φ_i θ_s φ_s [rad] of the light and the viewer and the spectrum of f_r. '#' starts a comment.
Result<ScatteredSamples> read_cornell(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads an ASTM E1392 file (`.astm`): lines of a key and its text. The last key is VARS, which names the columns of
/// the following rows: theta_i, phi_i, theta_s, phi_s [rad] and the values, which are R, G, B, or X, Y, Z, or one
/// column of any name.
Result<ScatteredSamples> read_astm(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads ALTA's text format: `#DIM nX nY`, `#PARAM_IN` with one of sixteen parameterizations (docs/formats.md),
/// `#PARAM_OUT`, `#VS` (error bars, ignored), then rows of nX + nY numbers.
Result<ScatteredSamples> read_alta(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads rows of numbers below a line that names their columns. Directions: wl_x, wl_y, wl_z, wv_x, wv_y, wv_z, or theta_l,
/// phi_l, theta_v, phi_v with the unit as the suffix _deg or _rad. Values [1/sr]: r, g, b, or x, y, z, or one column `value`,
/// or a spectrum in columns named by wavelength (450nm or nm450). Lines that begin with '#' are comments; the comment
/// `# isotropic` declares the samples isotropic. docs/formats.md lists other names, separators, and what is assumed of
/// azimuths and units that are missing, which `notes` tells.
Result<ScatteredSamples> read_csv(std::span<const std::byte> bytes, const std::string& file_name);

/// The quantity of the values of samples.
enum class Quantity {
    stated,  ///< as the file states it, or else f
    bsdf,    ///< f [1/sr]
    factor,  ///< the reflectance factor, π f
    cosine,  ///< corrected by the cosine, f cosθ_v [1/sr]
};

/// The names of all but `stated`, in their order.
inline constexpr std::array<std::string_view, 3> k_quantities{"bsdf", "factor", "cosine"};
/// The quantity of that name; `stated` if none has it.
Quantity quantity_named(std::string_view name);

/// Statements about a file of samples that does not make them.
struct ReadOptions {
    /// Names of columns as in CSV, of rows of numbers, separated by blanks or commas, instead of those that the file has;
    /// and constants, as phi_l_deg=180. With constants alone, and if it is empty, the file has names.
    std::string columns;
    Quantity quantity = Quantity::stated;
    /// Samples whose values are no more than this in any channel are masked: bounds, not measurements.
    float floor = 0;
    bool any() const { return !columns.empty() || quantity != Quantity::stated || floor > 0; }
};

/// Reads a measurement of any known format, recognised by its content. Errors: those of the formats; `wrong_kind`: a
/// fitted model; samples that are stated by `options` and are none.
Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& file_name,
                               const ReadOptions& options = {});
/// `read_measured` that frees `bytes` before it indexes samples.
Result<Measured> read_measured(std::vector<std::byte>&& bytes, const std::string& file_name,
                               const ReadOptions& options = {});
Result<Measured> load_measured(const std::string& path, const ReadOptions& options = {});

/// The bytes of a file that may be a measurement or a model; of one that begins as neither does, its beginning alone.
/// Errors: those of `read_file`.
Result<std::vector<std::byte>> read_input(const std::string& path, const ReadOptions& options = {});

}  // namespace srbf
