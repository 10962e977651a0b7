#include "srbf/convert.h"

#include <fmt/ranges.h>

#include "base/parallel.h"
#include "base/printable.h"
#include "brdf/colour.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "brdf/values.h"
#include "measured/angles.h"
#include "measured/bytes.h"
#include "measured/formats/format_rows.h"
#include "measured/formats/tensor_file.h"
#include "measured/formats/warp.h"
#include "measured/samples.h"
#include "srbf/elementary.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {

namespace {

/// f_r is not evaluated at smaller cosines (89.7°), since it may grow without bound towards the horizon.
constexpr float k_horizon = 5e-3f;

std::vector<Rgb> values_at(const Evaluate& brdf, std::span<const Vec3f> wl, std::span<const Vec3f> wv) {
    std::vector<Rgb> f(wl.size());
    brdf(wl, wv, f);
    return f;
}

double u_of(std::size_t i, std::size_t n) { return double(i) / double(n - 1); }
double theta_of(double u) { return u * u * k_pi / 2; }

constexpr std::size_t k_profile = 256;            // nodes of D and σ
constexpr std::uint32_t k_normals = 128;          // nodes of the visible normals, as in the database
constexpr int k_azimuths = 64;                    // number of azimuths φ_d
constexpr double k_min_determining_cosine = 0.1;  // directions with smaller cosines do not determine D
// The uniform fraction of D. Without it a narrow highlight leaves only a few nodes to the directions around it, which
// are dark, but fill most of a picture.
constexpr double k_uniform = 0.1;

/// D at the nodes u = i/(n−1), not normalised: the largest f (cosθl cosθv)^¾ of the directions with this half vector. D
/// determines the positions of the warp's nodes. With means instead, highlights that are visible only near the horizon
/// would fall between nodes.
std::vector<float> half_vector_profile(const Evaluate& brdf, int threads) {
    std::vector<double> max(k_profile);
    parallel_for(k_profile, threads, [&](std::size_t i) {
        std::vector<Vec3f> wl, wv;
        for (int d = 0; d <= 85; d += 5)
            for (int p = 0; p < k_azimuths; ++p) {
                const auto pair = merl_pair(theta_of(u_of(i, k_profile)), d * k_degree, (p + 0.5) / k_azimuths * k_pi);
                if (std::min(pair.wl.z, pair.wv.z) < k_min_determining_cosine) continue;
                wl.push_back(to_float(pair.wl)), wv.push_back(to_float(pair.wv));
            }
        const auto f = values_at(brdf, wl, wv);
        max[i] = f.empty() ? -1 : 0;
        for (std::size_t k = 0; k < f.size(); ++k)
            if (is_finite(f[k]))
                max[i] = std::max(max[i], luminance(f[k]) * elementary::pow(double(wl[k].z) * double(wv[k].z), 0.75));
    });
    // Near the horizon there are no pairs, and the last value is repeated.
    const double largest = *std::ranges::max_element(max);
    double last = 1;
    std::vector<float> profile;
    for (const double x : max) {
        last = x < 0 ? last : largest > 0 ? x / largest : 1;
        profile.push_back(float(last));
    }
    return profile;
}

/// ∫ D(m) max(0, m·ω) dm by the midpoint rule in u, with ω at θ.
double projected_area(const RglTable::Profile& ndf, double theta) {
    constexpr int polar = 1024;
    double sum = 0;
    for (int i = 0; i < polar; ++i) {
        const double u = (i + 0.5) / polar, m = theta_of(u), s = elementary::sin(m) * elementary::sin(theta),
                     c = elementary::cos(m) * elementary::cos(theta);
        // Closed form in azimuth: ∫ max(0, c + s cosφ) dφ.
        const double edge = c >= s ? k_pi : c <= -s ? 0 : elementary::acos(-c / s);
        sum += double(at(ndf, float(u))) * 2 * (c * edge + s * elementary::sin(edge)) * elementary::sin(m) * k_pi * u /
               polar;
    }
    return sum;
}

/// The normal of a facet at a position in the unit square of the warp.
Vec3d normal_at(double x, double y) { return spherical(theta_of(x), (2 * y - 1) * k_pi); }

/// The mirror direction of w about the microfacet normal m.
Vec3d reflect(Vec3d w, Vec3d m) { return 2 * dot(w, m) * m - w; }

/// Calls visit(other) for a node of a grid and its neighbours.
template <typename Visit>
void for_neighbours(std::size_t node, std::size_t width, std::size_t height, const Visit& visit) {
    const std::size_t x = node % width, y = node / width;
    for (std::size_t j = y - (y > 0); j < std::min(y + 2, height); ++j)
        for (std::size_t i = x - (x > 0); i < std::min(x + 2, width); ++i) visit(j * width + i);
}

/// Sets unknown nodes to the mean of their known neighbours, layer by layer. A row has `width` nodes.
void fill_unknown(std::span<Rgb> nodes, std::vector<char> known, std::size_t width) {
    for (bool grew = true; grew;) {
        grew = false;
        const std::vector<char> before = known;
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            if (before[node]) continue;
            int count = 0;
            Rgb sum;
            for_neighbours(node, width, nodes.size() / width, [&](std::size_t other) {
                count += before[other];
                for (int c = 0; c < 3 && before[other]; ++c) sum[c] += nodes[other][c];
            });
            if (count == 0) continue;
            for (int c = 0; c < 3; ++c) nodes[node][c] = sum[c] / float(count);
            known[node] = grew = true;
        }
    }
}

