#include "srbf/extended_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "base/r_sequence.h"
#include "brdf/colour.h"
#include "sampling/elevation_nodes.h"

namespace srbf {
namespace {

using Lobe = ExtendedLight::Lobe;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// GGX's kernel at a level of a filtered map, whose first level is the environment itself but for a kernel that nothing
/// resolves. With a = α² = r⁴ it is scale c / (1 + a − (1 − a) c)², c > 0.
class LevelKernel {
  public:
    explicit LevelKernel(double roughness) : a_(elementary::square(elementary::square(std::max(roughness, 0.01)))) {
        const double b = 1 - a_;
        const double integral =
            b < 1e-4 ? 1.0 / 8 : ((1 + a_) / (2 * a_) - 1 + elementary::log(2 * a_ / (1 + a_))) / (b * b);
        scale_ = 1 / (2 * k_pi * integral);
    }
    double operator()(double c) const { return c > 0 ? scale_ * c / elementary::square(1 + a_ - (1 - a_) * c) : 0; }
    /// A density that is higher where K is, over all directions: (a / π) (1 + a − (1 − a) c)⁻².
    double density(double c) const { return a_ / (k_pi * elementary::square(1 + a_ - (1 - a_) * c)); }
    /// The cosine below which that share of the density is, from the axis.
    double cosine(double share) const { return (1 - share - a_ * share) / (1 - share + a_ * share); }

