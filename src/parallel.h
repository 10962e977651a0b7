// Loops on several threads: level 0.
#pragma once
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

namespace srbf {

/// A place to work for `threads` threads; 0, and more than the machine has: as many as it has.
inline tbb::task_arena arena_of(int threads) {
    const int most = tbb::info::default_concurrency();
    return tbb::task_arena(threads > 0 ? std::min(threads, most) : most);
}

/// body(i) for i in 0..count−1, in any order, on threads as in `arena_of`.
template <typename Body> void parallel_for(std::size_t count, int threads, const Body& body) {
    arena_of(threads).execute([&] { tbb::parallel_for(std::size_t(0), count, body); });
}

}  // namespace srbf
