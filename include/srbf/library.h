// Libraries of materials that share their lobes, and their file.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/model.h"
#include "srbf/result.h"

SRBF_BEGIN

/// T materials whose BRDFs are sums of J shared lobes E_j: material t is ρ_t = Σ_i β_ti E_{j(t,i)} [1/sr], i < K.
/// *Dense*: K = J and j(t, i) = i, so that the mean of two materials is the mean of their coefficients. *Sparse*: each
/// material uses at most K of the lobes, those of `index`.
struct Library {
    PmModel basis;                     ///< E_j: a model in R, G, B whose coefficients are 1
    int stored = 0;                    ///< K, 1..J
    std::vector<std::uint16_t> index;  ///< sparse: T × K, j(t, i) < J; dense: empty
    std::vector<Rgb> coefficient;      ///< T × K, β_ti ≥ 0; of a lobe that is not used 0
    std::vector<std::string> names;    ///< T, each its own, without line breaks; of texels none
    std::uint64_t width = 0;           ///< texels in a row of a map; 0: no map
    std::vector<float> error;          ///< T, 0..k_half_max: of the fits
    std::map<std::string, std::string> provenance;

    std::size_t count() const { return error.size(); }  ///< T
    bool dense() const { return index.empty(); }
    friend bool operator==(const Library&, const Library&) = default;
};

/// Material t as a model of its own: of a dense library with all J lobes, of a sparse one with those that it uses, at
/// least one.
Model material(const Library& library, std::size_t t);
/// The material that is named so: one of `names`; X,Y in a map; or an index.
std::optional<std::size_t> find_material(const Library& library, std::string_view name);

/// The file has the tensors of a model file for the lobes, with `coefficient` [T,K,3] instead of [J,3], and
/// `aux.error`, F16 [T]. A sparse library also has `index`, U16 [T,K]. The metadata `names` has the names, separated by
/// line breaks, and `width` the width of a map.
std::vector<std::byte> write_library(const Library& library);
/// Errors: as in `read_model`; an index that is not below J; another number of names than of materials.
Result<Library> read_library(std::span<const std::byte> bytes, const std::string& file_name);

SRBF_END
