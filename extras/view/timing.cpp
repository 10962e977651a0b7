#include "extras/view/timing.h"

#include <fmt/format.h>

#include <algorithm>

namespace SRBF_NAMESPACE {

void Refits::step(Session& session, DisplayState& display) {
    orbit(display, 1 * k_degree, 0);
    if (!is_waiting_ && timed_ < count_ && session.stage() == Stage::idle && session.fitted()) {
        FitChoice choice = session.choice();
        choice.lobes = 6 + (choice.lobes + 1) % 5;
        clock_ = last_frame_ = {};
        session.choose(choice);
        is_waiting_ = true, display_times_.clear(), frames_ = 0, slowest_ = 0;
        return;
    }
    if (!is_waiting_) return void(display.quit = timed_ >= count_);
    ++frames_;
    slowest_ = std::max(slowest_, last_frame_.seconds());
    last_frame_ = {};
    const double waited = clock_.seconds();
    const auto& fitted = session.fitted();
    const bool is_new = session.stage() != Stage::fitting && fitted && fitted->seconds != last_duration_;
    if (is_new) last_duration_ = fitted->seconds, display_times_.push_back(waited);
    if (session.stage() != Stage::measuring && session.stage() != Stage::idle) return;
    is_waiting_ = false;
    ++timed_;
    fmt::print("J={}: fits on display after {:.2f} s; {:.1f} frames/s, slowest frame {:.0f} ms\n",
               fitted ? fitted->choice.lobes : 0, fmt::join(display_times_, ", "), frames_ / waited, 1000 * slowest_);
}

}  // namespace srbf