struct NewField {
    std::string_view name;
    TensorType type;
    std::vector<std::uint64_t> shape;
    std::span<const std::byte> numbers;
};
std::vector<std::byte> write_tensor_file(std::span<const NewField> fields) {
    std::uint64_t offset = k_tensor_magic.size() + 6;
    for (const NewField& field : fields) offset += 13 + field.name.size() + 8 * field.shape.size();
    std::vector<std::byte> bytes;
    const auto append = [&](std::span<const std::byte> raw) { bytes.insert(bytes.end(), raw.begin(), raw.end()); };
    append(as_bytes(k_tensor_magic));
    store(bytes, std::uint8_t(1));
    store(bytes, std::uint8_t(0));
    store(bytes, std::uint32_t(fields.size()));
    for (const NewField& field : fields) {
        store(bytes, std::uint16_t(field.name.size()));
        append(as_bytes(field.name));
        store(bytes, std::uint16_t(field.shape.size()));
        store(bytes, field.type);
        store(bytes, offset);
        for (const std::uint64_t extent : field.shape) store(bytes, extent);
        offset += field.numbers.size();
    }
    for (const NewField& field : fields) append(field.numbers);
    return bytes;
}

/// True for nodes that the warp maps, together with their neighbours, below the horizon, where samples are useless.
std::vector<char> useless_nodes(const RglTable& table, std::size_t slice) {
    const std::size_t side = table.colour.width, rows = table.colour.height;
    const Vec3d light = spherical(double(table.theta_l[slice]), 0.0);
    std::vector<char> below(side * rows), useless(side * rows, 1);
    for (std::size_t i = 0; i < below.size(); ++i) {
        const Warped u = warp(table.visible, slice, float(u_of(i % side, side)), float(u_of(i / side, rows)));
        below[i] = reflect(light, normal_at(double(u.x), double(u.y))).z <= 0;
    }
    for (std::size_t i = 0; i < useless.size(); ++i)
        for_neighbours(i, side, rows, [&](std::size_t other) { useless[i] = useless[i] && below[other]; });
    return useless;
}

/// CSV of all parts.
std::string csv_of_both_sides(const TableSource& source, const TableOptions& options) {
    ScatteredSamples all;
    all.isotropic = source.isotropic;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!source.has[p]) continue;
        const Part part = Part(p);
        const ScatteredSamples samples =
            to_samples(part_of(source.values, part), source.isotropic, options.directions, options.max_theta);
        for (std::size_t i = 0; i < samples.wl.size(); ++i) {
            all.wl.push_back(to_side(samples.wl[i], side_of_light(part)));
            all.wv.push_back(to_side(samples.wv[i], side_of_viewer(part)));
            all.colour.push_back(samples.colour[i]);
        }
    }
    return "# both sides\n" + write_csv(all, options.progress);
}

}  // namespace

