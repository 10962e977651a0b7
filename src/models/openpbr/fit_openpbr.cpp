#include "base/errors.h"
#include "brdf/directions.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/openpbr/openpbr_parameters.h"
#include "observe/number_variables.h"
#include "observe/pair_weights.h"
#include "observe/surface_problem.h"

namespace SRBF_NAMESPACE {
namespace {

/// A parameter that fits vary, and the kinds of surface that have it.
struct FittedParameter {
    std::string_view name;
    bool openpbr, gltf, principled;
    float min = 0, max = 0;  ///< range of the random numbers of initial surfaces
    bool is_fitted(OpenPbrSurfaceKind kind) const {
        return kind == OpenPbrSurfaceKind::openpbr ? openpbr : kind == OpenPbrSurfaceKind::gltf ? gltf : principled;
    }
};
constexpr std::array<FittedParameter, 19> k_fitted_parameters{{
    // Initial surfaces have about the measurement's colour. base_weight only scales base_color, and coat_darkening only
    // scales an effect of coat_color, so that neither is fitted.
    {"base_color", true, true, true},
    {"base_metalness", true, true, true, 0.02f, 0.98f},
    {"base_diffuse_roughness", true, false, true, 0.05f, 0.9f},
    // In glTF and Principled it changes only dielectrics, as the index of refraction does.
    {"specular_weight", true, false, false, 0.2f, 0.95f},
    {"specular_color", true, true, true, 0.3f, 0.95f},
    {"specular_roughness", true, true, true, 0.03f, 0.85f},
    {"specular_ior", true, true, true, 1.1f, 2.9f},
    {"coat_weight", true, true, true, 0.02f, 0.98f},
    {"coat_color", true, false, true, 0.3f, 0.95f},
    {"coat_roughness", true, true, true, 0.02f, 0.7f},
    {"coat_ior", true, false, true, 1.1f, 2.9f},
    {"fuzz_weight", true, true, true, 0.01f, 0.4f},
    {"fuzz_color", true, true, true},
    {"fuzz_roughness", true, true, true, 0.1f, 0.95f},
    // Principled has no weight of the film.
    {"thin_film_weight", true, true, false, 0.2f, 0.9f},
    {"thin_film_thickness", true, true, false, 0.1f, 0.9f},
    {"thin_film_ior", true, true, false, 1.2f, 2.5f},
    {"specular_roughness_anisotropy", true, true, true, 0.02f, 0.9f},
    {"specular_rotation", true, true, true, 0.25f, 0.75f},  // half a turn, far from the bounds
}};
/// Rows of the table: rows of all surfaces, rows of the film, and rows of anisotropy.
constexpr std::span<const FittedParameter> k_common_rows = std::span(k_fitted_parameters).first(14),
                                           k_film_rows = std::span(k_fitted_parameters).subspan(14, 3),
                                           k_anisotropy_rows = std::span(k_fitted_parameters).subspan(17);
const OpenPbrParameter& parameter_of(const FittedParameter& row) {
    return *std::ranges::find(k_openpbr_parameters, row.name, &OpenPbrParameter::name);
}

using OpenPbrVariable = NumberVariable<OpenPbrModel>;
using OpenPbrVariables = NumberVariables<OpenPbrModel>;
/// `min_roughness` is the least α of lobes, the square of a surface's roughness.
std::vector<OpenPbrVariable> make_variables(OpenPbrSurfaceKind kind, double min_roughness) {
    std::vector<OpenPbrVariable> all;
    for (const FittedParameter& row : k_fitted_parameters) {
        if (!row.is_fitted(kind)) continue;
        const OpenPbrParameter& parameter = parameter_of(row);
        const bool is_lobe = row.name == "specular_roughness" || row.name == "coat_roughness";
        const float min = is_lobe ? std::min(float(std::sqrt(min_roughness)), parameter.max / 2) : parameter.min;
        for (int c = 0; c < parameter.count(); ++c) all.push_back({&parameter, c, std::max(parameter.min, min)});
    }
    return all;
}
/// A surface with default values, also for the parameters that its kind lacks.
OpenPbrModel default_surface(OpenPbrSurfaceKind kind) {
    OpenPbrModel model;
    if (kind != OpenPbrSurfaceKind::openpbr) model.coat_darkening = 0, model.coat_ior = 1.5f;
    return model;
}

using OpenPbrProblem = SurfaceProblem<OpenPbrVariables>;

/// An approximate diffuse colour: the albedo along the normal if it was observed, otherwise π times the mean value.
Rgb typical_colour(const Observations& observations) {
    std::array<double, 3> sum{};
    double total = 0;
    if (!observations.integrals.empty()) {
        const ObservedIntegral& albedo = observations.integrals[0];
        for (std::size_t i = 0; i < albedo.wl.size(); ++i)
            for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += albedo.weight[i] * double(albedo.f[i][c]);
        total = 1;
    } else {
        for (std::size_t i = 0; i < observations.fitted_count(); ++i) {
            total += observations.weight[i];
            for (int c = 0; c < 3; ++c)
                sum[std::size_t(c)] += k_pi * observations.weight[i] * double(observations.f[i][c]);
        }
    }
    const auto fraction = [&](double x) { return float(std::clamp(total > 0 ? x / total : 0, 0.02, 0.95)); };
    return {fraction(sum[0]), fraction(sum[1]), fraction(sum[2])};
}

using OpenPbrCandidate = SurfaceCandidate<OpenPbrModel>;

constexpr int k_random_surfaces = 2048;
constexpr std::uint64_t k_surface_seed = 1;  ///< all fits use the same random numbers

/// Initial surfaces: glossy and rough metals and dielectrics, without and with a coat, and random surfaces. The latter
/// are the same for every fit except for the colour. If `with_film`, every fourth of them has a film.
std::vector<OpenPbrCandidate> initial_surfaces(const Observations& observations, bool with_film, bool with_anisotropy) {
    const Rgb colour = typical_colour(observations);
    std::vector<OpenPbrCandidate> starts;
    for (const float metalness : {0.f, 1.f})
        for (const float roughness : {0.2f, 0.5f})
            for (const float coat : {0.f, 0.5f}) {
                OpenPbrModel& start = starts.emplace_back().model;
                start.base_color = colour;
                start.base_metalness = 0.05f + 0.9f * metalness;  // no derivative vanishes between the bounds
                start.base_diffuse_roughness = 0.2f;
                start.specular_weight = 0.9f;
                start.specular_color = {0.9f, 0.9f, 0.9f};
                start.specular_roughness = roughness;
                start.coat_weight = 0.02f + coat;
                start.coat_color = {0.9f, 0.9f, 0.9f};
                start.coat_roughness = 0.15f;
                start.fuzz_weight = 0.05f;
                start.fuzz_color = colour;
            }
    std::mt19937_64 random(k_surface_seed);
    const auto uniform_in = [&](float min, float max) { return min + (max - min) * float(uniform(random)); };
    const auto draw = [&](OpenPbrModel& start, std::span<const FittedParameter> rows) {
        for (const FittedParameter& row : rows)
            for (int c = 0; row.max > 0 && c < parameter_of(row).count(); ++c)
                number(start, parameter_of(row), c) = uniform_in(row.min, row.max);
    };
    for (int i = 0; i < k_random_surfaces; ++i) {
        OpenPbrModel& start = starts.emplace_back().model;
        for (int c = 0; c < 3; ++c) start.base_color[c] = std::clamp(colour[c] * uniform_in(0.5f, 1.5f), 0.02f, 0.95f);
        start.fuzz_color = colour;
        draw(start, k_common_rows);
        if (i % 4 == 0 && with_film) draw(start, k_film_rows);
    }
    for (OpenPbrCandidate& start : starts)
        if (with_anisotropy) draw(start.model, k_anisotropy_rows);
    return starts;
}

/// The best surfaces with films of weight ½. The loss has many minima in the thickness, so that many are tried.
constexpr std::size_t k_surfaces_with_films = 2;
std::vector<OpenPbrCandidate> add_films(std::span<const OpenPbrCandidate> best) {
    std::vector<OpenPbrCandidate> all;
    for (const OpenPbrCandidate& base : best.first(std::min(best.size(), k_surfaces_with_films)))
        for (const float thickness : {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.65f, 0.8f})
            for (const float ior : {1.3f, 1.7f, 2.3f}) {
                OpenPbrModel& model = all.emplace_back(base).model;
                model.thin_film_weight = 0.5f;
                model.thin_film_thickness = thickness;
                model.thin_film_ior = ior;
            }
    return all;
}

constexpr std::array<SurfaceRound, 4> k_openpbr_rounds{{{4096, 10, 0}, {64, 10, 10}, {16, 5, 15}, {6, 2, 20}}};
constexpr std::array<SurfaceRound, 3> k_film_rounds{{{64, 10, 10}, {8, 5, 15}, {3, 2, 20}}};
constexpr SurfaceRound k_last_openpbr_round{2, 1, 40};
constexpr int k_reweighting_rounds = 4;      ///< rounds with weights adapted to errors, if no pictures are observed
constexpr double k_max_weight_change = 100;  ///< the largest factor by which weights adapt
constexpr int k_pruning_steps = 10;          ///< steps with which the surface adapts to the loss of a part
constexpr double k_min_part_gain = 0.01;     ///< a part is kept if it lowers the loss by a larger fraction
constexpr double k_invisible_loss = 0.01;    ///< no part is kept if the loss of pixels is below this (ΔE_ITP 0.1)

/// Variables without the variables of the named parameters.
std::vector<OpenPbrVariable> without(std::vector<OpenPbrVariable> variables, std::span<const std::string_view> names) {
    std::erase_if(variables, [&](const OpenPbrVariable& x) { return std::ranges::count(names, x.member->name) > 0; });
    return variables;
}
std::vector<std::string_view> names_of(std::span<const FittedParameter> rows) {
    std::vector<std::string_view> names;
    for (const FittedParameter& row : rows) names.push_back(row.name);
    return names;
}

/// A part of the surface that may be removed: its parameters, and a surface with their values without the part.
struct OpenPbrPart {
    std::vector<std::string_view> names;
    OpenPbrModel without;
};
std::vector<OpenPbrPart> openpbr_parts(const OpenPbrModel& defaults) {
    std::vector<OpenPbrPart> parts{
        {names_of(k_film_rows), defaults},
        {names_of(k_anisotropy_rows), defaults},
        {{"fuzz_weight", "fuzz_color", "fuzz_roughness"}, defaults},
        {{"coat_weight", "coat_color", "coat_roughness", "coat_ior"}, defaults},
        {{"base_diffuse_roughness"}, defaults},
        {{"specular_color"}, defaults},
        {{"coat_color"}, defaults},
        {{"specular_weight"}, defaults},
        {{"specular_ior"}, defaults},  // unused by metals
    };
    for (const float metalness : {0.f, 1.f})
        parts.push_back({{"base_metalness"}, defaults}), parts.back().without.base_metalness = metalness;
    return parts;
}

/// The result of a search, and the variables of its surface.
struct OpenPbrSolution {
    OpenPbrCandidate best;
    std::vector<OpenPbrVariable> variables;
};
/// Removes the parts without which the surface, once adapted, has at most 1.01 times its loss, or at most `max_loss`.
void prune_parts(OpenPbrSolution& solution, const SurfaceData& data, const OpenPbrModel& defaults, double max_loss) {
    for (const OpenPbrPart& part : openpbr_parts(defaults)) {
        OpenPbrModel pruned = solution.best.model;
        for (const OpenPbrParameter& parameter : k_openpbr_parameters)
            for (int c = 0; std::ranges::count(part.names, parameter.name) > 0 && c < parameter.count(); ++c)
                number(pruned, parameter, c) = number(part.without, parameter, c);
        if (pruned == solution.best.model) continue;
        const auto variables = without(solution.variables, part.names);
        OpenPbrProblem problem(data, {variables, pruned});
        Eigen::VectorXd x = problem.x_of(pruned);
        const double loss =
            levenberg_marquardt(problem, x, {.max_iterations = k_pruning_steps, .adapts_to_bounds = true}).loss;
        if (loss > std::max((1 + k_min_part_gain) * solution.best.loss, max_loss)) continue;
        solution = {{problem.model(x), loss}, variables};
    }
}

/// Searches for the best surface from many initial ones.
class OpenPbrSearch {
  public:
    OpenPbrSearch(const Observations& observations, const OpenPbrRequest& request, const FitConditions& conditions,
                  const ProgressToken& progress)
        : observations_(observations),
          weighed_(observations),
          conditions_(conditions),
          progress_(progress),
          defaults_(default_surface(request.surface)),
          all_(make_variables(request.surface, observations.min_roughness)) {
        if (conditions.is_isotropic) all_ = without(all_, names_of(k_anisotropy_rows));
        if (observations.is_grey()) {  // a film is coloured
            all_ = without(all_, names_of(k_film_rows));
            std::erase_if(all_, [](const OpenPbrVariable& x) { return x.channel > 0; });
        }
        all_but_film_ = without(all_, names_of(k_film_rows));
    }

