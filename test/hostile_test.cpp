// Malicious files: memory stays bounded, the error names its file, and no control characters reach the terminal.
#include <sys/resource.h>
#include <sys/wait.h>

#include "base/printable.h"
#include "base/text.h"
#include "command.h"
#include "exports.h"
#include "models.h"
#include "srbf/shading_code.h"

namespace srbf::hostile_test {
namespace {

namespace fs = std::filesystem;

/// Writes `part` `count` times between `first` and `last`, without holding it in memory: a child process starts with
/// the memory size of this program.
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

/// A model file that declares `length` bytes of header and contains `header`.
std::string model_with_header(std::size_t length, const std::string& header) {
    return little_endian(length, 8) + header;
}

/// The peak memory of a run of the program [bytes].
std::int64_t peak_memory(const TemporaryFolder& folder, const Arguments& arguments) {
    const TemporaryFolder captured;
    const pid_t process = start_srbf(folder, arguments, captured / "out", captured / "err");
    int status = 0;
    rusage usage{};
    EXPECT_EQ(::wait4(process, &status, 0, &usage), process);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) <= 1);
    const std::string err = read_text(captured / "err");
    EXPECT_LE(std::ranges::count(err, '\n'), 1) << err;
    return std::int64_t(usage.ru_maxrss) * 1024;
}

class Hostile : public ProgramTest {
  protected:
    void save(const Model& model, const std::string& name) {
        ASSERT_TRUE(save_model(model, folder / (name + ".srbf")).ok());
    }
};

Model small_model() {
    std::mt19937_64 random(1);
    return {random_model(random, {.lobes = 1, .variates = 1}), {}};
}

