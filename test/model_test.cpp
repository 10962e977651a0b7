// Models and their files: a file has the promised bytes, and reading it gives the written model.
#include "srbf/model.h"

#include "model_bytes.h"
#include "models.h"
#include "models/kind/parameters.h"
#include "models/pm/pm_functions.h"
#include "properties.h"
#include "srbf/file.h"
#include "temporary_folder.h"

namespace srbf::model_test {
namespace {

using Bytes = std::vector<std::byte>;

const PmModel& pm(const Model& model) { return std::get<PmModel>(model.model); }

TEST(Model, WrittenModelsAreReadBack) {
    std::mt19937_64 random(1);
    for (int trial = 0; trial < 200; ++trial) {
        const RandomModelOptions options{.axial = trial % 2 == 0,
                                         .log_scale = trial % 4 < 2,
                                         .lobes = 1 + int(random() % 12),
                                         .variates = 1 + int(random() % k_max_variates),
                                         .form = k_forms[std::size_t(trial) % k_forms.size()]};
        const Model model{rounded(random_model(random, options)), {{"source", "a.bsdf"}, {"", "empty key"}}};
        const Bytes bytes = write_model(model);
        const auto back = checked(read_model(bytes, "x"));
        EXPECT_EQ(pm(*back), pm(model));
        EXPECT_EQ(back->provenance, model.provenance);
        EXPECT_EQ(write_model(*back), bytes);
        EXPECT_EQ(write_model(model), bytes);
    }
}

TEST(Model, RoundedIsWhatAFileHolds) {
    std::mt19937_64 random(2);
    for (int trial = 0; trial < 200; ++trial) {
        const PmModel model = random_model(random, {.axial = trial % 2 == 0,
                                                    .log_scale = trial % 4 < 2,
                                                    .form = k_forms[std::size_t(trial) % k_forms.size()]});
        const PmModel once = rounded(model);
        EXPECT_NE(once, model);
        EXPECT_EQ(rounded(once), once);
        const auto back = checked(read_model(write_model({model, {}}), "x"));
        EXPECT_EQ(pm(*back), once);
    }
}

TEST(Model, NumbersBeyondAHalfAreHeldAtItsEnd) {
    std::mt19937_64 random(3);
    PmModel model = random_model(random, {.log_scale = true});
    model.coefficient[0] = {1e9f, k_half_max, 1e-12f};
    model.bandwidth[0] = 1e9f;
    model.centre[1] = {0, 0, -1};
    model.bandwidth[1] = 1e-12f;
    model.log_scale[0] = -1e9f;
    model.log_scale[1] = 1e9f;
    const PmModel once = rounded(model);
    EXPECT_EQ(once.coefficient[0], (Rgb{k_half_max, k_half_max, 0}));
    EXPECT_EQ(once.bandwidth[0], k_half_max);
    EXPECT_EQ(once.bandwidth[1], 0);
    EXPECT_EQ(once.centre[1], Vec3f(0, 0, -1));  // the sign of -0 is kept
    EXPECT_EQ(once.log_scale[0], -k_half_max);
    EXPECT_EQ(once.log_scale[1], k_half_max);
}

/// A model is not made of numbers that 16-bit floats do not hold.
TEST(Model, NumbersThatHalvesDoNotHoldAreRefused) {
    std::mt19937_64 random(2);
    const Model models[] = {{rounded(random_model(random, {.lobes = 2, .variates = 2})), {}},
                            {GgxModel{{0.1f, 0.2f, 0.3f}, {{0.25f, {0.5f, 0.5f, 0.5f}, 1}}}, {}}};
    for (const Model& model : models) {
        Parameters changed = parameters(model);
        EXPECT_TRUE(model_from(changed).ok());
        for (auto& [name, value] : changed)
            if (auto* array = std::get_if<NumberArray>(&value); array && name != "centre" && name != "parameterization")
                for (float& x : std::span(array->numbers).first(std::min<std::size_t>(array->numbers.size(), 1))) {
                    const float valid = x;
                    for (const float wrong : {1e6f, 1e-9f}) {
                        x = wrong;
                        EXPECT_FALSE(model_from(changed).ok()) << name;
                    }
                    x = valid;
                }
    }
}

TEST(Model, CentresKeepTheirAnglesToTheDigitsOfAHalf) {
    std::mt19937_64 random(4);
    PmModel model = random_model(random, {.axial = false, .lobes = 60, .variates = 2});
    std::size_t i = 0;
    for (const Vec3f& pole : {Vec3f(0, 0, 1), Vec3f(0, 0, -1), Vec3f(1, 0, 0), Vec3f(-1, 0, 0), Vec3f(0, -1, 0)})
        model.centre[i++] = pole;
    for (const double tilt : {1e-7, 1e-5, 1e-4, 1e-3, 1e-2, 0.1})
        for (const double z : {1.0, -1.0})
            for (const double azimuth : {0.3, -2.5})
                model.centre[i++] = to_float(spherical(z > 0 ? tilt : k_pi - tilt, azimuth));
    const PmModel once = rounded(model);
    for (std::size_t k = 0; k < model.centre.size(); ++k) {
        const Vec3f a = model.centre[k], b = once.centre[k];
        const double theta = std::acos(std::clamp(double(a.z), -1.0, 1.0)), sine = std::hypot(double(a.x), double(a.y));
        EXPECT_WITHIN(dot(b, b), 1, 1e-6);
        // Half an ulp each: of θ, at most 2^-10 beyond 2, and of φ, on the circle of this latitude.
        const double distance = std::sqrt(double(dot(a - b, a - b)));
        const double bound = theta * 0x1p-11 + sine * k_pi * 0x1p-11 + 3e-7;
        EXPECT_LE(distance, bound) << theta;
        if (theta < 0.01) {
            EXPECT_LE(distance, 5 * 0x1p-11 * sine + 1e-7) << theta;
        }
    }
}

TEST(Model, BytesAreThePromisedOnes) {
    std::mt19937_64 random(5);
    const auto bytes = [&](bool axial, bool log_scale, int lobes, int variates, PmForm form = PmForm::gaussian) {
        return payload_bytes(random_model(random, {axial, log_scale, lobes, variates, 300, form}));
    };
    EXPECT_EQ(bytes(true, false, 8, 4), 128u);
    EXPECT_EQ(bytes(true, true, 8, 4), 144u);
    EXPECT_EQ(bytes(false, false, 6, 3), 156u);
    EXPECT_EQ(bytes(false, false, 8, 4), 256u);
    EXPECT_EQ(bytes(true, false, 8, 4, PmForm::horizon), 160u);
    EXPECT_EQ(bytes(true, false, 6, 4, PmForm::extended), 160u);
    for (int trial = 0; trial < 12; ++trial) {
        const bool axial = trial % 2 == 0, log_scale = trial % 4 < 2;
        const PmForm form = k_forms[std::size_t(trial) % k_forms.size()];
        const PmModel model = random_model(random, {axial, log_scale, 7, 5, 300, form});
        EXPECT_EQ(has_log_scale(model), log_scale || form != PmForm::gaussian);
        const Bytes file = write_model({model, {}});
        const std::size_t length = header_length_of(file);
        EXPECT_EQ(file.size() - 8 - length, payload_bytes(model));
        EXPECT_EQ(length % 8, 0u);
        auto tensors = header_of(file);
        tensors.erase("__metadata__");
        for (const auto& entry : tensors) EXPECT_EQ(entry["dtype"], "F16");
        EXPECT_EQ(tensors.size(), 3u + !axial + has_log_scale(model) + (form != PmForm::gaussian));
    }
}

TEST(Model, TensorsAreNamedAndOrderedAsPromised) {
    PmModel model;
    model.lobes = 1;
    model.variates = 2;
    model.coefficient = {{1, 2, 0.5f}};
    model.log_scale = {0};
    model.centre = {{0, 0, 1}, {0, 0, -1}};
    model.bandwidth = {3, 4};
    model.parameterization = {{1, 1}, {0, -1}};
    const Bytes file = write_model({model, {{"who", "me"}}});
    const auto header = header_of(file);
    EXPECT_EQ(header["__metadata__"],
              (nlohmann::json{{"srbf", "1"}, {"model", "pm"}, {"form", "source"}, {"axial", "true"}, {"who", "me"}}));
    EXPECT_EQ(header["coefficient"]["shape"], (nlohmann::json{1, 3}));
    EXPECT_EQ(header["bandwidth"]["shape"], (nlohmann::json{1, 2}));
    EXPECT_EQ(header["parameterization"]["shape"], (nlohmann::json{2, 2}));
    const std::size_t data = file.size() - payload_bytes(model);
    const auto halves = [&](const char* name) {
        std::vector<float> numbers;
        const auto& offsets = header[name]["data_offsets"];
        for (std::size_t offset = offsets[0]; offset < offsets[1]; offset += 2)
            numbers.push_back(from_half(uint16_at(file, data + offset)));
        return numbers;
    };
    EXPECT_EQ(halves("coefficient"), (std::vector<float>{1, 2, 0.5f}));
    EXPECT_EQ(halves("bandwidth"), (std::vector<float>{3, -4}));
    EXPECT_EQ(halves("parameterization"), (std::vector<float>{1, 1, 0, -1}));
}

TEST(Model, ProvenanceMayHoldAnyByte) {
    std::mt19937_64 random(6);
    std::string every;
    for (int c = 0; c < 256; ++c) every += char(c);
    const std::map<std::string, std::string> valid{{"quotes", "a \"b\" \\ c"},
                                                   {"lines", "a\nb\r\n\tc"},
                                                   {"empty", ""},
                                                   {"", "no name"},
                                                   {"nul", std::string("a\0b", 3)},
                                                   {"UTF-8", "θ, φ, 🎈"},
                                                   {"\"key\"\n", "x"},
                                                   {"long", std::string(100000, 'x')}};
    auto provenance = valid;
    provenance["broken"] = every;
    provenance["\xff\xfe"] = "broken key";
    const Model model{rounded(random_model(random, {})), provenance};
    const auto back = checked(read_model(write_model(model), "x"));
    for (const auto& [key, text] : valid) EXPECT_EQ(back->provenance.at(key), text) << key;
    // The text is no UTF-8: its invalid bytes are replaced, and its ASCII stays.
    EXPECT_EQ(back->provenance.at("broken").substr(0, 128), every.substr(0, 128));
    EXPECT_EQ(back->provenance.size(), provenance.size());
    EXPECT_EQ(pm(*back), pm(model));
}

TEST(Model, ValueIsTheKernelsAboveTheHorizonAndZeroBelow) {
    std::mt19937_64 random(7);
    const Model model{random_model(random, {}), {}};
    static_assert(Brdf<Model> && Brdf<PmModel>);
    const Vec3f up = to_float(spherical(0.3, 0.1)), other = to_float(spherical(1.0, 2.0));
    EXPECT_GT(value(model, up, other).r, 0);
    EXPECT_EQ(value(model, up, other), value(pm(model), up, other));
    for (const Vec3f& low : {Vec3f(1, 0, 0), Vec3f(0.6f, 0, -0.8f), Vec3f(1, 0, -1e-30f), Vec3f(0, 0, NAN)}) {
        EXPECT_EQ(value(model, up, low), Rgb());
        EXPECT_EQ(value(model, low, up), Rgb());
    }
}

}  // namespace
}  // namespace srbf::model_test
