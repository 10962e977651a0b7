#include "srbf/extended_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "albedo_nodes.h"
#include "fit/solve/least_squares.h"
#include "parallel.h"
#include "r_sequence.h"
#include "srbf/colour.h"

namespace srbf {
namespace {

using Lobe = ExtendedLight::Lobe;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// 1 / ∫ c / (1 + α² − (1 − α²) c)² dω over the hemisphere.
double kernel_scale(double roughness) {
    const double a = roughness * roughness * roughness * roughness, b = 1 - a;
    const double integral = b < 1e-4 ? 1.0 / 8 : ((1 + a) / (2 * a) - 1 + elementary::log(2 * a / (1 + a))) / (b * b);
    return 1 / (2 * k_pi * integral);
}
double kernel_shape(double roughness, double cosine) {
    const double a = roughness * roughness * roughness * roughness, d = 1 + a - (1 - a) * cosine;
    return cosine > 0 ? cosine / (d * d) : 0;
}

/// Directions about z that stand for K, with equal shares of the density (1 + α² − (1 − α²) c)⁻² and weights that sum to 1; half of
/// them, y > 0, for the others are mirrored.
struct KernelDraw {
    Vec3d w;
    double weight;
};
std::vector<KernelDraw> draws_of_kernel(double roughness) {
    constexpr int k_rings = 64, k_of_ring = 16;
    const double a = roughness * roughness * roughness * roughness;
    std::vector<KernelDraw> draws;
    double sum = 0;
    for (int i = 0; i < k_rings; ++i) {
        const double x = (i + 0.5) / k_rings, c = (1 - x - a * x) / (1 - x + a * x);
        if (!(c > 0)) continue;
        const double s = std::sqrt(1 - c * c);
        for (int j = 0; j < k_of_ring; ++j) {
            const double phi = k_pi * (j + 0.5) / k_of_ring;
            draws.push_back({{s * elementary::cos(phi), s * elementary::sin(phi), c}, c});
            sum += c;
        }
    }
    for (KernelDraw& draw : draws) draw.weight /= sum;
    return draws;
}

/// The sizes of the lights that a fit sees, as roughnesses of K, whose half width is about 2 r² radians: from 1.6 degrees, which a
/// picture of a sphere 128 pixels wide resolves, to the cosine.
constexpr std::array<double, 6> k_light_sizes{0.12, 0.25, 0.4, 0.6, 0.8, 1};
constexpr int k_lights_of_a_size = 96;   ///< placed for each view
constexpr int k_draws_of_a_view = 2048;  ///< of what the BRDF reflects: albedos within about .3 %
/// Of luminance in the scale of a channel's errors, so that a channel that hardly reflects is not fitted as closely as the others.
constexpr double k_luminance_share = 0.3;
constexpr int k_lobe_starts = 12;
constexpr int k_view_sweeps =
    2;  ///< over all views, each towards the mean of its neighbours; a third changes pictures by less than .01 ΔE_ITP
/// Of squared distances of p and r from the neighbours', beside squared errors over the albedo of 1e-5 to 1e-3: 30 times as much made
/// pictures of metals err by twice as much, a tenth changed nothing.
constexpr double k_smoothness = 1e-3;
constexpr double k_most_axis = 1.3;  ///< |p|: beyond the mirror direction by as much as off-specular peaks are

/// ∫ K(roughness, a · w) K(k_light_sizes[size], b · w) dω of the angle between a and b.
class BlurredKernels {
  public:
    explicit BlurredKernels(int threads) : values_(k_light_sizes.size() * k_roughnesses * k_angles) {
        parallel_for(k_light_sizes.size() * k_roughnesses, threads, [&](std::size_t i) {
            const double size = k_light_sizes[i / k_roughnesses], roughness = roughness_of(double(i % k_roughnesses));
            const auto draws = draws_of_kernel(std::min(size, roughness));
            const double wider = std::max(size, roughness), scale = kernel_scale(wider);
            for (std::size_t angle = 0; angle < k_angles; ++angle) {
                const double u = double(angle) / (k_angles - 1), sine = u * u;  // of half the angle
                const double c = 1 - 2 * sine * sine, s = 2 * sine * std::sqrt(1 - sine * sine);
                double sum = 0;
                for (const KernelDraw& draw : draws)
                    sum += draw.weight * kernel_shape(wider, s * draw.w.x + c * draw.w.z);
                values_[i * k_angles + angle] = scale * sum;
            }
        });
    }
    /// Linear between nodes, with its derivatives by roughness and by the cosine between the axes.
    struct Value {
        double value, by_roughness, by_cosine;
    };
    Value at(std::size_t size, double roughness, double cosine) const {
        const double sine2 = std::clamp((1 - cosine) / 2, 1e-12, 1.0);  // of half the angle
        const double sine = std::sqrt(sine2), u = std::sqrt(sine);
        const double x = (roughness - k_least) / (1 - k_least) * (k_roughnesses - 1), y = u * (k_angles - 1);
        const auto i = std::size_t(std::clamp(int(x), 0, int(k_roughnesses) - 2)),
                   j = std::size_t(std::min(int(y), int(k_angles) - 2));
        const double s = x - double(i), t = y - double(j);
        const double* of = &values_[(size * k_roughnesses + i) * k_angles + j];
        const double low = of[0] + t * (of[1] - of[0]), high = of[k_angles] + t * (of[k_angles + 1] - of[k_angles]);
        const double by_y = (1 - s) * (of[1] - of[0]) + s * (of[k_angles + 1] - of[k_angles]);
        // u⁴ = (1 − cosine) / 2
        return {low + s * (high - low), (high - low) * (k_roughnesses - 1) / (1 - k_least),
                -by_y * (k_angles - 1) / (8 * u * sine)};
    }

