#include "app/jobs.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>

#include "app/memory.h"

namespace srbf {

int jobs_within_memory(std::uint64_t max_count) {
    constexpr std::uint64_t k_job_memory = std::uint64_t(1) << 29;
    return int(std::max<std::uint64_t>(std::min(max_count, free_memory() / k_job_memory), 1));
}

void in_jobs(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    const auto take = [&] {
        try {
            for (std::size_t i; (i = next++) < count;) work(i);
        } catch (...) {
            const std::scoped_lock lock(mutex);
            failure = std::current_exception();
            next = count;
        }
    };
    std::vector<std::jthread> workers;
    try {
        workers.reserve(std::size_t(jobs));
        for (int i = 1; i < jobs; ++i) workers.emplace_back(take);
    } catch (const std::system_error&) {  // no more threads: the running ones do the work
    }
    take();
    workers.clear();
    if (failure) std::rethrow_exception(failure);
}

void JobProgress::show(std::size_t i, const std::string& text, double fraction) {
    const std::scoped_lock lock(mutex_);
    sum_ += fraction - fraction_[i];
    fraction_[i] = fraction;
    line_.show(text, sum_ / double(fraction_.size()));
}

void JobProgress::print(const std::function<void()>& print) {
    const std::scoped_lock lock(mutex_);
    line_.clear();
    print();
}

}  // namespace srbf
