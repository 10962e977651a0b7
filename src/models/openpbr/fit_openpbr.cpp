#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "base/errors.h"
#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "models/openpbr/openpbr_functions.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/openpbr/openpbr_parameters.h"
#include "observe/large_errors.h"
#include "observe/pair_weights.h"
#include "observe/pixels.h"

namespace srbf {
namespace {

/// A parameter that fits vary, and of which surfaces. Colours are searched by their root, which is closer to visible
/// differences; x is the share of the parameter's range or of the root's. A start has a number drawn from a range of its own.
struct FittedParameter {
    std::string_view name;
    bool openpbr, gltf, principled;
    float least = 0, most = 0;  ///< of a start
    bool is_fitted(OpenPbrSurfaceKind kind) const {
        return kind == OpenPbrSurfaceKind::openpbr ? openpbr : kind == OpenPbrSurfaceKind::gltf ? gltf : principled;
    }
};
constexpr std::array<FittedParameter, 19> k_fitted_parameters{{
    // Starts have about the measurement's colour. base_weight is a factor of base_color, and coat_darkening one of what coat_color does.
    {"base_color", true, true, true},
    {"base_metalness", true, true, true, 0.02f, 0.98f},
    {"base_diffuse_roughness", true, false, true, 0.05f, 0.9f},
    // Elsewhere it changes a dielectric alone, as the index of refraction does.
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
    // Principled has no weight of a film.
    {"thin_film_weight", true, true, false, 0.2f, 0.9f},
    {"thin_film_thickness", true, true, false, 0.1f, 0.9f},
    {"thin_film_ior", true, true, false, 1.2f, 2.5f},
    {"specular_roughness_anisotropy", true, true, true, 0.02f, 0.9f},
    {"specular_rotation", true, true, true, 0.25f, 0.75f},  // half a turn, far from the bounds
}};
/// The last rows of the table: of a film, and of anisotropy.
constexpr std::span<const FittedParameter> k_film_rows = std::span(k_fitted_parameters).subspan(14, 3),
                                           k_anisotropy_rows = std::span(k_fitted_parameters).subspan(17);
const OpenPbrParameter& parameter_of(const FittedParameter& row) {
    return *std::ranges::find(k_openpbr_parameters, row.name, &OpenPbrParameter::name);
}

/// A number of the surface as a variable of the search.
struct OpenPbrVariable {
    const OpenPbrParameter* of;
    int c;
    float least;
};
/// No lobe is narrower than by `least_roughness` α, the square of a surface's roughness.
std::vector<OpenPbrVariable> openpbr_variables_of(OpenPbrSurfaceKind kind, double least_roughness) {
    std::vector<OpenPbrVariable> all;
    for (const FittedParameter& row : k_fitted_parameters) {
        if (!row.is_fitted(kind)) continue;
        const OpenPbrParameter& of = parameter_of(row);
        const bool is_of_lobe = row.name == "specular_roughness" || row.name == "coat_roughness";
        const float least = is_of_lobe ? std::min(float(std::sqrt(least_roughness)), of.most / 2) : of.least;
        for (int c = 0; c < of.count(); ++c) all.push_back({&of, c, std::max(of.least, least)});
    }
    return all;
}
/// A surface with the values of what it has no parameter for.
OpenPbrModel fixed_of(OpenPbrSurfaceKind kind) {
    OpenPbrModel model;
    if (kind != OpenPbrSurfaceKind::openpbr) model.coat_darkening = 0, model.coat_ior = 1.5f;
    return model;
}

constexpr double k_slope_step = 1e-3;  ///< of x, for differences

/// The data that a surface is fitted to, by the mean of ρ(ΔE_ITP) over pixels (see `Pixels`), or where no pictures are
/// observed by Σ w |f − f̂|² over pairs. The outputs of a surface are the colours of pixels, or its values at pairs.
class OpenPbrData {
  public:
    using Outputs = Aligned<float>;  ///< blocks of a column for each channel

