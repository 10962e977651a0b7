#include "app/jobs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>

namespace srbf {

int jobs_within_memory(std::uint64_t most) {
    constexpr std::uint64_t k_memory_of_a_job = std::uint64_t(1) << 29;
    const long pages = ::sysconf(_SC_AVPHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
    const std::uint64_t memory = pages > 0 && page > 0 ? std::uint64_t(pages) * std::uint64_t(page) : 0;
    return int(std::max<std::uint64_t>(std::min(most, memory / k_memory_of_a_job), 1));
}

void in_jobs(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
    std::atomic<std::size_t> next = 0;
    std::mutex one_at_a_time;
    std::exception_ptr failure;
    const auto take = [&] {
        try {
            for (std::size_t i; (i = next++) < count;) work(i);
        } catch (...) {
            const std::scoped_lock lock(one_at_a_time);
            failure = std::current_exception();
            next = count;
        }
    };
    std::vector<std::jthread> workers;
    try {
        workers.reserve(std::size_t(jobs));
        for (int i = 1; i < jobs; ++i) workers.emplace_back(take);
    } catch (const std::system_error&) {  // no more threads: those that run do the work
    }
    take();
    workers.clear();
    if (failure) std::rethrow_exception(failure);
}

void Board::show(std::size_t i, const std::string& what, double fraction) {
    const std::scoped_lock lock(one_at_a_time_);
    sum_ += fraction - fraction_[i];
    fraction_[i] = fraction;
    line_.show(what, sum_ / double(fraction_.size()));
}

void Board::print(const std::function<void()>& print) {
    const std::scoped_lock lock(one_at_a_time_);
    line_.clear();
    print();
}

}  // namespace srbf
