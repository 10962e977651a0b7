// The numbers of a model as Python's arrays, and models of such arrays. srbf/_parameters.py checks their shapes.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "brdf.h"
#include "srbf/directions.h"
#include "srbf/half.h"

namespace srbf {

/// The arrays of beams, by `add(name, numbers, shape)`.
template <typename Add> void add_beams(const Beams& beams, const Add& add) {
    for (std::size_t b = 0; b < beams.size(); ++b) {
        const Beam& beam = beams[b];
        if (beam.empty()) continue;
        const std::string name = "beam_" + std::string(k_beam_names[b]);
        const auto rings = py::ssize_t(beam.theta.size()), nodes = py::ssize_t(beam.share.size());
        add((name + "_angle").c_str(), beam.theta, {rings});
        add((name + "_share").c_str(), floats(beam.share), {nodes, 3});
        if (beam.azimuths.empty()) continue;
        const std::vector<float> azimuths(beam.azimuths.begin(), beam.azimuths.end());
        add((name + "_azimuths").c_str(), azimuths, {rings});
    }
}

inline py::dict parameters(const Held& brdf) {
    using Shape = std::vector<py::ssize_t>;
    py::dict of;
    const auto add = [&](const char* name, std::span<const float> numbers, Shape shape) {
        of[name] = array_of(numbers, std::move(shape));
    };
    const auto& model = brdf.require_model().model;
    if (const auto* bsdf = std::get_if<BsdfModel>(&model)) {
        for (std::size_t p = 0; p < k_parts; ++p)
            if (bsdf->part[p]) of[py::str(std::string(k_part_names[p]))] = parameters(Held(*bsdf->part[p]));
        add_beams(bsdf->beam, add);
    } else if (const auto* pm = std::get_if<PmModel>(&model)) {
        const py::ssize_t J = pm->lobes, N = pm->variates, F = features(pm->form);
        of["form"] = std::string(name(pm->form));
        of["axial"] = pm->axial;
        add("coefficient", floats(pm->coefficient), {J, 3});
        add("log_scale", pm->log_scale, {J});
        add("centre", floats(pm->centre), {J, N, 3});
        add("bandwidth", pm->bandwidth, {J, N});
        add("parameterization", floats(pm->parameterization), {N, 2});
        add("exponent", pm->exponent, {J, F});
        if (!pm->wavelength.empty()) {
            add("wavelength", pm->wavelength, {py::ssize_t(pm->wavelength.size())});
            add("spectrum", pm->spectrum, {J, py::ssize_t(pm->wavelength.size())});
        }
    } else if (const auto* su = std::get_if<SuModel>(&model)) {
        const py::ssize_t J = su->lobes, n = py::ssize_t(su->direction.size());
        of["interpolation"] = std::string(name(su->interpolation));
        of["neighbours"] = su->neighbours;
        of["discretise"] = std::string(name(su->discretise));
        if (su->index) of["index"] = std::string(name(su->index->map)), of["index_size"] = su->index->size;
        add("direction", floats(su->direction), {n, 3});
        add("coefficient", floats(su->coefficient), {n, J, 3});
        add("centre", floats(su->centre), {n, J, 3});
        add("bandwidth", su->bandwidth, {n, J});
        if (!su->shape.empty()) add("shape", su->shape, {n, J});
    } else if (const auto* ggx = std::get_if<GgxModel>(&model)) {
        std::vector<float> roughness, f0, f90;
        for (const GgxModel::Lobe& lobe : ggx->lobes) {
            roughness.push_back(lobe.roughness), f90.push_back(lobe.f90);
            f0.insert(f0.end(), {lobe.f0.r, lobe.f0.g, lobe.f0.b});
        }
        const auto L = py::ssize_t(ggx->lobes.size());
        add("diffuse", floats(std::vector{ggx->diffuse}), {3});
        add("roughness", roughness, {L});
        add("f0", f0, {L, 3});
        add("f90", f90, {L});
    } else if (const auto* openpbr = std::get_if<OpenPbrModel>(&model)) {
        for (const OpenPbrParameter& parameter : k_openpbr_parameters) {
            std::vector<float> numbers;
            for (int c = 0; c < parameter.count(); ++c) numbers.push_back(number(*openpbr, parameter, c));
            add(std::string(parameter.name).c_str(), numbers, {py::ssize_t(numbers.size())});
        }
        of["is_exchanged"] = openpbr->is_exchanged;
    }
    return of;
}

template <typename T> std::vector<T> vector_of(const py::dict& parameters, const char* name) {
    const auto array = parameters[name].cast<Array>();
    const auto* numbers = reinterpret_cast<const T*>(array.data());
    return {numbers, numbers + std::size_t(array.size()) * sizeof(float) / sizeof(T)};
}

inline PmModel pm_of(const py::dict& of) {
    PmModel pm;
    pm.form = form_named(of["form"].cast<std::string>()).value();
    pm.axial = of["axial"].cast<bool>();
    const auto bandwidth = of["bandwidth"].cast<Array>();
    pm.lobes = int(bandwidth.shape(0)), pm.variates = int(bandwidth.shape(1));
    pm.log_scale = vector_of<float>(of, "log_scale");
    pm.centre = vector_of<Vec3f>(of, "centre");
    pm.bandwidth = vector_of<float>(of, "bandwidth");
    pm.parameterization = vector_of<Parameterization>(of, "parameterization");
    pm.exponent = vector_of<float>(of, "exponent");
    const bool is_spectral = of.contains("spectrum");
    auto coefficient = vector_of<float>(of, is_spectral ? "spectrum" : "coefficient");
    const std::size_t channels = coefficient.size() / pm.log_scale.size();
    for (std::size_t i = 0; i < coefficient.size(); ++i) {  // makes up for what rounding takes from a log scale
        const float s = std::clamp(pm.log_scale[i / channels], -k_half_max, k_half_max);
        coefficient[i] *= std::exp(s - from_half(to_half(s)));
    }
    if (is_spectral) {
        pm.wavelength = vector_of<float>(of, "wavelength"), pm.spectrum = std::move(coefficient);
        pm.coefficient = colours(pm.spectrum, pm.wavelength);
    } else {
        for (std::size_t i = 0; i < coefficient.size(); i += 3)
            pm.coefficient.push_back({coefficient[i], coefficient[i + 1], coefficient[i + 2]});
    }
    return pm;
}

inline SuModel su_of(const py::dict& of) {
    SuModel su;
    su.interpolation = interpolation_named(of["interpolation"].cast<std::string>()).value();
    su.discretise = discretise_named(of["discretise"].cast<std::string>()).value();
    su.neighbours = of["neighbours"].cast<int>();
    const auto bandwidth = of["bandwidth"].cast<Array>();
    su.lobes = int(bandwidth.shape(1));
    su.direction = fibonacci_directions(int(bandwidth.shape(0)), k_pi / 2);
    su.coefficient = vector_of<Rgb>(of, "coefficient");
    su.centre = vector_of<Vec3f>(of, "centre");
    su.bandwidth = vector_of<float>(of, "bandwidth");
    if (of.contains("shape")) su.shape = vector_of<float>(of, "shape");
    if (of.contains("index"))
        su.index = index_texture(su, map_named(of["index"].cast<std::string>()).value(), of["index_size"].cast<int>());
    return su;
}

inline GgxModel ggx_of(const py::dict& of) {
    GgxModel ggx;
    ggx.diffuse = vector_of<Rgb>(of, "diffuse")[0];
    const auto roughness = vector_of<float>(of, "roughness"), f90 = vector_of<float>(of, "f90");
    const auto f0 = vector_of<Rgb>(of, "f0");
    for (std::size_t i = 0; i < roughness.size(); ++i) ggx.lobes.push_back({roughness[i], f0[i], f90[i]});
    return ggx;
}

inline OpenPbrModel openpbr_of(const py::dict& of) {
    OpenPbrModel openpbr;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters) {
        const auto numbers = vector_of<float>(of, std::string(parameter.name).c_str());
        for (int c = 0; c < parameter.count(); ++c) number(openpbr, parameter, c) = numbers.at(std::size_t(c));
    }
    openpbr.is_exchanged = of["is_exchanged"].cast<bool>();
    return openpbr;
}