/// Many parts of a few bytes, each of which a library or a reader might store as an object.
TEST_F(Hostile, SmallPartsStayWithinTheMemoryLimit) {
    constexpr std::size_t size = k_is_sanitized ? 1'000'000 : 8'000'000;
    struct File {
        std::string name, first, part, last;
    };
    const std::string columns = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n", xml = "<?xml?><WindowElement";
    const std::vector<File> files{
        {"deep.srbf", model_with_header(size, ""), "{\"a\":", ""},
        {"deep_short.srbf", model_with_header(1 << 20, ""), "{\"a\":", ""},
        {"lists.srbf", model_with_header(1 << 20, "{\"a\":"), "[", ""},
        {"numbers.srbf", model_with_header(1 << 20, "{\"a\":{\"shape\":["), "1,", ""},
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
    const std::int64_t base = peak_memory(folder, {"info", "missing"});
    EXPECT_LT(base, 64 << 20 << k_is_sanitized);
    const auto check = [&](const std::string& name) {
        SCOPED_TRACE(name);
        const auto limit = 4 * std::int64_t(fs::file_size(folder / name)) + (std::int64_t(36) << 20);
        const std::int64_t used = peak_memory(folder, {"info", name}) - base;
        if (!k_is_sanitized) {
            EXPECT_LT(used, limit);
        }
        fs::remove(folder / name);
    };
    for (const File& file : files) {
        write_many(folder / file.name, file.first, file.part, size / file.part.size(), file.last);
        check(file.name);
    }
    std::ofstream fields(folder / "fields.bsdf", std::ios::binary);
    fields << "tensor_file" << std::string("\0\1\0", 3) << little_endian(size / 20, 4);
    for (std::uint64_t i = 0; i < size / 20; ++i)  // name, rank 0, type u8, offset 0
        fields << little_endian(5, 2) << fmt::format("{:05x}", i) << little_endian(0, 2) << '\1' << little_endian(0, 8);
    fields.close();
    check("fields.bsdf");
}

/// An OpenEXR header for three float channels. Tests change parts of it.
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

/// Sizes, counts, types and offsets that are impossible for a file of that length.
TEST_F(Hostile, HeadersOfOpenExrAreBounded) {
    if (!is_built({"render"})) GTEST_SKIP() << "without srbf render";
    constexpr std::uint32_t k_max = 0x7fffffff, k_tiled = 0x200;
    const auto tiles = [](std::uint32_t side, char mode) {
        return ExrHeader::attribute("tiles", "tiledesc", little_endian(side, 4) + little_endian(side, 4) + mode);
    };
    const auto truncated_attribute = [](const std::string& name, std::uint64_t size) {
        return name + '\0' + "string" + '\0' + little_endian(size, 4);
    };
    const std::string first_row = little_endian(0x141, 8), zeros(400, '\0');
    const ExrHeader plain;
    const std::map<std::string, std::string> files{
        {"window", ExrHeader{.window = {0, 0, k_max - 1, k_max - 1}}.text()},
        {"overflowing_window", ExrHeader{.window = {k_max + 1, k_max + 1, k_max, k_max}}.text()},
        {"reversed_window", ExrHeader{.window = {5, 5, 1, 1}}.text()},
        {"wide_window", ExrHeader{.window = {0, 0, (1 << 26) - 1, 0}}.text()},
        {"tall_window", ExrHeader{.window = {0, 0, 0, (1 << 26) - 1}}.text()},
        {"more_pixels_than_bytes", ExrHeader{.window = {0, 0, 8191, 8191}}.text() + std::string(40000, '\0')},
        {"large_blocks", ExrHeader{.compression = "\x09", .window = {0, 0, (1 << 18) - 1, 255}}.text()},
        {"huge_tiles", ExrHeader{.tiles = tiles(k_max, 0)}.text(k_tiled)},
        {"no_tiles", ExrHeader{.tiles = tiles(0, 0)}.text(k_tiled)},
        {"many_tiles", ExrHeader{.tiles = tiles(1, 0), .window = {0, 0, 8191, 8191}}.text(k_tiled)},
        {"tiles_of_all_sizes", ExrHeader{.tiles = tiles(1, 2), .window = {0, 0, 8191, 1}}.text(k_tiled)},
        {"long_attribute", ExrHeader{.more = truncated_attribute("x", k_max)}.text()},
        {"negative_attribute", ExrHeader{.more = truncated_attribute("x", 0xfffffffb)}.text()},
        {"pixel_type", ExrHeader{.pixel_type = little_endian(77, 4)}.text()},
        {"sampling", ExrHeader{.sampling = little_endian(0xffffffff, 4)}.text()},
        {"no_sampling", ExrHeader{.sampling = little_endian(0, 4)}.text()},
        {"compression", ExrHeader{.compression = "\xc8"}.text()},
        {"deep", plain.text(0x800)},
        {"parts", plain.text(0x1000)},
        {"offset_beyond", plain.text() + little_endian(std::uint64_t(1) << 63, 8)},
        {"offset_of_the_header", plain.text() + little_endian(8, 8)},
        {"block_size", plain.text() + first_row + little_endian(0, 4) + little_endian(k_max, 4)},
        {"negative_block_size", plain.text() + first_row + little_endian(k_max + 1, 4) + little_endian(-1ull, 4)},
    };
    write_text(folder / "s.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0.6,0.8,0,0,1,1\n");
    const auto render = [](const std::string& file) {
        return Arguments{"render", "s.csv", "-o", "x.png", "--env", file, "--size", "2x2", "--spp", "1"};
    };
    const std::int64_t base = peak_memory(folder, render("missing"));
    for (const auto& [name, header] : files) {
        SCOPED_TRACE(name);
        write_text(folder / name, header + zeros);
        expect_failure(1, render(name), "srbf: " + name + ": ");
        const std::int64_t used = peak_memory(folder, render(name)) - base;
        if (!k_is_sanitized) {
            EXPECT_LT(used, std::int64_t(64) << 20);
        }
    }
    ASSERT_EQ(plain.text().size() + 8, 0x141u);
}

/// Sparse files of 8 GB, of which only the beginning is read. The sanitizer alone uses nearly 100 MB.
TEST_F(Hostile, UnknownInputIsRejectedAfterItsBeginning) {
    for (const auto& [name, start] :
         {std::pair("zeros", std::string(64, '\0')), {"words", std::string("these are words\n")}}) {
        write_text(folder / name, start);
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
            if (is_built(arguments)) {
                EXPECT_LT(peak_memory(folder, arguments), (k_is_sanitized ? 300 : 100) << 20)
                    << arguments[0] << " " << name;
            }
        fs::remove(folder / name);
    }
}

/// With any memory limit, each command succeeds or reports that memory is exhausted.
TEST_F(Hostile, MemoryStaysWithinTheLimit) {
    SKIP_UNDER_SANITIZERS("the sanitizer takes terabytes of addresses");
    save(small_model(), "m");
    write_text(folder / "a.binary", small_merl());
    int succeeded = 0, failed = 0;
    for (const char* megabytes : {"64", "100"})
        for (const Arguments& arguments : {Arguments{"info", k_paper},
                                           {"convert", "m.srbf", "-o", "x.binary"},
                                           {"render", "m.srbf", "-o", "x.png", "--size", "8x8", "--spp", "1"},
                                           {"export", "m.srbf", "--to", "html", "-o", "x.html"},
                                           k_quick_fit + Arguments{"a.binary", "-o", "x.srbf"}}) {
            if (!is_built(arguments)) continue;
            SCOPED_TRACE(fmt::format("{} MB: {}", megabytes, fmt::join(arguments, " ")));
            const ProgramRun result = run_srbf(folder, Arguments{"--max-memory", megabytes} + arguments);
            ++(result.status == 0 ? succeeded : failed);
            if (result.status == 0) continue;
            EXPECT_EQ(result.status, 1);
            EXPECT_ONE_LINE(result.err, "srbf: ");
            EXPECT_CONTAINS(result.err, "out of memory");
        }
    EXPECT_GE(succeeded, is_built({"render", "html"}) ? 5 : 3);
    EXPECT_GE(failed, 1);
    expect_failure(1, {"--max-memory", "500", "render", "m.srbf", "-o", "y.png", "--renderer", "raster"},
                   "no --max-memory");
    expect_failure(2, {"--max-memory", "1", "info", k_paper}, "64 to 1000000000");
}

TEST_F(Hostile, RunningOutOfMemoryNamesTheFile) {
    SKIP_UNDER_SANITIZERS("the sanitizer takes terabytes of addresses");
    std::string pairs = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n";
    while (pairs.size() < 5000) pairs += "0,0,1,0,0,1,1\n";
    for (const auto& [name, start] : {std::pair("large.csv", pairs), {"large.srbf", model_with_header(2, "{}")}}) {
        write_text(folder / name, start);
        fs::resize_file(folder / name, std::uint64_t(1) << 33);
        rlimit previous;
        ASSERT_EQ(::getrlimit(RLIMIT_AS, &previous), 0);
        const rlimit low{rlim_t(2) << 30, previous.rlim_max};
        ASSERT_EQ(::setrlimit(RLIMIT_AS, &low), 0);  // the program inherits it
        const ProgramRun failed = run_srbf(folder, {"info", name});
        ASSERT_EQ(::setrlimit(RLIMIT_AS, &previous), 0);
        EXPECT_EQ(failed.status, 1);
        EXPECT_EQ(failed.err, fmt::format("srbf: {}: out of memory\n", name));
    }
}

/// The error names the path that cannot be opened, wherever it is used.
TEST_F(Hostile, ErrorsNameTheFailingPath) {
    const TemporaryFolder elsewhere;
    const std::string loop = elsewhere / "loop";
    fs::create_symlink("loop", loop);
    write_text(folder / "file", "");
    write_text(folder / "pairs.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0,0,1\n");
    save(small_model(), "m");
    for (const std::string& path : {loop, loop + "/x", std::string("file/x"), std::string(300, 'x')}) {
        for (const Arguments& arguments : {Arguments{"info", path},
                                           {"fit", path},
                                           {"fit", k_paper, path, "-o", "file"},
                                           {"compare", path, "m.srbf"},
                                           {"compare", "m.srbf", path},
                                           {"convert", path, "-o", "x.csv"},
                                           {"eval", path, "--pairs", "pairs.csv"},
                                           {"eval", "m.srbf", "--pairs", path},
                                           {"render", path, "-o", "x.png"},
                                           {"render", "m.srbf", "-o", "x.png", "--env", path},
                                           {"render", "m.srbf", "-o", "x.png", "--mesh", path},
                                           {"render", "m.srbf", "-o", "x.png", "--compare", path},
                                           {"export", path, "--to", "c", "-o", "x.h"},
                                           {"export", "m.srbf", "--to", "html", "-o", "x.html", "--reference", path},
                                           {"export", "m.srbf", "--to", "html", "-o", "x.html", "--mesh", path}}) {
            const bool writes_into_file = arguments.back() == "file";
            expect_failure(1, arguments, writes_into_file ? "file" : path);
        }
        expect_failure(1, {"convert", "m.srbf", "-o", path + "/x.csv"}, path);
        expect_failure(1, {"compare", "m.srbf", "m.srbf", "--json", path + "/x.json"}, path);
    }
}

TEST_F(Hostile, CompareNamesBothFilesWithoutCommonParts) {
    BsdfModel bsdf;
    bsdf.part[std::size_t(Part::transmission_front)] = random_part(1, {.lobes = 1});
    save({bsdf, {}}, "a");
    save(small_model(), "b");
    expect_failure(1, {"compare", "a.srbf", "b.srbf"}, "a.srbf and b.srbf: parts: expected one that both have");
    expect_failure(1, {"compare", "b.srbf", "a.srbf", "--json", "-"}, "b.srbf and a.srbf: parts");
}

TEST_F(Hostile, NoControlCharactersReachTheTerminal) {
    SKIP_UNDER_SANITIZERS("too many runs");
    const std::string escapes =
        "a\x1b]0;title\x07\x1b[2J\r\n\t\x7f\xc2\x9b"
        "31mb";
    Model model = small_model();
    model.provenance = {{"source", escapes}, {escapes, "x"}};
    save(model, "m");
    write_text(folder / "s.brdf", "# " +
                                      std::string("a\x1b[2J\x07"
                                                  "b\n") +
                                      "# num wls\n1\n550\n0.1 0 0.1 0 0.5\n");
    write_text(folder / "s.csv", "theta_l_deg,theta_v_deg,phi_v_deg,value,\x1b[2J\n1,1,1,1,1\n");
    for (const Arguments& arguments : {Arguments{"info", "m.srbf"},
                                       {"info", "s.brdf"},
                                       {"info", "s.csv"},
                                       {"fit", "s.csv", "--model", "ggx"},
                                       {"compare", "m.srbf", "m.srbf"}}) {
        const ProgramRun result = run_srbf(folder, arguments);
        EXPECT_TRUE(result.status == 0 || result.status == 1);
        for (const char c : result.out + result.err)
            EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20) << fmt::format("{:02x}", int(c));
        EXPECT_LACKS((result.out + result.err), "\xc2\x9b");
    }
    EXPECT_CONTAINS(run_srbf(folder, {"info", "m.srbf"}).out,
                    "source                              a?]0;title??[2J   ??31mb");
}