  private:
    double a_, scale_ = 0;
};

/// A direction about z that stands for a kernel, and its weight.
struct KernelDraw {
    Vec3d w;
    double weight;
};
KernelDraw draw_at(double cosine, double azimuth, double weight) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    return {{sine * elementary::cos(azimuth), sine * elementary::sin(azimuth), cosine}, weight};
}
/// Equal shares of `density` with weights that sum to 1; half of them, y > 0, for the others are mirrored.
std::vector<KernelDraw> draws_of_kernel(const LevelKernel& kernel) {
    constexpr int k_rings = 64, k_of_ring = 16;
    std::vector<KernelDraw> draws;
    double sum = 0;
    for (int i = 0; i < k_rings; ++i) {
        const double c = kernel.cosine((i + 0.5) / k_rings);
        if (!(c > 0)) continue;
        for (int j = 0; j < k_of_ring; ++j) draws.push_back(draw_at(c, k_pi * (j + 0.5) / k_of_ring, c)), sum += c;
    }
    for (KernelDraw& draw : draws) draw.weight /= sum;
    return draws;
}

/// The sizes of the lights that a fit sees, as roughnesses of K, whose half width is about 2 r² radians: from 1.6 degrees, which a
/// picture of a sphere 128 pixels wide resolves, to the cosine.
constexpr std::array<double, 6> k_light_sizes{0.12, 0.25, 0.4, 0.6, 0.8, 1};
constexpr int k_lights_of_a_size = 256;  ///< placed for each view
constexpr int k_draws_of_a_view = 2048;  ///< of what the BRDF reflects: albedos within about .3 %
constexpr int k_draws_of_a_light = 64;   ///< of what a light sends
/// Errors are relative to the radiance, as the eye's are: of luminance in it, so that a channel that hardly reflects is
/// not fitted as closely as the others; and of what else lights the surface, which is this all round where the light
/// has radiance 1.
constexpr double k_luminance_share = 0.3, k_ambient = 0.1 / k_pi;
/// The weight of squared shares, next to squared relative errors of .02 to .2. Lobes of either sign that nearly cancel each other would
/// fit the lights of one view, but neither others nor the views between.
constexpr double k_ridge_of_lobes = 5e-2;
/// More lights of the least size, side by side along the plane of incidence, in which all lobes lie: a lobe that is sharper than
/// the BRDF would show a small lamp as a dot, which the other lights miss. They stand for a band of this solid angle [sr];
/// with 1 errors of pictures of metals are a tenth larger.
constexpr int k_lights_along = 120;
constexpr double k_band = 0.3;
constexpr int k_lobe_starts = 12;
/// Over all views, each towards the mean of its neighbours; a third changes pictures by less than .01 ΔE_ITP.
constexpr int k_view_sweeps = 2;
/// The weights of squared distances of p, by the angle of the axis, and of r from the neighbours', beside relative squared errors of .02 to
/// .2, of views `k_usual_step` [rad] apart, and of shares. Nodes are closer to each other at the horizon, where all lobes
/// would change within a degree of the view: there both count for more.
constexpr double k_smoothness = 3e-3, k_share_smoothness = 0.2, k_usual_step = 4 * k_pi / 180;
/// The inverse square of the angle between the views of a node and of the next, in `k_usual_step`; at least 1.
double closeness(std::size_t node) {
    const auto angle = [](std::size_t of) { return elementary::acos(ExtendedLight::cosine(int(of))); };
    return std::clamp(elementary::square(k_usual_step / (angle(node) - angle(node + 1))), 1.0, 1e3);
}
/// |p|: beyond the mirror direction by as much as off-specular peaks are, and less towards the horizon, where an axis with
/// |p| > 1 would turn by many degrees for one of the view: |p| ≤ `k_most_beyond` / sinθv or 1.
constexpr double k_most_axis = 1.3, k_most_beyond = 0.96;

/// K of a light, and draws of its density all round.
struct LightKernel {
    LevelKernel kernel;
    std::vector<KernelDraw> draws;
    explicit LightKernel(double roughness) : kernel(roughness) {
        RSequence<2> numbers;
        for (int i = 0; i < k_draws_of_a_light; ++i) {
            const auto u = numbers.next();
            draws.push_back(draw_at(kernel.cosine(u[0]), 2 * k_pi * u[1], 1));
        }
    }
};
const std::vector<LightKernel>& light_kernels() {
    static const std::vector<LightKernel> all(k_light_sizes.begin(), k_light_sizes.end());
    return all;
}

double level_by_roughness(double r, MapLevels levels) {
    return (ExtendedLight::k_levels - 1) * (levels == MapLevels::root ? 0.5 / std::sqrt(r) : 2 * (1 - r));
}

/// ∫ K(roughness, a · w) K(k_light_sizes[size], b · w) dω of the angle between a and b.
class BlurredKernels {
  public:
    BlurredKernels(MapLevels levels, int threads)
        : levels_(levels), values_(k_light_sizes.size() * k_levels * k_angles) {
        parallel_for(k_light_sizes.size() * k_levels, threads, [&](std::size_t i) {
            const double size = k_light_sizes[i / k_levels],
                         roughness = roughness_of_level(double(i % k_levels), levels);
            const auto draws = draws_of_kernel(LevelKernel(std::min(size, roughness)));
            const LevelKernel wider(std::max(size, roughness));
            for (std::size_t angle = 0; angle < k_angles; ++angle) {
                const double u = double(angle) / (k_angles - 1), sine = u * u;  // of half the angle
                const double c = 1 - 2 * sine * sine, s = 2 * sine * std::sqrt(1 - sine * sine);
                double sum = 0;
                for (const KernelDraw& draw : draws) sum += draw.weight * wider(s * draw.w.x + c * draw.w.z);
                values_[i * k_angles + angle] = sum;
            }
        });
    }
    /// Linear between levels, with its derivatives by roughness and by the cosine between the axes.
    struct Value {
        double value, by_roughness, by_cosine;
    };
    Value at(std::size_t size, double roughness, double cosine) const {
        const double sine2 = std::clamp((1 - cosine) / 2, 1e-12, 1.0);  // of half the angle
        const double sine = std::sqrt(sine2), u = std::sqrt(sine);
        const double x = level_of_roughness(roughness, levels_), y = u * (k_angles - 1);
        const auto i = std::size_t(std::min(int(x), int(k_levels) - 2)),
                   j = std::size_t(std::min(int(y), int(k_angles) - 2));
        const double s = x - double(i), t = y - double(j);
        const double* of = &values_[(size * k_levels + i) * k_angles + j];
        const double low = of[0] + t * (of[1] - of[0]), high = of[k_angles] + t * (of[k_angles + 1] - of[k_angles]);
        const double by_y = (1 - s) * (of[1] - of[0]) + s * (of[k_angles + 1] - of[k_angles]);
        // u⁴ = (1 − cosine) / 2
        return {low + s * (high - low), (high - low) * level_by_roughness(roughness, levels_),
                -by_y * (k_angles - 1) / (8 * u * sine)};
    }

