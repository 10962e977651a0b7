#include "srbf/extended_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "base/r_sequence.h"
#include "brdf/colour.h"
#include "brdf/frame.h"
#include "sampling/elevation_nodes.h"

namespace srbf {
namespace {

using Lobe = ExtendedLight::Lobe;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// GGX's kernel at a level of a filtered map. The first level is the environment itself, except for a kernel too
/// narrow to be resolved. With a = α² = r⁴ it is scale c / (1 + a − (1 − a) c)², c > 0.
class LevelKernel {
  public:
    explicit LevelKernel(double roughness) : a_(elementary::square(elementary::square(std::max(roughness, 0.01)))) {
        const double b = 1 - a_;
        const double integral =
            b < 1e-4 ? 1.0 / 8 : ((1 + a_) / (2 * a_) - 1 + elementary::log(2 * a_ / (1 + a_))) / (b * b);
        scale_ = 1 / (2 * k_pi * integral);
    }
    double operator()(double c) const { return c > 0 ? scale_ * c / elementary::square(1 + a_ - (1 - a_) * c) : 0; }
    /// K / (other + count D) for a factor of the balance heuristic, where D, a density over all directions that is high
    /// where K is, is (a / π) (1 + a − (1 − a) c)⁻².
    double over_densities(double c, double other, double count) const {
        return scale_ * std::max(c, 0.0) / (other * elementary::square(1 + a_ - (1 - a_) * c) + count * a_ / k_pi);
    }
    /// The cosine to the axis within which the given fraction of D lies.
    double cosine(double fraction) const { return (1 - fraction - a_ * fraction) / (1 - fraction + a_ * fraction); }

