// Progress and cancellation of a computation.
#pragma once
#include <functional>
#include <memory>
#include <string_view>
#include <utility>

#include "srbf/version.h"

SRBF_BEGIN

struct Progress {
    std::string_view stage;  ///< "growing lobes"
    double fraction = 0;     ///< completed fraction of the whole, 0..1; never decreases
};

/// Receives progress; returning false cancels the computation.
using ProgressCallback = std::function<bool(const Progress&)>;

/// Reports progress to a callback and carries cancellation to every stage of a computation. Copies share one state, so
/// that the caller can keep a copy and cancel from another thread. A default token reports nothing and is never
/// cancelled. All members are thread-safe; the callback runs on one thread at a time.
class ProgressToken {
  public:
    ProgressToken() = default;
    explicit ProgressToken(ProgressCallback callback);
    template <typename Callback>
    requires std::is_invocable_r_v<bool, Callback&, const Progress&> ProgressToken(Callback callback)
        : ProgressToken(ProgressCallback(std::move(callback))) {}

    /// Reports that `fraction` of this token's work is complete. Returns false once cancelled.
    bool report(std::string_view stage, double fraction) const;
    void cancel() const;
    bool cancelled() const;
    /// The token of a stage that accounts for the work from `begin` to `end` of this one.
    ProgressToken subrange(double begin, double end) const;

  private:
    struct State;
    std::shared_ptr<State> state_;
    double begin_ = 0, length_ = 1;
};

SRBF_END
