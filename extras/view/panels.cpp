#include "extras/view/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace srbf {
namespace {

constexpr std::array<Panels::Which, 2> k_materials{Panels::reference, Panels::fit};

/// A key of everything but the materials that the radiances depend on.
std::string key_of(const Look& look) {
    std::string key = fmt::format("{} {} {}", look.azimuth, look.elevation, look.zoom);
    for (const DirectionalLight& light : look.lights)
        key += fmt::format(" {} {} {} {}", light.towards.x, light.towards.y, light.towards.z, light.irradiance.r);
    return key + fmt::format(" {} {} {}", look.environment, look.turned, look.lamps);
}

/// The key of what was drawn.
float exposure_of(const RasterTarget& radiance, int width, int height) {
    Image image(width, height);
    const auto pixels = radiance.read_floats();
    for (std::size_t i = 0; i < pixels.size(); ++i) image.pixels[i] = {pixels[i][0], pixels[i][1], pixels[i][2]};
    return automatic_exposure(image);
}

/// Makes the material, or only uploads its numbers if `made` is a multivariate model with the same shader `text`.
Result<Done> make_or_update(std::optional<RasterMaterial>& made, std::string& text, const Material& material,
                            const ShaderOptions& options) {
    std::string anew = shader_text(material, options).fragment;
    const auto* pm = std::get_if<PmModel>(&material);
    if (pm && made && text == anew) return made->update(*pm), Done{};
    made.reset();
    auto of = RasterMaterial::make(material, options);
    if (!of) return of.error();
    made.emplace(*std::move(of));
    text = std::move(anew);
    return Done{};
}

}  // namespace

Result<Panels> Panels::make(Dialect dialect) {
    Panels panels(dialect);
    auto development = RasterDevelopment::make(dialect);
    if (!development) return development.error();
    panels.development_.emplace(*std::move(development));
    if (const auto sized = panels.resize(64, 64); !sized) return sized.error();
    return panels;
}

void Panels::set_mesh(const Mesh& mesh) {
    mesh_.emplace(mesh);
    drawn_.clear();
}

Result<Done> Panels::set_material(Which which, const std::optional<Material>& material,
                                  std::function<Proposals()> propose) {
    Panel& panel = of(which);
    panel.is_stale = true;
    panel.content = material;
    panel.propose = std::move(propose);
    panel.is_proposed = false;
    if (!material) return panel.material.reset(), panel.text.clear(), Done{};
    const ShaderOptions options{
        .dialect = dialect_, .output = PixelOutput::radiance, .input = PixelInput::surface, .lights = 3, .open = true};
    return make_or_update(panel.material, panel.text, *material, options);
}

Result<Done> Panels::set_environment(const Environment* environment) {
    environment_.reset();
    width_ = height_ = 0;  // the surface is of other points
    drawn_.clear();
    if (!environment) return Done{};
    auto made = RasterEnvironment::make(*environment);
    if (!made) return made.error();
    environment_.emplace(*std::move(made));
    return Done{};
}

int Panels::samples() const {
    int least = k_converged;
    if (environment_)
        for (const Which which : k_materials)
            if (has(which)) least = std::min(least, of(which).mean ? of(which).mean->samples() : 0);
    return least;
}

std::optional<Rgb> Panels::radiance_at(Which which, float u, float v) const {
    if (!has(which) || !(u >= 0 && u < 1 && v >= 0 && v < 1)) return std::nullopt;
    const Float4 pixel = of(which).seen().read_pixel(int(u * float(width_)), int(v * float(height_)));
    if (!(pixel[3] > 0)) return std::nullopt;
    return Rgb{pixel[0], pixel[1], pixel[2]};
}

Result<Done> Panels::begin_mean(Panel& panel) {
    if (!panel.is_proposed) {
        const ShaderOptions options{.dialect = dialect_, .lights = 3, .environment = true, .open = true};
        if (const auto done = make_or_update(panel.lit, panel.lit_text, *panel.content, options); !done)
            return done.error();
        panel.lit->set_proposal(panel.propose());
        panel.is_proposed = true;
    }
    if (!panel.mean) {
        auto mean = RasterMean::make(*surface_);
        if (!mean) return mean.error();
        panel.mean.emplace(*std::move(mean));
    }
    panel.mean->restart();
    return Done{};
}