  private:
    double a_, scale_ = 0;
};

/// A direction in the frame of the kernel's axis z, and its weight.
struct KernelSample {
    Vec3d w;
    double weight;
};
KernelSample direction_at(double cosine, double azimuth, double weight) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    return {{sine * elementary::cos(azimuth), sine * elementary::sin(azimuth), cosine}, weight};
}
/// Directions that each represent an equal part of `density`, with weights that sum to 1. They cover only y > 0;
/// the other half is its mirror image.
std::vector<KernelSample> sample_kernel(const LevelKernel& kernel) {
    constexpr int k_rings = 64, k_per_ring = 16;
    std::vector<KernelSample> samples;
    double sum = 0;
    for (int i = 0; i < k_rings; ++i) {
        const double c = kernel.cosine((i + 0.5) / k_rings);
        if (!(c > 0)) continue;
        for (int j = 0; j < k_per_ring; ++j)
            samples.push_back(direction_at(c, k_pi * (j + 0.5) / k_per_ring, c)), sum += c;
    }
    for (KernelSample& sample : samples) sample.weight /= sum;
    return samples;
}

/// The sizes of the lights used by the fit, as roughnesses of K, whose half width is approximately 2 r² radians:
/// from 1.6 degrees, which a picture of a sphere 128 pixels wide resolves, to the cosine.
constexpr std::array<double, 6> k_light_sizes{0.12, 0.25, 0.4, 0.6, 0.8, 1};
constexpr int k_lights_per_size = 256;  ///< for each view
constexpr int k_view_samples = 2048;    ///< of the reflected light: albedos within approximately 0.3 %
constexpr int k_light_samples = 64;     ///< of a light's emission
/// Errors are relative to the radiance, as visible errors are. The radiance includes a fraction of its luminance,
/// so that a channel that reflects little is not fitted as closely as the others. It also includes an ambient
/// light: this radiance in all directions, for a light of radiance 1.
constexpr double k_luminance_share = 0.3, k_ambient = 0.1 / k_pi;
/// The weight of squared fractions, compared with squared relative errors of 0.02 to 0.2. Without it, lobes of
/// opposite signs that nearly cancel could fit the lights of one view, but neither other lights nor the views
/// between.
constexpr double k_ridge_of_lobes = 5e-2;
/// More lights of the least size, side by side along the plane of incidence, in which all lobes lie. A lobe sharper
/// than the BRDF would show a small lamp as a dot, which the other lights miss. These lights represent a band of
/// this solid angle [sr]; with 1, errors of pictures of metals are a tenth larger.
constexpr int k_lights_along = 120;
constexpr double k_band = 0.3;
constexpr int k_lobe_starts = 12;
/// Sweeps over all views, each of which moves towards the mean of its neighbours. A third sweep changes pictures by
/// less than 0.01 ΔE_ITP.
constexpr int k_view_sweeps = 2;
/// The weights of squared distances from the neighbours: of p (as an angle of the axis) and r, and of fractions.
/// They compare with squared relative errors of 0.02 to 0.2, for views `k_usual_step` [rad] apart. Nodes are denser
/// at the horizon, where all lobes would change within one degree of the view, so that both weights are larger
/// there.
constexpr double k_smoothness = 3e-3, k_share_smoothness = 0.2, k_usual_step = 4 * k_pi / 180;
/// The inverse square of the angle between the views of a node and the next one, in units of `k_usual_step`; at
/// least 1.
double closeness(std::size_t node) {
    const auto angle = [](std::size_t node_index) { return elementary::acos(ExtendedLight::cosine(int(node_index))); };
    return std::clamp(elementary::square(k_usual_step / (angle(node) - angle(node + 1))), 1.0, 1e3);
}
/// Limits on |p|: it may exceed the mirror direction as off-specular peaks do. The limit is lower towards the
/// horizon, where an axis with |p| > 1 would move by many degrees when the view moves by one: |p| ≤ `k_most_beyond`
/// / sinθv or 1.
constexpr double k_most_axis = 1.3, k_most_beyond = 0.96;

/// K of a light, and samples of its density over all directions.
struct LightKernel {
    LevelKernel kernel;
    std::vector<KernelSample> samples;
    explicit LightKernel(double roughness) : kernel(roughness) {
        RSequence<2> numbers;
        for (int i = 0; i < k_light_samples; ++i) {
            const auto u = numbers.next();
            samples.push_back(direction_at(kernel.cosine(u[0]), 2 * k_pi * u[1], 1));
        }
    }
};
const std::vector<LightKernel>& light_kernels() {
    static const std::vector<LightKernel> kernels(k_light_sizes.begin(), k_light_sizes.end());
    return kernels;
}

double level_by_roughness(double r, MapLevels levels) {
    return (ExtendedLight::k_levels - 1) * (levels == MapLevels::root ? 0.5 / std::sqrt(r) : 2 * (1 - r));
}

/// ∫ K(roughness, a · w) K(k_light_sizes[size], b · w) dω as a function of the angle between a and b.
class BlurredKernels {
  public:
    BlurredKernels(MapLevels levels, int threads)
        : levels_(levels), values_(k_light_sizes.size() * k_levels * k_angles) {
        parallel_for(k_light_sizes.size() * k_levels, threads, [&](std::size_t i) {
            const double size = k_light_sizes[i / k_levels],
                         roughness = roughness_of_level(double(i % k_levels), levels);
            const auto samples = sample_kernel(LevelKernel(std::min(size, roughness)));
            const LevelKernel wider(std::max(size, roughness));
            for (std::size_t angle = 0; angle < k_angles; ++angle) {
                const double u = double(angle) / (k_angles - 1), sine = u * u;  // sine of half the angle
                const double c = 1 - 2 * sine * sine, s = 2 * sine * std::sqrt(1 - sine * sine);
                double sum = 0;
                for (const KernelSample& sample : samples)
                    sum += sample.weight * wider(s * sample.w.x + c * sample.w.z);
                values_[i * k_angles + angle] = sum;
            }
        });
    }
    /// The value, linear between levels, with its derivatives by roughness and by the cosine between the axes.
    struct Value {
        double value, by_roughness, by_cosine;
    };
    Value at(std::size_t size, double roughness, double cosine) const {
        const double sine2 = std::clamp((1 - cosine) / 2, 1e-12, 1.0);  // squared sine of half the angle
        const double sine = std::sqrt(sine2), u = std::sqrt(sine);
        const double x = level_of_roughness(roughness, levels_), y = u * (k_angles - 1);
        const auto i = std::size_t(std::min(int(x), int(k_levels) - 2)),
                   j = std::size_t(std::min(int(y), int(k_angles) - 2));
        const double s = x - double(i), t = y - double(j);
        const double* values = &values_[(size * k_levels + i) * k_angles + j];
        const double low = values[0] + t * (values[1] - values[0]),
                     high = values[k_angles] + t * (values[k_angles + 1] - values[k_angles]);
        const double slope_y = (1 - s) * (values[1] - values[0]) + s * (values[k_angles + 1] - values[k_angles]);
        // u⁴ = (1 − cosine) / 2
        return {low + s * (high - low), (high - low) * level_by_roughness(roughness, levels_),
                -slope_y * (k_angles - 1) / (8 * u * sine)};
    }

