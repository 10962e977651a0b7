#include "extras/render/raster.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "base/half.h"
#include "brdf/directions.h"
#include "extras/render/offscreen.h"

namespace SRBF_NAMESPACE {
namespace {

Error gl_error(std::string what, std::string expected, std::string found) {
    return {"raster", {}, std::move(what), std::move(expected), std::move(found)};
}

std::string log_of(GLuint id, decltype(glGetShaderInfoLog) read) {
    std::string log(1000, '\0');
    GLsizei length = 0;
    read(id, GLsizei(log.size()), &length, log.data());
    log.resize(std::size_t(length));
    std::replace(log.begin(), log.end(), '\n', ' ');
    return log;
}

Result<GlObject> compile(GLenum stage, const std::string& text) {
    GlObject shader(glCreateShader(stage), [](unsigned id) { glDeleteShader(id); });
    const char* const lines = text.c_str();
    glShaderSource(shader.id(), 1, &lines, nullptr);
    glCompileShader(shader.id());
    GLint is_compiled = 0;
    glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &is_compiled);
    if (!is_compiled) return gl_error("shader", "a text that compiles", log_of(shader.id(), glGetShaderInfoLog));
    return shader;
}

int gl_integer(unsigned name) {
    GLint number = 0;
    glGetIntegerv(name, &number);
    return number;
}

/// A buffer, bound to its target.
GlObject new_buffer(GLenum target, const void* data, std::size_t bytes, GLenum usage) {
    GLuint id = 0;
    glGenBuffers(1, &id);
    glBindBuffer(target, id);
    glBufferData(target, GLsizeiptr(bytes), data, usage);
    return {id, [](unsigned buffer) { glDeleteBuffers(1, &buffer); }};
}

/// A vertex array; it is not bound.
GlObject new_array() {
    GLuint id = 0;
    glGenVertexArrays(1, &id);
    return {id, [](unsigned array) { glDeleteVertexArrays(1, &array); }};
}

/// A texture without texels, clamped to its edges, of one level, bound to its target.
GlObject new_texture(GLenum target, GLenum filter) {
    GLuint id = 0;
    glGenTextures(1, &id);
    glBindTexture(target, id);
    for (const GLenum side : {GLenum(GL_TEXTURE_MIN_FILTER), GLenum(GL_TEXTURE_MAG_FILTER)})
        glTexParameteri(target, side, GLint(filter));
    for (const GLenum axis : {GLenum(GL_TEXTURE_WRAP_S), GLenum(GL_TEXTURE_WRAP_T), GLenum(GL_TEXTURE_WRAP_R)})
        glTexParameteri(target, axis, GL_CLAMP_TO_EDGE);
    glTexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
    return {id, [](unsigned texture) { glDeleteTextures(1, &texture); }};
}

/// A new program, which is not yet in use. Returns an error if OpenGL's compiler rejects the text.
Result<GlObject> new_program(const ShaderText& text) {
    const auto vertex = compile(GL_VERTEX_SHADER, text.vertex);
    if (!vertex) return vertex.error();
    const auto fragment = compile(GL_FRAGMENT_SHADER, text.fragment);
    if (!fragment) return fragment.error();
    GlObject program(glCreateProgram(), [](unsigned id) { glDeleteProgram(id); });
    glAttachShader(program.id(), vertex->id());
    glAttachShader(program.id(), fragment->id());
    glLinkProgram(program.id());
    GLint is_linked = 0;
    glGetProgramiv(program.id(), GL_LINK_STATUS, &is_linked);
    if (!is_linked) return gl_error("shader", "a text that links", log_of(program.id(), glGetProgramInfoLog));
    return program;
}

void bind_texture(std::size_t unit, GLenum target, const GlObject& texture) {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(target, texture.id());
}

/// Returns an error if `size` exceeds this limit of OpenGL.
Result<Done> check_gl_size(const char* what, std::uint64_t size, GLenum limit) {
    if (size <= std::uint64_t(gl_integer(limit))) return Done{};
    return gl_error(what, fmt::format("at most {} here", gl_integer(limit)), std::to_string(size));
}

/// The transform from x, y, z, w to OpenGL's clip coordinates, column-major.
std::array<float, 16> to_clip(const RasterView& view, const Bounds& box) {
    const Camera& camera = view.camera;
    const Frame axes = frame(camera);
    double near = HUGE_VAL, far = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p{corner & 1 ? box.min.x : box.max.x, corner & 2 ? box.min.y : box.max.y,
                      corner & 4 ? box.min.z : box.max.z};
        const double depth = -dot(p - camera.eye, axes.z);
        near = std::min(near, depth);
        far = std::max(far, depth);
    }
    far = std::max(far * 1.01, 1e-30);
    near = std::max(near * 0.99, far * 1e-4);
    const double half = std::tan(camera.fov / 2);
    const double scale_z = (near + far) / (near - far), shift_z = 2 * near * far / (near - far);
    // Rows of the matrix, to be multiplied by (p − eye): x, y, z' and −z.
    const std::array<Vec3d, 4> rows{1 / (half * view.aspect) * axes.x, 1 / half * axes.y, scale_z * axes.z,
                                    -1.0 * axes.z};
    std::array<float, 16> columns{};
    for (std::size_t r = 0; r < 4; ++r) {
        columns[r] = float(rows[r].x);
        columns[4 + r] = float(rows[r].y);
        columns[8 + r] = float(rows[r].z);
        columns[12 + r] = float((r == 2 ? shift_z : 0) - dot(rows[r], camera.eye));
    }
    return columns;
}