  private:
    static constexpr std::size_t k_roughnesses = 25, k_angles = 129;
    static constexpr double k_least = ExtendedLight::k_least_roughness;
    static double roughness_of(double i) { return k_least + (1 - k_least) * i / (k_roughnesses - 1); }
    std::vector<double> values_;
};

/// A light of K's shape about a direction, with its weight in the sum of squares.
struct Light {
    std::size_t size;
    Vec3d centre;
    double weight;
};

/// What a view shows of the lights.
struct View {
    Vec3d wv;
    Vec3d scale;  ///< of the errors of R, G, B
    std::vector<Light> lights;
    MatrixXd seen;  ///< lights × 3: weight × radiance / scale
};

/// Light that is reflected to the view from direction w, an equal share of the draws.
struct Reflected {
    Vec3d w, share;
};
std::vector<Reflected> reflected_to(const PreparedBrdf& brdf, const Vec3f& wv) {
    std::vector<Reflected> all;
    RSequence<3> numbers;
    for (int i = 0; i < k_draws_of_a_view; ++i) {
        const auto u = numbers.next();
        const LightSample drawn = sample(brdf, wv, {float(u[0]), float(u[1])}, float(u[2]));
        if (!(drawn.pdf > 0)) continue;
        const Vec3d weight{drawn.weight.r, drawn.weight.g, drawn.weight.b};
        all.push_back({to_double(drawn.wl), 1.0 / k_draws_of_a_view * weight});
    }
    return all;
}

/// Half of them where light is reflected from, half of them anywhere. What is estimated is the mean over directions of the squared
/// error under a light of radiance 1, whose share of the sphere goes with r⁴, for each size.
std::vector<Light> lights_about(const PreparedBrdf& brdf, const Vec3f& wv, const std::vector<Reflected>& reflected) {
    std::vector<Light> lights;
    RSequence<2> anywhere;
    RSequence<1> chosen;
    for (std::size_t size = 0; size < k_light_sizes.size(); ++size)
        for (int i = 0; i < k_lights_of_a_size; ++i) {
            Vec3d centre;
            if (i % 2 == 0 && !reflected.empty()) {
                centre = reflected[std::size_t(chosen.next()[0] * double(reflected.size()))].w;
            } else {
                const auto u = anywhere.next();
                const double c = 1 - 2 * u[0], s = std::sqrt(std::max(1 - c * c, 0.0)), phi = 2 * k_pi * u[1];
                centre = {s * elementary::cos(phi), s * elementary::sin(phi), c};
            }
            const double density = 0.5 * pdf(brdf, to_float(centre), wv) + 0.5 / (4 * k_pi),
                         r2 = k_light_sizes[size] * k_light_sizes[size];
            lights.push_back({size, centre, r2 / std::sqrt(density * k_lights_of_a_size)});
        }
    return lights;
}

View view_of(const PreparedBrdf& brdf, double cosine) {
    View view;
    view.wv = {std::sqrt(1 - cosine * cosine), 0, cosine};
    const Vec3f wv = to_float(view.wv);
    const std::vector<Reflected> reflected = reflected_to(brdf, wv);
    Vec3d albedo{};
    for (const Reflected& of : reflected) albedo = albedo + of.share;
    const double luminance = srbf::luminance(Rgb{float(albedo.x), float(albedo.y), float(albedo.z)});
    const auto scale = [&](double of) {
        return std::max((1 - k_luminance_share) * of + k_luminance_share * luminance, 1e-9);
    };
    view.scale = {scale(albedo.x), scale(albedo.y), scale(albedo.z)};
    view.lights = lights_about(brdf, wv, reflected);
    view.seen.resize(Eigen::Index(view.lights.size()), 3);
    for (std::size_t i = 0; i < view.lights.size(); ++i) {
        const Light& light = view.lights[i];
        const double roughness = k_light_sizes[light.size];
        Vec3d sum{};
        for (const auto& [w, share] : reflected) {
            // An isotropic BRDF reflects the same from both sides of the plane of incidence.
            const double along = w.x * light.centre.x + w.z * light.centre.z, across = w.y * light.centre.y;
            sum =
                sum + 0.5 * (kernel_shape(roughness, along + across) + kernel_shape(roughness, along - across)) * share;
        }
        const double by = light.weight * kernel_scale(roughness);
        view.seen.row(Eigen::Index(i)) << by * sum.x / view.scale.x, by * sum.y / view.scale.y,
            by * sum.z / view.scale.z;
    }
    return view;
}

/// The squared errors of a view, and `smoothness` times the squared distances from `near`, of x = (p, r) of each lobe but the first. The
/// weights are linear, and eliminated.
class LobesOfView {
  public:
    LobesOfView(const View& view, const BlurredKernels& kernels, VectorXd near, double smoothness)
        : view_(view),
          kernels_(kernels),
          near_(std::move(near)),
          lobes_(1 + int(near_.size()) / 2),
          smoothness_(smoothness) {}

