// Arrays and errors between Python and the library. Arrays are contiguous float32; directions and colours are [n, 3].
#pragma once
#include <pybind11/numpy.h>

#include "background.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "brdf/colour.h"
#include "srbf/result.h"
#include "srbf/vec.h"

namespace srbf {

namespace py = pybind11;
using Array = py::array_t<float, py::array::c_style>;
static_assert(sizeof(Vec3f) == 12 && sizeof(Rgb) == 12);

inline std::size_t rows(const Array& array) { return std::size_t(array.shape(0)); }
template <typename T> std::span<const T> span_of(const Array& array) {
    return {reinterpret_cast<const T*>(array.data()), rows(array)};
}
template <typename T> std::span<T> mutable_span_of(Array& array) {
    return {reinterpret_cast<T*>(array.mutable_data()), rows(array)};
}
inline Array array_of(std::span<const float> numbers, std::vector<py::ssize_t> shape) {
    Array array(std::move(shape));
    std::copy(numbers.begin(), numbers.end(), array.mutable_data());
    return array;
}
template <typename T> std::span<const float> floats(const std::vector<T>& values) {
    return {reinterpret_cast<const float*>(values.data()), values.size() * sizeof(T) / sizeof(float)};
}

/// A string of Python. Bytes that are not UTF-8 are kept ("surrogateescape") or written as \\xff ("backslashreplace").
inline py::str to_python_text(std::string_view text, const char* error_handler = "backslashreplace") {
    auto* decoded = PyUnicode_DecodeUTF8(text.data(), py::ssize_t(text.size()), error_handler);
    if (decoded == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::str>(decoded);
}
inline py::str file_name_of(std::string_view name) { return to_python_text(name, "surrogateescape"); }

/// Raises srbf.Error.
[[noreturn]] inline void raise(const Error& error) {
    const py::object type = py::module_::import("srbf").attr("Error");
    const py::object offset = error.offset ? py::cast(*error.offset) : py::none();
    const py::object exception =
        type(to_python_text(message(error)), file_name_of(error.source), offset, printable(error.what),
             printable(error.expected), printable(error.found), std::string(name(error.code)));
    PyErr_SetObject(type.ptr(), exception.ptr());
    throw py::error_already_set();
}
template <typename T> T required(Result<T> result) {
    if (!result) raise(result.error());
    return *std::move(result);
}

/// The first row whose squared length differs from 1 by 1e-3 or more; w.size() if there is none.
inline std::size_t first_not_unit(std::span<const Vec3f> w) {
    const auto is_wrong = [&](std::size_t i) { return !(std::abs(dot(w[i], w[i]) - 1) < 1e-3f); };
    constexpr std::size_t block = 1024;
    for (std::size_t first = 0; first < w.size(); first += block) {
        const std::size_t end = std::min(first + block, w.size());
        int wrong = 0;
        for (std::size_t i = first; i < end; ++i) wrong += is_wrong(i);
        for (std::size_t i = first; wrong > 0 && i < end; ++i)
            if (is_wrong(i)) return i;
    }
    return w.size();
}

/// Raises ValueError for the first row that is not a unit vector.
inline void require_unit(const Array& directions, const char* argument) {
    const std::span<const Vec3f> w = span_of<Vec3f>(directions);
    const std::size_t i = [&] {
        const py::gil_scoped_release released;
        return first_not_unit(w);
    }();
    if (i == w.size()) return;
    throw py::value_error(std::string(argument) + " at " + std::to_string(i) + ": expected a unit vector, found (" +
                          std::to_string(w[i].x) + ", " + std::to_string(w[i].y) + ", " + std::to_string(w[i].z) + ")");
}

/// Calls body(first, count) for parts of n rows, on all threads if there are several. Ctrl-C cancels a million rows.
template <typename Body> void for_parts(std::size_t n, const Body& body) {
    constexpr std::size_t k_part_rows = 1 << 14, k_rows_to_cancel = 1 << 20;
    const auto run = [&](const ProgressToken& token) {
        parallel_for_chunks(n, k_part_rows, n > k_part_rows ? 0 : 1, [&](std::size_t begin, std::size_t end) {
            if (!token.cancelled()) body(begin, end - begin);
        });
        return Done{};
    };
    if (n > k_rows_to_cancel) {
        in_background(py::none(), run);
        return;
    }
    const py::gil_scoped_release released;
    run({});
}

}  // namespace srbf