/// Returns an error if a material's numbers exceed the limits of OpenGL. Materials without an overload have few
/// numbers.
template <typename Other> Result<Done> check_limits(const Other&) { return Done{}; }
Result<Done> check_limits(const BsdfTables& tables) {
    const auto [h, d, p] = size_of(tables);
    return check_gl_size("nodes of a table along an axis", std::max({std::size_t(d), std::size_t(p), k_parts * h}),
                         GL_MAX_3D_TEXTURE_SIZE);
}
Result<Done> check_limits(const MerlTable& table) {
    return check_gl_size("nodes of a table along an axis", *std::ranges::max_element(table.size),
                         GL_MAX_3D_TEXTURE_SIZE);
}
Result<Done> check_limits(const PmModel& model) {
    return check_gl_size("bytes of a model's uniform buffer", pm_numbers(model).size() * sizeof(Float4),
                         GL_MAX_UNIFORM_BLOCK_SIZE);
}
Result<Done> check_limits(const SuModel& model) {
    const bool is_cube = model.index && model.index->map == DirectionMap::cube;
    const auto views = check_gl_size("views of a model", model.direction.size(), GL_MAX_TEXTURE_SIZE);
    if (!views || !model.index) return views;
    return check_gl_size("texels of an index texture along a side", std::uint64_t(model.index->size),
                         is_cube ? GL_MAX_CUBE_MAP_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE);
}

GlObject renderbuffer(GLenum format, int width, int height, int samples) {
    GLuint id = 0;
    glGenRenderbuffers(1, &id);
    glBindRenderbuffer(GL_RENDERBUFFER, id);
    if (samples > 1)
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    else
        glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
    return {id, [](unsigned buffer) { glDeleteRenderbuffers(1, &buffer); }};
}

GlObject framebuffer(const GlObject& colour, bool is_texture, const GlObject* depth) {
    GLuint id = 0;
    glGenFramebuffers(1, &id);
    glBindFramebuffer(GL_FRAMEBUFFER, id);
    if (is_texture)
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour.id(), 0);
    else
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour.id());
    if (depth) glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth->id());
    return {id, [](unsigned buffer) { glDeleteFramebuffers(1, &buffer); }};
}

Result<Done> check_picture(int width, int height, bool floats) {
    const int max_size = gl_integer(GL_MAX_RENDERBUFFER_SIZE);
    if (std::max(width, height) > max_size)
        return gl_error("picture", fmt::format("at most {} pixels along a side here", max_size),
                        fmt::format("{} x {}", width, height));
    if (floats && !epoxy_is_desktop_gl() && !epoxy_has_gl_extension("GL_EXT_color_buffer_float"))
        return gl_error("pictures of floats", "GL_EXT_color_buffer_float", "OpenGL ES without it");
    return Done{};
}

/// True if the bound framebuffer can be drawn into.
Result<Done> check_framebuffer(int width, int height) {
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && glGetError() != GL_OUT_OF_MEMORY)
        return Done{};
    return gl_error("picture", "memory and a format that can be drawn", fmt::format("{} x {}", width, height));
}

/// The floats of colour buffer `colour` of the read framebuffer, rows from the top.
std::vector<Float4> read_colour(GLenum colour, int columns, int rows) {
    const auto width = std::size_t(columns), height = std::size_t(rows);
    std::vector<Float4> pixels(width * height);
    glReadBuffer(colour);
    glReadPixels(0, 0, columns, rows, GL_RGBA, GL_FLOAT, pixels.data());
    for (std::size_t y = 0; y < height / 2; ++y)  // OpenGL's rows start at the bottom
        std::swap_ranges(&pixels[y * width], &pixels[y * width] + width, &pixels[(height - 1 - y) * width]);
    return pixels;
}

