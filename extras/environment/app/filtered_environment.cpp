#include "extras/environment/app/filtered_environment.h"

#include <bit>
#include <cassert>
#include <mutex>

#include "base/half.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "src/base/parallel.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of samples of K for each texel; small levels, whose kernels are wide, have more. Eight times as many
/// change ΔE_ITP of pictures of glossy paints by 0.1 of 8.
constexpr int k_min_samples = 256, k_max_samples = 8192, k_level_samples = 1 << 24;
/// A sample reads texels this many times as large as its solid angle, so that neighbours overlap.
constexpr double k_overlap = 2;

/// The direction through (s, t) of a face, from −1 to 1 to the right and downwards.
Vec3d through_face(std::size_t face, double s, double t) {
    switch (face) {
        case 0:
            return {1, -t, -s};
        case 1:
            return {-1, -t, s};
        case 2:
            return {s, 1, t};
        case 3:
            return {s, -1, -t};
        case 4:
            return {s, -t, 1};
        default:
            return {-s, -t, -1};
    }
}
struct FacePosition {
    std::size_t face;
    double s, t;
};
FacePosition face_position(const Vec3d& w) {
    const double x = std::abs(w.x), y = std::abs(w.y), z = std::abs(w.z);
    if (x >= y && x >= z) return {w.x > 0 ? std::size_t(0) : 1, (w.x > 0 ? -w.z : w.z) / x, -w.y / x};
    if (y >= z) return {w.y > 0 ? std::size_t(2) : 3, w.x / y, (w.y > 0 ? w.z : -w.z) / y};
    return {w.z > 0 ? std::size_t(4) : 5, (w.z > 0 ? w.x : -w.x) / z, -w.y / z};
}
double centre_of(int i, int side) { return (2 * i + 1.0) / side - 1; }
std::size_t index_of(int side, std::size_t face, int x, int y) {
    return (face * std::size_t(side) + std::size_t(y)) * std::size_t(side) + std::size_t(x);
}

/// The environment as cube images: the first has `side` texels along a side, each further one half as many.
class Pyramid {
  public:
    Pyramid(const Environment& source, int side, int threads) {
        Image map = source.texels();  // latitude and longitude; a face is a quarter of its width
        while (map.width >= 8 * side && map.height > 1) map = halved(map);
        const Environment environment(std::move(map));
        levels_.push_back({side, std::vector<Rgb>(std::size_t(6 * side * side))});
        parallel_for(std::size_t(6 * side), threads, [&](std::size_t row) {
            for (int x = 0; x < side; ++x) {
                const std::size_t face = row / std::size_t(side);
                const int y = int(row % std::size_t(side));
                const Vec3d w = normalize(through_face(face, centre_of(x, side), centre_of(y, side)));
                levels_[0].texels[index_of(side, face, x, y)] = environment.at(to_float(w)).radiance;
            }
        });
        for (int half = side / 2; half > 0; half /= 2) {
            CubeImage next{half, std::vector<Rgb>(std::size_t(6 * half * half))};
            const std::vector<Rgb>& texels = levels_.back().texels;
            for (std::size_t face = 0; face < 6; ++face)
                for (int y = 0; y < half; ++y)
                    for (int x = 0; x < half; ++x) {
                        const auto texel = [&](int i, int j) {
                            return texels[index_of(2 * half, face, 2 * x + i, 2 * y + j)];
                        };
                        next.texels[index_of(half, face, x, y)] =
                            mixed(mixed(texel(0, 0), texel(1, 0), 0.5f), mixed(texel(0, 1), texel(1, 1), 0.5f), 0.5f);
                    }
            levels_.push_back(std::move(next));
        }
    }
    const CubeImage& finest() const { return levels_[0]; }
    /// The level whose texels have this solid angle [sr].
    double level_of(double solid_angle) const {
        const double finest = 4 * k_pi / double(levels_[0].texels.size());
        return std::clamp(0.5 * std::log2(solid_angle / finest), 0.0, double(levels_.size() - 1));
    }
    Rgb at(const Vec3d& w, double level) const {
        const auto below = std::min(std::size_t(level), levels_.size() - 2);
        return mixed(levels_[below].at(w), levels_[below + 1].at(w), float(level - double(below)));
    }