  private:
    static constexpr std::size_t k_levels = ExtendedLight::k_levels, k_angles = 129;
    MapLevels levels_;
    std::vector<double> values_;
};

/// A light with the shape of K around a direction, and the square root of its weight in the mean over directions.
struct Light {
    std::size_t size;
    Vec3d centre;
    double share;
};

/// The radiance of a view under each light.
struct View {
    Vec3d wv;
    Rgb albedo;
    float width = 0;
    std::vector<Light> lights;
    MatrixXd weight;    ///< lights × 3: weights of errors of R, G, B
    MatrixXd radiance;  ///< lights × 3: weight × radiance
};

/// A BRDF that is sampled at another azimuth each time if it is anisotropic, so that sums are those of its mean
/// over azimuths.
class AveragedBrdf {
  public:
    AveragedBrdf(const PreparedBrdf& brdf, bool isotropic) : brdf_(brdf), isotropic_(isotropic) {}
    const PreparedBrdf& brdf() const { return brdf_; }
    LightSample sample(int draw, const Vec3f& wv, Vec2f u, float selector) const {
        const double azimuth = azimuth_of(draw);
        LightSample light = srbf::sample(brdf_, rotate(wv, azimuth), u, selector);
        light.wl = rotate(light.wl, -azimuth);
        return light;
    }
    struct Value {
        Rgb f;
        double density;
    };
    Value at(int draw, const Vec3f& wl, const Vec3f& wv) const {
        const double azimuth = azimuth_of(draw);
        const Vec3f l = rotate(wl, azimuth), v = rotate(wv, azimuth);
        return {value(brdf_, l, v), double(pdf(brdf_, l, v))};
    }

  private:
    static constexpr double k_golden_angle = 2.39996322972865332;
    double azimuth_of(int draw) const { return isotropic_ ? 0 : k_golden_angle * draw; }
    Vec3f rotate(const Vec3f& w, double azimuth) const {
        if (isotropic_) return w;
        const float c = float(elementary::cos(azimuth)), s = float(elementary::sin(azimuth));
        return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
    }
    const PreparedBrdf& brdf_;
    bool isotropic_;
};

/// A sample of the light reflected to the view: direction w, sampled with that density, and its weight in the mean.
struct Reflected {
    Vec3d w, share;
    double density;
};
std::vector<Reflected> sample_reflected(const AveragedBrdf& brdf, const Vec3f& wv) {
    std::vector<Reflected> reflected;
    RSequence<3> numbers;
    for (int i = 0; i < k_view_samples; ++i) {
        const auto u = numbers.next();
        const LightSample light = brdf.sample(i, wv, {float(u[0]), float(u[1])}, float(u[2]));
        if (!(light.pdf > 0)) continue;
        const Vec3d weight{light.weight.r, light.weight.g, light.weight.b};
        reflected.push_back({to_double(light.wl), 1.0 / k_view_samples * weight, double(light.pdf)});
    }
    return reflected;
}

/// Lights for a view, half of them in directions from which light is reflected, half of them in any direction. For
/// each size they estimate the mean, over directions, of the squared error under a light of radiance 1.
std::vector<Light> place_lights(const PreparedBrdf& brdf, const Vec3f& wv, const std::vector<Reflected>& reflected) {
    std::vector<Light> lights;
    RSequence<2> sphere_points;
    RSequence<1> reflected_points;
    for (std::size_t size = 0; size < k_light_sizes.size(); ++size)
        for (int i = 0; i < k_lights_per_size; ++i) {
            Vec3d centre;
            if (i % 2 == 0 && !reflected.empty()) {
                centre = reflected[std::size_t(reflected_points.next()[0] * double(reflected.size()))].w;
            } else {
                const auto u = sphere_points.next();
                const double c = 1 - 2 * u[0], s = std::sqrt(std::max(1 - c * c, 0.0)), phi = 2 * k_pi * u[1];
                centre = {s * elementary::cos(phi), s * elementary::sin(phi), c};
            }
            const double density = 0.5 * pdf(brdf, to_float(centre), wv) + 0.5 / (4 * k_pi);
            lights.push_back({size, centre, 1 / std::sqrt(density * k_lights_per_size)});
        }
    for (int i = 0; i < k_lights_along; ++i) {
        const double angle = k_pi * ((i + 0.5) / k_lights_along - 0.5);
        lights.push_back({0, {elementary::sin(angle), 0, elementary::cos(angle)}, std::sqrt(k_band / k_lights_along)});
    }
    return lights;
}

/// ∫ K(size, centre · w) f cosθ dω from samples of the BRDF and of the light, combined with the balance heuristic
/// (Veach & Guibas 1995): samples of the BRDF alone rarely hit a small light, and their noise would be fitted.
Vec3d radiance_under(const Light& light, const AveragedBrdf& brdf, const Vec3f& wv,
                     const std::vector<Reflected>& reflected) {
    const auto& [kernel, samples] = light_kernels()[light.size];
    const auto balanced = [&kernel](double c, double density) {
        return kernel.over_densities(c, k_view_samples * density, k_light_samples);
    };
    Vec3d sum{};
    for (const auto& [w, share, density] : reflected) {
        // An isotropic BRDF is symmetric about the plane of incidence.
        const double along = w.x * light.centre.x + w.z * light.centre.z, across = w.y * light.centre.y;
        sum = sum + 0.5 * k_view_samples * density *
                        (balanced(along + across, density) + balanced(along - across, density)) * share;
    }
    const Frame axes = frame_about(light.centre);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Vec3f w = to_float(axes.from(samples[i].w));
        if (!(w.z > 0)) continue;
        const auto [f, density] = brdf.at(int(i), w, wv);
        if (!is_finite(f)) continue;  // not measured
        const double scale = balanced(samples[i].w.z, density) * double(w.z);
        sum = sum + scale * Vec3d{double(f.r), double(f.g), double(f.b)};
    }
    return sum;
}