  private:
    static constexpr std::size_t k_levels = ExtendedLight::k_levels, k_angles = 129;
    MapLevels levels_;
    std::vector<double> values_;
};

/// A light of K's shape about a direction, with the root of its share in the mean over directions.
struct Light {
    std::size_t size;
    Vec3d centre;
    double share;
};

/// The radiance of a view under the lights.
struct View {
    Vec3d wv;
    Rgb albedo;
    float width = 0;
    std::vector<Light> lights;
    MatrixXd weight;  ///< lights × 3, of errors of R, G, B
    MatrixXd seen;    ///< lights × 3: weight × radiance
};

/// A BRDF whose draws are each of another azimuth if it is anisotropic, so that their sum is that of its mean over
/// azimuths.
class TurnedBrdf {
  public:
    TurnedBrdf(const PreparedBrdf& brdf, bool isotropic) : brdf_(brdf), isotropic_(isotropic) {}
    const PreparedBrdf& brdf() const { return brdf_; }
    LightSample sample(int draw, const Vec3f& wv, Vec2f u, float selector) const {
        const double azimuth = azimuth_of(draw);
        LightSample drawn = srbf::sample(brdf_, turned(wv, azimuth), u, selector);
        drawn.wl = turned(drawn.wl, -azimuth);
        return drawn;
    }
    struct At {
        Rgb f;
        double density;
    };
    At at(int draw, const Vec3f& wl, const Vec3f& wv) const {
        const double azimuth = azimuth_of(draw);
        const Vec3f l = turned(wl, azimuth), v = turned(wv, azimuth);
        return {value(brdf_, l, v), double(pdf(brdf_, l, v))};
    }

  private:
    static constexpr double k_golden_angle = 2.39996322972865332;
    double azimuth_of(int draw) const { return isotropic_ ? 0 : k_golden_angle * draw; }
    Vec3f turned(const Vec3f& w, double azimuth) const {
        if (isotropic_) return w;
        const float c = float(elementary::cos(azimuth)), s = float(elementary::sin(azimuth));
        return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
    }
    const PreparedBrdf& brdf_;
    bool isotropic_;
};

/// Light that is reflected to the view from direction w, drawn with that density, an equal share of the draws.
struct Reflected {
    Vec3d w, share;
    double density;
};
std::vector<Reflected> reflected_to(const TurnedBrdf& brdf, const Vec3f& wv) {
    std::vector<Reflected> all;
    RSequence<3> numbers;
    for (int i = 0; i < k_draws_of_a_view; ++i) {
        const auto u = numbers.next();
        const LightSample drawn = brdf.sample(i, wv, {float(u[0]), float(u[1])}, float(u[2]));
        if (!(drawn.pdf > 0)) continue;
        const Vec3d weight{drawn.weight.r, drawn.weight.g, drawn.weight.b};
        all.push_back({to_double(drawn.wl), 1.0 / k_draws_of_a_view * weight, double(drawn.pdf)});
    }
    return all;
}

/// Half of them where light is reflected from, half of them anywhere. What is estimated is, for each size, the mean
/// over directions of the squared error under a light of radiance 1.
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
            const double density = 0.5 * pdf(brdf, to_float(centre), wv) + 0.5 / (4 * k_pi);
            lights.push_back({size, centre, 1 / std::sqrt(density * k_lights_of_a_size)});
        }
    for (int i = 0; i < k_lights_along; ++i) {
        const double angle = k_pi * ((i + 0.5) / k_lights_along - 0.5);
        lights.push_back({0, {elementary::sin(angle), 0, elementary::cos(angle)}, std::sqrt(k_band / k_lights_along)});
    }
    return lights;
}

