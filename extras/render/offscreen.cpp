#include "extras/render/offscreen.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace SRBF_NAMESPACE {
namespace {

Error missing(std::string expected, std::string found) {
    return {"raster", {}, "drawing off screen", std::move(expected), std::move(found)};
}

bool is_loadable(const char* library) {
    void* const handle = ::dlopen(library, RTLD_LAZY | RTLD_LOCAL);
    if (handle) ::dlclose(handle);
    return handle != nullptr;
}

bool has_client_extension(std::string_view name) {
    const char* const extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    return extensions && std::string_view(extensions).find(name) != std::string_view::npos;
}

/// Displays without a screen, in the order: devices (possibly a GPU), Mesa's surfaceless platform, the default.
std::vector<EGLDisplay> offscreen_displays() {
    std::vector<EGLDisplay> displays;
    if (has_client_extension("EGL_EXT_platform_device") && has_client_extension("EGL_EXT_device_enumeration")) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (eglQueryDevicesEXT(EGLint(devices.size()), devices.data(), &count))
            for (const EGLDeviceEXT device : std::span(devices).first(std::size_t(count)))
                displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
    }
    if (has_client_extension("EGL_MESA_platform_surfaceless"))
        displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    displays.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    std::erase_if(displays, [](EGLDisplay display) {
        return display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr);
    });
    return displays;
}

/// Makes a context of this dialect current; EGL_NO_CONTEXT if none exists.
EGLContext current_context(EGLDisplay display, Dialect dialect) {
    const bool is_es = dialect == Dialect::es_300;
    if (!is_loadable(is_es ? "libGLESv2.so.2" : "libOpenGL.so.0") && !is_loadable("libGL.so.1")) return EGL_NO_CONTEXT;
    if (!eglBindAPI(is_es ? EGL_OPENGL_ES_API : EGL_OPENGL_API)) return EGL_NO_CONTEXT;
    const std::array<EGLint, 11> config_attributes{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                                   is_es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint count = 0;
    if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context") &&
        (!eglChooseConfig(display, config_attributes.data(), &config, 1, &count) || count < 1))
        return EGL_NO_CONTEXT;
    std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION, is_es ? 3 : 4, EGL_CONTEXT_MINOR_VERSION, is_es ? 0 : 5};
    if (!is_es)
        attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT});
    attributes.push_back(EGL_NONE);
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) return EGL_NO_CONTEXT;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return context;
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
}

}  // namespace

Result<OffscreenContext> OffscreenContext::make(std::optional<Dialect> dialect) {
    if (!is_loadable("libEGL.so.1")) return missing("EGL (Debian: libegl1, libgl1-mesa-dri)", "no libEGL.so.1");
    // Suppresses the library's messages about drivers that it tried; the error reports the result.
    ::setenv("EGL_LOG_LEVEL", "fatal", 0);
    const std::vector<EGLDisplay> displays = offscreen_displays();
    if (displays.empty()) return missing("an EGL display without a window (Debian: libgl1-mesa-dri)", "none");
    for (const Dialect candidate : {Dialect::gl_450, Dialect::es_300})
        for (const EGLDisplay display : displays) {
            if (dialect && dialect != candidate) continue;
            if (const EGLContext context = current_context(display, candidate); context != EGL_NO_CONTEXT)
                return OffscreenContext(display, context, candidate);
        }
    return missing(
        dialect ? std::string(name(*dialect)) : fmt::format("{} or {}", name(Dialect::gl_450), name(Dialect::es_300)),
        "neither its library nor a driver for it");
}

OffscreenContext::OffscreenContext(OffscreenContext&& other) noexcept
    : display_(other.display_), context_(std::exchange(other.context_, nullptr)), dialect_(other.dialect_) {}

OffscreenContext::~OffscreenContext() {
    if (!context_) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglReleaseThread();
}

std::string OffscreenContext::renderer() const {
    const auto text = [](GLenum name) { return reinterpret_cast<const char*>(glGetString(name)); };
    return fmt::format("{}, {}", text(GL_RENDERER), text(GL_VERSION));
}

}  // namespace