MerlTable to_merl(const Evaluate& brdf, std::array<std::uint32_t, 3> size, int threads) {
    const StandardArithmetic mode;
    MerlTable table;
    table.size = size;
    const std::uint32_t n_h = size[0], n_d = size[1], n_p = size[2];
    const std::size_t plane = std::size_t(n_d) * n_p;
    table.cells.resize(n_h * plane);
    parallel_for(n_h, threads, [&](std::size_t h) {
        std::vector<Vec3f> wl, wv;
        wl.reserve(plane), wv.reserve(plane);
        const double theta_h = elementary::square(double(h) / n_h) * k_pi / 2;
        for (std::uint32_t d = 0; d < n_d; ++d)
            for (std::uint32_t p = 0; p < n_p; ++p) {
                const auto pair = merl_pair(theta_h, double(d) / n_d * k_pi / 2, double(p) / n_p * k_pi);
                wl.push_back(to_float(pair.wl)), wv.push_back(to_float(pair.wv));
            }
        const auto f = values_at(brdf, wl, wv), exchanged = values_at(brdf, wv, wl);
        for (std::size_t i = 0; i < plane; ++i) {
            Rgb& cell = table.cells[h * plane + i];
            const bool above = std::min(wl[i].z, wv[i].z) > k_horizon;
            for (int c = 0; c < 3; ++c) cell[c] = above ? 0.5f * f[i][c] + 0.5f * exchanged[i][c] : k_nan;
            if (!is_finite(cell)) cell = {k_nan, k_nan, k_nan};
        }
    });
    table.masked = std::uint64_t(std::ranges::count_if(table.cells, [](const Rgb& f) { return f.r != f.r; }));
    return table;
}

std::vector<std::byte> write_merl(const MerlTable& table) {
    std::vector<std::byte> bytes;
    bytes.reserve(3 * sizeof(std::int32_t) + 3 * sizeof(double) * table.cells.size());
    for (const std::uint32_t n : table.size) store(bytes, std::int32_t(n));
    for (int c = 0; c < 3; ++c)
        for (const Rgb& f : table.cells)
            store(bytes, f.r == f.r ? double(f[c]) / k_merl_channel_scale[std::size_t(c)] : -1.0);
    return bytes;
}

