// Measured BRDFs in the form of their files.
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

SRBF_BEGIN

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
    int symmetry = 1;  ///< measured azimuths: 1 all, 2 half (others by rotation by π), 4 a quarter (others by mirrors)
    bool jacobian = true;
    std::vector<float> theta_l;  ///< [rad], increasing; a slice for each
    Profile ndf;                 ///< microfacet distribution
    Profile sigma;               ///< projected area
    VisibleNormals visible;      ///< slices: φ_l × θ_l
    Colours colour;              ///< slices: φ_l × θ_l
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
    std::vector<Entry> metadata;  ///< the header's lines, in the order of the file
};

class SampleIndex;

/// Samples at pairs of directions without a grid. A fit uses the samples themselves. `value` interpolates between them:
/// with
///   x = (log(1 + 20 θ_h) / log(1 + 10 π) π/2, θ_l, θ_v),  θ_h of the half vector,
/// and the K = 8 samples nearest to it in x, at distances d_k, and the distance R of the ninth (Shepard 1968, with the
/// weights of Franke & Little),
///   f_r = ⟨f A⟩ ((1 − t)/A + t/⟨A⟩),  ⟨g⟩ = Σ_k w_k g_k / Σ_k w_k,  w_k = ((R − d_k) / (R d_k))²,  A = cosθl cosθv.
/// t in [0, 1] is 1 for a constant f and 0 for a constant f A, by the slope of f A over A among the K. At a sample this
/// is its own value (the mean at the same x). It does not leave the ranges of both f and f A, and is continuous except
/// where distances tie. Isotropic samples at azimuths Δφ and −Δφ count as the same. For anisotropic ones (θ cosφ,
/// θ sinφ) replace θ_l and θ_v. Interpolation is inaccurate in wide gaps (docs/formats.md has figures).
struct ScatteredSamples {
    std::string description;
    bool isotropic = true;           ///< f_r depends only on the difference of the azimuths
    std::vector<float> wavelengths;  ///< [nm], increasing, of a spectral measurement; else empty
    std::vector<Vec3f> wl, wv;       ///< unit vectors, above the horizon
    std::vector<Rgb> colour;         ///< f_r [1/sr] of each sample, negative channels not yet clamped
    std::vector<float> spectrum;     ///< f_r [1/sr], samples × wavelengths
    std::vector<float> weight;       ///< weight of each in a fit, by its uncertainty; empty: 1
    std::uint64_t masked = 0;  ///< samples of the file that were dropped: not finite, below the horizon, or −999
    /// search structure for `value`; `make_index` builds it from wl, wv and colour
    std::shared_ptr<const SampleIndex> index;
    std::vector<std::string> notes;  ///< a line for each thing that the reader masked or assumed
    /// solid angle [sr] of the detector's aperture, at a wavelength [nm]; empty: not stated
    std::vector<std::array<float, 2>> receiver;
};

/// Builds the search structure of `value`. Call it again after any change of the samples.
void make_index(ScatteredSamples& samples);

struct TableFunctions;
/// A table of a type that only its format knows: its values, and functions of the format.
struct EvaluatedTable {
    /// f_r [1/sr] as `signed_value` returns it: 0 below the horizon, NaN in every channel where nothing was measured
    Evaluate values;
    bool isotropic = true;
    std::shared_ptr<const void> table = {};  ///< the format's own table, a T, see `table_as`
    std::string_view table_name = {};        ///< T::k_name
    std::shared_ptr<const TableFunctions> functions = {};
};

struct Measured;

/// A two-sided measurement, in bands of wavelengths. Each part is a measurement of its own, in its frame.
struct BsdfTable {
    struct Band {
        std::string name;  ///< "Visible", "Solar"; empty: colours
        Parts<Measured> part;
        Beams beam;
    };
    std::vector<Band> bands;  ///< one band or more
    std::size_t chosen = 0;   ///< index of the band that all functions look up
    std::string description;
    const Band& band() const { return bands[chosen]; }
};

