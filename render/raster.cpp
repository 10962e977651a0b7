#include "render/raster.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "render/offscreen.h"
#include "srbf/half.h"
#include "src/r_sequence.h"

namespace srbf {
namespace {

Error missing(std::string what, std::string expected, std::string found = {}) {
    return {"raster", {}, std::move(what), std::move(expected), std::move(found)};
}

int integer(GLenum of) {
    GLint number = 0;
    glGetIntegerv(of, &number);
    return number;
}

GlObject buffer_of(GLenum target, const void* data, std::size_t bytes, GLenum usage) {
    GLuint id = 0;
    glGenBuffers(1, &id);
    glBindBuffer(target, id);
    glBufferData(target, GLsizeiptr(bytes), data, usage);
    return {id, [](unsigned buffer) { glDeleteBuffers(1, &buffer); }};
}

GlObject new_array() {
    GLuint id = 0;
    glGenVertexArrays(1, &id);
    return {id, [](unsigned array) { glDeleteVertexArrays(1, &array); }};
}

}  // namespace

// ---- Meshes ------------------------------------------------------------------------------------------------------

RasterMesh::RasterMesh(const Mesh& mesh) : bounds_(srbf::bounds(mesh)), corners_(int(3 * mesh.triangles.size())) {
    assert(mesh.normals.size() == mesh.positions.size());
    array_ = new_array();
    glBindVertexArray(array_.id());
    std::vector<std::array<Vec3f, 2>> vertices(mesh.positions.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = {mesh.positions[i], mesh.normals[i]};
    constexpr GLsizei stride = sizeof vertices[0];
    vertices_ = buffer_of(GL_ARRAY_BUFFER, vertices.data(), vertices.size() * stride, GL_STATIC_DRAW);
    for (const GLuint attribute : {0u, 1u}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, stride,
                              reinterpret_cast<const void*>(attribute * sizeof(Vec3f)));
    }
    triangles_ = buffer_of(GL_ELEMENT_ARRAY_BUFFER, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle),
                           GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void RasterMesh::draw() const {
    glBindVertexArray(array_.id());
    glDrawElements(GL_TRIANGLES, corners_, GL_UNSIGNED_INT, nullptr);
    glBindVertexArray(0);
}

// ---- Materials ---------------------------------------------------------------------------------------------------

namespace {

std::string log_of(GLuint id, decltype(glGetShaderInfoLog) read) {
    std::string log(1000, '\0');
    GLsizei length = 0;
    read(id, GLsizei(log.size()), &length, log.data());
    log.resize(std::size_t(length));
    std::replace(log.begin(), log.end(), '\n', ' ');
    return log;
}

Result<GlObject> compiled(GLenum stage, const std::string& text) {
    GlObject shader(glCreateShader(stage), [](unsigned id) { glDeleteShader(id); });
    const char* const lines = text.c_str();
    glShaderSource(shader.id(), 1, &lines, nullptr);
    glCompileShader(shader.id());
    GLint is_compiled = 0;
    glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &is_compiled);
    if (!is_compiled) return missing("shader", "a text that compiles", log_of(shader.id(), glGetShaderInfoLog));
    return shader;
}

Result<GlObject> linked(const ShaderText& text) {
    const auto vertex = compiled(GL_VERTEX_SHADER, text.vertex);
    if (!vertex) return vertex.error();
    const auto fragment = compiled(GL_FRAGMENT_SHADER, text.fragment);
    if (!fragment) return fragment.error();
    GlObject program(glCreateProgram(), [](unsigned id) { glDeleteProgram(id); });
    glAttachShader(program.id(), vertex->id());
    glAttachShader(program.id(), fragment->id());
    glLinkProgram(program.id());
    GLint is_linked = 0;
    glGetProgramiv(program.id(), GL_LINK_STATUS, &is_linked);
    if (!is_linked) return missing("shader", "a text that links", log_of(program.id(), glGetProgramInfoLog));
    return program;
}

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

Result<Done> check_size(const char* what, std::uint64_t size, GLenum limit) {
    if (size <= std::uint64_t(integer(limit))) return Done{};
    return missing(what, fmt::format("at most {} here", integer(limit)), std::to_string(size));
}
/// Whether a material's numbers fit the limits of the library.
Result<Done> check_limits(const Flat&) { return Done{}; }
Result<Done> check_limits(const GgxModel&) { return Done{}; }
Result<Done> check_limits(const BsdfModel&) { return Done{}; }
Result<Done> check_limits(const BsdfTables& tables) {
    const auto [h, d, p] = size_of(tables);
    return check_size("nodes of a table along an axis", std::max({std::size_t(d), std::size_t(p), k_parts * h}),
                      GL_MAX_3D_TEXTURE_SIZE);
}
Result<Done> check_limits(const MerlTable& table) {
    return check_size("nodes of a table along an axis", *std::ranges::max_element(table.size), GL_MAX_3D_TEXTURE_SIZE);
}
Result<Done> check_limits(const PmModel& model) {
    return check_size("bytes of a model's uniform buffer", pm_numbers(model).size() * sizeof(Float4),
                      GL_MAX_UNIFORM_BLOCK_SIZE);
}
Result<Done> check_limits(const SuModel& model) {
    const bool is_cube = model.index && model.index->map == DirectionMap::cube;
    const auto views = check_size("views of a model", model.direction.size(), GL_MAX_TEXTURE_SIZE);
    if (!views || !model.index) return views;
    return check_size("texels of an index texture along a side", std::uint64_t(model.index->size),
                      is_cube ? GL_MAX_CUBE_MAP_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE);
}

/// The transform from x, y, z, w to OpenGL's clip coordinates, column-major.
std::array<float, 16> to_clip(const RasterView& view, const Bounds& box) {
    const Camera& camera = view.camera;
    const Frame axes = frame(camera);
    double near = HUGE_VAL, far = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p{corner & 1 ? box.least.x : box.most.x, corner & 2 ? box.least.y : box.most.y,
                      corner & 4 ? box.least.z : box.most.z};
        const double depth = -dot(p - camera.eye, axes.z);
        near = std::min(near, depth), far = std::max(far, depth);
    }
    far = std::max(far * 1.01, 1e-30);
    near = std::max(near * 0.99, far * 1e-4);
    const double half = std::tan(camera.fov / 2);
    const double scale_z = (near + far) / (near - far), shift_z = 2 * near * far / (near - far);
    // Rows of the matrix times (p − eye): x, y, z' and −z.
    const std::array<Vec3d, 4> rows{1 / (half * view.aspect) * axes.x + 2 * view.shift[0] * axes.z,
                                    1 / half * axes.y + 2 * view.shift[1] * axes.z, scale_z * axes.z, -1.0 * axes.z};
    std::array<float, 16> columns{};
    for (std::size_t r = 0; r < 4; ++r) {
        columns[r] = float(rows[r].x), columns[4 + r] = float(rows[r].y), columns[8 + r] = float(rows[r].z);
        columns[12 + r] = float((r == 2 ? shift_z : 0) - dot(rows[r], camera.eye));
    }
    return columns;
}

void bind_texture(std::size_t unit, GLenum target, const GlObject& texture) {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(target, texture.id());
}

/// A texture of `levels` mip levels, to be filled.
GlObject new_mip_texture(int levels) {
    GlObject texture = new_texture(GL_TEXTURE_2D, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, levels - 1);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    return texture;
}

/// Uses the current program, `program`.
void draw_mesh(const GlObject& program, const RasterMesh& mesh, const RasterView& view) {
    glUniformMatrix4fv(glGetUniformLocation(program.id(), "to_clip"), 1, GL_FALSE, to_clip(view, mesh.bounds()).data());
    glEnable(GL_DEPTH_TEST);
    if (!view.back_faces) glEnable(GL_CULL_FACE);
    mesh.draw();
    glDisable(GL_CULL_FACE);
}

}  // namespace

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
    const bool is_fine = epoxy_is_desktop_gl() || epoxy_has_gl_extension("GL_OES_texture_float_linear");
    if (!is_fine)
        for (Float4& texel : texels)
            for (float& x : texel) x = std::min(x, k_half_max);
    Texture texture{new_texture(GL_TEXTURE_3D, GL_LINEAR), GL_TEXTURE_3D};
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexImage3D(GL_TEXTURE_3D, 0, is_fine ? GL_RGBA32F : GL_RGBA16F, GLsizei(p), GLsizei(d), GLsizei(h), 0, GL_RGBA,
                 GL_FLOAT, texels.data());
    add_texture("merl_table", std::move(texture));
    data_bytes_ = texels.size() * (is_fine ? 16 : 8);
}