RglTable to_rgl(const Evaluate& brdf, const RglOptions& options) {
    const StandardArithmetic mode;
    RglTable table;
    table.description = options.description;
    for (std::uint32_t k = 0; k < options.polar; ++k) table.theta_l.push_back(float(k_pi / 2 * u_of(k, options.polar)));
    table.ndf = {std::uint32_t(k_profile), 1, half_vector_profile(brdf, options.threads)};
    const double area = projected_area(table.ndf, 0);
    for (float& d : table.ndf.nodes) d = float((1 - k_uniform) * double(d) / area + k_uniform / k_pi);
    table.sigma = {std::uint32_t(k_profile), 1, std::vector<float>(k_profile)};
    parallel_for(k_profile, options.threads, [&](std::size_t i) {
        table.sigma.nodes[i] = float(projected_area(table.ndf, theta_of(u_of(i, k_profile))));
    });

    RglTable::VisibleNormals& visible = table.visible;
    visible.width = visible.height = k_normals;
    std::vector<float> density(k_normals * k_normals);
    for (const float theta_l : table.theta_l) {
        const Vec3d wl = spherical(double(theta_l), 0.0);
        for (std::size_t y = 0; y < k_normals; ++y)
            for (std::size_t x = 0; x < k_normals; ++x) {
                const double u = u_of(x, k_normals);
                density[y * k_normals + x] =
                    float(double(at(table.ndf, float(u))) * std::max(0.0, dot(normal_at(u, u_of(y, k_normals)), wl)) *
                          elementary::sin(theta_of(u)) * u);
            }
        integrate(density, visible);
    }

    const std::size_t side = options.colours, size = side * side;
    table.colour.width = table.colour.height = options.colours;
    table.colour.nodes.resize(table.theta_l.size() * size);
    const std::size_t C = options.spectra.wavelengths.size();
    table.wavelengths = options.spectra.wavelengths, table.spectra.resize(table.theta_l.size() * C * size);
    parallel_for(table.theta_l.size(), options.threads, [&](std::size_t slice) {
        const double theta_l = std::min(double(table.theta_l[slice]), elementary::acos(double(k_horizon)));
        const Vec3d light = spherical(theta_l, 0.0);
        std::vector<Vec3f> wl(size, to_float(light)), wv;
        std::vector<double> scale;
        for (std::size_t i = 0; i < size; ++i) {
            const Warped u = warp(visible, slice, float(u_of(i % side, side)), float(u_of(i / side, side)));
            const Vec3d m = normal_at(double(u.x), double(u.y));
            wv.push_back(to_float(reflect(light, m)));
            scale.push_back(4 * double(at(table.sigma, to_unit(float(theta_l)))) / double(at(table.ndf, u.x)));
        }
        const auto f = values_at(brdf, wl, wv);
        std::vector<char> known(size);
        for (std::size_t i = 0; i < size; ++i) known[i] = wv[i].z > k_horizon && is_finite(f[i]);
        const auto nodes_of = [&](const auto& value) {  // three channels
            std::vector<Rgb> nodes(size);
            for (std::size_t i = 0; i < size; ++i)
                for (int c = 0; c < 3 && known[i]; ++c)
                    nodes[i][c] = float(double(value(i, c)) * double(wv[i].z) * scale[i]);
            fill_unknown(nodes, known, side);
            return nodes;
        };
        std::ranges::copy(nodes_of([&](std::size_t i, int c) { return f[i][c]; }),
                          table.colour.nodes.begin() + std::ptrdiff_t(slice * size));
        std::vector<float> spectrum(C * size);
        if (C > 0) options.spectra.evaluate(wl, wv, spectrum);
        for (std::size_t k = 0; k < C; ++k) {
            const auto nodes = nodes_of([&](std::size_t i, int) { return spectrum[i * C + k]; });
            for (std::size_t i = 0; i < size; ++i) table.spectra[(slice * C + k) * size + i] = nodes[i].r;
        }
    });
    return table;
}

