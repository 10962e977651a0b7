// libFuzzer for srbf_runtime.h. One file in 64 is prepared too, which takes long.
#include "../test/support/runtime_use.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    state = 88172645463325252ull;  // so that the input alone decides
    use_file(data, size, size > 0 && data[size - 1] % 64 == 0);
    return 0;
}
