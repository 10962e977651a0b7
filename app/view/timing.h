// How long fits take while the picture turns, and how often it is drawn meanwhile.
#pragma once
#include <vector>

#include "app/view/look.h"
#include "app/view/session.h"

namespace srbf {

/// So many fits, the next asked for when the one before is there; of each a line on standard output.
class Refits {
  public:
    explicit Refits(int count) : count_(count) {}
    /// Once a frame: turns the picture, asks for the next fit and prints the one that is there; quits after the last.
    void step(Session& session, Look& look);

  private:
    int count_, timed_ = 0;
    bool waits_ = false;  ///< for a fit that was asked for; then:
    Stopwatch asked_, last_frame_;
    int frames_ = 0;
    double slowest_ = 0;                 ///< [s] a frame
    std::vector<double> swapped_after_;  ///< [s] the fits that came on display
    double swapped_ = 0;                 ///< what the last of them says that it took
};

}  // namespace srbf
