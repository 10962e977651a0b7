// BSDFs as models: their parts and beams.
#include <fmt/format.h>

#include <algorithm>

#include "model/bsdf_file.h"
#include "srbf/half.h"
#include "srbf/model.h"

namespace srbf {

Rgb value(const BsdfModel& model, Vec3f wl, Vec3f wv) { return value(model.part, wl, wv); }

std::size_t payload_bytes(const BsdfModel& model) {
    std::size_t bytes = 0;
    for (const auto& part : model.part) bytes += part ? payload_bytes(*part) : 0;
    for (const Beam& beam : model.beam) bytes += 2 * 4 * beam.theta.size();
    return bytes;
}

std::size_t auxiliary_bytes(const BsdfModel& model) {
    std::size_t bytes = 0;
    for (const auto& part : model.part) bytes += part ? auxiliary_bytes(*part) : 0;
    return bytes;
}

namespace {
std::string prefix_of(Part part) { return fmt::format("{}.", name(part)); }
constexpr std::size_t k_most_beam_nodes = 256;
}  // namespace

void add_part(const Safetensors& part, Part of, Safetensors& content) {
    for (const auto& [key, tensor] : part.tensors) content.tensors[prefix_of(of) + key] = tensor;
    for (const auto& [key, text] : part.metadata) content.metadata[prefix_of(of) + key] = text;
}

Safetensors take_part(Safetensors& content, Part of) {
    const std::string prefix = prefix_of(of);
    Safetensors part;
    const auto take = [&](auto& from, auto& to) {
        for (auto at = from.lower_bound(prefix); at != from.end() && at->first.starts_with(prefix);) {
            to[at->first.substr(prefix.size())] = std::move(at->second);
            at = from.erase(at);
        }
    };
    take(content.tensors, part.tensors);
    take(content.metadata, part.metadata);
    return part;
}

std::map<std::string, Tensor16> encode_beams(const Beams& beams) {
    std::map<std::string, Tensor16> tensors;
    for (std::size_t b = 0; b < beams.size(); ++b) {
        const Beam& beam = beams[b];
        if (beam.empty()) continue;
        const auto n = std::uint64_t(beam.theta.size());
        Tensor16 angle{Type16::half, {n}, {}}, share{Type16::half, {n, 3}, {}};
        for (const float theta : beam.theta) angle.data.push_back(to_half(theta));
        for (const Rgb& tau : beam.share)
            for (int c = 0; c < 3; ++c) share.data.push_back(to_half(tau[c]));
        tensors[fmt::format("beam.{}.angle", k_beam_names[b])] = std::move(angle);
        tensors[fmt::format("beam.{}.share", k_beam_names[b])] = std::move(share);
    }
    return tensors;
}

Result<Beams> decode_beams(const std::map<std::string, Tensor16>& tensors, const std::string& file_name) {
    Beams beams;
    std::map<std::string, TensorShape> expected;
    for (const std::string_view of : k_beam_names) {
        const std::string angle = fmt::format("beam.{}.angle", of);
        const auto at = tensors.find(angle);
        if (at == tensors.end()) continue;
        const auto& shape = at->second.shape;
        if (shape.size() != 1 || shape[0] < 1 || shape[0] > k_most_beam_nodes)
            return Error{file_name,
                         {},
                         fmt::format("tensor '{}': shape", angle),
                         fmt::format("[n] up to [{}]", k_most_beam_nodes),
                         shape_text(shape)};
        expected[angle] = {Type16::half, {shape[0]}};
        expected[fmt::format("beam.{}.share", of)] = {Type16::half, {shape[0], 3}};
    }
    if (const auto valid = check_tensors(tensors, expected, file_name); !valid) return valid.error();
    for (std::size_t b = 0; b < beams.size(); ++b) {
        const std::string angle = fmt::format("beam.{}.angle", k_beam_names[b]),
                          share = fmt::format("beam.{}.share", k_beam_names[b]);
        if (!tensors.contains(angle)) continue;
        Beam& beam = beams[b];
        for (const std::uint16_t half : tensors.at(angle).data) {
            const float theta = from_half(half);
            if (!(theta >= 0 && theta <= 1.5713f && (beam.theta.empty() || theta > beam.theta.back())))
                return Error{file_name,
                             {},
                             fmt::format("tensor '{}'", angle),
                             "rising angles from 0 to 90 degrees",
                             fmt::format("{}", theta)};
            beam.theta.push_back(theta);
        }
        const auto& numbers = tensors.at(share).data;
        for (std::size_t i = 0; i < numbers.size(); i += 3) {
            const Rgb tau{from_half(numbers[i]), from_half(numbers[i + 1]), from_half(numbers[i + 2])};
            for (int c = 0; c < 3; ++c)
                if (!(tau[c] >= 0 && tau[c] <= 1))
                    return Error{file_name,
                                 {},
                                 fmt::format("tensor '{}'", share),
                                 "numbers from 0 to 1",
                                 fmt::format("{}", tau[c])};
            beam.share.push_back(tau);
        }
    }
    return beams;
}

}  // namespace srbf
