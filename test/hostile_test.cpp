// Files made to do harm: memory stays bounded, the error names its file, and terminals get no control characters.
#include <sys/resource.h>
#include <sys/wait.h>

#include <set>
#include <sstream>

#include "base/printable.h"
#include "base/text.h"
#include "command.h"
#include "models.h"
#include "srbf/shading_code.h"

namespace srbf::hostile_test {
namespace {

namespace fs = std::filesystem;

/// Sanitizers take long, and keep memory that was freed.
#ifdef __SANITIZE_ADDRESS__
constexpr bool k_is_sanitized = true;
#else
constexpr bool k_is_sanitized = false;
#endif

/// Writes `part` again and again between `first` and `last`. This program stays small: a process that it starts begins
/// with its size.
void write_many(const fs::path& path, const std::string& first, std::string_view part, std::size_t count,
                const std::string& last = {}) {
    std::ofstream out(path, std::ios::binary);
    out << first;
    for (std::size_t i = 0; i < count; ++i) out << part;
    out << last;
}

std::string little_endian(std::uint64_t number, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += char(number >> 8 * i & 0xff);
    return text;
}

/// A model file of a header of that length, as far as it begins so.
std::string model_of(std::size_t length, const std::string& header) { return little_endian(length, 8) + header; }

/// The most memory [bytes] that the program takes.
std::int64_t memory_of(const TemporaryFolder& folder, const Arguments& arguments) {
    const TemporaryFolder captured;
    const pid_t process = start(folder, arguments, captured / "out", captured / "err");
    int status = 0;
    rusage usage{};
    EXPECT_EQ(::wait4(process, &status, 0, &usage), process);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) <= 1);
    const std::string err = contents(captured / "err");
    EXPECT_LE(std::ranges::count(err, '\n'), 1) << err;
    return std::int64_t(usage.ru_maxrss) * 1024;
}

using Hostile = CommandLine;

/// Many parts of a few bytes, of which a library or a reader would make objects.
TEST_F(Hostile, SmallPartsTakeNoMoreMemoryThanPromised) {
    constexpr std::size_t size = k_is_sanitized ? 1'000'000 : 20'000'000;
    struct File {
        std::string name, first, part, last;
    };
    const std::string columns = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n", xml = "<?xml?><WindowElement";
    const std::vector<File> files{
        {"deep.srbf", model_of(size, ""), "{\"a\":", ""},
        {"deep_short.srbf", model_of(1 << 20, ""), "{\"a\":", ""},
        {"lists.srbf", model_of(1 << 20, "{\"a\":"), "[", ""},
        {"numbers.srbf", model_of(1 << 20, "{\"a\":{\"shape\":["), "1,", ""},
        {"deep.xml", "<?xml?>", "<a>", ""},
        {"wide.xml", xml + ">", "<a/>", "</WindowElement>"},
        {"attributes.xml", xml, " a=''", "/>"},
        {"entries.mbsdf", "NVIDIA ARC MBSDF V1\n", "a=\"\"\n", ""},
        {"header.csv", "wl_x,", ",", ""},
        {"columns.csv", columns, ",", ""},
        {"lines.csv", columns, "0,0,1,0,0,1,1\n", ""},
        {"words.brdf", "1\n", "1 ", ""},
        {"vars.astm", "VARS ", "a,", ""},
        {"dim.alta", "#DIM ", "1 ", ""},
        {"rows.xompt", "{\"x\":\"OpenMATERIAL\",\"brdf\":{\"lookupTable\":[", "[5e-7,1,1,1,1],", "[5e-7,1,1,1,1]]}}"},
        {"deep.xompt", "{\"x\":\"OpenMATERIAL\",\"brdf\":{\"lookupTable\":[", "[", ""},
        {"values.json", "{\"theta_i\":0,\"data\":{\"BRDF\":{\"values\":[1", ",1", "]}}}"},
        {"deep.json", "{\"theta_i\":", "{\"a\":", ""},
        {"values.zemax", "Source Measured\nScatterRadial 3600\n", "1 ", ""},
        {"rows.fred", "type bsdf_data\n0 0\n", "1 1 1\n", ""},
        {"unknown", "", "unknown\1", ""},
    };
    const std::int64_t base = memory_of(folder, {"info", "missing"});
    EXPECT_LT(base, 64 << 20 << k_is_sanitized);
    const auto check = [&](const std::string& name) {
        SCOPED_TRACE(name);
        const auto promised = 4 * std::int64_t(fs::file_size(folder / name)) + (std::int64_t(64) << 20);
        const std::int64_t taken = memory_of(folder, {"info", name}) - base;
        if (!k_is_sanitized) {
            EXPECT_LT(taken, promised);
        }
        fs::remove(folder / name);
    };
    for (const File& file : files) {
        write_many(folder / file.name, file.first, file.part, size / file.part.size(), file.last);
        check(file.name);
    }
    std::ofstream fields(folder / "fields.bsdf", std::ios::binary);
    fields << "tensor_file" << std::string("\0\1\0", 3) << little_endian(size / 20, 4);
    for (std::uint64_t i = 0; i < size / 20; ++i)  // a name, no extents, u8, no offset
        fields << little_endian(5, 2) << fmt::format("{:05x}", i) << little_endian(0, 2) << '\1' << little_endian(0, 8);
    fields.close();
    check("fields.bsdf");
}

