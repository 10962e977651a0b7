// The library for Python: the module srbf._srbf. On top of it, python/srbf/__init__.py supports arrays of any
// shape. Most functions are in headers: because of pybind11, two files took half as long again to compile.
#include <pybind11/stl.h>

#include "api/table_file.h"
#include "code/offered_code.h"
#include "errors/sphere.h"
#include "fit/fit_options.h"
#include "fits.h"
#include "measured/tables.h"
#include "parameters.h"
#include "python_code.h"
#include "srbf/convert.h"
#include "srbf/edit.h"
#include "srbf/shading_code.h"

namespace srbf {
namespace {

Array render(const PyBrdf& brdf, const std::string& lighting, int size, bool is_preview) {
    constexpr int k_preview_points = 48;
    const auto lighting_row = std::ranges::find(standard_lightings(), std::string_view(lighting), &Lighting::name);
    const Evaluate brdfs[] = {brdf.evaluate()};
    const auto pictures = in_background(py::none(), [&](const ProgressToken& token) {
        return sphere_pictures(brdfs, std::span(&*lighting_row, 1), size, 0, token,
                               is_preview ? k_preview_points : k_mirror_points);
    });
    return array_of(floats(pictures[0][0].pixels), {size, size, 3});
}

void convert(const PyBrdf& brdf, const std::string& path, bool spectra, int threads) {
    const auto refused = [&](const char* what, std::string expected) {
        raise({"", {}, what, std::move(expected), path, ErrorCode::argument});
    };
    const Format* format = format_written_to(path);
    if (!format) refused("path", "a name that ends in " + extensions_of_formats());
    if (!spectra && format->extension != ".bsdf") refused("spectra", "False only with a path that ends in .bsdf");
    if (threads != 0 && format->extension == ".csv") refused("threads", "no number with a path that ends in .csv");
    required(in_background(py::none(), [&](const ProgressToken& token) -> Result<Done> {
        const auto bytes =
            table_file(brdf.content(), *format, {.spectra = spectra, .threads = threads, .progress = token});
        if (!bytes) return bytes.error();
        return write_file(path, *bytes);
    }));
}

/// The names of a table's rows.
template <typename Rows> std::vector<std::string> names_of(const Rows& rows) {
    std::vector<std::string> names;
    for (const auto& row : rows) names.emplace_back(row.name);
    return names;
}

std::string code(const std::vector<PyBrdf>& models, const std::vector<std::string>& names, const std::string& to,
                 const std::string& prefix, bool sampling, bool albedo) {
    std::vector<NamedModel> named;
    for (std::size_t i = 0; i < models.size(); ++i) named.push_back({identifier(names[i]), &models[i].require_model()});
    for (const CodeModule& module : code_modules())
        if (to == module.name) return required(module.text(named, prefix, 0));
    const auto language = code_language_named(to);
    if (!language) return {};
    return required(shading_code(named, prefix, {.language = *language, .sampling = sampling, .albedo = albedo}));
}

py::list notes_of(const PyBrdf& brdf) {
    py::list lines;
    if (brdf.measured())
        for (const std::string& note : notes(*brdf.measured())) lines.append(to_python_text(note));
    return lines;
}

py::dict provenance_of(const PyBrdf& brdf) {
    py::dict entries;
    if (brdf.model())
        for (const auto& [key, value] : brdf.model()->provenance) entries[to_python_text(key)] = to_python_text(value);
    return entries;
}

PyBrdf edit_of(const PyBrdf& brdf, const Edit& edit) {
    const Model& model = brdf.require_model();
    return PyBrdf(required(in_background(py::none(), [&](const ProgressToken& token) {
        return edit_model(model, std::span(&edit, 1), {.progress = token});
    })));
}

using Colour = std::array<float, 3>;
Rgb colour_of(const Colour& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

void define_edits(py::class_<PyBrdf>& brdf) {
    brdf.def("roughened", [](const PyBrdf& model, double factor) { return edit_of(model, Roughen{factor}); })
        .def("tinted",
             [](const PyBrdf& model, const Colour& highlight, const Colour& body) {
                 return edit_of(model, Tint{colour_of(highlight), colour_of(body)});
             })
        .def("saturated", [](const PyBrdf& model, double factor) { return edit_of(model, Saturate{factor}); })
        .def("hue_turned", [](const PyBrdf& model, double degrees) { return edit_of(model, TurnHue{degrees}); })
        .def("rotated", [](const PyBrdf& model, double degrees) { return edit_of(model, Rotate{degrees}); })
        .def("coated",
             [](const PyBrdf& model, double roughness, double ior, const Colour& tint) {
                 return edit_of(model, Coat{roughness, ior, colour_of(tint)});
             })
        .def("reduced", [](const PyBrdf& model, int lobes) { return edit_of(model, Reduce{lobes}); })
        .def("blended", [](const PyBrdf& model, const PyBrdf& other, double mix) {
            return PyBrdf(required(blend_models(model.require_model(), other.require_model(), mix)));
        });
}

void save_brdf(const PyBrdf& brdf, const std::string& path) {
    const Model& model = brdf.require_model();
    required([&] {
        const py::gil_scoped_release released;
        return save_model(model, path);
    }());
}

void define_brdf(py::module_& module) {
    py::class_<PyBrdf> brdf_class(module, "Brdf");
    define_edits(brdf_class);
    brdf_class.def("evaluate", &values_of)
        .def("evaluate_channels", &channels_of)
        .def("sample", &sample_rows)
        .def("pdf", &pdf_rows)
        .def("albedo", &albedo_rows)
        .def("value_at",
             [](const PyBrdf& brdf, float lx, float ly, float lz, float vx, float vy, float vz) {
                 return value_at(brdf, {lx, ly, lz}, {vx, vy, vz});
             })
        .def("sample_at",
             [](const PyBrdf& brdf, float vx, float vy, float vz, float u, float v, float selector) {
                 return sample_at(brdf, {vx, vy, vz}, {u, v, selector});
             })
        .def("parameters", [](const PyBrdf& brdf) { return to_python(parameters(brdf.require_model())); })
        .def("file_bytes", &file_bytes)
        .def("reading", &reading)
        .def("is_model", [](const PyBrdf& brdf) { return brdf.model() != nullptr; })
        .def("is_slow", &PyBrdf::is_slow)
        .def("isotropic", &PyBrdf::isotropic)
        .def("change_by_azimuth", [](const PyBrdf& brdf) { return change_by_azimuth(brdf); })
        .def("wavelengths",
             [](const PyBrdf& brdf) {
                 const auto nm = brdf.model() ? wavelengths(*brdf.model()) : wavelengths(*brdf.measured());
                 return array_of(nm, {py::ssize_t(nm.size())});
             })
        .def("exchanged", &PyBrdf::exchanged, py::call_guard<py::gil_scoped_release>())
        .def("is_exchanged", &PyBrdf::is_exchanged)
        .def("kind",
             [](const PyBrdf& brdf) {
                 return brdf.model() ? std::string(kind(*brdf.model())) : brdf.measured()->format;
             })
        .def("nbytes",
             [](const PyBrdf& brdf) { return brdf.model() ? payload_bytes(*brdf.model()) : brdf.measured()->bytes; })
        .def("source", [](const PyBrdf& brdf) { return file_name_of(brdf.measured() ? brdf.measured()->source : ""); })
        .def("notes", &notes_of)
        .def("provenance", &provenance_of)
        .def("save", &save_brdf);
}

void define_fits(py::module_& module) {
    py::class_<FitRequest>(module, "Request").def(py::init([](const FitTexts& texts) {
        return required(fit_request(texts));
    }));
    module.def("fit", &fit_brdf);
    module.def("fit_function", &fit_function);
    module.def("errors", &errors);
    module.def("errors_of_function", &errors_of_function);
}

void define_functions(py::module_& module) {
    module.def("load", &load_file);
    module.def("unpickled", &unpickled);
    module.def("model_of", &model_of);
    module.def("from_arrays", &brdf_of_samples);
    module.def("render", &render);
    module.def("convert", &convert);
    module.def("code", &code);
    module.def("python_code", [](const PyBrdf& brdf) { return required(python_code(brdf.require_model())); });
    module.def("identifier", [](const std::string& text) { return identifier(text); });
}

/// Names and numbers that Python offers as choices.
void define_choices(py::module_& module) {
    module.def("fit_options", [] {
        py::dict choices;  // the choices of each option
        for (const FitOptionRow& option : fit_options()) choices[py::str(std::string(option.name))] = option.choices;
        return choices;
    });
    module.def("formats", [] {
        std::map<std::string, std::string> extensions;
        for (const Format& format : formats()) extensions[std::string(format.name)] = format.extension;
        return extensions;
    });
    module.def("lightings", [] { return names_of(standard_lightings()); });
    module.def("code_languages", [] { return names_of(k_code_languages); });
    module.def("host_materials", [] { return names_of(code_modules()); });
}

}  // namespace
}  // namespace srbf

PYBIND11_MODULE(_srbf, module) {
    using namespace srbf;
    define_brdf(module);
    define_fits(module);
    define_functions(module);
    define_choices(module);
    module.attr("max_threads") = k_max_threads;
    module.attr("version") = SRBF_VERSION;
    module.attr("knows_numpy_2") = PYBIND11_VERSION_HEX >= 0x020C0000;
}
