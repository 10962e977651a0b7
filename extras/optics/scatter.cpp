// Scatter tables: look-up, and the parsing of their files.
#include "extras/optics/formats.h"

#include <fmt/format.h>

#include "base/parallel.h"
#include "base/printable.h"
#include "brdf/colour.h"
#include "brdf/directions.h"
#include "measured/angles.h"
#include "measured/bytes.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

/// The position of x among rising nodes: between `i` and `next`, at the fraction `weight`. Beyond the ends it is
/// the last node there.
struct NodeInterval {
    std::size_t i = 0, next = 0;
    double weight = 0;
};
NodeInterval position_among(std::span<const float> nodes, double x) {
    if (nodes.size() < 2 || !(x > double(nodes.front()))) return {};
    if (x >= double(nodes.back())) return {nodes.size() - 1, nodes.size() - 1, 0};
    const std::size_t upper = std::size_t(std::ranges::upper_bound(nodes, float(x)) - nodes.begin());
    const std::size_t i = std::clamp<std::size_t>(upper, 1, nodes.size() - 1) - 1;
    const double low = double(nodes[i]), high = double(nodes[i + 1]);
    return {i, i + 1, std::clamp((x - low) / (high - low), 0.0, 1.0)};
}

/// The position of x among periodic nodes. After the last node comes the first.
NodeInterval position_around(std::span<const float> nodes, double x, double period) {
    const double first = double(nodes.front()), last = double(nodes.back());
    x = std::fmod(x - first, period);
    x = first + (x < 0 ? x + period : x);
    if (nodes.size() < 2 || x <= last) return position_among(nodes, x);
    return {nodes.size() - 1, 0, std::clamp((x - last) / (first + period - last), 0.0, 1.0)};
}

/// A weighted mean of the measured values.
struct ScatterMean {
    double sum = 0, weight = 0;
    void add(double value, double value_weight) {
        if (value_weight > 0 && std::isfinite(value)) {
            sum += value_weight * value;
            weight += value_weight;
        }
    }
    double result() const { return weight > 0 ? sum / weight : double(k_nan); }
};

/// Tolerance for the rounding of angles in files.
constexpr double k_rounding = 1e-5;

bool is_within(std::span<const float> nodes, double x) {
    return x >= double(nodes.front()) - k_rounding && x <= double(nodes.back()) + k_rounding;
}

/// True if the nodes cover a half turn, which is mirrored at the plane of incidence.
bool are_mirrored(std::span<const float> nodes) {
    return double(nodes.back()) <= k_pi + k_azimuth_rounding && nodes.front() >= 0;
}

NodeInterval azimuth_position(std::span<const float> nodes, double phi) {
    return are_mirrored(nodes) ? position_among(nodes, std::abs(std::remainder(phi, 2 * k_pi)))
                               : position_around(nodes, phi, 2 * k_pi);
}

/// True if an azimuth was measured: it does not lie in a gap at the end of the nodes that is clearly wider than the
/// gaps between nodes.
bool has_azimuth(std::span<const float> nodes, double phi) {
    if (nodes.size() == 1) return true;
    const double first = double(nodes.front()), last = double(nodes.back()),
                 x = std::abs(std::remainder(phi, 2 * k_pi));
    double gap = 0;
    if (!are_mirrored(nodes)) {
        const NodeInterval position = azimuth_position(nodes, phi);
        gap = position.next < position.i ? first + 2 * k_pi - last : 0;
    } else if (x < first || x > last) {
        gap = 2 * (x < first ? first : k_pi - last);
    }
    double widest = 0;
    for (std::size_t k = 1; gap > 0 && k < nodes.size(); ++k)
        widest = std::max(widest, double(nodes[k]) - double(nodes[k - 1]));
    return gap <= 1.5 * widest;
}

/// Rotates about y by `theta`, from +z towards +x.
Vec3d tilted(const Vec3d& w, double theta) {
    const double c = elementary::cos(theta), s = elementary::sin(theta);
    return {c * w.x + s * w.z, w.y, c * w.z - s * w.x};
}

