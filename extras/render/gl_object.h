// Objects of OpenGL 4.5 or OpenGL ES 3.0 in the current context, and its errors.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "extras/render/pixel_shader.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// Owns an object of the graphics library. It must be destroyed while its context is current.
class GlObject {
  public:
    using Delete = void (*)(unsigned id);
    GlObject() = default;
    GlObject(unsigned id, Delete destroy) : id_(id), delete_(destroy) {}
    GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)), delete_(other.delete_) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(id_, other.id_), std::swap(delete_, other.delete_);
        return *this;
    }
    ~GlObject() {
        if (id_ != 0) delete_(id_);
    }
    unsigned id() const { return id_; }

  private:
    unsigned id_ = 0;
    Delete delete_ = nullptr;
};

// Numbers of type unsigned are OpenGL's enumerators.

/// A buffer, bound to its target.
GlObject new_buffer(unsigned target, const void* data, std::size_t bytes, unsigned usage);
/// A vertex array; it is not bound.
GlObject new_array();
/// A texture without texels, clamped to its edges, of one level, bound to its target.
GlObject new_texture(unsigned target, unsigned filter);
void bind_texture(std::size_t unit, unsigned target, const GlObject& texture);
/// A program; it is not in use. Errors: the library's compiler rejects the text.
Result<GlObject> new_program(const ShaderText& text);

/// An error of the renderer that draws with OpenGL.
Error gl_error(std::string what, std::string expected, std::string found = {});
/// The value of a state or a limit of the library.
int gl_integer(unsigned name);
/// Errors: `size` exceeds a limit of the library.
Result<Done> check_gl_size(const char* what, std::uint64_t size, unsigned limit);

}  // namespace srbf
