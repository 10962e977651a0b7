// BRDF tables of ASAM OpenMATERIAL 3D, `.xompt`.

#include "base/floating_point.h"
#include "brdf/directions.h"
#include "extras/optics/formats.h"
#include "extras/optics/json_rows.h"
#include "measured/bytes.h"
#include "measured/samples.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr double k_nanometre = 1e-9;

/// The position of a parser in a text.
struct TextPosition {
    std::uint64_t line = 1;  ///< line of the next character
    char last = ' ';         ///< the character before it
};
/// An iterator over the characters of a text that updates `position`.
struct TrackedText {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;
    const char* character;
    TextPosition* position;
    reference operator*() const { return *character; }
    TrackedText& operator++() {
        position->last = *character++;
        position->line += position->last == '\n';
        return *this;
    }
    bool operator==(const TrackedText& other) const { return character == other.character; }
};

/// Collects "lookupTable" and "receiverSolidAngles" in "brdf" and "name" in "metadata", and ignores everything else.
struct OpenMaterialRows : JsonRows {
    std::string name;
    TextPosition position;
    std::optional<std::string> expected;  ///< set if a number is out of its range
    bool in_table = false, has_table = false;
    std::size_t table_depth = 0, column = 0;
    SpectralRow row{};
    std::vector<SpectralRow> rows;
    std::vector<std::array<float, 2>> receiver;  ///< `ScatteredSamples::receiver`

    /// The columns of a file: wavelength, θ_l, θ_v, φ_v and f.
    static constexpr std::array<std::size_t, 5> k_order{k_wavelength_column, 0, 2, 3, k_value_column};

    /// The line of the last number. The parser has already read the character after it.
    std::uint64_t line() const { return position.line - (position.last == '\n'); }
    /// Checks that an angle is within its range. Older versions of the format have zenith angles down to −π/2.
    bool check_angle(double x) {
        constexpr double limits[] = {k_pi / 2, k_pi / 2, 2 * k_pi};
        const double upper = limits[column - 1], lower = -upper;
        if (x >= lower - k_azimuth_rounding && x <= upper + k_azimuth_rounding) return true;
        expected = fmt::format("{:.4g} to {:.4g} rad in column {} of a row", lower, upper, column + 1);
        return refuse(fmt::format("{:g}", x));
    }
    bool take(double x) override {
        if (!receiver.empty() && path.size() > 1 && path[path.size() - 2] == "receiverSolidAngles") {
            if (last_key == "wavelength") receiver.back()[0] = float(x / k_nanometre);
            if (last_key == "solidAngle") receiver.back()[1] = float(x);
        }
        if (!in_table) return true;
        if (path.size() != table_depth + 2) return refuse("a number outside of a row");
        if (column == k_order.size()) return refuse("a row of more than five numbers");
        if (column > 0 && column < 4 && !check_angle(x)) return false;
        row[k_order[column]] = float(column == 0 ? x / k_nanometre : x);
        ++column;
        return true;
    }
    bool boolean(bool) override { return !in_table || refuse("a truth value in a row"); }
    bool take_text(const std::string& text) override {
        if (in_table) return refuse("a text in a row");
        if (last_key == "name" && !path.empty() && path.back() == "metadata") name = text.substr(0, 200);
        return true;
    }
    bool open(bool is_array) override {
        if (in_table && (!is_array || path.size() != table_depth + 1)) return refuse("something else than rows");
        column = 0;
        if (!is_array && !path.empty() && path.back() == "receiverSolidAngles") receiver.push_back({0, 0});
        if (in_table || !is_array || last_key != "lookupTable" || path.empty() || path.back() != "brdf") return true;
        if (has_table) return refuse("a second table");
        in_table = has_table = true;
        table_depth = path.size();
        return true;
    }
    bool close(bool) override {
        if (!in_table) return true;
        if (path.size() == table_depth + 1) return in_table = false, true;
        if (column != k_order.size()) return refuse("a row of fewer than five numbers");
        // The light's azimuth is 0, and f is not negative. A direction at −θ lies at θ in the opposite half of its
        // plane.
        row[1] = 0;
        row[k_weight_column] = 1;
        for (const std::size_t theta : {0u, 2u})
            if (row[theta] < 0) row[theta] = -row[theta], row[3] += float(k_pi);
        if (row[k_value_column] < 0) row[k_value_column] = k_nan;
        rows.push_back(row);
        return true;
    }
};