    /// Takes every n-th view; without views, an n-th of the pairs, the first ones.
    OpenPbrData(const Observations& observations, std::size_t every) {
        if (observations.views.empty())
            take_pairs(observations, every);
        else
            take_views(observations, every);
    }

    static std::size_t place(std::size_t i, std::size_t c) { return (3 * (i / k_block) + c) * k_block + i % k_block; }
    std::size_t count() const { return pixels_.count() > 0 ? pixels_.count() : f_.size(); }

    void outputs(const OpenPbrModel& model, std::vector<Rgb>& f, Outputs& seen) const {
        f.resize(wl_.size());
        evaluate(model, wl_, wv_, f);
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
    double loss(const Outputs& seen, PixelSlopes& slopes) const {
        double sum = 0;
        if (pixels_.count() == 0) {
            for (std::size_t i = 0; i < f_.size(); ++i) sum += weight_[i] * squared_distance(f_[i], colour(seen, i));
            return sum;
        }
        for (std::size_t block = 0; block < pixels_.blocks(); ++block)
            sum += pixels_.errors(block, columns(seen, block), slopes);
        return sum / double(pixels_.count());
    }
    /// JᵀJ and Jᵀr, given the outputs and their derivatives.
    void linearise(const Outputs& seen, const std::vector<Outputs>& by, PixelSlopes& slopes, Eigen::MatrixXd& H,
                   Eigen::VectorXd& g) const {
        const auto n = Eigen::Index(by.size());
        H = Eigen::MatrixXd::Zero(n, n);
        g = Eigen::VectorXd::Zero(n);
        if (pixels_.count() == 0)
            add_pairs(seen, by, H, g);
        else
            add_pixels(seen, by, slopes, H, g);
    }

  private:
    struct Pixel {
        std::size_t first, count, weight;  // of the rows; the first of its weights
    };

    static Rgb colour(const Outputs& of, std::size_t i) { return {of[place(i, 0)], of[place(i, 1)], of[place(i, 2)]}; }
    static Pixels::Colours columns(const Outputs& of, std::size_t block) {
        const float* const first = &of[3 * block * k_block];
        return {first, first + k_block, first + 2 * k_block};
    }

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
        const std::size_t fitted = std::min(observations.fitted_count(), k_most_pairs / every);
        const auto end = [&](const auto& of) { return of.begin() + std::ptrdiff_t(fitted); };
        wl_.assign(observations.wl.begin(), end(observations.wl));
        wv_.assign(observations.wv.begin(), end(observations.wv));
        f_.assign(observations.f.begin(), end(observations.f));
        weight_.assign(observations.weight.begin(), end(observations.weight));
    }

    /// Adds a row of the Jacobian with its residual.
    static void add(const Eigen::VectorXd& row, double r, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        for (Eigen::Index i = 0; i < row.size(); ++i) {
            if (row[i] == 0) continue;
            g[i] += row[i] * r;
            for (Eigen::Index k = 0; k <= i; ++k) H(i, k) += row[i] * row[k];
        }
    }
    static void fill_upper(Eigen::MatrixXd& H) {
        for (Eigen::Index i = 0; i < H.rows(); ++i)
            for (Eigen::Index k = i + 1; k < H.cols(); ++k) H(i, k) = H(k, i);
    }
    void add_pairs(const Outputs& seen, const std::vector<Outputs>& by, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
        Eigen::VectorXd row(g.size());
        for (std::size_t i = 0; i < f_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const double root = std::sqrt(weight_[i]);
                for (std::size_t p = 0; p < by.size(); ++p) row[Eigen::Index(p)] = root * double(by[p][place(i, c)]);
                add(row, root * double(seen[place(i, c)] - f_[i][int(c)]), H, g);
            }
        fill_upper(H);
    }
    void add_pixels(const Outputs& seen, const std::vector<Outputs>& by, PixelSlopes& slopes, Eigen::MatrixXd& H,
                    Eigen::VectorXd& g) const {
        Eigen::VectorXd row(g.size());
        const double share = 1 / double(pixels_.count());
        for (std::size_t block = 0; block < pixels_.blocks(); ++block) {
            pixels_.errors(block, columns(seen, block), slopes);
            for (std::size_t i = block * k_block; i < std::min((block + 1) * k_block, pixels_.count()); ++i)
                for (std::size_t component = 0; component < 3; ++component) {
                    const auto by_channel = slopes.jacobian_of(component);
                    for (std::size_t p = 0; p < by.size(); ++p) {
                        double slope = 0;
                        for (std::size_t c = 0; c < 3; ++c)
                            slope += double(by_channel[c][i % k_block]) * double(by[p][place(i, c)]);
                        row[Eigen::Index(p)] = slope;
                    }
                    add(row, double(slopes.residual(component)[i % k_block]), H, g);
                }
        }
        fill_upper(H);
        H *= share, g *= share;
    }

