// The screen: a desktop window for OpenGL and Dear ImGui, with its input and output.
#pragma once
#include <functional>
#include <string>

#include "extras/render/tone.h"

struct GLFWwindow;

namespace SRBF_NAMESPACE {

/// Owns GLFW, its window and Dear ImGui, and destroys them in the required order.
class Screen {
  public:
    Screen() = default;
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    /// Opens a window of this size in pixels, or a larger one if it `fills` most of its monitor. Its OpenGL context
    /// becomes current. Errors: no display, no OpenGL 4.5.
    Result<Done> open(int width, int height, bool fills);
    /// Sets whether `show` waits for the refresh of the display.
    void set_paced(bool paced);
    bool is_closing() const;

    /// Callbacks during `wait`: for a key, with its name for `press`, unless text is being typed; and for a file
    /// that is dropped on the window.
    std::function<void(const std::string& key)> on_key;
    std::function<void(const std::string& path)> on_drop;
    /// Waits at most this many seconds for input. 0: only processes pending input.
    void wait(double seconds);

    /// Calls of Dear ImGui between these two are drawn by the second. Afterwards `read` returns the picture and
    /// `show` displays it.
    void begin_frame();
    void end_frame();
    /// Pixels of the monitor per pixel at scale 1.
    float scale() const { return scale_; }
    Image8 read() const;
    void show();

  private:
    GLFWwindow* window_ = nullptr;
    bool has_imgui_ = false;
    float scale_ = 1;
};

}  // namespace srbf