/// The directions of a look-up: θ_l, and the viewer in two frames. In one, +x is on the side of the mirror
/// direction; the other is tilted so that +z is the mirror direction.
struct ScatterDirections {
    double theta_l;
    Vec3d about_normal, about_mirror;
};

/// The azimuth, in the convention of the table's nodes, of a direction in the frame of the nodes.
double azimuth_of(const ScatterTable& table, const Vec3d& w) {
    // Around the mirror direction, azimuth 180° points towards grazing.
    return table.about_mirror ? elementary::atan2(-w.y, -w.x) : elementary::atan2(w.y, w.x);
}

/// A channel of a slice at the same position relative to the mirror direction; NaN beyond its nodes.
double slice_at(const ScatterTable& table, const ScatterTable::Slice& slice, const ScatterDirections& directions,
                std::size_t channel) {
    const Vec3d& viewer = table.about_mirror ? directions.about_mirror : directions.about_normal;
    const double theta = polar_angle(viewer);
    if (!is_within(slice.polar, theta)) return double(k_nan);
    if (theta > k_rounding && !has_azimuth(slice.azimuth, azimuth_of(table, viewer))) return double(k_nan);
    const Vec3d w = table.about_mirror ? viewer : tilted(directions.about_mirror, double(slice.theta_l));
    const NodeInterval p = position_among(slice.polar, polar_angle(w)),
                       a = azimuth_position(slice.azimuth, azimuth_of(table, w));
    const std::size_t n = slice.azimuth.size(), begin = channel * slice.polar.size() * n;
    ScatterMean mean;
    for (const auto& [row, weight] : {std::pair(p.i, 1 - p.weight), {p.next, p.weight}}) {
        mean.add(double(slice.f[begin + row * n + a.i]), weight * (1 - a.weight));
        mean.add(double(slice.f[begin + row * n + a.next]), weight * a.weight);
    }
    return mean.result();
}

/// A channel at a rotation of the sample, interpolated linearly in the angle of incidence.
double rotation_at(const ScatterTable& table, std::size_t rotation, const ScatterDirections& directions,
                   std::size_t channel) {
    const std::size_t first = table.first[rotation], count = table.first[rotation + 1] - first;
    std::vector<float> nodes;
    for (std::size_t k = 0; k < count; ++k) nodes.push_back(table.slices[first + k].theta_l);
    const NodeInterval position = position_among(nodes, directions.theta_l);
    ScatterMean mean;
    mean.add(slice_at(table, table.slices[first + position.i], directions, channel), 1 - position.weight);
    if (position.weight > 0)
        mean.add(slice_at(table, table.slices[first + position.next], directions, channel), position.weight);
    return mean.result();
}

std::vector<float> degrees_list(std::initializer_list<double> begin, double end, double step) {
    std::vector<float> radians;
    for (const double angle : begin) radians.push_back(float(angle * k_degree));
    while (double(radians.back()) < (end - step / 2) * k_degree)
        radians.push_back(float(std::round((double(radians.back()) / k_degree + step) * 1e3) / 1e3 * k_degree));
    return radians;
}

/// The direction in a part's frame of a node of a slice, for light at azimuth φ_l.
Vec3d node_direction(const ScatterTable& table, double theta_l, double phi_l, double polar, double azimuth) {
    const double s = elementary::sin(polar), x = s * elementary::cos(azimuth), y = s * elementary::sin(azimuth);
    const Vec3d local{table.about_mirror ? -x : x, table.about_mirror ? -y : y, elementary::cos(polar)};
    const Vec3d forward = table.about_mirror ? tilted(local, theta_l) : local;
    const double c_l = -elementary::cos(phi_l), s_l = -elementary::sin(phi_l);
    return {c_l * forward.x - s_l * forward.y, s_l * forward.x + c_l * forward.y, forward.z};
}

}  // namespace

