// Files of texels, and `srbf map` of them.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <map>

#include "program.h"
#include "srbf/file.h"
#include "srbf/npy.h"
#include "texel_values.h"

namespace srbf::texel_files_test {
namespace {

std::string npy(const std::string& header, std::size_t numbers) {
    std::string text = "\x93NUMPY";
    text += std::string("\1\0", 2) + char(header.size()) + '\0' + header;
    return text + std::string(4 * numbers, '\0');
}

TEST(Npy, head_is_read_and_every_truncation_is_an_error) {
    const std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 5, 3), }\n";
    const std::string file = npy(header, 30);
    const auto head = read_npy_head(as_bytes(file), file.size(), "t.npy");
    ASSERT_TRUE(head) << message(head.error());
    EXPECT_EQ(head->shape, (std::vector<std::uint64_t>{2, 5, 3}));
    EXPECT_EQ(head->data, 10 + header.size());
    for (std::size_t n = 0; n < file.size(); ++n)
        EXPECT_FALSE(read_npy_head(as_bytes(std::string_view(file).substr(0, n)), n, "t.npy").ok()) << n;
    for (const char* bad : {"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 5, 3), }",
                            "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 5, 3), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 5, -3), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3), }", "{}"}) {
        const std::string wrong = npy(bad, 30);
        EXPECT_FALSE(read_npy_head(as_bytes(wrong), wrong.size(), "t.npy").ok()) << bad;
    }
}

/// A folder with the texels and pairs as files.
class TexelFiles : public testing::Test {
  protected:
    void SetUp() override {
        const SharedPairs pairs = shared_pairs();
        const std::vector<Rgb> f = blends(pairs, k_texels);
        std::string csv = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n";
        for (std::size_t i = 0; i < k_pairs; ++i) {
            const Vec3f l = pairs.wl[i], v = pairs.wv[i];
            csv += fmt::format("{},{},{},{},{},{}\n", l.x, l.y, l.z, v.x, v.y, v.z);
        }
        write(folder / "p.csv", csv);
        const std::string header =
            fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}, 3), }}\n", k_texels, k_pairs);
        write(folder / "t.npy", npy(header, 0) + std::string(reinterpret_cast<const char*>(f.data()), 12 * f.size()));
    }
    static constexpr std::size_t k_texels = 8;
    const std::vector<std::string> fit{"map",    "t.npy", "--pairs",    "p.csv", "--lobes",   "3",
                                       "--slab", "2",     "--variates", "3",     "--threads", "2"};
    TemporaryFolder folder;
};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::map<std::string, std::string> files_in(const std::string& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (!entry.path().filename().string().starts_with("."))
            all[entry.path().filename().string()] = contents(entry.path().string());
    return all;
}

TEST_F(TexelFiles, killed_and_resumed_nothing_is_lost) {
    const ProgramRun whole = run(folder, fit + std::vector<std::string>{"-o", "whole"});
    ASSERT_EQ(whole.status, 0) << whole.err;
    const auto expected = files_in(folder / "whole");
    ASSERT_EQ(expected.size(), k_texels / 2);
    const auto stack = read_stack(as_bytes(expected.at("t-000000002.srbf")), "t");
    ASSERT_TRUE(stack) << message(stack.error());
    EXPECT_EQ(stack->models.size(), 2u);

    // Killed once the first slab is there.
    const TemporaryFolder captured;
    const pid_t process =
        start(folder, fit + std::vector<std::string>{"-o", "killed"}, captured / "out", captured / "err");
    ASSERT_NE(process, 0);
    while (!std::filesystem::exists(folder / "killed/t-000000000.srbf")) ::usleep(1000);
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
    const auto left = files_in(folder / "killed");
    EXPECT_LT(left.size(), expected.size());
    for (const auto& [name, text] : left) EXPECT_EQ(text, expected.at(name)) << name;
    // A slab that is not whole is fitted again.
    write(folder / "killed/t-000000002.srbf", expected.at("t-000000002.srbf").substr(0, 900));
    const ProgramRun resumed = run(folder, fit + std::vector<std::string>{"-o", "killed", "--resume"});
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(files_in(folder / "killed"), expected);
    EXPECT_EQ(resumed.out.find(" 0 kept"), resumed.out.npos) << resumed.out;
    // By other options everything is.
    const ProgramRun other =
        run(folder, fit + std::vector<std::string>{"-o", "killed", "--resume", "--seed", "1", "--texels", "0:2"});
    EXPECT_NE(other.out.find(" 0 kept"), other.out.npos) << other.out;
}