    double loss(const VectorXd& x) {
        const auto n = Eigen::Index(view_.lights.size());
        A_.resize(n, lobes_), by_axis_.resize(n, lobes_), by_roughness_.resize(n, lobes_);
        for (int k = 0; k < lobes_; ++k) k == 0 ? set_column(0, 0, 1) : set_column(k, x[2 * k - 2], x[2 * k - 1]);
        gram_ = A_.transpose() * A_;
        double sum = smoothness_ * (x - near_).squaredNorm();
        const VectorXd unbounded = VectorXd::Constant(lobes_, std::numeric_limits<double>::infinity());
        for (int c = 0; c < 3; ++c) {
            weights_[std::size_t(c)] = bounded_least_squares(gram_, A_.transpose() * view_.seen.col(c), unbounded);
            sum += (A_ * weights_[std::size_t(c)] - view_.seen.col(c)).squaredNorm();
        }
        return sum;
    }
    void linearise(const VectorXd& x, MatrixXd& H, VectorXd& g) const {
        H = smoothness_ * MatrixXd::Identity(x.size(), x.size()), g = smoothness_ * (x - near_);
        for (std::size_t c = 0; c < 3; ++c) {
            MatrixXd J(A_.rows(), x.size());
            std::vector<int> positive;
            for (int k = 0; k < lobes_; ++k) {
                if (weights_[c][k] > 0) positive.push_back(k);
                if (k == 0) continue;
                J.col(2 * k - 2) = weights_[c][k] * by_axis_.col(k);
                J.col(2 * k - 1) = weights_[c][k] * by_roughness_.col(k);
            }
            if (!positive.empty()) {  // the weights adapt
                const MatrixXd A = A_(Eigen::all, positive);
                J -= A * ridged(gram_(positive, positive)).ldlt().solve(A.transpose() * J);
            }
            H += J.transpose() * J;
            g += J.transpose() * (A_ * weights_[c] - view_.seen.col(Eigen::Index(c)));
        }
    }
    VectorXd lower(const VectorXd& x) const { return each(x, -most_axis(), ExtendedLight::k_least_roughness); }
    VectorXd upper(const VectorXd& x) const { return each(x, most_axis(), 1); }
    VectorXd longest_step(const VectorXd& x) const { return each(x, 0.2, 0.2); }

