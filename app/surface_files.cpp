#include "app/surface_files.h"

#include <nlohmann/json.hpp>

#include "app/html.h"
#include "base/errors.h"
#include "base/printable.h"
#include "brdf/values.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/openpbr/openpbr_parameters.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

using Json = nlohmann::ordered_json;

constexpr float k_nanometres = 1000;  ///< one unit of a film's thickness, 1e-6 m, in nanometres

/// The comment lines at the head of a surface's file.
std::vector<std::string> notes(const NamedModel& named) {
    std::vector<std::string> lines{
        fmt::format("{}: written by srbf {}. Colours are linear, in Rec.709 primaries.", named.name, SRBF_VERSION)};
    const auto& provenance = named.model->provenance;
    for (const auto& [key, words] : {std::pair{"source", "Measurement"}, std::pair{"surface", "Fitted parameters of"},
                                     std::pair{"delta_e_itp", "dE_ITP against the measurement, as srbf draws it"},
                                     std::pair{"heldout_delta_e_itp", "dE_ITP of pictures in cross-validation"}})
        if (const auto entry = provenance.find(key); entry != provenance.end())
            lines.push_back(fmt::format("{}: {}", words, entry->second));
    return lines;
}

/// For target programs whose coat does not alter the base. The returned base has the roughness and the index of
/// refraction that it effectively has under its coat.
OpenPbrModel with_plain_coat(const OpenPbrModel& model) {
    OpenPbrModel plain = model;
    plain.specular_roughness =
        Kernel<float>::roughened(model.specular_roughness, model.coat_roughness, model.coat_weight);
    const float ratio = model.specular_ior / (1 + model.coat_weight * (model.coat_ior - 1));
    plain.specular_ior = std::max(ratio, 1 / ratio);
    return plain;
}

/// The roughnesses α along and across the tangent (`openpbr_anisotropic_value`), and the tangent's rotation [turns].
struct Anisotropy {
    float along, across, rotation;
    explicit Anisotropy(const OpenPbrModel& model) : rotation(model.specular_rotation) {
        const float alpha = model.specular_roughness * model.specular_roughness,
                    ratio = 1 - model.specular_roughness_anisotropy;
        along = std::min(alpha * std::sqrt(2 / (1 + ratio * ratio)), 1.f);
        across = ratio * along;
    }
};
bool is_anisotropic(const OpenPbrModel& model) { return model.specular_roughness_anisotropy > 0; }

// ---- MaterialX and USD ----

/// A number or a colour as an input of a node.
struct Input {
    std::string name, numbers;
    bool is_colour;
};
Input input(std::string_view name, float x) { return {std::string(name), fmt::format("{:.6g}", x), false}; }
Input input(std::string_view name, const Rgb& c) {
    return {std::string(name), fmt::format("{:.6g}, {:.6g}, {:.6g}", c.r, c.g, c.b), true};
}

/// OpenPBR Surface uses the same parameter names, but for the rotation: it takes the tangent as a vector from a node.
std::vector<Input> openpbr_inputs(const OpenPbrModel& model) {
    std::vector<Input> inputs;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters)
        if (parameter.name != "specular_rotation")
            inputs.push_back(parameter.colour ? input(parameter.name, model.*parameter.colour)
                                              : input(parameter.name, model.*parameter.number));
    return inputs;
}
/// MaterialX rotates vectors clockwise [degrees].
float clockwise(const OpenPbrModel& model) { return -360 * model.specular_rotation; }
/// Standard Surface has neither coat darkening nor a film weight; its film thickness is in nanometres. Its
/// roughnesses are α / a along the tangent and α a across it, with a² = 1 − specular_anisotropy.
std::vector<Input> standard_surface_inputs(const OpenPbrModel& model) {
    const Anisotropy facets(model);
    return {input("base", model.base_weight),
            input("base_color", model.base_color),
            input("diffuse_roughness", model.base_diffuse_roughness),
            input("metalness", model.base_metalness),
            input("specular", model.specular_weight),
            input("specular_color", model.specular_color),
            input("specular_roughness", std::sqrt(std::sqrt(facets.along * facets.across))),
            input("specular_anisotropy", model.specular_roughness_anisotropy),
            input("specular_rotation", is_anisotropic(model) ? 1 - facets.rotation : 0),
            input("specular_IOR", model.specular_ior),
            input("coat", model.coat_weight),
            input("coat_color", model.coat_color),
            input("coat_roughness", model.coat_roughness),
            input("coat_IOR", model.coat_ior),
            input("sheen", model.fuzz_weight),
            input("sheen_color", model.fuzz_color),
            input("sheen_roughness", model.fuzz_roughness),
            input("thin_film_thickness", model.thin_film_weight > 0 ? k_nanometres * model.thin_film_thickness : 0),
            input("thin_film_IOR", model.thin_film_ior)};
}

