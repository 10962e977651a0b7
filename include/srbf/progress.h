// How far a computation is, and whether it goes on: level 0.
#pragma once
#include <concepts>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>

namespace srbf {

/// What a computation is doing.
struct Progress {
    std::string_view stage;  ///< "growing lobes"
    double fraction = 0;     ///< of the whole that is done, 0..1; it never decreases
};

/// Receives progress; returning false cancels the computation.
using ProgressCallback = std::function<bool(const Progress&)>;

/// Reports progress to a callback and carries cancellation to every stage of a computation. Copies share one state, so
/// the caller may keep one to cancel from another thread. A default token reports to nobody and is never cancelled.
/// All members may be called from several threads at once; the callback runs on one thread at a time.
class ProgressToken {
  public:
    ProgressToken() = default;
    explicit ProgressToken(ProgressCallback callback);
    template <typename Callback>
    requires std::is_invocable_r_v<bool, Callback&, const Progress&> ProgressToken(Callback callback)
        : ProgressToken(ProgressCallback(std::move(callback))) {}

    /// Reports that `fraction` of this token's work is done. False once cancelled.
    bool report(std::string_view stage, double fraction) const;
    void cancel() const;
    bool cancelled() const;
    /// The token of a stage that takes the work from `begin` to `end` of this one.
    ProgressToken part(double begin, double end) const;

  private:
    struct State;
    std::shared_ptr<State> state_;
    double begin_ = 0, length_ = 1;
};

}  // namespace srbf
