#include "extras/render/gl_object.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace SRBF_NAMESPACE {
namespace {

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

}  // namespace

Error gl_error(std::string what, std::string expected, std::string found) {
    return {"raster", {}, std::move(what), std::move(expected), std::move(found)};
}

int gl_integer(unsigned name) {
    GLint number = 0;
    glGetIntegerv(name, &number);
    return number;
}

GlObject new_buffer(GLenum target, const void* data, std::size_t bytes, GLenum usage) {
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

Result<Done> check_gl_size(const char* what, std::uint64_t size, GLenum limit) {
    if (size <= std::uint64_t(gl_integer(limit))) return Done{};
    return gl_error(what, fmt::format("at most {} here", gl_integer(limit)), std::to_string(size));
}

}  // namespace srbf
