// Runs as many command lines as are asked for, of random bytes: command_lines COUNT [SEED]. SRBF_FUZZ_SHOW=1 shows them.
#include "command_line.h"

#include <random>

int main(int argc, char** argv) {
    const int count = argc > 1 ? std::atoi(argv[1]) : 0;
    std::mt19937_64 random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
    std::array<int, 3> of_status{};
    for (int i = 0; i < count; ++i) {
        std::vector<std::byte> bytes(40);
        for (std::byte& byte : bytes) byte = std::byte(random() & 255);
        ++of_status[std::size_t(srbf::check_command_line(bytes))];
    }
    fmt::print("{} command lines: status 0 of {}, 1 of {}, 2 of {}\n", count, of_status[0], of_status[1], of_status[2]);
}
