#include "app/load.h"

#include <cstdio>

#include "app/commands.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "models/model_files.h"
#include "srbf/file.h"
#include "srbf/metrics.h"
#include "srbf/sampling.h"

namespace srbf {

Rgb value(const LoadedFile& subject, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& brdf) { return value(brdf, wl, wv); }, subject.content);
}

Evaluate evaluator(const LoadedFile& subject) {
    return std::visit([](const auto& brdf) { return evaluator(brdf); }, subject.content);
}

bool is_isotropic(const LoadedFile& subject) {
    return std::visit([](const auto& brdf) { return is_isotropic(brdf); }, subject.content);
}

std::span<const float> wavelengths(const LoadedFile& subject) {
    return std::visit([](const auto& brdf) { return wavelengths(brdf); }, subject.content);
}

Channels channels(const LoadedFile& subject) {
    if (wavelengths(subject).empty()) return rgb_channels(evaluator(subject));
    const auto* measured = std::get_if<Measured>(&subject.content);
    return measured ? spectra(*measured) : channels(std::get<Model>(subject.content));
}

double fitted_theta(const LoadedFile& subject) {
    if (!subject.is_model()) return 0;
    const auto& provenance = std::get<Model>(subject.content).provenance;
    const auto entry = provenance.find("max_theta");
    if (entry == provenance.end()) return 0;
    const double theta = std::atof(entry->second.c_str());
    return theta >= 1 && theta <= 90 ? theta : 0;
}

std::string stem_of(const std::string& path) {
    const std::string name = path.substr(path.find_last_of('/') + 1);  // npos + 1 is 0
    if (const auto position = name.find(".srbf#"); position != name.npos)
        return name.substr(0, position) + "_" + name.substr(name.find('#', position) + 1);
    const auto dot = name.rfind('.');
    return dot == name.npos || dot == 0 ? name : name.substr(0, dot);
}

Result<FileOrMap> load_file_or_map(const std::string& path, const ReadOptions& options) {
    auto loaded = load_brdf_or_map(path, options);
    if (!loaded) return loaded.error();
    if (auto* map = std::get_if<TexelMap>(&*loaded)) return FileOrMap(std::move(*map));
    if (auto* model = std::get_if<Model>(&*loaded)) return FileOrMap(LoadedFile{path, std::move(*model)});
    auto& measured = std::get<Measured>(*loaded);
    for (const std::string& note : notes(measured))
        fmt::print(stderr, "srbf: {}: {}\n", printable(path), printable(note));
    return FileOrMap(LoadedFile{path, std::move(measured)});
}

Result<LoadedFile> load_file(const std::string& path, const ReadOptions& options) {
    auto loaded = load_file_or_map(path, options);
    if (!loaded) return loaded.error();
    if (auto* subject = std::get_if<LoadedFile>(&*loaded)) return std::move(*subject);
    return map_error(path);
}

int complain(const Error& error) {
    std::fputs(fmt::format("srbf: {}\n", message(error)).c_str(), stderr);
    return k_input_error;
}

int status_of(const Result<Done>& done) { return done ? int(k_done) : complain(done.error()); }

}  // namespace srbf
