// The inner loops of fits: columns of numbers with one row per observation. They use float SIMD within a block of
// rows and double sums over blocks, so that results depend neither on the vector width nor on the number of
// threads.
#pragma once
#include <span>

#include "base/aligned.h"

namespace SRBF_NAMESPACE {

// All arrays hold k_block numbers and are aligned for SIMD. Only the first `count`, a multiple of k_row_multiple,
// are computed.

/// x = Σ_n weight[n] s[n]. Returns the maximum over rows with a positive √w, or the lowest float if there are none.
float exponent(std::span<const float> weight, std::span<const float* const> s, const float* root_weight, float* x,
               std::size_t count);
inline constexpr double k_max_exponent = 20;
/// e = √w exp(x − offset), for x − offset ≤ k_max_exponent, or 0 where that is less than 2⁻⁹³. Rows of weight 0 may
/// exceed it and become 0. x may alias e.
void exponentiate(const float* x, const float* root_weight, float offset, float* e, std::size_t count = k_block);
/// x = Σ_n weight[n] s[n].
void combine(std::span<const float> weight, std::span<const float* const> s, float* x, std::size_t count = k_block);
/// x = factor Σ_n weight[n] s[n].
void combine_and_multiply(std::span<const float> weight, std::span<const float* const> s, const float* factor, float* x,
                          std::size_t count = k_block);
/// out = a + b.
void add(const float* a, const float* b, float* out, std::size_t count = k_block);
/// out = a b.
void multiply(const float* a, const float* b, float* out, std::size_t count = k_block);
/// out = a b + c d.
void add_two_products(const float* a, const float* b, const float* c, const float* d, float* out,
                      std::size_t count = k_block);
/// out += a b.
void add_product(const float* a, const float* b, float* out, std::size_t count = k_block);
/// r = y − Σ_j beta[j] columns[j]; returns Σ r².
double residual(const float* y, std::span<const float> beta, std::span<const float* const> columns, float* r,
                std::size_t count = k_block);
/// The sum of a column, and the sum of its squares.
double sum(const float* column, std::size_t count = k_block);
double sum_of_squares(const float* column, std::size_t count = k_block);
/// G[i × n + k] += columns[i] · columns[k] for k ≤ i, n the number of columns.
void add_gram(std::span<const float* const> columns, double* G, std::size_t count = k_block);
/// G[i × n + k] += rows[i] · columns[k], n the number of columns.
void add_products(std::span<const float* const> rows, std::span<const float* const> columns, double* G,
                  std::size_t count = k_block);

}  // namespace