    /// The lobes at the x of the last call of `loss`, with weights that sum to `albedo`.
    std::vector<Lobe> lobes(const VectorXd& x, const Rgb& albedo) const {
        std::vector<Lobe> all;
        for (int k = 0; k < lobes_; ++k) {
            Lobe& lobe = all.emplace_back(k == 0 ? Lobe{0, 1, {}} : Lobe{float(x[2 * k - 2]), float(x[2 * k - 1]), {}});
            for (int c = 0; c < 3; ++c) {
                const VectorXd& weights = weights_[std::size_t(c)];
                const double sum = weights.sum();
                lobe.weight[c] = sum > 0 ? float(weights[k] / sum * double(albedo[c])) : k == 0 ? albedo[c] : 0;
            }
        }
        return all;
    }

  private:
    void set_column(int k, double p, double r) {
        const double s = view_.wv.x, c = std::sqrt(std::max(1 - p * p * s * s, 1e-12));
        const Vec3d axis{-p * s, 0, c},
            by_p{-s, 0, -p * s * s / std::max(c, 0.05)};  // whose slope at the horizon is infinite
        for (Eigen::Index i = 0; i < A_.rows(); ++i) {
            const Light& light = view_.lights[std::size_t(i)];
            const auto at = kernels_.at(light.size, r, dot(axis, light.centre));
            A_(i, k) = light.weight * at.value;
            by_axis_(i, k) = light.weight * at.by_cosine * dot(by_p, light.centre);
            by_roughness_(i, k) = light.weight * at.by_roughness;
        }
    }
    double most_axis() const { return std::min(k_most_axis, 0.999 / std::max(view_.wv.x, 1e-3)); }  // above the horizon
    static VectorXd each(const VectorXd& x, double axis, double roughness) {
        VectorXd of(x.size());
        for (Eigen::Index i = 0; i < x.size(); ++i) of[i] = i % 2 == 0 ? axis : roughness;
        return of;
    }

    const View& view_;
    const BlurredKernels& kernels_;
    VectorXd near_;
    int lobes_;
    double smoothness_;
    MatrixXd A_, by_axis_, by_roughness_, gram_;
    std::array<VectorXd, 3> weights_;
};

/// x of all views.
class Tracks {
  public:
    Tracks(const std::vector<View>& views, const BlurredKernels& kernels, int lobes, int threads)
        : views_(views), kernels_(kernels), threads_(threads), x_(views.size()) {
        // A view of 45 degrees from several starts; from there each begins with its neighbour's lobes.
        std::size_t first = 0;
        while (views[first].wv.z < 0.7) ++first;
        x_[first] = best_of_starts(views[first], lobes);
        for (std::size_t v = first + 1; v < views.size(); ++v) x_[v] = refined(v, x_[v - 1], x_[v - 1]);
        for (std::size_t v = first; v-- > 0;) x_[v] = refined(v, x_[v + 1], x_[v + 1]);
        for (int sweep = 0; sweep < 2 * k_view_sweeps; ++sweep)  // even views, odd views
            parallel_for(views.size() / 2, threads, [&](std::size_t i) {
                const std::size_t v = 2 * i + std::size_t(sweep % 2), last = views_.size() - 1;
                const VectorXd &below = x_[v == 0 ? 1 : v - 1], &above = x_[v == last ? last - 1 : v + 1];
                x_[v] = refined(v, x_[v], 0.5 * (below + above));
            });
    }
    const VectorXd& operator[](std::size_t v) const { return x_[v]; }

