// Model files of each version stay readable: test/models/VERSION/ has a file of each kind, written when its version was
// current, and its values then. To add a kind: SRBF_WRITE_MODELS=1 writes the missing files. A file that is there is
// never written again.
#include <fmt/format.h>

#include "base/text.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/su/su_functions.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "su_models.h"
#include "temporary_folder.h"

namespace srbf::versions_test {
namespace {

namespace fs = std::filesystem;

const fs::path k_folder = fs::path(SRBF_SOURCE_DIR) / "test" / "models";
const std::string k_file_version = "1";
/// Files of this kind begin with the former name of OpenPBR, by which it is read but not written.
constexpr const char* k_renamed = "pbr";
/// Files that version 0.1 wrote and that need a new fit, with the reason that the error states.
const std::map<std::string, std::string> k_refused{
    {"stack", "texels with lobes of their own"}, {"su", "shapes of lobes"}, {"su_cube", "shapes of lobes"}};

/// A model of each kind that the program writes.
std::map<std::string, Model> current_models() {
    std::map<std::string, Model> all;
    std::mt19937_64 random(44);
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (const bool log_scale : {false, true})
                all[fmt::format("pm_{}_{}{}", name(form), axial ? "axial" : "general", log_scale ? "_scaled" : "")] = {
                    random_model(random, {.axial = axial, .log_scale = log_scale, .lobes = 3, .form = form}),
                    {{"source", "made up"}, {"max_theta", "80"}}};
    all["pm_spectral"] = {spectral_model(random, {.lobes = 2}, 5), {}};
    SuModel su = random_su(random, 8, 2);
    all["su_rotated"] = {su, {}};
    su.index = index_texture(su, DirectionMap::cube, 2);
    all["su_rotated_cube"] = {su, {}};
    su.index = index_texture(su, DirectionMap::parabolic, 2);
    su.interpolation = SuInterpolation::plain;
    su.neighbours = 3;
    su.discretise = Discretise::light;
    all["su_parabolic_plain_light"] = {su, {}};
    all["ggx_one"] = {GgxModel{{0.1f, 0.2f, 0.3f}, {{0.4f, {0.5f, 0.3f, 0.1f}, 1}}}, {}};
    all["ggx_two"] = {GgxModel{{0.1f, 0.2f, 0.3f}, {{0.4f, {0.5f, 0.3f, 0.1f}, 1}, {0.1f, {0.2f, 0.2f, 0.2f}, 0.5f}}},
                      {}};
    all["openpbr"] = {OpenPbrModel{.base_color = {0.5f, 0.3f, 0.1f}, .coat_weight = 0.5f, .fuzz_weight = 0.25f}, {}};
    OpenPbrModel brushed{.base_color = {0.9f, 0.6f, 0.3f}, .base_metalness = 1, .specular_roughness = 0.4f};
    brushed.specular_roughness_anisotropy = 0.7f;
    brushed.specular_rotation = 0.1f;
    all["openpbr_brushed"] = {rounded(brushed), {}};
    all["openpbr_film"] = {rounded(OpenPbrModel{.base_metalness = 0.5f, .thin_film_weight = 0.75f}), {}};
    all["bsdf"] = {lobe_bsdf_with_beams(), {}};
    all["bsdf_turned"] = {lobe_bsdf_with_beams(), {}};  // whose beams depend on azimuth
    return all;
}

/// Values at a few pairs of directions, on both sides.
std::vector<Rgb> values_of(const AnyBrdf& brdf) {
    std::mt19937_64 random(1);
    std::vector<Rgb> values;
    for (int i = 0; i < 12; ++i) {
        const double lowest = i < 8 ? 0.05 : -1;
        const Vec3f wl = to_float(random_direction(random, lowest));
        const Vec3f wv = i % 2 ? to_float(random_direction(random, lowest)) : mirror(wl);
        values.push_back(std::visit([&](const auto& any_brdf) { return value(any_brdf, wl, wv); }, brdf));
    }
    return values;
}

std::string csv_of(const std::vector<Rgb>& values) {
    std::string csv = "r,g,b\n";
    for (const Rgb& f : values) csv += fmt::format("{:.9g},{:.9g},{:.9g}\n", f.r, f.g, f.b);
    return csv;
}

std::vector<Rgb> values_in(const fs::path& csv) {
    const std::string text = read_text(csv);
    std::vector<Rgb> values;
    std::vector<std::string_view> fields;
    for (Lines lines(text); auto line = lines.next();) {
        split_fields(*line, fields);
        if (lines.number() > 1 && fields.size() == 3)
            values.push_back({to_number<float>(fields[0]).value_or(-1), to_number<float>(fields[1]).value_or(-1),
                              to_number<float>(fields[2]).value_or(-1)});
    }
    return values;
}

/// Writes the files of the current version that are missing.
void write_missing() {
    const fs::path folder = k_folder / k_file_version;
    fs::create_directories(folder);
    const auto add = [&](const std::string& name, const std::vector<std::byte>& bytes) {
        const fs::path file = folder / (name + ".srbf");
        if (fs::exists(file)) return;
        ASSERT_TRUE(write_file(file.string(), bytes).ok());
        const auto loaded = checked(load_brdf(file.string()));
        write_text(folder / (name + ".csv"), csv_of(values_of(*loaded)));
    };
    for (const auto& [name, model] : current_models()) add(name, write_model(model));
}

TEST(Versions, FilesOfEachVersionKeepTheirMeaning) {
    if (std::getenv("SRBF_WRITE_MODELS")) write_missing();
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(k_folder)) {
        if (entry.path().extension() != ".srbf") continue;
        SCOPED_TRACE(entry.path().string());
        ++files;
        if (k_refused.contains(entry.path().stem().string())) continue;
        const auto loaded = checked(load_brdf(entry.path().string()));
        const auto expected = values_in(fs::path(entry.path()).replace_extension(".csv")), found = values_of(*loaded);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_RGB_WITHIN_RELATIVE(found[i], expected[i], 1e-4, 1e-7) << i;
        if (entry.path().parent_path().filename() != k_file_version) continue;
        const auto bytes = *read_file(entry.path().string());
        if (entry.path().stem().string().starts_with(k_renamed)) continue;
        EXPECT_EQ(write_model(std::get<Model>(*loaded)), bytes);
    }
    EXPECT_GE(files, 20);
}

TEST(Versions, WithdrawnFilesAreRefusedInOneLine) {
    for (const auto& [name, found] : k_refused) {
        const auto loaded = load_brdf((k_folder / "1" / (name + ".srbf")).string());
        ASSERT_FALSE(loaded);
        EXPECT_CONTAINS(message(loaded.error()), "found " + found);
    }
    EXPECT_FALSE(load_brdf((k_folder / "1" / "stack.srbf#1").string()));
}

/// A kind of which no file is kept could change its meaning unseen.
TEST(Versions, AFileOfEachKindIsKept) {
    for (const auto& [name, model] : current_models())
        EXPECT_TRUE(fs::exists(k_folder / k_file_version / (name + ".srbf"))) << name;
    const auto bytes = write_model(current_models().begin()->second);
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_CONTAINS(text, "\"srbf\":\"" + k_file_version + "\"") << "a new version needs a folder of files";
}

}  // namespace
}  // namespace srbf::versions_test
