// Meshes: the built-in ones are closed surfaces, files give back what they hold, bad ones an error.
#include "extras/render/mesh.h"

#include <fmt/format.h>

#include "../fuzz/targets.h"
#include "bad_texts.h"
#include "srbf/file.h"
#include "temporary_folder.h"

namespace srbf::mesh_test {
namespace {

Vec3d position(const Mesh& mesh, std::uint32_t i) { return to_double(mesh.positions[i]); }

/// Every edge is shared by two triangles that pass it in opposite directions.
bool is_closed(const Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> passes;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++passes[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : passes) {
        const auto back = passes.find({edge.second, edge.first});
        if (count != 1 || back == passes.end() || back->second != 1) return false;
    }
    return true;
}

/// Returns the volume of a closed surface whose triangles run counter-clockwise; negative where they run the other way.
double volume(const Mesh& mesh) {
    double six = 0;
    for (const Triangle& t : mesh.triangles)
        six += dot(position(mesh, t[0]), cross(position(mesh, t[1]), position(mesh, t[2])));
    return six / 6;
}

/// The largest angle between a vertex' normal and that of its triangles.
double normals_off(const Mesh& mesh) {
    const auto triangle_normals = area_weighted_normals(mesh.positions, mesh.triangles);
    double max = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3d difference = to_double(triangle_normals[i]) - to_double(mesh.normals[i]);
        max = std::max(max, std::sqrt(dot(difference, difference)));
    }
    return max;
}

TEST(Mesh, SphereIsClosedAndHasItsVolume) {
    Mesh mesh = sphere();
    for (const Vec3f& p : mesh.positions) EXPECT_WITHIN(dot(p, p), 1, 1e-6);
    EXPECT_WITHIN_RELATIVE(volume(mesh), 4 * k_pi / 3, 2e-3);
    EXPECT_EQ(mesh.triangles.size(), 2u * 192 * 95);
    check_mesh(mesh);
    // The poles are one point of many numbers.
    const auto ring = [](std::uint32_t i) { return i / 192; };
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& i : t)
            if (ring(i) == 0 || ring(i) == 96) i = 192 * ring(i);
    EXPECT_TRUE(is_closed(mesh));
}

TEST(Mesh, KnotIsAClosedTube) {
    const Mesh mesh = knot();
    check_mesh(mesh);
    EXPECT_TRUE(is_closed(mesh));
    double length = 0;
    for (int i = 0; i < 480; ++i) {
        const auto middle = [&](int ring) {
            return 0.5 * (position(mesh, std::uint32_t(ring % 480 * 64)) +
                          position(mesh, std::uint32_t(ring % 480 * 64 + 32)));
        };
        const Vec3d step = middle(i + 1) - middle(i);
        length += std::sqrt(dot(step, step));
    }
    EXPECT_WITHIN_RELATIVE(volume(mesh), k_pi * 0.32 * 0.32 * length, 3e-3);
    EXPECT_LT(normals_off(mesh), 0.02);
}

TEST(Mesh, TrianglesFaceAsTheirNormalsDo) {
    for (const std::string_view name : k_built_in_meshes) {
        const Mesh mesh = *load_mesh(std::string(name));
        for (const Triangle& t : mesh.triangles) {
            const auto at = [&](std::size_t k) { return to_double(mesh.positions[t[k]]); };
            const Vec3d facing = normalize(cross(at(1) - at(0), at(2) - at(0)));
            for (const std::uint32_t i : t) ASSERT_GT(dot(facing, to_double(mesh.normals[i])), 0.9) << name;
        }
    }
}

