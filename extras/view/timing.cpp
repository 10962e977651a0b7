#include "extras/view/timing.h"

#include <fmt/format.h>

#include <algorithm>

namespace srbf {

void Refits::step(Session& session, Look& look) {
    orbit(look, 1 * k_degree, 0);
    if (!waits_ && timed_ < count_ && session.stage() == Stage::idle && session.fitted()) {
        FitChoice choice = session.choice();
        choice.lobes = 6 + (choice.lobes + 1) % 5;
        asked_ = last_frame_ = {};
        session.choose(choice);
        waits_ = true, swapped_after_.clear(), frames_ = 0, slowest_ = 0;
        return;
    }
    if (!waits_) return void(look.quit = timed_ >= count_);
    ++frames_;
    slowest_ = std::max(slowest_, last_frame_.seconds());
    last_frame_ = {};
    const double waited = asked_.seconds();
    const auto& fitted = session.fitted();
    const bool is_new = session.stage() != Stage::fitting && fitted && fitted->seconds != swapped_;
    if (is_new) swapped_ = fitted->seconds, swapped_after_.push_back(waited);
    if (session.stage() != Stage::measuring && session.stage() != Stage::idle) return;
    waits_ = false;
    ++timed_;
    fmt::print("J={}: fits on display after {:.2f} s; {:.1f} frames/s, slowest frame {:.0f} ms\n",
               fitted ? fitted->choice.lobes : 0, fmt::join(swapped_after_, ", "), frames_ / waited, 1000 * slowest_);
}

}  // namespace srbf