void RasterMaterial::load(const PmModel& model) {
    const auto numbers = pm_numbers(model, is_open_);
    data_bytes_ = numbers.size() * sizeof(Float4);
    numbers_ = buffer_of(GL_UNIFORM_BUFFER, numbers.data(), data_bytes_, GL_DYNAMIC_DRAW);
    glUniformBlockBinding(program_.id(), glGetUniformBlockIndex(program_.id(), "PmNumbers"), 0);
}

void RasterMaterial::load(const GgxModel& model) {
    const auto numbers = ggx_numbers(model);
    data_bytes_ = sizeof numbers;
    glUniform4fv(glGetUniformLocation(program_.id(), "ggx_numbers"), GLsizei(numbers.size()), numbers[0].data());
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
    const auto fits = std::visit([](const auto& of) { return check_limits(of); }, material);
    if (!fits) return fits.error();
    auto program = linked(shader_text(material, options));
    if (!program) return program.error();
    RasterMaterial made(*std::move(program));
    made.no_array_ = new_array();
    made.is_open_ = options.open;
    glUseProgram(made.program_.id());
    std::visit([&](const auto& of) { made.load(of); }, material);
    return made;
}

void RasterMaterial::update(const PmModel& model) {
    const auto numbers = pm_numbers(model, is_open_);
    assert(numbers.size() * sizeof(Float4) == data_bytes_);
    glBindBuffer(GL_UNIFORM_BUFFER, numbers_.id());
    glBufferSubData(GL_UNIFORM_BUFFER, 0, GLsizeiptr(data_bytes_), numbers.data());
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
    draw_mesh(program_, mesh, view);
}

