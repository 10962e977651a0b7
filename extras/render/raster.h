// Drawing with OpenGL 4.5 or OpenGL ES 3.0 in the current context, off screen or into a window's framebuffer.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "brdf/frame.h"
#include "extras/render/environment.h"
#include "extras/render/gl_object.h"
#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "models/su/su_functions.h"

namespace SRBF_NAMESPACE {

/// Parameters of a picture.
struct RasterView {
    Camera camera;
    double aspect = 4.0 / 3;
    std::span<const DirectionalLight> lights;  ///< as many as the material was made for
    float exposure = 1;                        ///< for PixelOutput::shown
    /// True: back faces are drawn, which open surfaces need. Without them a frame of a scanned mesh takes two
    /// thirds of the time.
    bool back_faces = true;
    /// Offset of the points that pixels show from the pixels' centres, right and up, in widths and heights of the
    /// picture.
    std::array<double, 2> shift{};
};

/// A mesh in the buffers of the graphics library.
class RasterMesh {
  public:
    /// `textured`: with texture coordinates, which the mesh must have.
    explicit RasterMesh(const Mesh& mesh, bool textured = false);
    const Bounds& bounds() const { return bounds_; }
    /// Draws the mesh with the program in use, `program`, after setting its uniform `to_clip` for the view.
    void draw(const GlObject& program, const RasterView& view) const;

  private:
    void load_corners(const Mesh& mesh);
    Bounds bounds_;
    int corners_ = 0;
    GlObject vertices_, triangles_, array_;  ///< a textured mesh has each corner as a vertex, and no triangles_
};

/// An environment in textures of the graphics library.
class RasterEnvironment {
  public:
    /// Errors: larger than the library's textures.
    static Result<RasterEnvironment> make(const Environment& environment);

  private:
    friend class RasterMaterial;
    RasterEnvironment() = default;
    GlObject radiance_, columns_, rows_;
    float scale_ = 1;  ///< factor of the radiance: half floats hold at most 65504
};

/// Light of an environment for one more sample of every pixel.
struct EnvironmentLight {
    const RasterEnvironment* environment = nullptr;
    Frame axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< axes of the environment in the world
    LightDraws draws = LightDraws::both;
};

/// Position and normal of the visible surface at one point of each pixel, or under an environment at 2 × 2 points:
/// the first of two passes.
class RasterSurface {
  public:
    enum class Points { one = 1, four = 2 };
    /// `textured`: with texture coordinates, of meshes that were made so. Errors: larger than the library's framebuffers;
    /// float formats that cannot be rendered to.
    static Result<RasterSurface> make(Dialect dialect, int width, int height, Points points = Points::one,
                                      bool textured = false);
    /// Draws the mesh. The view's shift is that of one point of a pixel; the others are half a pixel away from it.
    /// Restores the framebuffer binding and the viewport.
    void draw(const RasterMesh& mesh, const RasterView& view) const;
    /// Rows of points from the top. Positions are (x, y, z), and 1 where there is a surface. Normals are
    /// interpolated and face the viewer; their fourth number is 1 at the front and −1 at the back.
    std::vector<Float4> read_positions() const { return read(0); }
    std::vector<Float4> read_normals() const { return read(1); }

  private:
    friend class RasterMaterial;
    friend class RasterTarget;
    RasterSurface() = default;
    std::vector<Float4> read(unsigned colour) const;
    int width_ = 0, height_ = 0;  ///< size of the picture
    int along_ = 1;               ///< number of points along a side of a pixel
    GlObject program_, positions_, normals_, places_, depth_, framebuffer_;
};

class RasterTarget;

/// A map of shared lobes: its code (`map_code` in GLSL, named "map"), and its coefficients.
struct RasterMap {
    /// A level of `layers` × height × width texels of R, G, B, A in 16-bit floats.
    struct Level {
        int width, height;
        std::vector<std::uint16_t> halves;
    };
    std::string code;
    int layers = 0;
    std::vector<Level> levels;  ///< from the finest on
};

/// A material in the graphics library: a program and its numbers.
class RasterMaterial {
  public:
    /// Errors: a model larger than the library's buffers or textures; a text that the library's compiler rejects.
    static Result<RasterMaterial> make(const Material& material, const ShaderOptions& options);