TEST(Mesh, NormalsAreWeightedByArea) {
    // Two triangles at a right angle, of areas 1 and 2, share the edge from 0 to 1.
    const std::vector<Vec3f> p{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 4}, {9, 9, 9}};
    const std::vector<Triangle> t{{0, 1, 2}, {0, 3, 1}};
    const auto n = area_weighted_normals(p, t);
    const float s = 1 / std::sqrt(5.f);
    for (const std::size_t i : {0u, 1u}) {
        EXPECT_WITHIN(n[i].x, 0, 1e-7);
        EXPECT_WITHIN(n[i].y, 2 * s, 1e-6);
        EXPECT_WITHIN(n[i].z, s, 1e-6);
    }
    EXPECT_EQ(n[2], (Vec3f{0, 0, 1}));
    EXPECT_EQ(n[3], (Vec3f{0, 1, 0}));
    EXPECT_EQ(n[4], (Vec3f{0, 0, 1}));  // of no triangle
}

std::string corpus(const std::string& name) {
    return read_text(std::filesystem::path(SRBF_SOURCE_DIR) / "fuzz" / "corpus" / name);
}
Result<Mesh> read(const std::string& text) { return read_mesh(as_bytes(text), "f"); }

TEST(Ply, HoldsOneMeshInThreeEncodings) {
    const std::vector<Triangle> triangles{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (const std::string name : {"ply/ascii", "ply/little", "ply/big"}) {
        const auto mesh = checked(read(corpus(name)));
        EXPECT_EQ(mesh->positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})) << name;
        EXPECT_EQ(mesh->triangles.size(), name == "ply/ascii" ? 4u : 3u);
        const float s = -1 / std::sqrt(3.f);
        EXPECT_WITHIN(mesh->normals[0].x, s, 1e-6);
        EXPECT_WITHIN(mesh->normals[0].z, s, 1e-6);
        EXPECT_EQ(mesh->normals[3], (Vec3f{0, 0, 1}));
        // The binary ones hold a polygon of four corners and a triangle.
        if (name == "ply/ascii")
            EXPECT_EQ(mesh->triangles, triangles);
        else
            EXPECT_EQ(mesh->triangles, (std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}}));
    }
}

TEST(Ply, SkipsUnknownElements) {
    const auto mesh = checked(read(corpus("ply/others")));
    EXPECT_EQ(mesh->positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh->normals, std::vector<Vec3f>(3, Vec3f{0, 0, 1}));
}

