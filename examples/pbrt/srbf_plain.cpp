// C++20, and no header of pbrt.
#include "srbf_plain.h"

#include <map>
#include <mutex>
#include <utility>

#include "srbf/srbf.h"

struct srbf_plain::Brdf {
    srbf::PreparedBrdf prepared;
};

namespace {

srbf::Vec3f vec(const float w[3]) { return {w[0], w[1], w[2]}; }

void store(srbf::Rgb colour, float scale, float f[3]) {
    f[0] = scale * colour.r, f[1] = scale * colour.g, f[2] = scale * colour.b;
}

}  // namespace

const srbf_plain::Brdf* srbf_plain::open(const std::string& file, bool exchanged, std::string& error) {
    static std::mutex mutex;
    static auto& opened = *new std::map<std::pair<std::string, bool>, Brdf>;  // its elements are never moved or freed
    const std::lock_guard lock(mutex);
    if (const auto found = opened.find({file, exchanged}); found != opened.end()) return &found->second;
    const auto loaded = srbf::load(file);
    if (!loaded) return error = message(loaded.error()), nullptr;
    Brdf brdf{srbf::prepare(exchanged ? srbf::exchanged(*loaded) : *loaded)};
    return &opened.emplace(std::pair(file, exchanged), std::move(brdf)).first->second;
}

void srbf_plain::value(const Brdf& brdf, const float wl[3], const float wv[3], float f[3]) {
    const srbf::Rgb colour = srbf::value(brdf.prepared, vec(wl), vec(wv));
    store(colour.g >= 0 ? colour : srbf::Rgb{}, 1, f);  // NaN, in all channels, where a measurement has no value
}

float srbf_plain::sample(const Brdf& brdf, const float wv[3], float uc, const float u[2], float wl[3], float f[3]) {
    const srbf::LightSample light = srbf::sample(brdf.prepared, vec(wv), {u[0], u[1]}, uc);
    if (!(light.pdf > 0)) return 0;
    wl[0] = light.wl.x, wl[1] = light.wl.y, wl[2] = light.wl.z;
    store(light.weight, light.pdf / light.wl.z, f);  // the weight is f cosθ / pdf
    return light.pdf;
}

float srbf_plain::pdf(const Brdf& brdf, const float wl[3], const float wv[3]) {
    return srbf::pdf(brdf.prepared, vec(wl), vec(wv));
}

float srbf_plain::albedo(const Brdf& brdf, float cos_v) { return srbf::albedo(brdf.prepared, cos_v).g; }
