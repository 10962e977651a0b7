#pragma once

namespace tbb {
struct task_arena {
    explicit task_arena(int) {}
    template <typename Body> void execute(const Body& body) { body(); }
};
}  // namespace tbb
