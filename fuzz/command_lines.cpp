// Runs command lines made of random bytes: command_lines COUNT [SEED]. SRBF_FUZZ_SHOW=1 shows them.
#include "command_line.h"

#include <random>

int main(int argc, char** argv) {
    const int count = argc > 1 ? std::atoi(argv[1]) : 0;
    std::mt19937_64 random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
    std::array<int, 3> counts{};  // by exit status
    for (int i = 0; i < count; ++i) {
        std::vector<std::byte> bytes(40);
        for (std::byte& byte : bytes) byte = std::byte(random() & 255);
        ++counts[std::size_t(srbf::check_command_line(bytes))];
    }
    fmt::print("{} command lines: status 0 of {}, 1 of {}, 2 of {}\n", count, counts[0], counts[1], counts[2]);
}
