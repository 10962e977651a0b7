// Maps of texels that share their lobes, and their file.
#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/model.h"
#include "srbf/result.h"

SRBF_BEGIN

/// T texels whose BRDFs are sums of J shared lobes E_j: ρ_t = Σ_j β_tj E_j [1/sr], so that the mean of two texels is
/// the mean of their coefficients.
struct TexelMap {
    PmModel basis;                 ///< E_j: a model in R, G, B whose coefficients are 1
    std::size_t width = 0;         ///< texels in a row, a divisor of T
    std::vector<Rgb> coefficient;  ///< T × J, β_tj ≥ 0
    std::vector<float> error;      ///< T, 0..k_half_max: of the fits
    std::map<std::string, std::string> provenance;

    std::size_t count() const { return error.size(); }  ///< T
    std::size_t height() const { return count() / width; }
    friend bool operator==(const TexelMap&, const TexelMap&) = default;
};

/// Texel t as a model of its own.
Model texel(const TexelMap& map, std::size_t t);
/// The index of the texel with the name "X,Y" or "T".
std::optional<std::size_t> find_texel(const TexelMap& map, std::string_view name);

/// The file has the tensors of a model file for the lobes, with `coefficient` [T,J,3] instead of [J,3], and
/// `aux.error`, F16 [T]. The metadata `width` has the width.
std::vector<std::byte> write_map(const TexelMap& map);
/// Reads a map. Without the metadata `width` the texels are a row. Returns an error as `read_model` does, and for a
/// library of version 0.1, whose materials have lobes of their own.
Result<TexelMap> read_map(std::span<const std::byte> bytes, const std::string& file_name);

SRBF_END