/// File names with characters that end strings, comments, elements or lines in some language.
const std::string k_names[] = {
    "a\nb\r\"\"\"\nimport os; os._exit(1) #\x1b[2J\x07\x7f\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\xef\xbb\xbf\"];'); \\\" ?\?",
    "a\xe2\x80\xa8"
    "fn b() -> f32 { return 1.0; }\xe2\x80\xa9int b;\xc2\x85\x0b\x0c \xff\xc0\x80\xed\xa0\x80\xef\xbf\xbf <b>&amp;'--> "
    "]]>{{title}}`${b}`|*_[c](d) \\",
};
/// Metadata. Unlike file names it is UTF-8 and may contain slashes.
const std::string k_texts[] = {"\"\"\"\nimport os; os._exit(1) #",
                               "\x1b[2J\x07\x7f\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\xef\xbb\xbf\xef\xbf\xbf",
                               "\xe2\x80\xa8"
                               "fn b() -> f32 { return 1.0; }\xe2\x80\xa9int b;\xc2\x85\x0b\x0c",
                               "=1\"];'); \\\" \\",
                               "*/\nint b; // ?\?/\nint c; /* \\",
                               "<b>&amp;'-->]]></script><script>alert(1)</script>{{title}}`${b}`"};
constexpr std::size_t k_fields = std::size(k_texts);

