#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fit/fits.h"
#include "fit/objective/objective.h"
#include "fit/objective/pixels.h"
#include "fit/solve/least_squares.h"
#include "parallel.h"

namespace srbf {
namespace {

/// A parameter that fits vary, and of which surfaces. Colours are searched by their root, which is closer to what is
/// seen; x is the share of the parameter's range or of the root's.
struct FittedParameter {
    std::string_view name;
    bool openpbr, gltf, principled;
    bool is_fitted(PbrSurfaceKind kind) const {
        return kind == PbrSurfaceKind::openpbr ? openpbr : kind == PbrSurfaceKind::gltf ? gltf : principled;
    }
};
constexpr std::array<FittedParameter, 14> k_fitted_parameters{{
    // base_weight is a factor of base_color, and coat_darkening one of what coat_color does.
    {"base_color", true, true, true},
    {"base_metalness", true, true, true},
    {"base_diffuse_roughness", true, false, true},
    // Elsewhere it changes a dielectric alone, as the index of refraction does.
    {"specular_weight", true, false, false},
    {"specular_color", true, true, true},
    {"specular_roughness", true, true, true},
    {"specular_ior", true, true, true},
    {"coat_weight", true, true, true},
    {"coat_color", true, false, true},
    {"coat_roughness", true, true, true},
    {"coat_ior", true, false, true},
    {"fuzz_weight", true, true, true},
    {"fuzz_color", true, true, true},
    {"fuzz_roughness", true, true, true},
}};

/// A number of the surface as a variable of the search.
struct PbrVariable {
    const PbrParameter* of;
    int c;
};
std::vector<PbrVariable> pbr_variables_of(PbrSurfaceKind kind) {
    std::vector<PbrVariable> all;
    for (const FittedParameter& row : k_fitted_parameters) {
        if (!row.is_fitted(kind)) continue;
        const auto of = std::ranges::find(k_pbr_parameters, row.name, &PbrParameter::name);
        for (int c = 0; c < of->count(); ++c) all.push_back({&*of, c});
    }
    return all;
}
/// What a surface has where it has no parameter.
PbrModel fixed_of(PbrSurfaceKind kind) {
    PbrModel model;
    if (kind != PbrSurfaceKind::openpbr) model.coat_darkening = 0, model.coat_ior = 1.5f;
    return model;
}

constexpr double k_slope_step = 1e-3;  ///< of x, for differences

/// The sum that a fit minimises, as a function of the variables' x in [0, 1]: of pixels the mean of ρ(ΔE_ITP) (see
/// `Pixels`), or where no pictures are observed Σ w |f − f̂|². Derivatives are differences.
class PbrProblem {
  public:
    /// Of every so many views or pairs.
    PbrProblem(const Observations& observations, PbrSurfaceKind kind, std::size_t every, int threads)
        : variables_(pbr_variables_of(kind)), fixed_(fixed_of(kind)), threads_(threads) {
        if (observations.views.empty())
            take_pairs(observations, every);
        else
            take_views(observations, every);
    }

    PbrModel model(const Eigen::VectorXd& x) const {
        PbrModel model = fixed_;
        for (std::size_t i = 0; i < variables_.size(); ++i) {
            const PbrParameter& of = *variables_[i].of;
            const double at = x[Eigen::Index(i)];
            number(model, of, variables_[i].c) =
                float(double(of.least) + (of.colour ? at * at : at) * double(of.most - of.least));
        }
        return model;
    }
    Eigen::VectorXd x_of(const PbrModel& model) const {
        Eigen::VectorXd x(Eigen::Index(variables_.size()));
        for (std::size_t i = 0; i < variables_.size(); ++i) {
            const PbrParameter& of = *variables_[i].of;
            const double share = double(number(model, of, variables_[i].c) - of.least) / double(of.most - of.least);
            x[Eigen::Index(i)] = of.colour ? std::sqrt(share) : share;
        }
        return x;
    }