void RasterMaterial::draw_whole(std::initializer_list<std::pair<const char*, const GlObject*>> textures) const {
    std::size_t unit = textures_.size();
    for (const auto& [sampler, texture] : textures) {
        glUniform1i(glGetUniformLocation(program_.id(), sampler), GLint(unit));
        bind_texture(unit++, GL_TEXTURE_2D, *texture);
    }
    glDepthMask(GL_FALSE);
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthMask(GL_TRUE);
    glBindVertexArray(0);
}

void RasterMaterial::draw(const RasterSurface& surface, const RasterView& view) const {
    use(view);
    // The triangle lies at the far plane: the surface is where the depth is less.
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    draw_whole({{"surface_positions", &surface.positions_}, {"surface_normals", &surface.normals_}});
    glDepthFunc(GL_LESS);
}

void RasterMaterial::set_proposal(const Proposals& proposals) {
    const ProposalNumbers numbers = proposal_numbers(proposals);
    glUseProgram(program_.id());
    glUniform4fv(glGetUniformLocation(program_.id(), "mixture_numbers"), GLsizei(numbers.nodes.size() / 4),
                 numbers.nodes.data());
    glUniform2fv(glGetUniformLocation(program_.id(), "mixture_grain"), GLsizei(numbers.grains.size()),
                 numbers.grains[0].data());
}