/// Metadata with hostile or harmless texts. Field 0 has text `first`.
std::map<std::string, std::string> metadata(std::size_t first, bool harmless) {
    constexpr std::array<const char*, k_fields> fields{"source",      "surface",   "objective",
                                                       "delta_e_itp", "max_theta", "xx"};
    std::map<std::string, std::string> entries;
    for (std::size_t i = 0; i < k_fields; ++i) {
        const std::string text = harmless ? "b" : k_texts[(first + i) % k_fields];
        entries[fields[i]] = text;
        entries[harmless ? fmt::format("x{}", i) : text] = text;
    }
    return entries;
}

/// Exported text without comments, documentation and notes, as XML, USD, Python and languages like C write them.
std::string code_without_comments(std::string text) {
    const auto remove = [&](std::string_view first, std::string_view last) {
        for (std::size_t position; (position = text.find(first)) != text.npos;)
            text.erase(position, text.find(last, position + first.size()) + last.size() - position);
    };
    remove("<!--", "-->");
    remove("doc = \"\"\"", "\"\"\"");
    std::istringstream lines(text);
    std::string code;
    for (std::string line; std::getline(lines, line);) {
        const std::string_view begin = trimmed(line);
        if (!begin.starts_with("//") && !begin.starts_with("# ") && begin != "#") code += line + "\n";
    }
    return code;
}

