// The functions of srbf.h, implemented by functions of the other headers.
#include <atomic>

#include "base/errors.h"
#include "errors/picture_errors.h"
#include "srbf/file.h"
#include "srbf/fit.h"
#include "srbf/load.h"
#include "srbf/map.h"
#include "srbf/prepared.h"

namespace SRBF_NAMESPACE {

struct LoadedBrdf::Contents {
    AnyBrdf brdf;
    mutable std::atomic<int> uses = 1;

    explicit Contents(AnyBrdf content) : brdf(std::move(content)) {}
};
void add_use(const LoadedBrdf::Contents& contents) { contents.uses.fetch_add(1, std::memory_order_relaxed); }
void end_use(const LoadedBrdf::Contents& contents) {
    if (contents.uses.fetch_sub(1, std::memory_order_acq_rel) == 1) delete &contents;
}

const AnyBrdf& content(const LoadedBrdf& brdf) {
    if (!brdf.contents) misused("a LoadedBrdf without content: expected what load or fit returned");
    return brdf.contents->brdf;
}
LoadedBrdf loaded_brdf(AnyBrdf content) { return {Shared(new LoadedBrdf::Contents(std::move(content)))}; }

Result<LoadedBrdf> load(const std::string& path) {
    auto brdf = load_brdf(path);
    if (!brdf) return brdf.error();
    return loaded_brdf(*std::move(brdf));
}

LoadedBrdf exchanged(const LoadedBrdf& brdf) {
    AnyBrdf copy = content(brdf);
    std::visit([](auto& any) { exchange(any); }, copy);
    return loaded_brdf(std::move(copy));
}

Result<FittedBrdf> fit(const LoadedBrdf& measured) {
    const auto* measurement = std::get_if<Measured>(&content(measured));
    if (!measurement) return Error{"fit", {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind};
    auto outcome = fit(*measurement, FitRequest{});
    if (!outcome) return outcome.error();
    const std::size_t bytes = payload_bytes(outcome->model);
    return FittedBrdf{loaded_brdf(std::move(outcome->model)), bytes, headline_errors(*outcome->errors).mean.delta_e};
}

Result<Done> save(const LoadedBrdf& model, const std::string& path) {
    const auto* fitted = std::get_if<Model>(&content(model));
    if (!fitted) return Error{path, {}, "output", "a fitted model", "a measurement", ErrorCode::wrong_kind};
    return save_model(*fitted, path);
}

PreparedBrdf prepare(const LoadedBrdf& brdf, int threads) {
    const auto prepared = [threads](const auto& any) {
        return prepare(any, {.azimuths = azimuths_for(is_isotropic(any)), .threads = threads});
    };
    return std::visit(prepared, content(brdf));
}

}  // namespace