std::string mtlx_text(const NamedModel& named, const char* node, const char* specification,
                      const std::vector<Input>& inputs, const std::string& tangent = {}) {
    std::string text = "<?xml version=\"1.0\"?>\n<!--\n";
    for (const std::string& line : notes(named)) text += fmt::format("  {}\n", in_xml_comment(line));
    text += fmt::format(
        "  {}, MaterialX 1.39.\n-->\n<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n{}"
        "  <{} name=\"{}_surface\" type=\"surfaceshader\">\n",
        specification, tangent, node, named.name);
    if (!tangent.empty())
        text += fmt::format("    <input name=\"geometry_tangent\" type=\"vector3\" nodename=\"{}_turned\" />\n",
                            named.name);
    for (const Input& input : inputs)
        text += fmt::format("    <input name=\"{}\" type=\"{}\" value=\"{}\" />\n", input.name,
                            input.is_colour ? "color3" : "float", input.numbers);
    return text + fmt::format(
                      "  </{1}>\n  <surfacematerial name=\"{0}\" type=\"material\">\n"
                      "    <input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{0}_surface\" />\n"
                      "  </surfacematerial>\n</materialx>\n",
                      named.name, node);
}

/// Nodes that rotate the tangent about the normal, for the material `name`; empty if the surface is isotropic.
std::string mtlx_tangent(const std::string& name, const OpenPbrModel& model) {
    if (!is_anisotropic(model)) return "";
    std::string text;
    for (const char* node : {"tangent", "normal"})
        text += fmt::format(
            "  <{0} name=\"{1}_{0}\" type=\"vector3\">\n    <input name=\"space\" type=\"string\" value=\"world\" "
            "/>\n"
            "  </{0}>\n",
            node, name);
    return text + fmt::format(
                      "  <rotate3d name=\"{0}_turned\" type=\"vector3\">\n"
                      "    <input name=\"in\" type=\"vector3\" nodename=\"{0}_tangent\" />\n"
                      "    <input name=\"amount\" type=\"float\" value=\"{1:.6g}\" />\n"
                      "    <input name=\"axis\" type=\"vector3\" nodename=\"{0}_normal\" />\n  </rotate3d>\n",
                      name, clockwise(model));
}

/// The nodes of `mtlx_tangent` as USD shaders.
std::string usd_tangent(const std::string& name, const OpenPbrModel& model) {
    std::string text;
    for (const auto& [prim, id] : {std::pair{"Tangent", "tangent"}, std::pair{"Normal", "normal"}})
        text += fmt::format(
            "\n            def Shader \"{}\"\n            {{\n                uniform token info:id = "
            "\"ND_{}_vector3\"\n"
            "                string inputs:space = \"world\"\n                float3 outputs:out\n            }}\n",
            prim, id);
    return text + fmt::format(
                      "\n            def Shader \"Turned\"\n            {{\n"
                      "                uniform token info:id = \"ND_rotate3d_vector3\"\n"
                      "                float3 inputs:in.connect = </World/Materials/{0}/Tangent.outputs:out>\n"
                      "                float inputs:amount = {1:.6g}\n"
                      "                float3 inputs:axis.connect = </World/Materials/{0}/Normal.outputs:out>\n"
                      "                float3 outputs:out\n            }}\n",
                      name, clockwise(model));
}

