// Compiles compute shaders.
#pragma once
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <string>

namespace srbf {

/// The linked program of a compute shader, or 0.
inline GLuint compute_program(const std::string& source) {
    const GLuint shader_id = glCreateShader(GL_COMPUTE_SHADER), program = glCreateProgram();
    const char* text = source.c_str();
    glShaderSource(shader_id, 1, &text, nullptr);
    glCompileShader(shader_id);
    glAttachShader(program, shader_id);
    glLinkProgram(program);
    GLint is_linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &is_linked);
    if (!is_linked) {
        std::string compile_log(4000, '\0'), link_log(4000, '\0');
        glGetShaderInfoLog(shader_id, 4000, nullptr, compile_log.data());
        glGetProgramInfoLog(program, 4000, nullptr, link_log.data());
        ADD_FAILURE() << compile_log.c_str() << link_log.c_str();
    }
    glDeleteShader(shader_id);
    return is_linked ? program : 0;
}

}  // namespace srbf