void RasterMaterial::draw(const RasterSurface& surface, const RasterView& view, const EnvironmentLight& light,
                          const RasterTarget& before, int index) const {
    use(view);
    const auto place = [&](const char* uniform) { return glGetUniformLocation(program_.id(), uniform); };
    const auto set_axes = [&](const char* uniform, Vec3d x, Vec3d y, Vec3d z, bool in_rows) {
        const std::array<Vec3f, 3> vectors{to_float(x), to_float(y), to_float(z)};
        std::array<float, 9> columns;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3f& w = vectors[in_rows ? k : i];
                const std::size_t of = in_rows ? i : k;
                columns[3 * i + k] = of == 0 ? w.x : of == 1 ? w.y : w.z;
            }
        glUniformMatrix3fv(place(uniform), 1, GL_FALSE, columns.data());
    };
    const RasterEnvironment& environment = *light.environment;
    const Frame camera = frame(view.camera);
    const double half = std::tan(view.camera.fov / 2);
    set_axes("into_environment", light.axes.x, light.axes.y, light.axes.z, true);
    set_axes("picture_axes", half * view.aspect * camera.x, half * camera.y, camera.z, false);
    glUniform1f(place("environment_scale"), environment.scale_);
    glUniform1f(place("share"), light.draws == LightDraws::filtered ? 1.f : 1 / float(index + 1));
    glUniform1i(place("sample_index"), index);
    glUniform1i(place("draws"), int(light.draws));
    glUniform2f(place("picture_size"), float(surface.width_), float(surface.height_));
    glUniform2f(place("shift"), float(view.shift[0] * surface.width_), float(view.shift[1] * surface.height_));
    glDisable(GL_DEPTH_TEST);
    draw_whole({{"surface_positions", &surface.positions_},
                {"surface_normals", &surface.normals_},
                {"before", &before.colour_},
                {"environment", &environment.radiance_},
                {"environment_columns", &environment.columns_},
                {"environment_rows", &environment.rows_}});
}

// ---- Environments ------------------------------------------------------------------------------------------------

Result<RasterEnvironment> RasterEnvironment::make(const Environment& of) {
    const Image& texels = of.texels();
    const auto fits = check_size("texels of an environment along a side",
                                 std::uint64_t(std::max(texels.width, texels.height)) + 1, GL_MAX_TEXTURE_SIZE);
    if (!fits) return fits.error();
    RasterEnvironment environment;
    float most = 0;
    for (const Rgb& texel : texels.pixels) most = std::max({most, texel.r, texel.g, texel.b});
    environment.scale_ = std::max(1.f, most / k_half_max);
    const int levels = std::bit_width(unsigned(std::max(texels.width, texels.height)));
    environment.radiance_ = new_mip_texture(levels);
    Image level = texels;
    for (int k = 0; k < levels; ++k) {
        if (k > 0) level = halved(level);
        std::vector<std::array<std::uint16_t, 4>> halves(level.pixels.size());
        for (std::size_t i = 0; i < halves.size(); ++i)
            for (int c = 0; c < 3; ++c) halves[i][std::size_t(c)] = to_half(level.pixels[i][c] / environment.scale_);
        glTexImage2D(GL_TEXTURE_2D, k, GL_RGBA16F, level.width, level.height, 0, GL_RGBA, GL_HALF_FLOAT, halves.data());
    }
    const auto sums = [](std::span<const float> numbers, int width, int height) {
        GlObject texture = new_texture(GL_TEXTURE_2D, GL_NEAREST);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, width, height, 0, GL_RED, GL_FLOAT, numbers.data());
        return texture;
    };
    environment.columns_ = sums(of.columns(), texels.width + 1, texels.height);
    environment.rows_ = sums(of.rows(), texels.height + 1, 1);
    if (glGetError() == GL_OUT_OF_MEMORY)
        return missing("environment", "memory of the graphics library",
                       fmt::format("{} x {} texels", texels.width, texels.height));
    return environment;
}

// ---- Framebuffers ------------------------------------------------------------------------------------------------

