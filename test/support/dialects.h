// A fixture of tests that draw off screen, once for each dialect of OpenGL.
#pragma once
#include <gtest/gtest.h>

#include "extras/render/offscreen.h"

namespace srbf {

/// Skips the test if no context of its dialect can be created.
class OpenGLTest : public testing::TestWithParam<Dialect> {
  protected:
    void SetUp() override {
        auto made = OffscreenContext::make(GetParam());
        if (!made) GTEST_SKIP() << message(made.error());
        context.emplace(*std::move(made));
    }

    std::optional<OffscreenContext> context;
};

/// Names the tests All/SUITE.TEST/OpenGL.
#define IN_EACH_DIALECT(SUITE)                                                              \
    INSTANTIATE_TEST_SUITE_P(All, SUITE, testing::Values(Dialect::gl_450, Dialect::es_300), \
                             [](const auto& test) { return test.param == Dialect::gl_450 ? "OpenGL" : "OpenGLES"; })

}  // namespace srbf
