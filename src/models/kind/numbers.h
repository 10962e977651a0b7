// Kinds of models that one list of numbers describes: file, parameters, rows and ranges follow from it.
#pragma once
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "base/errors.h"
#include "base/half.h"
#include "models/kind/kind.h"

SRBF_BEGIN

/// A number or a colour of a model, or of each of its lobes, by one of four pointers.
template <typename M, typename Lobe = M> struct Member {
    std::string_view name;  ///< of the parameter
    float least, most;      ///< infinity: the largest 16-bit float
    float M::*number = nullptr;
    Rgb M::*colour = nullptr;
    float Lobe::*lobe_number = nullptr;
    Rgb Lobe::*lobe_colour = nullptr;
    std::string_view tensor = name, row = name;  ///< names in the file and in the rows of `srbf info`

    constexpr bool of_lobe() const { return lobe_number || lobe_colour; }
    constexpr int count() const { return colour || lobe_colour ? 3 : 1; }
};
inline constexpr float k_unbounded = std::numeric_limits<float>::infinity();

/// Number c of a member, 0 ≤ c < count.
template <typename M, typename Lobe, typename Of>
requires std::same_as<std::remove_const_t<Of>, M>
auto& number(Of& model, const Member<M, Lobe>& of, int c, std::size_t lobe = 0) {
    if constexpr (requires { model.lobes; }) {
        if (of.lobe_number) return model.lobes[lobe].*of.lobe_number;
        if (of.lobe_colour) return (&(model.lobes[lobe].*of.lobe_colour).r)[c];
    }
    return of.number ? model.*of.number : (&(model.*of.colour).r)[c];
}

template <typename M> std::size_t lobes_of_numbers(const M& model) {
    if constexpr (requires { model.lobes; }) return model.lobes.size();
    return 0;
}
template <typename M, typename Lobe>
std::vector<float> numbers_of(const M& model, const Member<M, Lobe>& of, std::size_t first, std::size_t end) {
    std::vector<float> numbers;
    for (std::size_t lobe = first; lobe < end; ++lobe)
        for (int c = 0; c < of.count(); ++c) numbers.push_back(number(model, of, c, lobe));
    return numbers;
}
/// All numbers of a member, and their shape: of lobes [L] or [L, 3], of others [1] or [3].
template <typename M, typename Lobe> NumberArray array_of(const M& model, const Member<M, Lobe>& of) {
    const std::size_t slots = of.of_lobe() ? lobes_of_numbers(model) : 1, count = std::size_t(of.count());
    std::vector<std::size_t> shape{of.of_lobe() ? slots : count};
    if (of.of_lobe() && count > 1) shape.push_back(count);
    return {std::move(shape), numbers_of(model, of, 0, slots)};
}

/// Functions of `Kind<M>` by its list `numbers`. A file has the members that `is_stored(model, member)`.
template <typename M> struct KindOfNumbers {
    static Safetensors content(const M& model) {
        Safetensors content;
        for (const auto& of : Kind<M>::numbers) {
            if (!is_stored(model, of)) continue;
            const NumberArray array = array_of(model, of);
            Tensor16& tensor =
                content.tensors[std::string(of.tensor)] = {Type16::half, {array.shape.begin(), array.shape.end()}, {}};
            for (const float x : array.numbers)
                tensor.data.push_back(to_half(std::clamp(x, of.least, std::min(of.most, k_half_max))));
        }
        return content;
    }
    /// The model of a file that has the members and the lobes of `model`.
    static Result<M> read_into(M model, const Safetensors& content, const std::string& file_name) {
        std::map<std::string, TensorShape> expected;
        for (const auto& of : Kind<M>::numbers)
            if (is_stored(model, of)) {
                const auto shape = array_of(model, of).shape;
                expected[std::string(of.tensor)] = {Type16::half, {shape.begin(), shape.end()}};
            }
        if (const auto valid = check_tensors(content.tensors, expected, file_name); !valid) return valid.error();
        for (const auto& of : Kind<M>::numbers) {
            const auto tensor = content.tensors.find(std::string(of.tensor));
            for (std::size_t i = 0; tensor != content.tensors.end() && i < tensor->second.data.size(); ++i) {
                const float x = from_half(tensor->second.data[i]);
                if (!(x >= of.least && x <= of.most))
                    return input_error(
                        file_name, fmt::format("tensor '{}'", of.tensor),
                        of.most == k_unbounded ? "numbers of at least 0" : fmt::format("{} to {}", of.least, of.most),
                        fmt::format("{}", x));
                number(model, of, int(i) % of.count(), i / std::size_t(of.count())) = x;
            }
        }
        return model;
    }
    static double largest(const M& model) {
        double largest = 0;
        for (const auto& of : Kind<M>::numbers)
            if (of.most == k_unbounded)
                for (const float x : array_of(model, of).numbers) largest = std::max(largest, double(x));
        return largest;
    }
    /// Adds a row for each member, then for those of each lobe.
    static void add_numbers(std::string& text, const M& model, int width) {
        for (std::size_t row = 0; row <= lobes_of_numbers(model); ++row)
            for (const auto& of : Kind<M>::numbers)
                if (of.of_lobe() == (row > 0)) {
                    const std::size_t lobe = std::max<std::size_t>(row, 1) - 1;
                    text += fmt::format("  {:<{}}{:.4g}\n", of.row, width,
                                        fmt::join(numbers_of(model, of, lobe, lobe + 1), "  "));
                }
    }
    static Parameters parameters(const M& model) {
        Parameters all;
        for (const auto& of : Kind<M>::numbers) all.push_back({std::string(of.name), array_of(model, of)});
        return all;
    }
    static M from_parameters(ParameterReader& reader) {
        M model;
        for (const auto& of : Kind<M>::numbers) {
            const char* const colour = of.of_lobe() ? "L3" : "3";
            const auto numbers = reader.numbers(of.name, of.count() > 1 ? colour : of.of_lobe() ? "L" : "1");
            if constexpr (requires { model.lobes; }) model.lobes.resize(reader.length('L'));
            for (std::size_t i = 0; i < numbers.size(); ++i)
                number(model, of, int(i) % of.count(), i / std::size_t(of.count())) = numbers[i];
        }
        return model;
    }
};

SRBF_END
