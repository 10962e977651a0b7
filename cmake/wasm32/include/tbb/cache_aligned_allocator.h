#pragma once
#include <cstddef>
#include <new>

namespace tbb {
template <typename T> struct cache_aligned_allocator {
    using value_type = T;
    cache_aligned_allocator() = default;
    template <typename U> cache_aligned_allocator(const cache_aligned_allocator<U>&) {}
    T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(128))); }
    void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(128)); }
    template <typename U> bool operator==(const cache_aligned_allocator<U>&) const { return true; }
};
}  // namespace tbb
