#include "base/errors.h"
#include "base/floating_point.h"
#include "base/text.h"
#include "brdf/colour.h"
#include "measured/angles.h"
#include "measured/bytes.h"
#include "measured/formats/format_rows.h"
#include "measured/formats/tensor_file.h"
#include "measured/formats/warp.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr std::uint64_t k_largest_extent = 65536;

/// Requirements on a field. An extent of 0 stands for any extent of at least `min_extent`.
struct Expected {
    const char* name;
    TensorType type;
    std::vector<std::uint64_t> shape;
    std::uint64_t min_extent = 1;
};

Error wrong(const std::string& file_name, const std::string& name, const TensorField& field, std::string expected,
            std::string found) {
    return {file_name, field.offset, "tensor field " + name, std::move(expected), std::move(found)};
}

Result<TensorField> find(const TensorFile& file, const std::string& file_name, const Expected& expected) {
    std::string shape;
    for (const std::uint64_t extent : expected.shape)
        shape += (shape.empty() ? "" : " x ") + (extent ? fmt::format("{}", extent) : "n");
    const std::string wanted = fmt::format("{} of {}", shape, k_tensor_type_names[std::size_t(expected.type)]);
    const auto entry = file.find(expected.name);
    if (entry == file.end())
        return Error{file_name, {}, fmt::format("tensor field {}", expected.name), wanted, "no such field"};
    const TensorField& field = entry->second;
    bool fits = field.type == expected.type && field.shape.size() == expected.shape.size();
    for (std::size_t i = 0; fits && i < field.shape.size(); ++i)
        fits = expected.min_extent <= field.shape[i] && field.shape[i] <= k_largest_extent &&
               (expected.shape[i] == 0 || expected.shape[i] == field.shape[i]);
    if (!fits) return wrong(file_name, expected.name, field, wanted, describe(field.type, field.shape));
    return field;
}

struct Floats {
    TensorField field;
    std::vector<float> values;
};

Result<Floats> find_floats(const TensorFile& file, const std::string& file_name, const Expected& expected,
                           float min = -k_largest_value) {
    const auto field = find(file, file_name, expected);
    if (!field) return field.error();
    std::vector<float> values(field->bytes.size() / sizeof(float));
    std::memcpy(values.data(), field->bytes.data(), field->bytes.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!(min <= values[i] && values[i] <= k_largest_value))
            return Error{file_name, field->offset + i * sizeof(float), fmt::format("tensor field {}", expected.name),
                         fmt::format("values between {} and {}", min, k_largest_value), fmt::format("{}", values[i])};
    return Floats{*field, std::move(values)};
}

/// Keeps the first of `copies` equal parts: the file of an isotropic material may repeat data for each azimuth. Returns
/// false if the others differ by more than rounding.
bool keep_first(std::vector<float>& values, std::uint64_t copies) {
    const std::size_t part = values.size() / copies;
    for (std::size_t i = part; i < values.size(); ++i)
        if (std::abs(values[i] - values[i % part]) > 1e-3f * std::abs(values[i % part]) + 1e-6f) return false;
    values.resize(part);
    return true;
}

constexpr const char* k_one_azimuth = "the same values at every azimuth (isotropic)";

struct Azimuths {
    std::vector<float> phi;     ///< empty for an isotropic material
    std::uint64_t in_file = 1;  ///< number of azimuths in the file, also for an isotropic material
    bool isotropic() const { return phi.empty(); }
    std::uint64_t kept() const { return isotropic() ? 1 : in_file; }
};

/// Reads a function of polar angle and azimuth. An isotropic one is stored for two or more equal azimuths.
Result<RglTable::Profile> read_profile(const TensorFile& file, const std::string& file_name, const char* name,
                                       const Azimuths& azimuths, float min) {
    auto table = find_floats(file, file_name, {name, TensorType::f32, {0, 0}}, min);
    if (!table) return table.error();
    const TensorField& field = table->field;
    if (field.shape[1] < 2 || (!azimuths.isotropic() && field.shape[0] < 2))
        return wrong(file_name, name, field, "at least 2 nodes", describe(field.type, field.shape));
    if (azimuths.isotropic() && !keep_first(table->values, field.shape[0]))
        return wrong(file_name, name, field, k_one_azimuth, "different ones");
    const std::uint64_t rows = azimuths.isotropic() ? 1 : field.shape[0];
    return RglTable::Profile{std::uint32_t(field.shape[1]), std::uint32_t(rows), std::move(table->values)};
}