    /// The best surface, without the parts that it does not need.
    Result<OpenPbrSolution> solve() {
        const bool with_film = all_.size() > all_but_film_.size();
        std::vector<OpenPbrCandidate> candidates =
            initial_surfaces(observations_, with_film, !conditions_.is_isotropic);
        if (const auto done = search(candidates, k_openpbr_rounds); !done) return done.error();
        if (with_film) {
            std::vector<OpenPbrCandidate> films = add_films(candidates);
            if (const auto done = search(films, k_film_rounds); !done) return done.error();
            candidates.insert(candidates.end(), films.begin(), films.end());
            std::ranges::stable_sort(candidates, {}, &OpenPbrCandidate::loss);
        }
        if (const auto done = search(candidates, {&k_last_openpbr_round, 1}); !done) return done.error();
        const bool adapts_weights = observations_.views.empty() && traits(observations_.objective).response;
        for (int i = 0; i < k_reweighting_rounds && adapts_weights; ++i) {
            weighed_.weight = observations_.weight;
            weigh_large_errors(weighed_, evaluator(candidates[0].model), k_max_weight_change);
            if (const auto done = search(candidates, {&k_last_openpbr_round, 1}); !done) return done.error();
        }
        OpenPbrSolution solution{candidates[0], parameters_of(candidates[0].model)};
        prune_parts(solution, data(), defaults_, observations_.views.empty() ? 0 : k_invisible_loss);
        return solution;
    }
    /// The data of the last round.
    SurfaceData data() const { return SurfaceData(weighed_, 1); }

