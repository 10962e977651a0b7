#include "srbf/progress.h"

#include <algorithm>
#include <atomic>
#include <mutex>

namespace SRBF_NAMESPACE {

struct ProgressToken::State {
    ProgressCallback callback;
    std::atomic<bool> cancelled = false;
    std::mutex mutex;
    double fraction = 0;
};

ProgressToken::ProgressToken(ProgressCallback callback) : state_(std::make_shared<State>()) {
    state_->callback = std::move(callback);
}

bool ProgressToken::report(std::string_view stage, double fraction) const {
    if (!state_) return true;
    const std::scoped_lock lock(state_->mutex);
    if (state_->cancelled) return false;
    state_->fraction = std::max(state_->fraction, begin_ + length_ * std::clamp(fraction, 0.0, 1.0));
    if (state_->callback && !state_->callback({stage, state_->fraction})) state_->cancelled = true;
    return !state_->cancelled;
}

void ProgressToken::cancel() const {
    if (state_) state_->cancelled = true;
}

bool ProgressToken::cancelled() const { return state_ && state_->cancelled; }

ProgressToken ProgressToken::subrange(double begin, double end) const {
    ProgressToken part = *this;
    part.begin_ = begin_ + length_ * begin;
    part.length_ = length_ * (end - begin);
    return part;
}

}  // namespace