/// Any measurement.
struct Measured {
    std::string source;       ///< the file name
    std::string format;       ///< the name of one of `formats()` (measured/formats.h), unless its reader gives another
    std::uint64_t bytes = 0;  ///< size of the file
    std::variant<MerlTable, RglTable, MbsdfTable, ScatteredSamples, EvaluatedTable, BsdfTable> table;
    bool is_exchanged = false;  ///< all functions of a `Measured` look up the table at (wv, wl)
};
/// Exchanges light and viewer: f_r(wl, wv) of the result is f_r(wv, wl) of the argument.
void exchange(Measured& measured);
/// The format's own table of a measurement, if it is a `T`; otherwise null.
template <typename T> const T* table_as(const Measured& measured) {
    const auto* evaluated = std::get_if<EvaluatedTable>(&measured.table);
    return evaluated && evaluated->table_name == T::k_name ? static_cast<const T*>(evaluated->table.get()) : nullptr;
}
/// True if f_r depends only on the difference of the azimuths.
bool is_isotropic(const Measured& measured);
/// A line for each thing that the reader masked or assumed beyond the format.
std::vector<std::string> notes(const Measured& measured);

/// f [1/sr] by a look-up in the measurement, with light and viewer exchanged if `is_exchanged`. The directions must be
/// unit vectors, which is not checked.
/// A BRDF is 0 if wl.z ≤ 0 or wv.z ≤ 0; a BSDF has the values of its chosen band on either side. Every channel is NaN
/// where nothing was measured, and otherwise finite. A channel is negative where a saturated colour lies outside of the
/// gamut.
/// Tables are interpolated linearly. MERL's tables use the measured ones of eight nodes. UTIA's (extrapolated beyond
/// 75°) and MBSDF's have no value if one of the nodes was not measured. Along the normal, where tables other than
/// MERL's need an azimuth that the pair lacks, it is the mean over azimuths.
Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv);

/// `signed_value` of a table or a measurement, with negative channels set to 0.
template <typename Table>
requires requires(const Table& table, Vec3f w) { signed_value(table, w, w); }
Rgb value(const Table& table, Vec3f wl, Vec3f wv) { return non_negative(signed_value(table, wl, wv)); }

/// `signed_value` as an `Evaluate`, the input of a fit. It keeps a reference to `measured`.
Evaluate signed_evaluator(const Measured& measured);
Evaluate signed_evaluator(const Measured&&) = delete;
/// `value` as an `Evaluate`. It keeps a reference to `measured`.
Evaluate evaluator(const Measured& measured);

/// The wavelengths [nm] of a spectral measurement; otherwise empty.
std::span<const float> wavelengths(const Measured& measured);
/// f_r at these wavelengths, with the look-up of the colours and negative values clamped to 0. It keeps a reference to
/// `measured`.
Channels spectra(const Measured& measured);
Channels spectra(const Measured&&) = delete;

/// Chooses the band with that name, whatever the case of its letters. Returns an error if there is no such band.
Result<Done> choose_band(Measured& measured, std::string_view name);

/// The quantity of the values of samples.
enum class Quantity {
    stated,  ///< the quantity that the file states, or else f
    bsdf,    ///< f [1/sr]
    factor,  ///< the reflectance factor, π f
    cosine,  ///< corrected by the cosine, f cosθ_v [1/sr]
};

/// Statements about a file of samples that the file itself lacks.
struct ReadOptions {
    /// Names of the columns of a file of numbers, as a CSV file has them, separated by blanks or commas. They replace
    /// the names in the file. An entry may also be a constant, such as phi_l_deg=180. If the text is empty or has
    /// constants alone, the file names its columns.
    std::string columns;
    Quantity quantity = Quantity::stated;
    /// Samples whose values are no more than this in any channel are masked: bounds, not measurements.
    float floor = 0;
    bool any() const { return !columns.empty() || quantity != Quantity::stated || floor > 0; }
};

/// Reads a measurement of any known format, recognised by its content. Returns an error if the format's reader does or
/// if `options` are for samples and the file has none; the code is `wrong_kind` for a fitted model.
Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& file_name,
                               const ReadOptions& options = {});
Result<Measured> load_measured(const std::string& path, const ReadOptions& options = {});

SRBF_END
