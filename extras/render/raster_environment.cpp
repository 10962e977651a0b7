#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "base/half.h"
#include "extras/render/raster.h"
#include "src/base/r_sequence.h"

namespace SRBF_NAMESPACE {
namespace {

/// A texture with `levels` mip levels, still without texels.
GlObject new_mip_texture(int levels) {
    GlObject texture = new_texture(GL_TEXTURE_2D, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, levels - 1);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    return texture;
}

}  // namespace

Result<RasterEnvironment> RasterEnvironment::make(const Environment& source) {
    const Image& texels = source.texels();
    const auto fits = check_gl_size("texels of an environment along a side",
                                    std::uint64_t(std::max(texels.width, texels.height)) + 1, GL_MAX_TEXTURE_SIZE);
    if (!fits) return fits.error();
    RasterEnvironment environment;
    float maximum = 0;
    for (const Rgb& texel : texels.pixels) maximum = std::max({maximum, texel.r, texel.g, texel.b});
    environment.scale_ = std::max(1.f, maximum / k_half_max);
    const int levels = std::bit_width(unsigned(std::max(texels.width, texels.height)));
    environment.radiance_ = new_mip_texture(levels);
    Image level = texels;
    for (int k = 0; k < levels; ++k) {
        if (k > 0) level = halved(level);
        std::vector<std::array<std::uint16_t, 4>> halves(level.pixels.size());
        for (std::size_t i = 0; i < halves.size(); ++i)
            for (int c = 0; c < 3; ++c) halves[i][std::size_t(c)] = to_half(level.pixels[i][c] / environment.scale_);
        glTexImage2D(GL_TEXTURE_2D, k, GL_RGBA16F, level.width, level.height, 0, GL_RGBA, GL_HALF_FLOAT, halves.data());
    }
    const auto sums = [](std::span<const float> numbers, int width, int height) {
        GlObject texture = new_texture(GL_TEXTURE_2D, GL_NEAREST);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, width, height, 0, GL_RED, GL_FLOAT, numbers.data());
        return texture;
    };
    environment.columns_ = sums(source.columns(), texels.width + 1, texels.height);
    environment.rows_ = sums(source.rows(), texels.height + 1, 1);
    if (glGetError() == GL_OUT_OF_MEMORY)
        return gl_error("environment", "memory of the graphics library",
                        fmt::format("{} x {} texels", texels.width, texels.height));
    return environment;
}

Result<RasterMean> RasterMean::make(const RasterSurface& surface) {
    auto first = RasterTarget::make_for(surface, RasterTarget::Format::floats);
    if (!first) return first.error();
    auto second = RasterTarget::make_for(surface, RasterTarget::Format::floats);
    if (!second) return second.error();
    return RasterMean({*std::move(first), *std::move(second)});
}

void RasterMean::add(const RasterMaterial& material, const RasterSurface& surface, const RasterView& view,
                     const EnvironmentLight& light) {
    const RasterTarget& before = picture();
    const RasterTarget& after = targets_[std::size_t((samples_ + 1) % 2)];
    after.begin();
    material.draw(surface, view, light, before, samples_);
    ++samples_;
}

std::array<double, 2> sample_shift(int i, int width, int height) {
    const auto point = RSequence<2>().at(std::size_t(i));
    return {(point[0] - 0.5) / width, (point[1] - 0.5) / height};
}

}  // namespace srbf