    static constexpr std::size_t k_most_pairs = 16384;
    std::vector<Vec3f> wl_, wv_;
    std::vector<Pixel> pixel_;
    std::vector<float> light_;
    Pixels pixels_;
    std::vector<Rgb> f_;  // of pairs
    std::vector<double> weight_;
};

/// The loss as a function of the variables' x in [0, 1]; what is no variable stays as it is in `fixed`. Derivatives are
/// differences.
class OpenPbrProblem {
  public:
    OpenPbrProblem(const OpenPbrData& data, std::vector<OpenPbrVariable> variables, const OpenPbrModel& fixed)
        : data_(data), variables_(std::move(variables)), fixed_(fixed), by_(variables_.size()) {}

    OpenPbrModel model(const Eigen::VectorXd& x) const {
        OpenPbrModel model = fixed_;
        for (std::size_t i = 0; i < variables_.size(); ++i) {
            const auto [of, c, least] = variables_[i];
            const double at = x[Eigen::Index(i)];
            number(model, *of, c) = float(double(least) + (of->colour ? at * at : at) * double(of->most - least));
        }
        return model;
    }
    Eigen::VectorXd x_of(const OpenPbrModel& model) const {
        Eigen::VectorXd x(Eigen::Index(variables_.size()));
        for (std::size_t i = 0; i < variables_.size(); ++i) {
            const auto [of, c, least] = variables_[i];
            const double share = std::max(double(number(model, *of, c) - least) / double(of->most - least), 0.0);
            x[Eigen::Index(i)] = of->colour ? std::sqrt(share) : share;
        }
        return x;
    }

    double loss(const Eigen::VectorXd& x) { return loss(model(x)); }
    double loss(const OpenPbrModel& model) {
        data_.outputs(model, f_, seen_);
        return data_.loss(seen_, slopes_);
    }
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        for (std::size_t i = 0; i < variables_.size(); ++i) {
            Eigen::VectorXd moved = x;
            double& at = moved[Eigen::Index(i)];
            const double step = at + k_slope_step <= 1 ? k_slope_step : -k_slope_step;
            at += step;
            data_.outputs(model(moved), f_, by_[i]);
            for (std::size_t k = 0; k < by_[i].size(); ++k)
                by_[i][k] = float((double(by_[i][k]) - double(seen_[k])) / step);
        }
        data_.linearise(seen_, by_, slopes_, H, g);
    }
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Zero(x.size()); }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Ones(x.size()); }
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Constant(x.size(), 0.25); }

  private:
    const OpenPbrData& data_;
    std::vector<OpenPbrVariable> variables_;
    OpenPbrModel fixed_;
    std::vector<Rgb> f_;
    OpenPbrData::Outputs seen_;
    std::vector<OpenPbrData::Outputs> by_;
    PixelSlopes slopes_;
};