  private:
    std::vector<CubeImage> levels_;
};

/// A direction in the frame of the kernel's axis z, its fraction of ∫ K dω, and the level of the pyramid to read.
struct Sample {
    Vec3d w;
    double weight, level;
};
/// Samples K. Their spacing is proportional to their distance from z: K falls slowly, and a lamp far from z may be
/// brighter by as much. With t = tan(θ/2) and u uniform in [0, 1), t = α/2 ((1 + 2/α)ᵘ − 1), α = r².
std::vector<Sample> sample_kernel(float roughness, int count, const Pyramid& pyramid, double texel) {
    constexpr double k_golden_angle = 2.39996322972865332;
    const double half = 0.5 * std::pow(double(roughness), 2), range = std::log1p(1 / half);
    std::vector<Sample> samples;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double u = (i + 0.5) / count, growth = std::exp(range * u), t = half * (growth - 1);
        const double c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t), phi = k_golden_angle * i;
        // dω = 2π sinθ dθ, dθ = 2 dt / (1 + t²), dt = half range grown du
        const double solid_angle = 2 * k_pi * s * 2 / (1 + t * t) * half * range * growth / count;
        const double weight = solid_angle * double(filter_kernel(roughness, float(c)));
        samples.push_back({{s * std::cos(phi), s * std::sin(phi), c},
                           weight,
                           pyramid.level_of(std::max(k_overlap * solid_angle, texel))});
        sum += weight;
    }
    for (Sample& sample : samples) sample.weight /= sum;
    return samples;
}

}  // namespace

Rgb CubeImage::at(const Vec3d& w) const {
    const FacePosition position = face_position(w);
    const double x = (position.s + 1) / 2 * side - 0.5, y = (position.t + 1) / 2 * side - 0.5, left = std::floor(x),
                 top = std::floor(y);
    const auto inner = [&](int k) { return std::clamp(k, 0, side - 1); };
    // Beyond an edge, the texel belongs to the adjacent face.
    const auto across = [&](int i, int j) {
        const auto on_edge = [&](int k) { return std::clamp(centre_of(k, side), -1 - 1e-9, 1 + 1e-9); };
        const FacePosition neighbour = face_position(through_face(position.face, on_edge(i), on_edge(j)));
        const auto nearest = [&](double coordinate) { return inner(int((coordinate + 1) / 2 * side)); };
        return texels[index_of(side, neighbour.face, nearest(neighbour.s), nearest(neighbour.t))];
    };
    const auto texel = [&](int i, int j) {
        const bool in_row = i == inner(i), in_column = j == inner(j);
        if (in_row && in_column) return texels[index_of(side, position.face, i, j)];
        if (in_row || in_column) return across(i, j);
        // Three texels meet at a corner.
        const Rgb mean = mixed(across(i, inner(j)), across(inner(i), j), 0.5f);
        return mixed(mean, texels[index_of(side, position.face, inner(i), inner(j))], 1.f / 3);
    };
    const int i = int(left), j = int(top);
    const float s = float(x - left);
    return mixed(mixed(texel(i, j), texel(i + 1, j), s), mixed(texel(i, j + 1), texel(i + 1, j + 1), s),
                 float(y - top));
}