double light_azimuth(const ScatterTable& table, double rotation) {
    return table.about_mirror ? rotation + k_pi / 2 : k_pi - rotation;
}

Rgb signed_value(const ScatterTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const double phi_l = elementary::atan2(double(wl.y), double(wl.x));
    // The frame whose +x is on the side of the mirror direction.
    const double c = -elementary::cos(phi_l), s = -elementary::sin(phi_l);
    Vec3d forward{c * double(wv.x) + s * double(wv.y), c * double(wv.y) - s * double(wv.x), double(wv.z)};
    NodeInterval position;
    if (table.rotation.size() > 1) {
        double rotation = table.about_mirror ? phi_l - k_pi / 2 : k_pi - phi_l;
        const double last = double(table.rotation.back());
        const bool is_half = last <= k_pi + k_azimuth_rounding, is_quarter = last <= k_pi / 2 + k_azimuth_rounding;
        if (is_quarter) {
            rotation = std::remainder(rotation, k_pi);
            if (rotation < 0) {
                rotation = -rotation;
                forward.y = -forward.y;
            }
        }
        position = is_quarter ? position_among(table.rotation, rotation)
                              : position_around(table.rotation, rotation, is_half ? k_pi : 2 * k_pi);
    }
    const double theta_l = polar_angle(to_double(wl));
    const ScatterDirections directions{theta_l, forward, tilted(forward, -theta_l)};
    std::array<double, 3> values{};
    for (std::size_t channel = 0; channel < table.channels; ++channel) {
        ScatterMean mean;
        mean.add(rotation_at(table, position.i, directions, channel), 1 - position.weight);
        if (position.weight > 0) mean.add(rotation_at(table, position.next, directions, channel), position.weight);
        values[channel] = mean.result();
    }
    const float grey = float(values[0]);
    const Rgb f = table.channels == 1 ? Rgb{grey, grey, grey} : to_rgb(Xyz{values[0], values[1], values[2]});
    return {table.tint.r * f.r, table.tint.g * f.g, table.tint.b * f.b};
}

double scatter_integral(const ScatterTable& table, const ScatterTable::Slice& slice, std::size_t channel) {
    // Cells of the hemisphere around the normal, half a degree by a degree. Each has the value at its middle.
    constexpr int k_polar = 180, k_turn = 360;
    const double theta_l = double(slice.theta_l);
    double sum = 0;
    for (int i = 0; i < k_polar; ++i) {
        const double theta = (i + 0.5) * k_pi / 2 / k_polar, c = elementary::cos(theta), s = elementary::sin(theta);
        for (int j = 0; j < k_turn; ++j) {
            const double phi = (j + 0.5) * 2 * k_pi / k_turn;
            const Vec3d w{s * elementary::cos(phi), s * elementary::sin(phi), c};
            const double f = slice_at(table, slice, {theta_l, w, tilted(w, -theta_l)}, channel);
            if (std::isfinite(f)) sum += f * s * c;
        }
    }
    return sum * (k_pi / 2 / k_polar) * (2 * k_pi / k_turn);
}

void mask_gaps(ScatterTable& table) {
    for (ScatterTable::Slice& slice : table.slices) {
        if (std::ranges::all_of(slice.f, [](float f) { return f == 0; })) continue;
        const std::size_t n = slice.f.size() / table.channels;
        for (std::size_t i = 0; i < n; ++i) {
            bool is_gap = true;
            for (std::size_t index = i; index < slice.f.size(); index += n)
                is_gap = is_gap && (slice.f[index] == 0 || std::isnan(slice.f[index]));
            if (is_gap) ++table.masked;
            for (std::size_t index = i; is_gap && index < slice.f.size(); index += n) slice.f[index] = k_nan;
        }
    }
}