std::string usd_text(const NamedModel& named, const OpenPbrModel& model) {
    std::string text = "#usda 1.0\n(\n    defaultPrim = \"World\"\n    doc = \"\"\"";
    for (const std::string& line : notes(named)) text += in_string(line) + "\n";
    text += fmt::format(
        "UsdPreviewSurface 2.6; OpenPBR Surface 1.1 as a network of MaterialX 1.39.\"\"\"\n"
        "    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\ndef Xform \"World\"\n{{\n"
        "    def Sphere \"Sphere\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )\n    {{\n"
        "        float3[] extent = [(-1, -1, -1), (1, 1, 1)]\n        double radius = 1\n"
        "        rel material:binding = </World/Materials/{0}>\n    }}\n\n"
        "    def Scope \"Materials\"\n    {{\n        def Material \"{0}\"\n        {{\n"
        "            token outputs:surface.connect = </World/Materials/{0}/Preview.outputs:surface>\n"
        "            token outputs:mtlx:surface.connect = </World/Materials/{0}/OpenPbr.outputs:out>\n\n"
        "            def Shader \"Preview\"\n            {{\n"
        "                uniform token info:id = \"UsdPreviewSurface\"\n",
        named.name);
    const auto add = [&](const Input& input) {
        const char* const pattern =
            input.is_colour ? "                color3f inputs:{} = ({})\n" : "                float inputs:{} = {}\n";
        text += fmt::format(fmt::runtime(pattern), input.name, input.numbers);
    };
    const OpenPbrModel plain = with_plain_coat(model);
    const float mean_of_coat = (model.coat_color.r + model.coat_color.g + model.coat_color.b) / 3;
    add(input("diffuseColor", scaled(model.base_weight, model.base_color)));
    add(input("metallic", model.base_metalness));
    add(input("roughness", plain.specular_roughness));
    add(input("ior", plain.specular_ior));
    add(input("clearcoat", model.coat_weight * mean_of_coat));
    add(input("clearcoatRoughness", model.coat_roughness));
    text +=
        "                token outputs:surface\n            }\n\n            def Shader \"OpenPbr\"\n            {\n"
        "                uniform token info:id = \"ND_open_pbr_surface_surfaceshader\"\n";
    for (const Input& input : openpbr_inputs(model)) add(input);
    if (is_anisotropic(model))
        text += fmt::format(
            "                vector3f inputs:geometry_tangent.connect = </World/Materials/{}/Turned.outputs:out>\n",
            named.name);
    text += "                token outputs:out\n            }\n";
    if (is_anisotropic(model)) text += usd_tangent(named.name, model);
    return text + "        }\n    }\n}\n";
}

// ---- glTF ----

/// A triangulated unit sphere. The positions are its normals too.
struct Sphere {
    std::vector<float> positions, tangents;  ///< tangents point along the circles of latitude
    std::vector<std::uint16_t> indices;
};
Sphere sphere() {
    constexpr int k_rings = 48, k_sides = 96;
    Sphere mesh;
    for (int ring = 0; ring <= k_rings; ++ring)
        for (int side = 0; side <= k_sides; ++side) {
            const double theta = k_pi * ring / k_rings, phi = 2 * k_pi * side / k_sides;
            const Vec3d w = spherical(theta, phi);
            mesh.positions.insert(mesh.positions.end(), {float(w.y), float(w.z), float(w.x)});  // y is up
            mesh.tangents.insert(mesh.tangents.end(), {float(std::cos(phi)), 0, float(-std::sin(phi)), 1});
        }
    const auto vertex = [](int ring, int side) { return std::uint16_t(ring * (k_sides + 1) + side); };
    for (int ring = 0; ring < k_rings; ++ring)
        for (int side = 0; side < k_sides; ++side) {
            if (ring > 0)
                mesh.indices.insert(mesh.indices.end(),
                                    {vertex(ring, side), vertex(ring + 1, side), vertex(ring, side + 1)});
            if (ring + 1 < k_rings)
                mesh.indices.insert(mesh.indices.end(),
                                    {vertex(ring, side + 1), vertex(ring + 1, side), vertex(ring + 1, side + 1)});
        }
    return mesh;
}