/// A header of OpenEXR for three channels of floats, of which a test changes parts.
struct ExrHeader {
    std::string pixel_type = little_endian(2, 4), sampling = little_endian(1, 4), compression = "\3", tiles = {},
                more = {};
    std::array<std::uint32_t, 4> window{0, 0, 2, 1};

    static std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
        return name + '\0' + type + '\0' + little_endian(value.size(), 4) + value;
    }
    std::string text(std::uint32_t flags = 0) const {
        std::string channels, box;
        for (const char* name : {"B", "G", "R"})
            channels += name + ('\0' + pixel_type) + little_endian(0, 4) + sampling + little_endian(1, 4);
        for (const std::uint32_t number : window) box += little_endian(number, 4);
        return "\x76\x2f\x31\x01" + little_endian(2 | flags, 4) + attribute("channels", "chlist", channels + '\0') +
               attribute("compression", "compression", compression) + attribute("dataWindow", "box2i", box) +
               attribute("displayWindow", "box2i", box) + attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
               attribute("pixelAspectRatio", "float", little_endian(0x3f800000, 4)) +
               attribute("screenWindowCenter", "v2f", std::string(8, '\0')) +
               attribute("screenWindowWidth", "float", little_endian(0x3f800000, 4)) + tiles + more + '\0';
    }
};

