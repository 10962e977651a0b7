#include "extras/render/path.h"

#include <atomic>
#include <cassert>
#include <mutex>

#include "brdf/directions.h"
#include "extras/render/rays.h"
#include "extras/render/shading.h"
#include "src/base/parallel.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr int k_tile = 16;     // pixels per side
constexpr int k_roulette = 3;  // bounces before Russian roulette

Rgb operator*(const Rgb& a, const Rgb& b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
Rgb operator*(float s, const Rgb& a) { return {s * a.r, s * a.g, s * a.b}; }
Rgb& operator+=(Rgb& a, const Rgb& b) { return a = {a.r + b.r, a.g + b.g, a.b + b.b}; }
float largest(const Rgb& a) { return std::max({a.r, a.g, a.b}); }
Vec3f operator-(Vec3f a) { return -1.f * a; }

/// A 64-bit hash of x (SplitMix64, Steele, Lea & Flood 2014).
constexpr std::uint64_t k_step = 0x9e3779b97f4a7c15;
std::uint64_t hash(std::uint64_t x) {
    x += k_step;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}

/// Random numbers uniform in [0,1) for one path. The first `k_low_discrepancy` numbers of the paths of a pixel form
/// an R sequence: path i uses multiples i of powers of 1/g, where g^(k_low_discrepancy+1) = g + 1 (Roberts 2018),
/// with a random offset. The others are independent.
class Random {
  public:
    Random(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample)
        : sample_(sample), shift_(hash(hash(seed) ^ pixel)), state_(hash(shift_ ^ sample)) {}
    float next() {
        state_ += k_step;
        if (taken_ >= k_low_discrepancy) return in_unit(hash(state_));
        const auto d = taken_++;
        return in_unit(hash(shift_ + k_step * (d + 1)) + sample_ * steps()[d]);
    }
    /// Skips the remaining low-discrepancy numbers.
    void independent() { taken_ = k_low_discrepancy; }

  private:
    static constexpr std::size_t k_low_discrepancy = 10;
    static float in_unit(std::uint64_t x) { return float(x >> 40) * 0x1p-24f; }
    static const std::array<std::uint64_t, k_low_discrepancy>& steps() {
        static const auto powers = [] {
            double g = 1.5;
            for (int i = 0; i < 60; ++i) g = std::pow(1 + g, 1.0 / (k_low_discrepancy + 1));
            std::array<std::uint64_t, k_low_discrepancy> step;
            for (std::size_t d = 0; d < k_low_discrepancy; ++d)
                step[d] = std::uint64_t(std::pow(1 / g, double(d + 1)) * 0x1p64);
            return step;
        }();
        return powers;
    }
    std::uint64_t sample_, shift_, state_;
    std::size_t taken_ = 0;
};

/// Three axes in float; shading uses a frame whose z axis is the normal.
struct Axes {
    Vec3f x, y, z;
    Vec3f to(Vec3f w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
    Vec3f from(Vec3f w) const { return w.x * x + w.y * y + w.z * z; }
};
Axes to_axes(const Frame& frame) { return {to_float(frame.x), to_float(frame.y), to_float(frame.z)}; }

/// The power heuristic: the weight of a sample with density `a` if another technique has density `b`.
float power_heuristic(float a, float b) { return a > 0 ? 1 / (1 + (b / a) * (b / a)) : 0; }

struct Surface {
    Vec3f position;
    Vec3f geometric;                    ///< normal on the viewer's side
    Axes axes;                          ///< around the shading normal, which for a BRDF is on the viewer's side
    const PreparedBsdf* body_material;  ///< the body's material, or the chosen one; null for a map
    std::optional<PreparedBsdf> point_material;  ///< material of a map at this point
    Vec3f wv;  ///< direction to the viewer in `axes`; z is the normal of a BSDF's front

    const PreparedBsdf& material() const { return body_material ? *body_material : *point_material; }
};

/// The result of tracing one path.
struct PathResult {
    Rgb radiance, albedo;
    Vec3f normal{};
    float depth = 0;
    bool hit = false;
    std::uint32_t rays = 0;
};

class Tracer {
  public:
    explicit Tracer(const PathScene& scene, const PathOptions& options)
        : scene_(scene),
          options_(options),
          meshes_(meshes_of(scene)),
          rays_(meshes_),
          camera_(to_axes(frame(scene.camera))),
          environment_axes_(to_axes(environment_frame(scene.camera))) {
        // Offset of a ray's origin from the surface, proportional to the size of the scene.
        double size = 0;
        for (const Mesh* mesh : meshes_) {
            const Bounds box = bounds(*mesh);
            const Vec3d diagonal = to_double(box.max) - to_double(box.min);
            const double length = std::sqrt(dot(diagonal, diagonal));
            size = size == 0 ? length : std::min(size, length);
        }
        offset_ = float(1e-4 * std::min(size, 1e6));
        half_ = float(std::tan(scene.camera.fov / 2));
        eye_ = to_float(scene.camera.eye);
    }

    PathResult path(float s, float t, Random& random) const {
        const float aspect = float(options_.width) / float(options_.height);
        Vec3f origin = eye_, direction = camera_.from(normalize(Vec3f{half_ * aspect * s, half_ * t, -1}));
        PathResult result;
        Rgb throughput{1, 1, 1};
        float sampled_pdf = 0;  // density of the direction; 0: a camera ray, which was not sampled
        for (int bounce = 0;; ++bounce) {
            ++result.rays;
            const auto hit = is_free(bounce) ? std::nullopt : rays_.closest(origin, direction);
            add_lights(result.radiance, throughput, origin, direction, hit ? hit->distance : k_infinity, sampled_pdf);
            if (!hit || bounce == options_.bounces) return result;
            const Surface surface = surface_at(*hit, direction, random);
            if (bounce == 0) {
                result.hit = true;
                result.depth = hit->distance;
                result.normal = camera_.to(surface.wv.z > 0 ? surface.axes.z : -surface.axes.z);
            }
            add_sampled_lights(result, throughput, surface, random);

            const Vec2f u{random.next(), random.next()};
            const BsdfSample bounce_sample = sample(surface.material(), surface.wv, u, random.next());
            if (!(largest(bounce_sample.weight) > 0)) return result;
            sampled_pdf = bounce_sample.pdf;
            if (bounce == 0) result.albedo = bounce_sample.weight;
            throughput = throughput * bounce_sample.weight;
            random.independent();
            direction = surface.axes.from(bounce_sample.wl);
            if (!is_consistent(surface, bounce_sample.wl, direction)) return result;
            origin = origin_of(surface, direction);
            if (bounce >= k_roulette) {
                const float survival_probability = std::min(largest(throughput), 0.95f);
                if (!(random.next() < survival_probability)) return result;
                throughput = (1 / survival_probability) * throughput;
            }
        }
    }

    Axes camera() const { return camera_; }

  private:
    /// True if nothing can stop the path after that many bounces.
    bool is_free(int bounce) const { return bounce > 0 && !options_.occlusion; }

    static constexpr float k_infinity = std::numeric_limits<float>::infinity();

    static std::vector<const Mesh*> meshes_of(const PathScene& scene) {
        std::vector<const Mesh*> meshes;
        for (const Body& body : scene.bodies) meshes.push_back(body.mesh);
        return meshes;
    }

    Surface surface_at(const Hit& hit, Vec3f direction, Random& random) const {
        const Body& body = scene_.bodies[hit.mesh];
        const Triangle& triangle = body.mesh->triangles[hit.triangle];
        const float weight = 1 - hit.u - hit.v;
        const auto interpolated = [&](const std::vector<Vec3f>& values) {
            return weight * values[triangle[0]] + hit.u * values[triangle[1]] + hit.v * values[triangle[2]];
        };
        Surface surface{};
        surface.position = interpolated(body.mesh->positions);
        surface.body_material = std::get_if<PreparedBsdf>(&scene_.materials[body.material]);
        if (const auto* map = std::get_if<PreparedMap>(&scene_.materials[body.material]))
            surface.point_material = brdf_at(*map, texture_at(*body.mesh, hit));
        else if (const auto* masked = std::get_if<MaskedMaterials>(&scene_.materials[body.material]))
            surface.body_material = &masked->chosen(texture_at(*body.mesh, hit), random.next());
        surface.geometric = dot(hit.geometric_normal, direction) < 0 ? hit.geometric_normal : -hit.geometric_normal;
        Vec3f normal = interpolated(body.mesh->normals);
        if (!(dot(normal, normal) > 1e-12f)) normal = surface.geometric;
        if (dot(normal, surface.geometric) < 0) normal = -normal;
        normal = Shading<float>::visible_normal(normal, -direction);
        const bool is_back = !surface.material().is_brdf() && dot(hit.geometric_normal, direction) > 0;
        const float side = is_back ? -1.f : 1.f;
        surface.axes = to_axes(surface_frame(to_double(side * normal)));
        surface.wv = surface.axes.to(-direction);
        return surface;
    }

    /// True if a direction is on the same side of the triangle as of the shading normal's horizon.
    bool is_consistent(const Surface& surface, Vec3f wl, Vec3f direction) const {
        return !options_.occlusion || dot(direction, surface.geometric) * (wl.z * surface.wv.z > 0 ? 1.f : -1.f) > 0;
    }
    Vec3f origin_of(const Surface& surface, Vec3f direction) const {
        return surface.position + (dot(direction, surface.geometric) > 0 ? offset_ : -offset_) * surface.geometric;
    }

    Rgb value_at(const Surface& surface, Vec3f wl) const {
        const Rgb f = value(surface.material(), wl, surface.wv);
        return is_finite(f) ? f : Rgb{};
    }

    /// Adds f cosθl times the radiance from `direction` if nothing is closer than `distance`. Uses multiple
    /// importance sampling for density `light_pdf`; 0 means a light with a single direction, which needs none.
    void add_light(PathResult& result, const Rgb& throughput, const Surface& surface, Vec3f direction, float distance,
                   const Rgb& arriving, float light_pdf) const {
        const Vec3f wl = surface.axes.to(direction);
        if (!is_consistent(surface, wl, direction)) return;
        const Rgb f = value_at(surface, wl);
        if (!(largest(f) > 0)) return;
        if (options_.occlusion) {
            ++result.rays;
            if (rays_.occluded(origin_of(surface, direction), direction, distance - offset_)) return;
        }
        const float brdf_pdf = light_pdf > 0 ? pdf(surface.material(), wl, surface.wv) : 0;
        const float scale = light_pdf > 0 ? power_heuristic(light_pdf, brdf_pdf) / light_pdf : 1;
        result.radiance += (scale * std::abs(wl.z)) * (throughput * f * arriving);
    }

    void add_sampled_lights(PathResult& result, const Rgb& throughput, const Surface& surface, Random& random) const {
        for (const DirectionalLight& light : scene_.lights)
            add_light(result, throughput, surface, to_float(light.towards), k_infinity, light.irradiance, 0);
        if (has_environment()) {
            const float u1 = random.next(), u2 = random.next();
            const Vec3f w = scene_.environment->sample(u1, u2);
            if (const auto light = scene_.environment->at(w); light.pdf > 0)
                add_light(result, throughput, surface, environment_axes_.from(w), k_infinity, light.radiance,
                          light.pdf);
        }
        if (!scene_.area_lights.empty()) {
            const float position = random.next() * float(scene_.area_lights.size()), u1 = random.next(),
                        u2 = random.next();
            const AreaLight& light = scene_.area_lights[std::min(std::size_t(position), scene_.area_lights.size() - 1)];
            const Vec3f offset = light.corner + u1 * light.x + u2 * light.y - seen_from(surface);
            const float distance = std::sqrt(dot(offset, offset));
            const Vec3f direction = (1 / distance) * offset;
            if (const float density = area_pdf(light, direction, distance); density > 0)
                add_light(result, throughput, surface, direction, distance, light.radiance, density);
        }
    }

    Vec3f seen_from(const Surface& surface) const { return surface.position + offset_ * surface.geometric; }
    bool has_environment() const { return scene_.environment && !scene_.environment->is_black(); }

    /// The density of sampling a direction by a point of this light; 0 from behind.
    float area_pdf(const AreaLight& light, Vec3f direction, float distance) const {
        const Vec3f normal = cross(light.x, light.y);
        const float facing = -dot(normal, direction);  // area times cosine
        return facing > 0 ? distance * distance / (facing * float(scene_.area_lights.size())) : 0;
    }

    /// Adds the emission along a ray up to `distance`, whose direction was sampled with density `sampled_pdf`.
    void add_lights(Rgb& radiance, const Rgb& throughput, Vec3f origin, Vec3f direction, float distance,
                    float sampled_pdf) const {
        const auto add = [&](const Rgb& arriving, float light_pdf) {
            radiance += (sampled_pdf > 0 ? power_heuristic(sampled_pdf, light_pdf) : 1) * (throughput * arriving);
        };
        for (const AreaLight& light : scene_.area_lights) {
            const Vec3f normal = cross(light.x, light.y);
            const float hit_distance = dot(light.corner - origin, normal) / dot(direction, normal),
                        squared_area = dot(normal, normal);
            const Vec3f p = origin + hit_distance * direction - light.corner;
            const float s = dot(cross(p, light.y), normal) / squared_area,
                        t = dot(cross(light.x, p), normal) / squared_area;
            if (!(hit_distance > 0 && hit_distance < distance && s >= 0 && s <= 1 && t >= 0 && t <= 1)) continue;
            if (const float density = area_pdf(light, direction, hit_distance); density > 0)
                add(light.radiance, density);
        }
        if (distance < k_infinity || !has_environment()) return;
        const auto light = scene_.environment->at(environment_axes_.to(direction));
        add(light.radiance, light.pdf);
    }

    const PathScene& scene_;
    const PathOptions& options_;
    std::vector<const Mesh*> meshes_;
    Rays rays_;
    Axes camera_, environment_axes_;
    float offset_ = 0, half_ = 0;
    Vec3f eye_;
};

}  // namespace

Rgb mask_fractions(const Image& mask, std::size_t materials, Vec2f uv) {
    const auto wrapped = [](float at, int size) { return (int(at) % size + size) % size; };
    const float x = (uv.x - std::floor(uv.x)) * float(mask.width) - 0.5f,
                y = (uv.y - std::floor(uv.y)) * float(mask.height) - 0.5f;
    Rgb texel;
    for (const float column : {std::floor(x), std::floor(x) + 1})
        for (const float row : {std::floor(y), std::floor(y) + 1})
            texel += ((1 - std::abs(x - column)) * (1 - std::abs(y - row))) *
                     mask.at(wrapped(column, mask.width), wrapped(row, mask.height));
    const float second = std::min(texel.r, 1.f), third = materials > 2 ? std::min(texel.g, 1 - second) : 0;
    return {1 - second - third, second, third};
}

const PreparedBsdf& MaskedMaterials::chosen(Vec2f uv, float selector) const {
    const Rgb fractions = mask_fractions(mask, materials.size(), uv);
    return materials[selector < fractions.g ? 1 : selector < fractions.g + fractions.b ? 2 : 0];
}

PathPicture render_paths(const PathScene& scene, const PathOptions& options) {
    assert(options.width >= 1 && options.height >= 1 && options.samples >= 1 && options.bounces >= 1);
    const Tracer tracer(scene, options);
    const int width = options.width, height = options.height;
    const auto pixels = std::size_t(width) * std::size_t(height);
    const Image black(width, height);
    PathPicture picture{{black, std::vector<float>(pixels)}, {black, black, std::vector<float>(pixels)}};
    const int columns = (width + k_tile - 1) / k_tile, rows = (height + k_tile - 1) / k_tile;
    std::atomic<std::uint64_t> rays{0};
    std::mutex reporting;
    int done = 0;
    parallel_for(std::size_t(columns * rows), options.threads, [&](std::size_t tile) {
        const int left = int(tile) % columns * k_tile, top = int(tile) / columns * k_tile;
        std::uint64_t tile_rays = 0;
        for (int y = top; y < std::min(top + k_tile, height); ++y)
            for (int x = left; x < std::min(left + k_tile, width); ++x) {
                const auto pixel = std::size_t(y) * std::size_t(width) + std::size_t(x);
                std::array<double, 11> sum{};
                for (int i = 0; i < options.samples; ++i) {
                    Random random(options.seed, pixel, std::uint64_t(i));
                    const float dx = random.next(), dy = random.next();
                    const PathResult result = tracer.path(2 * (float(x) + dx) / float(width) - 1,
                                                          1 - 2 * (float(y) + dy) / float(height), random);
                    const float values[] = {result.radiance.r,
                                            result.radiance.g,
                                            result.radiance.b,
                                            result.normal.x,
                                            result.normal.y,
                                            result.normal.z,
                                            result.albedo.r,
                                            result.albedo.g,
                                            result.albedo.b,
                                            result.depth,
                                            result.hit || largest(result.radiance) > 0 ? 1.f : 0.f};
                    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += double(values[k]);
                    tile_rays += result.rays;
                }
                const auto mean = [&](std::size_t k) { return float(sum[k] / options.samples); };
                const float coverage = scene.environment ? 1 : mean(10);
                if (coverage > 0)
                    picture.rendering.radiance.pixels[pixel] = (1 / coverage) * Rgb{mean(0), mean(1), mean(2)};
                picture.rendering.coverage[pixel] = coverage;
                picture.first.normal.pixels[pixel] = {mean(3), mean(4), mean(5)};
                picture.first.albedo.pixels[pixel] = {mean(6), mean(7), mean(8)};
                picture.first.depth[pixel] = mean(9);
            }
        rays += tile_rays;
        if (!options.progress) return;
        const std::lock_guard lock(reporting);
        options.progress(double(++done) / (columns * rows));
    });
    picture.rays = rays;
    return picture;
}

Mesh ground_below(const Mesh& mesh, Vec3d up, double size) {
    const Bounds box = bounds(mesh);
    const Vec3d min = to_double(box.min), max = to_double(box.max), middle = 0.5 * (min + max), extent = max - min;
    const Vec3d n = normalize(up), x = normalize(cross(std::abs(n.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0), n)),
                y = cross(n, x);
    // The lowest corner of the bounding box along `up`.
    double lowest = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3d corner{i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z};
        lowest = std::min(lowest, dot(corner - middle, n));
    }
    const double half = 0.5 * size * std::max({extent.x, extent.y, extent.z});
    const auto corner_at = [&](double s, double t) {
        return to_float(middle + lowest * n + (s * half) * x + (t * half) * y);
    };
    Mesh ground;
    ground.positions = {corner_at(-1, -1), corner_at(1, -1), corner_at(1, 1), corner_at(-1, 1)};
    ground.normals.assign(4, to_float(n));
    ground.triangles = {{0, 1, 2}, {0, 2, 3}};
    return ground;
}

}  // namespace
