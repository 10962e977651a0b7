#include <cmath>
#include <limits>

#include "measured/angles.h"
#include "measured/tensor_file.h"
#include "measured/warp.h"

namespace srbf {

namespace {

constexpr std::uint64_t k_largest_extent = 65536;
/// No quantity of a measurement comes near, and sums and differences of such numbers stay finite.
constexpr float k_largest_value = 1e12f;
constexpr double k_max = std::numeric_limits<float>::max();

/// What a field must be; extent 0 stands for any from `least_extent` up.
struct Expected {
    const char* name;
    TensorType type;
    std::vector<std::uint64_t> shape;
    std::uint64_t least_extent = 1;
};

Error wrong(const std::string& source, const std::string& name, const TensorField& field, std::string expected,
            std::string found) {
    return {source, field.offset, "tensor field " + name, std::move(expected), std::move(found)};
}

Result<TensorField> find(const TensorFile& file, const std::string& source, const Expected& expected) {
    std::string shape;
    for (const std::uint64_t extent : expected.shape)
        shape += (shape.empty() ? "" : " x ") + (extent ? fmt::format("{}", extent) : "n");
    const std::string wanted = fmt::format("{} of {}", shape, k_tensor_type_names[std::size_t(expected.type)]);
    const auto entry = file.find(expected.name);
    if (entry == file.end())
        return Error{source, {}, fmt::format("tensor field {}", expected.name), wanted, "no such field"};
    const TensorField& field = entry->second;
    bool fits = field.type == expected.type && field.shape.size() == expected.shape.size();
    for (std::size_t i = 0; fits && i < field.shape.size(); ++i)
        fits = expected.least_extent <= field.shape[i] && field.shape[i] <= k_largest_extent &&
               (expected.shape[i] == 0 || expected.shape[i] == field.shape[i]);
    if (!fits) return wrong(source, expected.name, field, wanted, describe(field.type, field.shape));
    return field;
}

/// A field of floats, all of them between `least` and `k_largest_value`.
struct Floats {
    TensorField field;
    std::vector<float> values;
};

Result<Floats> find_floats(const TensorFile& file, const std::string& source, const Expected& expected,
                           float least = -k_largest_value) {
    const auto field = find(file, source, expected);
    if (!field) return field.error();
    std::vector<float> values(field->bytes.size() / sizeof(float));
    std::memcpy(values.data(), field->bytes.data(), field->bytes.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!(least <= values[i] && values[i] <= k_largest_value))
            return Error{source, field->offset + i * sizeof(float), fmt::format("tensor field {}", expected.name),
                         fmt::format("values between {} and {}", least, k_largest_value), fmt::format("{}", values[i])};
    return Floats{*field, std::move(values)};
}

/// Keeps the first of `copies` equal parts: an isotropic material repeats itself from azimuth to azimuth.
/// False where the others differ from it by more than rounding.
bool keep_first(std::vector<float>& values, std::uint64_t copies) {
    const std::size_t part = values.size() / copies;
    for (std::size_t i = part; i < values.size(); ++i)
        if (std::abs(values[i] - values[i % part]) > 1e-3f * std::abs(values[i % part]) + 1e-6f) return false;
    values.resize(part);
    return true;
}

constexpr const char* k_one_azimuth = "the same values at every azimuth (isotropic)";

/// A function of the polar angle, stored for two or more azimuths alike.
Result<std::vector<float>> read_profile(const TensorFile& file, const std::string& source, const char* name,
                                        float least) {
    auto table = find_floats(file, source, {name, TensorType::f32, {0, 0}}, least);
    if (!table) return table.error();
    if (table->field.shape[1] < 2)
        return wrong(source, name, table->field, "at least 2 nodes", describe(TensorType::f32, table->field.shape));
    if (!keep_first(table->values, table->field.shape[0]))
        return wrong(source, name, table->field, k_one_azimuth, "different ones");
    return std::move(table->values);
}

/// Normalises a slice of densities and integrates it; false where its integral is no positive number.
bool integrate(std::span<const float> density, RglTable::VisibleNormals& visible) {
    const std::size_t width = visible.width, height = visible.height;
    std::vector<double> left(density.size());
    double integral = 0;
    for (std::size_t y = 0; y < height; ++y) {
        const std::size_t row = y * width, end = row + width - 1;
        for (std::size_t i = row; i < end; ++i)
            left[i + 1] = left[i] + 0.5 * (double(density[i]) + double(density[i + 1]));
        integral += left[end] * (y == 0 || y == height - 1 ? 0.5 : 1);
    }
    if (!(integral > 0)) return false;
    double below = 0, last = 0;
    for (std::size_t y = 0; y < height; ++y) {
        const std::size_t row = y * width;
        for (std::size_t i = row; i < row + width; ++i)
            visible.nodes.push_back({float(double(density[i]) / integral), float(left[i] / integral)});
        const double whole = left[row + width - 1] / integral;
        if (y > 0) below += 0.5 * (last + whole);
        visible.rows.push_back({float(whole), float(below)});
        last = whole;
    }
    return true;
}

Result<RglTable::VisibleNormals> read_visible(const TensorFile& file, const std::string& source, std::uint64_t azimuths,
                                              std::uint64_t slices) {
    auto vndf = find_floats(file, source, {"vndf", TensorType::f32, {azimuths, slices, 0, 0}}, 0);
    if (!vndf) return vndf.error();
    const TensorField& field = vndf->field;
    if (field.shape[2] < 2 || field.shape[3] < 2)
        return wrong(source, "vndf", field, "at least 2 x 2 nodes", describe(field.type, field.shape));
    if (!keep_first(vndf->values, azimuths)) return wrong(source, "vndf", field, k_one_azimuth, "different ones");
    RglTable::VisibleNormals visible{std::uint32_t(field.shape[3]), std::uint32_t(field.shape[2]), {}, {}};
    visible.nodes.reserve(vndf->values.size());
    const std::size_t size = std::size_t(visible.width) * visible.height;
    for (std::size_t slice = 0; slice < slices; ++slice)
        if (!integrate(std::span(vndf->values).subspan(slice * size, size), visible))
            return wrong(source, "vndf", field, "a positive integral in every slice",
                         fmt::format("0 in slice {}", slice));
    return visible;
}

Result<RglTable::Colours> read_colour(const TensorFile& file, const std::string& source, std::uint64_t azimuths,
                                      std::uint64_t slices) {
    if (!file.contains("rgb") && file.contains("spectra"))
        return Error{source, file.find("spectra")->second.offset, "tensor field rgb", "an RGB measurement",
                     "a spectral one, which cannot be read yet"};
    auto rgb = find_floats(file, source, {"rgb", TensorType::f32, {azimuths, slices, 3, 0, 0}});
    if (!rgb) return rgb.error();
    const TensorField& field = rgb->field;
    if (field.shape[3] < 2 || field.shape[4] < 2)
        return wrong(source, "rgb", field, "at least 2 x 2 nodes", describe(field.type, field.shape));
    if (!keep_first(rgb->values, azimuths)) return wrong(source, "rgb", field, k_one_azimuth, "different ones");
    RglTable::Colours colour{std::uint32_t(field.shape[4]), std::uint32_t(field.shape[3]), {}};
    const std::size_t size = std::size_t(colour.width) * colour.height;
    for (std::size_t slice = 0; slice < slices; ++slice)
        for (std::size_t i = 0; i < size; ++i) {
            const float* const f = &rgb->values[3 * slice * size + i];
            colour.nodes.push_back({f[0], f[size], f[2 * size]});
        }
    return colour;
}

/// u(θ) = √(2θ/π)
float to_unit(float theta) { return std::sqrt(theta * float(2 / k_pi)); }

float at(const std::vector<float>& profile, float u) {
    const auto [i, to] = between_nodes(u, profile.size());
    return mix(profile[i], profile[i + 1], to);
}

Rgb at(const RglTable::Colours& colour, const Slices& slices, const Warped& w) {
    const auto [column, x] = between_nodes(w.x, colour.width);
    const auto [row, y] = between_nodes(w.y, colour.height);
    const auto bilinear = [&, column = column, row = row, x = x, y = y](std::size_t slice, float weight, Rgb& sum) {
        const Rgb* const f = &colour.nodes[(slice * colour.height + row) * colour.width + column];
        const Rgb* const g = f + colour.width;
        for (int c = 0; c < 3; ++c) sum[c] += weight * mix(mix(f[0][c], f[1][c], x), mix(g[0][c], g[1][c], x), y);
    };
    Rgb sum;
    bilinear(slices.first, 1 - slices.to, sum);
    bilinear(slices.second, slices.to, sum);
    return sum;
}

}  // namespace

bool is_rgl(std::span<const std::byte> bytes) {
    return bytes.size() >= k_tensor_magic.size() &&
           std::memcmp(bytes.data(), k_tensor_magic.data(), k_tensor_magic.size()) == 0;
}

Result<RglTable> read_rgl(std::span<const std::byte> bytes, const std::string& source) {
    const auto parsed = parse_tensor_file(bytes, source);
    if (!parsed) return parsed.error();
    const TensorFile& file = *parsed;

    const auto description = find(file, source, {"description", TensorType::u8, {0}, 0});
    if (!description) return description.error();
    const auto phi = find_floats(file, source, {"phi_i", TensorType::f32, {0}});
    if (!phi) return phi.error();
    const std::uint64_t azimuths = phi->values.size();
    if (azimuths > 2)
        return wrong(source, "phi_i", phi->field, "an isotropic measurement (1 or 2 azimuths)",
                     fmt::format("an anisotropic one ({} azimuths), which cannot be read yet", azimuths));
    const auto theta = find_floats(file, source, {"theta_i", TensorType::f32, {0}});
    if (!theta) return theta.error();
    for (std::size_t i = 1; i < theta->values.size(); ++i)
        if (theta->values[i] <= theta->values[i - 1])
            return wrong(source, "theta_i", theta->field, "increasing angles",
                         fmt::format("{} after {}", theta->values[i], theta->values[i - 1]));
    const auto jacobian = find(file, source, {"jacobian", TensorType::u8, {1}});
    if (!jacobian) return jacobian.error();
    if (std::to_integer<int>(jacobian->bytes[0]) != 1)
        return wrong(source, "jacobian", *jacobian, "1 (values to be multiplied by ndf / 4 sigma)",
                     fmt::format("{}", std::to_integer<int>(jacobian->bytes[0])));

    auto ndf = read_profile(file, source, "ndf", 0);
    if (!ndf) return ndf.error();
    auto sigma = read_profile(file, source, "sigma", std::numeric_limits<float>::min());
    if (!sigma) return sigma.error();
    auto visible = read_visible(file, source, azimuths, theta->values.size());
    if (!visible) return visible.error();
    auto colour = read_colour(file, source, azimuths, theta->values.size());
    if (!colour) return colour.error();
    const char* const text = reinterpret_cast<const char*>(description->bytes.data());
    return RglTable{std::string(text, description->bytes.size()),
                    theta->values,
                    *std::move(ndf),
                    *std::move(sigma),
                    *std::move(visible),
                    *std::move(colour)};
}

Rgb signed_value(const RglTable& table, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    const Vec3f h = wl + wv;
    const float u_h = to_unit(polar_angle(h)), theta_l = polar_angle(wl);
    // Of near opposite azimuths h.x and h.y are exact, so the azimuth of h from ωl keeps its digits in this
    // form.
    const float phi = azimuth(wl.x * h.y - wl.y * h.x, wl.x * h.x + wl.y * h.y);
    const Slices slices = slices_at(table.theta_l, theta_l);
    const Warped w = unwarp(table.visible, slices, u_h, (phi + float(k_pi)) * float(0.5 / k_pi));
    const Rgb f = at(table.colour, slices, w);

    // At the very horizon the quotient may leave the range of float; a value stays finite.
    const double scale = at(table.ndf, u_h) / (4.0 * double(at(table.sigma, to_unit(theta_l))) * double(wv.z));
    const auto finite = [scale](float x) { return float(std::clamp(scale * double(x), -k_max, k_max)); };
    return {finite(f.r), finite(f.g), finite(f.b)};
}

Rgb value(const RglTable& table, Vec3f wl, Vec3f wv) {
    const Rgb f = signed_value(table, wl, wv);
    return {std::max(f.r, 0.0f), std::max(f.g, 0.0f), std::max(f.b, 0.0f)};
}

}  // namespace srbf