namespace {

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
    const int most = integer(GL_MAX_RENDERBUFFER_SIZE);
    if (std::max(width, height) > most)
        return missing("picture", fmt::format("at most {} pixels along a side here", most),
                       fmt::format("{} x {}", width, height));
    if (floats && !epoxy_is_desktop_gl() && !epoxy_has_gl_extension("GL_EXT_color_buffer_float"))
        return missing("pictures of floats", "GL_EXT_color_buffer_float", "OpenGL ES without it");
    return Done{};
}

/// Whether the bound framebuffer can be drawn into.
Result<Done> check_framebuffer(int width, int height) {
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && glGetError() != GL_OUT_OF_MEMORY)
        return Done{};
    return missing("picture", "memory and a format that can be drawn", fmt::format("{} x {}", width, height));
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

int most_samples(GLenum format) {
    GLint count = 0, most = 1;
    glGetInternalformativ(GL_RENDERBUFFER, format, GL_NUM_SAMPLE_COUNTS, 1, &count);
    if (count > 0) glGetInternalformativ(GL_RENDERBUFFER, format, GL_SAMPLES, 1, &most);
    return most;
}

}  // namespace

Result<RasterTarget> RasterTarget::make_for(const RasterSurface& surface, Format format) {
    auto target = make(surface.width_, surface.height_, 1, format);
    if (!target || surface.along_ > 1) return target;
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer_.id());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, surface.depth_.id());
    target->depth_ = {};
    if (auto complete = check_framebuffer(target->width_, target->height_); !complete) return complete.error();
    return target;
}

Result<RasterTarget> RasterTarget::make(int width, int height, int samples, Format format) {
    assert(width >= 1 && height >= 1 && samples >= 1);
    if (auto fits = check_picture(width, height, format == Format::floats); !fits) return fits.error();
    GLenum of_pixel = GL_RGBA8;
    if (format == Format::floats) of_pixel = most_samples(GL_RGBA32F) >= samples ? GL_RGBA32F : GL_RGBA16F;

    RasterTarget target;
    target.width_ = width, target.height_ = height, target.format_ = format;
    target.samples_ = std::clamp(most_samples(of_pixel), 1, samples);
    const bool is_texture = target.samples_ == 1;
    if (is_texture) {
        target.colour_ = new_texture(GL_TEXTURE_2D, GL_LINEAR);
        glTexImage2D(GL_TEXTURE_2D, 0, GLint(of_pixel), width, height, 0, GL_RGBA,
                     format == Format::floats ? GL_FLOAT : GL_UNSIGNED_BYTE, nullptr);
    } else {
        target.colour_ = renderbuffer(of_pixel, width, height, target.samples_);
    }
    target.depth_ = renderbuffer(GL_DEPTH_COMPONENT24, width, height, target.samples_);
    if (target.samples_ > 1) {
        target.resolved_colour_ = renderbuffer(of_pixel, width, height, 1);
        target.resolved_ = framebuffer(target.resolved_colour_, false, nullptr);
    }
    target.framebuffer_ = framebuffer(target.colour_, is_texture, &target.depth_);
    if (auto complete = check_framebuffer(width, height); !complete) return complete.error();
    return target;
}

void RasterTarget::begin() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, width_, height_);
    const float grey = format_ == Format::bytes ? srgb_encoded(k_background) : 0;
    glClearColor(grey, grey, grey, 0);
    glClear(depth_.id() != 0 ? GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT);
}

