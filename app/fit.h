// Input, output and messages of `srbf fit`. The fit itself is in srbf/fitting.h.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "app/image.h"
#include "app/output.h"
#include "srbf/fit.h"
#include "srbf/fit_bsdf.h"

namespace srbf {

/// A fit of a file.
struct FileFit {
    std::string input, output;
    std::string preview, json;  // empty: none
    FitRequest request;
    bool exchange = false;                // light and viewer of the measurement
    ReadOptions read = {};                // what its file does not state
    std::string band = {};                // of a two-sided measurement; empty: the default
    std::vector<std::string> given = {};  // the options of the command line
    double load_seconds = 0;
};

/// Fits the measurement in a file, writes the outputs and prints the report; returns the exit status.
int fit_file(FileFit fit);
/// Fits a two-sided measurement, writes the outputs and prints the report; returns the exit status.
int fit_both_sides(const FileFit& fit, const Measured& measured);
Json report_of(const FileFit& fit, const Measured& measured, const BsdfOutcome& outcome);
/// Loads the measurement of a fit, with light and viewer exchanged if that is asked.
Result<Measured> load_measured(FileFit& fit);

/// The measured and the fitted sphere beside each other.
Image8 preview_of(const FileFit& fit, const Measured& measured, const Model& model);
/// Writes the model, the picture and the report, all of them or none; prints what `print` does, or the report itself if
/// it goes to standard output, before they are renamed.
Result<Done> write_fit(const FileFit& fit, const Model& model, const Image8& picture, const Json& report,
                       const std::function<Result<Done>()>& print);
Json report_of(const FileFit& fit, const Measured& measured, const FitOutcome& outcome);
Result<Done> print_report(const FileFit& fit, const Measured& measured, const FitOutcome& outcome);

/// Fits of many files, with the same options.
struct FolderFit {
    std::vector<std::string> inputs;
    std::string folder;    // STEM.srbf and STEM.json of each input STEM.*
    FileFit each;          // request and exchange
    std::string settings;  // the options that models depend on
    bool resume = false;   // keep what is done
};
/// Prints a line for each file in their order, and a summary; returns the exit status. Failures do not stop the others.
int fit_files(const FolderFit& fit);

}  // namespace srbf
