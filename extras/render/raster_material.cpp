#include <epoxy/gl.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/half.h"
#include "brdf/frame.h"
#include "extras/render/raster.h"
#include "models/su/su_functions.h"

namespace SRBF_NAMESPACE {
namespace {

/// Errors: a material's numbers exceed the limits of the library. Materials without an overload have few numbers.
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
    const auto numbers = pm_numbers(model, is_open_);
    data_bytes_ = numbers.size() * sizeof(Float4);
    numbers_ = new_buffer(GL_UNIFORM_BUFFER, numbers.data(), data_bytes_, GL_DYNAMIC_DRAW);
    glUniformBlockBinding(program_.id(), glGetUniformBlockIndex(program_.id(), "PmNumbers"), 0);
}

void RasterMaterial::load(const Uniform& of) {
    if (of.numbers.empty()) return;
    data_bytes_ = of.numbers.size() * sizeof(Float4);
    glUniform4fv(glGetUniformLocation(program_.id(), of.name.c_str()), GLsizei(of.numbers.size()),
                 of.numbers[0].data());
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
    result.is_open_ = options.open;
    glUseProgram(result.program_.id());
    std::visit([&](const auto& content) { result.load(content); }, material);
    return result;
}

Result<RasterMaterial> RasterMaterial::make(const RasterMap& map, const ShaderOptions& options) {
    const auto& finest = map.levels[0];
    const auto fits = check_gl_size("texels of a map along a side",
                                    std::uint64_t(std::max(finest.width, finest.height)), GL_MAX_TEXTURE_SIZE);
    if (!fits) return fits.error();
    const auto layers = check_gl_size("lobes of a map", std::uint64_t(map.layers), GL_MAX_ARRAY_TEXTURE_LAYERS);
    if (!layers) return layers.error();
    auto program = new_program(map_shader_text(map.code, options));
    if (!program) return program.error();
    RasterMaterial result(*std::move(program));
    result.no_array_ = new_array();
    glUseProgram(result.program_.id());
    Texture texture{new_texture(GL_TEXTURE_2D_ARRAY, GL_LINEAR), GL_TEXTURE_2D_ARRAY};
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glTexParameteri(GL_TEXTURE_2D_ARRAY, axis, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, GLint(map.levels.size()) - 1);
    for (std::size_t k = 0; k < map.levels.size(); ++k) {
        const auto& [width, height, halves] = map.levels[k];
        glTexImage3D(GL_TEXTURE_2D_ARRAY, GLint(k), GL_RGBA16F, width, height, map.layers, 0, GL_RGBA, GL_HALF_FLOAT,
                     halves.data());
        result.data_bytes_ += 2 * halves.size();
    }
    result.add_texture("map_layers", std::move(texture));
    return result;
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
    mesh.draw(program_, view);
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
    // The triangle lies at the far plane; the surface is where the depth is less.
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
    const auto set_axes = [&](const char* uniform, Vec3d x, Vec3d y, Vec3d z, bool is_transposed) {
        const std::array<Vec3f, 3> vectors{to_float(x), to_float(y), to_float(z)};
        std::array<float, 9> columns;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3f& w = vectors[is_transposed ? k : i];
                const std::size_t component = is_transposed ? i : k;
                columns[3 * i + k] = component == 0 ? w.x : component == 1 ? w.y : w.z;
            }
        glUniformMatrix3fv(place(uniform), 1, GL_FALSE, columns.data());
    };
    const RasterEnvironment& environment = *light.environment;
    const Frame camera = frame(view.camera);
    const double half = std::tan(view.camera.fov / 2);
    set_axes("into_environment", light.axes.x, light.axes.y, light.axes.z, true);
    set_axes("picture_axes", half * view.aspect * camera.x, half * camera.y, camera.z, false);
    glUniform1f(place("environment_scale"), environment.scale_);
    glUniform1f(place("share"), 1 / float(index + 1));
    glUniform1i(place("sample_index"), index);
    glUniform1i(place("draws"), int(light.draws));
    glUniform2f(place("picture_size"), float(surface.width_), float(surface.height_));
    glUniform2f(place("shift"), float(view.shift[0] * surface.width_), float(view.shift[1] * surface.height_));
    glDisable(GL_DEPTH_TEST);
    draw_whole({{"surface_positions", &surface.positions_},
                {"surface_normals", &surface.normals_},
                {"surface_places", &surface.places_},
                {"before", &before.colour_},
                {"environment", &environment.radiance_},
                {"environment_columns", &environment.columns_},
                {"environment_rows", &environment.rows_}});
}

}  // namespace srbf
