#include "extras/render/rays.h"

#include <limits>
#include <new>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "src/base/parallel.h"

namespace SRBF_NAMESPACE {
namespace {

RTCScene scene_of(const std::shared_ptr<void>& pointer) { return static_cast<RTCScene>(pointer.get()); }

RTCRay ray_of(Vec3f origin, Vec3f direction, float furthest) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tfar = furthest;
    ray.mask = ~0u;
    return ray;
}

// The two versions differ in the arguments of a query.
#if RTC_VERSION_MAJOR >= 4
void intersect(RTCScene scene, RTCRayHit& hit) { rtcIntersect1(scene, &hit); }
void occlude(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray); }
#else
void intersect(RTCScene scene, RTCRayHit& hit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &hit);
}
void occlude(RTCScene scene, RTCRay& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
}
#endif

}  // namespace

namespace {

/// Embree returns null if memory does not suffice.
template <typename T> T* require_memory(T* object) {
    if (object == nullptr) throw std::bad_alloc();
    return object;
}

}  // namespace

Rays::Rays(const std::vector<const Mesh*>& meshes) {
    device_ = {
        require_memory(rtcNewDevice("set_affinity=0")),  // its option `threads` would limit Embree in the whole process
        [](void* device) { rtcReleaseDevice(static_cast<RTCDevice>(device)); }};
    const auto device = static_cast<RTCDevice>(device_.get());
    scene_ = {require_memory(rtcNewScene(device)), [](void* scene) { rtcReleaseScene(static_cast<RTCScene>(scene)); }};
    rtcSetSceneFlags(scene_of(scene_), RTC_SCENE_FLAG_ROBUST);
    for (unsigned i = 0; i < meshes.size(); ++i) {
        const Mesh& mesh = *meshes[i];
        const RTCGeometry geometry = require_memory(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
        // Embree reads 16 bytes for a vertex of 12, so that vertices are copied into its own padded buffer.
        auto* vertices = static_cast<Vec3f*>(require_memory(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), mesh.positions.size())));
        std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
        auto* triangles = static_cast<Triangle*>(require_memory(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size())));
        std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_of(scene_), geometry, i);
        rtcReleaseGeometry(geometry);
    }
    // On one thread, the tree of such a mesh is built quickly and independently of the machine.
    on_threads(1, [&] { rtcCommitScene(scene_of(scene_)); });
    if (rtcGetDeviceError(device) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
}

std::optional<Hit> Rays::closest(Vec3f origin, Vec3f direction) const {
    RTCRayHit query{};
    query.ray = ray_of(origin, direction, std::numeric_limits<float>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect(scene_of(scene_), query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return Hit{query.ray.tfar, query.hit.geomID, query.hit.primID,
               query.hit.u,    query.hit.v,      normalize(Vec3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z))};
}

bool Rays::occluded(Vec3f origin, Vec3f direction, float distance) const {
    RTCRay ray = ray_of(origin, direction, distance);
    occlude(scene_of(scene_), ray);
    return ray.tfar < 0;
}

Vec2f texture_at(const Mesh& mesh, const Hit& hit) {
    const auto& [a, b, c] = mesh.texture[hit.triangle];
    const float weight = 1 - hit.u - hit.v;
    return {weight * a.x + hit.u * b.x + hit.v * c.x, weight * a.y + hit.u * b.y + hit.v * c.y};
}

}  // namespace