    /// It repeats the map over a textured mesh. Requires PixelInput::triangles or an environment. Errors: as above.
    static Result<RasterMaterial> make(const RasterMap& map, const ShaderOptions& options);

    /// Replaces the numbers by those of another model with the same text (`shader_text`). This costs only the
    /// upload of these bytes.
    void update(const PmModel& model);
    /// Draws the mesh into the current framebuffer with its current viewport. Requires PixelInput::triangles.
    void draw(const RasterMesh& mesh, const RasterView& view) const;
    /// Shades `surface`, drawn from the same view, into a framebuffer with the depths of the surface, as
    /// `RasterTarget::make_for` makes it. Requires PixelInput::surface.
    void draw(const RasterSurface& surface, const RasterView& view) const;
    /// Sets the density from which directions to the light are sampled. Requires `ShaderOptions::environment`.
    void set_proposal(const Proposals& proposals);
    /// Adds sample `index`, counted from 0, to the mean `before` of all samples before it, over the whole picture:
    /// where there is no surface, it shows the environment. Requires `ShaderOptions::environment` and
    /// `set_proposal`.
    void draw(const RasterSurface& surface, const RasterView& view, const EnvironmentLight& light,
              const RasterTarget& before, int index) const;
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
    /// Binds the textures of a pass over the whole picture after the material's own, and draws it.
    void draw_whole(std::initializer_list<std::pair<const char*, const GlObject*>> textures) const;
    void load(const MerlTable& table);
    void load(const PmModel& model);
    void load(const SuModel& model);
    void load(const BsdfTables& tables);
    template <typename M> void load(const M& of) { load(uniform_of(of)); }  // numbers of a BSDF are in the text
    void load(const Uniform& uniform);
    void load_table(std::array<std::uint32_t, 3> size, std::vector<Float4> texels);

    GlObject program_, numbers_, no_array_;
    std::vector<Texture> textures_;  ///< in the order of their units
    std::size_t data_bytes_ = 0, auxiliary_bytes_ = 0;
    bool is_open_ = false;  ///< for a multivariate model
};

/// An off-screen framebuffer. Drawing binds it.
class RasterTarget {
  public:
    /// Pixel formats: 8 bits per channel, or floats (32 bits; 16 if multisampling requires it).
    enum class Format { bytes, floats };
    /// `samples` per pixel, or as many as are supported. Errors: larger than the library's framebuffers; float
    /// formats that cannot be rendered to.
    static Result<RasterTarget> make(int width, int height, int samples, Format format);
    /// For the second pass over `surface`, with the same size and, with one point per pixel, the same depths. Must
    /// not outlive it.
    static Result<RasterTarget> make_for(const RasterSurface& surface, Format format);
    /// Binds the framebuffer, sets its viewport and clears it to 0 without coverage, or to the grey background of
    /// `shown` pictures. Depths are cleared only if they are its own.
    void begin() const;
    /// The picture with its samples averaged: rows from the top, RGBA.
    std::vector<Float4> read_floats() const;
    Float4 read_pixel(int x, int y) const;  ///< one pixel of it; (0, 0) is the upper left one
    Image8 read_bytes() const;
    int samples() const { return samples_; }
    /// The picture as a texture; requires one sample per pixel.
    unsigned texture() const;