ScatterTable to_scatter(const Evaluate& part, bool about_mirror, bool isotropic, int threads) {
    const StandardArithmetic mode;
    ScatterTable table;
    table.about_mirror = about_mirror;
    table.rotation = isotropic ? std::vector<float>{0} : degrees_list({0}, 360, 15);
    const std::vector<float> incidence = degrees_list({0}, 85, 5);
    const std::vector<float> polar =
        about_mirror ? degrees_list({0, 0.25, 0.5, 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 12.5, 15, 20}, 175, 5)
                     : degrees_list({0}, 90, isotropic ? 1 : 2);
    const std::vector<float> azimuth = !about_mirror ? degrees_list({0, 0.5, 1, 2, 3, 5, 7.5, 10}, 360, 10)
                                       : isotropic   ? degrees_list({0}, 180, 10)
                                                     : degrees_list({0}, 360, 10);
    for (const float rotation : table.rotation) {
        static_cast<void>(rotation);
        table.first.push_back(std::uint32_t(table.slices.size()));
        for (const float theta : incidence) table.slices.push_back({theta, polar, azimuth, {}});
    }
    table.first.push_back(std::uint32_t(table.slices.size()));
    parallel_for(table.slices.size(), threads, [&](std::size_t k) {
        ScatterTable::Slice& slice = table.slices[k];
        const double phi_l = light_azimuth(table, double(table.rotation[k / incidence.size()]));
        const double theta_l = double(slice.theta_l);
        const std::size_t n = polar.size() * azimuth.size();
        const std::vector<Vec3f> wl(n, to_float(spherical(theta_l, phi_l)));
        std::vector<Vec3f> wv;
        for (const float p : polar)
            for (const float a : azimuth)
                wv.push_back(to_float(node_direction(table, theta_l, phi_l, double(p), double(a))));
        std::vector<Rgb> f(n);
        part(wl, wv, f);
        for (std::size_t i = 0; i < n; ++i)
            slice.f.push_back(wv[i].z > 1e-6f && is_finite(f[i])
                                  ? float(f[i].r == f[i].b ? double(f[i].g) : luminance(f[i]))
                                  : k_nan);
    });
    return table;
}

// ---- Measurements ----

bool is_isotropic(const ScatterTable& table) { return table.rotation.size() == 1; }

std::vector<TableLine> lines_about(const ScatterTable& table) {
    const ScatterTable::Slice& first_slice = table.slices.front();
    ValueRange theta_l, polar, value;
    std::uint64_t values = 0;
    std::string tis;
    for (std::size_t k = 0; k < table.slices.size(); ++k) {
        const ScatterTable::Slice& slice = table.slices[k];
        theta_l.add(float(double(slice.theta_l) / k_degree));
        for (const float p : slice.polar) polar.add(float(double(p) / k_degree));
        for (const float f : slice.f) value.add(f);
        values += slice.f.size() / table.channels;
        if (k < table.first[1] && k < 20)
            tis += fmt::format("{}{:.4g} at {:.3g}°", k ? ", " : "",
                               scatter_integral(table, slice, table.channels == 1 ? 0 : 1),
                               double(slice.theta_l) / k_degree);
    }
    return {{"dimensions",
             fmt::format(
                 "{} rotations of the sample, {} angles of incidence in total, {} polar × {} azimuths about the {}{}",
                 table.rotation.size(), table.slices.size(), first_slice.polar.size(), first_slice.azimuth.size(),
                 table.about_mirror ? "mirror direction" : "normal", table.channels == 1 ? "" : ", CIE X, Y, Z")},
            {"θl", theta_l.text() + " degrees"},
            {"polar angle", polar.text() + " degrees"},
            {"masked entries",
             fmt::format("{} of {}, 0 or a number for no value in the file", grouped(table.masked), grouped(values))},
            {"value [1/sr]", value.text()},
            {"TIS", "∫ f cosθ over the measured directions: " + tis}};
}

EvaluatedTable as_evaluated_table(ScatterTable table) {
    return evaluated_table(std::make_shared<const ScatterTable>(std::move(table)));
}

