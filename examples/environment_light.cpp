// A sphere of a measured material under an environment, in a window of OpenGL 3.3. The shader is exported code with the
// function `radiance` that it asks for, which looks the environment up in a cube map that is filtered for it.
//   srbf export film.srbf --to glsl --with environment -o film.glsl
//   srbf export studio.hdr --to dds -o studio.dds
//   environment_light film.glsl studio.dds [picture.png]
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <epoxy/gl.h>
// Before what includes OpenGL.
#include <GLFW/glfw3.h>
#include <stb/stb_image_write.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr int k_size = 512;

const std::string k_version = "#version 330 core\n";
const std::string k_whole_picture = k_version + R"(
out vec2 at;
void main() {
    at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(at, 0.0, 1.0);
})";
const std::string k_sphere = R"(
in vec2 at;
out vec4 colour;
uniform samplerCube filtered;
uniform vec2 turn;
mat3 frame_about(vec3 n) {
    vec3 t = normalize(abs(n.y) < 0.9 ? cross(vec3(0.0, 1.0, 0.0), n) : cross(vec3(1.0, 0.0, 0.0), n));
    return mat3(t, cross(n, t), n);
}
mat3 to_world;
vec3 seen(vec3 w, float roughness) { return textureLod(filtered, w, 5.0 * sqrt(roughness)).rgb; }
vec3 NAME_radiance(vec3 direction, float roughness) { return seen(to_world * direction, roughness); }
void main() {
    vec3 eye = vec3(sin(turn.x) * cos(turn.y), sin(turn.y), cos(turn.x) * cos(turn.y));
    mat3 camera = frame_about(eye);
    vec3 ray = normalize(camera * vec3(0.35 * at, -1.0)), from = 4.0 * eye;
    float along = -dot(from, ray), inside = 1.0 - dot(from, from) + along * along;
    vec3 light = seen(ray, 0.0);
    if (inside > 0.0) {
        to_world = frame_about(from + (along - sqrt(inside)) * ray);
        light = NAME_environment(-ray * to_world);
    }
    float mean = 0.0;  // of what a white surface shows from six sides
    for (int i = 0; i < 6; ++i) {
        vec3 w = vec3(0.0);
        w[i / 2] = float(2 * (i % 2) - 1);
        mean += dot(seen(w, 1.0), vec3(0.2126, 0.7152, 0.0722)) / 6.0;
    }
    colour = vec4(pow(clamp(light / max(mean, 1.0e-6), 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
})";

[[noreturn]] void fail(const std::string& what) {
    std::fprintf(stderr, "environment_light: %s\n", what.c_str());
    std::exit(1);
}

GLuint program_of(const std::string& fragment) {
    const GLuint program = glCreateProgram();
    for (const auto& [kind, text] : {std::pair{GL_VERTEX_SHADER, k_whole_picture}, {GL_FRAGMENT_SHADER, fragment}}) {
        const GLuint shader = glCreateShader(GLenum(kind));
        const char* const source = text.c_str();
        glShaderSource(shader, 1, &source, nullptr);
        glCompileShader(shader);
        glAttachShader(program, shader);
    }
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) fail("the shader does not compile");
    glUseProgram(program);
    return program;
}

/// Binds the cube map of a .dds.
void bind_cube(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::array<std::uint32_t, 32> header{};
    stream.read(reinterpret_cast<char*>(header.data()), sizeof header);
    if (!stream || header[0] != 0x20534444 || header[21] != 113)
        fail(file + " is not a cube map by srbf export --to dds");
    GLuint name = 0;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_CUBE_MAP, name);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, GLint(header[7]) - 1);
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    std::vector<std::uint16_t> texels;
    for (unsigned face = 0; face < 6; ++face)
        for (unsigned level = 0; level < header[7]; ++level) {
            const unsigned side = header[4] >> level;
            texels.resize(std::size_t(4) * side * side);
            stream.read(reinterpret_cast<char*>(texels.data()), std::streamsize(2 * texels.size()));
            glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, GLint(level), GL_RGBA16F, GLsizei(side), GLsizei(side),
                         0, GL_RGBA, GL_HALF_FLOAT, texels.data());
        }
    if (!stream) fail(file + " ends early");
}

}  // namespace

int main(int count, char** argument) {
    if (count < 3) fail("expected MATERIAL.glsl ENVIRONMENT.dds [PICTURE.png]");
    std::stringstream material;
    material << std::ifstream(argument[1]).rdbuf();
    if (material.str().empty()) fail(std::string(argument[1]) + " cannot be read");
    std::string sphere = k_sphere;
    const std::string name = std::filesystem::path(argument[1]).stem().string();
    for (std::size_t at; (at = sphere.find("NAME")) != std::string::npos;) sphere.replace(at, 4, name);

    if (!glfwInit()) fail("there is no display");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3), glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, count == 3), glfwWindowHint(GLFW_RESIZABLE, false);
    GLFWwindow* const window = glfwCreateWindow(k_size, k_size, name.c_str(), nullptr, nullptr);
    if (!window) fail("there is no OpenGL 3.3");
    glfwMakeContextCurrent(window);
    GLuint corners = 0;
    glGenVertexArrays(1, &corners);
    glBindVertexArray(corners);
    bind_cube(argument[2]);
    const GLuint program = program_of(k_version + material.str() + sphere);
    glViewport(0, 0, k_size, k_size);
    while (!glfwWindowShouldClose(window)) {
        double x = 0, y = k_size / 2.0;
        if (count == 3) glfwGetCursorPos(window, &x, &y);
        glUniform2f(glGetUniformLocation(program, "turn"), float(x / 80), float((y - k_size / 2.0) / k_size));
        glDrawArrays(GL_TRIANGLES, 0, 3);
        if (count > 3) {
            std::vector<unsigned char> rows(3 * k_size * k_size);
            glReadPixels(0, 0, k_size, k_size, GL_RGB, GL_UNSIGNED_BYTE, rows.data());
            stbi_flip_vertically_on_write(true);
            return stbi_write_png(argument[3], k_size, k_size, 3, rows.data(), 0) ? 0 : 1;
        }
        glfwSwapBuffers(window);
        glfwWaitEventsTimeout(0.05);
    }
}