unsigned RasterTarget::texture() const {
    assert(samples_ == 1);
    return colour_.id();
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

Result<RasterSurface> RasterSurface::make(Dialect dialect, int picture_width, int picture_height, Points points) {
    assert(picture_width >= 1 && picture_height >= 1);
    const int width = int(points) * picture_width, height = int(points) * picture_height;
    if (auto fits = check_picture(width, height, true); !fits) return fits.error();
    auto program = linked(surface_shader_text(dialect));
    if (!program) return program.error();
    RasterSurface surface;
    surface.width_ = picture_width, surface.height_ = picture_height, surface.along_ = int(points);
    surface.program_ = *std::move(program);
    const int bound = integer(GL_FRAMEBUFFER_BINDING);
    GLuint id = 0;
    glGenFramebuffers(1, &id);
    surface.framebuffer_ = {id, [](unsigned buffer) { glDeleteFramebuffers(1, &buffer); }};
    glBindFramebuffer(GL_FRAMEBUFFER, id);
    std::array<GLenum, 2> colours{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    for (std::size_t i = 0; i < 2; ++i) {
        GlObject& texture = i == 0 ? surface.positions_ : surface.normals_;
        texture = new_texture(GL_TEXTURE_2D, GL_NEAREST);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
        glFramebufferTexture2D(GL_FRAMEBUFFER, colours[i], GL_TEXTURE_2D, texture.id(), 0);
    }
    glDrawBuffers(2, colours.data());
    surface.depth_ = renderbuffer(GL_DEPTH_COMPONENT24, width, height, 1);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, surface.depth_.id());
    const auto complete = check_framebuffer(width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, GLuint(bound));
    if (!complete) return complete.error();
    return surface;
}

void RasterSurface::draw(const RasterMesh& mesh, const RasterView& view) const {
    const GLint bound = integer(GL_DRAW_FRAMEBUFFER_BINDING);
    std::array<GLint, 4> viewport{};
    glGetIntegerv(GL_VIEWPORT, viewport.data());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, along_ * width_, along_ * height_);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program_.id());
    RasterView shifted = view;
    const std::array<int, 2> size{width_, height_};
    // The shift of all points: that point lies in the lower or the upper half of its pixel.
    for (std::size_t axis = 0; axis < 2 && along_ == 2; ++axis)
        shifted.shift[axis] -= (view.shift[axis] < 0 ? -0.25 : 0.25) / size[axis];
    draw_mesh(program_, mesh, shifted);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound));
    glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
}

std::vector<Float4> RasterSurface::read(unsigned colour) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    return read_colour(GL_COLOR_ATTACHMENT0 + colour, along_ * width_, along_ * height_);
}

// ---- Means of samples --------------------------------------------------------------------------------------------

Result<RasterMean> RasterMean::make(const RasterSurface& surface) {
    auto first = RasterTarget::make_for(surface, RasterTarget::Format::floats);
    if (!first) return first.error();
    auto second = RasterTarget::make_for(surface, RasterTarget::Format::floats);
    if (!second) return second.error();
    return RasterMean({*std::move(first), *std::move(second)});
}

void RasterMean::add(const RasterMaterial& material, const RasterSurface& surface, const RasterView& view,
                     const EnvironmentLight& light) {
    const RasterTarget& before = picture();
    const RasterTarget& after = targets_[std::size_t((samples_ + 1) % 2)];
    after.begin();
    material.draw(surface, view, light, before, samples_);
    ++samples_;
}

std::array<double, 2> sample_shift(int i, int width, int height) {
    const auto point = RSequence<2>().at(std::size_t(i));
    return {(point[0] - 0.5) / width, (point[1] - 0.5) / height};
}

// ---- Development -------------------------------------------------------------------------------------------------

Result<RasterDevelopment> RasterDevelopment::make(Dialect dialect) {
    auto program = linked(develop_shader_text(dialect));
    if (!program) return program.error();
    RasterDevelopment development;
    development.program_ = *std::move(program);
    development.no_array_ = new_array();
    return development;
}