Measured measured_of(std::array<std::optional<ScatterTable>, 2> tables, const std::string& file_name,
                     const char* format) {
    if (!tables[1]) return {file_name, format, 0, as_evaluated_table(*std::move(tables[0]))};
    BsdfTable both{{{}}, 0, {}};
    for (std::size_t s = 0; s < 2; ++s)
        if (tables[s])
            both.bands[0].part[std::size_t(s == 0 ? Part::reflection_front : Part::transmission_front)] =
                std::make_shared<const Measured>(
                    Measured{file_name, format, 0, as_evaluated_table(*std::move(tables[s]))});
    return {file_name, format, 0, std::move(both)};
}

std::vector<ScatterTable> scatter_tables(const TableSource& source, bool about_mirror, int threads) {
    std::vector<ScatterTable> tables;
    for (const Part part : {Part::reflection_front, Part::transmission_front}) {
        if (!source.has[std::size_t(part)]) continue;
        const Measured* measured = source.measured && !source.measured->is_exchanged ? source.measured : nullptr;
        const auto* bsdf = measured ? std::get_if<BsdfTable>(&measured->table) : nullptr;
        if (bsdf) measured = bsdf->band().part[std::size_t(part)].get();
        const auto* table = measured ? table_as<ScatterTable>(*measured) : nullptr;
        if (table && table->about_mirror == about_mirror) {
            tables.push_back(*table);
            continue;
        }
        tables.push_back(to_scatter(part_of(source.values, part), about_mirror, source.isotropic, threads));
        tables.back().transmission = is_transmission(part);
    }
    return tables;
}

// ---- Text ----

std::string_view ScatterText::raw_line() {
    const auto end = std::min(text_.find('\n', offset_), text_.size());
    const std::string_view line = trimmed(text_.substr(offset_, end - offset_));
    offset_ = std::min(end + 1, text_.size());
    ++line_;
    return line;
}

std::string_view ScatterText::word() {
    while (offset_ < text_.size()) {
        const char c = text_[offset_];
        if (c == '\n') ++line_;
        if (c == '#' && comments_)
            offset_ = std::min(text_.find('\n', offset_), text_.size());
        else if (c == ' ' || c == '\t' || c == '\r' || c == '\n')
            ++offset_;
        else
            break;
    }
    const auto end = std::min(text_.find_first_of(" \t\r\n", offset_), text_.size());
    const std::string_view word = text_.substr(offset_, end - offset_);
    offset_ = end;
    return word;
}

std::size_t ScatterText::count(std::string_view what, std::size_t max_count) {
    const auto count = number<std::uint64_t>(what);
    if (!error_ && (count < 1 || count > max_count))
        fail(what, fmt::format("between 1 and {}", max_count), fmt::format("{}", count));
    return error_ ? 0 : std::size_t(count);
}

std::vector<float> ScatterText::angles(std::string_view what, std::size_t count, double lower, double upper) {
    std::vector<float> radians;
    for (std::size_t i = 0; i < count && !error_; ++i) {
        const double degrees = number<double>(what);
        if (error_) break;
        if (!(degrees >= lower && degrees <= upper) || (i > 0 && !(float(degrees * k_degree) > radians.back())))
            fail(what, fmt::format("rising ones from {:g} to {:g}", lower, upper), fmt::format("{:g}", degrees));
        radians.push_back(float(degrees * k_degree));
    }
    return radians;
}

void ScatterText::values(std::size_t count, std::vector<float>& target, double scale) {
    for (std::size_t i = 0; i < count && !error_; ++i) {
        const double f = number<double>("value") * scale;
        if (!error_ && !(std::abs(f) <= double(k_largest_value)))
            fail("value", "one in the range of values", fmt::format("{:g}", f));
        target.push_back(float(f));
    }
}

void ScatterText::fail(std::string_view what, std::string expected, std::string found) {
    if (!error_) error_ = at_line(file_name_, line_, std::string(what), std::move(expected), std::move(found));
}

std::string written_degrees(float radians) { return fmt::format("{:.7g}", double(radians) / k_degree); }

}  // namespace
