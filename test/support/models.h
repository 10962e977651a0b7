// Models for tests.
#pragma once
#include "base/half.h"
#include "brdf/values.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "models/model_files.h"
#include "models/pm/pm_functions.h"
#include "random_directions.h"
#include "srbf/map.h"
#include "srbf/model.h"

namespace srbf {

struct RandomModelOptions {
    bool axial = true, log_scale = false;
    int lobes = 5, variates = 3;
    double max_bandwidth = 300;
    PmForm form = PmForm::gaussian;
};

/// A sum of Gaussians of the half vector about the normal, with these colours and bandwidths.
inline PmModel axial_gaussians(std::vector<Rgb> colours, std::vector<float> bandwidths) {
    PmModel model;
    model.lobes = int(colours.size());
    model.variates = 1;
    model.log_scale.assign(colours.size(), 0);
    model.centre.assign(colours.size(), {0, 0, 1});
    model.parameterization = {{1, 1}};
    model.coefficient = std::move(colours);
    model.bandwidth = std::move(bandwidths);
    return model;
}

/// A model with random numbers in the range of fits.
inline PmModel random_model(std::mt19937_64& random, const RandomModelOptions& options) {
    PmModel model;
    model.form = options.form;
    model.axial = options.axial;
    model.lobes = options.lobes;
    model.variates = options.variates;
    const auto draw = [&] { return uniform(random); };
    for (int j = 0; j < model.lobes; ++j) {
        model.coefficient.push_back({float(draw()), float(draw()), float(draw())});
        model.log_scale.push_back(options.log_scale ? float(20 * draw() - 10) : 0);
        for (int k = 0; k < features(model.form); ++k)
            model.exponent.push_back(float(k_terms[std::size_t(k)].min == 0 ? 3 * draw() : 6 * draw() - 3));
        for (int n = 0; n < model.variates; ++n) {
            const bool up = draw() < 0.7;
            model.centre.push_back(options.axial ? Vec3f(0, 0, up ? 1 : -1) : to_float(random_direction(random)));
            model.bandwidth.push_back(float(options.max_bandwidth * elementary::pow(draw(), 6)));
        }
    }
    for (int n = 0; n < model.variates; ++n) {
        const double angle = 2 * k_pi * draw();
        model.parameterization.push_back({float(elementary::cos(angle)), float(elementary::sin(angle))});
    }
    return model;
}

/// Returns the same model with coefficients at this many wavelengths.
inline PmModel spectral_model(std::mt19937_64& random, const RandomModelOptions& options, int wavelengths) {
    PmModel model = random_model(random, options);
    for (int c = 0; c < wavelengths; ++c) model.wavelength.push_back(400 + 10.25f * float(c));
    for (int i = 0; i < wavelengths * model.lobes; ++i) model.spectrum.push_back(float(uniform(random)));
    model.coefficient = colours(model.spectrum, model.wavelength);
    return model;
}

/// A map of width × height texels that share random lobes.
inline TexelMap random_map(std::mt19937_64& random, const RandomModelOptions& options, std::size_t width,
                           std::size_t height) {
    TexelMap map;
    map.basis = random_model(random, options);
    map.basis.coefficient.assign(std::size_t(options.lobes), {1, 1, 1});
    map.width = width;
    map.error.assign(width * height, 0);
    for (std::size_t i = 0; i < width * height * std::size_t(options.lobes); ++i)
        map.coefficient.push_back({float(uniform(random)), float(uniform(random)), float(uniform(random))});
    return rounded(map);
}

/// A part of a BSDF with random lobes, whose colours are a tenth of those of `random_model`.
inline std::shared_ptr<const Model> random_part(std::uint64_t seed, const RandomModelOptions& options) {
    std::mt19937_64 random(seed);
    PmModel model = random_model(random, options);
    for (Rgb& colour : model.coefficient) colour = scaled(0.1f, colour);
    return std::make_shared<const Model>(Model{model, {}});
}

/// A BSDF of four models of different kinds, with beams.
inline BsdfModel lobe_bsdf_with_beams(double max_bandwidth = 30) {
    BsdfModel bsdf;
    for (std::size_t p = 0; p < k_parts; ++p)
        bsdf.part[p] = random_part(p + 1, {.lobes = 3, .max_bandwidth = max_bandwidth, .form = PmForm::horizon});
    bsdf.beam[0] = {{0.f, 1.f}, {{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}}};
    bsdf.beam[2] = {
        {0.5f, 0.9f}, {{0.3f, 0.2f, 0.1f}, {0.1f, 0.2f, 0.1f}, {0.2f, 0.1f, 0.3f}, {0.4f, 0.1f, 0}}, {1, 3}};
    bsdf.beam[3] = {{0.25f}, {{0.1f, 0.1f, 0.1f}, {0.3f, 0.3f, 0.3f}}, {2}};
    return bsdf;
}

inline GgxModel grey_facets() { return {{0.1f, 0.1f, 0.1f}, {{0.4f, {0.5f, 0.5f, 0.5f}, 1}}}; }

/// A BSDF of four models of Lambert and GGX.
inline BsdfModel ggx_bsdf() {
    BsdfModel bsdf;
    for (std::size_t p = 0; p < k_parts; ++p)
        bsdf.part[p] = std::make_shared<const Model>(
            Model{GgxModel{{0.1f, 0.2f, 0.1f * float(p)}, {{0.4f, {0.5f, 0.1f * float(p), 0.1f}, 1}}}, {}});
    bsdf.beam[2] = {{0.f}, {{0.3f, 0.2f, 0.1f}}};
    return bsdf;
}

}  // namespace srbf