/// The next sample of each picture, all of them seen through the same points of their pixels.
void Panels::add_samples(const Look& look, RasterView view) {
    const int index = samples();
    if (index >= k_converged) return;
    view.shift = sample_shift(index, width_, height_);
    surface_->draw(*mesh_, view);
    const double s = std::sin(look.turned), c = std::cos(look.turned);
    const EnvironmentLight light{&*environment_, {{c, 0, -s}, {0, 1, 0}, {s, 0, c}}, LightDraws::both};
    for (const Which which : k_materials) {
        Panel& panel = of(which);
        if (panel.material && panel.mean && panel.mean->samples() == index)
            panel.mean->add(*panel.lit, *surface_, view, light);
    }
}

Result<Done> Panels::resize(int width, int height) {
    if (width == width_ && height == height_) return Done{};
    for (Panel& panel : panels_) panel.radiance.reset(), panel.shown.reset(), panel.mean.reset();
    surface_.reset();
    auto surface = RasterSurface::make(dialect_, width, height,
                                       environment_ ? RasterSurface::Points::four : RasterSurface::Points::one);
    if (!surface) return surface.error();
    surface_.emplace(*std::move(surface));
    for (const Which which : {reference, fit, difference}) {
        auto shown = RasterTarget::make(width, height, 1, RasterTarget::Format::bytes);
        if (!shown) return shown.error();
        of(which).shown.emplace(*std::move(shown));
        if (which == difference) continue;
        auto radiance = RasterTarget::make_for(*surface_, RasterTarget::Format::floats);
        if (!radiance) return radiance.error();
        of(which).radiance.emplace(*std::move(radiance));
    }
    width_ = width, height_ = height;
    drawn_.clear();
    return Done{};
}

Result<Done> Panels::draw(Look& look, int width, int height, bool expose, bool moving) {
    if (const auto sized = resize(width, height); !sized) return sized.error();
    std::array<DirectionalLight, 3> lights = look.lights;
    if (!look.has_lights())
        for (DirectionalLight& light : lights) light.irradiance = {};
    const RasterView view{.camera = camera_of(look, bounds()), .aspect = double(width) / height, .lights = lights};
    const std::string key = key_of(look);
    bool anew = key != drawn_;
    // One that is stale is drawn from the surface that is seen through the centres of pixels, and both begin again.
    if (environment_) anew = anew || of(reference).is_stale || of(fit).is_stale;
    if (anew) {
        drawn_ = key;
        surface_->draw(*mesh_, view);
        for (const Which which : k_materials) of(which).is_stale = true;
    }
    for (const Which which : k_materials) {
        Panel& panel = of(which);
        if (!panel.is_stale) continue;
        panel.is_stale = false;
        if (!environment_) panel.mean.reset();
        panel.radiance->begin();
        if (!panel.material) continue;
        if (environment_) {
            if (const auto begun = begin_mean(panel); !begun) return begun.error();
        } else {
            panel.material->draw(*surface_, view);
        }
    }
    if (environment_)
        for (int more = samples() == 0 ? k_first_samples : moving ? 0 : 1; more > 0; --more) add_samples(look, view);
    if (expose && look.automatic)
        if (const Which which = has(reference) ? reference : fit; has(which))
            look.exposure = exposure_of(of(which).seen(), width, height);
    for (const Which which : k_materials) {
        const Panel& panel = of(which);
        panel.shown->begin();
        development_->draw(panel.seen(), look.exposure);
    }
    of(difference).shown->begin();
    if (has(reference) && has(fit))
        development_->draw_difference(of(reference).seen(), of(fit).seen(), look.exposure, look.full_scale,
                                      look.in_delta_e);
    return Done{};
}

}  // namespace srbf