    double loss(const Eigen::VectorXd& x) { return loss(model(x)); }
    double loss(const PbrModel& model) {
        outputs(model, seen_, true);
        if (pixels_.count() == 0) {
            double sum = 0;
            for (std::size_t i = 0; i < f_.size(); ++i) sum += weight_[i] * squared_distance(f_[i], colour(seen_, i));
            return sum;
        }
        double sum = 0;
        for (std::size_t block = 0; block < pixels_.blocks(); ++block)
            sum += pixels_.errors(block, columns(seen_, block), slopes_);
        return sum / double(pixels_.count());
    }
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        const auto n = Eigen::Index(variables_.size());
        std::vector<Outputs> by(variables_.size());
        parallel_for(variables_.size(), threads_, [&](std::size_t i) {
            Eigen::VectorXd moved = x;
            double& at = moved[Eigen::Index(i)];
            const double step = at + k_slope_step <= 1 ? k_slope_step : -k_slope_step;
            at += step;
            outputs(model(moved), by[i], false);
            for (std::size_t k = 0; k < by[i].size(); ++k)
                by[i][k] = float((double(by[i][k]) - double(seen_[k])) / step);
        });
        H = Eigen::MatrixXd::Zero(n, n);
        g = Eigen::VectorXd::Zero(n);
        if (pixels_.count() == 0)
            add_pairs(by, H, g);
        else
            add_pixels(by, H, g);
    }
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Zero(x.size()); }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Ones(x.size()); }
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Constant(x.size(), 0.25); }

  private:
    /// Of pixels, or of pairs: blocks of a column for each channel.
    using Outputs = Aligned<float>;
    struct Pixel {
        std::size_t first, count, weight;  // of the rows; the first of its weights
    };

    static std::size_t place(std::size_t i, std::size_t c) { return (3 * (i / k_block) + c) * k_block + i % k_block; }
    static Rgb colour(const Outputs& of, std::size_t i) { return {of[place(i, 0)], of[place(i, 1)], of[place(i, 2)]}; }
    static Pixels::Colours columns(const Outputs& of, std::size_t block) {
        const float* const first = &of[3 * block * k_block];
        return {first, first + k_block, first + 2 * k_block};
    }
    std::size_t count() const { return pixels_.count() > 0 ? pixels_.count() : f_.size(); }

    void take_views(const Observations& observations, std::size_t every) {
        std::vector<Pixels::Triplet> reference;
        for (std::size_t v = 0; v < observations.views.size(); v += every) {
            const ObservedView& view = observations.views[v];
            for (const ObservedPixel& pixel : view.pixels) {
                pixel_.push_back({wl_.size() + pixel.first, pixel.weight.size(), light_.size()});
                light_.insert(light_.end(), pixel.weight.begin(), pixel.weight.end());
                Pixels::Triplet sum{};
                for (std::size_t i = 0; i < pixel.weight.size(); ++i)
                    for (int c = 0; c < 3; ++c)
                        sum[std::size_t(c)] += double(pixel.weight[i]) * double(view.f[pixel.first + i][c]);
                reference.push_back(sum);
            }
            wl_.insert(wl_.end(), view.wl.begin(), view.wl.end());
            wv_.insert(wv_.end(), view.wl.size(), view.wv);
        }
        pixels_ = Pixels(reference);
    }
    void take_pairs(const Observations& observations, std::size_t every) {
        const std::size_t fitted = std::min(observations.fitted(), k_most_pairs / every);
        const auto end = [&](const auto& of) { return of.begin() + std::ptrdiff_t(fitted); };
        wl_.assign(observations.wl.begin(), end(observations.wl));
        wv_.assign(observations.wv.begin(), end(observations.wv));
        f_.assign(observations.f.begin(), end(observations.f));
        weight_.assign(observations.weight.begin(), end(observations.weight));
    }

    void outputs(const PbrModel& model, Outputs& seen, bool parallel) const {
        std::vector<Rgb> f(wl_.size());
        const auto part = [&](std::size_t begin, std::size_t end) {
            const std::span wl(wl_), wv(wv_);
            evaluate(model, wl.subspan(begin, end - begin), wv.subspan(begin, end - begin),
                     std::span(f).subspan(begin, end - begin));
        };
        if (parallel)
            parallel_for_parts(wl_.size(), k_rows_at_once, threads_, part);
        else
            part(0, wl_.size());
        seen.assign(3 * k_block * blocks_for(count()), 0);
        for (std::size_t i = 0; i < count(); ++i) {
            std::array<double, 3> sum{};
            if (f_.size() > 0) {
                for (int c = 0; c < 3; ++c) sum[std::size_t(c)] = double(f[i][c]);
            } else {
                const Pixel& pixel = pixel_[i];
                for (std::size_t k = 0; k < pixel.count; ++k)
                    for (int c = 0; c < 3; ++c)
                        sum[std::size_t(c)] += double(light_[pixel.weight + k]) * double(f[pixel.first + k][c]);
            }
            for (std::size_t c = 0; c < 3; ++c) seen[place(i, c)] = float(sum[c]);
        }
    }
    /// Adds a row of the Jacobian with its residual.
    static void add(const Eigen::VectorXd& row, double r, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        for (Eigen::Index i = 0; i < row.size(); ++i) {
            if (row[i] == 0) continue;
            g[i] += row[i] * r;
            for (Eigen::Index k = 0; k < row.size(); ++k) H(i, k) += row[i] * row[k];
        }
    }
    void add_pairs(const std::vector<Outputs>& by, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
        Eigen::VectorXd row(g.size());
        for (std::size_t i = 0; i < f_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const double root = std::sqrt(weight_[i]);
                for (std::size_t p = 0; p < by.size(); ++p) row[Eigen::Index(p)] = root * double(by[p][place(i, c)]);
                add(row, root * double(seen_[place(i, c)] - f_[i][int(c)]), H, g);
            }
    }
    void add_pixels(const std::vector<Outputs>& by, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        Eigen::VectorXd row(g.size());
        const double share = 1 / double(pixels_.count());
        for (std::size_t block = 0; block < pixels_.blocks(); ++block) {
            pixels_.errors(block, columns(seen_, block), slopes_);
            for (std::size_t i = block * k_block; i < std::min((block + 1) * k_block, pixels_.count()); ++i)
                for (std::size_t component = 0; component < 3; ++component) {
                    const auto by_channel = slopes_.by(component);
                    for (std::size_t p = 0; p < by.size(); ++p) {
                        double slope = 0;
                        for (std::size_t c = 0; c < 3; ++c)
                            slope += double(by_channel[c][i % k_block]) * double(by[p][place(i, c)]);
                        row[Eigen::Index(p)] = slope;
                    }
                    add(row, double(slopes_.of(component)[i % k_block]), H, g);
                }
        }
        H *= share, g *= share;
    }

    static constexpr std::size_t k_most_pairs = 16384, k_rows_at_once = 1024;
    std::vector<PbrVariable> variables_;
    PbrModel fixed_;
    int threads_;
    std::vector<Vec3f> wl_, wv_;
    std::vector<Pixel> pixel_;
    std::vector<float> light_;
    Pixels pixels_;
    std::vector<Rgb> f_;  // of pairs
    std::vector<double> weight_;
    Outputs seen_;
    PixelSlopes slopes_;
};