/// ∫ K(size, centre · w) f cosθ dω by draws of the BRDF and of the light, with the balance heuristic (Veach & Guibas
/// 1995): those of the BRDF alone seldom meet a small light, and their noise would be fitted.
Vec3d shown_of(const Light& light, const TurnedBrdf& brdf, const Vec3f& wv, const std::vector<Reflected>& reflected) {
    const auto& [kernel, draws] = light_kernels()[light.size];
    const auto all_draws = [](double of_brdf, double of_light) {
        return k_draws_of_a_view * of_brdf + k_draws_of_a_light * of_light;
    };
    Vec3d sum{};
    for (const auto& [w, share, density] : reflected) {
        // An isotropic BRDF reflects the same from either half of the hemisphere, beside the plane of incidence.
        const double along = w.x * light.centre.x + w.z * light.centre.z, across = w.y * light.centre.y;
        for (const double c : {along + across, along - across})
            if (c > 0)
                sum =
                    sum + 0.5 * k_draws_of_a_view * density * kernel(c) / all_draws(density, kernel.density(c)) * share;
    }
    const Frame axes = frame_about(light.centre);
    for (std::size_t i = 0; i < draws.size(); ++i) {
        const Vec3f w = to_float(axes.from(draws[i].w));
        if (!(w.z > 0)) continue;
        const auto [f, density] = brdf.at(int(i), w, wv);
        if (!is_finite(f)) continue;  // not measured
        const double c = draws[i].w.z, scale = kernel(c) * double(w.z) / all_draws(density, kernel.density(c));
        sum = sum + scale * Vec3d{double(f.r), double(f.g), double(f.b)};
    }
    return sum;
}

/// As of ExtendedLight.
float width_of(const Vec3d& albedo, const std::vector<Reflected>& reflected) {
    double most = 1e-9;
    for (const auto& [w, share, density] : reflected)
        most = std::max(most, k_draws_of_a_view * density * (share.x + share.y + share.z));
    return float((albedo.x + albedo.y + albedo.z) / most);
}

/// The weight of errors of R, G, B relative to errors of luminance.
Vec3d weight_beside(const Vec3d& seen) {
    const double of_luminance = k_luminance_share * double(luminance(Rgb{float(seen.x), float(seen.y), float(seen.z)}));
    const auto weight = [&](double of) { return 1 / std::max((1 - k_luminance_share) * of + of_luminance, 1e-9); };
    return {weight(seen.x), weight(seen.y), weight(seen.z)};
}

View view_of(const TurnedBrdf& brdf, double cosine) {
    View view;
    view.wv = {std::sqrt(1 - cosine * cosine), 0, cosine};
    const Vec3f wv = to_float(view.wv);
    const std::vector<Reflected> reflected = reflected_to(brdf, wv);
    view.albedo = albedo(brdf.brdf(), float(cosine));
    const Vec3d whole{view.albedo.r, view.albedo.g, view.albedo.b}, ambient = k_ambient * whole;
    view.width = width_of(whole, reflected);
    view.lights = lights_about(brdf.brdf(), wv, reflected);
    view.seen.resize(Eigen::Index(view.lights.size()), 3);
    view.weight.resize(Eigen::Index(view.lights.size()), 3);
    for (std::size_t i = 0; i < view.lights.size(); ++i) {
        const Light& light = view.lights[i];
        const Vec3d sum = shown_of(light, brdf, wv, reflected);
        const Vec3d weight = light.share * weight_beside(sum + ambient);
        view.weight.row(Eigen::Index(i)) << weight.x, weight.y, weight.z;
        view.seen.row(Eigen::Index(i)) << weight.x * sum.x, weight.y * sum.y, weight.z * sum.z;
    }
    return view;
}

