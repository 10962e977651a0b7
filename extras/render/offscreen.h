// OpenGL contexts without a window.
#pragma once
#include <optional>

#include "srbf/shader.h"

namespace SRBF_NAMESPACE {

/// A context of its own, current on this thread for the lifetime of the object. It uses EGL without a display or
/// window; without a GPU the library renders on the CPU (Mesa's llvmpipe).
class OffscreenContext {
  public:
    /// A context for this dialect; by default OpenGL 4.5, or else OpenGL ES 3.0. Errors name the missing component.
    static Result<OffscreenContext> make(std::optional<Dialect> dialect = {});
    OffscreenContext(OffscreenContext&& other) noexcept;
    OffscreenContext& operator=(OffscreenContext&&) = delete;
    ~OffscreenContext();

    Dialect dialect() const { return dialect_; }
    /// The library's description of itself: "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6".
    std::string renderer() const;

  private:
    OffscreenContext(void* display, void* context, Dialect dialect)
        : display_(display), context_(context), dialect_(dialect) {}
    void* display_ = nullptr;
    void* context_ = nullptr;
    Dialect dialect_{};
};

}  // namespace