/// Sizes, counts, kinds and offsets that no file of that length has.
TEST_F(Hostile, HeadersOfOpenExrAreBounded) {
    if (!is_offered({"render"})) GTEST_SKIP() << "without srbf render";
    constexpr std::uint32_t k_most = 0x7fffffff, k_tiled = 0x200;
    const auto tiles = [](std::uint32_t side, char mode) {
        return ExrHeader::attribute("tiles", "tiledesc", little_endian(side, 4) + little_endian(side, 4) + mode);
    };
    const auto cut = [](const std::string& name, std::uint64_t size) {
        return name + '\0' + "string" + '\0' + little_endian(size, 4);
    };
    const std::string first_row = little_endian(0x141, 8), zeros(400, '\0');
    const ExrHeader plain;
    const std::map<std::string, std::string> files{
        {"window", ExrHeader{.window = {0, 0, k_most - 1, k_most - 1}}.text()},
        {"overflowing_window", ExrHeader{.window = {k_most + 1, k_most + 1, k_most, k_most}}.text()},
        {"reversed_window", ExrHeader{.window = {5, 5, 1, 1}}.text()},
        {"wide_window", ExrHeader{.window = {0, 0, (1 << 26) - 1, 0}}.text()},
        {"tall_window", ExrHeader{.window = {0, 0, 0, (1 << 26) - 1}}.text()},
        {"more_pixels_than_bytes", ExrHeader{.window = {0, 0, 8191, 8191}}.text() + std::string(40000, '\0')},
        {"large_blocks", ExrHeader{.compression = "\x09", .window = {0, 0, (1 << 18) - 1, 255}}.text()},
        {"huge_tiles", ExrHeader{.tiles = tiles(k_most, 0)}.text(k_tiled)},
        {"no_tiles", ExrHeader{.tiles = tiles(0, 0)}.text(k_tiled)},
        {"many_tiles", ExrHeader{.tiles = tiles(1, 0), .window = {0, 0, 8191, 8191}}.text(k_tiled)},
        {"tiles_of_all_sizes", ExrHeader{.tiles = tiles(1, 2), .window = {0, 0, 8191, 1}}.text(k_tiled)},
        {"long_attribute", ExrHeader{.more = cut("x", k_most)}.text()},
        {"negative_attribute", ExrHeader{.more = cut("x", 0xfffffffb)}.text()},
        {"pixel_type", ExrHeader{.pixel_type = little_endian(77, 4)}.text()},
        {"sampling", ExrHeader{.sampling = little_endian(0xffffffff, 4)}.text()},
        {"no_sampling", ExrHeader{.sampling = little_endian(0, 4)}.text()},
        {"compression", ExrHeader{.compression = "\xc8"}.text()},
        {"deep", plain.text(0x800)},
        {"parts", plain.text(0x1000)},
        {"offset_beyond", plain.text() + little_endian(std::uint64_t(1) << 63, 8)},
        {"offset_of_the_header", plain.text() + little_endian(8, 8)},
        {"block_size", plain.text() + first_row + little_endian(0, 4) + little_endian(k_most, 4)},
        {"negative_block_size", plain.text() + first_row + little_endian(k_most + 1, 4) + little_endian(-1ull, 4)},
    };
    write(folder / "s.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0.6,0.8,0,0,1,1\n");
    const auto with = [](const std::string& file) {
        return Arguments{"render", "s.csv", "-o", "x.png", "--env", file, "--size", "2x2", "--spp", "1"};
    };
    const std::int64_t base = memory_of(folder, with("missing"));
    for (const auto& [name, header] : files) {
        SCOPED_TRACE(name);
        write(folder / name, header + zeros);
        expect_failure(1, with(name), "srbf: " + name + ": ");
        const std::int64_t taken = memory_of(folder, with(name)) - base;
        if (!k_is_sanitized) {
            EXPECT_LT(taken, std::int64_t(64) << 20);
        }
    }
    ASSERT_EQ(plain.text().size() + 8, 0x141u);
}

/// Holes of 8 GB: nothing is written, and next to nothing is read. The sanitizer alone takes nearly 100 MB.
TEST_F(Hostile, UnknownInputIsRefusedByItsBeginning) {
    for (const auto& [name, start] :
         {std::pair("zeros", std::string(64, '\0')), {"words", std::string("these are words\n")}}) {
        write(folder / name, start);
        fs::resize_file(folder / name, std::uint64_t(1) << 33);
        for (const Arguments& arguments : {Arguments{"info", name},
                                           {"fit", name},
                                           {"fit", name, "--resume", "-o", "models"},
                                           {"map", "missing", "--pairs", name, "-o", "x"},
                                           {"compare", k_paper, name},
                                           {"convert", name, "-o", "x.csv"},
                                           {"eval", k_paper, "--pairs", name},
                                           {"render", k_paper, "-o", "x.png", "--env", name},
                                           {"render", k_paper, "-o", "x.png", "--mesh", name},
                                           {"render", k_paper, "-o", "x.png", "--compare", name}})
            if (is_offered(arguments)) {
                EXPECT_LT(memory_of(folder, arguments), (k_is_sanitized ? 300 : 100) << 20)
                    << arguments[0] << " " << name;
            }
        fs::remove(folder / name);
    }
}