  private:
    /// The parameters of a film are searched only if the surface has one.
    const std::vector<OpenPbrVariable>& parameters_of(const OpenPbrModel& surface) const {
        return surface.thin_film_weight > 0 ? all_ : all_but_film_;
    }
    Result<Done> search(std::vector<OpenPbrCandidate>& candidates, std::span<const SurfaceRound> rounds) {
        const auto variables_of = [&](const OpenPbrModel& surface) {
            return OpenPbrVariables{parameters_of(surface), defaults_};  // defaults where its kind lacks parameters
        };
        for (const SurfaceRound& round : rounds) {
            if (!progress_.report("searching parameters", done_)) return cancelled_error("fit");
            refine_candidates(candidates, round, SurfaceData(weighed_, round.subsampling), variables_of,
                              conditions_.threads);
            done_ += 0.9 / double(k_openpbr_rounds.size() + k_film_rounds.size() + k_reweighting_rounds);
        }
        return Done{};
    }

    const Observations& observations_;
    Observations weighed_;
    const FitConditions& conditions_;
    const ProgressToken& progress_;
    OpenPbrModel defaults_;
    std::vector<OpenPbrVariable> all_, all_but_film_;
    double done_ = 0;
};

}  // namespace

Result<Fitted<OpenPbrModel>> Kind<OpenPbrModel>::fit(const Observations& observations, const OpenPbrRequest& request,
                                                     const FitConditions& conditions, const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, number_count(OpenPbrModel{})); !valid) return valid.error();
    OpenPbrSearch search(observations, request, conditions, progress);
    const auto solution = search.solve();
    if (!solution) return solution.error();
    const SurfaceData data = search.data();
    OpenPbrProblem problem(data, {solution->variables, solution->best.model});
    Fitted<OpenPbrModel> fit{{}, solution->best.model, 0, problem.loss(solution->best.model)};
    fit.model = rounded(fit.unrounded);
    fit.loss = problem.loss(fit.model);
    return fit;
}

}  // namespace
