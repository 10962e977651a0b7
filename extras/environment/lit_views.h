// The light that a BRDF reflects towards a viewer under lights of several sizes, the data to which lobes are fitted.
#pragma once
#include <Eigen/Dense>

#include "extras/environment/filter_kernels.h"
#include "srbf/prepared.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {

inline constexpr int k_view_samples = 2048;  ///< number of samples of reflected light; albedos are within about 0.3 %
/// The radiance of an ambient light beside a light of radiance 1. Errors are relative to the radiance under both.
inline constexpr double k_ambient = 0.1 / k_pi;

/// A light with the shape of K around a direction, and the square root of its weight in the mean over directions.
struct KernelLight {
    std::size_t size;
    Vec3d centre;
    double root_weight;
};

/// The radiance of a view under each light.
struct LitView {
    Vec3d wv;
    Rgb albedo;
    float width = 0;
    std::vector<KernelLight> lights;
    Eigen::MatrixXd weight;    ///< lights × 3: weights of errors of R, G, B
    Eigen::MatrixXd radiance;  ///< lights × 3: weight × radiance
};

/// A BRDF that, if it is anisotropic, is sampled at another azimuth each time, so that sums belong to its mean over
/// azimuths.
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
    Vec3d w, weight;
    double density;
};
std::vector<Reflected> sample_reflected(const AveragedBrdf& brdf, const Vec3f& wv);

/// The radiance under each of the view's lights: lights × 3.
Eigen::MatrixXd radiances_of(const LitView& view, const AveragedBrdf& brdf, const std::vector<Reflected>& reflected);

/// A view in the plane y = 0 at this cosine to the normal, with its lights and the radiance that it reflects.
LitView lit_view(const AveragedBrdf& brdf, double cosine);
/// The cosine of a node's view in fits: at the horizon views have no limit, along the normal no plane of incidence.
double fitted_cosine(std::size_t view);

}  // namespace
