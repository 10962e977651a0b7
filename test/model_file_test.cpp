// Damaged and invalid model files: reading gives either a one-line error that describes the problem, or a model
// that keeps its contract.
#include <nlohmann/json.hpp>

#include "model_bytes.h"
#include "models.h"
#include "models/su/su_functions.h"
#include "srbf/file.h"
#include "su_models.h"

namespace srbf::model_file_test {
namespace {

using Bytes = std::vector<std::byte>;
using Json = nlohmann::json;
const std::string k_source = "a\nb.srbf";

void append(Bytes& bytes, std::string_view text) {
    for (const char c : text) bytes.push_back(std::byte(c));
}

/// A container with this header and these half-precision numbers.
Bytes container(const std::string& header, const std::vector<std::uint16_t>& data = {},
                std::uint64_t extra_length = 0) {
    Bytes bytes;
    for (unsigned i = 0; i < 8; ++i) bytes.push_back(std::byte((header.size() + extra_length) >> 8 * i & 0xff));
    append(bytes, header);
    for (const std::uint16_t half : data) {
        bytes.push_back(std::byte(half & 0xff));
        bytes.push_back(std::byte(half >> 8));
    }
    return bytes;
}

/// The parts of a file for tests to damage.
struct FileParts {
    Json header;
    std::vector<std::uint16_t> data;
    std::uint16_t& number(const char* tensor, std::size_t i) {
        return data[header[tensor]["data_offsets"][0].get<std::size_t>() / 2 + i];
    }
    Bytes bytes() const { return container(header.dump(), data); }
};

/// A valid file with J = 2, N = 1, and tensors in this order.
FileParts pm_file() {
    Json header{{"__metadata__", {{"srbf", "1"}, {"model", "pm"}, {"form", "source"}, {"axial", "true"}}},
                {"coefficient", {{"dtype", "F16"}, {"shape", {2, 3}}, {"data_offsets", {0, 12}}}},
                {"bandwidth", {{"dtype", "F16"}, {"shape", {2, 1}}, {"data_offsets", {12, 16}}}},
                {"parameterization", {{"dtype", "F16"}, {"shape", {1, 2}}, {"data_offsets", {16, 20}}}}};
    return {header, {0x3c00, 0x3c00, 0x3c00, 0x3c00, 0x3c00, 0x3c00, 0x4000, 0xc000, 0x3c00, 0x3c00}};
}

void expect_finite(const Model& model) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 8; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0));
        const Rgb f = value(model, wl, i % 2 ? to_float(random_direction(random, 0)) : mirror(wl));
        EXPECT_TRUE(is_finite(f) && f.r >= 0 && f.g >= 0 && f.b >= 0);
    }
}

/// The message of the read error. Empty if reading gives a model, whose values are then checked.
std::string read_error(const Bytes& bytes) {
    const auto model = read_model(bytes, k_source);
    if (model) return expect_finite(*model), "";
    EXPECT_EQ(model.error().source, k_source);
    EXPECT_FALSE(model.error().what.empty());
    const std::string line = message(model.error());
    EXPECT_EQ(line.find("a b.srbf: "), 0u) << line;
    EXPECT_LACKS(line, "\n");
    EXPECT_LT(line.size(), 400u) << line;
    return line;
}

/// The error after `damage` has changed a valid file.
template <typename Damage> std::string error_after(Damage damage, FileParts file = pm_file()) {
    damage(file);
    return read_error(file.bytes());
}

/// Expects that this error contains the part.
template <typename Damage> void expect_error(const std::string& part, Damage damage, FileParts file = pm_file()) {
    EXPECT_CONTAINS(error_after(damage, std::move(file)), part);
}

TEST(ModelFile, ReadsAValidFile) {
    const auto model = checked(read_model(pm_file().bytes(), "x"));
    const auto& pm = std::get<PmModel>(model->model);
    EXPECT_EQ(pm.coefficient, (std::vector<Rgb>{{1, 1, 1}, {1, 1, 1}}));
    EXPECT_EQ(pm.bandwidth, (std::vector<float>{2, 2}));
    EXPECT_EQ(pm.centre, (std::vector<Vec3f>{{0, 0, 1}, {0, 0, -1}}));
    EXPECT_EQ(pm.parameterization, (std::vector<Parameterization>{{1, 1}}));
    // The order and the whitespace of the header are free, and additional metadata is allowed.
    const FileParts file = pm_file();
    const std::string text = "  " + file.header.dump(4) + "\n ";
    EXPECT_EQ(read_error(container(text, file.data)), "");
    EXPECT_EQ(error_after([](FileParts& f) { f.header["__metadata__"]["more"] = "\u2713"; }), "");
}

