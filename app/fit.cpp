#include "app/fit.h"
#include "app/commands.h"
#include "base/files.h"
#include "base/printable.h"
#include "brdf/values.h"
#include "fit/patch_fit.h"
#include "fit/request_traits.h"
#include "measured/readers.h"
#include "srbf/file.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

/// Options that fits of some measurements do not read. `are_read` is true if fits of this measurement do. The rows of
/// `AllowedWhen` in fit_command.cpp depend on the command line alone.
struct ReadFor {
    std::vector<std::string_view> options;
    bool are_read;
    std::string expected, found;
};

/// Returns an error if an option was given that the fit of this measurement does not read.
Result<Done> check_read(const Measured& measured, const FitJob& fit) {
    const auto* bsdf = std::get_if<BsdfTable>(&measured.table);
    const PatchFitter* patches = nullptr;
    if (bsdf)
        for (const auto& part : bsdf->band().part)
            if (part && patch_fit_of(*part)) patches = patch_fit_of(*part);
    const std::string fitted(patches ? patches->fitted : "");
    const auto* pm = std::get_if<PmRequest>(&fit.request.model);
    const bool is_view_by_view = std::holds_alternative<SuRequest>(fit.request.model);
    const ReadFor rows[] = {
        {{"--variates"},
         !(patches && pm && !pm->size),
         "--lobes as well",
         fmt::format("none: a fit of {} then chooses its size", fitted)},
        {{"--target-delta-e"}, !patches, "a table", fitted},
        {{"--objective", "--max-theta"}, !patches || is_view_by_view, "a table or samples", fitted},
        {{"--channels"}, !(patches && fit.request.spectral), "rgb", "spectral, of " + fitted},
    };
    for (const ReadFor& row : rows)
        for (const std::string_view option : row.options)
            if (!row.are_read && std::ranges::count(fit.given, option) > 0)
                return Error{fit.input, {}, std::string(option), row.expected, row.found};
    return Done{};
}

}  // namespace

int fit_file(FitJob fit) {
    const auto measured = load_for_fit(fit);
    if (!measured) return complain(measured.error());
    const auto writable = check_outputs(fit.files, {fit.output, fit.preview, fit.json == "-" ? "" : fit.json});
    if (!writable) return complain(writable.error());

    if (std::holds_alternative<BsdfTable>(measured->table)) return fit_bsdf_file(fit, *measured);

    ProgressLine line;
    const auto show = line.shown_progress();
    auto outcome = srbf::fit(*measured, fit.request, show);
    if (!outcome) {
        line.clear();
        return complain(outcome.error());
    }
    Image8 picture;
    if (!fit.preview.empty()) {
        line.show("drawing", 1);
        picture = preview_of(fit, *measured, outcome->model);
    }
    line.clear();
    constexpr float k_far_above = 2;  // the interpolation of samples may exceed 1
    double brightest = 0;
    for (const double theta : {0, 15, 30, 45, 60, 75})
        brightest = std::max(brightest, largest_of(albedo(evaluator(outcome->model), theta * k_degree, k_pi / 2)));
    if (brightest > k_far_above)
        fmt::print(stderr, "srbf: {}: warning: it reflects {:.3g} times the light that it receives; see --quantity\n",
                   printable(fit.input), brightest);
    return status_of(write_fit(fit, outcome->model, picture, report_of(fit, *measured, *outcome),
                               [&] { return print_report(fit, *measured, *outcome); }));
}

Result<Measured> load_for_fit(FitJob& fit) {
    const Stopwatch loading;
    std::vector<Measured> files;
    for (const std::string& name : fit.files) {
        auto subject = load_file(name, fit.read);
        if (!subject) {
            Error error = subject.error();
            if (!files.empty()) error.source += " with " + files[0].source;
            return error;
        }
        auto* file = std::get_if<Measured>(&subject->content);
        if (!file) return Error{name, {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind};
        files.push_back(std::move(*file));
    }
    auto measured = files.size() > 1 ? join_measurements(files) : std::move(files[0]);
    if (!measured) return measured;
    if (fit.exchange) exchange(*measured);
    if (!fit.band.empty())
        if (const auto chosen = choose_band(*measured, fit.band); !chosen) return chosen.error();
    if (const auto read = check_read(*measured, fit); !read) return read.error();
    if (files.size() > 1) fmt::print(stderr, "srbf: {}\n", printable(notes(*measured)[0]));
    fit.load_seconds = loading.seconds();
    return measured;
}

Image8 preview_of(const FitJob& fit, const Measured& measured, const Model& model) {
    return preview(evaluator(measured), evaluator(model),
                   {.threads = fit.request.threads, .caption = fmt::format("fit, {} bytes", payload_bytes(model))});
}

Result<Done> write_fit(const FitJob& fit, const Model& model, const Image8& picture, const Json& report,
                       const std::function<Result<Done>()>& print) {
    std::vector<NewFile> files{{fit.output, write_model(model)}};
    if (!fit.preview.empty()) {
        auto bytes = png(picture, fit.preview);
        if (!bytes) return bytes.error();
        files.push_back({fit.preview, *std::move(bytes)});
    }
    if (!fit.json.empty() && fit.json != "-") files.push_back({fit.json, json_bytes(report)});
    return write_files(files, [&] { return fit.json == "-" ? write_json(report, "-") : print(); });
}

}  // namespace srbf
