#include "base/parallel.h"
#include "brdf/colour.h"
#include "extras/environment/lobe_tracks.h"
#include "srbf/extended_light.h"

namespace SRBF_NAMESPACE {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The light that a view reflects by each lobe of a model with coefficient 1.
struct LobesOfView {
    VectorXd albedo, width;  ///< J; widths as of ExtendedLight
    MatrixXd radiance;       ///< lights × J
};
/// Three lobes of a model as the channels of a BRDF.
PreparedBrdf three_lobes(PmModel model, std::size_t first) {
    std::ranges::fill(model.coefficient, Rgb{});
    for (std::size_t j = first; j < std::min(first + 3, model.coefficient.size()); ++j)
        model.coefficient[j][int(j - first)] = 1;
    return prepare(Model{std::move(model), {}});
}
/// Adds three lobes, of which the last ones may be missing.
void add_lobes(const LitView& view, const AveragedBrdf& three, Eigen::Index first, LobesOfView& to) {
    const Vec3f wv = to_float(view.wv);
    const std::vector<Reflected> reflected = sample_reflected(three, wv);
    const Rgb total = albedo(three.brdf(), wv.z);
    Eigen::Array3d largest = Eigen::Array3d::Constant(1e-9);
    for (const auto& [w, weight, density] : reflected)
        largest = largest.max(k_view_samples * density * Eigen::Array3d(weight.x, weight.y, weight.z));
    const Eigen::Index count = std::min<Eigen::Index>(3, to.albedo.size() - first);
    for (Eigen::Index c = 0; c < count; ++c) {
        to.albedo[first + c] = double(total[int(c)]);
        to.width[first + c] = to.albedo[first + c] / largest[c];
    }
    to.radiance.middleCols(first, count) = radiances_of(view, three, reflected).leftCols(count);
}

/// The view's errors for three lobes from `first` on, as if each were all that a typical material reflects: with its
/// albedo, and relative to its radiance `typical`.
void set_lobes(LitView& view, const LobesOfView& lobes, Eigen::Index first, const VectorXd& coefficient) {
    const double total = coefficient.dot(lobes.albedo);
    const VectorXd lit = (lobes.radiance * coefficient).array() + k_ambient * total;
    view.albedo = {float(total), float(total), float(total)};
    for (Eigen::Index c = 0; c < 3; ++c) {
        const Eigen::Index j = std::min(first + c, lobes.albedo.size() - 1);
        for (Eigen::Index i = 0; i < lit.size(); ++i)
            view.weight(i, c) = view.lights[std::size_t(i)].root_weight / std::max(lit[i], 1e-9);
        view.radiance.col(c) =
            total / std::max(lobes.albedo[j], 1e-9) * view.weight.col(c).cwiseProduct(lobes.radiance.col(j));
    }
}

}  // namespace

SharedLight shared_light(const PmModel& model, const ExtendedLightOptions& options) {
    const BlurredKernels kernels(options.levels, options.threads);
    const auto J = Eigen::Index(model.coefficient.size()), others = Eigen::Index(options.lobes - 1);
    std::vector<PreparedBrdf> threes;
    for (Eigen::Index j = 0; j < J; j += 3) threes.push_back(three_lobes(model, std::size_t(j)));
    const PreparedBrdf typical = prepare(Model{model, {}});
    std::vector<LitView> views(ExtendedLight::k_views);
    std::vector<LobesOfView> lobes(views.size());
    parallel_for(views.size(), options.threads, [&](std::size_t v) {
        const AveragedBrdf averaged(typical, options.isotropic);
        views[v] = lit_view(averaged, fitted_cosine(v));
        lobes[v] = {VectorXd(J), VectorXd(J), MatrixXd(Eigen::Index(views[v].lights.size()), J)};
        for (Eigen::Index j = 0; j < J; j += 3)
            add_lobes(views[v], {threes[std::size_t(j / 3)], options.isotropic}, j, lobes[v]);
    });
    // A map of one material has the axes and roughnesses of that material alone.
    const LobeTracks tracks(views, kernels, options.lobes, options.fixed, options.threads);

    SharedLight light{options.lobes, {}, {}, {}};
    light.weight.resize(views.size() * std::size_t(others * J));
    VectorXd coefficient(J);
    for (Eigen::Index j = 0; j < J; ++j) coefficient[j] = double(luminance(model.coefficient[std::size_t(j)]));
    for (Eigen::Index first = 0; first < J; first += 3) {
        for (std::size_t v = 0; v < views.size(); ++v) set_lobes(views[v], lobes[v], first, coefficient);
        const MatrixXd fractions = fractions_of(views, kernels, tracks);
        for (Eigen::Index i = 0; i < fractions.rows(); ++i)
            for (Eigen::Index j = first; j < std::min(first + 3, J); ++j)
                light.weight[std::size_t(i * J + j)] =
                    float(fractions(i, j - first) * lobes[std::size_t(i / others)].albedo[j]);
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
        light.width.push_back(float(lobes[v].width.minCoeff()));
        for (Eigen::Index k = 0; k < others; ++k)
            light.shape.push_back({float(tracks[v][2 * k]), float(tracks[v][2 * k + 1])});
    }
    return light;
}

}  // namespace
