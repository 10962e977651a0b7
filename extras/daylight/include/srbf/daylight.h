// Daylighting tables: matrices of patches and tensor trees, as WINDOW and Radiance have them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "srbf/fit_bsdf.h"
#include "srbf/measured.h"

namespace [[gnu::visibility("default")]] srbf {

/// A division of the hemisphere into patches, after Klems ("A new method for predicting the solar heat gain of complex
/// fenestration systems", 1994): rings of polar angles, and in a ring patches of one width, the first about azimuth 0.
struct AngleBasis {
    struct Ring {
        float theta = 0;             ///< [rad], by which the file names it
        float from = 0, to = 0;      ///< [rad]
        std::uint32_t azimuths = 1;  ///< number of patches
        friend bool operator==(const Ring&, const Ring&) = default;
    };
    std::string name;
    std::vector<Ring> rings;  ///< from 0 to π/2

    std::size_t patches() const;
    /// The first patch of a ring; `rings.size()`: the number of patches.
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
    /// A point of a patch, (s, t) in [0, 1]²: uniform in ∫ cosθ dω.
    Vec3d point_of(std::size_t patch, double s, double t) const;
};

/// The bases of WINDOW with 145, 77 and 41 patches.
enum class KlemsBasis { full, half, quarter };
AngleBasis klems_basis(KlemsBasis basis);

/// A matrix of patches: one part of a BSDF in WINDOW's and Radiance's XML, in the frame of that part (bsdf.h). Cell
/// (o, i) is the mean of f over the outgoing patch o and the incident patch i, both weighted by their cosines. In that
/// frame the light that belongs to point (x, y, z) of an incident patch comes from (x, −y, z), and point (x, y, z) of
/// an outgoing patch is the view direction (−x, y, z): the mirror direction has the same patch. Look-up is constant
/// over patches.
struct KlemsTable {
    AngleBasis incident, outgoing;
    std::vector<Rgb> cells;    ///< f [1/sr] without the beam, outgoing × incident
    std::vector<Rgb> beam;     ///< of each incident patch: the share that was a peak within one patch; or empty
    std::uint64_t masked = 0;  ///< cells without a measurement, NaN: none in files
    Rgb cell(std::size_t o, std::size_t i) const { return cells[o * incident.patches() + i]; }
    /// The outgoing patch of the mirror direction of an incident patch, or straight through.
    std::size_t straight_ahead(std::size_t i) const;
};

/// A function on the unit cube of 3 or 4 dimensions that is constant over leaves, as in Radiance's tensor trees. A branch
/// halves its cube along each coordinate: child n is the upper half along coordinate i if bit i of n is set. A grid divides
/// it into (2^level)^rank leaves, coordinate 0 slowest.
struct TensorTree {
    int rank = 3;
    /// A node is its level in the upper 5 bits, or k_branch, and in the others the first of its nodes or leaves.
    std::uint32_t root = 0;
    std::vector<std::uint32_t> nodes;
    std::vector<float> leaves;

