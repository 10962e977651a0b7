#include <epoxy/gl.h>

#include "extras/render/raster.h"

namespace SRBF_NAMESPACE {

Result<RasterDevelopment> RasterDevelopment::make(Dialect dialect) {
    auto program = new_program(develop_shader_text(dialect));
    if (!program) return program.error();
    RasterDevelopment development;
    development.program_ = *std::move(program);
    development.no_array_ = new_array();
    return development;
}

void RasterDevelopment::draw(const RasterTarget& radiance, const RasterTarget& other, float exposure, float full_scale,
                             bool in_delta_e) const {
    glUseProgram(program_.id());
    const auto place = [&](const char* uniform) { return glGetUniformLocation(program_.id(), uniform); };
    const auto set = [&](const char* uniform, Rgb c) { glUniform3f(place(uniform), c.r, c.g, c.b); };
    const float grey = float(srgb_encoded(double(k_background)));
    set("background", {grey, grey, grey}), set("darker", k_darker), set("as_bright", k_equal),
        set("brighter", k_brighter);
    glUniform1f(place("exposure"), exposure);
    glUniform1f(place("full_scale"), full_scale);
    glUniform1i(place("in_delta_e"), in_delta_e);
    glUniform1i(place("radiance"), 0), glUniform1i(place("other"), 1);
    bind_texture(0, GL_TEXTURE_2D, radiance.colour_);
    bind_texture(1, GL_TEXTURE_2D, other.colour_);
    glDisable(GL_DEPTH_TEST);
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

}  // namespace srbf