/// The squared errors of a view, `k_ridge_of_lobes` times squared shares, and `smoothness` times the squared distances from
/// `near`, of x = (p, r) of each lobe but the first. The weights are linear, and eliminated; that of the first lobe is
/// what the others leave of the albedo.
class LobesOfView {
  public:
    LobesOfView(const View& view, const BlurredKernels& kernels, VectorXd near, double smoothness)
        : view_(view),
          kernels_(kernels),
          near_(std::move(near)),
          others_(int(near_.size()) / 2),
          smoothness_(each(near_, smoothness, smoothness)) {
        const double s = view_.wv.x;  // p by the angle of its axis
        for (Eigen::Index i = 0; i < near_.size(); i += 2)
            smoothness_[i] *= s * s / std::max(1 - near_[i] * near_[i] * s * s, 0.01);
    }

    double loss(const VectorXd& x) {
        const auto n = Eigen::Index(view_.lights.size());
        shown_.resize(n, others_ + 1), by_axis_.resize(n, others_ + 1), by_roughness_.resize(n, others_ + 1);
        for (int k = 0; k <= others_; ++k) k == 0 ? set_lobe(0, 0, 1) : set_lobe(k, x[2 * k - 2], x[2 * k - 1]);
        double sum = smoothness_.dot((x - near_).cwiseAbs2());
        for (int c = 0; c < 3; ++c) {
            solve(c, channels_[std::size_t(c)]);
            sum += channels_[std::size_t(c)].error.squaredNorm();
        }
        return sum;
    }
    void linearise(const VectorXd& x, MatrixXd& H, VectorXd& g) const {
        H = smoothness_.asDiagonal(), g = smoothness_.cwiseProduct(x - near_);
        const auto n = Eigen::Index(view_.lights.size());
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& [A, gram, weights, error] = channels_[c];
            MatrixXd J = MatrixXd::Zero(A.rows(), x.size());
            for (int k = 0; k < others_; ++k) {
                const auto weight = view_.weight.col(Eigen::Index(c));
                J.col(2 * k).head(n) = weights[k] * weight.cwiseProduct(by_axis_.col(k + 1));
                J.col(2 * k + 1).head(n) = weights[k] * weight.cwiseProduct(by_roughness_.col(k + 1));
            }
            J -= A * gram.ldlt().solve(A.transpose() * J);  // the weights adapt
            H += J.transpose() * J;
            g += J.transpose() * error;
        }
    }
    VectorXd lower(const VectorXd& x) const { return each(x, -most_axis(), ExtendedLight::k_least_roughness); }
    VectorXd upper(const VectorXd& x) const { return each(x, most_axis(), 1); }
    VectorXd longest_step(const VectorXd& x) const { return each(x, 0.2, 0.2); }

    /// The squared errors at the x of the last call of `loss` by the shares of a channel: sᵀ H s − 2 gᵀ s and a constant.
    struct Quadratic {
        MatrixXd H;
        VectorXd g;
    };
    Quadratic by_shares(int c) const {
        const Channel& channel = channels_[std::size_t(c)];
        const double albedo = std::max(double(view_.albedo[c]), 1e-6);
        return {albedo * albedo * channel.gram, albedo * (channel.gram * channel.weights)};
    }

  private:
    /// A w − b, whose squares are errors under the lights and, in the last rows, the ridge.
    struct Channel {
        MatrixXd A, gram;  ///< AᵀA
        VectorXd weights, error;
    };
    void solve(int c, Channel& channel) const {
        const auto n = Eigen::Index(view_.lights.size());
        const double albedo = double(view_.albedo[c]);
        const VectorXd first = view_.weight.col(c).cwiseProduct(shown_.col(0));
        channel.A.setZero(n + others_, others_);
        channel.A.topRows(n) = view_.weight.col(c).asDiagonal() * shown_.rightCols(others_);
        channel.A.topRows(n).colwise() -= first;
        for (int k = 0; k < others_; ++k) channel.A(n + k, k) = std::sqrt(k_ridge_of_lobes) / std::max(albedo, 1e-6);
        VectorXd b = VectorXd::Zero(n + others_);
        b.head(n) = view_.seen.col(c) - albedo * first;
        channel.gram = channel.A.transpose() * channel.A;
        channel.weights = channel.gram.ldlt().solve(channel.A.transpose() * b);
        channel.error = channel.A * channel.weights - b;
    }
    void set_lobe(int k, double p, double r) {
        const double s = view_.wv.x, c = std::sqrt(std::max(1 - p * p * s * s, 1e-12));
        const Vec3d axis{-p * s, 0, c},
            by_p{-s, 0, -p * s * s / std::max(c, 0.05)};  // whose slope at the horizon is infinite
        for (Eigen::Index i = 0; i < shown_.rows(); ++i) {
            const Light& light = view_.lights[std::size_t(i)];
            const auto at = kernels_.at(light.size, r, dot(axis, light.centre));
            shown_(i, k) = at.value;
            by_axis_(i, k) = at.by_cosine * dot(by_p, light.centre);
            by_roughness_(i, k) = at.by_roughness;
        }
    }
    double most_axis() const {
        const double sine = std::max(view_.wv.x, 1e-3);
        return std::min({k_most_axis, std::max(k_most_beyond / sine, 1.0), 0.999 / sine});  // above the horizon
    }
    static VectorXd each(const VectorXd& x, double axis, double roughness) {
        VectorXd of(x.size());
        for (Eigen::Index i = 0; i < x.size(); ++i) of[i] = i % 2 == 0 ? axis : roughness;
        return of;
    }

    const View& view_;
    const BlurredKernels& kernels_;
    VectorXd near_;
    int others_;
    VectorXd smoothness_;
    MatrixXd shown_, by_axis_, by_roughness_;  ///< lights × lobes, each of weight 1
    std::array<Channel, 3> channels_;
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
        LobesOfView problem(views_[v], kernels_, near, k_smoothness * closeness(std::min(v, views_.size() - 2)));
        x = x.cwiseMax(problem.lower(x)).cwiseMin(problem.upper(x));
        levenberg_marquardt(problem, x, k_steps);
        return x;
    }

    const std::vector<View>& views_;
    const BlurredKernels& kernels_;
    int threads_;
    std::vector<VectorXd> x_;
};