/// Each command does its work or says that there is too little memory, whatever the bound.
TEST_F(Hostile, NoMoreMemoryIsTakenThanAllowed) {
    if (k_is_sanitized) GTEST_SKIP() << "the sanitizer takes terabytes of addresses";
    std::mt19937_64 random(1);
    ASSERT_TRUE(save_model({random_model(random, {}), {}}, folder / "m.srbf").ok());
    write(folder / "a.binary", small_merl());
    int done = 0, failed = 0;
    for (const char* megabytes : {"64", "100"})
        for (const Arguments& arguments : {Arguments{"info", k_paper},
                                           {"convert", "m.srbf", "-o", "x.binary"},
                                           {"render", "m.srbf", "-o", "x.png", "--size", "8x8", "--spp", "1"},
                                           {"export", "m.srbf", "--to", "html", "-o", "x.html"},
                                           k_quick_fit + Arguments{"a.binary", "-o", "x.srbf"}}) {
            if (!is_offered(arguments)) continue;
            SCOPED_TRACE(fmt::format("{} MB: {}", megabytes, fmt::join(arguments, " ")));
            const ProgramRun ended = run(folder, Arguments{"--max-memory", megabytes} + arguments);
            ++(ended.status == 0 ? done : failed);
            if (ended.status == 0) continue;
            EXPECT_EQ(ended.status, 1);
            EXPECT_TRUE(ended.err.starts_with("srbf: ") && ended.err.find("out of memory") != ended.err.npos)
                << ended.err;
            EXPECT_EQ(ended.err.find('\n'), ended.err.size() - 1) << ended.err;
        }
    EXPECT_GE(done, is_offered({"render", "html"}) ? 5 : 3);
    EXPECT_GE(failed, 1);
    expect_failure(1, {"--max-memory", "500", "render", "m.srbf", "-o", "y.png", "--renderer", "raster"},
                   "no --max-memory");
    expect_failure(2, {"--max-memory", "1", "info", k_paper}, "64 to 1000000000");
}

TEST_F(Hostile, RunningOutOfMemoryNamesTheFile) {
    if (k_is_sanitized) GTEST_SKIP() << "the sanitizer takes terabytes of addresses";
    std::string pairs = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n";
    while (pairs.size() < 5000) pairs += "0,0,1,0,0,1,1\n";
    for (const auto& [name, start] : {std::pair("large.csv", pairs), {"large.srbf", model_of(2, "{}")}}) {
        write(folder / name, start);
        fs::resize_file(folder / name, std::uint64_t(1) << 33);
        rlimit before;
        ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
        const rlimit low{rlim_t(2) << 30, before.rlim_max};
        ASSERT_EQ(::setrlimit(RLIMIT_AS, &low), 0);  // the program inherits it
        const ProgramRun failed = run(folder, {"info", name});
        ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
        EXPECT_EQ(failed.status, 1);
        EXPECT_EQ(failed.err, fmt::format("srbf: {}: out of memory\n", name));
    }
}

/// A path that leads nowhere is blamed itself, wherever it stands.
TEST_F(Hostile, ErrorsNameThePathThatFails) {
    const TemporaryFolder elsewhere;
    const std::string loop = elsewhere / "loop";
    fs::create_symlink("loop", loop);
    write(folder / "file", "");
    write(folder / "p.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0,0,1\n");
    std::mt19937_64 random(1);
    ASSERT_TRUE(save_model({random_model(random, {}), {}}, folder / "m.srbf").ok());
    for (const std::string& path : {loop, loop + "/x", std::string("file/x"), std::string(300, 'x')}) {
        for (const Arguments& arguments : {Arguments{"info", path},
                                           {"fit", path},
                                           {"fit", k_paper, path, "-o", "file"},
                                           {"compare", path, "m.srbf"},
                                           {"compare", "m.srbf", path},
                                           {"convert", path, "-o", "x.csv"},
                                           {"eval", path, "--pairs", "p.csv"},
                                           {"eval", "m.srbf", "--pairs", path},
                                           {"render", path, "-o", "x.png"},
                                           {"render", "m.srbf", "-o", "x.png", "--env", path},
                                           {"render", "m.srbf", "-o", "x.png", "--mesh", path},
                                           {"render", "m.srbf", "-o", "x.png", "--compare", path},
                                           {"export", path, "--to", "c", "-o", "x.h"},
                                           {"export", "m.srbf", "--to", "html", "-o", "x.html", "--reference", path},
                                           {"export", "m.srbf", "--to", "html", "-o", "x.html", "--mesh", path}}) {
            const bool into_file = arguments.back() == "file";
            expect_failure(1, arguments, into_file ? "file" : path);
        }
        expect_failure(1, {"convert", "m.srbf", "-o", path + "/x.csv"}, path);
        expect_failure(1, {"compare", "m.srbf", "m.srbf", "--json", path + "/x.json"}, path);
    }
}

