// Input, output and messages of `srbf fit`. The fit itself is in srbf/fitting.h.
#pragma once
#include <string>

#include "app/report.h"
#include "srbf/fitting.h"

namespace srbf {

/// A fit of a file.
struct FileFit {
    std::string input, output;
    std::string preview, json;  // empty: none
    FitRequest request;
    bool exchange = false;  // light and viewer of the measurement
    double load_seconds = 0;
};

/// "pm", "su" or "ggx".
std::string_view kind_of(const FitRequest& request);

Json report_of(const FileFit& fit, const Measured& measured, const FitOutcome& outcome);
Result<Done> print_report(const FileFit& fit, const Measured& measured, const FitOutcome& outcome);

}  // namespace srbf
