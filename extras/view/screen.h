// The screen: a desktop window for OpenGL and Dear ImGui, with its input and output.
#pragma once
#include <functional>
#include <string>

#include "extras/render/tone.h"

struct GLFWwindow;

namespace srbf {

/// Owns GLFW, its window and Dear ImGui, and destroys them in the required order.
class Screen {
  public:
    Screen() = default;
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    /// Opens a window of that size in pixels, or a larger one that `fills` most of its monitor; its OpenGL context becomes
    /// current. Errors: no display, no OpenGL 4.5.
    Result<Done> open(int width, int height, bool fills);
    /// True if `show` waits for the display's refresh.
    void set_paced(bool paced);
    bool is_closing() const;

    /// Callbacks from within `wait`: for a key, by its name in `press`, unless text is being typed, and for a file
    /// dropped on the window.
    std::function<void(const std::string& key)> on_key;
    std::function<void(const std::string& path)> on_drop;
    /// Waits for input, at most this many seconds; 0: processes pending input.
    void wait(double seconds);

    /// Calls to Dear ImGui between the two are drawn by the second, which also makes the picture available and shows
    /// it.
    void begin_frame();
    void end_frame();
    /// Pixels of the monitor for a pixel of a monitor of scale 1.
    float scale() const { return scale_; }
    Image8 read() const;
    void show();

  private:
    GLFWwindow* window_ = nullptr;
    bool has_imgui_ = false;
    float scale_ = 1;
};

}  // namespace srbf
