// The three pictures of the window: reference, fit, and their difference.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>

#include "extras/render/raster.h"
#include "extras/view/display_state.h"

namespace SRBF_NAMESPACE {

/// Pictures of one mesh with two materials from one camera, and of their difference. Uses the current OpenGL context.
class Panels {
  public:
    enum Which { reference, fit, difference };
    /// Errors: the graphics library cannot render to floats.
    static Result<Panels> make(Dialect dialect);

    void set_mesh(const Mesh& mesh);
    /// Sets a material; none: an empty picture. For a multivariate model with the same shader text, only numbers
    /// are uploaded.
    Result<Done> set_material(Which which, const std::optional<Material>& material,
                              std::function<Proposals()> propose = {});
    /// Sets the environment; null: directional lights only.
    Result<Done> set_environment(const Environment* environment);

    /// Redraws what has changed since the last call; each picture has width × height pixels. Automatic exposure is
    /// updated only if `expose` is true, since it would flicker during rotation. Under an environment, pictures
    /// begin with `k_first_samples`; each later call adds one sample unless the picture is `moving`.
    Result<Done> draw(DisplayState& display, int width, int height, bool expose, bool moving);
    /// The number of samples of the pictures under an environment; `k_converged` without one.
    int samples() const;
    static constexpr int k_converged = 1024;
    /// A picture as a texture, with rows from the bottom.
    unsigned texture(Which which) const { return panel_of(which).picture ? panel_of(which).picture->texture() : 0; }
    /// The radiance in a picture at (u, v), fractions of its width and height from the upper left corner. None:
    /// there is no material, or the mesh is not visible there.
    std::optional<Rgb> radiance_at(Which which, float u, float v) const;
    const Bounds& bounds() const { return mesh_->bounds(); }
    bool has(Which which) const { return panel_of(which).material.has_value(); }

  private:
    explicit Panels(Dialect dialect) : dialect_(dialect) {}
    Result<Done> resize(int width, int height);
    struct Panel {
        std::optional<RasterMaterial> material;
        std::string text;  ///< text of the shader
        bool is_stale = true;
        std::optional<RasterTarget> radiance, picture;
        // Under an environment, these replace `radiance`. They are made when they are needed.
        std::optional<Material> content;
        std::function<Proposals()> propose;
        std::optional<RasterMaterial> lit;
        std::string lit_text;
        bool is_proposed = false;
        std::optional<RasterMean> mean;
        const RasterTarget& displayed() const { return mean && mean->samples() > 0 ? mean->picture() : *radiance; }
    };
    Result<Done> begin_mean(Panel& panel);
    void add_samples(const DisplayState& display, RasterView view);
    Panel& panel_of(Which which) { return panels_[which]; }
    const Panel& panel_of(Which which) const { return panels_[which]; }

    Dialect dialect_;
    std::array<Panel, 3> panels_;
    std::optional<RasterMesh> mesh_;
    std::optional<RasterSurface> surface_;
    std::optional<RasterEnvironment> environment_;
    std::optional<RasterDevelopment> development_;
    int width_ = 0, height_ = 0;
    std::string drawn_;  ///< key of the camera, lights and mesh in the current pictures
};

}  // namespace srbf
