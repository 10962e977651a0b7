// The numbers of a model as Python's values, and models of such values.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "base/parameters.h"
#include "brdf.h"

namespace srbf {

inline py::dict to_python(const Parameters& all) {
    py::dict of;
    for (const Parameter& one : all)
        of[py::str(one.name)] = std::visit(
            []<typename T>(const T& value) -> py::object {
                if constexpr (std::is_same_v<T, Parameters>)
                    return to_python(value);
                else if constexpr (std::is_same_v<T, NumberArray>)
                    return array_of(value.numbers, {value.shape.begin(), value.shape.end()});
                else if constexpr (std::is_same_v<T, std::monostate>)
                    return py::none();
                else
                    return py::cast(value);
            },
            one.value);
    return of;
}

/// Raises TypeError for what is no array of real numbers.
inline NumberArray numbers_of(const std::string& name, const py::handle& value) {
    const py::array array = py::module_::import("numpy").attr("asarray")(value);
    if (const char kind = array.dtype().kind(); kind != 'f' && kind != 'i' && kind != 'u')
        throw py::type_error(name + ": expected real numbers, found dtype " +
                             py::str(array.dtype()).cast<std::string>());
    const py::array_t<float, py::array::c_style | py::array::forcecast> numbers(array);
    return {{array.shape(), array.shape() + array.ndim()}, {numbers.data(), numbers.data() + numbers.size()}};
}

inline Parameters from_python(const py::dict& all) {
    Parameters of;
    for (const auto& [key, value] : all) {
        Parameter& one = of.emplace_back(Parameter{key.cast<std::string>(), {}});
        if (py::isinstance<py::dict>(value))
            one.value = from_python(value.cast<py::dict>());
        else if (py::isinstance<py::str>(value))
            one.value = value.cast<std::string>();
        else if (py::isinstance<py::bool_>(value) ||
                 std::string(Py_TYPE(value.ptr())->tp_name).starts_with("numpy.bool"))
            one.value = value.cast<bool>();
        else if (py::isinstance<py::int_>(value))
            one.value = value.cast<int>();
        else
            one.value = numbers_of(one.name, value);
    }
    return of;
}

inline Held model_of(const py::dict& parameters, std::map<std::string, std::string> provenance) {
    return Held(required(model_from(from_python(parameters), std::move(provenance))));
}

}  // namespace srbf
