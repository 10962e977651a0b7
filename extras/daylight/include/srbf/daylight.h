// Daylighting tables: matrices of patches and tensor trees, the formats of WINDOW and Radiance.
#pragma once
#include "srbf/fit.h"
#include "srbf/measured.h"

SRBF_BEGIN

/// A division of the hemisphere into patches, after Klems ("A new method for predicting the solar heat gain of
/// complex fenestration systems", 1994). Rings of polar angles are divided into patches of equal width; the first
/// patch of a ring is centred at azimuth 0.
struct AngleBasis {
    struct Ring {
        float theta = 0;             ///< the ring's nominal polar angle in the file [rad]
        float from = 0, to = 0;      ///< bounds of the polar angle [rad]
        std::uint32_t azimuths = 1;  ///< number of patches
        friend bool operator==(const Ring&, const Ring&) = default;
    };
    std::string name;
    std::vector<Ring> rings;  ///< rings in order, from 0 to π/2

    std::size_t patches() const;
    /// The index of the first patch of a ring. `rings.size()` gives the number of patches.
    std::size_t first_of(std::size_t ring) const;
    std::size_t ring_of(std::size_t patch) const;
    /// The patch that contains a direction above the horizon.
    std::size_t patch_of(Vec3f w) const;
    /// The middle of a patch in azimuth [rad].
    double azimuth_of(std::size_t patch) const;
    /// The direction at the azimuth of a patch and the θ of its ring.
    Vec3d middle_of(std::size_t patch) const;
    /// ∫ cosθ dω over a patch of the ring [sr].
    double projected_solid_angle(std::size_t ring) const;
    /// A point of a patch for (s, t) in [0, 1]². Uniform (s, t) give points uniform in projected solid angle.
    Vec3d point_of(std::size_t patch, double s, double t) const;
};

/// WINDOW's bases, with 145, 77 and 41 patches.
enum class KlemsBasis { full, half, quarter };
AngleBasis klems_basis(KlemsBasis basis);

/// A matrix of patches: one part of a BSDF in the XML of WINDOW and Radiance, in the frame of that part (brdf.h).
/// Cell (o, i) is the mean of f over the outgoing patch o and the incident patch i, weighted by both cosines. A
/// point (x, y, z) of an incident patch corresponds to light from (x, −y, z). A point (x, y, z) of an outgoing
/// patch corresponds to the view direction (−x, y, z). So the mirror direction lies in the same patch. Look-up is
/// constant over patches.
struct KlemsTable {
    static constexpr std::string_view k_name = "KlemsTable";
    AngleBasis incident, outgoing;
    std::vector<Rgb> cells;    ///< f [1/sr] without the beam, outgoing × incident
    std::vector<Rgb> beam;     ///< each incident patch's fraction of light in a peak within one patch; or empty
    std::uint64_t masked = 0;  ///< cells without a measurement, which are NaN; files have none
    Rgb cell(std::size_t o, std::size_t i) const { return cells[o * incident.patches() + i]; }
    /// The outgoing patch that contains the mirror direction, or the direction straight through, of an incident
    /// patch.
    std::size_t straight_ahead(std::size_t i) const;
};

/// A function on the unit cube of 3 or 4 dimensions that is constant on each leaf, as in Radiance's tensor trees. A
/// branch halves its cube along each coordinate: child n is the upper half along coordinate i if bit i of n is set.
/// A grid divides its cube into (2^level)^rank leaves; coordinate 0 varies slowest.
struct TensorTree {
    int rank = 3;
    /// A node has its level, or k_branch, in its upper 5 bits, and the index of its first child or leaf in the
    /// others.
    std::uint32_t root = 0;
    std::vector<std::uint32_t> nodes;
    std::vector<float> leaves;

    static constexpr std::uint32_t k_branch = 31, k_max_leaves = (1u << 27) - 1;
    static constexpr std::uint32_t branch(std::uint32_t first) { return k_branch << 27 | first; }
    static constexpr std::uint32_t grid(int level, std::uint32_t first) { return std::uint32_t(level) << 27 | first; }
    static constexpr std::uint32_t level_of(std::uint32_t node) { return node >> 27; }
    static constexpr std::uint32_t first_of(std::uint32_t node) { return node & k_max_leaves; }
    /// The value of the leaf at x in [0, 1)^rank. Points outside are clamped to the cube.
    float at(std::array<double, 4> x) const;
    /// The width of the smallest leaf.
    float smallest_leaf() const;
};

