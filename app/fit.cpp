#include "app/fit.h"
#include "app/commands.h"
#include "app/fit_options.h"
#include "base/files.h"
#include "base/printable.h"
#include "brdf/values.h"
#include "measured/readers.h"
#include "srbf/file.h"
#include "srbf/metrics.h"

namespace srbf {
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
    if (const auto read = check_read(*measured, fit.request, fit.texts, dashed); !read)
        return with_source(read.error(), fit.input);
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
