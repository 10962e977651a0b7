#include "base/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace srbf {

const Parameter* ParameterReader::find(std::string_view name) const {
    const auto at = std::ranges::find(all_, name, &Parameter::name);
    return at == all_.end() ? nullptr : &*at;
}

template <typename T> const T* ParameterReader::value(std::string_view name, const char* expected) {
    asked_.emplace_back(name);
    const Parameter* of = find(name);
    const T* value = of ? std::get_if<T>(&of->value) : nullptr;
    if (of && !value) refuse(name, expected, "another value");
    return value;
}

std::vector<float> ParameterReader::numbers(std::string_view name, std::string_view shape) {
    const auto* of = value<NumberArray>(name, "an array of numbers");
    if (!of) {
        refuse(argument_error({}, fmt::format("{}: missing", name), {}, {}));
        return {};
    }
    std::vector<std::string> axes, lengths;
    bool fits = of->shape.size() == shape.size();
    for (std::size_t i = 0; i < shape.size(); ++i) {
        const char axis = shape[i];
        const bool is_letter = axis < '0' || axis > '9';
        if (is_letter && of->shape.size() == shape.size()) lengths_.try_emplace(axis, of->shape[i]);
        const bool is_known = !is_letter || lengths_.contains(axis);
        const std::size_t length = is_letter ? this->length(axis) : std::size_t(axis - '0');
        fits = fits && of->shape[i] == length;
        axes.push_back(std::string(1, axis));
        lengths.push_back(is_known ? std::to_string(length) : axes.back());
    }
    if (!fits) {
        refuse(name, fmt::format("shape [{}] = [{}]", fmt::join(axes, ", "), fmt::join(lengths, ", ")),
               fmt::format("[{}]", fmt::join(of->shape, ", ")));
        return {};
    }
    if (!std::ranges::all_of(of->numbers, [](float x) { return std::isfinite(x); }))
        refuse(name, "finite numbers", "others");
    return of->numbers;
}

std::vector<Vec3f> ParameterReader::units(std::string_view name, std::string_view shape) {
    auto all = vectors<Vec3f>(name, shape);
    if (!std::ranges::all_of(all, [](const Vec3f& w) { return std::abs(dot(w, w) - 1) < 1e-3f; }))
        refuse(name, "unit vectors", "others");
    return all;
}

std::string ParameterReader::word(std::string_view name, const std::vector<std::string_view>& known,
                                  std::string_view preset) {
    const auto* of = value<std::string>(name, "a word");
    if (of && std::ranges::count(known, *of) == 0) refuse(name, fmt::format("{}", fmt::join(known, " or ")), *of);
    return of && !error_ ? *of : std::string(preset);
}

bool ParameterReader::flag(std::string_view name, bool preset) {
    const auto* of = value<bool>(name, "true or false");
    return of ? *of : preset;
}

int ParameterReader::whole(std::string_view name, int least, int most, int preset) {
    const auto* of = value<int>(name, "a whole number");
    if (of && (*of < least || *of > most)) refuse(name, fmt::format("{} to {}", least, most), std::to_string(*of));
    return of && !error_ ? *of : preset;
}

const Parameters* ParameterReader::part(std::string_view name) { return value<Parameters>(name, "parameters"); }

std::size_t ParameterReader::length(char letter) const {
    const auto at = lengths_.find(letter);
    return at == lengths_.end() ? 0 : at->second;
}

void ParameterReader::refuse(std::string_view name, std::string expected, std::string found) {
    refuse(argument_error({}, std::string(name), std::move(expected), std::move(found)));
}

void ParameterReader::refuse(const Error& error) {
    if (!error_) error_ = error;
}

std::optional<Error> ParameterReader::error() const {
    if (error_) return error_;
    for (const Parameter& of : all_)
        if (std::ranges::count(asked_, of.name) == 0)
            return argument_error({}, of.name, fmt::format("one of {}", fmt::join(asked_, ", ")), {});
    return {};
}

}  // namespace srbf
