#include "models/kind/parameters.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"

namespace SRBF_NAMESPACE {

const Parameter* ParameterReader::find(std::string_view name) const {
    const auto found = std::ranges::find(all_, name, &Parameter::name);
    return found == all_.end() ? nullptr : &*found;
}

template <typename T> const T* ParameterReader::value(std::string_view name, const char* expected) {
    requested_.emplace_back(name);
    const Parameter* parameter = find(name);
    const T* value = parameter ? std::get_if<T>(&parameter->value) : nullptr;
    if (parameter && !value) refuse(name, expected, "another value");
    return value;
}

std::vector<float> ParameterReader::numbers(std::string_view name, std::string_view shape) {
    const auto* array = value<NumberArray>(name, "an array of numbers");
    if (!array) {
        refuse(argument_error({}, fmt::format("{}: missing", name), {}, {}));
        return {};
    }
    std::vector<std::string> axes, lengths;
    bool fits = array->shape.size() == shape.size();
    for (std::size_t i = 0; i < shape.size(); ++i) {
        const char axis = shape[i];
        const bool is_letter = axis < '0' || axis > '9';
        if (is_letter && array->shape.size() == shape.size()) lengths_.try_emplace(axis, array->shape[i]);
        const bool is_known = !is_letter || lengths_.contains(axis);
        const std::size_t length = is_letter ? this->length(axis) : std::size_t(axis - '0');
        fits = fits && array->shape[i] == length;
        axes.push_back(std::string(1, axis));
        lengths.push_back(is_known ? std::to_string(length) : axes.back());
    }
    if (!fits) {
        refuse(name, fmt::format("shape [{}] = [{}]", fmt::join(axes, ", "), fmt::join(lengths, ", ")),
               fmt::format("[{}]", fmt::join(array->shape, ", ")));
        return {};
    }
    if (!std::ranges::all_of(array->numbers, [](float x) { return std::isfinite(x); }))
        refuse(name, "finite numbers", "");
    return array->numbers;
}

std::vector<Vec3f> ParameterReader::units(std::string_view name, std::string_view shape) {
    auto units = vectors<Vec3f>(name, shape);
    if (!std::ranges::all_of(units, [](const Vec3f& w) { return std::abs(dot(w, w) - 1) < 1e-3f; }))
        refuse(name, "unit vectors", "");
    return units;
}

std::string ParameterReader::word(std::string_view name, const std::vector<std::string_view>& known,
                                  std::string_view preset) {
    const auto* word = value<std::string>(name, "a word");
    if (word && std::ranges::count(known, *word) == 0) refuse(name, fmt::format("{}", fmt::join(known, " or ")), *word);
    return word && !error_ ? *word : std::string(preset);
}

bool ParameterReader::flag(std::string_view name, bool preset) {
    const auto* flag = value<bool>(name, "true or false");
    return flag ? *flag : preset;
}

int ParameterReader::integer(std::string_view name, int min, int max, int preset) {
    const auto* number = value<int>(name, "a whole number");
    if (number && (*number < min || *number > max))
        refuse(name, fmt::format("{} to {}", min, max), std::to_string(*number));
    return number && !error_ ? *number : preset;
}

const Parameters* ParameterReader::part(std::string_view name) { return value<Parameters>(name, "parameters"); }

std::size_t ParameterReader::length(char letter) const {
    const auto found = lengths_.find(letter);
    return found == lengths_.end() ? 0 : found->second;
}

void ParameterReader::refuse(std::string_view name, std::string expected, std::string found) {
    refuse(argument_error({}, std::string(name), std::move(expected), std::move(found)));
}

void ParameterReader::refuse(const Error& error) {
    if (!error_) error_ = error;
}

std::optional<Error> ParameterReader::error() const {
    if (error_) return error_;
    for (const Parameter& parameter : all_)
        if (std::ranges::count(requested_, parameter.name) == 0)
            return argument_error({}, parameter.name, fmt::format("one of {}", fmt::join(requested_, ", ")), {});
    return {};
}

}  // namespace
