#include "srbf/prepared.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <mutex>

#include "base/floating_point.h"
#include "brdf/directions.h"
#include "generated/models/kinds.h"
#include "models/pm/pm_lanes.h"
#include "sampling/elevation_nodes.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr int k_albedo_points = 1 << 14;
constexpr std::size_t k_azimuths = 4;

using AlbedoTable = std::array<Rgb, k_albedo_nodes>;

/// w, rotated about the normal by quarter turns.
Vec3f quarter_turns(Vec3f w, std::size_t turns) {
    for (; turns > 0; --turns) w = {-w.y, w.x, w.z};
    return w;
}
/// The albedo of a view by quadrature, whose points are distributed over four azimuths.
Rgb integrate_albedo(const Evaluate& brdf, Vec3d view) {
    Quadrature points = albedo_quadrature(view, k_pi / 2, k_albedo_points);
    std::vector<Vec3f> wv(points.w.size());
    for (std::size_t i = 0; i < wv.size(); ++i) {
        const std::size_t turns = (i / 4 + i / 168) % k_azimuths;  // four points share one
        wv[i] = quarter_turns(to_float(view), turns), points.w[i] = quarter_turns(points.w[i], turns);
    }
    std::vector<Rgb> f(wv.size());
    brdf(points.w, wv, f);
    const auto [r, g, b] = weighted_sum(f, points.weight);
    return {float(r), float(g), float(b)};
}
AlbedoTable albedo_table(const Evaluate& brdf) {
    const StandardArithmetic mode;
    constexpr double k_horizon = 1e-7;  // cosθv of the node at the horizon
    AlbedoTable table;
    for (std::size_t node = 0; node < table.size(); ++node) {
        // On one thread: another thread's task might wait for this table.
        const double cosine = std::max(albedo_cosine(int(node)), k_horizon);
        table[node] = integrate_albedo(brdf, {std::sqrt(1 - cosine * cosine), 0, cosine});
    }
    return table;
}

/// The albedo of a view-by-view model by the integrals of its lobes, which the first call computes.
struct ViewAlbedo {
    explicit ViewAlbedo(const SuModel& su) : model(su) {}
    const SuModel& model;
    std::once_flag has_integrals;
    std::vector<Rgb> integrals;

    Rgb operator()(Vec3f wv) {
        std::call_once(has_integrals, [&] { integrals = view_integrals(model); });
        return between_views(model, integrals, wv);
    }
};

/// The parts of a model that is evaluated by its own batch evaluation.
template <typename M> BrdfParts parts_of(std::shared_ptr<const M> held, PreparedBrdf::Value value) {
    const M& model = *held;
    return {std::move(held), value, [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); }, {}};
}
template <typename M> PreparedBrdf::Value pair_by_pair() {
    return [](const void* any, const Vec3f& wl, const Vec3f& wv, float* colour) {
        const Rgb f = value(*static_cast<const M*>(any), wl, wv);
        std::memcpy(colour, &f, sizeof f);
    };
}

// A prepared model holds a copy of it; these two kinds hold further data.
template <typename M> BrdfParts parts_of(const M& model) {
    return parts_of(std::make_shared<const M>(model), pair_by_pair<M>());
}
BrdfParts parts_of(const PmModel& model) {
    const auto held = std::make_shared<const PmLanes>(model);
    return parts_of(held, pair_evaluator(*held));
}
BrdfParts parts_of(const SuModel& model) {
    const auto held = std::make_shared<const SuModel>(model);
    BrdfParts parts = parts_of(held, pair_by_pair<SuModel>());
    if (held->discretise == Discretise::view)
        parts.albedo = [view_albedo = std::make_shared<ViewAlbedo>(*held)](Vec3f wv) { return (*view_albedo)(wv); };
    return parts;
}
BrdfParts parts_of(const Model& model) {
    return std::visit([](const auto& kind) { return parts_of(kind); }, model.model);
}

BrdfParts parts_of(Measured&& measured) {
    auto held = std::make_shared<const Measured>(std::move(measured));
    const Measured& m = *held;
    return {std::move(held), pair_by_pair<Measured>(), evaluator(m), {}};
}

struct Diffuse {
    Rgb f;
};
Rgb value(const Diffuse& brdf, Vec3f wl, Vec3f wv) { return above_horizon(wl, wv) ? brdf.f : Rgb{}; }

/// The parts of a BRDF by default. A mixture of no lobes has the density 0, so that no sample has a direction.
BrdfParts black_parts() {
    const auto evaluate = [](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        require_equal_lengths(wl.size(), wv.size(), f.size());
        std::ranges::fill(f, Rgb{});
    };
    return {nullptr, nullptr, evaluate, MixtureProposal{}, [](Vec3f) { return Rgb{}; }};
}

}  // namespace

