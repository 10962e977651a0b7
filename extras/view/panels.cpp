#include "extras/view/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace SRBF_NAMESPACE {
namespace {

constexpr std::array<Panels::Which, 2> k_materials{Panels::reference, Panels::fit};

/// A key of what the radiances depend on, except the materials.
std::string key_of(const DisplayState& display) {
    std::string key = fmt::format("{} {} {}", display.azimuth, display.elevation, display.zoom);
    for (const DirectionalLight& light : display.lights)
        key += fmt::format(" {} {} {} {}", light.towards.x, light.towards.y, light.towards.z, light.irradiance.r);
    return key + fmt::format(" {} {} {}", display.environment, display.turned, display.lamps);
}

/// The automatic exposure of a picture.
float exposure_of(const RasterTarget& radiance, int width, int height) {
    Image image(width, height);
    const auto pixels = radiance.read_floats();
    for (std::size_t i = 0; i < pixels.size(); ++i) image.pixels[i] = {pixels[i][0], pixels[i][1], pixels[i][2]};
    return automatic_exposure(image);
}

/// Makes a material, or only uploads its numbers if `material` is a multivariate model with the same shader `text`.
Result<Done> make_or_update(std::optional<RasterMaterial>& raster_material, std::string& text, const Material& material,
                            const ShaderOptions& options) {
    std::string new_text = shader_text(material, options).fragment;
    const auto* pm = std::get_if<PmModel>(&material);
    if (pm && raster_material && text == new_text) return raster_material->update(*pm), Done{};
    raster_material.reset();
    auto new_material = RasterMaterial::make(material, options);
    if (!new_material) return new_material.error();
    raster_material.emplace(*std::move(new_material));
    text = std::move(new_text);
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
    Panel& panel = panel_of(which);
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
    width_ = height_ = 0;  // the surface has other points
    drawn_.clear();
    if (!environment) return Done{};
    auto raster_environment = RasterEnvironment::make(*environment);
    if (!raster_environment) return raster_environment.error();
    environment_.emplace(*std::move(raster_environment));
    return Done{};
}

int Panels::samples() const {
    int smallest = k_converged;
    if (environment_)
        for (const Which which : k_materials)
            if (has(which)) smallest = std::min(smallest, panel_of(which).mean ? panel_of(which).mean->samples() : 0);
    return smallest;
}

std::optional<Rgb> Panels::radiance_at(Which which, float u, float v) const {
    if (!has(which) || !(u >= 0 && u < 1 && v >= 0 && v < 1)) return std::nullopt;
    const Float4 pixel = panel_of(which).displayed().read_pixel(int(u * float(width_)), int(v * float(height_)));
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

/// Adds the next sample of each picture. All pictures use the same points of their pixels.
void Panels::add_samples(const DisplayState& display, RasterView view) {
    const int index = samples();
    if (index >= k_converged) return;
    view.shift = sample_shift(index, width_, height_);
    surface_->draw(*mesh_, view);
    const double s = std::sin(display.turned), c = std::cos(display.turned);
    const EnvironmentLight light{&*environment_, {{c, 0, -s}, {0, 1, 0}, {s, 0, c}}, LightDraws::both};
    for (const Which which : k_materials) {
        Panel& panel = panel_of(which);
        if (panel.material && panel.mean && panel.mean->samples() == index)
            panel.mean->add(*panel.lit, *surface_, view, light);
    }
}

Result<Done> Panels::resize(int width, int height) {
    if (width == width_ && height == height_) return Done{};
    for (Panel& panel : panels_) panel.radiance.reset(), panel.picture.reset(), panel.mean.reset();
    surface_.reset();
    auto surface = RasterSurface::make(dialect_, width, height,
                                       environment_ ? RasterSurface::Points::four : RasterSurface::Points::one);
    if (!surface) return surface.error();
    surface_.emplace(*std::move(surface));
    for (const Which which : {reference, fit, difference}) {
        auto picture = RasterTarget::make(width, height, 1, RasterTarget::Format::bytes);
        if (!picture) return picture.error();
        panel_of(which).picture.emplace(*std::move(picture));
        if (which == difference) continue;
        auto radiance = RasterTarget::make_for(*surface_, RasterTarget::Format::floats);
        if (!radiance) return radiance.error();
        panel_of(which).radiance.emplace(*std::move(radiance));
    }
    width_ = width, height_ = height;
    drawn_.clear();
    return Done{};
}

Result<Done> Panels::draw(DisplayState& display, int width, int height, bool expose, bool moving) {
    if (const auto sized = resize(width, height); !sized) return sized.error();
    std::array<DirectionalLight, 3> lights = display.lights;
    if (!display.has_lights())
        for (DirectionalLight& light : lights) light.irradiance = {};
    const RasterView view{.camera = camera_of(display, bounds()), .aspect = double(width) / height, .lights = lights};
    const std::string key = key_of(display);
    bool is_new = key != drawn_;
    // A stale picture starts from the surface at the centres of pixels, so both pictures start again.
    if (environment_) is_new = is_new || panel_of(reference).is_stale || panel_of(fit).is_stale;
    if (is_new) {
        drawn_ = key;
        surface_->draw(*mesh_, view);
        for (const Which which : k_materials) panel_of(which).is_stale = true;
    }
    for (const Which which : k_materials) {
        Panel& panel = panel_of(which);
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
        for (int remaining = samples() == 0 ? k_first_samples : moving ? 0 : 1; remaining > 0; --remaining)
            add_samples(display, view);
    if (expose && display.automatic)
        if (const Which which = has(reference) ? reference : fit; has(which))
            display.exposure = exposure_of(panel_of(which).displayed(), width, height);
    for (const Which which : k_materials) {
        const Panel& panel = panel_of(which);
        panel.picture->begin();
        development_->draw(panel.displayed(), display.exposure);
    }
    panel_of(difference).picture->begin();
    if (has(reference) && has(fit))
        development_->draw_difference(panel_of(reference).displayed(), panel_of(fit).displayed(), display.exposure,
                                      display.full_scale, display.in_delta_e);
    return Done{};
}

}  // namespace srbf
