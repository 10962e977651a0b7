// Options that several commands have which fit: of lobes, of the objective, of how they run.
#pragma once
#include <string>
#include <vector>

#include "app/options.h"
#include "srbf/fit.h"

namespace srbf {

/// The lobes of multivariate models.
struct LobeSettings {
    std::string form = std::string(name(PmRequest{}.form));
    int variates = PmRequest{}.variates;
    int axial = 0;  ///< 1: axial lobes, -1: general lobes, 0: depends on the measurement
    bool reciprocal = false, no_scale = false;

    /// Of as many lobes as by default.
    PmRequest request() const;
};
struct LobeOptions {
    Option form, variates, axial, reciprocal, no_scale;
};

/// --form, --variates and --axial.
LobeOptions add_lobe_options(const Subcommand& sub, LobeSettings& to);
/// --reciprocal and --no-scale, of models that have their lobes alone.
void add_single_lobe_options(const Subcommand& sub, LobeSettings& to, LobeOptions& of);
/// What these two go together with.
std::vector<Reading> lobe_readings(const LobeOptions& of, const LobeSettings& to);

Option add_number_of_variates(const Subcommand& sub, int& to);
Option add_objective(const Subcommand& sub, std::string& to);
void add_max_theta(const Subcommand& sub, double& to);  ///< [degrees], 0: the objective's default
void add_seed(const Subcommand& sub, std::uint64_t& to);
Option add_threads(const Subcommand& sub, int& to);

/// Whether an output is a folder, or is to be one.
bool is_folder(const std::string& output);

}  // namespace srbf