TEST_F(Hostile, CompareNamesBothFilesThatShareNothing) {
    const auto one_sided = [](Part part) {
        BsdfModel bsdf;
        bsdf.part[std::size_t(part)] = random_part(1, {.lobes = 1});
        return Model{bsdf, {}};
    };
    ASSERT_TRUE(save_model(one_sided(Part::transmission_front), folder / "a.srbf").ok());
    std::mt19937_64 random(1);
    ASSERT_TRUE(save_model({random_model(random, {}), {}}, folder / "b.srbf").ok());
    expect_failure(1, {"compare", "a.srbf", "b.srbf"}, "a.srbf and b.srbf: parts: expected one that both have");
    expect_failure(1, {"compare", "b.srbf", "a.srbf", "--json", "-"}, "b.srbf and a.srbf: parts");
}

TEST_F(Hostile, NoControlCharactersReachTheTerminal) {
    const std::string evil =
        "a\x1b]0;title\x07\x1b[2J\r\n\t\x7f\xc2\x9b"
        "31mb";
    std::mt19937_64 random(1);
    ASSERT_TRUE(save_model({random_model(random, {}), {{"source", evil}, {evil, "x"}}}, folder / "m.srbf").ok());
    write(folder / "s.brdf", "# " +
                                 std::string("a\x1b[2J\x07"
                                             "b\n") +
                                 "# num wls\n1\n550\n0.1 0 0.1 0 0.5\n");
    write(folder / "s.csv", "theta_l_deg,theta_v_deg,phi_v_deg,value,\x1b[2J\n1,1,1,1,1\n");
    for (const Arguments& arguments : {Arguments{"info", "m.srbf"},
                                       {"info", "s.brdf"},
                                       {"info", "s.csv"},
                                       {"fit", "s.csv", "--model", "ggx"},
                                       {"compare", "m.srbf", "m.srbf"}}) {
        const ProgramRun shown = run(folder, arguments);
        EXPECT_TRUE(shown.status == 0 || shown.status == 1);
        for (const char c : shown.out + shown.err)
            EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20) << fmt::format("{:02x}", int(c));
        EXPECT_EQ((shown.out + shown.err).find("\xc2\x9b"), std::string::npos);
    }
    EXPECT_NE(run(folder, {"info", "m.srbf"}).out.find("source                              a?]0;title??[2J   ??31mb"),
              std::string::npos)
        << run(folder, {"info", "m.srbf"}).out;
}

/// Names of files of what ends strings, comments, elements and lines somewhere.
const std::string k_names[] = {
    "a\nb\r\"\"\"\nimport os; os._exit(1) #\x1b[2J\x07\x7f\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\xef\xbb\xbf\"];'); \\\" ?\?",
    "a\xe2\x80\xa8"
    "fn b() -> f32 { return 1.0; }\xe2\x80\xa9int b;\xc2\x85\x0b\x0c \xff\xc0\x80\xed\xa0\x80\xef\xbf\xbf <b>&amp;'--> "
    "]]>{{title}}`${b}`|*_[c](d) \\",
};
/// Texts of metadata, which are UTF-8, unlike a name, and have slashes.
const std::string k_texts[] = {"\"\"\"\nimport os; os._exit(1) #",
                               "\x1b[2J\x07\x7f\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\xef\xbb\xbf\xef\xbf\xbf",
                               "\xe2\x80\xa8"
                               "fn b() -> f32 { return 1.0; }\xe2\x80\xa9int b;\xc2\x85\x0b\x0c",
                               "=1\"];'); \\\" \\",
                               "*/\nint b; // ?\?/\nint c; /* \\",
                               "<b>&amp;'-->]]></script><script>alert(1)</script>{{title}}`${b}`"};
