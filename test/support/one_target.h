// Limits Highway to one instruction set.
#pragma once
#include <hwy/highway.h>

namespace srbf {

using Target = decltype(hwy::SupportedTargets());  // uint32_t before Highway 0.17, int64_t from then on

/// Makes Highway use one instruction set until the end of its scope.
class OneTarget {
  public:
    explicit OneTarget(Target target) { choose(target); }
    ~OneTarget() { choose(0); }
    OneTarget(const OneTarget&) = delete;
    OneTarget& operator=(const OneTarget&) = delete;

  private:
    static void choose(Target target) {
        hwy::SetSupportedTargetsForTest(target);
        const auto update = [](auto& chosen) {
            if constexpr (requires { chosen.Update(hwy::SupportedTargets()); })
                chosen.Update(hwy::SupportedTargets());
            else
                chosen.Update();
        };
        update(hwy::GetChosenTarget());
    }
};

}  // namespace srbf