/// Expects an error for every prefix of a model's bytes, and an error or a valid model for every flipped byte.
/// Returns the number of valid models.
int check_damaged_bytes(const Bytes& bytes) {
    EXPECT_EQ(read_error(bytes), "");
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_NE(read_error(Bytes(bytes.begin(), bytes.begin() + std::ptrdiff_t(size))), "") << size;
    int models = 0;
    for (std::size_t position = 0; position < bytes.size(); ++position)
        for (const int flip : {0x01, 0x80, 0xff}) {
            Bytes flipped = bytes;
            flipped[position] ^= std::byte(flip);
            models += read_error(flipped).empty();
        }
    return models;
}

TEST(ModelFile, TruncationsAreErrorsAndFlippedBytesErrorsOrModels) {
    std::mt19937_64 random(2);
    int models = 0;
    for (const bool axial : {true, false}) {
        const RandomModelOptions options{.axial = axial, .log_scale = axial, .lobes = 2, .variates = 2};
        const Bytes bytes = write_model({random_model(random, options), {{"source", "a.bsdf"}}});
        models += check_damaged_bytes(bytes);
        Bytes longer = bytes;
        longer.push_back(std::byte(0));
        EXPECT_CONTAINS(read_error(longer), "data");
    }
    EXPECT_GT(models, 0);  // flipped bytes of numbers and of provenance
}

TEST(ModelFile, InvalidHeadersAreErrors) {
    EXPECT_CONTAINS(read_error({}), "at 0: header length: expected 8 bytes, found 0 bytes");
    Bytes garbage;
    append(garbage, "MERL or any other file that is none of ours");
    EXPECT_CONTAINS(read_error(garbage), "at 0: header length: expected at most 35");
    for (const std::uint64_t extra :
         {std::uint64_t(1), std::uint64_t(1) << 32, std::uint64_t(1) << 63, ~std::uint64_t(0) - 2})
        EXPECT_CONTAINS(read_error(container("{}", {}, extra)), "header length");
    for (const char* text :
         {"", "{", "null", "[]", "\"x\"", "12", "{}}", "{\"a\":}", "{\"a\":1,}", "\xff", "{\"\xff\":1}"})
        EXPECT_CONTAINS(read_error(container(text)), "at 8: header: expected a JSON object") << text;
    EXPECT_NE(read_error(container("{}")), "");
}

TEST(ModelFile, LongHeadersAreErrors) {
    const std::string header = pm_file().header.dump(), filler(1 << 20, ' ');
    EXPECT_EQ(read_error(container(header + filler.substr(header.size()), pm_file().data)), "");
    EXPECT_CONTAINS(read_error(container(header + filler, pm_file().data)), "header length: expected at most 1048576");
    std::mt19937_64 random(1);
    const Model model{random_model(random, {}), {{"note", filler}}};
    const auto saved = save_model(model, "/dev/null");
    ASSERT_FALSE(saved.ok());
    EXPECT_CONTAINS(message(saved.error()), "header length");
}

TEST(ModelFile, DeepNestingIsAnError) {
    const std::string open(100000, '['), close(100000, ']');
    EXPECT_NE(read_error(container(open)), "");
    EXPECT_NE(read_error(container(open + close)), "");
    // Nesting within parts that are read and shown in messages.
    const auto error_of_entry = [&](const std::string& dtype, const std::string& shape, const std::string& offsets) {
        const std::string entry = "{\"dtype\":" + dtype + ",\"shape\":" + shape + ",\"data_offsets\":" + offsets + "}";
        return read_error(container("{\"bandwidth\":" + entry + "}", {0x3c00}));
    };
    const std::string deep = "header: expected at most 3 levels of JSON";
    EXPECT_CONTAINS(error_of_entry(open + close, "[1]", "[0,2]"), deep);
    EXPECT_CONTAINS(error_of_entry("\"F16\"", open + close, "[0,2]"), deep);
    EXPECT_CONTAINS(error_of_entry("\"F16\"", "[1]", open + close), deep);
    EXPECT_CONTAINS(read_error(container("{\"__metadata__\":" + open + close + "}")), deep);
    EXPECT_CONTAINS(read_error(container("{\"__metadata__\":{\"a\":" + open + close + "}}")), deep);
    // The deepest that is allowed, and one level more.
    EXPECT_CONTAINS(error_of_entry("\"F16\"", "[[]]", "[0,2]"), "shape");
    EXPECT_CONTAINS(error_of_entry("\"F16\"", "[[1]]", "[0,2]"), deep);
}