/// Rounded to six decimals, which exceeds the precision of a 16-bit float.
double rounded(float x) { return std::round(double(x) * 1e6) / 1e6; }
Json rounded(const Rgb& colour) { return Json::array({rounded(colour.r), rounded(colour.g), rounded(colour.b)}); }

Json gltf_material(const NamedModel& named, const OpenPbrModel& model) {
    const Rgb base = scaled(model.base_weight, model.base_color);
    Json material{{"name", named.name},
                  {"pbrMetallicRoughness",
                   {{"baseColorFactor", {rounded(base.r), rounded(base.g), rounded(base.b), 1}},
                    {"metallicFactor", rounded(model.base_metalness)},
                    {"roughnessFactor", rounded(model.specular_roughness)}}}};
    Json& extensions = material["extensions"];
    extensions["KHR_materials_ior"] = {{"ior", rounded(model.specular_ior)}};
    extensions["KHR_materials_specular"] = {{"specularFactor", rounded(model.specular_weight)},
                                            {"specularColorFactor", rounded(model.specular_color)}};
    if (model.coat_weight > 0)
        extensions["KHR_materials_clearcoat"] = {{"clearcoatFactor", rounded(model.coat_weight)},
                                                 {"clearcoatRoughnessFactor", rounded(model.coat_roughness)}};
    if (model.fuzz_weight > 0)
        extensions["KHR_materials_sheen"] = {{"sheenColorFactor", rounded(scaled(model.fuzz_weight, model.fuzz_color))},
                                             {"sheenRoughnessFactor", rounded(model.fuzz_roughness)}};
    if (is_anisotropic(model)) {  // the roughness along the tangent is mix(roughness across, 1, strength²)
        const Anisotropy facets(model);
        material["pbrMetallicRoughness"]["roughnessFactor"] = rounded(std::sqrt(facets.across));
        extensions["KHR_materials_anisotropy"] = {
            {"anisotropyStrength",
             rounded(std::sqrt((facets.along - facets.across) / std::max(1 - facets.across, 1e-6f)))},
            {"anisotropyRotation", rounded(2 * float(k_pi) * facets.rotation)}};
    }
    if (model.thin_film_weight > 0) {
        const double thickness =
            rounded(k_nanometres * model.thin_film_thickness);  // the maximum applies if there is no texture
        extensions["KHR_materials_iridescence"] = {{"iridescenceFactor", rounded(model.thin_film_weight)},
                                                   {"iridescenceIor", rounded(model.thin_film_ior)},
                                                   {"iridescenceThicknessMinimum", thickness},
                                                   {"iridescenceThicknessMaximum", thickness}};
    }
    return material;
}

