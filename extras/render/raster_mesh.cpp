#include <epoxy/gl.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "brdf/frame.h"
#include "extras/render/raster.h"

namespace SRBF_NAMESPACE {
namespace {

/// The transform from x, y, z, w to OpenGL's clip coordinates, column-major.
std::array<float, 16> to_clip(const RasterView& view, const Bounds& box) {
    const Camera& camera = view.camera;
    const Frame axes = frame(camera);
    double near = HUGE_VAL, far = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p{corner & 1 ? box.least.x : box.most.x, corner & 2 ? box.least.y : box.most.y,
                      corner & 4 ? box.least.z : box.most.z};
        const double depth = -dot(p - camera.eye, axes.z);
        near = std::min(near, depth), far = std::max(far, depth);
    }
    far = std::max(far * 1.01, 1e-30);
    near = std::max(near * 0.99, far * 1e-4);
    const double half = std::tan(camera.fov / 2);
    const double scale_z = (near + far) / (near - far), shift_z = 2 * near * far / (near - far);
    // Rows of the matrix, to be multiplied by (p − eye): x, y, z' and −z.
    const std::array<Vec3d, 4> rows{1 / (half * view.aspect) * axes.x + 2 * view.shift[0] * axes.z,
                                    1 / half * axes.y + 2 * view.shift[1] * axes.z, scale_z * axes.z, -1.0 * axes.z};
    std::array<float, 16> columns{};
    for (std::size_t r = 0; r < 4; ++r) {
        columns[r] = float(rows[r].x), columns[4 + r] = float(rows[r].y), columns[8 + r] = float(rows[r].z);
        columns[12 + r] = float((r == 2 ? shift_z : 0) - dot(rows[r], camera.eye));
    }
    return columns;
}

}  // namespace

RasterMesh::RasterMesh(const Mesh& mesh, bool textured)
    : bounds_(srbf::bounds(mesh)), corners_(int(3 * mesh.triangles.size())) {
    assert(mesh.normals.size() == mesh.positions.size());
    if (textured) {
        load_corners(mesh);
        return;
    }
    array_ = new_array();
    glBindVertexArray(array_.id());
    std::vector<std::array<Vec3f, 2>> vertices(mesh.positions.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = {mesh.positions[i], mesh.normals[i]};
    constexpr GLsizei stride = sizeof vertices[0];
    vertices_ = new_buffer(GL_ARRAY_BUFFER, vertices.data(), vertices.size() * stride, GL_STATIC_DRAW);
    for (const GLuint attribute : {0u, 1u}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, stride,
                              reinterpret_cast<const void*>(attribute * sizeof(Vec3f)));
    }
    triangles_ = new_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle),
                            GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void RasterMesh::load_corners(const Mesh& mesh) {
    assert(mesh.texture.size() == mesh.triangles.size());
    struct Corner {
        Vec3f position, normal;
        Vec2f texture;
    };
    std::vector<Corner> corners;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = mesh.triangles[i][k];
            corners.push_back({mesh.positions[vertex], mesh.normals[vertex], mesh.texture[i][k]});
        }
    array_ = new_array();
    glBindVertexArray(array_.id());
    vertices_ = new_buffer(GL_ARRAY_BUFFER, corners.data(), corners.size() * sizeof(Corner), GL_STATIC_DRAW);
    for (const GLuint attribute : {0u, 1u, 2u}) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribPointer(attribute, attribute == 2 ? 2 : 3, GL_FLOAT, GL_FALSE, sizeof(Corner),
                              reinterpret_cast<const void*>(attribute * sizeof(Vec3f)));
    }
    glBindVertexArray(0);
}

void RasterMesh::draw(const GlObject& program, const RasterView& view) const {
    glUniformMatrix4fv(glGetUniformLocation(program.id(), "to_clip"), 1, GL_FALSE, to_clip(view, bounds_).data());
    glEnable(GL_DEPTH_TEST);
    if (!view.back_faces) glEnable(GL_CULL_FACE);
    glBindVertexArray(array_.id());
    if (triangles_.id() != 0)
        glDrawElements(GL_TRIANGLES, corners_, GL_UNSIGNED_INT, nullptr);
    else
        glDrawArrays(GL_TRIANGLES, 0, corners_);
    glBindVertexArray(0);
    glDisable(GL_CULL_FACE);
}

}  // namespace srbf
