// The command line of `srbf fit`, and the requests that it makes.
#pragma once
#include <algorithm>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "app/fit.h"
#include "app/fit_options.h"
#include "app/read_options.h"
#include "srbf/directions.h"

namespace srbf {

/// The parsed command line.
struct FitCommand {
    int run() const;

    std::vector<std::string> inputs, given;
    std::string settings;  // the options that results depend on
    std::string output, preview, json;
    ReadOptions read;
    std::string model = "pm", surface = std::string(name(OpenPbrRequest{}.surface)),
                objective = std::string(name(FitRequest{}.objective)),
                discretise = std::string(name(SuRequest{}.discretise)),
                interpolation = std::string(name(SuRequest{}.interpolation)), with_index, channels = "rgb", band;
    LobeSettings lobe;
    bool lobes_auto = false, exchange = false, resume = false;
    double max_theta = 0;  // [degrees], 0: the objective's default
    int lobes = 0;         // 0: not given
    int threads = 0;
    int directions = SuRequest{}.directions, neighbours = SuRequest{}.neighbours;
    std::uint64_t seed = 0;
    double target_delta_e = 0;  // 0: none
    std::size_t budget = 0;                       // 0: none

    PmRequest pm() const {
        PmRequest pm = lobe.request();
        if (lobes > 0) pm.size = LobeCount{lobes};
        if (lobes_auto) pm.size = AutomaticLobes{};
        if (budget > 0) pm.size = ByteBudget{budget};
        if (target_delta_e > 0) pm.size = TargetDeltaE{target_delta_e};
        return pm;
    }
    SuRequest su() const {
        SuRequest su;
        if (lobes > 0) su.lobes = lobes;
        su.discretise = *discretise_named(discretise);
        su.directions = directions;
        su.interpolation = *interpolation_named(interpolation), su.neighbours = neighbours;
        if (!with_index.empty()) su.index = map_named(with_index);
        return su;
    }
    FitRequest request() const {
        FitRequest request;
        if (model == "pm") request.model = pm();
        if (model == "su") request.model = su();
        if (model == "ggx") request.model = GgxRequest{std::max(lobes, 1)};
        if (model == "openpbr") request.model = OpenPbrRequest{*openpbr_surface_named(surface)};
        request.objective = *objective_named(objective);
        if (max_theta > 0) request.max_theta = max_theta * k_degree;
        request.spectral = is_spectral();
        request.seed = seed, request.threads = threads;
        return request;
    }
    bool is_spectral() const { return channels == "spectral"; }
    /// Several inputs go into a folder, and one does if the output is a folder, as with `cp`.
    bool into_folder() const { return inputs.size() > 1 || resume || is_folder(output); }
    FileFit file_fit() const {
        const std::string beside = std::filesystem::path(inputs[0]).stem().string() + ".srbf";
        return {inputs[0], output.empty() ? beside : output, preview, json, request(), exchange, read, band, given};
    }
    FolderFit folder_fit() const {
        return {inputs, output, {{}, {}, {}, {}, request(), exchange, read, band, given}, settings, resume};
    }
};

}  // namespace srbf
