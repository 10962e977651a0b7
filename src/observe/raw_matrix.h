// A measurement as a matrix, for view-by-view fits.
#pragma once
#include "srbf/brdf.h"
#include "srbf/models/su.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

struct TabulateOptions {
    int directions = 1536;                     ///< n, k_min_views..k_max_views
    int between = 512;                         ///< m ≥ 0, the number used by a fit; 0: only the raw matrix
    Discretise discretise = Discretise::view;  ///< `SuModel::discretise` of the model to be fitted
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
};

/// A BRDF at all pairs of n directions (the raw data of Tsai 2009, 12 n² bytes), and at further directions of each.
struct RawMatrix {
    Discretise discretise = Discretise::view;  ///< direction of a pair that is the sampled one in `between`
    std::vector<Vec3f> direction;              ///< n: the Fibonacci set of the whole hemisphere
    std::vector<Rgb> f;                        ///< n × n; (wl_l, wv_v) is at v n + l [1/sr], ≥ 0; NaN: not measured
    /// f at a sampled direction and another one drawn from MirrorMixture around it. The directions of the set miss
    /// most of a sharp highlight, and for isotropic data they miss the same part of it in all views.
    struct DrawnValue {
        Vec3f direction;
        Rgb f;
        float pdf = 0;  ///< [1/sr]
    };
    std::vector<DrawnValue> between;  ///< n × m
    std::uint64_t masked = 0;         ///< number of pairs of the matrix that were not measured
    std::uint64_t clamped = 0;        ///< number of negative channel values in the matrix, set to 0
};

/// Evaluates `f`, which may be negative or NaN. Returns an error if options are out of range, or if it is cancelled.
Result<RawMatrix> tabulate(const Evaluate& f, const TabulateOptions& options = {}, const ProgressToken& progress = {});

}  // namespace
