// Drawing with OpenGL 4.5 or OpenGL ES 3.0, off screen or into the framebuffer of a window, always in the current context, whosever it is: level 6.
#pragma once
#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/image.h"
#include "render/pixel_shader.h"
#include "render/scene.h"

namespace srbf {

/// What the graphics library gave by a number, given back when its owner goes. It must go while its context is current.
class GlObject {
  public:
    using Delete = void (*)(unsigned id);
    GlObject() = default;
    GlObject(unsigned id, Delete destroy) : id_(id), delete_(destroy) {}
    GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)), delete_(other.delete_) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(id_, other.id_), std::swap(delete_, other.delete_);
        return *this;
    }
    ~GlObject() {
        if (id_ != 0) delete_(id_);
    }
    unsigned id() const { return id_; }

  private:
    unsigned id_ = 0;
    Delete delete_ = nullptr;
};

/// A mesh as the graphics library holds it.
class RasterMesh {
  public:
    explicit RasterMesh(const Mesh& mesh);
    const Bounds& bounds() const { return bounds_; }
    void draw() const;

  private:
    Bounds bounds_;
    int corners_ = 0;
    GlObject vertices_, triangles_, array_;
};

/// How a picture is taken.
struct RasterView {
    Camera camera;
    double aspect = 4.0 / 3;
    std::span<const DirectionalLight> lights;  ///< as many as the material was made for
    float exposure = 1;                        ///< of PixelOutput::shown
    /// Whether triangles are drawn that are seen from behind, as the inside of an open surface is. Without them a frame of a scan takes
    /// two thirds of the time.
    bool back_faces = true;
};

/// Positions and normals of what each pixel sees, a sample each: the first pass of two.
class RasterSurface {
  public:
    /// Errors: larger than the library's pictures; floats that it cannot draw.
    static Result<RasterSurface> make(Dialect dialect, int width, int height);
    /// Draws the mesh. The framebuffer that was bound and its viewport are as before afterwards.
    void draw(const RasterMesh& mesh, const RasterView& view) const;
    /// Rows from the top: (x, y, z), and 1 where there is a surface; its normal as interpolated, turned to the viewer.
    std::vector<Float4> read_positions() const { return read(0); }
    std::vector<Float4> read_normals() const { return read(1); }

  private:
    friend class RasterMaterial;
    friend class RasterTarget;
    RasterSurface() = default;
    std::vector<Float4> read(unsigned colour) const;
    int width_ = 0, height_ = 0;
    GlObject program_, positions_, normals_, depth_, framebuffer_;
};

/// A material as the graphics library holds it: a program and its numbers.
class RasterMaterial {
  public:
    /// Errors: a model larger than the library's buffers or textures; a text that the library's compiler refuses.
    static Result<RasterMaterial> make(const Material& material, const ShaderOptions& options);

    /// Replaces the numbers by those of another model of the same text (`shader_text`). Costs no more than handing over that many bytes.
    void update(const PmModel& model);
    /// Draws the mesh into the current framebuffer, whose viewport is set; made for PixelInput::triangles.
    void draw(const RasterMesh& mesh, const RasterView& view) const;
    /// Shades what the surface holds, drawn from the same view, into a framebuffer that has the surface's depths, as those of
    /// `RasterTarget::make_for` have; made for PixelInput::surface.
    void draw(const RasterSurface& surface, const RasterView& view) const;
    /// Bytes of its numbers that a pixel looks up, and of the index texture and table of directions.
    std::size_t data_bytes() const { return data_bytes_; }
    std::size_t auxiliary_bytes() const { return auxiliary_bytes_; }

  private:
    struct Texture {
        GlObject object;
        unsigned target;
    };
    explicit RasterMaterial(GlObject program) : program_(std::move(program)) {}
    void add_texture(const char* sampler, Texture texture);
    void use(const RasterView& view) const;
    void load(const Flat&) {}
    void load(const MerlTable& table);
    void load(const PmModel& model);
    void load(const SuModel& model);
    void load(const GgxModel& model);

    GlObject program_, numbers_, no_array_;
    std::vector<Texture> textures_;  ///< in the order of their units
    std::size_t data_bytes_ = 0, auxiliary_bytes_ = 0;
    bool is_open_ = false;  ///< of a multivariate model
};

/// A framebuffer off screen, bound while it is drawn into.
class RasterTarget {
  public:
    /// What its pixels hold: 8 bits a channel, or floats (32 bits; 16 where several samples of those cannot be had).
    enum class Format { bytes, floats };
    /// `samples` for each pixel, or as many as there are. Errors: larger than the library's pictures; floats that it cannot draw.
    static Result<RasterTarget> make(int width, int height, int samples, Format format);
    /// For the second pass over the surface, whose size and depths it has; not to outlive it.
    static Result<RasterTarget> make_for(const RasterSurface& surface, Format format);
    /// Binds it, sets its viewport and clears it (of another's depths the colours alone): 0 everywhere, no coverage; or the grey behind `shown` pictures.
    void begin() const;
    /// What was drawn, its samples averaged: rows from the top, RGBA.
    std::vector<Float4> read_floats() const;
    Image8 read_bytes() const;
    int samples() const { return samples_; }
    /// What was drawn as a texture, of one sample a pixel.
    unsigned texture() const;

  private:
    friend class RasterDevelopment;
    RasterTarget() = default;
    void resolve() const;
    int width_ = 0, height_ = 0, samples_ = 1;
    Format format_{};
    GlObject colour_, depth_, framebuffer_;
    GlObject resolved_colour_, resolved_;  ///< of one sample, where the other has several
};

/// Shows radiances that were drawn before: exposure, and the scale of a difference, then cost no shading.
class RasterDevelopment {
  public:
    /// How a signed difference shows, sRGB from 0 to 1: where the other is darker, as bright, brighter; in between linear.
    static constexpr Rgb k_darker{0.13f, 0.40f, 0.67f}, k_equal{0.93f, 0.93f, 0.93f}, k_brighter{0.70f, 0.09f, 0.17f};

    static Result<RasterDevelopment> make(Dialect dialect);
    /// What a screen shows of a target of floats, into the current framebuffer of its size: as `shown` has it.
    void draw(const RasterTarget& radiance, float exposure) const { draw(radiance, radiance, exposure, 0); }
    /// exposure (other − reference), of their luminances; `full_scale` > 0 shows in full colour.
    void draw_difference(const RasterTarget& reference, const RasterTarget& other, float exposure,
                         float full_scale) const {
        draw(reference, other, exposure, full_scale);
    }

  private:
    RasterDevelopment() = default;
    void draw(const RasterTarget& radiance, const RasterTarget& other, float exposure, float full_scale) const;
    GlObject program_, no_array_;
};

/// Pictures of the scene, one for each material: linear radiance and coverage, as other renderers give them. Errors: as above.
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Material> materials, int width, int height,
                                         int samples = 4);

}  // namespace srbf