constexpr std::size_t k_fields = std::size(k_texts);

/// Metadata of those texts, or of `harmless` ones; `first`: that of the first field.
std::map<std::string, std::string> metadata(std::size_t first, bool harmless) {
    constexpr std::array<const char*, k_fields> fields{"source",      "surface",   "objective",
                                                       "delta_e_itp", "max_theta", "xx"};
    std::map<std::string, std::string> all;
    for (std::size_t i = 0; i < k_fields; ++i) {
        const std::string text = harmless ? "b" : k_texts[(first + i) % k_fields];
        all[fields[i]] = text, all[harmless ? fmt::format("x{}", i) : text] = text;
    }
    return all;
}

/// The destinations that the program names.
Arguments destinations(const TemporaryFolder& folder) {
    const std::string said = run(folder, {"export", "x", "--to", "nothing", "-o", "x"}).err;
    const auto begin = said.find("expected ") + 9;
    std::string list = said.substr(begin, said.find(", found") - begin);
    Arguments all;
    for (std::size_t at; (at = list.find(" or ")) != list.npos; list.erase(0, at + 4))
        all.push_back(list.substr(0, at));
    all.push_back(list);
    return all;
}

/// Exported text without comments, documentation and notes.
std::string code_alone(std::string text, const std::string& to) {
    const auto remove = [&](std::string_view first, std::string_view last) {
        for (std::size_t at; (at = text.find(first)) != text.npos;)
            text.erase(at, text.find(last, at + first.size()) + last.size() - at);
    };
    if (to == "mtlx" || to == "standard-surface") remove("<!--", "-->");
    if (to == "usd") remove("doc = \"\"\"", "\"\"\"");
    std::istringstream lines(text);
    std::string code;
    for (std::string line; std::getline(lines, line);) {
        const std::string_view begin = trimmed(line);
        if (!begin.starts_with("//") && !(to == "blender" && begin.starts_with("#"))) code += line + "\n";
    }
    return code;
}

/// Names and metadata stay text: exports are those of harmless names but for comments.
TEST_F(Hostile, WhatFilesSayIsNoCode) {
    std::mt19937_64 random(1);
    const PmModel pm = random_model(random, {.lobes = 1, .variates = 1});
    const Library map = random_map(random, {.lobes = 2}, 3, 2);
    const Arguments surfaces{"mtlx", "standard-surface", "gltf", "glb", "usd", "blender"}, all = destinations(folder);
    ASSERT_GE(all.size(), 12u);
    fs::create_directory(folder / "clean");
    std::set<std::string> tried;
    for (std::size_t i = 0; i < k_fields; i += 2) {
        const std::string& name = k_names[i / 2 % std::size(k_names)];
        for (const std::string& to : all) {
            const bool is_map = to == "ktx2" || to == "exr", is_surface = std::ranges::count(surfaces, to) > 0,
                       takes_long = to == "html" || to == "three";
            if (to == "dds" || (takes_long && i > 0)) continue;
            SCOPED_TRACE(fmt::format("{} {}: {}", to, i, printable(name)));
            const auto exported = [&](const std::string& file, bool harmless) {
                Library own = map;
                own.provenance = metadata(i, harmless);
                const Model model = is_surface ? Model{OpenPbrModel{}, own.provenance} : Model{pm, own.provenance};
                write(folder / file, text_of(is_map ? write_library(own) : write_model(model)));
                const ProgramRun done = run(folder, {"export", file, "--to", to, "-o", "x"});
                EXPECT_EQ(done.status, 0) << done.err;
                EXPECT_EQ(printable_lines(done.out + done.err), done.out + done.err);
                return contents(folder / "x");
            };
            std::string x = exported(name + ".srbf", false), y = exported("clean/" + identifier(name) + ".srbf", true);
            tried.insert(to);
            if (is_map || to == "glb") continue;
            EXPECT_EQ(printable_lines(x), x);
            if (to == "c") {
                EXPECT_EQ(x.find("?\?/"), x.npos);
            }
            if (to == "gltf")
                for (std::string* text : {&x, &y}) {
                    Json json = Json::parse(*text, nullptr, false);
                    ASSERT_TRUE(json.is_object());
                    json["asset"].erase("extras");
                    *text = json.dump();
                }
            if (to == "html")
                for (const char c : {'<', '>', '"', '\''})
                    EXPECT_EQ(std::ranges::count(x, c), std::ranges::count(y, c)) << c;
            else
                EXPECT_EQ(code_alone(x, to), code_alone(y, to));
        }
    }
    EXPECT_EQ(tried.size(), all.size() - std::size_t(std::ranges::count(all, "dds")));
}

