// Timing of fits while the picture rotates, and of the frame rate meanwhile.
#pragma once
#include <vector>

#include "extras/view/display_state.h"
#include "extras/view/session.h"

namespace SRBF_NAMESPACE {

/// Runs a number of fits in sequence, and prints a line for each to standard output.
class Refits {
  public:
    explicit Refits(int count) : count_(count) {}
    /// Call it once per frame. It rotates the picture, requests the next fit and prints the completed one. After
    /// the last it quits.
    void step(Session& session, DisplayState& display);

  private:
    int count_, timed_ = 0;
    bool is_waiting_ = false;  ///< for a requested fit; then:
    Stopwatch clock_, last_frame_;
    int frames_ = 0;
    double slowest_ = 0;                 ///< duration of the slowest frame [s]
    std::vector<double> display_times_;  ///< times after the request at which fits were displayed [s]
    double last_duration_ = 0;           ///< `Fitted::seconds` of the last of them
};

}  // namespace srbf
