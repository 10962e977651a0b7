#include "srbf/prepared_map.h"

#include <algorithm>
#include <cmath>

#include "brdf/colour.h"
#include "models/model_files.h"
#include "models/pm/pm_lanes.h"

namespace SRBF_NAMESPACE {
namespace {

using Row = MixtureProposal::Row;
constexpr std::size_t k_nodes = MixtureProposal::k_nodes, k_mixed = MixtureProposal::k_lobes;
constexpr float k_min_cosine_of_view = 1e-3f;  // cosine of the last node's view

}  // namespace

struct PreparedMap::Contents {
    std::size_t width = 0, height = 0;
    std::vector<Rgb> coefficient;  // rows of texels, each with J coefficients
    PmLanes lanes;                 // lanes of the basis
    MixtureProposal proposal;      // the proposal for the mean over the map
    // a_j w_jk: the weight of mixture lobe k for the light that basis lobe j reflects
    std::vector<std::array<Row, k_nodes>> lobe_weights = {};
};

PreparedMap prepare_map(const TexelMap& map, const ProposeOptions& options) {
    const auto J = std::size_t(map.basis.lobes);
    const auto mixture_of = [](const PreparedBrdf& brdf) { return std::get<MixtureProposal>(proposal(brdf)); };
    auto contents = std::make_shared<PreparedMap::Contents>(PreparedMap::Contents{
        map.width, map.height(), map.coefficient, PmLanes(map.basis), mixture_of(prepare(mean_texel(map), options))});
    contents->lobe_weights.resize(J);
    for (std::size_t j = 0; j < J; ++j) {
        const PreparedBrdf lobe = prepare(lobe_alone(map.basis, j), options);
        for (std::size_t node = 0; node < k_nodes; ++node) {
            const float root = 1 - float(node) / float(k_nodes - 1);
            const float reflected = albedo(lobe, std::max(root * root, k_min_cosine_of_view)).g;
            const Row weight = mixture_of(lobe).weight(node);
            for (std::size_t k = 0; k < k_mixed; ++k) contents->lobe_weights[j][node][k] = reflected * weight[k];
        }
    }
    return PreparedMap(std::move(contents));
}

PreparedBrdf brdf_at(const PreparedMap& map, Vec2f uv) {
    const PreparedMap::Contents& contents = *map.contents_;
    const std::size_t J = contents.lobe_weights.size();
    struct Interpolation {
        std::size_t texel[2];
        float weight[2];
    };
    const auto interpolation = [](float u, std::size_t count) {
        const float part = u - std::floor(u);  // NaN if u is not finite
        const float x = (part < 1 ? part : 0) * float(count) - 0.5f, below = std::floor(x);
        const auto i = std::size_t(below + float(count)) % count;  // x ≥ −½
        return Interpolation{{i, (i + 1) % count}, {1 - (x - below), x - below}};
    };
    const Interpolation column = interpolation(uv.x, contents.width), row = interpolation(uv.y, contents.height);
    std::vector<Rgb> coefficient(J);
    for (const int y : {0, 1})
        for (const int x : {0, 1}) {
            const Rgb* const beta = &contents.coefficient[(row.texel[y] * contents.width + column.texel[x]) * J];
            for (std::size_t j = 0; j < J; ++j)
                for (int c = 0; c < 3; ++c) coefficient[j][c] += row.weight[y] * column.weight[x] * beta[j][c];
        }
    const auto held = std::make_shared<const PmLanes>(contents.lanes.with_coefficients(coefficient));
    MixtureProposal proposal = contents.proposal;
    for (std::size_t node = 0; node < k_nodes; ++node) {
        Row weight{};
        for (std::size_t j = 0; j < J; ++j) {
            const float beta = float(luminance(coefficient[j]));
            for (std::size_t k = 0; k < k_mixed; ++k) weight[k] += beta * contents.lobe_weights[j][node][k];
        }
        float sum = 0;
        for (const float w : weight) sum += w;
        if (!(sum > 0)) weight = {1}, sum = 1;  // a black texel is sampled by the cosine
        for (float& w : weight) w /= sum;
        proposal.set_weights(node, std::span<const float, k_mixed>(weight));
    }
    return prepare(BrdfParts{held, pair_evaluator(*held),
                             [&lanes = *held](auto wl, auto wv, auto f) { evaluate(lanes, wl, wv, f); },
                             std::move(proposal)});
}

}  // namespace