/// Tensor trees: one part of a BSDF in Radiance's XML, in the frame of that part (brdf.h). Let p = (wl.x, −wl.y), q
/// = (−wv.x, wv.y), and let `square` be the area-preserving map of Shirley and Chiu from the unit disc to the unit
/// square, in which area × π is the projected solid angle:
///   rank 4: x = (square(p), square(q));   rank 3, isotropic: x = ((1 − |p|)/2, square(q rotated so that p lies on
///   +x)).
/// f [1/sr] is the leaf of `y` at x. Its colour has the chromaticity CIE 1976 u′, v′; (4/19, 9/19), equal energy,
/// is white.
struct TreeTable {
    static constexpr std::string_view k_name = "TreeTable";
    TensorTree y;
    std::vector<TensorTree> chromaticity;  ///< u′ and v′; empty: grey
};

/// f of the pair of patches [1/sr]; NaN if the cell is NaN.
Rgb signed_value(const KlemsTable& table, Vec3f wl, Vec3f wv);
/// f of the leaf [1/sr]. Never NaN.
Rgb signed_value(const TreeTable& table, Vec3f wl, Vec3f wv);
/// True if f depends only on the difference of azimuths, compared where centres of patches have the same
/// difference, within 1 % of the root mean square.
bool is_isotropic(const KlemsTable& table);
bool is_isotropic(const TreeTable& table);
/// The table as a part of a measurement (measured.h); `table_as` returns the original. Matrices are fitted by
/// `fit_patches`.
EvaluatedTable as_evaluated_table(KlemsTable table);
EvaluatedTable as_evaluated_table(TreeTable table);

/// Reads BSDF data in the XML of LBNL's WINDOW and of Radiance: matrices of patches in Klems' bases or in bases
/// that the file defines, or Radiance's tensor trees. They describe reflection and transmission at front and back,
/// in bands of wavelengths; the band "Visible" is chosen if it exists. WINDOW's front is +z. A peak within one
/// patch around the mirror direction, of which the neighbouring patches have less than a tenth, becomes a `Beam`.
/// Returns an error if the XML is not well-formed or has a document type, which can define entities, if the size of a
/// matrix does not match its bases, if a tree has the wrong shape, or if a number is not finite.
Result<BsdfTable> read_bsdf_xml(std::span<const std::byte> bytes, const std::string& file_name);
inline constexpr std::size_t k_largest_xml = std::size_t(1) << 28;

/// Averages a part of a BSDF, in its own frame, over pairs of patches of `basis`, weighted by both cosines. A pair
/// has 256 points, or 4096 around the mirror direction. Values that were not measured are left out of a mean.
KlemsTable to_klems(const Evaluate& part, const AngleBasis& basis, int threads = 0);
/// Sets the beam of each incident patch to the fraction of the part's beam at the patch's middle.
void add_beam(KlemsTable& table, const Beams& beams, Part part);

/// The XML for WINDOW and Radiance of a BSDF whose parts are all matrices of patches. Beams are added back to the
/// patch of the mirror direction. Numbers are luminances with six digits, so that write(read(written)) is
/// `written`.
std::string write_bsdf_xml(const BsdfTable& table);

/// The averages that a fit to a matrix of patches compares: means over pairs of patches, computed as sums over
/// points.
struct PatchSums {
    std::vector<Rgb> mean;       ///< mean f of each class of pairs [1/sr]
    std::vector<double> weight;  ///< products of projected solid angles [sr²], of each class
    std::size_t points = 0;      ///< number of points in each class
    std::vector<Vec3f> wl, wv;   ///< classes × points
    /// The means of `f` over the points of each class.
    std::vector<Rgb> averages(const Evaluate& f) const;
    /// The weighted squared error ratio of these means, over all channels.
    double error_ratio(const Evaluate& f) const;
};
/// Points in each pair of patches for errors.
inline constexpr std::size_t k_measured_points = 64;
/// The means of a matrix, with `points` points in each pair, uniform in projected solid angle.
PatchSums sums_of(const KlemsTable& table, std::size_t points);

/// Fits a part to averages over patches. It minimises the squared errors of these averages, weighted by projected
/// solid angles, with expectation-maximisation: it fits values at points within the patches, then replaces them by
/// the fitted values plus the error of their average, and repeats. Directional-hemispherical sums count as
/// radiances. If no number of lobes is requested, it takes the smallest size that is within 0.1 % of the data's Σ
/// f², and within 1 % or 0.001 of every directional-hemispherical sum.
Result<FitOutcome> fit_patches(const KlemsTable& table, const FitRequest& request, const ProgressToken& progress = {});

/// The directional-hemispherical sums of a matrix for each incident ring, or for each incident patch if it is
/// anisotropic, and the sums of `f` and the part's beam for light from the middles of these patches.
std::vector<Hemispherical> hemispherical(const KlemsTable& table, const Evaluate& f, const Beams& beams, Part part);

SRBF_END
