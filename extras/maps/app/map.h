// The command line of `srbf map`, and its two kinds of output.
#pragma once
#include <string>
#include <variant>

#include "app/fit_options.h"
#include "fit/texel_stream.h"
#include "srbf/fit_batch.h"

namespace SRBF_NAMESPACE {

struct MapCommand {
    std::string texels, pairs, output;
    std::string settings;  // the options on which results depend
    FitTexts texts;
    FitRequest request;  // parsed from the texts, with the number of each texel's lobes
    int lobes = std::get<LobeCount>(*std::get<PmRequest>(BatchOptions{}.request.model).size).lobes;
    int basis = 0;                    // number of lobes that the texels share; 0: each has its own
    std::size_t first = 0, last = 0;  // range of texels; last 0: all
    std::size_t examples = 0;         // texels whose lobes are searched for, if not those of all
    std::size_t slab = TexelStream{}.slab, width = 0;
    bool resume = false;

    const PmRequest& lobe() const { return std::get<PmRequest>(request.model); }
};

/// Writes a stack of models (model.h) for each slab of texels; returns the exit status.
int fit_slabs(const MapCommand& fit);
/// Writes a dense library (library.h) of all texels; returns the exit status.
int fit_map(const MapCommand& fit);

}  // namespace srbf
