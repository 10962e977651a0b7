// PROGRAM [--of=NOUN] [googletest's options]: runs the tests of all its files, or those of NOUN_test.cpp.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace {

/// A filter of the tests in `file`; empty if there are none.
std::string tests_of(std::string_view file) {
    std::string filter;
    const auto& all = *testing::UnitTest::GetInstance();
    for (int i = 0; i < all.total_test_suite_count(); ++i) {
        const testing::TestSuite& suite = *all.GetTestSuite(i);
        for (int k = 0; k < suite.total_test_count(); ++k) {
            const testing::TestInfo& test = *suite.GetTestInfo(k);
            if (std::string_view(test.file()).ends_with(file))
                filter += (filter.empty() ? "" : ":") + std::string(suite.name()) + '.' + test.name();
        }
    }
    return filter;
}

}  // namespace

int main(int count, char** arguments) {
    testing::InitGoogleTest(&count, arguments);
    constexpr std::string_view option = "--of=";
    const std::string_view selection = count == 2 ? arguments[1] : "";
    if (count > 1) {
        const bool is_option = selection.starts_with(option);
        const std::string file = is_option ? std::string(selection.substr(option.size())) + "_test.cpp" : "";
        const std::string tests = is_option ? tests_of("/" + file) : "";
        if (tests.empty()) {
            const std::string reason = is_option ? "no tests in " + file : std::string("expected one option");
            std::fprintf(stderr, "usage: %s [--of=NOUN] [googletest's options]; %s\n", arguments[0], reason.c_str());
            return 2;
        }
        // A filter of what not to run holds among them; another one takes their place.
        std::string& filter = testing::GTEST_FLAG(filter);
        if (filter == "*") filter = tests;
        if (filter.starts_with('-')) filter = tests + filter;
    }
    return RUN_ALL_TESTS();
}
