// A sphere of a measured material under an environment, in a window of OpenGL 3.3. The shader is exported code with the
// function `radiance` that it asks for; the environment is filtered here as that function has to answer.
//   srbf export film.srbf --to glsl --with environment -o film.glsl
//   environment_light film.glsl studio.hdr [picture.png]
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <epoxy/gl.h>
// Before what includes OpenGL.
#include <GLFW/glfw3.h>
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr int k_levels = 6, k_width = 1024, k_size = 512;  // level k is filtered for roughness k / (k_levels - 1)

const std::string k_version = "#version 330 core\n";
const std::string k_whole_picture = k_version + R"(
out vec2 at;
void main() {
    at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(at, 0.0, 1.0);
})";
const std::string k_directions = R"(
vec2 place_of(vec3 w) { return vec2(atan(w.x, -w.z) / 6.2831853 + 0.5, acos(clamp(w.y, -1.0, 1.0)) / 3.14159265); }
mat3 frame_about(vec3 n) {
    vec3 t = normalize(abs(n.y) < 0.9 ? cross(vec3(0.0, 1.0, 0.0), n) : cross(vec3(1.0, 0.0, 0.0), n));
    return mat3(t, cross(n, t), n);
})";
// The mean over GGX's lobe of a roughness, seen along the normal (Karis 2013): half vectors are drawn from its
// distribution, and each reads a level of the source whose texels are twice as wide as its share of the directions.
const std::string k_filter = k_version + R"(
in vec2 at;
out vec4 colour;
uniform sampler2D source;
uniform float roughness;
)" + k_directions + R"(
void main() {
    vec2 angle = (0.5 * at + 0.5) * vec2(6.2831853, 3.14159265);
    vec3 n = vec3(-sin(angle.x) * sin(angle.y), cos(angle.y), cos(angle.x) * sin(angle.y));
    mat3 frame = frame_about(n);
    float a2 = pow(roughness, 4.0), texel = 19.7392088 / float(textureSize(source, 0).x * textureSize(source, 0).y);
    vec4 sum = vec4(0.0);
    const int count = 512;
    for (int i = 0; i < count; ++i) {
        float u = (float(i) + 0.5) / float(count), turn = 2.39996323 * float(i);
        float z = sqrt((1.0 - u) / (1.0 + (a2 - 1.0) * u)), r = sqrt(1.0 - z * z);
        vec3 h = vec3(r * cos(turn), r * sin(turn), z), l = 2.0 * z * h - vec3(0.0, 0.0, 1.0);
        if (l.z <= 0.0) continue;
        float root = 1.0 + (a2 - 1.0) * z * z, density = a2 / (12.5663706 * root * root);
        float level = 0.5 * log2(1.0 / (float(count) * density * texel));
        sum += l.z * vec4(textureLod(source, place_of(frame * l), max(level + 1.0, 0.0)).rgb, 1.0);
    }
    colour = roughness == 0.0 ? textureLod(source, place_of(n), 0.0) : sum / sum.a;
})";
const std::string k_sphere = k_directions + R"(
in vec2 at;
out vec4 colour;
uniform sampler2D filtered;
uniform vec2 turn;
uniform float exposure;
mat3 to_world;
vec3 seen(vec3 w, float roughness) { return textureLod(filtered, place_of(w), 5.0 * roughness).rgb; }
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
    colour = vec4(pow(clamp(exposure * light, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
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

GLuint texture(int levels, int width, int height, const float* texels) {
    GLuint name = 0;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, levels - 1);
    for (int k = 0; k < levels; ++k)
        glTexImage2D(GL_TEXTURE_2D, k, GL_RGB16F, width >> k, height >> k, 0, GL_RGB, GL_FLOAT, k ? nullptr : texels);
    return name;
}

/// Binds the levels of the filtered environment, which are drawn one by one.
void filter(const float* texels, int width, int height) {
    const GLuint levels = texture(k_levels, k_width, k_width / 2, nullptr), program = program_of(k_filter);
    texture(int(std::log2(width)), width, height, texels);
    glGenerateMipmap(GL_TEXTURE_2D);
    GLuint target = 0;
    glGenFramebuffers(1, &target);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    for (int k = 0; k < k_levels; ++k) {
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, levels, k);
        glViewport(0, 0, k_width >> k, k_width / 2 >> k);
        glUniform1f(glGetUniformLocation(program, "roughness"), float(k) / (k_levels - 1));
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glBindTexture(GL_TEXTURE_2D, levels);
}

}  // namespace

int main(int count, char** argument) {
    if (count < 3) fail("expected MATERIAL.glsl ENVIRONMENT.hdr [PICTURE.png]");
    std::stringstream material;
    material << std::ifstream(argument[1]).rdbuf();
    int width = 0, height = 0, channels = 0;
    float* const texels = stbi_loadf(argument[2], &width, &height, &channels, 3);
    if (material.str().empty() || !texels) fail("a file cannot be read");
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
    filter(texels, width, height);
    double mean = 0;
    for (int i = 0; i < 3 * width * height; ++i) mean += double(texels[i]) / (3.0 * width * height);
    const GLuint program = program_of(k_version + material.str() + sphere);
    glUniform1f(glGetUniformLocation(program, "exposure"), float(1 / mean));
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
