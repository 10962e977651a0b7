#include "app/load.h"

#include <cstdio>

#include "app/commands.h"
#include "base/files.h"
#include "base/paths.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "models/library_file.h"
#include "srbf/file.h"
#include "srbf/metrics.h"
#include "srbf/sampling.h"

namespace srbf {

Rgb value(const Subject& subject, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& brdf) { return value(brdf, wl, wv); }, subject.content);
}

Evaluate evaluator(const Subject& subject) {
    return std::visit([](const auto& brdf) { return evaluator(brdf); }, subject.content);
}

int azimuths_of(const Subject& subject) {
    return std::visit([](const auto& brdf) { return is_isotropic(brdf); }, subject.content) ? 1
                                                                                            : k_anisotropic_azimuths;
}

std::span<const float> wavelengths(const Subject& subject) {
    return std::visit([](const auto& brdf) { return wavelengths(brdf); }, subject.content);
}

Channels channels(const Subject& subject) {
    if (wavelengths(subject).empty()) return rgb_channels(evaluator(subject));
    const auto* measured = std::get_if<Measured>(&subject.content);
    return measured ? spectra(*measured) : channels(std::get<Model>(subject.content));
}

double fitted_theta(const Subject& subject) {
    if (!subject.is_model()) return 0;
    const auto& provenance = std::get<Model>(subject.content).provenance;
    const auto entry = provenance.find("max_theta");
    if (entry == provenance.end()) return 0;
    const double theta = std::atof(entry->second.c_str());
    return theta >= 1 && theta <= 90 ? theta : 0;
}

std::string stem_of(const std::string& path) {
    const std::string name = path.substr(path.find_last_of('/') + 1);  // npos + 1 is 0
    constexpr std::string_view separator = ".srbf#";
    if (const auto position = name.find(separator); position != name.npos) {
        const std::string member = name.substr(position + separator.size());
        return member.find_first_not_of("0123456789,") == member.npos ? name.substr(0, position) + "_" + member
                                                                      : member;
    }
    const auto dot = name.rfind('.');
    return dot == name.npos || dot == 0 ? name : name.substr(0, dot);
}

Result<Subject> load_subject(const std::string& path, const ReadOptions& options) {
    auto loaded = load_brdf(path, options);
    if (!loaded) return loaded.error();
    if (const auto* measured = std::get_if<Measured>(&*loaded))
        for (const std::string& note : notes(*measured))
            fmt::print(stderr, "srbf: {}: {}\n", printable(path), printable(note));
    return Subject{path, *std::move(loaded)};
}

Result<std::optional<Library>> library_in(const std::string& path) {
    using Found = Result<std::optional<Library>>;
    std::error_code code;
    if (!std::filesystem::is_regular_file(system_files::path_of(path), code))
        return std::optional<Library>();  // a pipe can be read only once
    return within_memory(path, [&]() -> Found {
        const auto bytes = read_file(path, all_if(is_safetensors));
        if (!bytes || !is_library(*bytes)) return std::optional<Library>();
        auto library = read_library(*bytes, path);
        if (!library) return library.error();
        return std::optional(*std::move(library));
    });
}

int complain(const Error& error) {
    std::fputs(fmt::format("srbf: {}\n", message(error)).c_str(), stderr);
    return k_input_error;
}

int status_of(const Result<Done>& done) { return done ? int(k_done) : complain(done.error()); }

}  // namespace srbf