/// See ExtendedLight::width.
float width_of(const Vec3d& albedo, const std::vector<Reflected>& reflected) {
    double largest = 1e-9;
    for (const auto& [w, share, density] : reflected)
        largest = std::max(largest, k_view_samples * density * (share.x + share.y + share.z));
    return float((albedo.x + albedo.y + albedo.z) / largest);
}

/// The weights of errors of R, G, B for this radiance.
Vec3d error_weights(const Vec3d& radiance) {
    const double luminance_part =
        k_luminance_share * double(luminance(Rgb{float(radiance.x), float(radiance.y), float(radiance.z)}));
    const auto weight = [&](double channel) {
        return 1 / std::max((1 - k_luminance_share) * channel + luminance_part, 1e-9);
    };
    return {weight(radiance.x), weight(radiance.y), weight(radiance.z)};
}

/// A view in the plane y = 0 with its lights, but without what it reflects.
View view_with_lights(const AveragedBrdf& brdf, const Vec3d& wv, const std::vector<Reflected>& reflected) {
    return {wv, {}, 0, place_lights(brdf.brdf(), to_float(wv), reflected), {}, {}};
}
/// The radiance under each of the view's lights: lights × 3.
MatrixXd radiances_of(const View& view, const AveragedBrdf& brdf, const std::vector<Reflected>& reflected) {
    MatrixXd radiances(Eigen::Index(view.lights.size()), 3);
    for (std::size_t i = 0; i < view.lights.size(); ++i) {
        const Vec3d sum = radiance_under(view.lights[i], brdf, to_float(view.wv), reflected);
        radiances.row(Eigen::Index(i)) << sum.x, sum.y, sum.z;
    }
    return radiances;
}
/// Sets what the view reflects: its albedo, and the radiance under each light.
void set_reflected(View& view, const Vec3d& total, const MatrixXd& radiances) {
    view.albedo = {float(total.x), float(total.y), float(total.z)};
    view.weight.resize(radiances.rows(), 3);
    for (Eigen::Index i = 0; i < radiances.rows(); ++i) {
        const Vec3d sum{radiances(i, 0), radiances(i, 1), radiances(i, 2)};
        const Vec3d weight = view.lights[std::size_t(i)].share * error_weights(sum + k_ambient * total);
        view.weight.row(i) << weight.x, weight.y, weight.z;
    }
    view.radiance = view.weight.cwiseProduct(radiances);
}

/// The direction to the viewer at this cosine to the normal.
Vec3d view_at(double cosine) { return {std::sqrt(1 - cosine * cosine), 0, cosine}; }

View view_of(const AveragedBrdf& brdf, double cosine) {
    const Vec3d wv = view_at(cosine);
    const std::vector<Reflected> reflected = sample_reflected(brdf, to_float(wv));
    View view = view_with_lights(brdf, wv, reflected);
    const Rgb of_all = albedo(brdf.brdf(), float(cosine));
    const Vec3d total{of_all.r, of_all.g, of_all.b};
    view.width = width_of(total, reflected);
    set_reflected(view, total, radiances_of(view, brdf, reflected));
    return view;
}