TEST_F(TexelFiles, ranges_make_the_same_slabs) {
    ASSERT_EQ(run(folder, fit + std::vector<std::string>{"-o", "a", "--texels", "4:6"}).status, 0);
    ASSERT_EQ(run(folder, fit + std::vector<std::string>{"-o", "b", "--texels", "2:8"}).status, 0);
    EXPECT_EQ(files_in(folder / "a").at("t-000000004.srbf"), files_in(folder / "b").at("t-000000004.srbf"));
    for (const auto& bad : {"8:9", "0:9"})
        EXPECT_EQ(run(folder, fit + std::vector<std::string>{"-o", "c", "--texels", bad}).status, 1) << bad;
    for (const auto& bad : {"2:2", "3", "a:b", "-1:2"})
        EXPECT_EQ(run(folder, fit + std::vector<std::string>{"-o", "c", "--texels", bad}).status, 2) << bad;
    EXPECT_FALSE(std::filesystem::exists(folder / "c"));
}

TEST_F(TexelFiles, numbers_for_no_value_are_as_good_as_nan) {
    std::string texels = contents(folder / "t.npy");
    std::map<std::string, std::string> slabs[2];
    for (const float number : {std::nanf(""), -999.f}) {
        for (std::size_t i = 1; i <= 24; ++i) std::memcpy(&texels[texels.size() - 4 * i], &number, 4);
        write(folder / "t.npy", texels);
        const ProgramRun done = run(folder, fit + std::vector<std::string>{"-o", "masked", "--texels", "7:8"});
        ASSERT_EQ(done.status, 0) << done.err;
        EXPECT_EQ(done.err.find("-999, which stands for no value") != done.err.npos, number < 0) << done.err;
        slabs[number < 0] = files_in(folder / "masked");
    }
    EXPECT_EQ(slabs[0], slabs[1]);
}

TEST_F(TexelFiles, slabs_of_another_division_or_other_bytes_are_not_mixed_in) {
    using Words = std::vector<std::string>;
    const auto fitted = [&](const char* to, const char* slab, const char* texels, const Words& resume) {
        return run(folder, Words{"map", "t.npy", "--pairs", "p.csv", "--lobes", "1", "--variates", "1", "-o", to,
                                 "--slab", slab, "--texels", texels} +
                               resume);
    };
    ASSERT_EQ(fitted("o", "2", "0:2", {}).status, 0);
    ASSERT_EQ(fitted("fresh", "1", "0:2", {}).status, 0);
    const auto of_two = files_in(folder / "o"), of_one = files_in(folder / "fresh");
    const auto expect_refused = [&](const char* slab, const char* texels) {
        const auto before = files_in(folder / "o");
        for (const Words& resume : {Words{}, {"--resume"}}) {
            const ProgramRun refused = fitted("o", slab, texels, resume);
            EXPECT_EQ(refused.status, 1) << slab << ' ' << texels;
            EXPECT_NE(refused.err.find("one of another --slab"), refused.err.npos) << refused.err;
            EXPECT_EQ(files_in(folder / "o"), before);
        }
    };
    // The slab reaches into the range, or out of it.
    expect_refused("1", "1:2");
    expect_refused("1", "0:1");
    // One that begins alike is fitted again; one that begins within another is refused.
    EXPECT_NE(fitted("o", "1", "0:2", {"--resume"}).out.find(" 0 kept"), std::string::npos);
    EXPECT_EQ(files_in(folder / "o"), of_one);
    expect_refused("2", "0:2");
    // A slab of other bytes is fitted again, and so is another slab in its place.
    const std::string name = "t-000000001.srbf", slab = of_one.at(name);
    std::vector<std::string> others{of_one.at("t-000000000.srbf")};
    for (const std::size_t at : {std::size_t(9), slab.find("objective") + 14, slab.size() / 2, slab.size() - 1}) {
        others.push_back(slab);
        others.back()[at] = char(others.back()[at] ^ 1);
    }
    for (const std::string& other : others) {
        write(folder / ("o/" + name), other);
        EXPECT_EQ(fitted("o", "1", "0:2", {"--resume"}).status, 0);
        EXPECT_EQ(files_in(folder / "o"), of_one);
    }
}

}  // namespace
}  // namespace srbf::texel_files_test