/// The shares of the lobes after the first, of all views: a row for each view and lobe, of R, G, B. They minimise the
/// squared errors and what shares change by between neighbours.
MatrixXd shares_of(const std::vector<View>& views, const BlurredKernels& kernels, const Tracks& tracks) {
    const Eigen::Index others = tracks[0].size() / 2, n = others * Eigen::Index(views.size());
    std::array<MatrixXd, 3> H;
    MatrixXd g = MatrixXd::Zero(n, 3), shares(n, 3);
    H.fill(MatrixXd::Zero(n, n));
    for (std::size_t v = 0; v < views.size(); ++v) {
        LobesOfView problem(views[v], kernels, tracks[v], 0);
        problem.loss(tracks[v]);
        const Eigen::Index at = others * Eigen::Index(v);
        for (int c = 0; c < 3; ++c) {
            const auto of = problem.by_shares(c);
            MatrixXd& all = H[std::size_t(c)];
            all.block(at, at, others, others) += of.H, g.col(c).segment(at, others) += of.g;
            if (v + 1 == views.size()) continue;
            const double smoothness = k_share_smoothness * elementary::square(closeness(v));
            for (Eigen::Index i = at; i < at + others; ++i) {
                all(i, i) += smoothness, all(i + others, i + others) += smoothness;
                all(i, i + others) -= smoothness, all(i + others, i) -= smoothness;
            }
        }
    }
    for (int c = 0; c < 3; ++c) shares.col(c) = H[std::size_t(c)].ldlt().solve(g.col(c));
    return shares;
}

}  // namespace

