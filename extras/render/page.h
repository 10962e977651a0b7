// A self-contained HTML page about materials, with WebGL 2 pictures, plots and tables.
#pragma once
#include <optional>

#include "extras/render/mesh.h"
#include "extras/render/pixel_shader.h"
#include "extras/render/tone.h"
#include "srbf/brdf.h"

namespace SRBF_NAMESPACE {

/// One of the BRDFs that a page compares.
struct PageMaterial {
    std::string name;                  ///< "Measured", "film"
    std::string kind;                  ///< "multivariate, 208 bytes"
    std::optional<Material> material;  ///< what its picture shows; none: only plots and tables
    Evaluate brdf;                     ///< the function that plots show
    bool both_sides = false;           ///< true for a BSDF, whose plots go all around
    std::string parameters;            ///< text to read and copy; may be empty
};

struct Page {
    std::string title;
    std::vector<PageMaterial> materials;  ///< one or more materials; plots draw the first widest
    /// A table with one column per material.
    struct Row {
        std::string name, meaning;       ///< `meaning` appears below the table; may be empty
        std::vector<std::string> cells;  ///< one per material
    };
    std::vector<Row> table;
    std::string table_note, picture_note;  ///< below the table and below the pictures
    std::string generator;                 ///< the last line: the program that wrote the page
    std::optional<Mesh> mesh;              ///< the initial shape, with y upwards, beside the built-in ones
    std::string mesh_name;
};

/// The page: HTML in UTF-8 without external references. Its shaders come from `shader_text` in OpenGL ES 3.0; the page
/// displays their text and compiles it. The initial picture shows `mesh`, or `page_mesh("ball")`, from `Viewpoint{}`
/// under `k_three_lights`, with the automatic_exposure of the sphere of the first material with a picture.
std::string page_html(const Page& page);

/// The automatic_exposure of a sphere under `k_three_lights`.
float exposure_under_lights(const Evaluate& brdf);

/// Data of viewer.js as JSON, for pages that load their materials later. The first function returns meshes, lights,
/// the environment and shaders; the second returns a material with the text of its shader and the exposure of its
/// picture under directional lights.
std::string viewer_data();
std::string viewer_material(const PageMaterial& material);
/// The bundled environment at half its width. It is defined in a file of its own, for programs without files.
Image page_environment();

/// One of `k_built_in_meshes` with fewer triangles, for the page.
Mesh page_mesh(std::string_view name);
/// Aspect ratio (width / height) of the initial pictures, and of pictures of another mesh.
inline constexpr double k_page_aspect = 4.0 / 3;
/// The polar angles of the light in the plots [degrees].
inline constexpr std::array<double, 4> k_slice_theta{0, 30, 60, 75};
/// The angles of the light at the back, from the front's normal, in the plots of a BSDF.
inline constexpr std::array<double, 4> k_slice_theta_behind{180, 150, 120, 105};
/// Maximum θ_h, θ_d, φ_d nodes of a table for its picture; `picture_note` should mention the loss.
inline constexpr std::array<std::uint32_t, 3> k_page_table{128, 45, 24};

}  // namespace