/// Reads a field of slices φ_l × θ_l (× channels) × rows × columns, without the repetitions of an isotropic file.
Result<Floats> read_slices(const TensorFile& file, const std::string& file_name, const Expected& expected,
                           const Azimuths& azimuths, float min = -k_largest_value) {
    auto floats = find_floats(file, file_name, expected, min);
    if (!floats) return floats.error();
    const auto& shape = floats->field.shape;
    if (shape[shape.size() - 1] < 2 || shape[shape.size() - 2] < 2)
        return wrong(file_name, expected.name, floats->field, "at least 2 x 2 nodes",
                     describe(floats->field.type, shape));
    if (azimuths.isotropic() && !keep_first(floats->values, azimuths.in_file))
        return wrong(file_name, expected.name, floats->field, k_one_azimuth, "different ones");
    return floats;
}

Result<RglTable::VisibleNormals> read_visible(const TensorFile& file, const std::string& file_name,
                                              const Azimuths& azimuths, std::uint64_t polar) {
    const auto vndf =
        read_slices(file, file_name, {"vndf", TensorType::f32, {azimuths.in_file, polar, 0, 0}}, azimuths, 0);
    if (!vndf) return vndf.error();
    const TensorField& field = vndf->field;
    RglTable::VisibleNormals visible{std::uint32_t(field.shape[3]), std::uint32_t(field.shape[2]), {}, {}};
    visible.nodes.reserve(vndf->values.size());
    const std::size_t size = std::size_t(visible.width) * visible.height;
    for (std::size_t slice = 0; slice < azimuths.kept() * polar; ++slice)
        if (!integrate(std::span(vndf->values).subspan(slice * size, size), visible))
            return wrong(file_name, "vndf", field, "a positive integral in every slice",
                         fmt::format("0 in slice {}", slice));
    return visible;
}

/// Computes colours Σ_c weight_c channel_c from a field with any number of channels.
RglTable::Colours to_colours(const Floats& floats, std::span<const Rgb> weights) {
    const auto& shape = floats.field.shape;
    RglTable::Colours colour{std::uint32_t(shape[4]), std::uint32_t(shape[3]), {}};
    const std::size_t size = std::size_t(colour.width) * colour.height, slice = weights.size() * size;
    colour.nodes.resize(floats.values.size() / weights.size());
    for (std::size_t node = 0; node < colour.nodes.size(); ++node) {
        const float* const channel = &floats.values[node / size * slice + node % size];
        double sum[3] = {0, 0, 0};
        for (std::size_t k = 0; k < weights.size(); ++k)
            for (int c = 0; c < 3; ++c) sum[c] += double(weights[k][c]) * double(channel[k * size]);
        colour.nodes[node] = {float(sum[0]), float(sum[1]), float(sum[2])};
    }
    return colour;
}

Result<std::vector<float>> read_wavelengths(const TensorFile& file, const std::string& file_name) {
    auto wavelengths = find_floats(file, file_name, {"wavelengths", TensorType::f32, {0}});
    if (!wavelengths) return wavelengths.error();
    const std::vector<float>& nm = wavelengths->values;
    if (nm.size() > 4096 || !are_wavelengths(nm))
        return wrong(file_name, "wavelengths", wavelengths->field, "increasing ones in nm, from 100 up",
                     fmt::format("{} from {} to {}", nm.size(), nm.front(), nm.back()));
    return std::move(wavelengths->values);
}

/// The colours. A table with wavelengths gets them from its spectra, which it keeps.
Result<RglTable::Colours> read_colours(const TensorFile& file, const std::string& file_name, const Azimuths& azimuths,
                                       RglTable& table) {
    const bool is_spectral = !table.wavelengths.empty();
    const std::vector<Rgb> weights =
        is_spectral ? rgb_weights(table.wavelengths) : std::vector<Rgb>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::vector<std::uint64_t> shape{azimuths.in_file, table.theta_l.size(), weights.size(), 0, 0};
    auto channels = read_slices(file, file_name, {is_spectral ? "spectra" : "rgb", TensorType::f32, shape}, azimuths);
    if (!channels) return channels.error();
    mask_missing(channels->values, 1);
    RglTable::Colours colour = to_colours(*channels, weights);
    if (is_spectral) table.spectra = std::move(channels->values);
    return colour;
}

