// Materials as a page for a browser, in one file: pictures by WebGL 2, plots, tables: level 7.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/mesh.h"
#include "render/pixel_shader.h"
#include "srbf/brdf.h"

namespace srbf {

/// One of the BRDFs that the page compares.
struct PageMaterial {
    std::string name;                  ///< "Measured", "film"
    std::string kind;                  ///< "multivariate, 208 bytes"
    std::optional<Material> material;  ///< what its picture is drawn of; none: plots and tables alone
    Evaluate brdf;                     ///< of the plots
    std::string parameters;            ///< to read and copy; empty: none are shown
};

struct Page {
    std::string title;
    std::vector<PageMaterial> materials;  ///< one at least; the first is drawn widest in the plots
    /// What is told of each material.
    struct Row {
        std::string name, meaning;       ///< the latter below the table; empty: it needs none
        std::vector<std::string> cells;  ///< as many as materials
    };
    std::vector<Row> table;
    std::string table_note, picture_note;  ///< below the table, and below the pictures
    std::string generator;                 ///< the last line: who wrote the page
};

/// The page, HTML in UTF-8, without a reference to anything outside of itself. Its shaders are those of `shader_text` in the dialect of OpenGL ES
/// 3.0, read by the page from the text that it shows. It starts with `page_mesh("ball")` seen from `Viewpoint{}` by `k_three_lights`, at
/// automatic_exposure of the sphere of the first that has a picture.
std::string page_html(const Page& page);

/// One of `k_built_in_meshes` as the page has it, of fewer triangles.
Mesh page_mesh(std::string_view name);
/// Of the page's pictures when it opens, and of those of another mesh; width / height.
inline constexpr double k_page_aspect = 4.0 / 3;
/// The polar angles of the light in the page's plots [degrees].
inline constexpr std::array<double, 4> k_slice_theta{0, 30, 60, 75};
/// θ_h, θ_d, φ_d: nodes enough for a table's picture; `picture_note` should tell what is lost.
inline constexpr std::array<std::uint32_t, 3> k_page_table{128, 45, 24};

}  // namespace srbf