struct PreparedBrdf::Contents {
    BrdfParts parts;
    mutable std::once_flag has_albedo = {};
    mutable AlbedoTable albedo = {};

    mutable std::atomic<int> uses = 1;

    explicit Contents(BrdfParts contents_parts) : parts(std::move(contents_parts)) {}
};
void add_use(const PreparedBrdf::Contents& contents) { contents.uses.fetch_add(1, std::memory_order_relaxed); }
void end_use(const PreparedBrdf::Contents& contents) {
    if (contents.uses.fetch_sub(1, std::memory_order_acq_rel) == 1) delete &contents;
}

PreparedBrdf::PreparedBrdf(Shared<Contents> contents)
    : contents_(std::move(contents)), held_(contents_->parts.held.get()), value_(contents_->parts.value) {}

const PreparedBrdf::Contents& PreparedBrdf::contents() const {
    if (contents_) return *contents_;
    static const Contents black(black_parts());
    return black;
}

const Proposal& proposal(const PreparedBrdf& brdf) { return brdf.contents().parts.proposal; }

PreparedBrdf prepare(BrdfParts parts) { return PreparedBrdf(Shared(new PreparedBrdf::Contents(std::move(parts)))); }

PreparedBrdf prepare(const Model& model, CosineProposal) { return prepare(parts_of(model)); }

PreparedBrdf prepare(const Model& model, const ProposeOptions& options) {
    BrdfParts parts = parts_of(model);
    parts.proposal = propose(model, options);
    if (auto* views = std::get_if<ViewProposal>(&parts.proposal))
        views->model = static_cast<const SuModel*>(parts.held.get());
    return prepare(std::move(parts));
}

PreparedBrdf prepare(Measured measured, CosineProposal) { return prepare(parts_of(std::move(measured))); }

PreparedBrdf prepare(Measured measured, const ProposeOptions& options) {
    BrdfParts parts = parts_of(std::move(measured));
    parts.proposal = propose(parts.evaluate, options);
    return prepare(std::move(parts));
}

PreparedBrdf diffuse(Rgb reflectance) {
    for (int c = 0; c < 3; ++c) reflectance[c] *= float(1 / k_pi);
    return prepare(Diffuse{reflectance}, CosineProposal{});
}

void evaluate(const PreparedBrdf& brdf, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    brdf.contents().parts.evaluate(wl, wv, f);
}

Evaluate evaluator(PreparedBrdf brdf) {
    return [brdf = std::move(brdf)](auto wl, auto wv, auto f) { evaluate(brdf, wl, wv, f); };
}

LightSample sample(const PreparedBrdf& brdf, Vec3f wv, Vec2f u, float selector) {
    assert(has_unit_lengths(wv, wv));
    return sample(brdf, proposal(brdf), wv, u, selector);
}
float pdf(const PreparedBrdf& brdf, Vec3f wl, Vec3f wv) {
    assert(has_unit_lengths(wl, wv));
    return pdf(proposal(brdf), wl, wv);
}
ValuePdf value_pdf(const PreparedBrdf& brdf, const Vec3f& wl, const Vec3f& wv) {
    if (!above_horizon(wl, wv)) return {};
    return {value(brdf, wl, wv), pdf(proposal(brdf), wl, wv)};
}

Rgb albedo(const PreparedBrdf& brdf, float cos_v) {
    if (!(cos_v > 0)) return {};
    const PreparedBrdf::Contents& contents = brdf.contents();
    if (contents.parts.albedo) {
        const float cosine = std::min(cos_v, 1.f), sine = std::sqrt(1 - cosine * cosine);
        Rgb mean;
        for (std::size_t turns = 0; turns < k_azimuths; ++turns) {
            const Rgb view_albedo = contents.parts.albedo(quarter_turns({sine, 0, cosine}, turns));
            for (int c = 0; c < 3; ++c) mean[c] += view_albedo[c] / float(k_azimuths);
        }
        return mean;
    }
    std::call_once(contents.has_albedo, [&] { contents.albedo = albedo_table(contents.parts.evaluate); });
    const float position = albedo_coordinate(std::min(cos_v, 1.f));
    const auto below = std::size_t(std::min(int(position), k_albedo_nodes - 2));
    const Rgb a = contents.albedo[below], b = contents.albedo[below + 1];
    const float fraction = position - float(below);
    Rgb interpolated;
    for (int c = 0; c < 3; ++c) interpolated[c] = a[c] + fraction * (b[c] - a[c]);
    return interpolated;
}

}  // namespace
