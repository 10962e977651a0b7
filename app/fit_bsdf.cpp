// `srbf fit` of a BSDF: its report, part by part.

#include <thread>

#include "app/commands.h"
#include "app/fit.h"
#include "app/hash.h"
#include "app/peak.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "models/bsdf/bsdf_functions.h"
#include "srbf/file.h"

namespace srbf {
namespace {

/// Radians to degrees, rounded to four decimals.
double degrees_of(double radians) { return std::round(radians / k_degree * 1e4) / 1e4; }

/// The largest absolute and relative errors of the directional-hemispherical sums.
std::string sums_text(const std::vector<Hemispherical>& sums) {
    double largest = 0, relative = 0;
    for (const Hemispherical& sum : sums) {
        const double error = std::abs(sum.fitted - sum.measured);
        largest = std::max(largest, error);
        if (sum.measured > 0) relative = std::max(relative, error / sum.measured);
    }
    return fmt::format("{:>9.4f} {:>9}", largest, percent(relative));
}

Result<Done> print(const FitJob& fit, const Measured& measured, const BsdfOutcome& outcome) {
    const auto& table = std::get<BsdfTable>(measured.table);
    fmt::print("{}  ({}, {} bytes{})\n", printable(fit.input), measured.format, grouped(measured.bytes),
               table.band().name.empty() ? "" : ", " + printable(table.band().name));
    fmt::print("  stored    {} bytes, fitted in {:.2f} s\n\n", grouped(payload_bytes(outcome.model)),
               outcome.fit_seconds);
    fmt::print("  {:<20} {:>7} {:>12}   {}\n", "", "", "squared", "directional-hemispherical");
    fmt::print("  {:<20} {:>7} {:>12}   {:>9} {:>9}\n", "part", "bytes", "error ratio", "error", "relative");
    for (const PartFit& part : outcome.parts) {
        std::string bytes = part.answered_by ? "shared" : "black";
        if (!part.answered_by && !part.black) bytes = grouped(payload_bytes(part.outcome.model));
        fmt::print("  {:<20} {:>7} {:>12}   {}\n", name(part.part), bytes, percent(part.squared_error_ratio),
                   sums_text(part.hemispherical));
    }
    fmt::print("\n");
    for (const PartFit& part : outcome.parts)
        if (const auto& data = table.band().part[std::size_t(part.part)])
            fmt::print("  {:<20} {}\n", name(part.part), peak_text(peak_of(*data), is_transmission(part.part)));
    const auto& beams = std::get<BsdfModel>(outcome.model.model).beam;
    for (std::size_t b = 0; b < beams.size(); ++b)
        if (!beams[b].empty())
            fmt::print("  {:<20} {:>7}   unscattered light, {:.3g} % at 0°, stored as it is\n",
                       fmt::format("beam, {}", k_beam_names[b]), payload_bytes(beams[b]),
                       100 * double(fraction_at(beams[b], {0, 0, 1}).g));
    fmt::print("\n  reflected and transmitted: at most {} of the light, measured {}\n", percent(outcome.max_fitted),
               percent(outcome.max_measured));
    fmt::print("  model     {}\n", printable(fit.output));
    if (!fit.preview.empty()) fmt::print("  picture   {}\n", printable(fit.preview));
    if (!fit.json.empty()) fmt::print("  report    {}\n", printable(fit.json));
    return flush_standard_output();
}

}  // namespace

Json report_of(const FitJob& fit, const Measured& measured, const BsdfOutcome& outcome) {
    Json json{{"source", fit.input},
              {"source_format", measured.format},
              {"source_bytes", measured.bytes},
              {"output", fit.output},
              {"version", SRBF_VERSION},
              {"model", "bsdf"},
              {"band", std::get<BsdfTable>(measured.table).band().name},
              {k_model_hash, hash_of(write_model(outcome.model))},
              {"payload_bytes", payload_bytes(outcome.model)},
              {"auxiliary_bytes", auxiliary_bytes(outcome.model)},
              {"fit_seconds", outcome.fit_seconds},
              {"load_seconds", fit.load_seconds},
              {"seed", fit.request.seed},
              {"threads", fit.request.threads > 0 ? fit.request.threads : int(std::thread::hardware_concurrency())},
              {"most_light_measured", outcome.max_measured},
              {"most_light", outcome.max_fitted}};
    for (const PartFit& part : outcome.parts) {
        Json member{{"part", name(part.part)},
                    {"answered_by", part.answered_by ? Json(name(*part.answered_by)) : Json()},
                    {"black", part.black},
                    {"squared_error_ratio", part.squared_error_ratio}};
        if (const auto& data = std::get<BsdfTable>(measured.table).band().part[std::size_t(part.part)]) {
            const Peak peak = peak_of(*data);
            member["peak"] = name(peak.position);
            member["peak_ratio"] = peak.ratio;
        }
        for (const Hemispherical& sum : part.hemispherical)
            member["hemispherical"].push_back({{"theta", degrees_of(sum.theta)},
                                               {"phi", degrees_of(sum.phi)},
                                               {"measured", sum.measured},
                                               {"fitted", sum.fitted}});
        json["parts"].push_back(std::move(member));
    }
    return json;
}

int fit_bsdf_file(const FitJob& fit, const Measured& measured) {
    ProgressLine line;
    const auto outcome = fit_bsdf(measured, fit.request, line.shown_progress());
    line.clear();
    if (!outcome) return complain(outcome.error());
    Image8 picture;
    if (!fit.preview.empty()) picture = preview_of(fit, measured, outcome->model);
    return status_of(write_fit(fit, outcome->model, picture, report_of(fit, measured, *outcome),
                               [&] { return print(fit, measured, *outcome); }));
}

}  // namespace srbf
