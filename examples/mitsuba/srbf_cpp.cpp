// A model of srbf, or a measurement, as a BSDF of Mitsuba 3, for its variant scalar_rgb; another variant says that it
// has no such plugin. C++20. To build it for the Mitsuba of `pip install mitsuba==3.9.1 nanobind==2.14.0`:
//   cmake -S examples/mitsuba -B build/mitsuba -DCMAKE_PREFIX_PATH=PREFIX_OF_SRBF -DPython_EXECUTABLE=PYTHON
//   cmake --build build/mitsuba
// and in Python, to use it:
//   mitsuba.set_variant("scalar_rgb")
//   mitsuba.file_resolver().append("build/mitsuba")
//   mitsuba.load_dict({"type": "srbf_cpp", "filename": "film.srbf"})
// With "exchange": True light and viewer are exchanged, as `measured` has them of an RGL file.
// A BRDF is black from the back, as Mitsuba's own; its `twosided` shows it on both sides. A BSDF has both.
//
// Mitsuba's `wi` points to the viewer and its `wo` to the light. The TransportMode is not used, which is correct for
// reciprocal models only: with others, integrators that follow light (`ptracer`) exchange light and viewer.
#include <mitsuba/core/fresolver.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/render/bsdf.h>
#include <srbf/load.h>
#include <srbf/prepared_bsdf.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace {

using Spectrum = mitsuba::Color<float, 3>;
using mitsuba::BSDFContext;
using mitsuba::BSDFFlags;

class SrbfBsdf final : public mitsuba::BSDF<float, Spectrum> {
  public:
    MI_DECLARE_CLASS(SrbfBsdf)

    explicit SrbfBsdf(const mitsuba::Properties& properties)
        : BSDF(properties),
          file_(mitsuba::file_resolver()->resolve(properties.get<std::string_view>("filename")).string()),
          bsdf_(opened(file_, properties.get<bool>("exchange", false))) {
        const auto add = [&](BSDFFlags kind, uint32_t sides) { m_components.push_back(+kind | sides); };
        const uint32_t front = +BSDFFlags::FrontSide, both = BSDFFlags::FrontSide | BSDFFlags::BackSide;
        add(BSDFFlags::GlossyReflection, bsdf_.is_brdf() ? front : both);
        if (!bsdf_.is_brdf()) {
            add(BSDFFlags::GlossyTransmission, both);
            add(BSDFFlags::DeltaReflection, both);  // the beams: a mirror's, and what passes straight through
            add(BSDFFlags::Null, both);
        }
        for (const auto flags : m_components) m_flags |= flags;
    }

    Spectrum eval(const BSDFContext& context, const SurfaceInteraction3f& at, const Vector3f& wo,
                  bool active) const override {
        return asks(active, context, at) ? reflected(value(bsdf_, vec(wo), vec(at.wi)), wo) : Spectrum(0);
    }
    float pdf(const BSDFContext& context, const SurfaceInteraction3f& at, const Vector3f& wo,
              bool active) const override {
        return asks(active, context, at) ? srbf::pdf(bsdf_, vec(wo), vec(at.wi)) : 0;
    }
    std::pair<Spectrum, float> eval_pdf(const BSDFContext& context, const SurfaceInteraction3f& at, const Vector3f& wo,
                                        bool active) const override {
        if (!asks(active, context, at)) return {0, 0};
        const srbf::ValuePdf both = value_pdf(bsdf_, vec(wo), vec(at.wi));
        return {reflected(both.value, wo), both.pdf};
    }
    std::pair<BSDFSample3f, Spectrum> sample(const BSDFContext& context, const SurfaceInteraction3f& at, float sample1,
                                             const Point2f& sample2, bool active) const override {
        BSDFSample3f result(Vector3f(0, 0, 1));
        if (!asks(active, context, at)) return {result, 0};
        const srbf::BsdfSample light = srbf::sample(bsdf_, vec(at.wi), {sample2.x(), sample2.y()}, sample1);
        if (!(light.pdf > 0 || light.is_beam)) return {result, 0};
        result.wo = {light.wl.x, light.wl.y, light.wl.z};
        result.pdf = light.is_beam ? 1 : light.pdf;  // a beam has none, and integrators ignore it
        result.sampled_component = 2u * light.is_beam + (light.wl.z * at.wi.z() < 0);
        result.sampled_type = m_components[result.sampled_component] & BSDFFlags::All;
        return {result, {light.weight.r, light.weight.g, light.weight.b}};
    }

    std::string to_string() const override { return "SrbfBsdf[" + file_ + "]"; }

  private:
    static srbf::PreparedBsdf opened(const std::string& file, bool exchanged) {
        auto loaded = srbf::load_brdf(file);
        if (!loaded) throw std::runtime_error(message(loaded.error()));
        return std::visit(
            [&](auto& brdf) {
                if (exchanged) exchange(brdf);
                return prepare_bsdf(brdf, {.azimuths = srbf::azimuths_for(is_isotropic(brdf))});
            },
            *loaded);
    }
    static srbf::Vec3f vec(const Vector3f& w) { return {w.x(), w.y(), w.z()}; }
    /// f |cosθ| of the light; a measurement is NaN, in all channels, where it has no value.
    static Spectrum reflected(const srbf::Rgb& f, const Vector3f& wo) {
        return f.g >= 0 ? std::abs(wo.z()) * Spectrum(f.r, f.g, f.b) : Spectrum(0);
    }
    /// A context may ask for components. These are sampled together, so one that asks for reflection gets all.
    bool asks(bool active, const BSDFContext& context, const SurfaceInteraction3f& at) const {
        return active && context.is_enabled(BSDFFlags::GlossyReflection) && (at.wi.z() > 0 || !bsdf_.is_brdf());
    }

    std::string file_;
    srbf::PreparedBsdf bsdf_;
};

}  // namespace

extern "C" MI_EXPORT void init_plugin(std::string_view name, mitsuba::PluginRegisterFn add) {
    add(name, "scalar_rgb", SrbfBsdf::Type,
        [](void*, const mitsuba::Properties& properties) -> mitsuba::ref<mitsuba::Object> {
            return new SrbfBsdf(properties);
        });
}