/// Diffuse reflection of about that colour: the albedo along the normal, or else π times the mean value.
Rgb typical_colour(const Observations& observations) {
    std::array<double, 3> sum{};
    double all = 0;
    if (!observations.integrals.empty()) {
        const ObservedIntegral& of = observations.integrals[0];
        for (std::size_t i = 0; i < of.wl.size(); ++i)
            for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += of.weight[i] * double(of.f[i][c]);
        all = 1;
    } else {
        for (std::size_t i = 0; i < observations.fitted_count(); ++i) {
            all += observations.weight[i];
            for (int c = 0; c < 3; ++c)
                sum[std::size_t(c)] += k_pi * observations.weight[i] * double(observations.f[i][c]);
        }
    }
    const auto share = [&](double x) { return float(std::clamp(all > 0 ? x / all : 0, 0.02, 0.95)); };
    return {share(sum[0]), share(sum[1]), share(sum[2])};
}

/// A surface that a search starts from. From one without a film, surfaces with one are not searched.
struct OpenPbrCandidate {
    OpenPbrModel model;
    double loss = 0;
    bool has_film() const { return model.thin_film_weight > 0; }
};

constexpr int k_drawn_starts = 2048;           ///< of which those with the least loss are searched from
constexpr std::uint64_t k_seed_of_starts = 1;  ///< of the random numbers of a fit, which are the same for all

/// Where the search may start: metals and dielectrics, from glossy to rough, without and with a coat; and drawn surfaces,
/// the same for every fit but for the colour, of which every fourth has a film if `with_film`.
std::vector<OpenPbrCandidate> openpbr_starts_of(const Observations& observations, bool with_film,
                                                bool with_anisotropy) {
    const Rgb colour = typical_colour(observations);
    std::vector<OpenPbrCandidate> starts;
    for (const float metalness : {0.f, 1.f})
        for (const float roughness : {0.2f, 0.5f})
            for (const float coat : {0.f, 0.5f}) {
                OpenPbrModel& start = starts.emplace_back().model;
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
    std::mt19937_64 random(k_seed_of_starts);
    const auto within = [&](float least, float most) {
        return least + (most - least) * float(double(random() >> 11) * 0x1p-53);
    };
    const auto draw = [&](OpenPbrModel& start, std::span<const FittedParameter> rows) {
        for (const FittedParameter& row : rows)
            for (int c = 0; row.most > 0 && c < parameter_of(row).count(); ++c)
                number(start, parameter_of(row), c) = within(row.least, row.most);
    };
    for (int i = 0; i < k_drawn_starts; ++i) {
        OpenPbrModel& start = starts.emplace_back().model;
        for (int c = 0; c < 3; ++c) start.base_color[c] = std::clamp(colour[c] * within(0.5f, 1.5f), 0.02f, 0.95f);
        start.fuzz_color = colour;
        draw(start, std::span(k_fitted_parameters).first<14>());
        if (i % 4 == 0 && with_film) draw(start, k_film_rows);
    }
    for (OpenPbrCandidate& start : starts)
        if (with_anisotropy) draw(start.model, k_anisotropy_rows);
    return starts;
}

/// The best surfaces under films, half of which are seen: the loss over the thickness has many minima.
constexpr std::size_t k_surfaces_under_films = 2;
std::vector<OpenPbrCandidate> under_films(std::span<const OpenPbrCandidate> best) {
    std::vector<OpenPbrCandidate> all;
    for (const OpenPbrCandidate& under : best.first(std::min(best.size(), k_surfaces_under_films)))
        for (const float thickness : {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.65f, 0.8f})
            for (const float ior : {1.3f, 1.7f, 2.3f}) {
                OpenPbrModel& model = all.emplace_back(under).model;
                model.thin_film_weight = 0.5f, model.thin_film_thickness = thickness, model.thin_film_ior = ior;
            }
    return all;
}

/// Rounds of the search: of how many candidates, on every so many views, with so many steps.
struct OpenPbrRound {
    std::size_t candidates, every;
    int steps;
};
constexpr std::array<OpenPbrRound, 3> k_openpbr_rounds{{{64, 10, 10}, {16, 5, 15}, {6, 2, 20}}};
constexpr std::array<OpenPbrRound, 3> k_film_rounds{{{64, 10, 10}, {8, 5, 15}, {3, 2, 20}}};
constexpr OpenPbrRound k_last_openpbr_round{2, 1, 40};
constexpr int k_weighed_rounds = 4;             ///< with weights adapted to errors, where no pictures are observed
constexpr double k_most_weight_change = 100;    ///< of these
constexpr int k_steps_without = 10;             ///< to adapt to a part that is dropped
constexpr double k_least_gain_of_parts = 0.01;  ///< of the loss, by which a part is kept
constexpr double k_unseen = 0.01;               ///< a loss of pixels, ΔE_ITP .1, for which no part is kept

/// Variables without those of these parameters.
std::vector<OpenPbrVariable> without(std::vector<OpenPbrVariable> variables, std::span<const std::string_view> names) {
    std::erase_if(variables, [&](const OpenPbrVariable& one) { return std::ranges::count(names, one.of->name) > 0; });
    return variables;
}
std::vector<std::string_view> names_of(std::span<const FittedParameter> rows) {
    std::vector<std::string_view> names;
    for (const FittedParameter& row : rows) names.push_back(row.name);
    return names;
}

/// A part of the surface that may be dropped: its variables, and a surface that has it at these numbers.
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
        {{"specular_ior"}, defaults},  // of a metal
    };
    for (const float metalness : {0.f, 1.f})
        parts.push_back({{"base_metalness"}, defaults}), parts.back().without.base_metalness = metalness;
    return parts;
}

