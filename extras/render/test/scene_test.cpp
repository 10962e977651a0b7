// The camera sees the whole mesh, without distortion.
#include "extras/render/scene.h"

#include "brdf/directions.h"
#include "properties.h"

namespace srbf::scene_test {
namespace {

void expect_orthonormal(const Frame& f) {
    for (const auto& [a, b, product] :
         {std::tuple{f.x, f.x, 1}, {f.y, f.y, 1}, {f.z, f.z, 1}, {f.x, f.y, 0}, {f.y, f.z, 0}})
        EXPECT_WITHIN(dot(a, b), product, 1e-12);
    EXPECT_WITHIN(dot(cross(f.x, f.y), f.z), 1, 1e-12);
}

TEST(Camera, SeesTheWholeMeshAndLittleElse) {
    std::mt19937_64 random(1);
    const Mesh mesh = knot(60, 8);
    for (const bool z_up : {false, true})
        for (int i = 0; i < 40; ++i) {
            const Viewpoint viewpoint{7 * uniform(random), (2 * uniform(random) - 1) * 1.5, 0.2 + uniform(random),
                                      z_up};
            const double aspect = 0.3 + 2 * uniform(random);
            const Camera camera = camera_of(mesh, viewpoint, aspect);
            const Frame axes = frame(camera);
            expect_orthonormal(axes);
            EXPECT_GT(z_up ? axes.y.z : axes.y.y, 0);
            EXPECT_WITHIN(z_up ? axes.z.z : axes.z.y, std::sin(viewpoint.elevation), 1e-9);
            double max = 0;
            for (const Vec3f& p : mesh.positions) {
                const Vec3d seen = axes.to(to_double(p) - camera.eye);
                ASSERT_LT(seen.z, 0);
                const double half = -seen.z * std::tan(camera.fov / 2);
                max = std::max({max, std::abs(seen.x) / half / aspect, std::abs(seen.y) / half});
            }
            EXPECT_WITHIN(max, 1 - k_margin, 1e-9);
        }
}

TEST(Camera, MayLookStraightDownAndUp) {
    for (const double elevation : {k_pi / 2, -k_pi / 2}) {
        const Camera camera = camera_of(sphere(8), {.azimuth = 0.5, .elevation = elevation}, 1);
        expect_orthonormal(frame(camera));
        EXPECT_WITHIN(frame(camera).z.y, elevation > 0 ? 1 : -1, 1e-9);
        // The camera is upright as it is just before the pole.
        const Camera before = camera_of(sphere(8), {.azimuth = 0.5, .elevation = 0.999 * elevation}, 1);
        EXPECT_GT(dot(frame(camera).x, frame(before).x), 0.999);
    }
}

TEST(Camera, DirectionsGoThroughThePicture) {
    const Camera camera{{1, 2, 3}, {0, 0.5, -1}, {0, 1, 0}, 0.7};
    const Frame axes = frame(camera);
    const Vec3d middle = direction_through(camera, 1.5, 0, 0);
    EXPECT_WITHIN(dot(middle, axes.z), -1, 1e-12);
    const Vec3d top = direction_through(camera, 1.5, 0, 1), right = direction_through(camera, 1.5, 1, 0);
    EXPECT_WITHIN(std::acos(dot(middle, top)), 0.35, 1e-9);
    EXPECT_GT(dot(top, axes.y), 0);
    EXPECT_WITHIN(dot(right, axes.x) / -dot(right, axes.z), 1.5 * std::tan(0.35), 1e-9);
}

TEST(Lights, StandWithTheCamera) {
    const Camera ahead{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.5}, beside{{5, 0, 0}, {0, 0, 0}, {0, 1, 0}, 0.5};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d w = k_three_lights[k].towards;
        EXPECT_WITHIN(dot(lights_of(ahead)[k].towards, w), 1, 1e-12);
        EXPECT_WITHIN(dot(lights_of(beside)[k].towards, Vec3d{w.z, w.y, -w.x}), 1, 1e-12);
    }
}

TEST(SurfaceFrame, LiesAlongLatitudes) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3d n = random_direction(random);
        const Frame f = surface_frame(n);
        expect_orthonormal(f);
        EXPECT_WITHIN(f.x.y, 0, 1e-15);
        EXPECT_GE(f.y.y, 0);
        const Vec3d w = random_direction(random), there = f.from(f.to(w));
        EXPECT_WITHIN(dot(there, w), 1, 1e-12);
    }
    expect_orthonormal(surface_frame({0, 1, 0}));
    expect_orthonormal(surface_frame({0, -1, 0}));
}

}  // namespace
}  // namespace srbf::scene_test
