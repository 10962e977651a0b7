// Targets for libFuzzer and for the test of the corpus, which run a reader on arbitrary bytes.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "brdf/directions.h"
#include "measured/bytes.h"
#include "measured/formats.h"
#include "measured/readers.h"
#include "models/model_files.h"
#include "require.h"
#include "srbf/convert.h"
#include "srbf/load.h"
#include "srbf/map.h"
#include "srbf/measured.h"
#include "srbf/model.h"
#include "srbf/prepared.h"
#include "srbf/sampling.h"
#ifdef SRBF_RENDER
#include "extras/render/environment.h"
#include "extras/render/mesh.h"
#include "extras/render/path.h"
#endif

namespace srbf {

/// Checks that an error is one line of bounded length that names its source.
inline void check_error(const Error& error) {
    const std::string line = message(error);
    require(line.starts_with("f: ") && line.size() < 2000 && line.find('\n') == line.npos, "an error is one line");
}

inline bool is_finite_and_not_negative(const Rgb& f) { return is_finite(f) && f.r >= 0 && f.g >= 0 && f.b >= 0; }

/// Checks that spectra, if there are any, satisfy the contract of `Brdf` at each wavelength.
template <typename B> void check_spectra(const B& brdf, std::span<const Vec3f> wl, std::span<const Vec3f> wv) {
    if (wavelengths(brdf).empty()) return;
    Channels spectral;
    if constexpr (std::is_same_v<B, Model>)
        spectral = channels(brdf);
    else
        spectral = spectra(brdf);
    std::vector<float> f(spectral.count() * wl.size());
    spectral.evaluate(wl, wv, f);
    for (const float x : f) require(std::isfinite(x) && x >= 0, "finite spectra, not negative");
}

/// True for BSDFs.
template <typename B> bool is_two_sided(const B& brdf) {
    if constexpr (std::is_same_v<B, Model>) return std::holds_alternative<BsdfModel>(brdf.model);
    if constexpr (std::is_same_v<B, Measured>) return std::holds_alternative<BsdfTable>(brdf.table);
    return false;
}

/// Checks that a BRDF satisfies the contract of `Brdf`, and a BSDF that of its parts.
template <typename B> void check_values(const Result<B>& brdf) {
    if (!brdf) return check_error(brdf.error());
    std::mt19937_64 random(1);
    std::vector<Vec3f> lights, views;
    const auto direction = [&random] {
        const double z = 2 * uniform(random) - 0.5, theta = std::acos(std::min(1.0, z));  // a quarter is the normal
        return to_float(spherical(theta, 7 * uniform(random)));
    };
    for (int i = 0; i < 24; ++i) {
        Vec3f wl = direction(), wv = direction();
        if (i % 6 == 1) wl = {0, 0, 1};
        if (i % 6 == 2) wv = mirror(wl);
        if (i % 6 == 3) wv = wl;
        if (i % 6 == 4) wv = {1, 0, 1e-30f};
        lights.push_back(wl);
        views.push_back(wv);
        const Rgb f = value(*brdf, wl, wv);
        if ((wl.z <= 0 || wv.z <= 0) && !is_two_sided(*brdf)) {
            require(f == Rgb{}, "0 below the horizon");
            continue;
        }
        const bool is_masked = std::isnan(f.r) && std::isnan(f.g) && std::isnan(f.b);
        require(is_masked || is_finite_and_not_negative(f), "finite and not negative, or NaN");
    }
    std::vector<Rgb> f(lights.size());
    evaluator (*brdf)(lights, views, f);
    for (const Rgb& c : f) require(std::isnan(c.r) || is_finite_and_not_negative(c), "batches, too");
    if constexpr (std::is_same_v<B, Model> || std::is_same_v<B, Measured>) check_spectra(*brdf, lights, views);
}

/// A target, with the name of its folder in the corpus.
struct NamedTarget {
    std::string name;
    std::function<void(std::span<const std::byte>)> check;
};

/// Repeats the bytes to fill a UTIA table, which has a fixed size.
inline void check_utia(std::span<const std::byte> bytes) {
    check_values(read_utia(bytes, "f"));
    if (bytes.empty()) return;
    std::vector<std::byte> table(3 * 288 * 288 * sizeof(double));
    for (std::size_t i = 0; i < table.size(); i += bytes.size())
        std::memcpy(&table[i], bytes.data(), std::min(bytes.size(), table.size() - i));
    check_values(read_utia(table, "f"));
}

/// Checks a table as a `Measured`, whose evaluator works in batches and has spectra.
template <typename Table> void check_measured(Result<Table> table) {
    check_values(table ? Result<Measured>(Measured{"f", "", 0, *std::move(table)}) : Result<Measured>(table.error()));
}

/// Checks that what was read can be written, and that reading and writing it again gives the same bytes. (The first
/// writing may change bytes: that of a model normalises weights.)
template <typename T, typename Read, typename Write> void check_round_trip(const T& content, Read read, Write write) {
    const auto written = write(content);
    const auto reread = read(written, "f");
    require(reread.ok() && write(*reread) == written, "write(read(written)) = written");
}

inline void check_mbsdf(std::span<const std::byte> bytes) {
    const auto table = read_mbsdf(bytes, "f");
    check_measured(table);
    if (!table) return;
    check_round_trip(*table, read_mbsdf, [](const MbsdfTable& t) { return write_mbsdf(t); });
    require(read_mbsdf(write_mbsdf(*table), "f")->metadata.size() == table->metadata.size(), "metadata are kept");
}

inline void check_model(std::span<const std::byte> bytes) {
    const auto model = read_model(bytes, "f");
    check_values(model);
    if (model) check_round_trip(*model, read_model, [](const Model& m) { return write_model(m); });
}

/// Checks a model file with the given header, in which all numbers are 1.
inline void check_header(std::span<const std::byte> header) {
    constexpr std::size_t k_length_bytes = 8, k_numbers = 31;  // the size of the headers in the corpus
    std::vector<std::byte> file;
    for (std::size_t i = 0; i < k_length_bytes; ++i)
        file.push_back(std::byte(std::uint64_t(header.size()) >> 8 * i & 0xff));
    file.insert(file.end(), header.begin(), header.end());
    for (std::size_t i = 0; i < k_numbers; ++i) file.insert(file.end(), {std::byte(0x00), std::byte(0x3c)});
    check_model(file);
}

inline void check_map(std::span<const std::byte> bytes) {
    const auto map = read_map(bytes, "f");
    if (!map) return check_error(map.error());
    check_round_trip(*map, read_map, write_map);
    check_values(Result<Model>(texel(*map, 0)));
}

#ifdef SRBF_RENDER
/// Checks that a mesh has triangles with valid vertices, finite positions and unit normals.
inline void check_mesh(const Result<Mesh>& mesh) {
    if (!mesh) return check_error(mesh.error());
    require(!mesh->triangles.empty() && mesh->normals.size() == mesh->positions.size(), "triangles and normals");
    for (const Triangle& t : mesh->triangles)
        for (const std::uint32_t i : t) require(i < mesh->positions.size(), "indices in range");
    for (const Vec3f& p : mesh->positions)
        require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite positions");
    for (const Vec3f& n : mesh->normals) require(std::abs(dot(n, n) - 1) < 1e-5f, "unit normals");
    require(mesh->texture.empty() || mesh->texture.size() == mesh->triangles.size(), "places in a map of all or none");
    for (const auto& corners : mesh->texture)
        for (const Vec2f& uv : corners) require(std::isfinite(uv.x) && std::isfinite(uv.y), "finite places in a map");
}

/// Pictures of meshes with more triangles would take too long.
inline constexpr std::size_t k_max_triangles = 1 << 14;

/// Checks that a picture of a mesh is finite.
inline void check_picture(const Result<Mesh>& mesh) {
    check_mesh(mesh);
    if (!mesh || mesh->triangles.size() > k_max_triangles) return;
    const Scene scene = scene_of(*mesh, {}, 1);
    const Mesh floor = ground_below(*mesh, scene.camera.up);
    static const std::vector<PathMaterial> materials{diffuse({0.5f, 0.5f, 0.5f})};
    const PathScene paths{{{&*mesh, 0}, {&floor, 0}}, materials, scene.camera, scene.lights, {}, nullptr};
    const PathPicture picture =
        render_paths(paths, {.width = 4, .height = 4, .samples = 1, .threads = 1, .progress = {}});
    for (const Rgb& c : picture.rendering.radiance.pixels) require(is_finite(c), "a picture of finite radiance");
    for (const float depth : picture.first.depth) require(std::isfinite(depth), "of finite depth");
}

/// Checks that an environment has finite radiance, and samples unit vectors.
inline void check_environment(const Result<Environment>& environment) {
    if (!environment) return check_error(environment.error());
    for (const Rgb& c : environment->texels().pixels)
        require(is_finite_and_not_negative(c), "light is finite and not negative");
    std::mt19937_64 random(1);
    for (int i = 0; i < 8; ++i) {
        const float u1 = float(uniform(random)), u2 = float(uniform(random));
        const Vec3f w = environment->sample(u1, u2);
        require(std::abs(dot(w, w) - 1) < 1e-4f, "a direction");
        const auto light = environment->at(w);
        require(light.pdf >= 0 && std::isfinite(light.pdf), "a density");
        require(is_finite(light.radiance), "finite between texels, too");
    }
}
#endif

/// Checks that samples for views down to the horizon are unit vectors with positive density and finite weight, or none.
inline void check_samples(const PreparedBrdf& brdf) {
    std::mt19937_64 random(1);
    for (const float cosine : {1.f, 0.8f, 0.3f, 0.01f, 1e-6f, 1e-30f, 0.f, -0.5f}) {
        const Vec3f wv{std::sqrt(1 - cosine * cosine), 0, cosine};
        for (int i = 0; i < 16; ++i) {
            const float u = float(uniform(random)), v = float(uniform(random)), selector = float(uniform(random));
            const LightSample s = sample(brdf, wv, {std::min(u, 0.9999999f), v}, std::min(selector, 0.9999999f));
            require(is_finite_and_not_negative(s.weight), "a finite weight");
            require(std::isfinite(s.pdf) && s.pdf >= 0, "a density");
            if (s.pdf > 0) require(s.wl.z > 0 && std::abs(dot(s.wl, s.wl) - 1) < 1e-4f, "a direction to the light");
        }
    }
}
inline void check_albedo(const PreparedBrdf& brdf) {
    for (const float cosine : {1.f, 0.5f, 0.01f, 1e-7f, 0.f}) {
        const Rgb a = albedo(brdf, cosine);
        require(is_finite_and_not_negative(a), "an albedo is finite and not negative");
    }
}

/// Targets that do more than read.
inline const NamedTarget k_targets[] = {
    {"utia", check_utia},
    {"mbsdf", check_mbsdf},
    {"columns",
     [](auto bytes) {
         check_values(
             read_measured(bytes, "f", {"theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,532nm", Quantity::factor, 1e-4f}));
         check_values(
             read_measured(bytes, "f", {"theta_i theta_s 532nm phi_l_deg=180 phi_v_deg=0", Quantity::cosine, 0}));
     }},
    {"measured", [](auto bytes) { check_values(read_measured(bytes, "f")); }},
    {"model", check_model},
    {"header", check_header},
    {"map", check_map},
#ifdef SRBF_RENDER
    {"ply", [](auto bytes) { check_picture(read_ply(bytes, "f")); }},
    {"obj", [](auto bytes) { check_picture(read_obj(bytes, "f")); }},
    {"environment", [](auto bytes) { check_environment(read_environment(bytes, "f")); }},
#endif
};

}  // namespace srbf

#include "generated/fuzz/extra_targets.h"
#include "measured/tables.h"

namespace srbf {

/// All targets: the ones above, the targets of extras, and the readers of other formats, named like "astm_e1392".
inline std::vector<NamedTarget> all_targets() {
    std::vector<NamedTarget> all(std::begin(k_targets), std::end(k_targets));
    for (const std::span<const NamedTarget> extra : k_extra_targets) all.insert(all.end(), extra.begin(), extra.end());
    for (const Format& format : formats()) {
        std::string name;
        for (const char c : format.name) name += c == ' ' ? '_' : char(std::tolower(static_cast<unsigned char>(c)));
        if (std::ranges::find(all, name, &NamedTarget::name) != all.end()) continue;
        all.push_back({name, [&format](auto bytes) { check_values(read_as(format, bytes, "f")); }});
    }
    return all;
}

}  // namespace srbf
