// Timing of fits while the picture rotates, and of the frame rate meanwhile.
#pragma once
#include <vector>

#include "extras/view/look.h"
#include "extras/view/session.h"

namespace srbf {

/// Runs a number of fits one after the other, and prints a line for each to standard output.
class Refits {
  public:
    explicit Refits(int count) : count_(count) {}
    /// To be called once per frame: rotates the picture, requests the next fit and prints the completed one; quits
    /// after the last.
    void step(Session& session, Look& look);

  private:
    int count_, timed_ = 0;
    bool waits_ = false;  ///< for a requested fit; then:
    Stopwatch asked_, last_frame_;
    int frames_ = 0;
    double slowest_ = 0;                 ///< [s] per frame
    std::vector<double> swapped_after_;  ///< [s] of the fits that were displayed
    double swapped_ = 0;                 ///< the duration that the last of them reports
};

}  // namespace srbf
