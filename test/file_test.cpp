// Files that are written and read whole: round trips, and errors that leave the old file. failures_test.cpp has a full
// disk.
#include "srbf/file.h"

#include <unistd.h>

#include "properties.h"
#include "temporary_folder.h"

namespace srbf::file_test {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed at the end.
class File : public testing::Test {
  protected:
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::size_t files() const { return std::size_t(std::distance(fs::directory_iterator(folder_), {})); }

    const TemporaryFolder temporary_;
    const fs::path folder_ = temporary_.path;
};

std::string read_back(const std::string& path) {
    const auto bytes = read_file(path);
    EXPECT_TRUE(bytes.ok());
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : "";
}

void expect_error(const Error& error, const std::string& path) {
    EXPECT_EQ(error.source, path);
    EXPECT_FALSE(error.what.empty());
    EXPECT_FALSE(error.found.empty());
    EXPECT_LACKS(message(error), "\n");
}

TEST_F(File, ReadsBackWhatWasWritten) {
    std::mt19937_64 random(1);
    for (const std::size_t size : {0u, 1u, 4096u, 65535u, 65536u, 65537u, 1000000u}) {
        std::vector<std::byte> bytes(size);
        for (auto& b : bytes) b = std::byte(random());
        ASSERT_TRUE(write_file(path("a"), bytes).ok());
        const auto back = checked(read_file(path("a")));
        EXPECT_EQ(*back, bytes);
    }
    EXPECT_EQ(files(), 1u);
}

TEST_F(File, ReadsAPipe) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    ASSERT_EQ(::write(ends[1], "through", 7), 7);
    ::close(ends[1]);
    EXPECT_EQ(read_back("/dev/fd/" + std::to_string(ends[0])), "through");
    ::close(ends[0]);
}

TEST_F(File, UnreadableIsAnError) {
    ASSERT_TRUE(write_file(path("a"), as_bytes("old")).ok());
    for (const std::string& p : {path("missing"), path(""), path("a/below"), std::string()}) {
        const auto bytes = read_file(p);
        ASSERT_FALSE(bytes.ok()) << p;
        expect_error(bytes.error(), p);
    }
}

TEST_F(File, UnwritableIsAnErrorAndLeavesNothing) {
    ASSERT_TRUE(write_file(path("a"), as_bytes("old")).ok());
    fs::create_directory(path("folder"));
    for (const std::string& p : {path("folder"), path("a/below"), path("missing/a"), std::string()}) {
        const auto done = write_file(p, as_bytes("new"));
        ASSERT_FALSE(done.ok()) << p;
        expect_error(done.error(), p);
    }
    EXPECT_EQ(read_back(path("a")), "old");
    EXPECT_EQ(files(), 2u);
}

TEST_F(File, WritesToDevices) {
    EXPECT_TRUE(write_file("/dev/null", as_bytes("x")).ok());
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const auto done = write_file("/dev/full", as_bytes("x"));
    ASSERT_FALSE(done.ok());
    expect_error(done.error(), "/dev/full");
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(File, KeepsPermissionsAndLinks) {
    ASSERT_TRUE(write_file(path("a"), as_bytes("old")).ok());
    fs::permissions(path("a"), fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink("a", path("link"));
    ASSERT_TRUE(write_file(path("link"), as_bytes("new")).ok());
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(read_back(path("a")), "new");
    EXPECT_EQ(fs::status(path("a")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(Message, IsOneLineWithThePartsThatAreGiven) {
    EXPECT_EQ(message({"a.bsdf", 18, "field count", "between 1 and 1024", "0"}),
              "a.bsdf: at 18: field count: expected between 1 and 1024, found 0");
    EXPECT_EQ(message({"a", {}, "broken", "", ""}), "a: broken");
    EXPECT_EQ(message({"a", {}, "broken", "", "x"}), "a: broken: found x");
    EXPECT_EQ(message({"a\nb", {}, "broken", "y", ""}), "a b: broken: expected y");
}

}  // namespace
}  // namespace srbf::file_test
