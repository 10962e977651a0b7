#include "srbf/prepared_map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "brdf/colour.h"
#include "models/pm/pm_lanes.h"

namespace srbf {
namespace {

using Row = MixtureProposal::Row;
constexpr std::size_t k_nodes = MixtureProposal::k_nodes, k_mixed = MixtureProposal::k_lobes;
constexpr float k_least_cosine_of_view = 1e-3f;  // at which the last node is made

PmModel with_coefficients(PmModel basis, std::vector<Rgb> coefficient) {
    basis.coefficient = std::move(coefficient);
    return basis;
}
std::vector<Rgb> mean_coefficients(const Library& map) {
    const auto J = std::size_t(map.basis.lobes);
    std::vector<std::array<double, 3>> sum(J);
    for (std::size_t i = 0; i < map.coefficient.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) sum[i % J][c] += double(map.coefficient[i][int(c)]);
    std::vector<Rgb> mean;
    const double T = double(map.count());
    for (const auto& of : sum) mean.push_back({float(of[0] / T), float(of[1] / T), float(of[2] / T)});
    return mean;
}

}  // namespace

struct PreparedMap::Contents {
    std::size_t width = 0, height = 0;
    std::vector<Rgb> coefficient;  // texels in rows, each with J of them
    PmLanes lanes;                 // of the basis
    MixtureProposal proposal;      // of the mean over the map
    std::vector<std::array<Row, k_nodes>> of_lobe =
        {};  // a_j w_jk: what a mixture's lobe draws of what basis lobe j reflects
};

PreparedMap prepare_map(const Library& map, const ProposeOptions& of_caller) {
    assert(map.dense() && map.width > 0);
    ProposeOptions options = of_caller;
    options.most_variance = std::numeric_limits<double>::infinity();  // mixtures alone, which are blended
    const auto J = std::size_t(map.basis.lobes), width = std::size_t(map.width);
    const auto proposal_of = [&](std::vector<Rgb> coefficient) {
        return prepare({with_coefficients(map.basis, std::move(coefficient)), {}}, options);
    };
    const auto mixture_of = [](const PreparedBrdf& brdf) { return std::get<MixtureProposal>(proposal(brdf)); };
    auto contents = std::make_shared<PreparedMap::Contents>(
        PreparedMap::Contents{width, map.count() / width, map.coefficient, PmLanes(map.basis),
                              mixture_of(proposal_of(mean_coefficients(map)))});
    contents->of_lobe.resize(J);
    for (std::size_t j = 0; j < J; ++j) {
        std::vector<Rgb> alone(J);
        alone[j] = {1, 1, 1};
        const PreparedBrdf lobe = proposal_of(std::move(alone));
        for (std::size_t node = 0; node < k_nodes; ++node) {
            const float root = 1 - float(node) / float(k_nodes - 1);
            const float reflected = albedo(lobe, std::max(root * root, k_least_cosine_of_view)).g;
            const Row weight = mixture_of(lobe).weight(node);
            for (std::size_t k = 0; k < k_mixed; ++k) contents->of_lobe[j][node][k] = reflected * weight[k];
        }
    }
    return PreparedMap(std::move(contents));
}

PreparedBrdf brdf_at(const PreparedMap& map, Vec2f uv) {
    const PreparedMap::Contents& of = *map.contents_;
    const std::size_t J = of.of_lobe.size();
    struct Between {
        std::size_t texel[2];
        float weight[2];
    };
    const auto between = [](float u, std::size_t count) {
        const float part = u - std::floor(u);  // not a number if u is none
        const float x = (part < 1 ? part : 0) * float(count) - 0.5f, below = std::floor(x);
        const auto i = std::size_t(below + float(count)) % count;  // x ≥ −½
        return Between{{i, (i + 1) % count}, {1 - (x - below), x - below}};
    };
    const Between column = between(uv.x, of.width), row = between(uv.y, of.height);
    std::vector<Rgb> coefficient(J);
    for (const int y : {0, 1})
        for (const int x : {0, 1}) {
            const Rgb* const beta = &of.coefficient[(row.texel[y] * of.width + column.texel[x]) * J];
            for (std::size_t j = 0; j < J; ++j)
                for (int c = 0; c < 3; ++c) coefficient[j][c] += row.weight[y] * column.weight[x] * beta[j][c];
        }
    const auto held = std::make_shared<const PmLanes>(of.lanes.with_coefficients(coefficient));
    MixtureProposal proposal = of.proposal;
    for (std::size_t node = 0; node < k_nodes; ++node) {
        Row weight{};
        for (std::size_t j = 0; j < J; ++j) {
            const float beta = float(luminance(coefficient[j]));
            for (std::size_t k = 0; k < k_mixed; ++k) weight[k] += beta * of.of_lobe[j][node][k];
        }
        float sum = 0;
        for (const float w : weight) sum += w;
        if (!(sum > 0)) weight = {1}, sum = 1;  // the cosine of a black texel
        for (float& w : weight) w /= sum;
        proposal.set_weights(node, std::span<const float, k_mixed>(weight));
    }
    return prepare(BrdfParts{held, pair_evaluator(*held),
                             [&lanes = *held](auto wl, auto wv, auto f) { evaluate(lanes, wl, wv, f); },
                             std::move(proposal)});
}

}  // namespace srbf
