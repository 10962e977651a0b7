// The weights of objective appearance, one text for numbers and for vectors of the processor, which each instruction
// set compiles again. A host defines SRBF_FN, and for its `Real` the functions max, sqrt and pow(Real, double); it
// includes srbf/elementary.h and srbf/metrics.h.

/// The value that appears bright on a display exposed for a picture is this quantile of f cosθl, weighted by cosθv.
constexpr double k_bright_quantile = 0.75;

/// A sum of f cosθl and a positive number is at least this fraction of that number, whatever noise below 0 it contains.
constexpr double k_min_left = 0.1;

/// f cosθl + s, with the s of `Objective::appearance`.
template <typename Real> SRBF_FN Real above_dark(Real f, Real bright, Real cos_l) {
    using std::max;
    const Real s = Real(k_dark_fraction) * bright;
    return max(f * cos_l + s, Real(k_min_left) * s);
}
template <typename Real> SRBF_FN Real displayed_slope(Real f, Real bright, Real cos_l) {
    using elementary::pow;
    return cos_l * pow(above_dark(f, bright, cos_l), -5.0 / 6) / Real(6);
}
/// The squared slope of the displayed f cosθl.
template <typename Real> SRBF_FN Real display_weight(Real f, Real bright, Real cos_l, Real cos_v) {
    const Real slope = displayed_slope(f, bright, cos_l);
    return slope * slope * cos_v;
}
/// The squared slope of ∛(f cosθl + bright), up to a factor, weighted by √cosθv: measurements brighten towards the
/// rim of a picture, which is narrow.
template <typename Real> SRBF_FN Real highlight_weight(Real f, Real bright, Real cos_l, Real cos_v) {
    using elementary::pow, std::max, std::sqrt;
    return cos_l * cos_l * pow(max(Real(1) + f * cos_l / bright, Real(k_min_left)), -4.0 / 3) * sqrt(cos_v);
}
template <typename Real> SRBF_FN Real cosine_weight(Real, Real, Real cos_l, Real cos_v) {
    return cos_l * cos_l * cos_v;
}