/// Diffuse reflection of about that colour: the albedo along the normal, or else π times the mean value.
Rgb typical_colour(const Observations& observations) {
    std::array<double, 3> sum{};
    double all = 0;
    if (!observations.radiances.empty()) {
        const RadianceObservation& of = observations.radiances[0];
        for (std::size_t i = 0; i < of.wl.size(); ++i)
            for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += of.weight[i] * double(of.f[i][c]);
        all = 1;
    } else {
        for (std::size_t i = 0; i < observations.fitted(); ++i) {
            all += observations.weight[i];
            for (int c = 0; c < 3; ++c)
                sum[std::size_t(c)] += k_pi * observations.weight[i] * double(observations.f[i][c]);
        }
    }
    const auto share = [&](double x) { return float(std::clamp(all > 0 ? x / all : 0, 0.02, 0.95)); };
    return {share(sum[0]), share(sum[1]), share(sum[2])};
}

/// Where the search starts: metals and dielectrics, from glossy to rough, without and with a coat.
std::vector<PbrModel> pbr_starts_of(const Observations& observations) {
    const Rgb colour = typical_colour(observations);
    std::vector<PbrModel> starts;
    for (const float metalness : {0.f, 1.f})
        for (const float roughness : {0.2f, 0.5f})
            for (const float coat : {0.f, 0.5f}) {
                PbrModel& start = starts.emplace_back();
                start.base_color = colour;
                start.base_metalness = 0.05f + 0.9f * metalness;  // within the bounds all parameters have slopes
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
    return starts;
}

/// Rounds of the search: of how many candidates, on every so many views, with so many steps.
struct PbrRound {
    std::size_t candidates, every;
    int steps;
};
constexpr std::array<PbrRound, 3> k_pbr_rounds{{{8, 10, 8}, {3, 5, 15}, {1, 1, 15}}};
constexpr int k_weighed_rounds = 4;           ///< with weights adapted to errors, where no pictures are observed
constexpr double k_most_weight_change = 100;  ///< of these
constexpr double k_least_gain = 0.01;         ///< of the loss, by which a part is kept

/// Sets parts to their defaults that the surface does as well without.
void drop_unused(PbrProblem& problem, PbrModel& model, const PbrModel& defaults) {
    const auto attempt = [&](const PbrModel& less) {
        if (less == model || problem.loss(less) > (1 + k_least_gain) * problem.loss(model)) return;
        model = less;
    };
    PbrModel less = model;
    less.fuzz_weight = 0, less.fuzz_color = defaults.fuzz_color, less.fuzz_roughness = defaults.fuzz_roughness;
    attempt(less);
    less = model;
    less.coat_weight = 0, less.coat_color = defaults.coat_color, less.coat_roughness = defaults.coat_roughness;
    less.coat_ior = defaults.coat_ior;
    attempt(less);
    for (const float metalness : {0.f, 1.f}) {
        less = model;
        less.base_metalness = metalness;
        attempt(less);
    }
    less = model;
    less.base_diffuse_roughness = 0;
    attempt(less);
}

struct PbrCandidate {
    PbrModel model;
    double loss;
};

}  // namespace