TEST(ModelFile, LongNamesAreCutInMessages) {
    const std::string name(100000, 'n');
    EXPECT_NE(error_after([&](FileParts& f) { f.header[name] = 1; }), "");
    EXPECT_NE(error_after([&](FileParts& f) { f.header[name] = f.header["bandwidth"]; }), "");
    EXPECT_NE(error_after([&](FileParts& f) { f.header["bandwidth"]["dtype"] = name; }), "");
    EXPECT_NE(error_after([&](FileParts& f) { f.header["bandwidth"]["shape"] = name; }), "");
    EXPECT_NE(error_after([&](FileParts& f) { f.header["__metadata__"]["form"] = name; }), "");
    EXPECT_NE(error_after([&](FileParts& f) { f.header["__metadata__"][name] = 1; }), "");
    EXPECT_NE(error_after([&](FileParts& f) { f.header["bandwidth"]["shape"] = std::vector<int>(100000, 1); }), "");
}

TEST(ModelFile, InvalidTensorsAreErrors) {
    for (const char* tensor : {"coefficient", "bandwidth", "parameterization"}) {
        const std::string what = std::string("tensor '") + tensor + "'";
        expect_error(what + ": dtype: expected \"F16\"", [&](FileParts& f) { f.header[tensor]["dtype"] = "F32"; });
        for (const char* part : {"dtype", "shape", "data_offsets"}) {
            expect_error(what, [&](FileParts& f) { f.header[tensor].erase(part); });
            for (const Json& invalid :
                 {Json(), Json(1), Json("x"), Json::object(), Json::array(), Json{1.5, 2}, Json{-1, 2}, Json{1, "x"},
                  Json{~std::uint64_t(0), ~std::uint64_t(0)}, Json{0, 1e300}})
                expect_error(what, [&](FileParts& f) { f.header[tensor][part] = invalid; });
        }
        expect_error(what, [&](FileParts& f) { f.header[tensor] = "x"; });
        EXPECT_NE(error_after([&](FileParts& f) { f.header.erase(tensor); }), "");
        // Renamed with its data, so that the file has no other problem.
        expect_error("tensor '", [&](FileParts& f) { f.header["z"] = f.header[tensor], f.header.erase(tensor); });
        for (const Json& shape : {Json{2, 2, 1, 1, 1, 1, 1, 1, 1}, Json{0, 3}, Json{std::uint64_t(1) << 40, 1},
                                  Json{std::uint64_t(1) << 32, std::uint64_t(1) << 32}, Json{1025, 1}, Json{7}})
            expect_error(what, [&](FileParts& f) { f.header[tensor]["shape"] = shape; });
    }
    // The tensor has as many elements in another shape.
    expect_error("tensor 'coefficient': shape: expected [2, 3], found [3, 2]", [](FileParts& f) {
        f.header["coefficient"]["shape"] = {3, 2};
    });
    expect_error("shape", [](FileParts& f) { f.header["bandwidth"]["shape"] = {1, 2}; });
    EXPECT_CONTAINS(error_after([](FileParts& f) { f.header["bandwidth"]["shape"] = {2}; }),
                    "tensor 'bandwidth': shape");
    expect_error("tensor 'parameterization'", [](FileParts& f) { f.header["parameterization"]["shape"] = {2, 1}; });
}

TEST(ModelFile, CountsBeyondTheLimitsAreErrors) {
    const auto error_of_shape = [](std::size_t J, std::size_t N) {
        FileParts f = pm_file();
        const std::size_t a = 6 * J, b = a + 2 * J * N, c = b + 4 * N;
        f.header["coefficient"] = {{"dtype", "F16"}, {"shape", {J, 3}}, {"data_offsets", {0, a}}};
        f.header["bandwidth"] = {{"dtype", "F16"}, {"shape", {J, N}}, {"data_offsets", {a, b}}};
        f.header["parameterization"] = {{"dtype", "F16"}, {"shape", {N, 2}}, {"data_offsets", {b, c}}};
        f.data.assign(c / 2, 0x3c00);
        return read_error(f.bytes());
    };
    EXPECT_EQ(error_of_shape(k_max_lobes, k_max_variates), "");
    EXPECT_CONTAINS(error_of_shape(k_max_lobes + 1, 1), "expected [J, N] up to [1024, 8], found [1025, 1]");
    EXPECT_CONTAINS(error_of_shape(1, k_max_variates + 1), "found [1, 9]");
    EXPECT_NE(error_of_shape(0, 1), "");
    EXPECT_NE(error_of_shape(1, 0), "");
}