/// A least-squares problem in x = (p, r) of each lobe except the first: the squared errors of a view, plus
/// `k_ridge_of_lobes` times squared fractions, plus `smoothness` times the squared distances from `near`. The
/// weights are linear, and eliminated. The first lobe's weight is the remainder of the albedo.
class ViewProblem {
  public:
    ViewProblem(const View& view, const BlurredKernels& kernels, VectorXd near, double smoothness)
        : view_(view),
          kernels_(kernels),
          near_(std::move(near)),
          free_lobes_(int(near_.size()) / 2),
          smoothness_(repeat(near_, smoothness, smoothness)) {
        const double s = view_.wv.x;  // converts p to the angle of its axis
        for (Eigen::Index i = 0; i < near_.size(); i += 2)
            smoothness_[i] *= s * s / std::max(1 - near_[i] * near_[i] * s * s, 0.01);
    }

    double loss(const VectorXd& x) {
        const auto n = Eigen::Index(view_.lights.size());
        lobe_radiance_.resize(n, free_lobes_ + 1), by_axis_.resize(n, free_lobes_ + 1),
            by_roughness_.resize(n, free_lobes_ + 1);
        for (int k = 0; k <= free_lobes_; ++k) k == 0 ? set_lobe(0, 0, 1) : set_lobe(k, x[2 * k - 2], x[2 * k - 1]);
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
            for (int k = 0; k < free_lobes_; ++k) {
                const auto weight = view_.weight.col(Eigen::Index(c));
                J.col(2 * k).head(n) = weights[k] * weight.cwiseProduct(by_axis_.col(k + 1));
                J.col(2 * k + 1).head(n) = weights[k] * weight.cwiseProduct(by_roughness_.col(k + 1));
            }
            J -= A * gram.ldlt().solve(A.transpose() * J);  // the weights adapt
            H += J.transpose() * J;
            g += J.transpose() * error;
        }
    }
    VectorXd lower(const VectorXd& x) const { return repeat(x, -axis_limit(), ExtendedLight::k_least_roughness); }
    VectorXd upper(const VectorXd& x) const { return repeat(x, axis_limit(), 1); }
    VectorXd longest_step(const VectorXd& x) const { return repeat(x, 0.2, 0.2); }

    /// The squared errors at x of the last call of `loss`, as a function of a channel's fractions s: sᵀ H s − 2 gᵀ
    /// s plus a constant.
    struct Quadratic {
        MatrixXd H;
        VectorXd g;
    };
    Quadratic by_fractions(int c) const {
        const Channel& channel = channels_[std::size_t(c)];
        const double albedo = std::max(double(view_.albedo[c]), 1e-6);
        return {albedo * albedo * channel.gram, albedo * (channel.gram * channel.weights)};
    }

  private:
    /// A w − b. Its squares are errors under the lights and, in the last rows, the ridge.
    struct Channel {
        MatrixXd A, gram;  ///< AᵀA
        VectorXd weights, error;
    };
    void solve(int c, Channel& channel) const {
        const auto n = Eigen::Index(view_.lights.size());
        const double albedo = double(view_.albedo[c]);
        const VectorXd first = view_.weight.col(c).cwiseProduct(lobe_radiance_.col(0));
        channel.A.setZero(n + free_lobes_, free_lobes_);
        channel.A.topRows(n) = view_.weight.col(c).asDiagonal() * lobe_radiance_.rightCols(free_lobes_);
        channel.A.topRows(n).colwise() -= first;
        for (int k = 0; k < free_lobes_; ++k)
            channel.A(n + k, k) = std::sqrt(k_ridge_of_lobes) / std::max(albedo, 1e-6);
        VectorXd b = VectorXd::Zero(n + free_lobes_);
        b.head(n) = view_.radiance.col(c) - albedo * first;
        channel.gram = channel.A.transpose() * channel.A;
        channel.weights = channel.gram.ldlt().solve(channel.A.transpose() * b);
        channel.error = channel.A * channel.weights - b;
    }
    void set_lobe(int k, double p, double r) {
        const double s = view_.wv.x, c = std::sqrt(std::max(1 - p * p * s * s, 1e-12));
        const Vec3d axis{-p * s, 0, c},
            by_p{-s, 0, -p * s * s / std::max(c, 0.05)};  // its slope at the horizon is infinite
        for (Eigen::Index i = 0; i < lobe_radiance_.rows(); ++i) {
            const Light& light = view_.lights[std::size_t(i)];
            const auto kernel = kernels_.at(light.size, r, dot(axis, light.centre));
            lobe_radiance_(i, k) = kernel.value;
            by_axis_(i, k) = kernel.by_cosine * dot(by_p, light.centre);
            by_roughness_(i, k) = kernel.by_roughness;
        }
    }
    double axis_limit() const {
        const double sine = std::max(view_.wv.x, 1e-3);
        // keeps the axis above the horizon
        return std::min({k_most_axis, std::max(k_most_beyond / sine, 1.0), 0.999 / sine});
    }
    static VectorXd repeat(const VectorXd& x, double axis, double roughness) {
        VectorXd values(x.size());
        for (Eigen::Index i = 0; i < x.size(); ++i) values[i] = i % 2 == 0 ? axis : roughness;
        return values;
    }

    const View& view_;
    const BlurredKernels& kernels_;
    VectorXd near_;
    int free_lobes_;
    VectorXd smoothness_;
    MatrixXd lobe_radiance_, by_axis_, by_roughness_;  ///< lights × lobes, for weight 1
    std::array<Channel, 3> channels_;
};