Result<PbrFit> fit_pbr(const Observations& observations, const PbrFitOptions& options, const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, pbr_number_count()); !valid) return valid.error();
    Observations weighed = observations;
    std::vector<PbrCandidate> candidates;
    for (const PbrModel& start : pbr_starts_of(observations)) candidates.push_back({start, 0});
    double done = 0;
    const auto search = [&](const PbrRound& round) -> Result<Done> {
        PbrProblem problem(weighed, options.surface, round.every, options.threads);
        candidates.resize(std::min(candidates.size(), round.candidates));
        for (PbrCandidate& candidate : candidates) {
            if (!progress.report("searching parameters", done)) return cancelled_error("fit");
            Eigen::VectorXd x = problem.x_of(candidate.model);
            candidate.loss =
                levenberg_marquardt(problem, x, {.max_iterations = round.steps, .adapts_to_bounds = true}).loss;
            candidate.model = problem.model(x);
            done += 0.9 / double(k_pbr_rounds.size() + k_weighed_rounds) / double(candidates.size());
        }
        std::ranges::stable_sort(candidates, {}, &PbrCandidate::loss);
        return Done{};
    };
    for (const PbrRound& round : k_pbr_rounds)
        if (const auto found = search(round); !found) return found.error();
    // As of Lambert and GGX: weights that hold for small errors are adapted to large ones.
    for (int i = 0; i < k_weighed_rounds && observations.views.empty() && traits(observations.objective).seen; ++i) {
        weighed.weight = observations.weight;
        weigh_large_errors(weighed, evaluator(candidates[0].model), k_most_weight_change);
        if (const auto found = search(k_pbr_rounds.back()); !found) return found.error();
    }
    PbrProblem problem(weighed, options.surface, 1, options.threads);
    PbrFit fit{{}, candidates[0].model, 0, 0};
    drop_unused(problem, fit.unrounded, fixed_of(options.surface));
    fit.unrounded_loss = problem.loss(fit.unrounded);
    fit.model = rounded(fit.unrounded);
    fit.loss = problem.loss(fit.model);
    return fit;
}

}  // namespace srbf
