#pragma once
#include <tbb/cache_aligned_allocator.h>

#include <vector>

namespace SRBF_NAMESPACE {

/// A vector that begins at a cache line.
template <typename T> using Aligned = std::vector<T, tbb::cache_aligned_allocator<T>>;

}  // namespace srbf