/// The lobes' parameters x for all views.
class Tracks {
  public:
    Tracks(const std::vector<View>& views, const BlurredKernels& kernels, int lobes, int threads)
        : views_(views), kernels_(kernels), threads_(threads), x_(views.size()) {
        // One view at 45 degrees is fitted from several starts; from there on, each view begins with its
        // neighbour's lobes.
        std::size_t first = 0;
        while (views[first].wv.z < 0.7) ++first;
        x_[first] = best_of_starts(views[first], lobes);
        for (std::size_t v = first + 1; v < views.size(); ++v) x_[v] = refine(v, x_[v - 1], x_[v - 1]);
        for (std::size_t v = first; v-- > 0;) x_[v] = refine(v, x_[v + 1], x_[v + 1]);
        for (int sweep = 0; sweep < 2 * k_view_sweeps; ++sweep)  // even views, odd views
            parallel_for(views.size() / 2, threads, [&](std::size_t i) {
                const std::size_t v = 2 * i + std::size_t(sweep % 2), last = views_.size() - 1;
                const VectorXd &below = x_[v == 0 ? 1 : v - 1], &above = x_[v == last ? last - 1 : v + 1];
                x_[v] = refine(v, x_[v], 0.5 * (below + above));
            });
    }
    const VectorXd& operator[](std::size_t v) const { return x_[v]; }

  private:
    static constexpr LevenbergMarquardtOptions k_steps{.max_iterations = 30, .decrease_tolerance = 1e-4};

    VectorXd best_of_starts(const View& view, int lobes) const {
        std::vector<std::pair<double, VectorXd>> starts(k_lobe_starts);
        parallel_for(starts.size(), threads_, [&](std::size_t i) {
            RSequence<1> numbers({double(i) / k_lobe_starts});
            VectorXd x(2 * (lobes - 1));
            for (int k = 0; k < lobes - 1; ++k) {  // near the mirror direction, with roughnesses in ascending order
                x[2 * k] = 0.9;
                x[2 * k + 1] = 0.08 + 0.9 * (k + numbers.next()[0]) / (lobes - 1);
            }
            ViewProblem problem(view, kernels_, x, 0);
            const double loss = levenberg_marquardt(problem, x, k_steps).loss;
            starts[i] = {loss, std::move(x)};
        });
        return std::ranges::min(starts, {}, [](const auto& start) { return start.first; }).second;
    }
    VectorXd refine(std::size_t v, VectorXd x, const VectorXd& near) const {
        ViewProblem problem(views_[v], kernels_, near, k_smoothness * closeness(std::min(v, views_.size() - 2)));
        x = x.cwiseMax(problem.lower(x)).cwiseMin(problem.upper(x));
        levenberg_marquardt(problem, x, k_steps);
        return x;
    }

    const std::vector<View>& views_;
    const BlurredKernels& kernels_;
    int threads_;
    std::vector<VectorXd> x_;
};