/// The names that lines at the left margin define.
std::vector<std::string> defined_names(const std::string& text) {
    std::istringstream lines(text);
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || !std::isalpha(static_cast<unsigned char>(line[0]))) continue;
        std::string head = line.substr(0, line.find_first_of("([={:"));
        if (const auto at = head.find(" extends"); at != head.npos) head.resize(at);
        head.erase(head.find_last_not_of(' ') + 1);
        const std::string name = head.substr(head.find_last_of(" $") + 1);
        if (name != "if" && name != "import" && name != "typedef struct" && name != "struct" && !name.empty())
            names.push_back(name);
    }
    return names;
}

/// Two files whose names would be one in the code: it tells them apart, or an error names both.
TEST_F(Hostile, NamesInCodeAreDistinct) {
    std::mt19937_64 random(1);
    const Model pm{random_model(random, {.lobes = 1, .variates = 1}), {}}, two{full_bsdf(), {}};
    using Named = std::pair<std::string, const Model*>;
    const std::pair<Named, Named> pairs[] = {{{"a_b", &pm}, {"aB", &pm}},
                                             {{"x", &pm}, {"x_r", &pm}},
                                             {{"x", &pm}, {"x_light", &pm}},
                                             {{"y", &two}, {"y_mirror", &two}},
                                             {{"y", &two}, {"y_reflection_back", &pm}},
                                             {{"y_reflection_back", &pm}, {"y", &two}}};
    std::map<std::string, int> done;
    for (const std::string& to : destinations(folder)) {
        if (to == "html" || to == "dds") continue;
        for (const auto& [a, b] : pairs) {
            if (to == "three" && &a != &pairs[0].first) continue;
            SCOPED_TRACE(fmt::format("{}: {} and {}", to, a.first, b.first));
            for (const auto& [name, model] : {a, b}) ASSERT_TRUE(save_model(*model, folder / (name + ".srbf")).ok());
            const ProgramRun ended =
                run(folder, {"export", a.first + ".srbf", b.first + ".srbf", "--to", to, "-o", "o"});
            if (ended.status == 0) {
                ++done[to];
                std::vector<std::string> names = defined_names(contents(folder / "o"));
                EXPECT_GE(names.size(), 2u);
                // A module has names of JavaScript and, in a text, of GLSL.
                if (to == "three") std::erase_if(names, [](const auto& name) { return !name.ends_with("Material"); });
                std::ranges::sort(names);
                const auto twice = std::ranges::adjacent_find(names);
                EXPECT_EQ(twice, names.end()) << *twice;
                continue;
            }
            EXPECT_EQ(ended.status, 1);
            EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
            if (ended.err.find("names in their code") != ended.err.npos) {
                EXPECT_NE(ended.err.find(a.first + " and " + b.first), ended.err.npos) << ended.err;
            }
        }
    }
    EXPECT_GE(done.size(), 7u);
    for (const auto& [to, count] : done) EXPECT_GE(count, to == "three" ? 1 : 4) << to;
}