TEST(ModelFile, OverlapsGapsAndTrailingBytesAreErrors) {
    expect_error("data", [](FileParts& f) { f.header["bandwidth"]["data_offsets"] = {10, 14}; });
    expect_error("without gap or overlap", [](FileParts& f) { f.header["bandwidth"]["data_offsets"] = {16, 20}; });
    expect_error("data_offsets", [](FileParts& f) { f.header["bandwidth"]["data_offsets"] = {14, 12}; });
    expect_error("data_offsets", [](FileParts& f) { f.header["bandwidth"]["data_offsets"] = {12, 18}; });
    expect_error("data_offsets", [](FileParts& f) { f.header["parameterization"]["data_offsets"] = {18, 22}; });
    expect_error("data: expected 20 bytes, found 22 bytes", [](FileParts& f) { f.data.push_back(0); });
    // A gap before the first tensor, or between two tensors.
    for (const int first : {0, 1, 2}) {
        const auto gap = [&](FileParts& f) {
            const char* const order[] = {"coefficient", "bandwidth", "parameterization"};
            for (int i = first; i < 3; ++i)
                for (Json& offset : f.header[order[i]]["data_offsets"]) offset = offset.get<unsigned>() + 2;
            f.data.push_back(0x3c00);
        };
        expect_error("data: expected tensors without gap or overlap", gap);
    }
}

TEST(ModelFile, NumbersOutOfRangeAreErrors) {
    for (const unsigned bad : {0x7c00u, 0xfc00u, 0x7e00u, 0x7c01u, 0xffffu})
        for (std::size_t i = 0; i < 10; ++i)
            EXPECT_CONTAINS(error_after([&](FileParts& f) { f.data[i] = std::uint16_t(bad); }),
                            "expected finite numbers")
                << i;
    expect_error("tensor 'coefficient': expected numbers of at least 0, found -1",
                 [](FileParts& f) { f.data[4] = 0xbc00; });
    expect_error("tensor 'parameterization'", [](FileParts& f) { f.data[8] = 0, f.data[9] = 0x8000; });
    EXPECT_EQ(error_after([](FileParts& f) { f.data[8] = 0; }), "");
    // The sign of a bandwidth is meaningful only for axial lobes.
    const auto general = [](std::uint16_t bandwidth) {
        return error_after([&](FileParts& f) {
            f.header["__metadata__"]["axial"] = "false";
            f.header["centre"] = {{"dtype", "F16"}, {"shape", {2, 1, 2}}, {"data_offsets", {20, 28}}};
            f.data.resize(14, 0x3c00);
            f.data[7] = bandwidth;
        });
    };
    EXPECT_EQ(general(0x4000), "");
    EXPECT_CONTAINS(general(0xc000), "tensor 'bandwidth': expected numbers of at least 0, found -2");
}

TEST(ModelFile, MissingOrUnknownTensorsAreErrors) {
    const auto error_with_tensor = [](const char* name, const char* axial, Json shape) {
        return error_after([&](FileParts& f) {
            f.header["__metadata__"]["axial"] = axial;
            f.header[name] = {{"dtype", "F16"}, {"shape", shape}, {"data_offsets", {20, 28}}};
            f.data.resize(14, 0x3c00);
        });
    };
    EXPECT_CONTAINS(error_with_tensor("centre", "true", {2, 1, 2}), "tensor 'centre': expected none of that name");
    EXPECT_CONTAINS(error_with_tensor("gloss", "true", {4}), "tensor 'gloss'");
    EXPECT_CONTAINS(error_with_tensor("log_scale", "true", {4}), "tensor 'log_scale': shape: expected [2], found [4]");
    EXPECT_CONTAINS(error_with_tensor("gloss", "false", {4}), "tensor 'centre': expected present, found none");
    expect_error("number of tensors", [](FileParts& f) {
        for (std::size_t i = 1; i < 100; ++i) f.header[std::string(i, 't')] = f.header["bandwidth"];
    });
}

