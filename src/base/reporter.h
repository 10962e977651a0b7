// Progress of work that several threads share.
#pragma once
#include <algorithm>
#include <mutex>

#include "srbf/progress.h"

namespace SRBF_NAMESPACE {

/// Reports the completed fraction of a stage's work, from any thread.
class Reporter {
  public:
    Reporter(ProgressToken token, double total) : token_(std::move(token)), total_(total) {}
    /// Returns false once cancelled.
    bool advance(std::string_view stage, double work) {
        const std::scoped_lock lock(mutex_);
        done_ += work;
        return token_.report(stage, std::min(done_ / total_, 1.0));
    }
    bool cancelled() const { return token_.cancelled(); }

  private:
    ProgressToken token_;
    double total_, done_ = 0;
    std::mutex mutex_;
};

}  // namespace