/// An identifier in the form of a UUID, from a hash of the text: 64-bit FNV-1a, twice.
std::string uuid_of(std::string_view text) {
    const auto hash = [&](std::uint64_t h) {
        for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3;
        return h;
    };
    const std::uint64_t a = hash(0xcbf29ce484222325), b = hash(a);
    return fmt::format("{:08x}-{:04x}-8{:03x}-8{:03x}-{:012x}", a >> 32, a >> 16 & 0xffff, a & 0xfff, b >> 48 & 0xfff,
                       b & 0xffffffffffff);
}

/// Samples on a grid of angles, every 5° in θ and every 15° in azimuth, without those that were not measured.
ScatteredSamples sample_on_grid(const Evaluate& brdf, const std::string& description) {
    std::vector<Vec3f> wl, wv;
    for (int l = 0; l < 18; ++l)
        for (int v = 0; v < 18; ++v)
            for (int phi = 0; phi <= (v == 0 ? 0 : 12); ++phi) {
                wl.push_back(to_float(spherical(5 * l * k_degree, 0.0)));
                wv.push_back(to_float(spherical(5 * v * k_degree, 15 * phi * k_degree)));
            }
    std::vector<Rgb> f(wl.size());
    brdf(wl, wv, f);
    ScatteredSamples samples;
    samples.description = description;
    for (std::size_t i = 0; i < f.size(); ++i)
        if (is_finite(f[i])) {
            samples.wl.push_back(wl[i]);
            samples.wv.push_back(wv[i]);
            samples.colour.push_back(f[i]);
        }
    return samples;
}

}  // namespace

bool is_openmaterial(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    return first != text.npos && text[first] == '{' && text.substr(0, 4096).find("OpenMATERIAL") != text.npos;
}

Result<ScatteredSamples> read_openmaterial(std::span<const std::byte> bytes, const std::string& file_name) {
    OpenMaterialRows sax;
    const std::string_view text = as_text(bytes);
    sax.rows.reserve(std::size_t(std::ranges::count(text, '[')));
    const bool parsed = nlohmann::json::sax_parse(TrackedText{text.data(), &sax.position},
                                                  TrackedText{text.data() + text.size(), &sax.position}, &sax);
    if (!parsed && sax.expected) return at_line(file_name, sax.line(), "angle", *sax.expected, sax.wrong);
    if (!parsed)
        return Error{file_name, {}, "OpenMATERIAL", "JSON with rows of five numbers in brdf.lookupTable", sax.wrong};
    if (sax.rows.empty()) return Error{file_name, {}, "OpenMATERIAL", "rows in brdf.lookupTable", "none"};
    for (const SpectralRow& row : sax.rows)
        if (!std::isfinite(row[k_wavelength_column]))
            return Error{file_name, {}, "OpenMATERIAL", "a wavelength and three angles in each row", {}};
    for (const auto& [nm, solid_angle] : sax.receiver)
        if (!(nm > 0 && solid_angle > 0 && std::isfinite(solid_angle)))
            return Error{file_name,
                         {},
                         "receiverSolidAngles",
                         "a wavelength and a solid angle above 0 in each",
                         fmt::format("{:g} and {:g}", nm, solid_angle)};
    auto samples = samples_of_rows(sax.rows, bytes.size(), file_name, sax.name, true);
    if (samples) samples->receiver = std::move(sax.receiver);
    return samples;
}

