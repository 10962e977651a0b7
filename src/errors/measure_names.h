// The names of error measures in output.
#pragma once
#include <array>
#include <string>

#include "srbf/metrics.h"

SRBF_BEGIN

/// Names of a measure in output.
struct MeasureName {
    const char* name;   ///< in JSON and provenance
    const char* title;  ///< in tables
    double Measures::*member;
    bool is_ratio;  ///< printed in per cent; otherwise the root of a mean, divided by `unit`
    double unit = 1;
};
inline constexpr double k_log_10 = 2.302585092994045684;  // ln 10
inline constexpr std::array<MeasureName, 6> k_measures{{
    {"squared_error_ratio", "squared error ratio", &Measures::squared_error_ratio, true},
    {"squared_error_ratio_cosine", "  of f cosθl", &Measures::squared_error_ratio_cosine, true},
    {"log_rms_cosine", "RMS of log(1 + f cosθl)", &Measures::log_rms_cosine, false},
    {"cube_root_error_ratio", "cube root error ratio", &Measures::cube_root_error_ratio, true},
    {"sixth_root_error_ratio", "sixth root error ratio", &Measures::sixth_root_error_ratio, true},
    {"log10_rms", "RMS of log10 f", &Measures::log10_rms, false, k_log_10},
}};

/// Calls add(name, value) for the measures of a comparison: over the matrix, held out, and of albedo.
template <typename Add> void for_measures(const Comparison& of, const Add& add) {
    for (const MeasureName& m : k_measures) add(std::string(m.name), of.matrix.*m.member);
    for (const MeasureName& m : k_measures) add("heldout_" + std::string(m.name), of.heldout.*m.member);
    add(std::string("albedo_error"), of.albedo_error);
}

SRBF_END