  private:
    static constexpr LevenbergMarquardtOptions k_steps{.max_iterations = 30, .decrease_tolerance = 1e-4};

    VectorXd best_of_starts(const View& view, int lobes) const {
        std::vector<std::pair<double, VectorXd>> tried(k_lobe_starts);
        parallel_for(tried.size(), threads_, [&](std::size_t i) {
            RSequence<1> numbers({double(i) / k_lobe_starts});
            VectorXd x(2 * (lobes - 1));
            for (int k = 0; k < lobes - 1; ++k) {  // near the mirror direction, of roughnesses in order
                x[2 * k] = 0.9;
                x[2 * k + 1] = 0.08 + 0.9 * (k + numbers.next()[0]) / (lobes - 1);
            }
            LobesOfView problem(view, kernels_, x, 0);
            const double loss = levenberg_marquardt(problem, x, k_steps).loss;
            tried[i] = {loss, std::move(x)};
        });
        return std::ranges::min(tried, {}, [](const auto& of) { return of.first; }).second;
    }
    VectorXd refined(std::size_t v, VectorXd x, const VectorXd& near) const {
        LobesOfView problem(views_[v], kernels_, near, k_smoothness);
        levenberg_marquardt(problem, x, k_steps);
        return x;
    }

    const std::vector<View>& views_;
    const BlurredKernels& kernels_;
    int threads_;
    std::vector<VectorXd> x_;
};

}  // namespace

double ExtendedLight::cosine(int node) { return elevation_cosine(double(node) / (k_views - 1)); }

std::vector<Lobe> lobes_at(const ExtendedLight& light, float cos_v) {
    const float at = elevation_coordinate(cos_v) * float(ExtendedLight::k_views - 1);
    const auto below = std::size_t(std::clamp(int(at), 0, ExtendedLight::k_views - 2)), K = std::size_t(light.lobes);
    const float part = at - float(below);
    const auto mix = [&](float x, float y) { return x + part * (y - x); };
    std::vector<Lobe> all;
    for (std::size_t k = 0; k < K; ++k) {
        const Lobe &a = light.lobe[below * K + k], &b = light.lobe[(below + 1) * K + k];
        Lobe& lobe = all.emplace_back(Lobe{mix(a.axis, b.axis), mix(a.roughness, b.roughness), {}});
        for (int c = 0; c < 3; ++c) lobe.weight[c] = mix(a.weight[c], b.weight[c]);
    }
    return all;
}

Vec3f axis_of(const Lobe& lobe, const Vec3f& wv) {
    const float p = lobe.axis;
    return {-p * wv.x, -p * wv.y, std::sqrt(std::max(1 - p * p * (1 - wv.z * wv.z), 0.f))};
}

float filter_kernel(float roughness, float cosine) {
    return float(kernel_scale(roughness) * kernel_shape(roughness, cosine));
}

ExtendedLight extended_light(const PreparedBrdf& brdf, const ExtendedLightOptions& options) {
    assert(options.lobes >= k_least_extended_lobes && options.lobes <= k_most_extended_lobes);
    const BlurredKernels kernels(options.threads);
    std::vector<View> views(ExtendedLight::k_views);
    // At the horizon and along the normal views have no limit, or no plane of incidence.
    const auto cosine = [](std::size_t v) { return std::clamp(ExtendedLight::cosine(int(v)), 1e-4, 0.9999); };
    parallel_for(views.size(), options.threads, [&](std::size_t v) { views[v] = view_of(brdf, cosine(v)); });
    const Tracks tracks(views, kernels, options.lobes, options.threads);
    ExtendedLight light{options.lobes, {}};
    for (std::size_t v = 0; v < views.size(); ++v) {
        LobesOfView problem(views[v], kernels, tracks[v], 0);
        problem.loss(tracks[v]);
        const std::vector<Lobe> lobes = problem.lobes(tracks[v], albedo(brdf, float(cosine(v))));
        light.lobe.insert(light.lobe.end(), lobes.begin(), lobes.end());
    }
    return light;
}

}  // namespace srbf
