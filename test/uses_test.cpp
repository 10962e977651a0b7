// Uses of every file that the fuzzer of uses began with or once found.
#include "../fuzz/uses.h"

#include "corpus.h"
#include "properties.h"
#include "temporary_folder.h"

namespace srbf::uses_test {
namespace {

TEST(Uses, KeepTheirPromises) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(corpora().at("uses"))) {
        const std::string bytes = read_text(entry.path());
        check_uses(std::as_bytes(std::span(bytes)));
        ++files;
    }
    EXPECT_GE(files, 10);
}

}  // namespace
}  // namespace srbf::uses_test