/// Names and metadata remain text: except for comments, the export is the same as with harmless names.
TEST_F(Hostile, NamesAndMetadataAreNotCode) {
    std::mt19937_64 random(1);
    const PmModel pm = random_model(random, {.lobes = 1, .variates = 1});
    const TexelMap map = random_map(random, {.lobes = 2}, 3, 2);
    Arguments kinds = export_kinds();
    std::erase_if(kinds, is_of_environments);
    ASSERT_GE(kinds.size(), 12u);
    fs::create_directory(folder / "clean");
    std::set<std::string> tried;
    for (std::size_t i = 0; i < k_fields; i += 2) {
        const std::string& name = k_names[i / 2 % std::size(k_names)];
        for (const std::string& to : kinds) {
            if (is_slow_export(to) && i > 0) continue;
            SCOPED_TRACE(fmt::format("{} {}: {}", to, i, printable(name)));
            const auto exported = [&](const std::string& file, bool harmless) {
                TexelMap named_map = map;
                named_map.provenance = metadata(i, harmless);
                const Model model =
                    is_of_surfaces(to) ? Model{OpenPbrModel{}, named_map.provenance} : Model{pm, named_map.provenance};
                write_text(folder / file, as_text(is_of_maps(to) ? write_map(named_map) : write_model(model)));
                const ProgramRun result =
                    run_ok(folder, Arguments{"export", file, "--to", to, "-o", "x"} + quick_options(to));
                EXPECT_EQ(printable_lines(result.out + result.err), result.out + result.err);
                return read_text(folder / "x");
            };
            std::string x = exported(name + ".srbf", false), y = exported("clean/" + identifier(name) + ".srbf", true);
            tried.insert(to);
            if (is_of_maps(to) || to == "glb") continue;  // not texts
            EXPECT_EQ(printable_lines(x), x);
            if (to == "c") {
                EXPECT_LACKS(x, "?\?/");
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
                EXPECT_EQ(code_without_comments(x), code_without_comments(y));
        }
    }
    EXPECT_EQ(tried.size(), kinds.size());
}

/// The names defined on unindented lines.
std::vector<std::string> defined_names(const std::string& text) {
    std::istringstream lines(text);
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || !std::isalpha(static_cast<unsigned char>(line[0]))) continue;
        std::string head = line.substr(0, line.find_first_of("([={:"));
        if (const auto position = head.find(" extends"); position != head.npos) head.resize(position);
        head.erase(head.find_last_not_of(' ') + 1);
        const std::string name = head.substr(head.find_last_of(" $") + 1);
        if (name != "if" && name != "import" && name != "typedef struct" && name != "struct" && !name.empty())
            names.push_back(name);
    }
    return names;
}

