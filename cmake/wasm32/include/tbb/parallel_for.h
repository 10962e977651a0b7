#pragma once

namespace tbb {
template <typename Index, typename Body> void parallel_for(Index first, Index last, const Body& body) {
    for (Index i = first; i < last; ++i) body(i);
}
}  // namespace tbb
