// Scatter tables: their look-up, and the words of their files.
#include "measured/scatter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measured/limits.h"
#include "parallel.h"
#include "srbf/convert.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"

namespace srbf {

namespace {

/// Where x lies among rising nodes: between i and i + 1, at that share; beyond the ends at these.
struct NodePlace {
    std::size_t i = 0;
    double share = 0;
};
NodePlace place_among(std::span<const float> nodes, double x) {
    if (nodes.size() < 2 || !(x > double(nodes.front()))) return {};
    if (x >= double(nodes.back())) return {nodes.size() - 2, 1};
    const std::size_t next = std::size_t(std::ranges::upper_bound(nodes, float(x)) - nodes.begin());
    const std::size_t i = std::clamp<std::size_t>(next, 1, nodes.size() - 1) - 1;
    const double from = double(nodes[i]), to = double(nodes[i + 1]);
    return {i, std::clamp((x - from) / (to - from), 0.0, 1.0)};
}

/// A weighted mean of what was measured.
struct ScatterMean {
    double sum = 0, weight = 0;
    void add(double value, double of_weight) {
        if (of_weight > 0 && std::isfinite(value)) sum += of_weight * value, weight += of_weight;
    }
    double result() const { return weight > 0 ? sum / weight : double(k_nan); }
};

/// The azimuth in the range of the nodes: by whole turns, or mirrored at the plane of incidence if they cover half a turn.
double azimuth_within(std::span<const float> nodes, double phi) {
    if (double(nodes.back()) <= k_pi + k_azimuth_rounding && double(nodes.front()) >= 0)
        return std::abs(std::remainder(phi, 2 * k_pi));
    const double first = double(nodes.front());
    phi = std::fmod(phi - first, 2 * k_pi);
    return first + (phi < 0 ? phi + 2 * k_pi : phi);
}

/// Rotates about y by `theta`, from +z towards +x.
Vec3d tilted(const Vec3d& w, double theta) {
    const double c = elementary::cos(theta), s = elementary::sin(theta);
    return {c * w.x + s * w.z, w.y, c * w.z - s * w.x};
}

double polar_of(const Vec3d& w) { return elementary::atan2(elementary::hypot(w.x, w.y), w.z); }

/// The value of a slice at a direction given in the frame whose z is the mirror direction of its light.
double slice_at(const ScatterTable& table, const ScatterTable::Slice& slice, const Vec3d& about_mirror) {
    Vec3d w = about_mirror;
    double phi = elementary::atan2(-w.y, -w.x);  // 180° goes on towards grazing
    if (!table.about_mirror) {
        w = tilted(about_mirror, double(slice.theta_l));
        phi = elementary::atan2(w.y, w.x);  // 0 is the side of the mirror direction
    }
    const NodePlace p = place_among(slice.polar, polar_of(w));
    const std::size_t n = slice.azimuth.size();
    NodePlace a = place_among(slice.azimuth, azimuth_within(slice.azimuth, phi));
    std::size_t next = std::min(a.i + 1, n - 1);
    // Where the nodes leave the end of the turn open, the first follows the last.
    const double last = double(slice.azimuth.back()), turn = azimuth_within(slice.azimuth, phi);
    if (turn > last && n > 1) {
        const double gap = double(slice.azimuth.front()) + 2 * k_pi - last;
        a = {n - 1, std::clamp((turn - last) / gap, 0.0, 1.0)}, next = 0;
    }
    ScatterMean mean;
    for (const auto& [row, share] :
         {std::pair(p.i, 1 - p.share), {std::min(p.i + 1, slice.polar.size() - 1), p.share}}) {
        mean.add(double(slice.f[row * n + a.i]), share * (1 - a.share));
        mean.add(double(slice.f[row * n + next]), share * a.share);
    }
    return mean.result();
}

/// The value of a rotation of the sample, linear in the angle of incidence.
double rotation_at(const ScatterTable& table, std::size_t rotation, double theta_l, const Vec3d& about_mirror) {
    const std::size_t first = table.first[rotation], count = table.first[rotation + 1] - first;
    std::vector<float> nodes;
    for (std::size_t k = 0; k < count; ++k) nodes.push_back(table.slices[first + k].theta_l);
    const NodePlace at = place_among(nodes, theta_l);
    ScatterMean mean;
    mean.add(slice_at(table, table.slices[first + at.i], about_mirror), 1 - at.share);
    if (at.share > 0) mean.add(slice_at(table, table.slices[first + at.i + 1], about_mirror), at.share);
    return mean.result();
}

}  // namespace

Rgb signed_value(const ScatterTable& table, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    const double phi_l = elementary::atan2(double(wl.y), double(wl.x));
    const double theta_l = polar_of({double(wl.x), double(wl.y), double(wl.z)});
    // The frame whose +x is the side of the mirror direction.
    const double c = -elementary::cos(phi_l), s = -elementary::sin(phi_l);
    const Vec3d forward{c * double(wv.x) + s * double(wv.y), c * double(wv.y) - s * double(wv.x), double(wv.z)};
    const Vec3d about_mirror = tilted(forward, -theta_l);
    double f = 0;
    if (table.rotation.size() == 1) {
        f = rotation_at(table, 0, theta_l, about_mirror);
    } else {
        const double turn = azimuth_within(table.rotation, phi_l);
        NodePlace at = place_among(table.rotation, turn);
        std::size_t next = at.i + 1;
        if (const double last = double(table.rotation.back()); turn > last) {
            const double gap = double(table.rotation.front()) + 2 * k_pi - last;
            at = {table.rotation.size() - 1, std::clamp((turn - last) / gap, 0.0, 1.0)}, next = 0;
        }
        ScatterMean mean;
        mean.add(rotation_at(table, at.i, theta_l, about_mirror), 1 - at.share);
        if (at.share > 0) mean.add(rotation_at(table, next, theta_l, about_mirror), at.share);
        f = mean.result();
    }
    return {table.tint.r * float(f), table.tint.g * float(f), table.tint.b * float(f)};
}

Rgb value(const ScatterTable& table, Vec3f wl, Vec3f wv) {
    Rgb f = signed_value(table, wl, wv);
    for (int c = 0; c < 3; ++c) f[c] = f[c] < 0 ? 0 : f[c];  // a NaN is kept
    return f;
}

double scatter_integral(const ScatterTable& table, const ScatterTable::Slice& slice, bool with_cosine) {
    // Cells of a degree of the hemisphere about the normal, of which the table answers for each middle.
    constexpr int k_polar = 180, k_turn = 360;
    double sum = 0;
    for (int i = 0; i < k_polar; ++i) {
        const double theta = (i + 0.5) * k_pi / 2 / k_polar, c = elementary::cos(theta), s = elementary::sin(theta);
        for (int j = 0; j < k_turn; ++j) {
            const double phi = (j + 0.5) * 2 * k_pi / k_turn;
            const Vec3d w{s * elementary::cos(phi), s * elementary::sin(phi), c};
            const double f = slice_at(table, slice, tilted(w, -double(slice.theta_l)));
            if (std::isfinite(f)) sum += f * s * (with_cosine ? c : 1);
        }
    }
    return sum * (k_pi / 2 / k_polar) * (2 * k_pi / k_turn);
}

void mask_gaps(ScatterTable& table) {
    for (ScatterTable::Slice& slice : table.slices) {
        if (std::ranges::all_of(slice.f, [](float f) { return f == 0; })) continue;
        for (float& f : slice.f)
            if (f == 0) f = k_nan, ++table.masked;
    }
}

namespace {

std::vector<float> degrees_list(std::initializer_list<double> begin, double end, double step) {
    std::vector<float> all;
    for (const double angle : begin) all.push_back(float(angle * k_degree));
    while (double(all.back()) < (end - step / 2) * k_degree)
        all.push_back(float(std::round((double(all.back()) / k_degree + step) * 1e3) / 1e3 * k_degree));
    return all;
}

/// The direction of a part's frame at a place of a slice, for light at azimuth φ_l.
Vec3d direction_in(const ScatterTable& table, double theta_l, double phi_l, double polar, double azimuth) {
    const double s = elementary::sin(polar), x = s * elementary::cos(azimuth), y = s * elementary::sin(azimuth);
    const Vec3d local{table.about_mirror ? -x : x, table.about_mirror ? -y : y, elementary::cos(polar)};
    const Vec3d forward = table.about_mirror ? tilted(local, theta_l) : local;
    const double c = -elementary::cos(phi_l), turn = -elementary::sin(phi_l);
    return {c * forward.x - turn * forward.y, turn * forward.x + c * forward.y, forward.z};
}

}  // namespace

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
        const double phi_l = double(table.rotation[k / incidence.size()]), theta_l = double(slice.theta_l);
        const std::size_t n = polar.size() * azimuth.size();
        const std::vector<Vec3f> wl(n, to_float(spherical(theta_l, phi_l)));
        std::vector<Vec3f> wv;
        for (const float p : polar)
            for (const float a : azimuth)
                wv.push_back(to_float(direction_in(table, theta_l, phi_l, double(p), double(a))));
        std::vector<Rgb> f(n);
        part(wl, wv, f);
        for (std::size_t i = 0; i < n; ++i)
            slice.f.push_back(wv[i].z > 1e-6f && is_finite(f[i])
                                  ? float(f[i].r == f[i].b ? double(f[i].g) : luminance(f[i]))
                                  : k_nan);
    });
    return table;
}