int max_samples(GLenum format) {
    GLint count = 0, samples = 1;
    glGetInternalformativ(GL_RENDERBUFFER, format, GL_NUM_SAMPLE_COUNTS, 1, &count);
    if (count > 0) glGetInternalformativ(GL_RENDERBUFFER, format, GL_SAMPLES, 1, &samples);
    return samples;
}

}  // namespace

RasterMesh::RasterMesh(const Mesh& mesh) : bounds_(srbf::bounds(mesh)), corners_(int(3 * mesh.triangles.size())) {
    assert(mesh.normals.size() == mesh.positions.size());
    array_ = new_array();
    glBindVertexArray(array_.id());
    std::vector<std::array<Vec3f, 2>> vertices(mesh.positions.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = {mesh.positions[i], mesh.normals[i]};
    constexpr GLsizei stride = sizeof vertices[0];
    vertices_ = new_buffer(GL_ARRAY_BUFFER, vertices.data(), vertices.size() * stride, GL_STATIC_DRAW);
    for (const GLuint attribute : {0u, 1u}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, stride,
                              reinterpret_cast<const void*>(attribute * sizeof(Vec3f)));
    }
    triangles_ = new_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle),
                            GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void RasterMesh::draw(const GlObject& program, const RasterView& view) const {
    glUniformMatrix4fv(glGetUniformLocation(program.id(), "to_clip"), 1, GL_FALSE, to_clip(view, bounds_).data());
    glEnable(GL_DEPTH_TEST);
    if (!view.back_faces) glEnable(GL_CULL_FACE);
    glBindVertexArray(array_.id());
    glDrawElements(GL_TRIANGLES, corners_, GL_UNSIGNED_INT, nullptr);
    glBindVertexArray(0);
    glDisable(GL_CULL_FACE);
}

void RasterMaterial::add_texture(const char* sampler, Texture texture) {
    glUniform1i(glGetUniformLocation(program_.id(), sampler), GLint(textures_.size()));
    textures_.push_back(std::move(texture));
}

void RasterMaterial::load(const MerlTable& table) { load_table(table.size, merl_texels(table)); }
void RasterMaterial::load(const BsdfTables& tables) {
    const auto [h, d, p] = size_of(tables);
    load_table({std::uint32_t(k_parts) * h, d, p}, merl_texels(tables));
}
void RasterMaterial::load_table(std::array<std::uint32_t, 3> size, std::vector<Float4> texels) {
    const auto [h, d, p] = size;
    // Linear interpolation of 32-bit floats is an extension in OpenGL ES.
    const bool has_float_filter = epoxy_is_desktop_gl() || epoxy_has_gl_extension("GL_OES_texture_float_linear");
    if (!has_float_filter)
        for (Float4& texel : texels)
            for (float& x : texel) x = std::min(x, k_half_max);
    Texture texture{new_texture(GL_TEXTURE_3D, GL_LINEAR), GL_TEXTURE_3D};
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexImage3D(GL_TEXTURE_3D, 0, has_float_filter ? GL_RGBA32F : GL_RGBA16F, GLsizei(p), GLsizei(d), GLsizei(h), 0,
                 GL_RGBA, GL_FLOAT, texels.data());
    add_texture("merl_table", std::move(texture));
    data_bytes_ = texels.size() * (has_float_filter ? 16 : 8);
}

void RasterMaterial::load(const PmModel& model) {
    const auto numbers = pm_numbers(model);
    data_bytes_ = numbers.size() * sizeof(Float4);
    numbers_ = new_buffer(GL_UNIFORM_BUFFER, numbers.data(), data_bytes_, GL_STATIC_DRAW);
    glUniformBlockBinding(program_.id(), glGetUniformBlockIndex(program_.id(), "PmNumbers"), 0);
}

void RasterMaterial::load(const Uniform& uniform) {
    if (uniform.numbers.empty()) return;
    data_bytes_ = uniform.numbers.size() * sizeof(Float4);
    glUniform4fv(glGetUniformLocation(program_.id(), uniform.name.c_str()), GLsizei(uniform.numbers.size()),
                 uniform.numbers[0].data());
}

