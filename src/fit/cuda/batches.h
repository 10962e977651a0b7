// What a CUDA device computes for many candidates at once.
#pragma once
#include <Eigen/Dense>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fit/search.h"
#include "srbf/result.h"

namespace srbf {

/// A candidate with what the search asks of it, in and out.
struct DeviceWork {
    std::size_t rows = 0;  ///< index of its observations
    Lobes lobes;           ///< in and out
    double log_peak_limit = 0;
    int iterations = 0;  ///< of `optimise`
    double target = std::numeric_limits<double>::infinity();
    std::vector<std::vector<double>> candidates;  ///< of `best_additions`

    double loss = 0;               ///< out
    Eigen::MatrixXd beta, gram;    ///< out: J × C; E·E
    std::vector<double> addition;  ///< out of `best_additions`: the best candidate, or empty
};

/// The name of the CUDA device that fits would use. Errors: why there is none.
Result<std::string> cuda_device();

/// Runs batches of work on a CUDA device, or the same text over a serial grid on this processor: a block for each work.
/// Results do not depend on the number of blocks that run at once.
class Batches {
  public:
    enum class Where { emulated, cuda };
    /// Copies the observations to the device. Errors: no device; its memory is full.
    static Result<Batches> make(Where where, std::span<const Rows* const> rows);
    Batches(Batches&&) noexcept;
    Batches& operator=(Batches&&) noexcept;
    ~Batches();

    /// Levenberg-Marquardt, as `levenberg_marquardt` of LobeProblem.
    Result<Done> optimise(std::span<DeviceWork> work);
    /// The loss, and the best of the candidates, as LobeProblem::best_addition.
    Result<Done> best_additions(std::span<DeviceWork> work);

  private:
    struct State;
    explicit Batches(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace srbf