void RasterDevelopment::draw(const RasterTarget& radiance, const RasterTarget& other, float exposure, float full_scale,
                             bool in_delta_e, float share) const {
    glUseProgram(program_.id());
    const auto place = [&](const char* uniform) { return glGetUniformLocation(program_.id(), uniform); };
    const auto set = [&](const char* uniform, Rgb c) { glUniform3f(place(uniform), c.r, c.g, c.b); };
    const float grey = srgb_encoded(k_background);
    set("background", {grey, grey, grey}), set("darker", k_darker), set("as_bright", k_equal),
        set("brighter", k_brighter);
    glUniform1f(place("exposure"), exposure);
    glUniform1f(place("full_scale"), full_scale);
    glUniform1i(place("in_delta_e"), in_delta_e);
    glUniform1f(place("share"), share);
    glUniform1i(place("radiance"), 0), glUniform1i(place("other"), 1);
    bind_texture(0, GL_TEXTURE_2D, radiance.colour_);
    bind_texture(1, GL_TEXTURE_2D, other.colour_);
    glDisable(GL_DEPTH_TEST);
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Material> materials, int width, int height,
                                         int samples) {
    const auto context = OffscreenContext::make();
    if (!context) return context.error();
    const auto target = RasterTarget::make(width, height, samples, RasterTarget::Format::floats);
    if (!target) return target.error();
    const RasterMesh mesh(scene.mesh);
    const RasterView view{scene.camera, double(width) / height, scene.lights, 1};
    std::vector<Rendering> renderings;
    for (const Material& of : materials) {
        const auto material = RasterMaterial::make(of, {.dialect = context->dialect(),
                                                        .output = PixelOutput::radiance,
                                                        .lights = std::max(1, int(scene.lights.size()))});
        if (!material) return material.error();
        target->begin();
        material->draw(mesh, view);
        Rendering& rendering = renderings.emplace_back(Rendering{Image(width, height), {}});
        rendering.coverage.reserve(rendering.radiance.pixels.size());
        std::size_t i = 0;
        for (const Float4& pixel : target->read_floats()) {
            rendering.coverage.push_back(pixel[3]);
            if (pixel[3] > 0)
                rendering.radiance.pixels[i] = {pixel[0] / pixel[3], pixel[1] / pixel[3], pixel[2] / pixel[3]};
            ++i;
        }
    }
    return renderings;
}

Result<std::vector<Rendering>> rasterize(const Scene& scene, const Environment& environment,
                                         std::span<const SampledMaterial> materials,
                                         const EnvironmentOptions& options) {
    const int width = options.width, height = options.height;
    const auto context = OffscreenContext::make();
    if (!context) return context.error();
    const Dialect dialect = context->dialect();
    const auto light = RasterEnvironment::make(environment);
    if (!light) return light.error();
    const auto surface = RasterSurface::make(dialect, width, height, RasterSurface::Points::four);
    if (!surface) return surface.error();
    std::vector<RasterMaterial> made;
    std::vector<RasterMean> means;
    for (const SampledMaterial& of : materials) {
        auto material = RasterMaterial::make(
            of.material, {.dialect = dialect, .lights = std::max(1, int(scene.lights.size())), .environment = true});
        if (!material) return material.error();
        material->set_proposal(of.proposal);
        made.push_back(*std::move(material));
        auto mean = RasterMean::make(*surface);
        if (!mean) return mean.error();
        means.push_back(*std::move(mean));
    }
    const RasterMesh mesh(scene.mesh);
    for (int i = 0; i < options.samples; ++i) {
        const RasterView view{.camera = scene.camera,
                              .aspect = double(width) / height,
                              .lights = scene.lights,
                              .shift = sample_shift(i, width, height)};
        surface->draw(mesh, view);
        for (std::size_t k = 0; k < made.size(); ++k)
            means[k].add(made[k], *surface, view, {&*light, environment_frame(scene.camera), options.draws});
        glFinish();
        if (options.progress) options.progress(double(i + 1) / options.samples);
    }
    std::vector<Rendering> renderings;
    for (const RasterMean& mean : means) {
        const std::vector<Float4> pixels = mean.picture().read_floats();
        Rendering& rendering = renderings.emplace_back(Rendering{Image(width, height), {}});
        rendering.coverage.assign(pixels.size(), 1);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            rendering.radiance.pixels[i] = {pixels[i][0], pixels[i][1], pixels[i][2]};
    }
    return renderings;
}

}  // namespace srbf
