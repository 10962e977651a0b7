// Damaged files: reading gives an Error that describes the problem, or a table that keeps its contract; it never
// crashes.
#include "base/text.h"
#include "corpus.h"
#include "measured/formats.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "measured_files.h"
#include "srbf/file.h"
#include "temporary_folder.h"

namespace srbf::measured_test {
namespace {

const std::string k_name = "test\n.file";

/// Expects that a read result is an error with all its parts, or a table that keeps the contract of a BRDF.
template <typename Table> void expect_contract_or_error(const Table& table, std::mt19937_64& random) {
    constexpr bool may_be_missing = !std::is_same_v<Table, ScatteredSamples>;
    constexpr bool two_sided = std::is_same_v<Table, BsdfTable>;  // keeps the contract in the frame of each part
    for (int i = 0; i < 40; ++i) {
        Vec3f wl = to_float(random_direction(random)), wv = to_float(random_direction(random));
        if (i % 4 == 0) wl = {0, 0, 1};
        if (i % 4 == 1) wv = mirror(wl);
        if (i % 4 == 2) wv = {1, 0, 1e-30f};
        const auto in_frame = [](Vec3f w) { return two_sided ? Vec3f{w.x, w.y, std::abs(w.z)} : w; };
        EXPECT_TRUE(satisfies_contract(value(table, wl, wv), in_frame(wl), in_frame(wv), may_be_missing));
        EXPECT_TRUE(may_be_missing || is_finite(signed_value(table, wl, wv)));
    }
}

template <typename Table> void expect_contract_or_error(const Result<Table>& table, std::mt19937_64& random) {
    if (table) return expect_contract_or_error(*table, random);
    EXPECT_EQ(table.error().source, k_name);
    EXPECT_FALSE(table.error().what.empty());
    EXPECT_LACKS(error_text(table), "\n");
    EXPECT_LT(message(table.error()).size(), 1000u);
}

/// Reads the bytes by content and as each format. False if reading by content gives an error.
bool read_all(std::span<const std::byte> bytes, std::mt19937_64& random) {
    // A copy of exactly this size, so that sanitizers notice reads past its end.
    const Bytes copy(bytes.begin(), bytes.end());
    const auto measured = read_measured(copy, k_name);
    if (measured)
        std::visit([&](const auto& table) { expect_contract_or_error(table, random); }, measured->table);
    else
        expect_contract_or_error(Result<RglTable>(measured.error()), random);
    expect_contract_or_error(read_merl(copy, k_name), random);
    expect_contract_or_error(read_rgl(copy, k_name), random);
    expect_contract_or_error(read_mbsdf(copy, k_name), random);
    for (const auto reader : {read_cornell, read_astm, read_alta})
        expect_contract_or_error(build_index(reader(copy, k_name)), random);
    expect_contract_or_error(build_index(read_csv(copy, k_name, {})), random);
    return measured.ok();
}

Bytes with_flipped_bits(std::span<const std::byte> bytes, std::size_t position, int pattern) {
    Bytes damaged(bytes.begin(), bytes.end());
    damaged[position] ^= std::byte(pattern);
    return damaged;
}

constexpr std::size_t k_merl_header = 3 * sizeof(std::int32_t);  ///< the numbers of nodes [bytes]

Bytes small_merl() {
    return merl_file({3, 4, 5}, [](int h, int d, int p, int c) { return (h + d + p) % 7 == 6 ? -1 : 1 + c + h; });
}

TEST(DamagedInput, EveryTruncationIsAnError) {
    std::mt19937_64 random(1);
    for (const Bytes& bytes :
         {small_merl(), tensor_file(simple_rgl()), tensor_file(spectral_rgl()), small_mbsdf(), grey_mbsdf()}) {
        EXPECT_TRUE(read_all(bytes, random));
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            // An MBSDF file without its transmission is valid.
            const std::string_view remainder = as_text(std::span(bytes).subspan(size));
            EXPECT_EQ(read_all(std::span(bytes).first(size), random), remainder.starts_with("MBSDF_DATA_TRANSMISSION="))
                << size;
        }
    }
}

/// A text that is truncated between two samples or within the digits of the last number is a valid shorter file.
TEST(DamagedInput, EveryTruncationOfATextIsAnErrorOrAShorterFile) {
    std::mt19937_64 random(5);
    for (const std::string_view text : {k_small_cornell, k_small_astm, k_small_alta, k_small_csv}) {
        EXPECT_TRUE(read_all(as_bytes(text), random)) << text;
        std::size_t errors = 0;
        for (std::size_t size = 0; size < text.size(); ++size) errors += !read_all(as_bytes(text).first(size), random);
        // Truncation within the header, or within a row before its last number, is an error.
        EXPECT_GE(errors, text.size() / 2) << text;
    }
}

TEST(DamagedInput, EveryFlippedByteOfATextIsAnErrorOrSamples) {
    std::mt19937_64 random(6);
    for (const std::string_view text : {k_small_cornell, k_small_astm, k_small_alta, k_small_csv})
        for (std::size_t position = 0; position < text.size(); ++position)
            for (const int pattern : {0xff, 0x01, 0x80, 0x10, 0x20})
                read_all(with_flipped_bits(as_bytes(text), position, pattern), random);
}

TEST(DamagedInput, EveryFlippedHeaderByteIsAnErrorOrATable) {
    std::mt19937_64 random(2);
    std::size_t header = 0, spectral_header = 0, anisotropic_header = 0;
    const Bytes rgl = tensor_file(simple_rgl(), &header), spectral = tensor_file(spectral_rgl(), &spectral_header),
                anisotropic = tensor_file(anisotropic_rgl(), &anisotropic_header);
    for (const auto& [bytes, size] : {std::pair(rgl, header),
                                      {small_merl(), k_merl_header},
                                      {spectral, spectral_header},
                                      {anisotropic, anisotropic_header},
                                      {small_mbsdf(), small_mbsdf().size()},
                                      {grey_mbsdf(), grey_mbsdf().size()}})
        for (std::size_t position = 0; position < size; ++position)
            for (const int pattern : {0xff, 0x01, 0x80}) read_all(with_flipped_bits(bytes, position, pattern), random);
}

TEST(DamagedInput, EveryFlippedByteOfTheNumbersIsAnErrorOrATable) {
    std::mt19937_64 random(3);
    for (const Bytes& bytes : {small_merl(), tensor_file(simple_rgl())})
        for (std::size_t position = k_merl_header; position < bytes.size(); ++position)
            read_all(with_flipped_bits(bytes, position, position % 2 ? 0x7f : 0xff), random);
}

TEST(DamagedInput, HasPlainMessages) {
    const auto message_for = [](std::span<const std::byte> bytes) { return error_text(read_measured(bytes, "f")); };
    EXPECT_EQ(message_for({}), "f: unknown format: expected " + names_of_formats() + ", found an empty file");
    EXPECT_TRUE(names_of_formats().starts_with("RGL, ") && names_of_formats().ends_with(" or UTIA"));
    EXPECT_CONTAINS(message_for(as_bytes("theta phi\n1 2\n")), "unknown format");

    Bytes truncated = merl_file({90, 90, 180}, [](int, int, int, int) { return 0.1; });
    ASSERT_EQ(message_for(truncated), "");
    truncated.resize(truncated.size() - 8);
    EXPECT_EQ(message_for(truncated),
              "f: at 12: size of a MERL table of 90 x 90 x 180: expected 34992012 bytes, found 34992004 bytes");

    const double nan = std::nan("");
    EXPECT_EQ(message_for(merl_file({3, 4, 5}, [&](int, int, int, int) { return nan; })),
              "f: at 12: MERL cells: expected at least one measured (finite and not negative), found none");
}

/// A file of the format that is larger than the size to which files of unknown format are read.
Bytes large_file(const Format& format) {
    if (format.name == "UTIA") return Bytes(format.size({}));
    if (format.name == "MERL") return merl_file({50, 50, 50}, [](auto...) { return 1; });
    for (const auto& [target, files] : corpus_files())
        for (const std::string& text : files) {
            Bytes bytes(as_bytes(text).begin(), as_bytes(text).end());
            if (format_of(bytes) != &format) continue;
            bytes.resize(3'000'000, std::byte('\n'));
            return bytes;
        }
    return {};
}

TEST(Formats, AreReadCompletely) {
    const TemporaryFolder folder;
    EXPECT_GE(formats().size(), 8u);
    for (const Format& format : formats()) {
        const Bytes bytes = large_file(format);
        ASSERT_FALSE(bytes.empty()) << "the corpus lacks a file of " << format.name;
        ASSERT_TRUE(write_file((folder / "file").string(), bytes).ok());
        const auto read = checked(read_input((folder / "file").string()));
        EXPECT_EQ(read->size(), bytes.size()) << format.name;
    }
}

std::string rgl_error(const std::vector<FieldToWrite>& fields) {
    return error_text(read_rgl(tensor_file(fields), "f"));
}

TEST(DamagedInput, SizesBeyondTheFileAreRejected) {
    for (const std::int32_t n : {0, -1, 4097, 0x7fffffff}) {
        Bytes merl;
        for (int i = 0; i < 3; ++i) append(merl, n);
        merl.resize(1000);
        const auto table = read_merl(merl, "f");
        ASSERT_FALSE(table.ok());
        EXPECT_EQ(table.error().what, "MERL dimensions");
    }
    Bytes large_merl;
    for (int i = 0; i < 3; ++i) append(large_merl, std::int32_t(4096));
    EXPECT_FALSE(read_merl(large_merl, "f").ok());

    for (const std::uint64_t n : {std::uint64_t(0x7fffffff), std::uint64_t(1) << 62, ~std::uint64_t(0)}) {
        auto fields = simple_rgl();
        field(fields, "vndf").shape = {1, 3, n, n};
        EXPECT_CONTAINS(rgl_error(fields), "to lie within");
        field(fields, "vndf").shape = {0, n, n, n};  // no elements
        EXPECT_FALSE(rgl_error(fields).empty());
    }

    // An offset near 2⁶⁴ wraps around when the size is added. It is in the first entry, after its name.
    auto fields = simple_rgl();
    Bytes wrapping = tensor_file(fields);
    const std::uint64_t offset = ~std::uint64_t(1);
    std::memcpy(&wrapping[18 + 2 + fields[0].name.size() + 2 + 1], &offset, sizeof offset);
    const auto table = read_rgl(wrapping, "f");
    ASSERT_FALSE(table.ok());
    EXPECT_CONTAINS(table.error().expected, "to lie within");
}

TEST(DamagedInput, EachNeededFieldIsChecked) {
    for (const auto& [name, type, shape, numbers] : simple_rgl()) {
        const std::string tensor_field = "tensor field " + name;
        auto missing = simple_rgl();
        std::erase_if(missing, [&, name = name](const FieldToWrite& f) { return f.name == name; });
        EXPECT_CONTAINS(rgl_error(missing), tensor_field);
        EXPECT_CONTAINS(rgl_error(missing), "no such field");

        auto other_type = simple_rgl();
        field(other_type, name).type = type == TensorType::u8 ? TensorType::i8 : TensorType::u32;
        EXPECT_CONTAINS(rgl_error(other_type), tensor_field);

        auto other_rank = simple_rgl();
        field(other_rank, name).shape.push_back(1);
        EXPECT_CONTAINS(rgl_error(other_rank), tensor_field);

        auto duplicated = simple_rgl();
        duplicated.push_back(field(duplicated, name));
        EXPECT_CONTAINS(rgl_error(duplicated), tensor_field + ": expected each name once");

        if (type != TensorType::f32) continue;
        for (const float bad : {std::nanf(""), INFINITY, -INFINITY, -1e20f}) {
            auto filled = simple_rgl();
            FieldToWrite& f = field(filled, name);
            std::memcpy(f.numbers.data() + f.numbers.size() - 4, &bad, 4);
            EXPECT_CONTAINS(rgl_error(filled), tensor_field + ": expected values") << bad;
        }
    }
}

TEST(DamagedInput, EachValueIsChecked) {
    const auto error_with_field = [](const std::string& name, std::vector<std::uint64_t> shape, auto f) {
        auto fields = simple_rgl();
        field(fields, name) = float_field(name, std::move(shape), f);
        return rgl_error(fields);
    };
    const auto zero = [](std::size_t) { return 0.0f; };
    const auto index = [](std::size_t i) { return float(i); };
    EXPECT_CONTAINS(error_with_field("theta_i", {3}, zero), "increasing");
    EXPECT_CONTAINS(error_with_field("vndf", {1, 3, 4, 5}, zero), "positive integral");
    EXPECT_CONTAINS(error_with_field("vndf", {1, 3, 4, 5}, [](std::size_t) { return -1.0f; }), "found -1");
    EXPECT_CONTAINS(error_with_field("sigma", {2, 5}, zero), "found 0");
    EXPECT_CONTAINS(error_with_field("ndf", {2, 4}, index), "isotropic");
    EXPECT_CONTAINS(error_with_field("ndf", {2, 1}, zero), "at least 2 nodes");
    EXPECT_CONTAINS(error_with_field("vndf", {1, 3, 1, 5}, index), "at least 2 x 2");
    EXPECT_CONTAINS(error_with_field("rgb", {1, 3, 3, 4, 1}, index), "at least 2 x 2");
    EXPECT_CONTAINS(error_with_field("rgb", {1, 3, 4, 4, 3}, index), "expected 1 x 3 x 3 x n x n of f32");
    EXPECT_CONTAINS(error_with_field("phi_i", {3}, zero), "increasing azimuths over a whole turn");
    EXPECT_CONTAINS(error_with_field("phi_i", {3}, index),
                    "increasing azimuths over a whole turn");  // covers only two radians

    const auto with_wavelengths = [](const std::vector<float>& nm) {
        auto fields = spectral_rgl();
        field(fields, "wavelengths") = float_field("wavelengths", {nm.size()}, [&](std::size_t i) { return nm[i]; });
        return rgl_error(fields);
    };
    EXPECT_EQ(with_wavelengths({450, 550, 600}), "");
    for (const std::vector<float>& nm :
         {std::vector<float>{450, 450, 600}, {450, 600, 550}, {1, 2, 3}, {500, 600, 1e9f}})
        EXPECT_CONTAINS(with_wavelengths(nm), "tensor field wavelengths");
    EXPECT_CONTAINS(with_wavelengths({450, 550}), "tensor field spectra: expected 1 x 3 x 2 x n x n");
    auto without_wavelengths = spectral_rgl();
    std::erase_if(without_wavelengths, [](const FieldToWrite& f) { return f.name == "wavelengths"; });
    EXPECT_CONTAINS(rgl_error(without_wavelengths), "tensor field wavelengths");
}

}  // namespace
}  // namespace srbf::measured_test