/// Of parts as models, by their names, and of beams.
inline BsdfModel bsdf_of(const py::dict& of) {
    BsdfModel bsdf;
    for (std::size_t p = 0; p < k_parts; ++p)
        if (const py::str part{std::string(k_part_names[p])}; of.contains(part))
            bsdf.part[p] = std::make_shared<const Model>(of[part].cast<Held>().require_model());
    for (std::size_t b = 0; b < bsdf.beam.size(); ++b) {
        const std::string name = "beam_" + std::string(k_beam_names[b]);
        const std::string angle = name + "_angle", share = name + "_share", azimuths = name + "_azimuths";
        if (!of.contains(py::str(angle))) continue;
        bsdf.beam[b] = {vector_of<float>(of, angle.c_str()), vector_of<Rgb>(of, share.c_str())};
        if (!of.contains(py::str(azimuths))) continue;
        for (const float n :
             vector_of<float>(of, azimuths.c_str()))  // what is not a number of nodes becomes 0, which is refused
            bsdf.beam[b].azimuths.push_back(n >= 1 && n <= float(k_most_beam_nodes) ? int(n) : 0);
    }
    return bsdf;
}

/// The model of that kind with these numbers as its file has them: rounded to 16-bit floats and within their ranges.
/// Centres that are so already stay as they are, since angles are rounded twice where they go through vectors.
inline Held model_of(const std::string& kind, const py::dict& of, std::map<std::string, std::string> provenance) {
    Model model{kind == "pm"        ? decltype(Model::model)(pm_of(of))
                : kind == "su"      ? decltype(Model::model)(su_of(of))
                : kind == "ggx"     ? decltype(Model::model)(ggx_of(of))
                : kind == "openpbr" ? decltype(Model::model)(openpbr_of(of))
                                    : decltype(Model::model)(bsdf_of(of)),
                std::move(provenance)};
    Model rounded = required(read_model(write_model(model), "parameters"));
    const auto keep = [](const auto& given, auto& centres) {
        for (std::size_t i = 0; i < centres.size(); ++i)
            if (const Vec3f apart = given[i] - centres[i]; dot(apart, apart) < 1e-13f) centres[i] = given[i];
    };
    if (auto* pm = std::get_if<PmModel>(&rounded.model)) keep(std::get<PmModel>(model.model).centre, pm->centre);
    if (auto* su = std::get_if<SuModel>(&rounded.model)) keep(std::get<SuModel>(model.model).centre, su->centre);
    if (std::holds_alternative<BsdfModel>(model.model)) return Held(std::move(model));  // whose parts are such models
    return Held(std::move(rounded));
}

}  // namespace srbf
