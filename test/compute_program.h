// This header compiles compute shaders of tests.
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
        std::string log(4000, '\0'), of_linking(4000, '\0');
        glGetShaderInfoLog(shader_id, 4000, nullptr, log.data());
        glGetProgramInfoLog(program, 4000, nullptr, of_linking.data());
        ADD_FAILURE() << log.c_str() << of_linking.c_str();
    }
    glDeleteShader(shader_id);
    return is_linked ? program : 0;
}

}  // namespace srbf