void RasterMaterial::load(const SuModel& model) {
    const auto n = GLsizei(model.direction.size()), width = GLsizei(2 * model.lobes);
    const SuTexels texels = su_texels(model);
    Texture numbers{new_texture(GL_TEXTURE_2D, GL_NEAREST), GL_TEXTURE_2D};
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, width, n, 0, GL_RGBA, GL_HALF_FLOAT, texels.numbers.data());
    add_texture("su_numbers", std::move(numbers));
    data_bytes_ = 8 * texels.numbers.size();
    Texture directions{new_texture(GL_TEXTURE_2D, GL_NEAREST), GL_TEXTURE_2D};
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 1, n, 0, GL_RGBA, GL_FLOAT, texels.directions.data());
    add_texture("su_directions", std::move(directions));
    auxiliary_bytes_ = sizeof(Float4) * texels.directions.size();
    if (model.interpolation == SuInterpolation::rotated) return;

    const IndexTexture index = model.index ? *model.index : index_texture(model, DirectionMap::cube);
    const bool is_cube = index.map == DirectionMap::cube;
    const GLenum target = is_cube ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D;
    Texture texture{new_texture(target, GL_NEAREST), target};
    const std::size_t face = std::size_t(index.size) * std::size_t(index.size);
    for (std::size_t i = 0; i < (is_cube ? 6 : 1); ++i)
        glTexImage2D(is_cube ? GL_TEXTURE_CUBE_MAP_POSITIVE_X + GLenum(i) : GL_TEXTURE_2D, 0, GL_RGBA32UI, index.size,
                     index.size, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, &index.texels[i * face]);
    add_texture("su_index", std::move(texture));
    auxiliary_bytes_ += index.texels.size() * sizeof index.texels[0];
}

Result<RasterMaterial> RasterMaterial::make(const Material& material, const ShaderOptions& options) {
    const auto fits = std::visit([](const auto& content) { return check_limits(content); }, material);
    if (!fits) return fits.error();
    auto program = new_program(shader_text(material, options));
    if (!program) return program.error();
    RasterMaterial result(*std::move(program));
    result.no_array_ = new_array();
    glUseProgram(result.program_.id());
    std::visit([&](const auto& content) { result.load(content); }, material);
    return result;
}

void RasterMaterial::use(const RasterView& view) const {
    glUseProgram(program_.id());
    const auto place = [&](const char* uniform) { return glGetUniformLocation(program_.id(), uniform); };
    const Vec3f eye = to_float(view.camera.eye);
    glUniform3f(place("eye"), eye.x, eye.y, eye.z);
    glUniform1f(place("exposure"), view.exposure);
    std::vector<Vec3f> directions;
    std::vector<Rgb> irradiances;
    for (const DirectionalLight& light : view.lights) {
        directions.push_back(to_float(light.towards));
        irradiances.push_back(light.irradiance);
    }
    if (!directions.empty()) {
        glUniform3fv(place("light_direction"), GLsizei(directions.size()), &directions[0].x);
        glUniform3fv(place("light_irradiance"), GLsizei(irradiances.size()), &irradiances[0].r);
    }
    for (std::size_t unit = 0; unit < textures_.size(); ++unit)
        bind_texture(unit, textures_[unit].target, textures_[unit].object);
    if (numbers_.id() != 0) glBindBufferBase(GL_UNIFORM_BUFFER, 0, numbers_.id());
}

void RasterMaterial::draw(const RasterMesh& mesh, const RasterView& view) const {
    use(view);
    mesh.draw(program_, view);
}

void RasterMaterial::draw(const RasterSurface& surface, const RasterView& view) const {
    use(view);
    std::size_t unit = textures_.size();
    for (const auto& [sampler, texture] :
         {std::pair("surface_positions", &surface.positions_), {"surface_normals", &surface.normals_}}) {
        glUniform1i(glGetUniformLocation(program_.id(), sampler), GLint(unit));
        bind_texture(unit++, GL_TEXTURE_2D, *texture);
    }
    // The triangle lies at the far plane; the surface is where the depth is less.
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
}

Result<RasterTarget> RasterTarget::make_for(const RasterSurface& surface) {
    auto target = make(surface.width_, surface.height_, 1, Format::bytes);
    if (!target) return target;
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer_.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, surface.depth_.id());
    target->depth_ = {};
    if (auto complete = check_framebuffer(target->width_, target->height_); !complete) return complete.error();
    return target;
}