/// Names of files reach the terminal, and JSON there, in one line each.
TEST_F(Hostile, NamesOfFilesAreOneLine) {
    std::mt19937_64 random(1);
    const Model model{random_model(random, {.lobes = 1, .variates = 1}), {}};
    fs::create_directory(folder / "b");
    const auto runs = [&](const std::string& name) {
        EXPECT_TRUE(save_model(model, folder / (name + ".srbf")).ok());
        write(folder / (name + ".binary"), small_merl());
        std::vector<ProgramRun> all;
        for (const Arguments& arguments :
             {Arguments{"info", name + ".srbf"},
              {"compare", name + ".srbf", name + ".srbf"},
              {"compare", name + ".srbf", name + ".srbf", "--json", "-"},
              k_quick_fit + Arguments{name + ".binary", "-o", name + ".o", "--json", name + ".json"},
              k_quick_fit + Arguments{name + ".binary", "b.binary", "-o", name + "-models"},
              {"render", name + ".srbf", "-o", name + ".png", "--size", "8x8", "--spp", "1", "--compare",
               name + ".binary"},
              {"eval", name + ".srbf", "--pairs", name},
              {"convert", name, "-o", name + ".csv"},
              {"export", name + ".srbf", "--to", name, "-o", name},
              {"info", "--" + name},
              {name}})
            if (is_offered(arguments)) all.push_back(run(folder, arguments));
        return all;
    };
    write(folder / "b.binary", small_merl());
    const auto harmless = runs("a");
    for (const std::string& name : k_names) {
        const auto done = runs(name);
        for (std::size_t i = 0; i < done.size(); ++i) {
            SCOPED_TRACE(fmt::format("{}: {}", i, printable(name)));
            const std::string said = done[i].out + done[i].err;
            EXPECT_EQ(done[i].status, harmless[i].status) << said;
            EXPECT_EQ(printable_lines(said), said);
            EXPECT_EQ(std::ranges::count(said, '\n'), std::ranges::count(harmless[i].out + harmless[i].err, '\n'))
                << said;
        }
        const Json report = Json::parse(done[2].out, nullptr, false);
        ASSERT_TRUE(report.is_object()) << done[2].out;
        if (name.find('\xff') == name.npos) {
            EXPECT_EQ(report["reference"], name + ".srbf");
        }
    }
}

TEST_F(Hostile, TextIsQuotedForItsDestination) {
    EXPECT_EQ(csv_field("=1+1"), "'=1+1");
    EXPECT_EQ(csv_field("@a,\"b\""), "\"'@a,\"\"b\"\"\"");
    EXPECT_EQ(csv_field("plain-2"), "plain-2");
    EXPECT_EQ(in_string("a\"\\\n"), "a\\\"\\\\ ");
    EXPECT_EQ(in_comment("a\\ ?\?/ ?\?\?/ \\"), "a/ ?/ ?/ /");
    EXPECT_EQ(in_xml_comment("a--><b>"), "a__&gt;&lt;b&gt;");
    EXPECT_EQ(in_markdown("a|b `c` [d](e) <f>"), "a\\|b \\`c\\` \\[d\\](e) &lt;f&gt;");
    EXPECT_EQ(in_template_literal("`${a}`\n"), "\\`\\${a}\\`\n");
    EXPECT_EQ(printable_json("\"\xe2\x80\xae\xf3\xa0\x80\x81\""), "\"\\u202e\\udb40\\udc01\"");
    EXPECT_EQ(json_in_script("\"</script>\""), "\"\\u003c/script>\"");
    EXPECT_EQ(printable("é θ 𝛑 \xe2\x80\x8d"), "é θ 𝛑 \xe2\x80\x8d");
    for (const char* overlong :
         {"\xc0\x80", "\xe0\x80\x80", "\xf0\x80\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\x80", "\xc3"})
        EXPECT_EQ(printable(overlong), std::string(std::string_view(overlong).size(), '?'));
}

}  // namespace
}  // namespace srbf::hostile_test
