// A multivariate model in the memory layout of its evaluation.
#pragma once
#include <array>

#include "srbf/models/pm.h"

namespace SRBF_NAMESPACE {

/// The numbers of a multivariate model as kernel.glsl expects them, with exponents to base 2. Lobes form groups of
/// eight, so that a vector with up to eight lanes loads as many lobes at once. Padding lobes contribute 0.
class PmLanes {
  public:
    static constexpr int k_lanes = 8;

    explicit PmLanes(const PmModel& model);
    /// A copy with other coefficients.
    PmLanes with_coefficients(std::span<const Rgb> coefficient) const;

    PmForm form() const { return form_; }
    bool axial() const { return axial_; }
    int lobes() const { return lobes_; }
    int variates() const { return variates_; }  ///< including padding

    /// The number of variates including padding with bandwidth 0, so that few numbers of variates need compiled code.
    static constexpr int padded_variates(int variates, bool axial) {
        if (!axial) return variates <= 4 ? 4 : 8;
        return variates <= 4 ? variates : variates <= 6 ? 6 : 8;
    }

    /// Weights of variate n, followed by the weights of the next variates.
    const float* weight_l(int n) const { return &numbers_[0].lane[std::size_t(n)]; }
    const float* weight_v(int n) const { return &numbers_[1].lane[std::size_t(n)]; }
    /// Weights of the four variates from n on, twice in a row; n is a multiple of four.
    const float* four_weights_l(int n) const { return numbers_[std::size_t(2 + n / 4)].lane.data(); }
    const float* four_weights_v(int n) const { return numbers_[std::size_t(4 + n / 4)].lane.data(); }
    alignas(32) static constexpr float k_poles[] = {1, 1, 1, 1, -1, -1, -1, -1};

    /// The first number of lobe j; `row` moves to another row. The numbers of the next lobes of its group follow.
    const float* lobe(int j) const {
        return &numbers_[std::size_t(k_first + j / k_lanes * rows_)].lane[std::size_t(j % k_lanes)];
    }
    static const float* row(const float* lobe, int row) { return lobe + row * k_lanes; }

    // Indices of the rows of a group.
    static constexpr int log2_scale() { return 0; }
    static constexpr int coefficient(int channel) { return 1 + channel; }
    static constexpr int log2_falloff(bool axial, int n) { return 4 + (axial ? 3 : 4) * n; }
    static constexpr int pole(int n) { return 5 + 3 * n; }  ///< z of an axial centre
    /// index in `k_poles` of the variate's pole, as the bits of an integer
    static constexpr int place(int n) { return 6 + 3 * n; }
    static constexpr int centre(int n, int axis) { return 5 + 4 * n + axis; }  ///< general centre
    static constexpr int exponent(bool axial, int variates, int k) { return log2_falloff(axial, variates) + k; }

  private:
    struct alignas(k_lanes * sizeof(float)) Row {
        std::array<float, k_lanes> lane{};
    };
    static constexpr int k_first = 6;  // row of the first group
    void set_coefficient(std::size_t j, const Rgb& beta);
    PmForm form_;
    bool axial_;
    int lobes_, variates_, rows_;
    std::vector<Row> numbers_;  // the weights, then the rows of each group
};

/// A function that evaluates a BRDF at one pair of directions above the horizon. It writes R, G, B and padding to
/// `colour`, which is aligned to 16 bytes.
using PairEvaluator = void (*)(const void* model, const Vec3f& wl, const Vec3f& wv, float* colour);
/// pm_value of kernel.glsl for a `PmLanes`, with lobes in the lanes of a vector. Its error is at most 1e-4 of the
/// exact value or 1e-6 of the model's peak.
PairEvaluator pair_evaluator(const PmLanes& model);
/// f on arrays of pairs. The spans must have the same length.
void evaluate(const PmLanes& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);

}  // namespace
