#include "base/floating_point.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

/// A pair of directions in ALTA's order.
struct ViewAndLight {
    Vec3d view, light;
};
ViewAndLight pair(Vec3d view, Vec3d light) { return {view, light}; }

Vec3d vector(const double* x) { return {x[0], x[1], x[2]}; }

/// The direction (θ, φ) from the plane vector (θ cosφ, θ sinφ).
Vec3d from_plane(double x, double y) { return spherical(elementary::hypot(x, y), elementary::atan2(y, x)); }

/// The viewer is at (θ_d, φ_d) relative to the half vector (θ_h, φ_h), and the light at the viewer's mirror direction.
ViewAndLight from_half_vector(double theta_h, double phi_h, double theta_d, double phi_d) {
    const Vec3d d = spherical(theta_d, phi_d), h = spherical(theta_h, phi_h);
    const double c = elementary::cos(theta_h), s = elementary::sin(theta_h), x = c * d.x + s * d.z,
                 z = c * d.z - s * d.x;
    const Vec3d view{elementary::cos(phi_h) * x - elementary::sin(phi_h) * d.y,
                     elementary::sin(phi_h) * x + elementary::cos(phi_h) * d.y, z};
    return {view, 2 * dot(view, h) * h - view};
}

/// The direction with these x and y above the horizon; −z if there is none.
Vec3d from_projection(double x, double y) {
    const double z2 = 1 - x * x - y * y;
    return z2 > 0 ? Vec3d{x, y, std::sqrt(z2)} : Vec3d{0, 0, -1};
}

Vec3d from_stereographic(double x, double y) {
    const double r2 = x * x + y * y;
    return {2 * x / (1 + r2), 2 * y / (1 + r2), (1 - r2) / (1 + r2)};
}

struct AltaParameterization {
    std::string_view name;
    /// The kind of each number: 't' is a polar angle or its projection, 'p' an azimuth, '.' anything else.
    std::string_view kinds;
    bool isotropic;
    ViewAndLight (*directions)(const double*);
};

/// The parameterizations of ALTA's params.h. Where its conversion to vectors loses a hemisphere or is not the inverse
/// of its conversion from vectors (RETRO, STEREOGRAPHIC), this is the inverse of the latter.
constexpr AltaParameterization k_parameterizations[] = {
    {"CARTESIAN", "......", false, [](const double* x) { return pair(vector(x), vector(x + 3)); }},
    {"SPHERICAL_TL_PL_TV_PV", "tptp", false,
     [](const double* x) { return pair(spherical(x[2], x[3]), spherical(x[0], x[1])); }},
    {"ISOTROPIC_TV_TL_DPHI", "ttp", true,
     [](const double* x) { return pair(spherical(x[0], 0.0), spherical(x[1], x[2])); }},
    {"ISOTROPIC_TL_TV_PROJ_DPHI", "ttt", true,
     [](const double* x) { return pair(from_plane(x[1], x[2]), spherical(x[0], 0.0)); }},
    {"ISOTROPIC_TV_PROJ_DPHI", "tt", true,
     [](const double* x) { return pair(from_plane(x[0], x[1]), spherical(0.0, 0.0)); }},
    {"RUSIN_TH_PH_TD_PD", "tptp", false, [](const double* x) { return from_half_vector(x[0], x[1], x[2], x[3]); }},
    {"RUSIN_TH_TD_PD", "ttp", true, [](const double* x) { return from_half_vector(x[0], 0, x[1], x[2]); }},
    {"RUSIN_TH_TD", "tt", true, [](const double* x) { return from_half_vector(x[0], 0, x[1], k_pi / 2); }},
    {"COS_TH_TD", "..", true,
     [](const double* x) { return from_half_vector(elementary::acos(x[0]), 0, elementary::acos(x[1]), 0); }},
    {"SCHLICK_TL_TK_PROJ_DPHI", "ttt", true,
     [](const double* x) {
         const Vec3d light = spherical(x[0], 0.0), k = from_plane(x[1], x[2]), reflected = mirror(light);
         return pair(2 * dot(k, reflected) * k - reflected, light);
     }},
    {"RETRO_TL_TVL_PROJ_DPHI", "ttt", true,
     [](const double* x) {
         const Vec3d light = spherical(x[0], 0.0), x_axis{-light.z, 0, light.x}, y_axis{0, 1, 0};
         const Vec3d v = from_plane(x[1], x[2]);
         return pair(v.x * x_axis + v.y * y_axis + v.z * light, light);
     }},
    {"STARK_3D", "..p", true,
     [](const double* x) {
         const Vec3d h{x[0], 0, std::sqrt(1 - x[0] * x[0] - x[1] * x[1])};
         // b is orthogonal to h, at azimuth φ in the plane.
         const Vec3d b = x[1] * normalize(Vec3d{h.z * elementary::cos(x[2]), h.z * elementary::sin(x[2]),
                                                -h.x * elementary::cos(x[2])});
         return pair(h - b, h + b);
     }},
    {"STARK_2D", "..", true,
     [](const double* x) {
         const Vec3d h{x[0], 0, std::sqrt(1 - x[0] * x[0] - x[1] * x[1])}, b{0, x[1], 0};
         return pair(h - b, h + b);
     }},
    {"NEUMANN_3D", "..p", true,
     [](const double* x) {
         const double dx = x[1] * elementary::cos(x[2]), dy = x[1] * elementary::sin(x[2]);
         return pair(from_projection(x[0] + dx, dy), from_projection(x[0] - dx, -dy));
     }},
    {"NEUMANN_2D", "..", true,
     [](const double* x) { return pair(from_projection(x[0], x[1]), from_projection(x[0], -x[1])); }},
    {"STEREOGRAPHIC", "....", false,
     [](const double* x) { return pair(from_stereographic(x[0], x[1]), from_stereographic(x[2], x[3])); }},
};