std::vector<std::byte> write_rgl(const RglTable& table, bool with_spectra) {
    const std::uint64_t T = table.theta_l.size(), H = table.colour.height, W = table.colour.width, size = H * W;
    const bool is_spectral = with_spectra && !table.wavelengths.empty();
    std::vector<float> luminances, rgb, smooth;
    for (std::size_t slice = 0; slice < T; ++slice) {
        const std::span<const Rgb> nodes(&table.colour.nodes[slice * size], size);
        const auto useless = useless_nodes(table, slice);
        for (std::size_t i = 0; i < size; ++i)
            luminances.push_back(useless[i] ? 0 : float(std::max(0.0, luminance(nodes[i]))));
        // A black slice cannot be importance sampled, and is sampled uniformly.
        if (std::all_of(luminances.end() - std::ptrdiff_t(size), luminances.end(), [](float x) { return x == 0; }))
            std::fill(luminances.end() - std::ptrdiff_t(size), luminances.end(), 1.0f);
        for (int c = 0; c < 3; ++c)
            for (const Rgb& f : nodes) rgb.push_back(f[c]);
        if (!with_spectra || is_spectral) continue;
        const std::size_t begin = smooth.size();
        smooth.resize(begin + k_primary_wavelengths.size() * size);
        for (std::size_t i = 0; i < size; ++i) {
            const auto spectrum = reflectance_spectrum(nodes[i]);
            for (std::size_t k = 0; k < spectrum.size(); ++k) smooth[begin + k * size + i] = spectrum[k];
        }
    }
    std::span<const float> nm = k_primary_wavelengths;
    if (is_spectral) nm = table.wavelengths;
    std::vector<float> vndf;
    for (const auto& node : table.visible.nodes) vndf.push_back(node.density);
    // Loaders interpolate between azimuths, and need two equal rows.
    const auto two_rows = [](const RglTable::Profile& profile) {
        std::vector<float> rows = profile.nodes;
        rows.insert(rows.end(), profile.nodes.begin(), profile.nodes.end());
        return rows;
    };

    const auto floats = [](std::string_view name, std::vector<std::uint64_t> shape, std::span<const float> numbers) {
        return NewField{name, TensorType::f32, std::move(shape), std::as_bytes(numbers)};
    };
    const std::array<std::uint32_t, 2> version{1, 0};
    const std::array<std::byte, 1> jacobian{std::byte(table.jacobian)};
    const std::array<float, 1> phi{0};
    const std::vector<float> sigma = two_rows(table.sigma), ndf = two_rows(table.ndf);
    std::vector<NewField> fields{
        {"version", TensorType::u32, {2}, std::as_bytes(std::span(version))},
        {"description", TensorType::u8, {table.description.size()}, as_bytes(table.description)},
        floats("phi_i", {1}, phi),
        floats("theta_i", {T}, table.theta_l),
        floats("sigma", {2, table.sigma.width}, sigma),
        floats("ndf", {2, table.ndf.width}, ndf),
        floats("vndf", {1, T, table.visible.height, table.visible.width}, vndf),
        floats("luminance", {1, T, H, W}, luminances)};
    if (!is_spectral) fields.push_back(floats("rgb", {1, T, 3, H, W}, rgb));
    if (with_spectra) fields.push_back(floats("wavelengths", {nm.size()}, nm));
    if (with_spectra)
        fields.push_back(floats("spectra", {1, T, nm.size(), H, W}, is_spectral ? table.spectra : smooth));
    fields.push_back({"jacobian", TensorType::u8, {1}, jacobian});
    return write_tensor_file(fields);
}

MbsdfTable to_mbsdf(const Evaluate& brdf, const MbsdfOptions& options) {
    const StandardArithmetic mode;
    MbsdfTable table;
    table.polar = options.polar, table.azimuths = options.azimuths;
    table.metadata = options.metadata;
    const std::size_t slice = std::size_t(table.polar) * table.azimuths;
    table.cells.resize(table.polar * slice);
    const auto direction = [&](std::size_t i, double phi) {
        const double theta = double(i) / table.polar * k_pi / 2;
        return to_float(spherical(std::min(theta, elementary::acos(double(k_horizon))), phi));
    };
    parallel_for(table.polar, options.threads, [&](std::size_t l) {
        std::vector<Vec3f> wl(slice, direction(l, 0)), wv;
        wv.reserve(slice);
        for (std::size_t v = 0; v < table.polar; ++v)
            for (std::uint32_t p = 0; p < table.azimuths; ++p)
                wv.push_back(direction(v, p * k_pi / std::max(table.azimuths - 1, 1u)));
        const std::span<Rgb> f = std::span(table.cells).subspan(l * slice, slice);
        brdf(wl, wv, f);
        std::vector<char> known(slice);
        for (std::size_t i = 0; i < slice; ++i)
            if (!(known[i] = is_finite(f[i]))) f[i] = {};
        fill_unknown(f, std::move(known), table.azimuths);
    });
    table.grey = std::ranges::all_of(table.cells, [](const Rgb& f) { return f.r == f.g && f.g == f.b; });
    return table;
}

