#include "app/memory.h"

#include <sys/resource.h>

#include <algorithm>

namespace srbf {
namespace {

bool is_limited = false;

}  // namespace

void limit_memory(int megabytes) {
    rlimit limit{};
    ::getrlimit(RLIMIT_DATA, &limit);
    limit.rlim_max = std::min(limit.rlim_max, rlim_t(megabytes) << 20);
    limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
    ::setrlimit(RLIMIT_DATA, &limit);  // lowering the limit is always permitted
    is_limited = true;
}

Result<Done> check_drawing() {
    if (is_limited)
        return Error{"OpenGL", {}, "memory", "no --max-memory, which OpenGL's drivers do not survive", "a limit"};
    return Done{};
}

}  // namespace srbf
