// A context to draw in without a window: level 6.
#pragma once
#include <optional>
#include <string>

#include "srbf/shader.h"

namespace srbf {

/// A context of its own, current on this thread from when it is made until it goes: by EGL, without a display or window; on a
/// machine without a GPU the library draws on the CPU (Mesa's llvmpipe).
class OffscreenContext {
  public:
    /// Of that dialect; without one OpenGL 4.5, or else OpenGL ES 3.0. Errors name what is missing.
    static Result<OffscreenContext> make(std::optional<Dialect> dialect = {});
    OffscreenContext(OffscreenContext&& other) noexcept;
    OffscreenContext& operator=(OffscreenContext&&) = delete;
    ~OffscreenContext();

    Dialect dialect() const { return dialect_; }
    /// What the library says of itself: "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6".
    std::string renderer() const;

  private:
    OffscreenContext(void* display, void* context, Dialect dialect)
        : display_(display), context_(context), dialect_(dialect) {}
    void* display_ = nullptr;
    void* context_ = nullptr;
    Dialect dialect_{};
};

}  // namespace srbf