  private:
    friend class RasterDevelopment;
    friend class RasterMaterial;
    RasterTarget() = default;
    void resolve() const;
    int width_ = 0, height_ = 0, samples_ = 1;
    Format format_{};
    GlObject colour_, depth_, framebuffer_;
    GlObject resolved_colour_, resolved_;  ///< with one sample per pixel, if the others have several
};

/// The mean of the samples of a picture under an environment, which converges as they are added. Sample i shows the
/// points that are `sample_shift(i)` from the centres of pixels.
class RasterMean {
  public:
    static Result<RasterMean> make(const RasterSurface& surface);
    /// Discards all samples.
    void restart() { samples_ = 0; }
    int samples() const { return samples_; }
    /// Adds a sample. `surface` must have been drawn from the same view, with the shift of sample `samples()`.
    void add(const RasterMaterial& material, const RasterSurface& surface, const RasterView& view,
             const EnvironmentLight& light);
    /// The mean; requires a sample.
    const RasterTarget& picture() const { return targets_[std::size_t(samples_ % 2)]; }

  private:
    explicit RasterMean(std::array<RasterTarget, 2> targets) : targets_(std::move(targets)) {}
    std::array<RasterTarget, 2> targets_;
    int samples_ = 0;
};
/// The shift of sample i in a picture of this size: a low-discrepancy sequence, uniform over a pixel.
std::array<double, 2> sample_shift(int i, int width, int height);

/// Displays previously rendered radiances, so that changes of exposure or of the scale of a difference need no shading.
class RasterDevelopment {
  public:
    /// Colours of a signed difference, sRGB from 0 to 1: the other picture is darker, equal or brighter; linear in
    /// between.
    static constexpr Rgb k_darker{0.13f, 0.40f, 0.67f}, k_equal{0.93f, 0.93f, 0.93f}, k_brighter{0.70f, 0.09f, 0.17f};

    static Result<RasterDevelopment> make(Dialect dialect);
    /// Displays a target of floats in the current framebuffer, which must have the same size, like `shown`.
    void draw(const RasterTarget& radiance, float exposure) const { draw(radiance, radiance, exposure, 0, false); }
    /// Displays exposure (other − reference) of the luminances, or ΔE_ITP / 100 of the displayed colours (from
    /// `k_equal` to `k_brighter`). `full_scale` > 0 is the difference with the full colour.
    void draw_difference(const RasterTarget& reference, const RasterTarget& other, float exposure, float full_scale,
                         bool in_delta_e = false) const {
        draw(reference, other, exposure, full_scale, in_delta_e);
    }

  private:
    RasterDevelopment() = default;
    void draw(const RasterTarget& radiance, const RasterTarget& other, float exposure, float full_scale,
              bool in_delta_e) const;
    GlObject program_, no_array_;
};

/// Pictures of the scene with each material: linear radiance and coverage, as from other renderers. Errors: as
/// above.
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Material> materials, int width, int height,
                                         int samples = 4);

/// Pictures of the scene with each of the maps. Requires a mesh with texture coordinates.
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const RasterMap> maps, int width, int height,
                                         int samples = 4);

/// A material, and the proposal from which its light is sampled.
template <typename M> struct Sampled {
    M material;
    Proposals proposal;
};
using SampledMaterial = Sampled<Material>;
using SampledMap = Sampled<RasterMap>;  ///< one proposal for all texels
struct EnvironmentOptions {
    int width = 640, height = 480;
    int samples = 64;  ///< per pixel, at least 1
    LightDraws draws = LightDraws::both;
    /// Called regularly with the completed fraction, 0..1.
    std::function<void(double)> progress;
};
/// Draws the scene under an environment, oriented by `environment_frame`, and the scene's lights. All light reaches
/// every point of a surface and is reflected once: pictures converge to those of `render_paths` without occlusion
/// and ground. Further errors: an environment larger than the library's textures.
Result<std::vector<Rendering>> rasterize(const Scene& scene, const Environment& environment,
                                         std::span<const SampledMaterial> materials, const EnvironmentOptions& options);
/// Requires a mesh with texture coordinates.
Result<std::vector<Rendering>> rasterize(const Scene& scene, const Environment& environment,
                                         std::span<const SampledMap> maps, const EnvironmentOptions& options);

}  // namespace srbf