// ---- Text ----

std::string_view ScatterText::raw_line() {
    const auto end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view line = trimmed(text_.substr(at_, end - at_));
    at_ = std::min(end + 1, text_.size());
    ++line_;
    return line;
}

std::string_view ScatterText::word() {
    while (at_ < text_.size()) {
        const char c = text_[at_];
        if (c == '\n') ++line_;
        if (c == '#' && comments_)
            at_ = std::min(text_.find('\n', at_), text_.size());
        else if (c == ' ' || c == '\t' || c == '\r' || c == '\n')
            ++at_;
        else
            break;
    }
    const auto end = std::min(text_.find_first_of(" \t\r\n", at_), text_.size());
    const std::string_view word = text_.substr(at_, end - at_);
    at_ = end;
    return word;
}

std::size_t ScatterText::count(std::string_view what, std::size_t most) {
    const auto count = number<std::uint64_t>(what);
    if (!error_ && (count < 1 || count > most))
        fail(what, fmt::format("between 1 and {}", most), fmt::format("{}", count));
    return error_ ? 0 : std::size_t(count);
}

std::vector<float> ScatterText::angles(std::string_view what, std::size_t count, double least, double most) {
    std::vector<float> all;
    for (std::size_t i = 0; i < count && !error_; ++i) {
        const double degrees = number<double>(what);
        if (error_) break;
        if (!(degrees >= least && degrees <= most) || (i > 0 && !(float(degrees * k_degree) > all.back())))
            fail(what, fmt::format("rising ones from {:g} to {:g}", least, most), fmt::format("{:g}", degrees));
        all.push_back(float(degrees * k_degree));
    }
    return all;
}

void ScatterText::values(std::size_t count, std::vector<float>& to, double scale) {
    for (std::size_t i = 0; i < count && !error_; ++i) {
        const double f = number<double>("value") * scale;
        if (!error_ && !(std::abs(f) <= double(k_largest_value)))
            fail("value", "one in the range of values", fmt::format("{:g}", f));
        to.push_back(float(f));
    }
}

void ScatterText::fail(std::string_view what, std::string expected, std::string found) {
    if (!error_) error_ = at_line(file_name_, line_, std::string(what), std::move(expected), std::move(found));
}

std::string written_degrees(float radians) { return fmt::format("{:.7g}", double(radians) / k_degree); }

}  // namespace srbf
