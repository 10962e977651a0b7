// Kinds of models that one list of numbers describes: file, parameters, rows, reports and ranges follow from it.
#pragma once
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/half.h"
#include "brdf/info_rows.h"
#include "brdf/values.h"
#include "models/kind/kind.h"

SRBF_BEGIN

/// A number or a colour of a model, or of each of its lobes, by one of four pointers.
template <typename M, typename Lobe = M> struct Member {
    std::string_view name;  ///< name of the parameter
    float min, max;         ///< infinity: the largest 16-bit float
    float M::*number = nullptr;
    Rgb M::*colour = nullptr;
    float Lobe::*lobe_number = nullptr;
    Rgb Lobe::*lobe_colour = nullptr;
    std::string_view tensor = name, row = name;  ///< names in the file and in the rows of `srbf info`

    constexpr bool belongs_to_lobe() const { return lobe_number || lobe_colour; }
    constexpr int count() const { return colour || lobe_colour ? 3 : 1; }
};
inline constexpr float k_unbounded = std::numeric_limits<float>::infinity();

/// Number c of a member, 0 ≤ c < count.
template <typename M, typename Lobe, typename MaybeConst>
requires std::same_as<std::remove_const_t<MaybeConst>, M>
auto& number(MaybeConst& model, const Member<M, Lobe>& member, int c, std::size_t lobe = 0) {
    if constexpr (requires { model.lobes; }) {
        if (member.lobe_number) return model.lobes[lobe].*member.lobe_number;
        if (member.lobe_colour) return (model.lobes[lobe].*member.lobe_colour)[c];
    }
    return member.number ? model.*member.number : (model.*member.colour)[c];
}

template <typename M> std::size_t lobes_of_numbers(const M& model) {
    if constexpr (requires { model.lobes; }) return model.lobes.size();
    return 0;
}
template <typename M, typename Lobe>
std::vector<float> collect_numbers(const M& model, const Member<M, Lobe>& member, std::size_t first, std::size_t end) {
    std::vector<float> numbers;
    for (std::size_t lobe = first; lobe < end; ++lobe)
        for (int c = 0; c < member.count(); ++c) numbers.push_back(number(model, member, c, lobe));
    return numbers;
}
/// All numbers of a member, and their shape: [L] or [L, 3] for members of lobes, [1] or [3] for others.
template <typename M, typename Lobe> NumberArray array_of(const M& model, const Member<M, Lobe>& member) {
    const std::size_t slots = member.belongs_to_lobe() ? lobes_of_numbers(model) : 1,
                      count = std::size_t(member.count());
    std::vector<std::size_t> shape{member.belongs_to_lobe() ? slots : count};
    if (member.belongs_to_lobe() && count > 1) shape.push_back(count);
    return {std::move(shape), collect_numbers(model, member, 0, slots)};
}

/// A file has the members that are stored: all of them, unless the kind says otherwise.
template <typename M, typename Lobe> constexpr bool is_stored(const M&, const Member<M, Lobe>&) { return true; }

template <typename M>
concept OfNumbers = requires {
    Kind<M>::numbers;
};
/// The number of stored numbers.
template <OfNumbers M> std::size_t number_count(const M& model) {
    std::size_t count = 0;
    for (const auto& member : Kind<M>::numbers)
        count += is_stored(model, member) ? array_of(model, member).numbers.size() : 0;
    return count;
}
// The functions of a `Model` (model.h); a kind that is anisotropic or not reciprocal has its own.
template <OfNumbers M> std::size_t payload_bytes(const M& model) { return 2 * number_count(model); }
template <OfNumbers M> constexpr std::size_t auxiliary_bytes(const M&) { return 0; }
template <OfNumbers M> constexpr bool is_isotropic(const M&) { return true; }
template <OfNumbers M> constexpr void exchange(M&) {}

/// A kind that is evaluated pair by pair: `Kind<M>::rho(model)` is the function of wl and wv above the horizon.
template <typename M>
concept OfPairs = requires {
    &Kind<M>::rho;
};
template <OfPairs M>
void evaluate(const M& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    const auto rho = Kind<M>::rho(model);
    for (std::size_t i = 0; i < f.size(); ++i) {
        const Vec3f value = rho(wl[i], wv[i]);
        f[i] = above_horizon(wl[i], wv[i]) ? Rgb{value.x, value.y, value.z} : Rgb{};
    }
}
template <OfNumbers M> Rgb value(const M& model, Vec3f wl, Vec3f wv) {
    Rgb f;
    evaluate(model, {&wl, 1}, {&wv, 1}, {&f, 1});
    return f;
}
inline Vec3f vector_of(const Rgb& colour) { return {colour.r, colour.g, colour.b}; }

