#include "extras/view/screen.h"

#include <epoxy/gl.h>
// Epoxy replaces OpenGL's own header, so this header follows it.
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "extras/render/pixel_shader.h"
#include "extras/view/ink.h"

namespace SRBF_NAMESPACE {
namespace {

/// The fraction of the monitor that a large window takes.
constexpr double k_monitor_fraction = 0.8;

/// The name of a key for `press`; empty: the key is not used.
std::string name_of(int key, int scancode, int modifiers) {
    constexpr std::pair<int, const char*> named[] = {
        {GLFW_KEY_LEFT, "Left"},          {GLFW_KEY_RIGHT, "Right"}, {GLFW_KEY_UP, "Up"},
        {GLFW_KEY_DOWN, "Down"},          {GLFW_KEY_ENTER, "Enter"}, {GLFW_KEY_PAGE_UP, "PageUp"},
        {GLFW_KEY_PAGE_DOWN, "PageDown"}, {GLFW_KEY_F1, "F1"},       {GLFW_KEY_ESCAPE, "Escape"}};
    std::string name;
    if (const auto entry = std::ranges::find(named, key, [](const auto& row) { return row.first; });
        entry != std::end(named))
        name = entry->second;
    else if (const char* text = glfwGetKeyName(key, scancode); text && text[0] != 0 && text[1] == 0)
        name = char(std::toupper(text[0]));
    return (modifiers & GLFW_MOD_SHIFT) != 0 && !name.empty() ? "Shift+" + name : name;
}

Screen& screen_of(GLFWwindow* window) { return *static_cast<Screen*>(glfwGetWindowUserPointer(window)); }

}  // namespace

Screen::~Screen() {
    if (has_imgui_) {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
    if (window_) glfwDestroyWindow(window_);
    glfwTerminate();
}

Result<Done> Screen::open(int width, int height, bool fills) {
    const auto glfw_error = [] {
        const char* text = nullptr;
        glfwGetError(&text);
        return std::string(text ? text : "nothing");
    };
    if (!glfwInit()) return Error{"window", {}, "display", "one, named by DISPLAY", glfw_error()};
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    if (GLFWmonitor* const monitor = fills ? glfwGetPrimaryMonitor() : nullptr) {
        int x = 0, y = 0, monitor_width = 0, monitor_height = 0;
        glfwGetMonitorWorkarea(monitor, &x, &y, &monitor_width, &monitor_height);
        width = std::max(width, int(k_monitor_fraction * monitor_width)),
        height = std::max(height, int(k_monitor_fraction * monitor_height));
    }
    window_ = glfwCreateWindow(width, height, "srbf view", nullptr, nullptr);
    if (!window_)
        return Error{"window",
                     {},
                     "graphics library of this display",
                     std::string(name(Dialect::gl_450)),
                     glfw_error() + " (Mesa draws it on the CPU with LIBGL_ALWAYS_SOFTWARE=1)"};
    glfwMakeContextCurrent(window_);
    glfwSetWindowUserPointer(window_, this);
    // These are set before Dear ImGui's callbacks, which call them.
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int modifiers) {
        if (action == GLFW_RELEASE || (modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) return;
        if (const auto& callback = screen_of(window).on_key) callback(name_of(key, scancode, modifiers));
    });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
        if (const auto& callback = screen_of(window).on_drop)
            for (int i = 0; i < count; ++i) callback(paths[i]);
    });
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    float x_scale = 1, y_scale = 1;
    glfwGetWindowContentScale(window_, &x_scale, &y_scale);
    scale_ = std::clamp(std::max(x_scale, y_scale), 1.f, 4.f);
    load_font(scale_);
    ImGui::GetStyle().ScaleAllSizes(scale_);
    ImGui::GetStyle().WindowRounding = 0;
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    has_imgui_ = true;
    return Done{};
}

void Screen::set_paced(bool paced) { glfwSwapInterval(paced ? 1 : 0); }
bool Screen::is_closing() const { return glfwWindowShouldClose(window_); }
void Screen::wait(double seconds) { seconds > 0 ? glfwWaitEventsTimeout(seconds) : glfwPollEvents(); }

void Screen::begin_frame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

void Screen::end_frame() {
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    glClearColor(0.1f, 0.1f, 0.1f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

Image8 Screen::read() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    Image8 image(width, height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadBuffer(GL_BACK);
    std::vector<Rgb8> pixels(image.pixels.size());
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    for (int y = 0; y < height; ++y)
        std::copy_n(&pixels[std::size_t(height - 1 - y) * std::size_t(width)], width, &image.at(0, y));
    return image;
}

void Screen::show() { glfwSwapBuffers(window_); }

}  // namespace srbf