Result<RasterTarget> RasterTarget::make(int width, int height, int samples, Format format) {
    assert(width >= 1 && height >= 1 && samples >= 1);
    if (auto fits = check_picture(width, height, format == Format::floats); !fits) return fits.error();
    GLenum pixel_format = GL_RGBA8;
    if (format == Format::floats) pixel_format = max_samples(GL_RGBA32F) >= samples ? GL_RGBA32F : GL_RGBA16F;

    RasterTarget target;
    target.width_ = width;
    target.height_ = height;
    target.format_ = format;
    target.samples_ = std::clamp(max_samples(pixel_format), 1, samples);
    const bool is_texture = target.samples_ == 1;
    if (is_texture) {
        target.colour_ = new_texture(GL_TEXTURE_2D, GL_LINEAR);
        glTexImage2D(GL_TEXTURE_2D, 0, GLint(pixel_format), width, height, 0, GL_RGBA,
                     format == Format::floats ? GL_FLOAT : GL_UNSIGNED_BYTE, nullptr);
    } else {
        target.colour_ = renderbuffer(pixel_format, width, height, target.samples_);
    }
    target.depth_ = renderbuffer(GL_DEPTH_COMPONENT24, width, height, target.samples_);
    if (target.samples_ > 1) {
        target.resolved_colour_ = renderbuffer(pixel_format, width, height, 1);
        target.resolved_ = framebuffer(target.resolved_colour_, false, nullptr);
    }
    target.framebuffer_ = framebuffer(target.colour_, is_texture, &target.depth_);
    if (auto complete = check_framebuffer(width, height); !complete) return complete.error();
    return target;
}

void RasterTarget::begin() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, width_, height_);
    const float grey = format_ == Format::bytes ? float(srgb_encoded(double(k_background))) : 0;
    glClearColor(grey, grey, grey, 0);
    glClear(depth_.id() != 0 ? GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT);
}

void RasterTarget::resolve() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    if (samples_ == 1) return;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.id());
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_.id());
}

std::vector<Float4> RasterTarget::read_floats() const {
    assert(format_ == Format::floats);
    resolve();
    return read_colour(GL_COLOR_ATTACHMENT0, width_, height_);
}

Image8 RasterTarget::read_bytes() const {
    assert(format_ == Format::bytes);
    resolve();
    std::vector<std::array<std::uint8_t, 4>> pixels(std::size_t(width_) * std::size_t(height_));
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    Image8 image(width_, height_);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const auto& pixel = pixels[std::size_t(height_ - 1 - y) * std::size_t(width_) + std::size_t(x)];
            image.at(x, y) = {pixel[0], pixel[1], pixel[2]};
        }
    return image;
}

Result<RasterSurface> RasterSurface::make(Dialect dialect, int width, int height) {
    assert(width >= 1 && height >= 1);
    if (auto fits = check_picture(width, height, true); !fits) return fits.error();
    auto program = new_program(surface_shader_text(dialect));
    if (!program) return program.error();
    RasterSurface surface;
    surface.width_ = width;
    surface.height_ = height;
    surface.program_ = *std::move(program);
    const auto texture = [&] {
        GlObject made = new_texture(GL_TEXTURE_2D, GL_NEAREST);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
        return made;
    };
    surface.positions_ = texture();
    surface.normals_ = texture();
    surface.depth_ = renderbuffer(GL_DEPTH_COMPONENT24, width, height, 1);
    surface.framebuffer_ = framebuffer(surface.positions_, true, &surface.depth_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, surface.normals_.id(), 0);
    constexpr std::array<GLenum, 2> colours{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glDrawBuffers(2, colours.data());
    if (auto complete = check_framebuffer(width, height); !complete) return complete.error();
    return surface;
}

void RasterSurface::draw(const RasterMesh& mesh, const RasterView& view) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, width_, height_);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program_.id());
    mesh.draw(program_, view);
}

std::vector<Float4> RasterSurface::read(unsigned colour) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    return read_colour(GL_COLOR_ATTACHMENT0 + colour, width_, height_);
}

Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Material> materials, int width, int height,
                                         int samples) {
    const auto context = OffscreenContext::make();
    if (!context) return context.error();
    const auto target = RasterTarget::make(width, height, samples, RasterTarget::Format::floats);
    if (!target) return target.error();
    const RasterMesh mesh(scene.mesh);
    const RasterView view{scene.camera, double(width) / height, scene.lights};
    std::vector<Rendering> renderings;
    for (const Material& shown : materials) {
        const auto material = RasterMaterial::make(shown, {.dialect = context->dialect(),
                                                           .output = PixelOutput::radiance,
                                                           .lights = std::max(1, int(scene.lights.size()))});
        if (!material) return material.error();
        target->begin();
        material->draw(mesh, view);
        Rendering& rendering = renderings.emplace_back(Rendering{Image(width, height), {}});
        for (const Float4& pixel : target->read_floats()) {
            const std::size_t i = rendering.coverage.size();
            rendering.coverage.push_back(pixel[3]);
            if (pixel[3] > 0)
                rendering.radiance.pixels[i] = {pixel[0] / pixel[3], pixel[1] / pixel[3], pixel[2] / pixel[3]};
        }
    }
    return renderings;
}

}  // namespace