/// The fractions of the lobes after the first for all views: one row for each view and lobe, with R, G, B. They
/// minimise the squared errors plus the squared differences between neighbours.
MatrixXd shares_of(const std::vector<View>& views, const BlurredKernels& kernels, const Tracks& tracks) {
    const Eigen::Index others = tracks[0].size() / 2, n = others * Eigen::Index(views.size());
    std::array<MatrixXd, 3> H;
    MatrixXd g = MatrixXd::Zero(n, 3), shares(n, 3);
    H.fill(MatrixXd::Zero(n, n));
    for (std::size_t v = 0; v < views.size(); ++v) {
        ViewProblem problem(views[v], kernels, tracks[v], 0);
        problem.loss(tracks[v]);
        const Eigen::Index first = others * Eigen::Index(v);
        for (int c = 0; c < 3; ++c) {
            const auto quadratic = problem.by_fractions(c);
            MatrixXd& channel_H = H[std::size_t(c)];
            channel_H.block(first, first, others, others) += quadratic.H,
                g.col(c).segment(first, others) += quadratic.g;
            if (v + 1 == views.size()) continue;
            const double smoothness = k_share_smoothness * elementary::square(closeness(v));
            for (Eigen::Index i = first; i < first + others; ++i) {
                channel_H(i, i) += smoothness, channel_H(i + others, i + others) += smoothness;
                channel_H(i, i + others) -= smoothness, channel_H(i + others, i) -= smoothness;
            }
        }
    }
    for (int c = 0; c < 3; ++c) shares.col(c) = H[std::size_t(c)].ldlt().solve(g.col(c));
    return shares;
}

/// The cosine of a node's view in fits: at the horizon views have no limit, along the normal no plane of incidence.
double fitted_cosine(std::size_t view) { return std::clamp(ExtendedLight::cosine(int(view)), 1e-4, 0.9999); }

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
void add_lobes(const View& view, const AveragedBrdf& three, Eigen::Index first, LobesOfView& to) {
    const Vec3f wv = to_float(view.wv);
    const std::vector<Reflected> reflected = sample_reflected(three, wv);
    const Rgb total = albedo(three.brdf(), wv.z);
    Eigen::Array3d largest = Eigen::Array3d::Constant(1e-9);
    for (const auto& [w, share, density] : reflected)
        largest = largest.max(k_view_samples * density * Eigen::Array3d(share.x, share.y, share.z));
    const Eigen::Index count = std::min<Eigen::Index>(3, to.albedo.size() - first);
    for (Eigen::Index c = 0; c < count; ++c) {
        to.albedo[first + c] = double(total[int(c)]);
        to.width[first + c] = to.albedo[first + c] / largest[c];
    }
    to.radiance.middleCols(first, count) = radiances_of(view, three, reflected).leftCols(count);
}

/// The view's errors for the channels `mix`, J × 3, of sums of lobes.
void set_channels(View& view, const LobesOfView& lobes, const MatrixXd& mix) {
    const Eigen::RowVector3d total = lobes.albedo.transpose() * mix;
    set_reflected(view, {total[0], total[1], total[2]}, lobes.radiance * mix);
}
/// Coefficients of three channels, a third of the lobes each by their width, so that the fit of axes and roughnesses
/// suits broad and narrow lobes.
MatrixXd thirds_by_width(const PmModel& model, const VectorXd& width) {
    const auto J = std::size_t(width.size());
    std::vector<std::size_t> order(J);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t j) { return width[Eigen::Index(j)]; });
    MatrixXd mix = MatrixXd::Zero(Eigen::Index(J), 3);
    for (std::size_t i = 0; i < J; ++i)
        mix(Eigen::Index(order[i]), Eigen::Index(3 * i / J)) = double(luminance(model.coefficient[order[i]]));
    return mix;
}
/// The view's errors for three lobes from `first` on, as if each were all that a typical material reflects: with its
/// albedo, and relative to its radiance `typical`.
void set_lobes(View& view, const LobesOfView& lobes, Eigen::Index first, const VectorXd& coefficient) {
    const double total = coefficient.dot(lobes.albedo);
    const VectorXd lit = (lobes.radiance * coefficient).array() + k_ambient * total;
    view.albedo = {float(total), float(total), float(total)};
    for (Eigen::Index c = 0; c < 3; ++c) {
        const Eigen::Index j = std::min(first + c, lobes.albedo.size() - 1);
        for (Eigen::Index i = 0; i < lit.size(); ++i)
            view.weight(i, c) = view.lights[std::size_t(i)].share / std::max(lit[i], 1e-9);
        view.radiance.col(c) =
            total / std::max(lobes.albedo[j], 1e-9) * view.weight.col(c).cwiseProduct(lobes.radiance.col(j));
    }
}

}  // namespace

