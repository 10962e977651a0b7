// Input, output and messages of `srbf fit`. The fit itself is in srbf/fitting.h.
#pragma once
#include <string>

#include "app/report.h"
#include "srbf/fit_bsdf.h"
#include "srbf/fitting.h"

namespace srbf {

/// A fit of a file.
struct FileFit {
    std::string input, output;
    std::string preview, json;  // empty: none
    FitRequest request;
    bool exchange = false;  // light and viewer of the measurement
    std::string band = {};  // of a measurement of both sides; empty: the default
    double load_seconds = 0;
};

/// "pm", "su" or "ggx".
std::string_view kind_of(const FitRequest& request);

/// Fits a measurement of both sides, writes the outputs and prints the report; returns the exit status.
int fit_both_sides(const FileFit& fit, const Measured& measured);

Json report_of(const FileFit& fit, const Measured& measured, const FitOutcome& outcome);
Result<Done> print_report(const FileFit& fit, const Measured& measured, const FitOutcome& outcome);

}  // namespace srbf
