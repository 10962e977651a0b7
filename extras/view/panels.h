// The three pictures of the window: reference, fit, and their difference.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>

#include "extras/render/raster.h"
#include "extras/view/look.h"

namespace srbf {

/// Pictures of one mesh with two materials from one camera, and of their difference. Uses the current context.
class Panels {
  public:
    enum Which { reference, fit, difference };
    /// Errors: a graphics library that cannot render to floats.
    static Result<Panels> make(Dialect dialect);

    void set_mesh(const Mesh& mesh);
    /// Sets a material; none: an empty picture. A multivariate model with the same shader text only costs the upload of
    /// its numbers.
    Result<Done> set_material(Which which, const std::optional<Material>& material,
                              std::function<Proposals()> propose = {});
    /// Sets the light around the scene; none: lights alone.
    Result<Done> set_environment(const Environment* environment);

    /// Redraws what has changed since the last call; each picture has width × height pixels. Automatic exposure is
    /// updated only with `expose`, since it would flicker during rotation. Under an environment the pictures begin
    /// with `k_first_samples`; if they are not `moving`, each call adds one.
    Result<Done> draw(Look& look, int width, int height, bool expose, bool moving);
    /// The samples of the pictures under an environment; `k_converged` without one.
    int samples() const;
    static constexpr int k_converged = 1024;
    /// A picture as a texture, rows from the bottom.
    unsigned texture(Which which) const { return of(which).shown ? of(which).shown->texture() : 0; }
    /// The radiance that a picture shows at (u, v), shares of its width and height from the upper left corner. None: no
    /// material, or nothing of the mesh.
    std::optional<Rgb> radiance_at(Which which, float u, float v) const;
    const Bounds& bounds() const { return mesh_->bounds(); }
    bool has(Which which) const { return of(which).material.has_value(); }

  private:
    explicit Panels(Dialect dialect) : dialect_(dialect) {}
    Result<Done> resize(int width, int height);
    struct Panel {
        std::optional<RasterMaterial> material;
        std::string text;  ///< of its shader
        bool is_stale = true;
        std::optional<RasterTarget> radiance, shown;
        // Under an environment, instead of `radiance`; made when there is one.
        std::optional<Material> content;
        std::function<Proposals()> propose;
        std::optional<RasterMaterial> lit;
        std::string lit_text;
        bool is_proposed = false;
        std::optional<RasterMean> mean;
        const RasterTarget& seen() const { return mean && mean->samples() > 0 ? mean->picture() : *radiance; }
    };
    Result<Done> begin_mean(Panel& panel);
    void add_samples(const Look& look, RasterView view);
    Panel& of(Which which) { return panels_[which]; }
    const Panel& of(Which which) const { return panels_[which]; }

    Dialect dialect_;
    std::array<Panel, 3> panels_;
    std::optional<RasterMesh> mesh_;
    std::optional<RasterSurface> surface_;
    std::optional<RasterEnvironment> environment_;
    std::optional<RasterDevelopment> development_;
    int width_ = 0, height_ = 0;
    std::string drawn_;  ///< key of camera, lights and mesh of the current pictures
};

}  // namespace srbf