TEST(ModelFile, InvalidMetadataIsAnError) {
    for (const char* key : {"srbf", "model", "form", "axial"}) {
        const std::string what = std::string("metadata '") + key + "'";
        expect_error(what, [&](FileParts& f) { f.header["__metadata__"].erase(key); });
        for (const char* text : {"", "2", "gloss", "TRUE", "x\ny"})
            expect_error(what, [&](FileParts& f) { f.header["__metadata__"][key] = text; });
        expect_error(std::string("metadata ") + key, [&](FileParts& f) { f.header["__metadata__"][key] = true; });
    }
    expect_error("metadata 'srbf': expected 1, found none", [](FileParts& f) { f.header.erase("__metadata__"); });
    expect_error("metadata", [](FileParts& f) { f.header["__metadata__"] = 3; });
}

// ---- Spectral ----

TEST(ModelFile, SpectralModelsKeepTheirWavelengths) {
    std::mt19937_64 random(5);
    for (const int count : {1, 2, 3, 4, 31})
        for (const bool log_scale : {false, true}) {
            const PmModel model =
                rounded(spectral_model(random, {.log_scale = log_scale, .lobes = 3, .variates = 2}, count));
            const Bytes bytes = write_model({model, {{"source", "a.brdf"}}});
            const auto again = checked(read_model(bytes, "x"));
            EXPECT_EQ(std::get<PmModel>(again->model), model);
            EXPECT_EQ(again->provenance, (std::map<std::string, std::string>{{"source", "a.brdf"}}));
            EXPECT_EQ(payload_bytes(model), 2u * unsigned(3 * (count + 2 + log_scale) + 4));
            EXPECT_TRUE(std::ranges::equal(srbf::wavelengths(*again), model.wavelength));
        }
}

TEST(ModelFile, TruncationsOfSpectralModelsAreErrorsAndFlippedBytesErrorsOrModels) {
    std::mt19937_64 random(6);
    const PmModel model = spectral_model(random, {.axial = false, .lobes = 2, .variates = 1}, 4);
    EXPECT_GT(check_damaged_bytes(write_model({model, {}})), 0);
}

TEST(ModelFile, InvalidWavelengthsAreErrors) {
    const auto error_with_wavelengths = [](const char* wavelengths, std::size_t count) {
        return error_after([&](FileParts& f) {
            f.header["__metadata__"]["wavelengths"] = wavelengths;
            f.header["coefficient"]["shape"] = {2, count};
            f.header["coefficient"]["data_offsets"] = {0, 4 * count};
            f.header["bandwidth"]["data_offsets"] = {4 * count, 4 * count + 4};
            f.header["parameterization"]["data_offsets"] = {4 * count + 4, 4 * count + 8};
            f.data.assign(2 * count + 4, 0x3c00);
        });
    };
    EXPECT_EQ(error_with_wavelengths("450 550", 2), "");
    EXPECT_EQ(error_with_wavelengths(" 400.5  500 600 700 ", 4), "");
    EXPECT_CONTAINS(error_with_wavelengths("450 550", 3), "tensor 'coefficient': shape: expected [2, 2], found [2, 3]");
    for (const char* text :
         {"", " ", "550 450", "450 450", "450 x", "450,550", "nan 450", "99 450", "450 1e6", "-450 450"})
        EXPECT_CONTAINS(error_with_wavelengths(text, 2), "metadata 'wavelengths'") << text;
    std::string many;
    for (std::size_t i = 0; i <= k_max_wavelengths; ++i) many += std::to_string(400 + i) + " ";
    EXPECT_CONTAINS(error_with_wavelengths(many.c_str(), k_max_wavelengths + 1), "1 to 4096 increasing ones");
}

// ---- View by view ----

SuModel small_su(int index) {
    std::mt19937_64 random(4);
    SuModel model = random_su(random, 8, 2);
    if (index > 0) model.index = index_texture(model, index == 1 ? DirectionMap::cube : DirectionMap::parabolic, 2);
    return model;
}

