// Input, output and messages of `srbf fit`. The fit itself is in srbf/fit.h.
#pragma once
#include <functional>

#include "app/image.h"
#include "app/output.h"
#include "fit/fit_options.h"
#include "srbf/fit.h"

namespace srbf {

/// The fit of a file.
struct FitJob {
    std::string input, output;
    std::string preview, json;  // empty: none
    FitRequest request;
    FitTexts texts = {};                  // the options that `request` was made of
    bool exchange = false;                // exchange light and viewer of the measurement
    ReadOptions read = {};                // what the file does not state
    std::string band = {};                // the band of a two-sided measurement; empty: the default
    std::vector<std::string> files = {};  // the files that `input` names; several are of one sample
    double load_seconds = 0;
};

/// Fits the measurement in a file, writes the outputs and prints the report; returns the exit status.
int fit_file(FitJob fit);
/// Fits a BSDF, writes the outputs and prints the report; returns the exit status.
int fit_bsdf_file(const FitJob& fit, const Measured& measured);
Json report_of(const FitJob& fit, const Measured& measured, const BsdfOutcome& outcome);
/// Loads the measurement of a fit, or joins those of several files. Exchanges light and viewer and chooses the band if
/// that is requested, checks that its kind reads the given options, and notes the time in `load_seconds`.
Result<Measured> load_for_fit(FitJob& fit);

/// The measured and the fitted sphere side by side.
Image8 preview_of(const FitJob& fit, const Measured& measured, const Model& model);
/// Writes the model, the picture and the report, either all or none. Before the files are renamed into place, it
/// calls `print`, or prints the report itself if that goes to standard output.
Result<Done> write_fit(const FitJob& fit, const Model& model, const Image8& picture, const Json& report,
                       const std::function<Result<Done>()>& print);
Json report_of(const FitJob& fit, const Measured& measured, const FitOutcome& outcome);
Result<Done> print_report(const FitJob& fit, const Measured& measured, const FitOutcome& outcome);

/// Fits of many files with the same options.
struct FolderJob {
    std::vector<std::string> inputs;
    std::string folder;    // STEM.srbf and STEM.json of each input STEM.*
    FitJob common;         // what all fits share: request, reading, band
    std::string settings;  // the options that the models depend on
    bool resume = false;   // keep earlier results
};
/// Prints a row for each file, in order, and a summary; returns the exit status. A failure does not stop the others.
int fit_files(const FolderJob& fit);

}  // namespace srbf
