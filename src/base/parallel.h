// Loops on several threads, with the floating-point mode that all results require.
#pragma once
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#include "base/floating_point.h"

namespace SRBF_NAMESPACE {

/// Runs body() on `threads` threads; 0: all of the machine. More threads than it has are not used.
template <typename Body> void on_threads(int threads, const Body& body) {
    const int max = tbb::info::default_concurrency();
    tbb::task_arena(threads > 0 ? std::min(threads, max) : max).execute([&] {
        const StandardArithmetic mode;
        body();
    });
}

/// Runs body(i) for i in 0..count−1, in any order, on the threads of the caller's `on_threads`.
template <typename Body> void parallel_for(std::size_t count, const Body& body) {
    tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
        const StandardArithmetic mode;
        body(i);
    });
}

/// `parallel_for` if `parallel`, otherwise a loop in order on the caller's thread.
template <typename Body> void for_each(std::size_t count, bool parallel, const Body& body) {
    if (parallel) return parallel_for(count, body);
    for (std::size_t i = 0; i < count; ++i) body(i);
}

/// `parallel_for` on `threads` threads (see `on_threads`).
template <typename Body> void parallel_for(std::size_t count, int threads, const Body& body) {
    on_threads(threads, [&] { parallel_for(count, body); });
}

constexpr std::size_t chunk_count(std::size_t count, std::size_t size) { return (count + size - 1) / size; }
/// Calls body(begin, end) for parts of 0..count−1 of the given size; the last one may be smaller.
template <typename Body> void parallel_for_chunks(std::size_t count, std::size_t size, const Body& body) {
    parallel_for(chunk_count(count, size), [&](std::size_t i) { body(i * size, std::min((i + 1) * size, count)); });
}
template <typename Body> void parallel_for_chunks(std::size_t count, std::size_t size, int threads, const Body& body) {
    on_threads(threads, [&] { parallel_for_chunks(count, size, body); });
}

}  // namespace