/// A surface and what of it is searched.
struct OpenPbrFound {
    OpenPbrCandidate best;
    std::vector<OpenPbrVariable> variables;
};
/// Drops the parts without which the surface, adapted, is as good, or its loss at most `most_loss`.
void prune_parts(OpenPbrFound& found, const OpenPbrData& data, const OpenPbrModel& defaults, double most_loss) {
    for (const OpenPbrPart& part : openpbr_parts(defaults)) {
        OpenPbrModel less = found.best.model;
        for (const OpenPbrParameter& of : k_openpbr_parameters)
            for (int c = 0; std::ranges::count(part.names, of.name) > 0 && c < of.count(); ++c)
                number(less, of, c) = number(part.without, of, c);
        if (less == found.best.model) continue;
        const auto left = without(found.variables, part.names);
        OpenPbrProblem problem(data, left, less);
        Eigen::VectorXd x = problem.x_of(less);
        const double loss =
            levenberg_marquardt(problem, x, {.max_iterations = k_steps_without, .adapts_to_bounds = true}).loss;
        if (loss > std::max((1 + k_least_gain_of_parts) * found.best.loss, most_loss)) continue;
        found = {{problem.model(x), loss}, left};
    }
}

/// From many starts to the best surfaces.
class OpenPbrSearch {
  public:
    OpenPbrSearch(const Observations& observations, const OpenPbrRequest& request, const FitConditions& of,
                  const ProgressToken& progress)
        : observations_(observations),
          weighed_(observations),
          of_(of),
          progress_(progress),
          defaults_(fixed_of(request.surface)),
          all_(openpbr_variables_of(request.surface, observations.least_roughness)) {
        if (of.is_isotropic) all_ = without(all_, names_of(k_anisotropy_rows));
        all_but_film_ = without(all_, names_of(k_film_rows));
    }

