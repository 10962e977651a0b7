// Every file that the fuzzers began with or once found.
#include "../fuzz/targets.h"

#include "corpus.h"
#include "properties.h"

namespace srbf::corpus_test {
namespace {

TEST(Corpus, KeepsThePromisesOfEachTarget) {
    const auto corpus = corpus_files();
    for (const NamedTarget& target : all_targets())
        for (const std::string& bytes : corpus.at(target.name)) {
            // A copy of just this size, so that reading past its end is seen.
            const std::vector<char> copy(bytes.begin(), bytes.end());
            target.check(std::as_bytes(std::span(copy)));
        }
}

}  // namespace
}  // namespace srbf::corpus_test