/// Reads the azimuths of the light. A file of an isotropic material has one or two.
Result<Azimuths> read_azimuths(const TensorFile& file, const std::string& file_name, int& symmetry) {
    auto phi = find_floats(file, file_name, {"phi_i", TensorType::f32, {0}});
    if (!phi) return phi.error();
    const std::uint64_t count = phi->values.size();
    if (count <= 2) return Azimuths{{}, count};
    const float range = phi->values.back() - phi->values.front();
    symmetry = int(std::lround(std::clamp(2 * k_pi / double(range), 0.0, 9.0)));
    if (std::ranges::adjacent_find(phi->values, std::greater_equal()) != phi->values.end() ||
        (symmetry != 1 && symmetry != 2 && symmetry != 4))
        return wrong(file_name, "phi_i", phi->field, "increasing azimuths over a whole turn, a half or a quarter",
                     fmt::format("{} from {} to {}", count, phi->values.front(), phi->values.back()));
    return Azimuths{std::move(phi->values), count};
}

float at(const RglTable::Profile& profile, float u_x, float u_y) {
    const auto [column, x] = grid_position(u_x, profile.width);
    const auto [row, y] = grid_position(u_y, profile.height);
    const float* const node = &profile.nodes[row * profile.width + column];
    return mix(mix(node[0], node[1], x), mix(node[profile.width], node[profile.width + 1], x), y);
}

template <typename AnySlices> Rgb at(const RglTable::Colours& colour, const AnySlices& slices, const Warped& w) {
    const auto [column, x] = grid_position(w.x, colour.width);
    const auto [row, y] = grid_position(w.y, colour.height);
    const Four f = slices.blend([&, column = column, row = row, x = x, y = y](std::size_t slice) {
        const Rgb* const c = &colour.nodes[(slice * colour.height + row) * colour.width + column];
        const auto node = [](const Rgb& rgb) { return Four{rgb.r, rgb.g, rgb.b, 0}; };
        return mix(mix(node(c[0]), node(c[1]), x), mix(node(c[colour.width]), node(c[colour.width + 1]), x), y);
    });
    return {f[0], f[1], f[2]};
}

template <typename AnySlices>
void spectrum_at(const RglTable& table, const AnySlices& slices, const Warped& w, std::span<float> f) {
    const std::size_t width = table.colour.width, height = table.colour.height;
    const auto [column, x] = grid_position(w.x, width);
    const auto [row, y] = grid_position(w.y, height);
    for (std::size_t c = 0; c < f.size(); ++c)
        f[c] = slices.blend([&, column = column, row = row, x = x, y = y](std::size_t slice) {
            const float* const node = &table.spectra[((slice * f.size() + c) * height + row) * width + column];
            return mix(mix(node[0], node[1], x), mix(node[width], node[width + 1], x), y);
        });
}

/// Maps an azimuth in [−π, π] to [0, 1].
float turn(float phi) { return (phi + float(k_pi)) * float(0.5 / k_pi); }

/// Looks up a pair of directions: calls `visit(slices, w)` with the position of the colour, and returns the factor from
/// the colour to f_r cosθ_v, ndf / (4 sigma).
template <typename Visit> double look_up_isotropic(const RglTable& table, Vec3f wl, Vec3f wv, const Visit& visit) {
    const Vec3f h = wl + wv;
    const float u_h = to_unit(polar_angle(h)), theta_l = polar_angle(wl);
    // For nearly opposite azimuths h.x and h.y are exact, and so is this azimuth of h relative to ωl.
    const float phi = azimuth(wl.x * h.y - wl.y * h.x, wl.x * h.x + wl.y * h.y);
    const Slices slices = slices_at(table.theta_l, theta_l);
    visit(slices, unwarp(table.visible, slices, u_h, turn(phi)));
    return table.jacobian ? double(at(table.ndf, u_h)) / (4 * double(at(table.sigma, to_unit(theta_l)))) : 1;
}

template <typename Visit> double look_up_anisotropic(const RglTable& table, Vec3f wl, Vec3f wv, const Visit& visit) {
    // Maps the light to the measured azimuths, −π to 0 or −π/2, by rotation by π, or by mirroring at both axes.
    const bool above = wl.y > 0, right = wl.x > 0;
    const float flip_y = table.symmetry > 1 && above ? -1.0f : 1.0f;
    const float flip_x = table.symmetry == 2 ? flip_y : table.symmetry == 4 && right ? -1.0f : 1.0f;
    wl = {flip_x * wl.x, flip_y * wl.y, wl.z};
    wv = {flip_x * wv.x, flip_y * wv.y, wv.z};
    const Vec3f h = wl + wv;
    const float theta_l = polar_angle(wl), phi_l = azimuth(wl.y, wl.x);
    const float u_h = to_unit(polar_angle(h)), turn_h = turn(azimuth(h.y, h.x));
    const AnisotropicSlices slices{slices_at(table.phi_l, phi_l), slices_at(table.theta_l, theta_l),
                                   table.theta_l.size()};
    visit(slices, unwarp(table.visible, slices, u_h, turn_h));
    if (!table.jacobian) return 1;
    return double(at(table.ndf, u_h, turn_h)) / (4 * double(at(table.sigma, to_unit(theta_l), turn(phi_l))));
}