/// A valid file with n = 8, J = 2 and a cube.
FileParts su_file() {
    const Bytes bytes = write_model({small_su(1), {}});
    FileParts file{header_of(bytes), {}};
    for (std::size_t position = 8 + header_length_of(bytes); position < bytes.size(); position += 2)
        file.data.push_back(uint16_at(bytes, position));
    return file;
}
template <typename Damage> std::string su_error_after(Damage damage) { return error_after(damage, su_file()); }
template <typename Damage> void expect_su_error(const std::string& part, Damage damage) {
    expect_error(part, damage, su_file());
}

TEST(SuModelFile, TruncationsAreErrorsAndFlippedBytesErrorsOrModels) {
    int models = 0;
    for (const int index : {0, 1, 2})
        models += check_damaged_bytes(write_model({small_su(index), {{"source", "a.bsdf"}}}));
    EXPECT_GT(models, 0);
}

TEST(SuModelFile, NumbersOutOfRangeAreErrors) {
    EXPECT_EQ(su_error_after([](FileParts&) {}), "");
    for (const char* tensor : {"coefficient", "bandwidth", "centre"}) {
        for (const unsigned bad : {0x7c00u, 0xfc00u, 0x7e00u})
            expect_su_error("expected finite numbers", [&](FileParts& f) { f.number(tensor, 5) = std::uint16_t(bad); });
        const std::string negative = su_error_after([&](FileParts& f) { f.number(tensor, 5) = 0xbc00; });
        if (tensor == std::string("centre"))
            EXPECT_EQ(negative, "");
        else
            EXPECT_CONTAINS(negative, "expected numbers of at least 0, found -1");
    }
    expect_su_error("tensor 'aux.index': expected numbers below 8, found 8",
                    [](FileParts& f) { f.number("aux.index", 77) = 8; });
    expect_su_error("expected the Fibonacci set of 8", [](FileParts& f) { f.number("aux.directions", 4) ^= 1; });
    expect_su_error("aux.directions", [](FileParts& f) { f.number("aux.directions", 3) = 0x3c00; });
}

TEST(SuModelFile, InvalidTensorsAreErrors) {
    for (const char* tensor : {"coefficient", "bandwidth", "centre", "aux.index", "aux.directions"}) {
        const std::string what = std::string("tensor '") + tensor + "'";
        const bool is_index = tensor == std::string("aux.index");
        expect_su_error(what + ": dtype", [&](FileParts& f) { f.header[tensor]["dtype"] = is_index ? "F16" : "U16"; });
        expect_su_error(what + ": dtype", [&](FileParts& f) { f.header[tensor]["dtype"] = "U32"; });
        EXPECT_NE(su_error_after([&](FileParts& f) { f.header.erase(tensor); }), "");  // its data remain
    }
    const auto error_of_shape = [](const char* tensor, const Json& shape) {
        return su_error_after([&](FileParts& f) { f.header[tensor]["shape"] = shape; });
    };
    EXPECT_CONTAINS(error_of_shape("aux.index", {2, 6, 2, 8}), "tensor 'aux.index': shape");
    EXPECT_CONTAINS(error_of_shape("aux.index", {24, 8}), "tensor 'aux.index': shape");
    EXPECT_CONTAINS(error_of_shape("aux.index", {4, 6, 8}), "tensor 'aux.index': shape");
    EXPECT_CONTAINS(error_of_shape("bandwidth", {2, 8}), "expected [n, J] from [8, 1]");
    EXPECT_CONTAINS(error_of_shape("bandwidth", {16, 1}), "shape");
    EXPECT_CONTAINS(error_of_shape("centre", {8, 4}), "tensor 'centre': shape: expected [8, 2, 2], found [8, 4]");
    expect_su_error("data", [](FileParts& f) { f.header["gloss"] = f.header["bandwidth"]; });
}

TEST(SuModelFile, InvalidMetadataIsAnError) {
    for (const char* key : {"srbf", "model", "discretise", "interpolation", "neighbours"}) {
        const std::string what = std::string("metadata '") + key + "'";
        expect_su_error(what, [&](FileParts& f) { f.header["__metadata__"].erase(key); });
        for (const char* text : {"", "0", "8", "views", "33"})
            expect_su_error(what, [&](FileParts& f) { f.header["__metadata__"][key] = text; });
    }
    // The tensors of one kind with the metadata of another.
    EXPECT_NE(su_error_after([](FileParts& f) {
                  f.header["__metadata__"] = {{"srbf", "1"}, {"model", "pm"}, {"form", "source"}, {"axial", "false"}};
              }),
              "");
}

}  // namespace
}  // namespace srbf::model_file_test
