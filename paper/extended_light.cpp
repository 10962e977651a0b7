// Errors of pictures by a few lobes for each view (srbf/extended_light.h), without occlusion. Environments are files
// .hdr or .exr, models .srbf.
//   usage: extended_light [MESH..] [ENVIRONMENT..] MODEL..
// Prints for each model, and in the mean, ΔE_ITP and PSNR of a sphere and the meshes under the environments by the
// number of lobes, those of the split sum for models with one lobe of GGX, and those of a sphere under three rectangles
// of light. References under environments are integrals by a low-discrepancy sequence, since the noise of 2048 paths
// has a visible error. References under rectangles are path-traced.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "errors/sphere.h"
#include "extras/environment/app/filtered_environment.h"
#include "extras/render/path.h"
#include "extras/render/rays.h"
#include "extras/render/shading.h"
#include "srbf/extended_light.h"
#include "srbf/kernel.h"
#include "srbf/load.h"
#include "src/base/parallel.h"
#include "src/base/r_sequence.h"
#include "src/sampling/elevation_nodes.h"

namespace srbf {
namespace kernel {

template <Number Real> Real acos(Real x) { return std::acos(x); }
template <Number Real> Real abs(Real x) { return std::abs(x); }

/// The functions of exported code, compiled as C++.
struct ExportedLight {
    using Real = float;
    using Vec3 = Triple<float>;
    struct NodesAbout {
        int below;
        float beyond;
    };
    static NodesAbout nodes_about(float coordinate, int count) {
        const float at = std::clamp(coordinate, 0.f, 1.f) * float(count - 1);
        const int below = std::min(int(at), count - 2);
        return {below, at - float(below)};
    }
    static float elevation_coordinate(float cosine) { return srbf::elevation_coordinate(std::clamp(cosine, 0.f, 1.f)); }
    struct Pm {};
    const ExtendedLight& lobes;
    static constexpr int EXTENDED_LOBES = k_max_extended_lobes;  ///< those that `lobes` lacks have weight 0
    static constexpr int EXTENDED_NODES = ExtendedLight::k_views, EXTENDED_LEVELS = ExtendedLight::k_levels;
    const PreparedBrdf& material;
    const FilteredEnvironment* map = nullptr;
    Frame map_axes{};
    static inline thread_local const Frame* surface = nullptr;  ///< the frame of the shaded point
    ExportedLight(const PreparedBrdf& brdf, const ExtendedLight& light) : lobes(light), material(brdf) {}
    template <typename Number> float between(NodesAbout nodes, const Number& number) {
        const float below = number(std::size_t(nodes.below)), above = number(std::size_t(nodes.below) + 1);
        return below + nodes.beyond * (above - below);
    }
    ExtendedLight::Lobe lobe(int k, std::size_t node) {
        if (k >= lobes.lobes) return {0, 1, {}};
        return lobes.lobe[node * std::size_t(lobes.lobes) + std::size_t(k)];
    }
    static float light_roughness(int, float view_roughness) { return view_roughness; }
    Vec3 light_shape(int k, NodesAbout nodes) {
        return {between(nodes, [&](std::size_t i) { return lobe(k, i).axis; }),
                between(nodes, [&](std::size_t i) { return lobe(k, i).roughness; }), 0};
    }
    Vec3 light_weight(int k, Vec3 whole, NodesAbout nodes, Pm) {
        const auto fraction = [&](int c) {
            return between(nodes, [&](std::size_t i) { return lobe(k, i).weight[c]; });
        };
        return {whole.x * fraction(0), whole.y * fraction(1), whole.z * fraction(2)};
    }
    float light_width(NodesAbout nodes) {
        return between(nodes, [&](std::size_t i) { return lobes.width[i]; });
    }
    Vec3 light_whole(Vec3 albedo) {
        return {std::min(albedo.x, 1.f), std::min(albedo.y, 1.f), std::min(albedo.z, 1.f)};
    }
    static Vec3 reflected(Vec3 weight, Vec3 radiance) {
        return {weight.x * radiance.x, weight.y * radiance.y, weight.z * radiance.z};
    }
    Vec3 directional_albedo(float cosine, Pm) {
        const Rgb a = albedo(material, cosine);
        return {a.r, a.g, a.b};
    }
    Vec3 brdf(Vec3 wl, Vec3 wv, Pm) {
        const Rgb f = value(material, {wl.x, wl.y, wl.z}, {wv.x, wv.y, wv.z});
        return {f.r, f.g, f.b};
    }
#include "brdf/directions.h"
#include "extras/environment/code/extended.glsl"
};
Triple<float> ExportedLight::radiance(Vec3 direction, float roughness) {
    const Rgb light = map->at(to_float(map_axes.to(surface->from(to_double(direction)))), roughness);
    return {light.r, light.g, light.b};
}

}  // namespace kernel

namespace {

constexpr int k_size = 32, k_points = 4;  ///< pixels, and points in a pixel, along a side
constexpr int k_paths = 2048;
constexpr int k_draws = 256;  ///< samples of the BRDF, and of an environment, for each point: 4096 of each for a pixel

/// A point of a pixel: its local frame, and the direction to the viewer in that frame.
struct Point {
    Vec3f position;
    Frame axes;
    Vec3f wv;
};
struct Pixel {
    std::size_t index;
    std::vector<Point> points;
};
/// The pixels that the surface covers.
std::vector<Pixel> pixels_of(const Mesh& mesh, const Camera& camera) {
    const Rays rays({&mesh});
    std::vector<Pixel> pixels;
    for (int y = 0; y < k_size; ++y)
        for (int x = 0; x < k_size; ++x) {
            Pixel pixel{std::size_t(y) * k_size + std::size_t(x), {}};
            for (int k = 0; k < k_points * k_points; ++k) {
                const double s = 2 * (x + (k % k_points + 0.5) / k_points) / k_size - 1,
                             t = 1 - 2 * (y + (k / k_points + 0.5) / k_points) / k_size;
                const Vec3f direction = to_float(direction_through(camera, 1, s, t));
                const Vec3f to_viewer = -1.f * direction;
                const auto hit = rays.closest(to_float(camera.eye), direction);
                if (!hit) break;
                const Triangle& triangle = mesh.triangles[hit->triangle];
                const auto interpolate = [&](const std::vector<Vec3f>& values) {
                    return (1.f - hit->u - hit->v) * values[triangle[0]] + hit->u * values[triangle[1]] +
                           hit->v * values[triangle[2]];
                };
                Vec3f normal = interpolate(mesh.normals);
                if (dot(normal, hit->geometric_normal) < 0) normal = -1.f * normal;
                normal = Shading<float>::visible_normal(normal, to_viewer);
                const Frame axes = surface_frame(to_double(normal));
                pixel.points.push_back({interpolate(mesh.positions), axes, to_float(axes.to(to_double(to_viewer)))});
            }
            if (pixel.points.size() == k_points * k_points) pixels.push_back(std::move(pixel));
        }
    return pixels;
}

template <typename F> Image draw(const std::vector<Pixel>& pixels, const F& radiance) {
    Image image(k_size, k_size);
    parallel_for(pixels.size(), 0, [&](std::size_t i) {
        Rgb& pixel = image.pixels[pixels[i].index];
        for (const Point& point : pixels[i].points) {
            const Rgb value = radiance(point);
            for (int c = 0; c < 3; ++c) pixel[c] += value[c] / float(pixels[i].points.size());
        }
    });
    return image;
}
Image mask(const std::vector<Pixel>& pixels, const Image& image) {
    Image masked(k_size, k_size);
    for (const Pixel& pixel : pixels) masked.pixels[pixel.index] = image.pixels[pixel.index];
    return masked;
}

struct Errors {
    double delta_e = 0, psnr = 0, count = 0;
    void add(const Errors& other) { delta_e += other.delta_e, psnr += other.psnr, count += other.count; }
    std::string text() const { return fmt::format("{:.2f}, {:.1f}", delta_e / count, psnr / count); }
};
/// Errors of pixels displayed with the reference's exposure.
Errors errors_of(const std::vector<Pixel>& pixels, const Image& reference, const Image& other) {
    const float exposure = exposure_to(reference, k_exposed_value);
    Errors errors;
    double squares = 0;
    const auto display = [&](const Rgb& c) {
        return Rgb{std::clamp(exposure * c.r, 0.f, 1.f), std::clamp(exposure * c.g, 0.f, 1.f),
                   std::clamp(exposure * c.b, 0.f, 1.f)};
    };
    for (const Pixel& pixel : pixels) {
        const Rgb a = display(reference.pixels[pixel.index]), b = display(other.pixels[pixel.index]);
        errors.delta_e += delta_e_itp(a, b) / double(pixels.size());
        for (int c = 0; c < 3; ++c) squares += std::pow(double(srgb_encoded(a[c]) - srgb_encoded(b[c])), 2) / 3;
    }
    errors.psnr = std::min(-10 * std::log10(squares / double(pixels.size())), 100.0);
    errors.count = 1;
    return errors;
}

/// The split sum of renderers for Lambert and one lobe of GGX: irradiance, and one look-up along the mirror direction,
/// bent to the normal as in three.js, scaled to the directional albedo.
Rgb split_sum(const GgxModel& model, const PreparedBrdf& brdf, const FilteredEnvironment& map, const Frame& to_map,
              const Point& point) {
    const float roughness = std::sqrt(model.lobes[0].roughness);
    const Vec3f mirrored{-point.wv.x, -point.wv.y, point.wv.z};
    const float bend = roughness * roughness;
    Vec3d axis = to_double((1 - bend) * mirrored) + Vec3d{0, 0, double(bend)};
    const auto filtered = [&](const Vec3d& w, float r) {
        return map.at(to_float(to_map.to(point.axes.from(normalize(w)))), r);
    };
    const Rgb total = albedo(brdf, point.wv.z), glossy = filtered(axis, roughness), diffuse = filtered({0, 0, 1}, 1);
    Rgb sum;
    for (int c = 0; c < 3; ++c) {
        const float diffuse_albedo = std::min(model.diffuse[c], total[c]);
        sum[c] = diffuse_albedo * diffuse[c] + (total[c] - diffuse_albedo) * glossy[c];
    }
    return sum;
}

constexpr std::array<int, 5> k_lobe_counts{2, 3, 4, 6, 8};
constexpr std::size_t k_default_lobes = 3;  ///< an index of k_lobe_counts
/// Rectangles outside of the picture of a sphere of radius 1, seen from +z: a small one, a large one, and a near one at
/// grazing angles, which extends below the horizon of most points.
const std::array<AreaLight, 3> k_rectangles{{
    {{-1.2f, 2, 2.2f}, {0.1f, 0.2f, -0.1f}, {0.25f, 0, 0.25f}, {1, 1, 1}},
    {{-2.5f, 2.5f, -1}, {3, 0, 0}, {0, 0, 3}, {1, 1, 1}},
    {{1.35f, -1.5f, -1.2f}, {0, 0, 2.4f}, {0, 3, 0}, {1, 1, 1}},
}};

/// A sample of an environment.
struct EnvironmentDraw {
    Vec3f w;
    Environment::Light light;
};
constexpr std::size_t k_environment_draws = 1 << 16;
std::vector<EnvironmentDraw> draws_of(const Environment& environment) {
    std::vector<EnvironmentDraw> draws;
    RSequence<2> numbers;
    for (std::size_t i = 0; i < k_environment_draws; ++i) {
        const auto& u = numbers.next();
        const Vec3f w = environment.sample(float(u[0]), float(u[1]));
        draws.push_back({w, environment.at(w)});
    }
    return draws;
}

struct Map {
    std::string name;
    Environment environment;
    FilteredEnvironment filtered;
    std::vector<EnvironmentDraw> draws;
};
/// ∫ f cosθl L dω towards the viewer, in the mean over a pixel's points, by samples of the BRDF and of the environment
/// with the balance heuristic (Veach & Guibas 1995). The points of a pixel share one sequence.
Rgb reflected(const Pixel& pixel, const PreparedBrdf& brdf, const Map& map, const Frame& to_map) {
    std::array<double, 3> sum{};
    const auto add = [&](double weight, const Rgb& reflectance, const Rgb& light) {
        for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += weight * double(reflectance[c]) * double(light[c]);
    };
    constexpr std::size_t k_stride = 7919;
    RSequence<3> numbers;
    numbers = RSequence<3>(numbers.at(pixel.index * k_stride));
    std::size_t drawn = pixel.index * k_stride;
    for (const Point& point : pixel.points)
        for (int i = 0; i < k_draws; ++i) {
            const auto& u = numbers.next();
            const LightSample sampled = sample(brdf, point.wv, {float(u[0]), float(u[1])}, float(u[2]));
            if (sampled.pdf > 0 && sampled.wl.z > 0) {
                const auto light = map.environment.at(to_float(to_map.to(point.axes.from(to_double(sampled.wl)))));
                add(double(sampled.pdf) / (double(sampled.pdf) + double(light.pdf)), sampled.weight, light.radiance);
            }
            const auto& [w, light] = map.draws[drawn++ % k_environment_draws];
            const Vec3f wl = to_float(point.axes.to(to_map.from(to_double(w))));
            if (wl.z > 0)
                add(double(wl.z) / (double(pdf(brdf, wl, point.wv)) + double(light.pdf)), value(brdf, wl, point.wv),
                    light.radiance);
        }
    const double count = double(k_draws) * double(pixel.points.size());
    return {float(sum[0] / count), float(sum[1] / count), float(sum[2] / count)};
}
Image reference_picture(const std::vector<Pixel>& pixels, const PreparedBrdf& brdf, const Map& map,
                        const Frame& to_map) {
    Image image(k_size, k_size);
    parallel_for(pixels.size(), 0,
                 [&](std::size_t i) { image.pixels[pixels[i].index] = reflected(pixels[i], brdf, map, to_map); });
    return image;
}

struct Object {
    std::string name;
    Mesh mesh;
    Camera camera;
    std::vector<Pixel> pixels;
};
/// Errors of a model, over environments and objects.
struct Row {
    std::array<Errors, k_lobe_counts.size()> by_lobes;
    Errors split;
    std::array<Errors, k_rectangles.size()> by_rectangle;  ///< with the default number of lobes
    void add(const Row& other) {
        for (std::size_t k = 0; k < by_lobes.size(); ++k) by_lobes[k].add(other.by_lobes[k]);
        for (std::size_t i = 0; i < by_rectangle.size(); ++i) by_rectangle[i].add(other.by_rectangle[i]);
        split.add(other.split);
    }
    void print(const std::string& name) const {
        fmt::print("| {} |", name);
        for (const Errors& errors : by_lobes) fmt::print(" {} |", errors.text());
        fmt::print(" {} |", split.count > 0 ? split.text() : "");
        for (const Errors& errors : by_rectangle) fmt::print(" {} |", errors.text());
        fmt::print("\n");
        std::fflush(stdout);
    }
};

Row row_of(const Model& model, const std::vector<Map>& maps, const std::vector<Object>& objects) {
    const PreparedBrdf brdf = prepare(model);
    const auto* ggx = std::get_if<GgxModel>(&model.model);
    std::vector<ExtendedLight> lobes;
    for (const int count : k_lobe_counts) lobes.push_back(extended_light(brdf, {.lobes = count}));
    std::vector<kernel::ExportedLight> lights;
    for (const ExtendedLight& light : lobes) lights.emplace_back(brdf, light);
    Row row;
    for (const Object& object : objects) {
        const Frame axes = environment_frame(object.camera);
        for (const Map& map : maps) {
            const Image reference = reference_picture(object.pixels, brdf, map, axes);
            for (std::size_t k = 0; k < lights.size(); ++k) {
                lights[k].map = &map.filtered, lights[k].map_axes = axes;
                const Image picture = draw(object.pixels, [&](const Point& point) {
                    kernel::ExportedLight::surface = &point.axes;
                    const Vec3f c = lights[k].environment(point.wv, {});
                    return Rgb{c.x, c.y, c.z};
                });
                row.by_lobes[k].add(errors_of(object.pixels, reference, picture));
            }
            if (ggx && ggx->lobes.size() == 1)
                row.split.add(errors_of(object.pixels, reference, draw(object.pixels, [&](const Point& point) {
                                            return split_sum(*ggx, brdf, map.filtered, axes, point);
                                        })));
        }
    }
    const Object& sphere = objects[0];
    for (std::size_t i = 0; i < k_rectangles.size(); ++i) {
        const AreaLight& light = k_rectangles[i];
        const PathScene scene{{{&sphere.mesh, 0}}, {brdf}, sphere.camera, {}, {light}, nullptr};
        const PathOptions options{
            .width = k_size, .height = k_size, .samples = k_paths, .occlusion = false, .progress = {}};
        const Image reference = mask(sphere.pixels, render_paths(scene, options).rendering.radiance);
        row.by_rectangle[i].add(
            errors_of(sphere.pixels, reference, draw(sphere.pixels, [&](const Point& point) {
                          const auto corner = [&](const Vec3f& add) {
                              return to_float(point.axes.to(to_double(light.corner + add - point.position)));
                          };
                          const Vec3f c = lights[k_default_lobes].area(point.wv, corner({}), corner(light.x),
                                                                       corner(light.x + light.y), corner(light.y), {});
                          return Rgb{c.x, c.y, c.z};
                      })));
    }
    return row;
}

Result<Done> print_tables(int count, char** arguments) {
    std::vector<Map> maps;
    std::vector<Object> objects;
    std::vector<std::pair<std::string, Model>> models;
    for (int i = 1; i < count; ++i) {
        const std::filesystem::path path = arguments[i];
        const std::string name = path.stem().string(), kind = path.extension().string();
        if (kind == ".hdr" || kind == ".exr") {
            auto environment = load_environment(path.string());
            if (!environment) return environment.error();
            FilteredEnvironment filtered(*environment);
            auto draws = draws_of(*environment);
            maps.push_back({name, *std::move(environment), std::move(filtered), std::move(draws)});
        } else if (kind == ".srbf") {
            auto model = load_brdf(path.string());
            if (!model) return model.error();
            models.emplace_back(name, std::get<Model>(*std::move(model)));
        } else {
            auto mesh = load_mesh(path.string());
            if (!mesh) return mesh.error();
            objects.push_back({name, *std::move(mesh), {}, {}});
        }
    }
    objects.insert(objects.begin(), {"sphere", sphere(128), {}, {}});
    for (Object& object : objects) {
        object.camera = camera_of(object.mesh, {.elevation = 0}, 1);
        object.pixels = pixels_of(object.mesh, object.camera);
    }
    fmt::print("| mean ΔE_ITP, PSNR [dB] | {} lobes | split sum | small rectangle | large | near |\n",
               fmt::join(k_lobe_counts, " | "));
    Row mean;
    for (const auto& [name, model] : models) {
        const Row row = row_of(model, maps, objects);
        row.print(name);
        mean.add(row);
    }
    mean.print("mean");
    return Done{};
}

}  // namespace
}  // namespace srbf

int main(int count, char** arguments) {
    const auto printed = srbf::print_tables(count, arguments);
    if (!printed) fmt::print(stderr, "{}\n", srbf::message(printed.error()));
    return printed ? 0 : 1;
}
