#include "app/astc.h"

#include <cassert>

#ifdef SRBF_ASTC
#include <astcenc.h>

#include <memory>
#endif

namespace srbf {

#ifdef SRBF_ASTC
bool has_astc() { return true; }

std::vector<std::byte> astc_blocks(std::size_t width, std::size_t height, std::span<const std::byte> texels) {
    // One for each thread, because its tables take long to make.
    thread_local const auto context = [] {
        astcenc_config config{};
        astcenc_context* made = nullptr;
        [[maybe_unused]] auto error =
            astcenc_config_init(ASTCENC_PRF_LDR_SRGB, 4, 4, 1, ASTCENC_PRE_MEDIUM, 0, &config);
        assert(error == ASTCENC_SUCCESS);
        error = astcenc_context_alloc(&config, 1, &made);
        assert(error == ASTCENC_SUCCESS);
        return std::unique_ptr<astcenc_context, void (*)(astcenc_context*)>(made, astcenc_context_free);
    }();
    void* slice = const_cast<std::byte*>(texels.data());  // it is only read
    astcenc_image image{unsigned(width), unsigned(height), 1, ASTCENC_TYPE_U8, &slice};
    const astcenc_swizzle same{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_1};
    std::vector<std::byte> blocks((width + 3) / 4 * ((height + 3) / 4) * 16);
    [[maybe_unused]] const auto error = astcenc_compress_image(
        context.get(), &image, &same, reinterpret_cast<std::uint8_t*>(blocks.data()), blocks.size(), 0);
    assert(error == ASTCENC_SUCCESS);
    astcenc_compress_reset(context.get());
    return blocks;
}
#else
bool has_astc() { return false; }

std::vector<std::byte> astc_blocks(std::size_t, std::size_t, std::span<const std::byte>) {
    assert(false);
    return {};
}
#endif

}  // namespace srbf