FilteredEnvironment::FilteredEnvironment(const Environment& environment, int size, int threads,
                                         const std::function<void(double)>& progress) {
    assert(std::has_single_bit(unsigned(size)) && size >= k_min_size && size <= k_largest_size);
    const Pyramid pyramid(environment, size, threads);
    levels_.push_back(pyramid.finest());
    // The finest filtered level has three quarters of the texels, and the fewest samples for each.
    constexpr double k_first_fraction = 0.75;
    std::mutex reporting;
    double done = 0;
    for (int k = 1; k < k_levels; ++k) {
        const int side = size >> k;
        const double texel = 4 * k_pi / (6.0 * side * side);
        const std::vector<Sample> samples = sample_kernel(
            float(roughness_of_level(k)), std::clamp(k_level_samples / (6 * side * side), k_min_samples, k_max_samples),
            pyramid, texel);
        CubeImage& level = levels_.emplace_back(CubeImage{side, std::vector<Rgb>(std::size_t(6 * side * side))});
        const double fraction = k == 1 ? k_first_fraction : (1 - k_first_fraction) / (k_levels - 2);
        parallel_for(std::size_t(6 * side), threads, [&](std::size_t row) {
            const std::size_t face = row / std::size_t(side);
            const int y = int(row % std::size_t(side));
            for (int x = 0; x < side; ++x) {
                const Frame axes = frame_about(normalize(through_face(face, centre_of(x, side), centre_of(y, side))));
                std::array<double, 3> sum{};
                for (const Sample& sample : samples) {
                    const Rgb light = pyramid.at(axes.from(sample.w), sample.level);
                    for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += sample.weight * double(light[c]);
                }
                level.texels[index_of(side, face, x, y)] = {float(sum[0]), float(sum[1]), float(sum[2])};
            }
            if (!progress) return;
            const std::lock_guard lock(reporting);
            progress(done += fraction / (6 * side));
        });
    }
}

Rgb FilteredEnvironment::at(Vec3f w, float roughness) const {
    const float level = std::sqrt(std::clamp(roughness, 0.f, 1.f)) * float(k_levels - 1);
    const int below = std::min(int(level), k_levels - 2);
    const Vec3d towards = to_double(w);
    return mixed(levels_[std::size_t(below)].at(towards), levels_[std::size_t(below) + 1].at(towards),
                 level - float(below));
}

CubeFile to_dds(const FilteredEnvironment& environment) {
    // DDS_HEADER with its DDS_PIXELFORMAT, of Microsoft's "Programming Guide for DDS": D3DFMT_A16B16G16R16F replaces
    // the four characters.
    constexpr std::uint32_t k_caps_height_width_pitch_format_levels = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000 | 0x20000,
                            k_four_characters = 0x4, k_halves = 113, k_complex_texture_mipmap = 0x8 | 0x1000 | 0x400000,
                            k_cube_of_all_faces = 0x200 | 0xfc00;
    const auto size = std::uint32_t(environment.level(0).side);
    std::array<std::uint32_t, 32> header{0x20534444,
                                         124,
                                         k_caps_height_width_pitch_format_levels,
                                         size,
                                         size,
                                         8 * size,
                                         0,
                                         FilteredEnvironment::k_levels};
    header[19] = 32;
    header[20] = k_four_characters;
    header[21] = k_halves;
    header[27] = k_complex_texture_mipmap;
    header[28] = k_cube_of_all_faces;
    CubeFile file;
    const auto append = [&](const auto& numbers) {
        const auto bytes = std::as_bytes(std::span(numbers));
        file.bytes.insert(file.bytes.end(), bytes.begin(), bytes.end());
    };
    append(header);
    for (std::size_t face = 0; face < 6; ++face)
        for (int k = 0; k < FilteredEnvironment::k_levels; ++k) {
            const std::size_t texels = environment.level(k).texels.size() / 6;
            for (const Rgb& texel : std::span(environment.level(k).texels).subspan(face * texels, texels)) {
                file.clamped += std::max({texel.r, texel.g, texel.b}) > k_half_max;
                append(std::array{to_half(std::min(texel.r, k_half_max)), to_half(std::min(texel.g, k_half_max)),
                                  to_half(std::min(texel.b, k_half_max)), to_half(1.f)});
            }
        }
    return file;
}

}  // namespace