template <typename Visit> double look_up(const RglTable& table, Vec3f wl, Vec3f wv, const Visit& visit) {
    return table.phi_l.empty() ? look_up_isotropic(table, wl, wv, visit) : look_up_anisotropic(table, wl, wv, visit);
}

/// Clamps a value, which may exceed the range of float at the horizon.
float finite(double x) { return float(std::clamp<double>(x, -k_max_float, k_max_float)); }

bool is_rgl(std::span<const std::byte> bytes) { return as_text(bytes).starts_with(k_tensor_magic); }

}  // namespace

Result<RglTable> read_rgl(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    const auto parsed = parse_tensor_file(bytes, file_name);
    if (!parsed) return parsed.error();
    const TensorFile& file = *parsed;
    if (file.contains("M") || file.contains("wvls"))
        return input_error(file_name, "tensor file", "fields of an unpolarized BRDF, as vndf and rgb",
                           "Mueller matrices of a polarized one; write their first element, which is f, as CSV");

    const auto description = find(file, file_name, {"description", TensorType::u8, {0}, 0});
    if (!description) return description.error();
    RglTable table;
    const char* const text = reinterpret_cast<const char*>(description->bytes.data());
    table.description.assign(text, description->bytes.size());
    const auto azimuths = read_azimuths(file, file_name, table.symmetry);
    if (!azimuths) return azimuths.error();
    table.phi_l = azimuths->phi;
    auto theta = find_floats(file, file_name, {"theta_i", TensorType::f32, {0}});
    if (!theta) return theta.error();
    for (std::size_t i = 1; i < theta->values.size(); ++i)
        if (theta->values[i] <= theta->values[i - 1])
            return wrong(file_name, "theta_i", theta->field, "increasing angles",
                         fmt::format("{} after {}", theta->values[i], theta->values[i - 1]));
    table.theta_l = std::move(theta->values);
    const auto jacobian = find(file, file_name, {"jacobian", TensorType::u8, {1}});
    if (!jacobian) return jacobian.error();
    table.jacobian = jacobian->bytes[0] != std::byte(0);

    std::optional<Error> error;
    const auto take = [&](auto read, auto& to) {
        if (read)
            to = *std::move(read);
        else
            error = read.error();
        return !error;
    };
    constexpr float min_sigma = std::numeric_limits<float>::min();
    const bool is_spectral = !file.contains("rgb") && file.contains("spectra");
    if (!take(read_profile(file, file_name, "ndf", *azimuths, 0), table.ndf) ||
        !take(read_profile(file, file_name, "sigma", *azimuths, min_sigma), table.sigma) ||
        !take(read_visible(file, file_name, *azimuths, table.theta_l.size()), table.visible) ||
        (is_spectral && !take(read_wavelengths(file, file_name), table.wavelengths)) ||
        !take(read_colours(file, file_name, *azimuths, table), table.colour))
        return *error;
    return table;
}

Rgb signed_value(const RglTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    Rgb colour;
    const double factor =
        look_up(table, wl, wv, [&](const auto& slices, const Warped& w) { colour = at(table.colour, slices, w); });
    const double scale = factor / double(wv.z);
    const auto times_scale = [scale](float x) { return finite(scale * double(x)); };
    return {times_scale(colour.r), times_scale(colour.g), times_scale(colour.b)};
}

void signed_spectrum(const RglTable& table, Vec3f wl, Vec3f wv, std::span<float> f) {
    std::ranges::fill(f, 0.0f);
    if (!above_horizon(wl, wv)) return;
    const double factor =
        look_up(table, wl, wv, [&](const auto& slices, const Warped& w) { spectrum_at(table, slices, w, f); });
    const double scale = factor / double(wv.z);
    for (float& x : f) x = finite(scale * double(x));
}

const Format k_rgl_format{.name = "RGL",
                          .recognise = is_rgl,
                          .read = read_by<read_rgl>,
                          .extension = ".bsdf",
                          .used_by = "RGL",
                          .one_sided = true,
                          .write = write_as_rgl};

}  // namespace
