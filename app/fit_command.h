// The command line of `srbf fit`, and the requests that it makes.
#pragma once
#include <algorithm>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "app/fit.h"
#include "app/read_options.h"
#include "srbf/directions.h"
#include "srbf/fit_batch.h"
#include "srbf/text.h"

namespace srbf {

/// The parsed command line.
struct FitCommand {
    int run() const;

    std::vector<std::string> inputs, given;
    std::string settings;  // the options that results depend on
    std::string output, preview, json;
    std::string pairs;  // of texels; empty: none
    std::string basis;  // a number of shared lobes, or the library whose lobes are used; empty: none
    int active = 0;     // 0: all
    std::size_t width = 0;
    ReadOptions read;
    std::size_t first = 0, last = 0, slab = TexelFits{}.slab;
    std::string model = "pm", surface = std::string(name(OpenPbrRequest{}.surface)),
                form = std::string(name(PmRequest{}.form)), objective = std::string(name(FitRequest{}.objective)),
                discretise = std::string(name(SuRequest{}.discretise)),
                interpolation = std::string(name(SuRequest{}.interpolation)), with_index, channels = "rgb", band;
    int axial = 0;  // 1: axial lobes, -1: general lobes, 0: depends on the measurement
    bool no_scale = false, reciprocal = false, lobes_auto = false, exchange = false, resume = false, explain = false;
    double max_theta = 0;  // [degrees], 0: the objective's default
    int lobes = 0;         // 0: not given
    int variates = PmRequest{}.variates, threads = 0;
    int directions = SuRequest{}.directions, neighbours = SuRequest{}.neighbours;
    std::uint64_t seed = 0;
    double target_delta_e = 0;  // 0: none
    std::size_t budget = 0;     // 0: none

    PmRequest pm() const {
        PmRequest pm;
        pm.form = *form_named(form);
        pm.variates = variates;
        if (axial != 0) pm.axial = axial > 0;
        pm.reciprocal = reciprocal;
        pm.log_scale = !no_scale;
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
    bool output_is_folder() const {
        std::error_code ignored;
        return output.ends_with('/') || std::filesystem::is_directory(output, ignored);
    }
    /// Texels and several inputs go into a folder, and one does if the output is a folder, as with `cp`.
    bool into_folder() const { return basis.empty() && several(); }
    bool several() const { return inputs.size() > 1 || resume || !pairs.empty() || output_is_folder(); }
    FileFit file_fit() const {
        const std::string beside = std::filesystem::path(inputs[0]).stem().string() + ".srbf";
        return {inputs[0], output.empty() ? beside : output, preview, json, request(), exchange, read, band, given};
    }
    FolderFit folder_fit() const {
        return {inputs, output, {{}, {}, {}, {}, request(), exchange, read, band, given}, settings, resume};
    }
    TexelFits texel_fits() const {
        TexelFits fit{inputs[0], pairs, output, request(), first, last, slab, axial < 0, settings, resume};
        auto& pm = std::get<PmRequest>(fit.request.model);
        if (!pm.size) pm.size = std::get<PmRequest>(BatchOptions{}.request.model).size;
        return fit;
    }
    BasisFit basis_fit() const {
        BasisFit fit;
        fit.inputs = inputs, fit.output = output, fit.pairs = pairs, fit.width = width, fit.resume = resume;
        fit.settings = settings;
        const auto lobes_shared = to_number<int>(basis);
        if (!lobes_shared) fit.basis = basis;
        fit.options.form = *form_named(form), fit.options.variates = variates, fit.options.axial = axial >= 0;
        fit.options.lobes = lobes_shared.value_or(fit.options.lobes), fit.options.active = active;
        fit.target_delta_e = target_delta_e;
        fit.options.max_theta = max_theta * k_degree, fit.options.seed = seed, fit.options.threads = threads;
        return fit;
    }
};

}  // namespace srbf