std::vector<std::byte> write_mbsdf(const MbsdfTable& table, const MbsdfTable* transmission) {
    std::string header = fmt::format("{}\n", k_mbsdf_magic);
    const auto append = [&header](const std::string& text) {
        for (const char c : printable_lines(text)) {
            if (c == '\n')
                header += "\\n";
            else if (c == '"' || c == '\\')
                header += {'\\', c};
            else
                header += is_control(c) ? ' ' : c;
        }
    };
    for (const auto& [key, text] : table.metadata) {
        header += printable(key);
        header += "=\"";
        append(text);
        header += "\"\n";
    }
    std::vector<std::byte> bytes;
    const auto add_block = [&](const std::string& head, const MbsdfTable& block) {
        const int channels = block.grey ? 1 : 3;
        bytes.reserve(bytes.size() + head.size() + 3 * sizeof(std::uint32_t) +
                      block.cells.size() * std::size_t(channels) * sizeof(float));
        const auto raw = as_bytes(head);
        bytes.insert(bytes.end(), raw.begin(), raw.end());
        store(bytes, std::uint32_t(block.grey ? 0 : 1));
        store(bytes, block.polar);
        store(bytes, block.azimuths);
        for (const Rgb& f : block.cells)
            for (int c = 0; c < channels; ++c) store(bytes, f[c]);
    };
    add_block(header + fmt::format("{}\n", k_mbsdf_reflection), table);
    if (transmission) add_block(fmt::format("{}\n", k_mbsdf_transmission), *transmission);
    return bytes;
}

ScatteredSamples to_samples(const Evaluate& brdf, bool isotropic, int n, double theta_max) {
    const StandardArithmetic mode;
    const auto directions = fibonacci_directions(n, theta_max);
    ScatteredSamples samples;
    samples.isotropic = isotropic;
    for (const Vec3f& wv : directions)
        for (const Vec3f& wl : directions) samples.wl.push_back(wl), samples.wv.push_back(wv);
    samples.colour = values_at(brdf, samples.wl, samples.wv);
    keep_samples(samples, [&](std::size_t i) { return is_finite(samples.colour[i]); });
    make_index(samples);
    return samples;
}

std::string write_csv(const ScatteredSamples& samples, const ProgressToken& token) {
    std::string csv = samples.isotropic ? "# isotropic\n" : "# anisotropic\n";
    const std::size_t n = samples.wavelengths.size();
    csv += "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,";
    csv += n == 0 ? "r,g,b\n" : fmt::format("{}nm\n", fmt::join(samples.wavelengths, "nm,"));
    for (std::size_t i = 0; i < samples.wl.size() && !token.cancelled(); ++i) {
        const Vec3f wl = samples.wl[i], wv = samples.wv[i];
        const auto f = n == 0 ? std::span(&samples.colour[i].r, 3) : std::span(samples.spectrum).subspan(i * n, n);
        csv += fmt::format("{},{},{},{},{},{},{}\n", wl.x, wl.y, wl.z, wv.x, wv.y, wv.z, fmt::join(f, ","));
    }
    return csv;
}

Result<std::vector<std::byte>> write_as_merl(const TableSource& source, const TableOptions& options) {
    return write_merl(to_merl(non_negative(source.values), k_merl_size, options.threads));
}

Result<std::vector<std::byte>> write_as_rgl(const TableSource& source, const TableOptions& options) {
    const RglTable table = to_rgl(source.values, {.description = options.description,
                                                  .spectra = options.spectra ? source.spectra : Channels{},
                                                  .threads = options.threads});
    if (options.progress.cancelled()) return std::vector<std::byte>();
    return write_rgl(table, options.spectra);
}

Result<std::vector<std::byte>> write_as_mbsdf(const TableSource& source, const TableOptions& options) {
    const MbsdfOptions mbsdf{.metadata = {{"description", options.description}}, .threads = options.threads};
    if (!source.has[std::size_t(Part::transmission_front)]) return write_mbsdf(to_mbsdf(source.values, mbsdf));
    const MbsdfTable transmission = to_mbsdf(part_of(source.values, Part::transmission_front), mbsdf);
    return write_mbsdf(to_mbsdf(source.values, mbsdf), &transmission);
}

Result<std::vector<std::byte>> write_as_csv(const TableSource& source, const TableOptions& options) {
    if (source.two_sided) return bytes_of(csv_of_both_sides(source, options));
    if (const auto* samples = source.measured ? std::get_if<ScatteredSamples>(&source.measured->table) : nullptr)
        return bytes_of(write_csv(*samples, options.progress));
    ScatteredSamples samples = to_samples(source.values, source.isotropic, options.directions, options.max_theta);
    set_spectra(samples, source.spectra);
    return bytes_of(write_csv(samples, options.progress));
}

}  // namespace
