// PROGRAM [--of=NOUN] [googletest's options]: runs the tests of all its files, or those of NOUN_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
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
        const std::string noun(selection.substr(std::min(option.size(), selection.size())));
        const std::string tests = selection.starts_with(option) ? tests_of("/" + noun + "_test.cpp") : "";
        if (tests.empty()) {
            std::fprintf(stderr, "usage: %s [--of=NOUN] [googletest's options]; found %s\n", arguments[0],
                         arguments[1]);
            return 2;
        }
        // A filter of what not to run holds among them; another one takes their place.
        std::string& filter = testing::GTEST_FLAG(filter);
        if (filter == "*") filter = tests;
        if (filter.starts_with('-')) filter = tests + filter;
    }
    return RUN_ALL_TESTS();
}
