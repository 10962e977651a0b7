// BSDFs: models of the parts, and beams.

#include "base/errors.h"
#include "base/half.h"
#include "brdf/parts.h"
#include "brdf/values.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/bsdf/bsdf_kind.h"
#include "srbf/elementary.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

Rgb value(const BsdfModel& model, Vec3f wl, Vec3f wv) { return value(model.part, wl, wv); }

void evaluate(const BsdfModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    evaluate(model.part, wl, wv, f,
             [](const Model& part, auto l, auto v, auto result) { evaluate(part, l, v, result); });
}

std::size_t payload_bytes(const BsdfModel& model) {
    std::size_t bytes = 0;
    for (const auto& part : model.part) bytes += part ? payload_bytes(*part) : 0;
    for (const Beam& beam : model.beam) bytes += payload_bytes(beam);
    return bytes;
}

std::size_t payload_bytes(const Beam& beam) {
    std::size_t bytes = 0;
    for (const auto& [name, tensor] : encode_beams({beam})) bytes += 2 * tensor.data.size();
    return bytes;
}

std::size_t auxiliary_bytes(const BsdfModel& model) {
    std::size_t bytes = 0;
    for (const auto& part : model.part) bytes += part ? auxiliary_bytes(*part) : 0;
    return bytes;
}

bool is_isotropic(const BsdfModel& model) {
    return std::ranges::all_of(model.part, [](const auto& part) { return !part || is_isotropic(*part); });
}

void exchange(BsdfModel& model) { exchange_parts(model.part); }

namespace {
std::string prefix_of(Part part) { return fmt::format("{}.", name(part)); }
/// The fraction τ on a ring whose nodes begin at index `first`, for an azimuth in turns, 0..1.
Rgb fraction_on_ring(const Beam& beam, std::size_t ring, std::size_t first, float turns) {
    const auto n = std::size_t(beam.nodes(ring));
    const float position = turns * float(n);
    const std::size_t k = std::min(std::size_t(position), n - 1);
    return mixed(beam.fraction[first + k], beam.fraction[first + (k + 1) % n], position - float(k));
}

// The names of a beam's tensors.
std::string angle_name(std::string_view beam) { return fmt::format("beam.{}.angle", beam); }
std::string azimuths_name(std::string_view beam) { return fmt::format("beam.{}.azimuths", beam); }
std::string fraction_name(std::string_view beam) { return fmt::format("beam.{}.share", beam); }

Tensor16 to_halves(std::vector<std::uint64_t> shape, const auto& numbers) {
    Tensor16 tensor{Type16::half, std::move(shape), {}};
    for (const auto x : numbers) tensor.data.push_back(to_half(float(x)));
    return tensor;
}

/// Reads the tensors of beams.
struct BeamReader {
    const std::map<std::string, Tensor16>& tensors;
    const std::string& file_name;

    Error error(const std::string& tensor, std::string expected, std::string found) const {
        return Error{file_name, {}, fmt::format("tensor '{}'", tensor), std::move(expected), std::move(found)};
    }
    const Tensor16* find(const std::string& name) const {
        const auto entry = tensors.find(name);
        return entry == tensors.end() ? nullptr : &entry->second;
    }

    /// Reads the angles of the rings, and their numbers of nodes.
    Result<Beam> rings(std::string_view name) const {
        Beam beam;
        const std::string angle = angle_name(name), azimuths = azimuths_name(name);
        for (const std::uint16_t half : find(angle)->data) {
            const float theta = half == to_half(float(k_pi / 2)) ? float(k_pi / 2) : from_half(half);
            if (!(theta >= 0 && theta <= 1.5713f && (beam.theta.empty() || theta > beam.theta.back())))
                return error(angle, "rising angles from 0 to 90 degrees", fmt::format("{}", theta));
            beam.theta.push_back(theta);
        }
        const Tensor16* tensor = find(azimuths);
        for (std::size_t i = 0; tensor && i < tensor->data.size(); ++i) {
            const float n = from_half(tensor->data[i]);
            if (!(n >= 1 && n <= float(k_max_beam_nodes) && n == std::floor(n)))
                return error(azimuths, fmt::format("whole numbers from 1 to {}", k_max_beam_nodes),
                             fmt::format("{}", n));
            beam.azimuths.push_back(int(n));
        }
        return beam;
    }
    /// The shapes that the tensors of a beam must have. A grey beam with azimuths has one channel.
    Result<std::map<std::string, TensorShape>> shapes(std::string_view name) const {
        const std::string angle = angle_name(name), azimuths = azimuths_name(name), fraction = fraction_name(name);
        const auto& shape = find(angle)->shape;
        if (shape.size() != 1 || shape[0] < 1 || shape[0] > k_max_beam_rings)
            return input_error(file_name, fmt::format("tensor '{}': shape", angle),
                               fmt::format("[n] up to [{}]", k_max_beam_rings), shape_text(shape));
        std::map<std::string, TensorShape> expected{{angle, {Type16::half, {shape[0]}}}};
        std::uint64_t nodes = shape[0];
        if (const Tensor16* tensor = find(azimuths)) {
            expected[azimuths] = {Type16::half, {shape[0]}};
            nodes = 0;
            for (const std::uint16_t half : tensor->data)
                if (const float n = from_half(half); n >= 1 && n <= float(k_max_beam_nodes)) nodes += std::uint64_t(n);
        }
        const Tensor16* fractions = find(fraction);
        const bool is_grey = find(azimuths) && fractions && fractions->shape.size() == 2 && fractions->shape[1] == 1;
        expected[fraction] = {Type16::half, {nodes, std::uint64_t(is_grey ? 1 : 3)}};
        return expected;
    }
    Result<Beam> beam(std::string_view name) const {
        auto beam = rings(name);
        if (!beam) return beam;
        const std::string fraction = fraction_name(name);
        const Tensor16& tensor = *find(fraction);
        const std::size_t channels = tensor.shape[1];
        for (std::size_t i = 0; i < tensor.data.size(); ++i) {
            const float tau = from_half(tensor.data[i]);
            if (!(tau >= 0 && tau <= 1)) return error(fraction, "numbers from 0 to 1", fmt::format("{}", tau));
            if (i % channels == 0) beam->fraction.push_back({tau, tau, tau});
            beam->fraction.back()[int(i % channels)] = tau;
        }
        return beam;
    }
};

}  // namespace

