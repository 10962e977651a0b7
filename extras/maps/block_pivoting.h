// Bounded least squares for many small problems.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace SRBF_NAMESPACE {

/// Minimises ½ xᵀGx − gᵀx within 0 ≤ x ≤ upper, as `bounded_least_squares` does, by block principal pivoting (Júdice &
/// Pires 1994): each x is fixed at a bound or free; the free ones are solved for, and all that violate a bound or the
/// sign of their gradient change at once. This takes fewer steps than an active set that changes by one. If the number
/// of violations does not fall for three steps, only the last violation changes.
class BlockPivoting {
  public:
    /// `G`: n × n, symmetric and positive semidefinite. Its diagonal is scaled to 1, and gets the ridge 1e-6. The first
    /// solution begins with these of the x free and the others 0, a further one with those of the last.
    void set_matrix(std::span<const double> G, std::span<const bool> is_free);
    /// Sets x. `upper` may contain infinities. A column that is 0 gets x = 0.
    void minimise(std::span<const double> g, std::span<const double> upper, std::span<double> x);

  private:
    enum Status : unsigned char { at_zero, free, at_upper };
    void take(std::span<const double> upper, std::span<double> x) const;
    void solve_free();
    void factor_free();
    std::size_t count_violations(double tolerance);
    void change(std::size_t i);

    std::size_t n_ = 0;
    bool is_factored_ = false;            ///< whether `factor_` is that of the last step
    std::vector<double> G_, reciprocal_;  ///< scaled; and 1 / √G_ii, or 0
    std::vector<double> g_, upper_, x_;   ///< scaled
    std::vector<double> factor_, right_;  ///< of the free part
    std::vector<std::size_t> free_, factored_, violations_;
    std::vector<Status> status_;
};

}  // namespace srbf