    /// The best surface with the parts of it that are seen.
    Result<OpenPbrFound> found() {
        const bool with_film = all_.size() > all_but_film_.size();
        std::vector<OpenPbrCandidate> candidates = screened(with_film);
        if (const auto done = search(candidates, k_openpbr_rounds); !done) return done.error();
        if (with_film) {
            std::vector<OpenPbrCandidate> films = under_films(candidates);
            if (const auto done = search(films, k_film_rounds); !done) return done.error();
            candidates.insert(candidates.end(), films.begin(), films.end());
            std::ranges::stable_sort(candidates, {}, &OpenPbrCandidate::loss);
        }
        if (const auto done = search(candidates, {&k_last_openpbr_round, 1}); !done) return done.error();
        // As of Lambert and GGX: weights that hold for small errors are adapted to large ones.
        const bool is_weighed = observations_.views.empty() && traits(observations_.objective).response;
        for (int i = 0; i < k_weighed_rounds && is_weighed; ++i) {
            weighed_.weight = observations_.weight;
            weigh_large_errors(weighed_, evaluator(candidates[0].model), k_most_weight_change);
            if (const auto done = search(candidates, {&k_last_openpbr_round, 1}); !done) return done.error();
        }
        OpenPbrFound found{candidates[0], variables_of(candidates[0])};
        prune_parts(found, OpenPbrData(weighed_, 1), defaults_, observations_.views.empty() ? 0 : k_unseen);
        return found;
    }
    /// The data that were fitted to in the end.
    OpenPbrData data() const { return OpenPbrData(weighed_, 1); }

  private:
    const std::vector<OpenPbrVariable>& variables_of(const OpenPbrCandidate& candidate) const {
        return candidate.has_film() ? all_ : all_but_film_;
    }
    /// The starts with the least loss first.
    std::vector<OpenPbrCandidate> screened(bool with_film) const {
        std::vector<OpenPbrCandidate> starts = openpbr_starts_of(observations_, with_film, !of_.is_isotropic);
        const OpenPbrData data(weighed_, k_openpbr_rounds[0].every);
        parallel_for(starts.size(), of_.threads, [&](std::size_t i) {
            OpenPbrProblem problem(data, variables_of(starts[i]), defaults_);
            starts[i].model = problem.model(problem.x_of(starts[i].model));  // with what the surface lacks
            starts[i].loss = problem.loss(starts[i].model);
        });
        std::ranges::stable_sort(starts, {}, &OpenPbrCandidate::loss);
        return starts;
    }
    Result<Done> search(std::vector<OpenPbrCandidate>& candidates, std::span<const OpenPbrRound> rounds) {
        for (const OpenPbrRound& round : rounds) {
            if (!progress_.report("searching parameters", done_)) return cancelled_error("fit");
            const OpenPbrData data(weighed_, round.every);
            candidates.resize(std::min(candidates.size(), round.candidates));
            parallel_for(candidates.size(), of_.threads, [&](std::size_t i) {
                OpenPbrCandidate& candidate = candidates[i];
                OpenPbrProblem problem(data, variables_of(candidate), defaults_);
                Eigen::VectorXd x = problem.x_of(candidate.model);
                candidate.loss =
                    levenberg_marquardt(problem, x, {.max_iterations = round.steps, .adapts_to_bounds = true}).loss;
                candidate.model = problem.model(x);
            });
            std::ranges::stable_sort(candidates, {}, &OpenPbrCandidate::loss);
            done_ += 0.9 / double(k_openpbr_rounds.size() + k_film_rounds.size() + k_weighed_rounds);
        }
        return Done{};
    }

    const Observations& observations_;
    Observations weighed_;
    const FitConditions& of_;
    const ProgressToken& progress_;
    OpenPbrModel defaults_;
    std::vector<OpenPbrVariable> all_, all_but_film_;
    double done_ = 0;
};

}  // namespace

Result<Fitted<OpenPbrModel>> Kind<OpenPbrModel>::fit(const Observations& observations, const OpenPbrRequest& request,
                                                     const FitConditions& of, const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, openpbr_number_count(OpenPbrModel{})); !valid) return valid.error();
    OpenPbrSearch search(observations, request, of, progress);
    const auto found = search.found();
    if (!found) return found.error();
    const OpenPbrData data = search.data();
    OpenPbrProblem problem(data, found->variables, found->best.model);
    Fitted<OpenPbrModel> fit{{}, found->best.model, 0, problem.loss(found->best.model)};
    fit.model = rounded(fit.unrounded);
    fit.loss = problem.loss(fit.model);
    return fit;
}

}  // namespace srbf