std::string write_openmaterial(const ScatteredSamples& samples) {
    const bool is_spectral = !samples.wavelengths.empty();
    const std::vector<float> nm = is_spectral
                                      ? samples.wavelengths
                                      : std::vector<float>(k_primary_wavelengths.begin(), k_primary_wavelengths.end());
    struct Row {
        double theta_l, theta_v, phi_v;
        std::size_t sample;
    };
    std::vector<Row> rows;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const auto angle = [](Vec3f w) {
            return std::array{elementary::atan2(elementary::hypot(double(w.x), double(w.y)), double(w.z)),
                              elementary::atan2(double(w.y), double(w.x))};
        };
        const auto l = angle(samples.wl[i]), v = angle(samples.wv[i]);
        double phi = std::remainder(v[1] - l[1], 2 * k_pi);
        if (phi < 0) phi = samples.isotropic ? -phi : phi + 2 * k_pi;
        rows.push_back({l[0], v[0], phi, i});
    }
    std::ranges::stable_sort(rows, [](const Row& a, const Row& b) {
        return std::array{a.theta_l, a.theta_v, a.phi_v} < std::array{b.theta_l, b.theta_v, b.phi_v};
    });
    std::string wavelengths, table, receiver;
    for (const auto& [at, solid_angle] : samples.receiver)
        receiver += fmt::format("{}{{\"wavelength\": {:.7g}, \"solidAngle\": {}}}", receiver.empty() ? "" : ", ",
                                double(at) * k_nanometre, solid_angle);
    if (!receiver.empty()) receiver = fmt::format("        \"receiverSolidAngles\": [{}],\n", receiver);
    for (std::size_t k = 0; k < nm.size(); ++k) {
        const double metres = double(nm[k]) * k_nanometre;
        wavelengths += fmt::format("{}{:.7g}", k ? ", " : "", metres);
        for (const Row& row : rows) {
            const float f = is_spectral ? samples.spectrum[row.sample * nm.size() + k]
                                        : reflectance_spectrum(samples.colour[row.sample])[k];
            table += fmt::format("{}\n            [{:.7g}, {:.7g}, {:.7g}, {:.7g}, {}]", table.empty() ? "" : ",",
                                 metres, row.theta_l, row.theta_v, row.phi_v, std::max(f, 0.f));
        }
    }
    const std::string name = nlohmann::json(samples.description.empty() ? "BRDF" : samples.description)
                                 .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    return fmt::format(
        "{{\n    \"$schema\": "
        "\"https://raw.githubusercontent.com/asam-ev/OpenMATERIAL-3D/refs/tags/v1.0.0/schemas/"
        "material_brdf_schema.json\",\n"
        "    \"metadata\": {{\n        \"name\": {},\n        \"uuid\": \"{}\",\n        \"materialVersion\": "
        "\"1.0.0\",\n"
        "        \"openMaterial3dVersion\": \"1.0.0\",\n        \"copyrights\": [\"unknown\"],\n        \"license\": "
        "\"unknown\",\n        \"authors\": [\"unknown\"],\n        \"sources\": \"converted by srbf\"\n    }},\n"
        "    \"brdf\": {{\n        \"wavelengths\": [{}],\n{}        \"lookupTable\": [{}\n        ]\n    }}\n}}\n",
        name, uuid_of(table), wavelengths, receiver, table);
}

Result<std::vector<std::byte>> write_as_openmaterial(const TableSource& source, const TableOptions& options) {
    const auto* measured = source.measured ? std::get_if<ScatteredSamples>(&source.measured->table) : nullptr;
    if (measured) return bytes_of(write_openmaterial(*measured));
    ScatteredSamples samples = sample_on_grid(source.values, options.description);
    set_spectra(samples, source.spectra);
    return bytes_of(write_openmaterial(samples));
}

}  // namespace
