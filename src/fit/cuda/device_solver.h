// What a CUDA device computes for many candidates at once.
#pragma once
#include <memory>
#include <span>
#include <string>

#include "fit/search/solver.h"
#include "srbf/result.h"

namespace srbf {

/// The name of the CUDA device that fits would use. Errors: why there is none.
Result<std::string> cuda_device();

/// What solves the trials of a search.
enum class Where {
    processor,
    emulated,  ///< the device's text on this processor, for tests
    cuda,
};

/// Solves trials on a CUDA device, or by the same text over a serial grid on this processor: a block for each trial.
/// Results do not depend on the number of blocks that run at once.
class DeviceSolver {
  public:
    /// Copies the observations of each material to the device. Errors: no device; its memory is full.
    static Result<DeviceSolver> make(Where where, std::span<const Rows* const> rows, double log_peak_limit);
    DeviceSolver(DeviceSolver&&) noexcept;
    DeviceSolver& operator=(DeviceSolver&&) noexcept;
    ~DeviceSolver();

    Result<Done> optimise(std::span<Trial> trials);
    Result<Done> best_additions(std::span<Trial> trials);

  private:
    struct State;
    explicit DeviceSolver(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace srbf
