// The screen: a window of the desktop that OpenGL and Dear ImGui draw on, what reaches it, and what it shows.
#pragma once
#include <functional>
#include <string>

#include "render/image.h"

struct GLFWwindow;

namespace srbf {

/// GLFW, its window and Dear ImGui, ended in the order in which they can be.
class Screen {
  public:
    Screen() = default;
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    /// Opens it, so many pixels large; its OpenGL becomes the current one. Errors: no display, no OpenGL 4.5.
    Result<Done> open(int width, int height);
    /// Whether `show` waits for the display, or frames come as fast as they can.
    void set_paced(bool paced);
    bool is_closing() const;

    /// Who is told, from within `wait`, of a key by the name that `press` takes, unless text is typed, and of a file dropped on it.
    std::function<void(const std::string& key)> on_key;
    std::function<void(const std::string& path)> on_drop;
    /// Until something reaches it, so many seconds at most; 0: takes what has.
    void wait(double seconds);

    /// What Dear ImGui is told between the two is drawn by the second, to be read, and then shown.
    void begin_frame();
    void end_frame();
    Image8 read() const;
    void show();

  private:
    GLFWwindow* window_ = nullptr;
    bool has_imgui_ = false;
};

}  // namespace srbf
