// Uses of every file that the fuzzer of uses began with or once found.
#include "../fuzz/uses.h"

#include "corpus.h"
#include "properties.h"

namespace srbf::uses_test {
namespace {

TEST(Uses, KeepTheirPromises) {
    const std::vector<std::string> files = corpus_files().at("uses");
    EXPECT_GE(files.size(), 10u);
    for (const std::string& bytes : files) check_uses(std::as_bytes(std::span(bytes)));
}

}  // namespace
}  // namespace srbf::uses_test
