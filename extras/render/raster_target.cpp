#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "extras/render/raster.h"

namespace SRBF_NAMESPACE {
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
    GLenum pixel_format = GL_RGBA8;
    if (format == Format::floats) pixel_format = max_samples(GL_RGBA32F) >= samples ? GL_RGBA32F : GL_RGBA16F;

    RasterTarget target;
    target.width_ = width, target.height_ = height, target.format_ = format;
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

Float4 RasterTarget::read_pixel(int x, int y) const {
    assert(format_ == Format::floats);
    resolve();
    Float4 pixel{};
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    glReadPixels(x, height_ - 1 - y, 1, 1, GL_RGBA, GL_FLOAT, pixel.data());
    return pixel;
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

Result<RasterSurface> RasterSurface::make(Dialect dialect, int picture_width, int picture_height, Points points,
                                          bool textured) {
    assert(picture_width >= 1 && picture_height >= 1);
    const int width = int(points) * picture_width, height = int(points) * picture_height;
    if (auto fits = check_picture(width, height, true); !fits) return fits.error();
    auto program = new_program(surface_shader_text(dialect, textured));
    if (!program) return program.error();
    RasterSurface surface;
    surface.width_ = picture_width, surface.height_ = picture_height, surface.along_ = int(points);
    surface.program_ = *std::move(program);
    const int bound = gl_integer(GL_FRAMEBUFFER_BINDING);
    GLuint id = 0;
    glGenFramebuffers(1, &id);
    surface.framebuffer_ = {id, [](unsigned buffer) { glDeleteFramebuffers(1, &buffer); }};
    glBindFramebuffer(GL_FRAMEBUFFER, id);
    std::vector<GLenum> colours;
    for (GlObject* texture : {&surface.positions_, &surface.normals_, &surface.places_}) {
        if (texture == &surface.places_ && !textured) continue;
        *texture = new_texture(GL_TEXTURE_2D, GL_NEAREST);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
        colours.push_back(GLenum(GL_COLOR_ATTACHMENT0 + colours.size()));
        glFramebufferTexture2D(GL_FRAMEBUFFER, colours.back(), GL_TEXTURE_2D, texture->id(), 0);
    }
    glDrawBuffers(GLsizei(colours.size()), colours.data());
    surface.depth_ = renderbuffer(GL_DEPTH_COMPONENT24, width, height, 1);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, surface.depth_.id());
    const auto complete = check_framebuffer(width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, GLuint(bound));
    if (!complete) return complete.error();
    return surface;
}

void RasterSurface::draw(const RasterMesh& mesh, const RasterView& view) const {
    const GLint bound = gl_integer(GL_DRAW_FRAMEBUFFER_BINDING);
    std::array<GLint, 4> viewport{};
    glGetIntegerv(GL_VIEWPORT, viewport.data());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, along_ * width_, along_ * height_);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program_.id());
    RasterView shifted = view;
    const std::array<int, 2> size{width_, height_};
    // The shift of all points together: the point of the view lies in the lower or the upper half of its pixel.
    for (std::size_t axis = 0; axis < 2 && along_ == 2; ++axis)
        shifted.shift[axis] -= (view.shift[axis] < 0 ? -0.25 : 0.25) / size[axis];
    mesh.draw(program_, shifted);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound));
    glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
}

std::vector<Float4> RasterSurface::read(unsigned colour) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    return read_colour(GL_COLOR_ATTACHMENT0 + colour, along_ * width_, along_ * height_);
}

}  // namespace srbf