double ExtendedLight::cosine(int node) { return elevation_cosine(double(node) / (k_views - 1)); }

std::vector<Lobe> lobes_at(const ExtendedLight& light, float cos_v) {
    const float at = elevation_coordinate(cos_v) * float(ExtendedLight::k_views - 1);
    const auto below = std::size_t(std::clamp(int(at), 0, ExtendedLight::k_views - 2)), K = std::size_t(light.lobes);
    const float part = at - float(below);
    const auto mix = [&](float x, float y) { return x + part * (y - x); };
    const Rgb whole = albedo(light.brdf, cos_v);
    std::vector<Lobe> all;
    for (std::size_t k = 0; k < K; ++k) {
        const Lobe &a = light.lobe[below * K + k], &b = light.lobe[(below + 1) * K + k];
        Lobe& lobe = all.emplace_back(Lobe{mix(a.axis, b.axis), mix(a.roughness, b.roughness), {}});
        for (int c = 0; c < 3; ++c) lobe.weight[c] = std::min(whole[c], 1.f) * mix(a.weight[c], b.weight[c]);
    }
    return all;
}

Vec3f axis_of(const Lobe& lobe, const Vec3f& wv) {
    const float p = lobe.axis;
    return {-p * wv.x, -p * wv.y, std::sqrt(std::max(1 - p * p * (1 - wv.z * wv.z), 0.f))};
}

double level_of_roughness(double r, MapLevels levels) {
    return (ExtendedLight::k_levels - 1) * (levels == MapLevels::root ? std::sqrt(r) : r * (2 - r));
}
double roughness_of_level(double level, MapLevels levels) {
    const double x = level / (ExtendedLight::k_levels - 1);
    return levels == MapLevels::root ? x * x : 1 - std::sqrt(1 - x);
}

float filter_kernel(float roughness, float cosine, MapLevels levels) {
    const double x = level_of_roughness(double(roughness), levels);
    const int below = std::min(int(x), ExtendedLight::k_levels - 2);
    const auto at = [&](int level) { return LevelKernel(roughness_of_level(level, levels))(double(cosine)); };
    return float(at(below) + (x - below) * (at(below + 1) - at(below)));
}

ExtendedLight extended_light(const PreparedBrdf& brdf, const ExtendedLightOptions& options) {
    assert(options.lobes >= k_least_extended_lobes && options.lobes <= k_most_extended_lobes);
    const BlurredKernels kernels(options.levels, options.threads);
    const TurnedBrdf turned(brdf, options.isotropic);
    std::vector<View> views(ExtendedLight::k_views);
    // At the horizon and along the normal views have no limit, or no plane of incidence.
    const auto cosine = [](std::size_t v) { return std::clamp(ExtendedLight::cosine(int(v)), 1e-4, 0.9999); };
    parallel_for(views.size(), options.threads, [&](std::size_t v) { views[v] = view_of(turned, cosine(v)); });
    const Tracks tracks(views, kernels, options.lobes, options.threads);
    const MatrixXd shares = shares_of(views, kernels, tracks);
    ExtendedLight light{options.lobes, {}, {}, brdf};
    const int others = options.lobes - 1;
    for (std::size_t v = 0; v < views.size(); ++v) {
        light.width.push_back(views[v].width);
        const std::size_t first = light.lobe.size();
        light.lobe.push_back({0, 1, {1, 1, 1}});
        for (int k = 0; k < others; ++k) {
            Lobe& lobe = light.lobe.emplace_back(Lobe{float(tracks[v][2 * k]), float(tracks[v][2 * k + 1]), {}});
            for (int c = 0; c < 3; ++c) {
                lobe.weight[c] = float(shares(Eigen::Index(v) * others + k, c));
                light.lobe[first].weight[c] -= lobe.weight[c];
            }
        }
    }
    return light;
}

}  // namespace srbf