/// Two files whose names could collide in code: the code distinguishes them, or an error names both.
TEST_F(Hostile, NamesInCodeAreDistinct) {
    const Model model = small_model(), bsdf{lobe_bsdf_with_beams(), {}};
    using Named = std::pair<std::string, const Model*>;
    const std::pair<Named, Named> pairs[] = {{{"a_b", &model}, {"aB", &model}},
                                             {{"x", &model}, {"x_r", &model}},
                                             {{"x", &model}, {"x_light", &model}},
                                             {{"y", &bsdf}, {"y_mirror", &bsdf}},
                                             {{"y", &bsdf}, {"y_reflection_back", &model}},
                                             {{"y_reflection_back", &model}, {"y", &bsdf}}};
    std::map<std::string, int> succeeded;
    for (const std::string& to : export_kinds()) {
        const bool is_module = to.starts_with("three");
        if (is_of_environments(to) || (is_slow_export(to) && !is_module)) continue;  // one model, or names in strings
        for (const auto& [a, b] : pairs) {
            if (is_module && &a != &pairs[0].first) continue;
            SCOPED_TRACE(fmt::format("{}: {} and {}", to, a.first, b.first));
            for (const auto& [name, named_model] : {a, b}) save(*named_model, name);
            const ProgramRun result =
                run_srbf(folder, {"export", a.first + ".srbf", b.first + ".srbf", "--to", to, "-o", "o"});
            if (result.status == 0) {
                ++succeeded[to];
                std::vector<std::string> names = defined_names(read_text(folder / "o"));
                EXPECT_GE(names.size(), 2u);
                // A module contains names of JavaScript and, within a string, of GLSL.
                if (is_module) std::erase_if(names, [](const auto& name) { return !name.ends_with("Material"); });
                if (to == "c")  // variants of what all files share, for different processors
                    std::erase_if(
                        names, [](const auto& name) { return name.starts_with("srbf_") || name == "__attribute__"; });
                std::ranges::sort(names);
                const auto duplicate = std::ranges::adjacent_find(names);
                EXPECT_EQ(duplicate, names.end()) << *duplicate;
                continue;
            }
            EXPECT_EQ(result.status, 1);
            EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
            if (result.err.find("names in their code") != result.err.npos) {
                EXPECT_CONTAINS(result.err, a.first + " and " + b.first);
            }
        }
    }
    EXPECT_GE(succeeded.size(), 5u);  // with all extras 7
    for (const auto& [to, count] : succeeded) EXPECT_GE(count, to.starts_with("three") ? 1 : 4) << to;
    save(model, "srbf_view");
    const ProgramRun shared =
        run_srbf(folder, {"export", "srbf_view.srbf", "--to", "c", "--with", "sampling", "-o", "o"});
    EXPECT_EQ(shared.status, 1);
    EXPECT_CONTAINS(shared.err, "srbf_view and the functions of srbf");
}

/// File names are printed in a single line, also in JSON on the terminal.
TEST_F(Hostile, NamesOfFilesAreOneLine) {
    fs::create_directory(folder / "b");
    const auto runs = [&](const std::string& name) {
        save(small_model(), name);
        write_text(folder / (name + ".binary"), small_merl());
        std::vector<ProgramRun> results;
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
            if (is_built(arguments)) results.push_back(run_srbf(folder, arguments));
        return results;
    };
    write_text(folder / "b.binary", small_merl());
    const auto harmless = runs("a");
    for (const std::string& name : k_names) {
        const auto results = runs(name);
        for (std::size_t i = 0; i < results.size(); ++i) {
            SCOPED_TRACE(fmt::format("{}: {}", i, printable(name)));
            const std::string output = results[i].out + results[i].err;
            EXPECT_EQ(results[i].status, harmless[i].status) << output;
            EXPECT_EQ(printable_lines(output), output);
            EXPECT_EQ(std::ranges::count(output, '\n'), std::ranges::count(harmless[i].out + harmless[i].err, '\n'))
                << output;
        }
        const Json report = Json::parse(results[2].out, nullptr, false);
        ASSERT_TRUE(report.is_object()) << results[2].out;
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
