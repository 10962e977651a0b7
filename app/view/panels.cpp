#include "app/view/panels.h"

#include <fmt/format.h>

namespace srbf {
namespace {

constexpr std::array<Panels::Which, 2> k_materials{Panels::reference, Panels::fit};

/// A key of everything but the materials that the radiances depend on.
std::string key_of(const Look& look) {
    std::string key = fmt::format("{} {} {}", look.azimuth, look.elevation, look.zoom);
    for (const DirectionalLight& light : look.lights)
        key += fmt::format(" {} {} {} {}", light.towards.x, light.towards.y, light.towards.z, light.irradiance.r);
    return key;
}

/// The key of what was drawn.
float exposure_of(const RasterTarget& radiance, int width, int height) {
    Image image(width, height);
    const auto pixels = radiance.read_floats();
    for (std::size_t i = 0; i < pixels.size(); ++i) image.pixels[i] = {pixels[i][0], pixels[i][1], pixels[i][2]};
    return automatic_exposure(image);
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
    mesh_.reset();
    mesh_.emplace(mesh);
    drawn_.clear();
}

Result<Done> Panels::set_material(Which which, const std::optional<Material>& material) {
    Panel& panel = of(which);
    panel.is_stale = true;
    if (!material) return panel.material.reset(), panel.text.clear(), Done{};
    const ShaderOptions options{
        .dialect = dialect_, .output = PixelOutput::radiance, .input = PixelInput::surface, .lights = 3, .open = true};
    std::string text = shader_text(*material, options).fragment;
    const auto* pm = std::get_if<PmModel>(&*material);
    if (pm && panel.material && panel.is_pm && panel.text == text) return panel.material->update(*pm), Done{};
    panel.material.reset();
    auto made = RasterMaterial::make(*material, options);
    if (!made) return panel.text.clear(), made.error();
    panel.material.emplace(*std::move(made));
    panel.text = std::move(text);
    panel.is_pm = pm != nullptr;
    return Done{};
}

Result<Done> Panels::resize(int width, int height) {
    if (width == width_ && height == height_) return Done{};
    for (Panel& panel : panels_) panel.radiance.reset(), panel.shown.reset();
    surface_.reset();
    auto surface = RasterSurface::make(dialect_, width, height);
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

Result<Done> Panels::draw(Look& look, int width, int height, bool expose) {
    if (const auto sized = resize(width, height); !sized) return sized.error();
    const RasterView view{camera_of(look, bounds()), double(width) / height, look.lights};
    if (const std::string key = key_of(look); key != drawn_) {
        drawn_ = key;
        surface_->draw(*mesh_, view);
        for (const Which which : k_materials) of(which).is_stale = true;
    }
    for (const Which which : k_materials) {
        Panel& panel = of(which);
        if (!panel.is_stale) continue;
        panel.is_stale = false;
        panel.radiance->begin();
        if (panel.material) panel.material->draw(*surface_, view);
    }
    if (expose && look.automatic)
        if (const Which which = has(reference) ? reference : fit; has(which))
            look.exposure = exposure_of(*of(which).radiance, width, height);
    for (const Which which : k_materials) {
        of(which).shown->begin();
        development_->draw(*of(which).radiance, look.exposure);
    }
    of(difference).shown->begin();
    if (has(reference) && has(fit))
        development_->draw_difference(*of(reference).radiance, *of(fit).radiance, look.exposure, look.full_scale);
    return Done{};
}

}  // namespace srbf
