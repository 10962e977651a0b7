// Measured BRDFs, as their files hold them: level 3.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
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

/// An isotropic RGB measurement in the adaptive parameterization of Dupuy & Jakob, "An adaptive
/// parameterization for efficient material acquisition and rendering" (2018). A polar angle θ is stored as
/// u(θ) = √(2θ/π), an azimuth φ as (φ + π)/2π; with h = ωl + ωv, θ_h its polar angle and φ its azimuth from
/// that of ωl,
///   f_r cosθ_v = colour(w) ndf(u(θ_h)) / (4 sigma(u(θ_l))) [1/sr],  w = warp⁻¹(u(θ_h), (φ + π)/2π),
/// where the warp takes the unit square to itself with the density of `visible`. `colour` and `visible` are
/// linear in θ_l between their slices.
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
    std::string description;
    std::vector<float> theta_l;  ///< [rad], increasing, a slice for each
    std::vector<float> ndf;      ///< microfacet distribution, linear between nodes u = i/(n−1)
    std::vector<float> sigma;    ///< projected area, likewise
    VisibleNormals visible;
    Colours colour;
};

/// Any measurement.
struct Measured {
    std::string source;       ///< the file it came from
    std::string format;       ///< "MERL" or "RGL"
    std::uint64_t bytes = 0;  ///< size of the file
    std::variant<MerlTable, RglTable> table;
};

/// f_r by trilinear interpolation over the valid ones of the eight surrounding nodes; NaN where none is
/// valid.
Rgb value(const MerlTable& table, Vec3f wl, Vec3f wv);
/// f_r at the nearest node.
Rgb nearest(const MerlTable& table, Vec3f wl, Vec3f wv);
/// f_r, negative values clamped to 0.
Rgb value(const RglTable& table, Vec3f wl, Vec3f wv);
Rgb value(const Measured& measured, Vec3f wl, Vec3f wv);

/// f_r before negative channels are clamped: below 0 where a saturated colour leaves the gamut.
Rgb signed_value(const MerlTable& table, Vec3f wl, Vec3f wv);
Rgb signed_value(const RglTable& table, Vec3f wl, Vec3f wv);
Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv);
/// The same on arrays of pairs: what a fit observes. It refers to `measured`.
Evaluate signed_evaluator(const Measured& measured);

/// Reads the bytes of a MERL `.binary`: int32 dimensions, then three planes (R, G, B) of n_h n_d n_p doubles;
/// a channel is scaled by 1/1500, 1.15/1500, 1.66/1500. Negative or not finite: not measured. `source` is for
/// errors alone.
Result<MerlTable> read_merl(std::span<const std::byte> bytes, const std::string& source);
/// Reads the bytes of an RGL `.bsdf` tensor file, RGB and isotropic. The field `valid`, which tells measured
/// nodes from extrapolated ones, is left aside, as the authors' own loader does.
Result<RglTable> read_rgl(std::span<const std::byte> bytes, const std::string& source);

/// Reads a measurement of any known format, told by its content.
Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& source);
Result<Measured> load_measured(const std::string& path);

}  // namespace srbf
