// The numbers of a model as Python values, and models made from such values.
#pragma once
#include "brdf.h"
#include "models/kind/parameters.h"

namespace srbf {

inline py::dict to_python(const Parameters& parameters) {
    py::dict values;
    for (const Parameter& parameter : parameters)
        values[py::str(parameter.name)] = std::visit(
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
            parameter.value);
    return values;
}

/// The numbers of an array. Raises TypeError for anything but an array of real numbers.
inline NumberArray to_number_array(const std::string& name, const py::handle& value) {
    const py::array array = py::module_::import("numpy").attr("asarray")(value);
    if (const char kind = array.dtype().kind(); kind != 'f' && kind != 'i' && kind != 'u')
        throw py::type_error(name + ": expected real numbers, found dtype " +
                             py::str(array.dtype()).cast<std::string>());
    const py::array_t<float, py::array::c_style | py::array::forcecast> numbers(array);
    return {{array.shape(), array.shape() + array.ndim()}, {numbers.data(), numbers.data() + numbers.size()}};
}

inline Parameters from_python(const py::dict& values) {
    Parameters parameters;
    for (const auto& [key, value] : values) {
        Parameter& parameter = parameters.emplace_back(Parameter{key.cast<std::string>(), {}});
        if (py::isinstance<py::dict>(value))
            parameter.value = from_python(value.cast<py::dict>());
        else if (py::isinstance<py::str>(value))
            parameter.value = value.cast<std::string>();
        else if (py::isinstance<py::bool_>(value) ||
                 std::string(Py_TYPE(value.ptr())->tp_name).starts_with("numpy.bool"))
            parameter.value = value.cast<bool>();
        else if (py::isinstance<py::int_>(value))
            parameter.value = value.cast<int>();
        else
            parameter.value = to_number_array(parameter.name, value);
    }
    return parameters;
}

inline PyBrdf model_of(const py::dict& parameters, std::map<std::string, std::string> provenance) {
    return PyBrdf(required(model_from(from_python(parameters), std::move(provenance))));
}

}  // namespace srbf
