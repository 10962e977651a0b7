// Drawing under directional lights with OpenGL 4.5 or OpenGL ES 3.0 in the current context.
#pragma once
#include <cstdint>
#include <utility>

#include "extras/render/pixel_shader.h"
#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "models/su/su_functions.h"

namespace SRBF_NAMESPACE {

/// Owns an object of the graphics library. It must be destroyed while its context is current.
class GlObject {
  public:
    using Delete = void (*)(unsigned id);
    GlObject() = default;
    GlObject(unsigned id, Delete destroy) : id_(id), delete_(destroy) {}
    GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)), delete_(other.delete_) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(delete_, other.delete_);
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

/// Parameters of a picture.
struct RasterView {
    Camera camera;
    double aspect = 4.0 / 3;
    std::span<const DirectionalLight> lights;  ///< the lights, whose number the material's text has
    float exposure = 1;                        ///< exposure of PixelOutput::shown
    /// If true, back faces are drawn, which open surfaces need. Without them a frame of a scanned mesh takes two thirds
    /// of the time.
    bool back_faces = true;
};

/// A mesh in the buffers of the graphics library.
class RasterMesh {
  public:
    explicit RasterMesh(const Mesh& mesh);
    /// Draws the mesh with the program in use, `program`, after setting its uniform `to_clip` for the view.
    void draw(const GlObject& program, const RasterView& view) const;

  private:
    Bounds bounds_;
    int corners_ = 0;
    GlObject vertices_, triangles_, array_;
};

/// Position and normal of the visible surface at each pixel: the first of two passes.
class RasterSurface {
  public:
    /// Returns an error if it is larger than OpenGL's framebuffers, or if float formats cannot be rendered to.
    static Result<RasterSurface> make(Dialect dialect, int width, int height);
    /// Draws the mesh into this surface's framebuffer, which stays bound.
    void draw(const RasterMesh& mesh, const RasterView& view) const;
    /// Rows of pixels from the top. Positions are (x, y, z), and 1 where there is a surface. Normals are
    /// interpolated and face the viewer; their fourth number is 1 at the front and −1 at the back.
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

/// A material in the graphics library: a program and its numbers.
class RasterMaterial {
  public:
    /// Returns an error if the model is larger than OpenGL's buffers or textures, or if its compiler rejects the text.
    static Result<RasterMaterial> make(const Material& material, const ShaderOptions& options);

    /// Draws the mesh into the current framebuffer with its current viewport. Requires PixelInput::triangles.
    void draw(const RasterMesh& mesh, const RasterView& view) const;
    /// Shades `surface`, drawn from the same view, into a framebuffer with the depths of the surface, as
    /// `RasterTarget::make_for` makes it. Requires PixelInput::surface.
    void draw(const RasterSurface& surface, const RasterView& view) const;
    /// Size of the numbers that a pixel looks up, and of the index texture and table of directions.
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
    void load(const MerlTable& table);
    void load(const PmModel& model);
    void load(const SuModel& model);
    void load(const BsdfTables& tables);
    template <typename M> void load(const M& model) { load(uniform_of(model)); }  // numbers of a BSDF are in the text
    void load(const Uniform& uniform);
    void load_table(std::array<std::uint32_t, 3> size, std::vector<Float4> texels);

    GlObject program_, numbers_, no_array_;
    std::vector<Texture> textures_;  ///< textures in the order of their units
    std::size_t data_bytes_ = 0, auxiliary_bytes_ = 0;
};

/// An off-screen framebuffer. Drawing binds it.
class RasterTarget {
  public:
    /// Pixel formats: 8 bits per channel, or floats (32 bits; 16 if multisampling requires it).
    enum class Format { bytes, floats };
    /// A target of `samples` per pixel, or as many as OpenGL supports. Returns an error if it is larger than OpenGL's
    /// framebuffers, or if float formats cannot be rendered to.
    static Result<RasterTarget> make(int width, int height, int samples, Format format);
    /// Makes a target for the second pass over `surface`, with the same size and depths, one sample per pixel and
    /// bytes. It must not outlive `surface`.
    static Result<RasterTarget> make_for(const RasterSurface& surface);
    /// Binds the framebuffer, sets its viewport and clears it to 0 without coverage, or to the grey background of
    /// `shown` pictures. Depths are cleared only if the target owns them.
    void begin() const;
    /// The picture with its samples averaged: rows from the top, RGBA.
    std::vector<Float4> read_floats() const;
    Image8 read_bytes() const;
    int samples() const { return samples_; }

  private:
    RasterTarget() = default;
    void resolve() const;
    int width_ = 0, height_ = 0, samples_ = 1;
    Format format_{};
    GlObject colour_, depth_, framebuffer_;
    GlObject resolved_colour_, resolved_;  ///< the averages of several samples per pixel
};

/// Pictures of the scene with each material: linear radiance and coverage, as from other renderers. Returns an error as
/// `RasterTarget::make` and `RasterMaterial::make` do.
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Material> materials, int width, int height,
                                         int samples = 4);

}  // namespace