struct Gltf {
    Json json;  ///< without the buffer's `uri`
    std::vector<std::byte> bytes;
};
Gltf gltf(const NamedModel& named, const OpenPbrModel& model) {
    const Sphere mesh = sphere();
    std::vector<std::byte> bytes;
    const auto add = [&](std::span<const std::byte> part) { bytes.insert(bytes.end(), part.begin(), part.end()); };
    add(std::as_bytes(std::span(mesh.positions)));
    const std::size_t positions_end = bytes.size();
    if (is_anisotropic(model)) add(std::as_bytes(std::span(mesh.tangents)));
    const std::size_t vertices_end = bytes.size();
    add(std::as_bytes(std::span(mesh.indices)));
    const Json material = gltf_material(named, model);
    Json extension_names = Json::array(), extras = Json::array();
    for (const auto& [name, value] : material["extensions"].items()) extension_names.push_back(name);
    for (const std::string& line : notes(named)) extras.push_back(printable(line));
    constexpr int k_array = 34962, k_elements = 34963, k_float = 5126, k_unsigned_short = 5123;  // OpenGL's enumerants
    Json json{
        {"asset", {{"version", "2.0"}, {"generator", "srbf " SRBF_VERSION}, {"extras", {{"notes", extras}}}}},
        {"extensionsUsed", extension_names},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", {{{"mesh", 0}, {"name", named.name}}}},
        {"meshes",
         {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 0}}}, {"indices", 1}, {"material", 0}}}}}}},
        {"materials", {material}},
        {"accessors",
         {{{"bufferView", 0},
           {"componentType", k_float},
           {"count", mesh.positions.size() / 3},
           {"type", "VEC3"},
           {"min", {-1, -1, -1}},
           {"max", {1, 1, 1}}},
          {{"bufferView", 1},
           {"componentType", k_unsigned_short},
           {"count", mesh.indices.size()},
           {"type", "SCALAR"}}}},
        {"bufferViews",
         {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", positions_end}, {"target", k_array}},
          {{"buffer", 0},
           {"byteOffset", vertices_end},
           {"byteLength", bytes.size() - vertices_end},
           {"target", k_elements}}}},
        {"buffers", {{{"byteLength", bytes.size()}}}}};
    if (is_anisotropic(model)) {
        json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json["accessors"].size();
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size()},
                                     {"componentType", k_float},
                                     {"count", mesh.tangents.size() / 4},
                                     {"type", "VEC4"}});
        json["bufferViews"].push_back({{"buffer", 0},
                                       {"byteOffset", positions_end},
                                       {"byteLength", vertices_end - positions_end},
                                       {"target", k_array}});
    }
    return {std::move(json), bytes};
}
std::string gltf_text(Gltf document) {
    document.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(document.bytes);
    return document.json.dump(1) + "\n";
}
/// Binary glTF: magic number, version and size, then two chunks with their size and kind, padded to four bytes.
std::string glb_bytes(const Gltf& document) {
    std::string text = document.json.dump(),
                bytes(reinterpret_cast<const char*>(document.bytes.data()), document.bytes.size());
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    const auto little_endian = [](std::size_t x) {
        std::string word;
        for (int k = 0; k < 4; ++k) word += char(x >> (8 * k) & 0xff);
        return word;
    };
    constexpr std::size_t k_version = 2, k_head = 12, k_chunk_head = 8;
    return "glTF" + little_endian(k_version) + little_endian(k_head + 2 * k_chunk_head + text.size() + bytes.size()) +
           little_endian(text.size()) + "JSON" + text + little_endian(bytes.size()) + std::string("BIN\0", 4) + bytes;
}

// ---- Blender ----