/// The header: the first lines, which begin with '#'.
struct Header {
    std::optional<std::size_t> inputs, outputs;
    const AltaParameterization* parameterization = nullptr;
    std::string_view output = "INV_STERADIAN";
    std::string description;
    std::uint64_t line = 0;
};

std::optional<Error> read_header_line(std::string_view line, Header& header, const std::string& file_name) {
    const std::string_view key = next_word(line), rest = trimmed(line);
    const auto wrong = [&](std::string expected) {
        return at_line(file_name, header.line, std::string(key.substr(0, 40)), std::move(expected), quoted(rest));
    };
    if (key == "#DIM") {
        header.inputs = to_number<std::size_t>(next_word(line));
        header.outputs = to_number<std::size_t>(next_word(line));
        if (!header.inputs || !header.outputs || *header.inputs > 6 || *header.outputs > k_max_columns)
            return wrong("the numbers of inputs and outputs");
    } else if (key == "#PARAM_IN") {
        const auto known = std::ranges::find(k_parameterizations, rest, &AltaParameterization::name);
        if (known == std::end(k_parameterizations)) {
            std::string names;
            for (const auto& other : k_parameterizations)
                names += (names.empty() ? "" : ", ") + std::string(other.name);
            return wrong("one of " + names);
        }
        header.parameterization = known;
    } else if (key == "#PARAM_OUT") {
        if (rest != "INV_STERADIAN" && rest != "INV_STERADIAN_COSINE_FACTOR" && rest != "RGB_COLOR" &&
            rest != "XYZ_COLOR" && rest != "UNKNOWN_OUTPUT")
            return wrong("INV_STERADIAN, INV_STERADIAN_COSINE_FACTOR, RGB_COLOR or XYZ_COLOR");
        header.output = rest;
    } else if (key == "#FORMAT" && rest != "text") {
        return wrong("text");
    } else if (key == "#SAMPLE") {
        header.description = rest.substr(0, 1000);
        std::erase(header.description, '"');
    }
    return {};
}

bool is_alta(std::string_view text) {
    for (Lines lines(text); auto line = lines.next();) {
        if (!line->starts_with('#')) return false;
        const std::string_view key = next_word(*line);
        if (key == "#DIM" || key == "#PARAM_IN") return true;
    }
    return false;
}

}  // namespace

Result<ScatteredSamples> read_alta(std::span<const std::byte> bytes, const std::string& file_name) {
    Lines lines(as_text(bytes));
    Header header;
    std::optional<SampleBuilder> builder;
    std::vector<double> row;
    std::vector<float> f;
    while (auto line = lines.next()) {
        header.line = lines.number();
        if (line->starts_with('#')) {
            // The first row ends the header.
            if (auto error = builder ? std::nullopt : read_header_line(*line, header, file_name)) return *error;
            continue;
        }
        if (!builder) {
            if (!header.inputs)
                return at_line(file_name, header.line, "header", "a line #DIM before the samples", "none");
            if (!header.parameterization)
                return at_line(file_name, header.line, "header", "a line #PARAM_IN before the samples", "none");
            if (*header.inputs != header.parameterization->kinds.size())
                return at_line(file_name, header.line, "#DIM",
                               fmt::format("{} inputs for {}", header.parameterization->kinds.size(),
                                           header.parameterization->name),
                               fmt::format("{}", *header.inputs));
            if (*header.outputs != 1 && *header.outputs != 3)
                return at_line(file_name, header.line, "#DIM", "1 or 3 outputs", fmt::format("{}", *header.outputs));
            builder.emplace(*header.outputs == 1           ? Values::grey
                            : header.output == "XYZ_COLOR" ? Values::xyz
                                                           : Values::rgb,
                            std::vector<float>(), bytes.size(), lines_of(bytes));
            row.resize(*header.inputs + *header.outputs);
            f.resize(*header.outputs);
        }
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string_view word = next_word(*line);
            const auto number = to_number<double>(word);
            if (!number)
                return at_line(file_name, header.line, fmt::format("number {} of {}", i + 1, row.size()), "a number",
                               word.empty() ? "the end of the line" : quoted(word));
            row[i] = *number;
            const char kind = i < *header.inputs ? header.parameterization->kinds[i] : '.';
            if (kind == '.') continue;
            if (auto expected =
                    expected_angle(kind == 'p' ? AngleKind::azimuth : AngleKind::polar, row[i], k_in_radians);
                !expected.empty())
                return at_line(file_name, header.line, fmt::format("number {} of {}", i + 1, row.size()),
                               std::move(expected), quoted(word));
        }
        const auto [view, light] = header.parameterization->directions(row.data());
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = float(row[*header.inputs + i]);
        builder->add(light, view, f);
    }
    if (!builder) return at_line(file_name, lines.number(), "samples", "at least one", "the end of the file");
    auto samples = std::move(*builder).finish(file_name, header.description, header.parameterization->isotropic);
    if (samples && header.output == "INV_STERADIAN_COSINE_FACTOR") to_bsdf(*samples, Quantity::cosine);
    return samples;
}

const Format k_alta_format{.name = "ALTA", .is_text = true, .recognise = in_text<is_alta>, .read = read_by<read_alta>};

}  // namespace