    static constexpr std::uint32_t k_branch = 31, k_most_leaves = (1u << 27) - 1;
    static constexpr std::uint32_t branch(std::uint32_t first) { return k_branch << 27 | first; }
    static constexpr std::uint32_t grid(int level, std::uint32_t first) { return std::uint32_t(level) << 27 | first; }
    static constexpr std::uint32_t level_of(std::uint32_t node) { return node >> 27; }
    static constexpr std::uint32_t first_of(std::uint32_t node) { return node & k_most_leaves; }
    /// The leaf at x in [0, 1)^rank; what is outside counts as the border.
    float at(std::array<double, 4> x) const;
    /// The width of the smallest leaf.
    float smallest_leaf() const;
};

/// Tensor trees: one part of a BSDF in Radiance's XML, in the frame of that part (bsdf.h). With p = (wl.x, −wl.y), q =
/// (−wv.x, wv.y) and `square` the map of Shirley and Chiu from the unit disc to the unit square, which keeps areas, so that
/// area × π is the projected solid angle:
///   rank 4: x = (square(p), square(q));   rank 3, isotropic: x = ((1 − |p|)/2, square(q turned so that p lies on +x)).
/// f [1/sr] is the leaf of `y`. Its colour is that of CIE 1976 u′, v′, of which (4/19, 9/19), equal energy, is white.
struct TreeTable {
    TensorTree y;
    std::vector<TensorTree> chromaticity;  ///< u′ and v′; or empty: grey
};

/// f of the pair of patches; NaN where the table has it.
Rgb signed_value(const KlemsTable& table, Vec3f wl, Vec3f wv);
/// f of the leaf. Never NaN.
Rgb signed_value(const TreeTable& table, Vec3f wl, Vec3f wv);
/// True if f depends only on the difference of the azimuths, as far as the centres of patches have the same difference, up to
/// 1 % of the root mean square.
bool is_isotropic(const KlemsTable& table);
bool is_isotropic(const TreeTable& table);
/// A table as that of a part (measured.h); `own_table` gives it back. A matrix is fitted by `fit_patches`.
EvaluatedTable evaluated(KlemsTable table);
EvaluatedTable evaluated(TreeTable table);

/// Reads BSDF data in the XML of LBNL's WINDOW and of Radiance: matrices of patches in Klems' bases or in bases that
/// the file defines, or Radiance's tensor trees, for reflection and transmission at front and back, in bands of wavelengths
/// ("Visible" is chosen if there is one). WINDOW's front is +z. A peak of one patch about the mirror direction, of which the neighbouring
/// patches see less than a tenth, is a `Beam`. Errors: not well-formed XML; a document type (with which entities are
/// defined); a matrix of another size than its bases; a tree of the wrong shape; numbers that are not finite.
Result<BsdfTable> read_bsdf_xml(std::span<const std::byte> bytes, const std::string& file_name);
inline constexpr std::size_t k_largest_xml = std::size_t(1) << 28;

/// A part of a BSDF, in its own frame, as means over pairs of patches of `basis`, weighted by both cosines: of 256 points of a
/// pair, about the mirror direction 4096. What is not known is left out of a mean.
KlemsTable to_klems(const Evaluate& part, const AngleBasis& basis, int threads = 0);
/// Gives each incident patch the share of the part's beam at its middle.
void add_beam(KlemsTable& table, const Beams& beams, Part part);

/// The XML of WINDOW and Radiance of a BSDF whose parts are all matrices of patches, in their bands. A beam is put back into
/// the patch of its mirror direction. Numbers are luminances with six digits: write(read(written)) is `written`.
std::string write_bsdf_xml(const BsdfTable& table);

/// The sums that are fitted and measured of a matrix of patches: the mean of a function over pairs of them, as sums over points.
struct PatchSums {
    std::vector<Rgb> mean;       ///< of each class of pairs
    std::vector<double> weight;  ///< the product of their projected solid angles
    std::size_t points = 0;      ///< of each
    std::vector<Vec3f> wl, wv;   ///< classes × points
    /// The mean of `f` over the points of each.
    std::vector<Rgb> averages(const Evaluate& f) const;
    /// The weighted squared error ratio of these means, over all channels.
    double error_ratio(const Evaluate& f) const;
};
/// Points of each pair with which errors are measured.
inline constexpr std::size_t k_measured_points = 64;
/// `points` of each pair, uniform in the projected solid angles.
PatchSums sums_of(const KlemsTable& table, std::size_t points);

/// Fits a part to averages over patches. Squared errors of these averages, weighted by projected solid angles, are
/// minimised by expectation and maximisation: a fit to values at points within the patches, which are then replaced by
/// the fitted values plus the error of their average, and again. Directional-hemispherical sums count as radiances.
/// Without a number of lobes the smallest of some sizes is taken that is within 0.1 % of the data's Σ f² and within 1 %
/// or 0.001 of every directional-hemispherical sum.
Result<FitOutcome> fit_patches(const KlemsTable& table, const FitRequest& request, const ProgressToken& progress = {});

/// The directional-hemispherical sums of a matrix for each incident ring, of an anisotropic one for each incident patch,
/// and those of `f` and the part's beam for light from the middles of these patches.
std::vector<Hemispherical> hemispherical(const KlemsTable& table, const Evaluate& f, const Beams& beams, Part part);

}  // namespace srbf
