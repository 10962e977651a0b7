// Loading any BRDF from a file.
#pragma once
#include "srbf/load.h"
#include "srbf/map.h"

namespace srbf {

/// A measurement or a model from a file, distinguished by the content.
struct LoadedFile {
    std::string path;
    AnyBrdf content;
    bool is_model() const { return std::holds_alternative<Model>(content); }
};
Rgb value(const LoadedFile& subject, Vec3f wl, Vec3f wv);
/// Evaluates the subject at arrays of pairs. The result keeps a reference to `subject`.
Evaluate evaluator(const LoadedFile& subject);

/// True if values of the subject do not change when light and viewer turn together.
bool is_isotropic(const LoadedFile& subject);

/// The wavelengths [nm] of a spectral measurement or model; otherwise empty.
std::span<const float> wavelengths(const LoadedFile& subject);
/// A spectral subject's values at its wavelengths, otherwise R, G, B. The result keeps a reference to `subject`.
Channels channels(const LoadedFile& subject);

/// θmax of a model's fit [degrees], if `subject` is a model whose provenance states it; otherwise 0.
double fitted_theta(const LoadedFile& subject);

/// A name for the content of a path: "film" for "materials/film.srbf", "map_3,5" for "map.srbf#3,5".
std::string stem_of(const std::string& path);

/// Loads a file, and prints to standard error what its reader masked or assumed.
Result<LoadedFile> load_file(const std::string& path, const ReadOptions& options = {});
/// Loads a map of texels too.
using FileOrMap = std::variant<LoadedFile, TexelMap>;
Result<FileOrMap> load_file_or_map(const std::string& path, const ReadOptions& options = {});

/// Prints the error as one line to standard error; returns the exit status of an input error.
int complain(const Error& error);
/// The exit status of the last step of a command, whose error it prints.
int status_of(const Result<Done>& done);

}  // namespace srbf
