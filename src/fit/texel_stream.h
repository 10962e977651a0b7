// Fits of more texels than memory holds.
#pragma once
#include <cstddef>
#include <functional>

#include "srbf/fit_batch.h"

SRBF_BEGIN

/// Texels that are read and fitted in slabs, so that only one slab of them is in memory.
struct TexelStream {
    std::size_t begin = 0, end = 0;  ///< the texels to fit
    std::size_t slab = 1024;         ///< their number in a slab; the last one may have fewer
    /// Writes the values of texels `first`, `first` + 1, … to f, as many as it has room for.
    std::function<Result<Done>(std::size_t first, std::span<Rgb> f)> read;
    /// Receives the fits of a slab.
    std::function<Result<Done>(std::size_t first, std::span<const TexelFit> fits)> take;
    /// True for a slab that an earlier run has taken, which is left out; none: no slab was taken.
    std::function<bool(std::size_t first, std::size_t count)> is_done = {};
};

/// Fits the texels of a stream, slab after slab. Errors: those of `read` and `take`, which end it, and those of `fit_batch`.
Result<Done> fit_batch(const SharedPairs& pairs, const TexelStream& texels, const BatchOptions& options,
                       const ProgressToken& progress = {});

SRBF_END
