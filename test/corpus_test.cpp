// Every file that the fuzzers began with or once found.
#include "../fuzz/targets.h"

#include "corpus.h"
#include "properties.h"
#include "temporary_folder.h"

namespace srbf::corpus_test {
namespace {

TEST(Corpus, KeepsThePromisesOfEachTarget) {
    const auto folders = corpora();
    for (const NamedTarget& target : all_targets()) {
        const std::filesystem::path& folder = folders.at(target.name);
        int files = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            const std::string bytes = read_text(entry.path());
            // A copy of just this size, so that reading past its end is seen.
            const std::vector<char> copy(bytes.begin(), bytes.end());
            target.check(std::as_bytes(std::span(copy)));
            ++files;
        }
        EXPECT_GE(files, 1) << folder;
    }
}

}  // namespace
}  // namespace srbf::corpus_test