std::string blender_text(const NamedModel& named, const OpenPbrModel& model) {
    std::string text;
    for (const std::string& line : notes(named)) text += fmt::format("# {}\n", in_comment(line));
    text += fmt::format(
        "# Makes the material of Blender's Principled BSDF, version 4.3 or later: run it in Blender. With the name of "
        "a\n"
        "# .blend file after \"--\" it writes that file. A script that imports it calls {0}_material().\n\n\n"
        "def {0}_material():\n"
        "    import bpy\n\n"
        "    material = bpy.data.materials.new(\"{0}\")\n    material.use_nodes = True\n"
        "    material.use_fake_user = True  # so that it is stored though nothing has it\n"
        "    node = next(n for n in material.node_tree.nodes if n.type == \"BSDF_PRINCIPLED\")\n"
        "    for name, value in {{\n",
        named.name);
    const auto add_number = [&](const char* name, float x) {
        text += fmt::format("        \"{}\": {:.6g},\n", name, x);
    };
    const auto add_colour = [&](const char* name, const Rgb& c) {
        text += fmt::format("        \"{}\": ({:.6g}, {:.6g}, {:.6g}, 1),\n", name, c.r, c.g, c.b);
    };
    add_colour("Base Color", scaled(model.base_weight, model.base_color));
    add_number("Metallic", model.base_metalness);
    const Anisotropy facets(model);
    // Blender's roughnesses are α / a along the tangent and α a across it, with a² = 1 − 0.9 Anisotropic.
    add_number("Roughness", std::sqrt(std::sqrt(facets.along * facets.across)));
    add_number("Anisotropic", std::min(model.specular_roughness_anisotropy / 0.9f, 1.f));
    add_number("Anisotropic Rotation", facets.rotation);
    add_number("IOR", model.specular_ior);
    add_number("Diffuse Roughness", model.base_diffuse_roughness);
    add_number("Specular IOR Level", 0.5f * model.specular_weight);  // 0.5: the reflectance that the IOR gives
    add_colour("Specular Tint", model.specular_color);
    add_number("Coat Weight", model.coat_weight);
    add_number("Coat Roughness", model.coat_roughness);
    add_number("Coat IOR", model.coat_ior);
    add_colour("Coat Tint", model.coat_color);
    add_number("Sheen Weight", model.fuzz_weight);
    add_number("Sheen Roughness", model.fuzz_roughness);
    add_colour("Sheen Tint", model.fuzz_color);
    add_number("Thin Film Thickness", model.thin_film_weight > 0 ? k_nanometres * model.thin_film_thickness : 0);
    add_number("Thin Film IOR", model.thin_film_ior);
    return text + fmt::format(
                      "    }}.items():\n        node.inputs[name].default_value = value\n    return material\n\n\n"
                      "def _{0}_script():\n    import sys\n\n    import bpy\n\n    {0}_material()\n    if \"--\" in "
                      "sys.argv:\n"
                      "        bpy.ops.wm.save_as_mainfile(filepath=sys.argv[sys.argv.index(\"--\") + 1])\n\n\n"
                      "if __name__ == \"__main__\":\n    _{0}_script()\n",
                      named.name);
}

constexpr SurfaceFile k_surface_files[] = {
    {"mtlx", "a surface (fit --model openpbr) as a document of MaterialX with OpenPBR Surface",
     [](const NamedModel& named, const OpenPbrModel& model) {
         return mtlx_text(named, "open_pbr_surface", "OpenPBR Surface 1.1", openpbr_inputs(model),
                          mtlx_tangent(named.name, model));
     }},
    {"standard-surface", "the same with Autodesk Standard Surface",
     [](const NamedModel& named, const OpenPbrModel& model) {
         return mtlx_text(named, "standard_surface", "Autodesk Standard Surface 1.0.1",
                          standard_surface_inputs(with_plain_coat(model)));
     }},
    {"gltf", "a surface as glTF 2.0 with a sphere",
     [](const auto& named, const auto& model) { return gltf_text(gltf(named, with_plain_coat(model))); }},
    {"glb", "the same as one binary file",
     [](const auto& named, const auto& model) { return glb_bytes(gltf(named, with_plain_coat(model))); }},
    {"usd", "a surface as a stage of USD with a sphere", usd_text},
    {"principled", "a surface as a script that makes the Principled material of Blender",
     [](const auto& named, const auto& model) { return blender_text(named, with_plain_coat(model)); }},
};

}  // namespace

std::span<const SurfaceFile> surface_files() { return k_surface_files; }

Result<std::string> surface_text(const SurfaceFile& file, const NamedModel& named) {
    const auto* model = std::get_if<OpenPbrModel>(&named.model->model);
    if (!model)
        return argument_error(named.name, fmt::format("model for {}", file.name),
                              "a surface, of srbf fit --model openpbr", "another model");
    if (model->is_exchanged)
        return argument_error(named.name, "surface", "light and viewer as they are", "exchanged ones");
    return file.text(named, *model);
}

}  // namespace srbf