TEST(Obj, TrianglesInsideOutAreReversed) {
    const std::string vertices = "v 5 5 5\nv 6 5 5\nv 5 6 5\nv 5 5 6\n";
    const auto outside = checked(read(vertices + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"));
    const auto inside = checked(read(vertices + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"));
    EXPECT_EQ(outside->triangles, inside->triangles);
    EXPECT_EQ(outside->normals, inside->normals);
    EXPECT_LT(outside->normals[0].x, 0);
}

TEST(Obj, TakesAVertexForEachPairOfPositionAndNormal) {
    const auto mesh = checked(read(corpus("obj/normals")));
    EXPECT_EQ(mesh->triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {4, 5, 2}}));
    EXPECT_EQ(mesh->positions.size(), 6u);
    EXPECT_EQ(mesh->positions[0], mesh->positions[4]);
    EXPECT_EQ(mesh->normals, std::vector<Vec3f>(6, Vec3f{0, 0, 1}));
    const auto bare = checked(read(corpus("obj/bare")));
    EXPECT_EQ(bare->triangles.size(), 2u);
    EXPECT_EQ(bare->normals[1], (Vec3f{0, 0, 1}));
}

/// A map is wrapped around built-in meshes once, continuously but for where its edges meet, and on a sphere as a globe.
TEST(Mesh, BuiltInMeshesHavePlacesInAMap) {
    for (const std::string_view name : k_built_in_meshes) {
        const Mesh mesh = *load_mesh(std::string(name));
        ASSERT_EQ(mesh.texture.size(), mesh.triangles.size()) << name;
        for (const auto& corners : mesh.texture)
            for (const Vec2f& a : corners)
                for (const Vec2f& b : corners) ASSERT_LT(std::abs(a.x - b.x) + std::abs(a.y - b.y), 0.06f) << name;
    }
    const Mesh globe = sphere();
    for (std::size_t i = 0; i < globe.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f p = globe.positions[globe.triangles[i][k]];
            const Vec2f uv = globe.texture[i][k];
            const double theta = k_pi * double(uv.y), phi = 2 * k_pi * double(uv.x - 0.5f);
            EXPECT_WITHIN(p.y, std::cos(theta), 1e-5);
            EXPECT_WITHIN(p.x, std::sin(theta) * std::sin(phi), 1e-5);
            EXPECT_WITHIN(p.z, std::sin(theta) * std::cos(phi), 1e-5);
        }
}

TEST(Mesh, FilesHavePlacesInAMap) {
    using Corners = std::array<Vec2f, 3>;
    const auto expect = [](const Result<Mesh>& mesh, const std::vector<Corners>& expected) {
        ASSERT_TRUE(mesh) << message(mesh.error());
        ASSERT_EQ(mesh->texture.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_TRUE(mesh->texture[i][k].x == expected[i][k].x && mesh->texture[i][k].y == expected[i][k].y);
    };
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0.25\nvt 0.5 1\nvt nan 1\n", normal = "vn 0 0 1\n";
    expect(read(obj + normal + "f 1/1/1 2/2/1 3/-1/1\n"), {{{{0, 0.75f}, {0.5f, 0}, {0, 0}}}});
    expect(read(obj + normal + "f 1/1/1 2//1 3/1/1\n"), {});  // not of every corner
    expect(read(obj + "f 1/1 2/9 3/1\n"), {});
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0.25\n1 0 0 0.5 1\n1 1 0 2 0\n3 0 1 2\n";
    const Result<Mesh> flat = read(ply);
    expect(flat, {{{{0, 0.75f}, {0.5f, 0}, {2, 1}}}});
    // Inside out: corners and places are exchanged together.
    const auto turned = read(
        "v 5 5 5\nv 6 5 5\nv 5 6 5\nv 5 5 6\nvt 0 1\nvt 1 1\nvt 1 0\n"
        "f 1/1 2/2 3/3\nf 1/1 4/2 2/3\nf 1/1 3/2 4/3\nf 2/1 4/2 3/3\n");
    const Corners corner_places{{{0, 0}, {1, 1}, {1, 0}}};
    expect(turned, {corner_places, corner_places, corner_places, corner_places});
}

constexpr const char* k_no_faces = "f: faces of the mesh: expected one at least, found none";

TEST(Ply, BadFilesAreErrors) {
    const std::string ascii = corpus("ply/ascii"), little = corpus("ply/little");
    EXPECT_EQ(error_text(read(ascii)), "");
    expect_errors(read, ascii,
                  {{"face 4", "face 0", k_no_faces},
                   {"1 2 3\n", "1 2 4\n", "f: vertex index of a face: expected below 4, found 4"},
                   {"1 2 3\n", "1 2 -3\n", "expected a number from 0 on, found -3"},
                   {"1 2 3\n", "1 2 3.5\n", "found 3.5"},
                   {"1 0 0 1 0 0", "1 nan 0 1 0 0", "vertex 2 of 4: expected finite"},
                   {"1 0 0 1 0 0", "1 0 1e99 1 0 0", "vertex 2 of 4"},
                   {"1 0 0 1 0 0", "1 0 0 1 inf 0", "vertex 2 of 4"},
                   {"1 0 0 1 0 0", "1 zero 0 1 0 0", "found 'zero'"},
                   {"float y", "float w", "expected x, y and z"},
                   {"float y", "single y", "line 6: type of a property"},
                   {"ascii", "ebcdic", "line 2: format"},
                   {"end_header", "end", "no end_header"},
                   {"element face", "element vertex", "one vertex, found a second one"},
                   {"uchar int", "float int", "type of a list's length"},
                   {"\n3 1 2 3", "\n3000000000 1 2 3", "length of a list of face 4"}});
    for (const std::string& file : {ascii, little})
        for (const char* count :
             {"9", "4294967295", "4294967296", "18446744073709551615", "18446744073709551616", "-1"})
            EXPECT_NE(error_text(read(replaced(file, "vertex 4", std::string("vertex ") + count))), "") << count;
}

TEST(Ply, EveryTruncationIsAnError) {
    for (const std::string name : {"ply/little", "ply/big", "ply/ascii"}) {
        SCOPED_TRACE(name);
        // The last number of a text ends with the file as well as with a line.
        expect_truncations_refused(read, corpus(name), name == "ply/ascii" ? 2 : 1);
    }
}

TEST(Mesh, FlippedBytesBreakNoPromise) {
    for (const std::string name : {"ply/little", "ply/big", "ply/ascii", "ply/others", "obj/normals", "obj/bare"}) {
        const std::string file = corpus(name);
        for (std::size_t at = 0; at < file.size(); ++at)
            for (const char flip : {'\x01', '\x10', '\x40', '\x80', '\xff'}) {
                std::string changed = file;
                changed[at] = char(changed[at] ^ flip);
                check_mesh(read(changed));
            }
    }
}

TEST(Obj, BadFilesAreErrors) {
    expect_errors(read, corpus("obj/normals"),
                  {{"v 1 0 0", "v 1 nan 0", "line 4: v: expected three numbers"},
                   {"v 1 0 0", "v 1 0", "line 4"},
                   {"2/1/1", "5/1/1", "line 10: corner of a face"},
                   {"2/1/1", "2/1/3", "line 10"},
                   {"2/1/1", "0/1/1", "line 10"},
                   {"-4//-1", "-5//-1", "line 11"},
                   {"-4//-1", "x", "found 'x'"}});
    for (const char* text : {"v 0 0 0\nf 1 1\n", ""}) EXPECT_EQ(error_text(read(text)), k_no_faces);
}

/// A triangle with sides of that length.
std::string triangle(const char* length) { return fmt::format("v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nf 1 2 3\n", length); }

TEST(Obj, SizesThatNoSceneHasAreErrors) {
    for (const char* length : {"1e7", "-1e7", "1e-7"}) EXPECT_EQ(error_text(read(triangle(length))), "") << length;
    for (const char* length : {"1.1e7", "-1.1e7", "1e18", "3.4e38"})
        EXPECT_CONTAINS(error_text(read(triangle(length))), "coordinates of the mesh: expected at most 1e+07");
    for (const char* length : {"9e-8", "1e-38", "0"})
        EXPECT_CONTAINS(error_text(read(triangle(length))), "extent of the mesh: expected at least 1e-07");
}

TEST(Mesh, IsLoadedByItsNameOrItsFile) {
    EXPECT_EQ(load_mesh("sphere")->positions, sphere().positions);
    EXPECT_EQ(load_mesh("knot")->positions, knot().positions);
    const TemporaryFolder folder;
    EXPECT_FALSE(load_mesh(folder / "none.ply").ok());
    write_text(folder / "sphere", corpus("obj/bare"));
    EXPECT_EQ(load_mesh(folder / "sphere")->positions.size(), 3u);
}

TEST(Mesh, ReadsTheScansOfStanford) {
    struct Scan {
        const char* file;
        std::size_t vertices, triangles;
    };
    for (const Scan& scan :
         {Scan{"bunny.ply", 35947, 69451}, {"buddha.obj", 9990, 20000}, {"dragon.ply", 22998, 47794}}) {
        const auto path = shared_data() / "meshes" / scan.file;
        if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
        const auto mesh = checked(load_mesh(path));
        check_mesh(mesh);
        EXPECT_EQ(mesh->positions.size(), scan.vertices);
        EXPECT_EQ(mesh->triangles.size(), scan.triangles);
        EXPECT_GT(volume(*mesh), 0) << scan.file;
    }
}

}  // namespace
}  // namespace srbf::mesh_test
