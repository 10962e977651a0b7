// A sphere of a measured material under the sun of Filament 1.9: sphere measured.filamat PICTURE
//
// Needs a display and libfilament-dev. In measured.mat, CODE stands for the GLSL that `srbf export material.srbf --to
// glsl -o material.glsl` writes; `matc --api opengl --platform desktop -o measured.filamat measured.mat` of
// libfilament-tools compiles it. Writes 256 x 256 x 4 floats of 32 bits, linear, the highest row first.
#include <filament/Camera.h>
#include <filament/Engine.h>
#include <filament/IndexBuffer.h>
#include <filament/LightManager.h>
#include <filament/Material.h>
#include <filament/RenderTarget.h>
#include <filament/RenderableManager.h>
#include <filament/Renderer.h>
#include <filament/Scene.h>
#include <filament/Texture.h>
#include <filament/VertexBuffer.h>
#include <filament/View.h>
#include <filament/Viewport.h>
#include <geometry/SurfaceOrientation.h>
#include <utils/EntityManager.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

using namespace filament;
using namespace filament::math;

constexpr uint32_t size = 256, rows = 128, columns = 256;

int main(int, char** arguments) {
    std::vector<float3> normals;
    std::vector<uint32_t> corners;
    for (uint32_t i = 0; i <= rows; ++i)
        for (uint32_t j = 0; j <= columns; ++j) {
            const float theta = M_PI * i / rows, phi = 2 * M_PI * j / columns;
            normals.push_back({std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
            const uint32_t a = i * (columns + 1) + j, b = a + columns + 1;
            if (i < rows && j < columns) corners.insert(corners.end(), {a, a + 1, b, a + 1, b + 1, b});
        }
    std::vector<quatf> tangents(normals.size());
    auto* const frames =
        geometry::SurfaceOrientation::Builder().vertexCount(normals.size()).normals(normals.data()).build();
    frames->getQuats(tangents.data(), tangents.size());

    Engine* const engine = Engine::create(Engine::Backend::OPENGL);
    Scene* const scene = engine->createScene();
    VertexBuffer* const vertices = VertexBuffer::Builder()
                                       .bufferCount(2)
                                       .vertexCount(normals.size())
                                       .attribute(VertexAttribute::POSITION, 0, VertexBuffer::AttributeType::FLOAT3)
                                       .attribute(VertexAttribute::TANGENTS, 1, VertexBuffer::AttributeType::FLOAT4)
                                       .build(*engine);
    vertices->setBufferAt(*engine, 0, {normals.data(), normals.size() * sizeof(float3)});
    vertices->setBufferAt(*engine, 1, {tangents.data(), tangents.size() * sizeof(quatf)});
    IndexBuffer* const indices =
        IndexBuffer::Builder().indexCount(corners.size()).bufferType(IndexBuffer::IndexType::UINT).build(*engine);
    indices->setBuffer(*engine, {corners.data(), corners.size() * sizeof(uint32_t)});

    std::ifstream file(arguments[1], std::ios::binary);
    const std::vector<char> package{std::istreambuf_iterator<char>(file), {}};
    Material* const material = Material::Builder().package(package.data(), package.size()).build(*engine);
    const auto create = [] { return utils::EntityManager::get().create(); };
    const utils::Entity ball = create(), sun = create();
    RenderableManager::Builder(1)
        .boundingBox({{0, 0, 0}, {1, 1, 1}})
        .material(0, material->getDefaultInstance())
        .geometry(0, RenderableManager::PrimitiveType::TRIANGLES, vertices, indices)
        .build(*engine, ball);
    LightManager::Builder(LightManager::Type::DIRECTIONAL)
        .color({1, 1, 1})
        .intensity(3)
        .direction({2, -2, -3})
        .build(*engine, sun);
    scene->addEntity(ball), scene->addEntity(sun);

    Camera* const camera = engine->createCamera(create());
    camera->setProjection(26, 1, 0.1, 100);
    camera->lookAt({0, 0, 5}, {0, 0, 0});
    camera->setExposure(1);
    using Format = Texture::InternalFormat;
    using Usage = Texture::Usage;
    const auto attachment = [&](Format format, Usage usage) {
        return Texture::Builder().width(size).height(size).format(format).usage(usage).build(*engine);
    };
    RenderTarget* const target =
        RenderTarget::Builder()
            .texture(RenderTarget::AttachmentPoint::COLOR, attachment(Format::RGBA32F, Usage::COLOR_ATTACHMENT))
            .texture(RenderTarget::AttachmentPoint::DEPTH, attachment(Format::DEPTH24, Usage::DEPTH_ATTACHMENT))
            .build(*engine);
    View* const view = engine->createView();
    view->setScene(scene), view->setCamera(camera), view->setViewport({0, 0, size, size}),
        view->setRenderTarget(target);
    view->setPostProcessingEnabled(false);

    Renderer* const renderer = engine->createRenderer();
    SwapChain* const surface = engine->createSwapChain(size, size, 0);
    std::vector<float4> picture(size * size);
    while (!renderer->beginFrame(surface)) {
    }
    renderer->render(view);
    renderer->readPixels(target, 0, 0, size, size,
                         {picture.data(), picture.size() * sizeof(float4), backend::PixelDataFormat::RGBA,
                          backend::PixelDataType::FLOAT});
    renderer->endFrame();
    engine->flushAndWait();
    std::FILE* const out = std::fopen(arguments[2], "wb");
    std::fwrite(picture.data(), sizeof(float4), picture.size(), out);
    std::fclose(out);
}