double ExtendedLight::cosine(int node) { return elevation_cosine(double(node) / (k_views - 1)); }

std::vector<Lobe> lobes_at(const ExtendedLight& light, float cos_v) {
    const float position = elevation_coordinate(cos_v) * float(ExtendedLight::k_views - 1);
    const auto below = std::size_t(std::clamp(int(position), 0, ExtendedLight::k_views - 2)),
               K = std::size_t(light.lobes);
    const float fraction = position - float(below);
    const auto mix = [&](float x, float y) { return x + fraction * (y - x); };
    const Rgb total = albedo(light.brdf, cos_v);
    std::vector<Lobe> lobes;
    for (std::size_t k = 0; k < K; ++k) {
        const Lobe &a = light.lobe[below * K + k], &b = light.lobe[(below + 1) * K + k];
        Lobe& lobe = lobes.emplace_back(Lobe{mix(a.axis, b.axis), mix(a.roughness, b.roughness), {}});
        for (int c = 0; c < 3; ++c) lobe.weight[c] = std::min(total[c], 1.f) * mix(a.weight[c], b.weight[c]);
    }
    return lobes;
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
    const auto at_level = [&](int level) { return LevelKernel(roughness_of_level(level, levels))(double(cosine)); };
    return float(at_level(below) + (x - below) * (at_level(below + 1) - at_level(below)));
}

ExtendedLight extended_light(const PreparedBrdf& brdf, const ExtendedLightOptions& options) {
    assert(options.lobes >= k_least_extended_lobes && options.lobes <= k_most_extended_lobes);
    const BlurredKernels kernels(options.levels, options.threads);
    const AveragedBrdf averaged(brdf, options.isotropic);
    std::vector<View> views(ExtendedLight::k_views);
    parallel_for(views.size(), options.threads, [&](std::size_t v) { views[v] = view_of(averaged, fitted_cosine(v)); });
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

SharedLight shared_light(const PmModel& model, const ExtendedLightOptions& options) {
    const BlurredKernels kernels(options.levels, options.threads);
    const auto J = Eigen::Index(model.coefficient.size()), others = Eigen::Index(options.lobes - 1);
    std::vector<PreparedBrdf> threes;
    for (Eigen::Index j = 0; j < J; j += 3) threes.push_back(three_lobes(model, std::size_t(j)));
    const PreparedBrdf typical = prepare(Model{model, {}});
    std::vector<View> views(ExtendedLight::k_views);
    std::vector<LobesOfView> lobes(views.size());
    parallel_for(views.size(), options.threads, [&](std::size_t v) {
        const AveragedBrdf averaged(typical, options.isotropic);
        const Vec3d wv = view_at(fitted_cosine(v));
        views[v] = view_with_lights(averaged, wv, sample_reflected(averaged, to_float(wv)));
        lobes[v] = {VectorXd(J), VectorXd(J), MatrixXd(Eigen::Index(views[v].lights.size()), J)};
        for (Eigen::Index j = 0; j < J; j += 3)
            add_lobes(views[v], {threes[std::size_t(j / 3)], options.isotropic}, j, lobes[v]);
    });
    const MatrixXd thirds = thirds_by_width(model, lobes[views.size() / 2].width);
    for (std::size_t v = 0; v < views.size(); ++v) set_channels(views[v], lobes[v], thirds);
    const Tracks tracks(views, kernels, options.lobes, options.threads);

    SharedLight light{options.lobes, {}, {}, {}};
    light.weight.resize(views.size() * std::size_t(others * J));
    VectorXd coefficient(J);
    for (Eigen::Index j = 0; j < J; ++j) coefficient[j] = double(luminance(model.coefficient[std::size_t(j)]));
    for (Eigen::Index first = 0; first < J; first += 3) {
        for (std::size_t v = 0; v < views.size(); ++v) set_lobes(views[v], lobes[v], first, coefficient);
        const MatrixXd shares = shares_of(views, kernels, tracks);
        for (Eigen::Index i = 0; i < shares.rows(); ++i)
            for (Eigen::Index j = first; j < std::min(first + 3, J); ++j)
                light.weight[std::size_t(i * J + j)] =
                    float(shares(i, j - first) * lobes[std::size_t(i / others)].albedo[j]);
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
        light.width.push_back(float(lobes[v].width.minCoeff()));
        for (Eigen::Index k = 0; k < others; ++k)
            light.shape.push_back({float(tracks[v][2 * k]), float(tracks[v][2 * k + 1])});
    }
    return light;
}

}  // namespace srbf