/// Functions of `Kind<M>` by its list `numbers`.
template <typename M> struct KindOfNumbers {
    static Safetensors content(const M& model) {
        Safetensors content;
        for (const auto& member : Kind<M>::numbers) {
            if (!is_stored(model, member)) continue;
            const NumberArray array = array_of(model, member);
            Tensor16& tensor = content.tensors[std::string(member.tensor)] = {
                Type16::half, {array.shape.begin(), array.shape.end()}, {}};
            for (const float x : array.numbers)
                tensor.data.push_back(to_half(std::clamp(x, member.min, std::min(member.max, k_half_max))));
        }
        return content;
    }
    static Result<M> read(Safetensors& content, const std::string& file_name) {
        return read_into({}, content, file_name);
    }
    /// The model of a file that has the members and the lobes of `model`.
    static Result<M> read_into(M model, const Safetensors& content, const std::string& file_name) {
        std::map<std::string, TensorShape> expected;
        for (const auto& member : Kind<M>::numbers)
            if (is_stored(model, member)) {
                const auto shape = array_of(model, member).shape;
                expected[std::string(member.tensor)] = {Type16::half, {shape.begin(), shape.end()}};
            }
        if (const auto valid = check_tensors(content.tensors, expected, file_name); !valid) return valid.error();
        for (const auto& member : Kind<M>::numbers) {
            const auto tensor = content.tensors.find(std::string(member.tensor));
            for (std::size_t i = 0; tensor != content.tensors.end() && i < tensor->second.data.size(); ++i) {
                const float x = from_half(tensor->second.data[i]);
                if (!(x >= member.min && x <= member.max))
                    return input_error(file_name, fmt::format("tensor '{}'", member.tensor),
                                       member.max == k_unbounded ? "numbers of at least 0"
                                                                 : fmt::format("{} to {}", member.min, member.max),
                                       fmt::format("{}", x));
                number(model, member, int(i) % member.count(), i / std::size_t(member.count())) = x;
            }
        }
        return model;
    }
    static double largest(const M& model) {
        double largest = 0;
        for (const auto& member : Kind<M>::numbers)
            if (member.max == k_unbounded)
                for (const float x : array_of(model, member).numbers) largest = std::max(largest, double(x));
        return largest;
    }
    static std::string summary(const M&) { return fmt::format("{}, {}", Kind<M>::name, Kind<M>::words); }
    /// Adds the kind, the size, a row for each member of the model, then a row for each member of each lobe.
    static void add_rows(std::string& text, const M& model) {
        add_row(text, "model", fmt::format("{}: {}", Kind<M>::name, Kind<M>::words));
        add_row(text, "size", fmt::format("{} numbers, {} bytes", number_count(model), payload_bytes(model)));
        std::size_t width = 18;
        for (const auto& member : Kind<M>::numbers) width = std::max(width, member.row.size() + 1);
        for (std::size_t row = 0; row <= lobes_of_numbers(model); ++row)
            for (const auto& member : Kind<M>::numbers)
                if (member.belongs_to_lobe() == (row > 0)) {
                    const std::size_t lobe = std::max<std::size_t>(row, 1) - 1;
                    text += fmt::format("  {:<{}}{:.4g}\n", member.row, width,
                                        fmt::join(collect_numbers(model, member, lobe, lobe + 1), "  "));
                }
    }
    static Parameters members(const M& model) {
        Parameters numbers = parameters(model);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (const auto& member = Kind<M>::numbers[i]; !member.belongs_to_lobe() && member.count() == 1)
                std::get<NumberArray>(numbers[i].value).shape.clear();
        return {{"form", std::string(Kind<M>::name)},
                {"lobes", std::max(1, int(lobes_of_numbers(model)))},
                {"variates", 1},
                {"axial", is_isotropic(model)},
                {"parameters", std::move(numbers)}};
    }
    /// A member in code: "x", or "Vec3(r, g, b)".
    template <typename Lobe>
    static std::string number_text(const M& model, const Member<M, Lobe>& member, const NumberText& text,
                                   std::size_t lobe = 0) {
        std::vector<std::string> numbers;
        for (int c = 0; c < member.count(); ++c)
            numbers.push_back(
                text(number(model, member, c, lobe), member.name, lobe * std::size_t(member.count()) + std::size_t(c)));
        return member.count() > 1 ? fmt::format("Vec3({})", fmt::join(numbers, ", ")) : numbers[0];
    }
    /// True if one of the kind's names is among the parameters.
    static bool matches(const ParameterReader& reader) {
        return std::ranges::any_of(Kind<M>::numbers, [&](const auto& member) { return reader.has(member.name); });
    }
    static Parameters parameters(const M& model) {
        Parameters all;
        for (const auto& member : Kind<M>::numbers) all.push_back({std::string(member.name), array_of(model, member)});
        return all;
    }
    static M from_parameters(ParameterReader& reader) {
        M model;
        for (const auto& member : Kind<M>::numbers) {
            constexpr const char* shapes[2][2] = {{"1", "L"}, {"3", "L3"}};
            const auto numbers = reader.numbers(member.name, shapes[member.count() > 1][member.belongs_to_lobe()]);
            if constexpr (requires { model.lobes; }) model.lobes.resize(reader.length('L'));
            for (std::size_t i = 0; i < numbers.size(); ++i)
                number(model, member, int(i) % member.count(), i / std::size_t(member.count())) = numbers[i];
        }
        return model;
    }
};

SRBF_END