Rgb fraction_at(const Beam& beam, Vec3f wl) {
    if (beam.empty() || !std::isfinite(wl.x + wl.y + wl.z)) return {};
    const float theta = elementary::acos(std::fmin(std::abs(wl.z), 1.f));
    float turns = 0;
    if (!beam.azimuths.empty()) {
        turns = elementary::atan2(wl.y, wl.x) / float(2 * k_pi);
        turns = std::fmin(turns < 0 ? turns + 1 : turns, 1.f);
    }
    // Interpolates between the rings next to θ. The fraction is constant below the first ring, and falls to 0 at 90°.
    std::size_t next = 0, first = 0, before = 0;
    for (; next < beam.theta.size() && beam.theta[next] <= theta; ++next)
        before = first, first += std::size_t(beam.nodes(next));
    if (next == 0) return fraction_on_ring(beam, 0, 0, turns);
    const bool is_last = next == beam.theta.size();
    const float theta0 = beam.theta[next - 1], theta1 = is_last ? float(k_pi / 2) : beam.theta[next];
    const float t = theta1 > theta0 ? std::fmin((theta - theta0) / (theta1 - theta0), 1.f) : 0.f;
    return mixed(fraction_on_ring(beam, next - 1, before, turns),
                 is_last ? Rgb{} : fraction_on_ring(beam, next, first, turns), t);
}

Rgb fraction_at(const Beams& beams, Part part, Vec3f wl) {
    const Beam& beam = beams[std::size_t(part)];
    if (beam.empty() && is_transmission(part)) return fraction_at(beams[std::size_t(counterpart(part))], mirror(wl));
    return fraction_at(beam, wl);
}

Evaluate part_of(Evaluate bsdf, Part part) {
    return [bsdf = std::move(bsdf), part](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        require_equal_lengths(wl.size(), wv.size(), f.size());
        std::vector<Vec3f> lights, views;
        for (std::size_t i = 0; i < f.size(); ++i) {
            lights.push_back(to_side(wl[i], side_of_light(part)));
            views.push_back(to_side(wv[i], side_of_viewer(part)));
        }
        bsdf(lights, views, f);
        for (std::size_t i = 0; i < f.size(); ++i)
            if (!above_horizon(wl[i], wv[i])) f[i] = {};
    };
}

void add_part(const Safetensors& tensors, Part part, Safetensors& content) {
    for (const auto& [key, tensor] : tensors.tensors) content.tensors[prefix_of(part) + key] = tensor;
    for (const auto& [key, text] : tensors.metadata) content.metadata[prefix_of(part) + key] = text;
}

Safetensors take_part(Safetensors& content, Part part) {
    const std::string prefix = prefix_of(part);
    Safetensors taken;
    const auto take = [&](auto& source, auto& target) {
        for (auto entry = source.lower_bound(prefix); entry != source.end() && entry->first.starts_with(prefix);) {
            target[entry->first.substr(prefix.size())] = std::move(entry->second);
            entry = source.erase(entry);
        }
    };
    take(content.tensors, taken.tensors);
    take(content.metadata, taken.metadata);
    return taken;
}

std::map<std::string, Tensor16> encode_beams(const Beams& beams) {
    std::map<std::string, Tensor16> tensors;
    for (std::size_t b = 0; b < beams.size(); ++b) {
        const Beam& beam = beams[b];
        if (beam.empty()) continue;
        const bool is_grey = !beam.azimuths.empty() &&
                             std::ranges::all_of(beam.fraction, [](const Rgb& x) { return x.r == x.g && x.g == x.b; });
        std::vector<float> fraction;
        for (const Rgb& tau : beam.fraction)
            for (int c = 0; c < (is_grey ? 1 : 3); ++c) fraction.push_back(tau[c]);
        const auto rings = std::uint64_t(beam.theta.size()), nodes = std::uint64_t(beam.fraction.size());
        tensors[angle_name(k_beam_names[b])] = to_halves({rings}, beam.theta);
        if (!beam.azimuths.empty()) tensors[azimuths_name(k_beam_names[b])] = to_halves({rings}, beam.azimuths);
        tensors[fraction_name(k_beam_names[b])] = to_halves({nodes, std::uint64_t(is_grey ? 1 : 3)}, fraction);
    }
    return tensors;
}

Result<Beams> decode_beams(const std::map<std::string, Tensor16>& tensors, const std::string& file_name) {
    const BeamReader reader{tensors, file_name};
    std::map<std::string, TensorShape> expected;
    for (const std::string_view name : k_beam_names) {
        if (!reader.find(angle_name(name))) continue;
        auto shapes = reader.shapes(name);
        if (!shapes) return shapes.error();
        expected.merge(*shapes);
    }
    if (const auto valid = check_tensors(tensors, expected, file_name); !valid) return valid.error();
    Beams beams;
    for (std::size_t b = 0; b < beams.size(); ++b) {
        if (!reader.find(angle_name(k_beam_names[b]))) continue;
        auto beam = reader.beam(k_beam_names[b]);
        if (!beam) return beam.error();
        beams[b] = *std::move(beam);
    }
    return beams;
}

}  // namespace
