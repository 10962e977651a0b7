// Work on many files in parallel.
#pragma once
#include <cstdint>
#include <functional>
#include <mutex>

#include "app/output.h"

namespace srbf {

/// The number of files to process in parallel: at most `max_count`, and one per 512 MiB of free memory, which is
/// more than a material of MERL's size takes; at least 1.
int jobs_within_memory(std::uint64_t max_count);

/// Calls work(i) for i = 0..count−1, started in order of i, on `jobs` threads.
void in_jobs(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

/// A progress line for the files in progress. Thread-safe.
class JobProgress {
  public:
    JobProgress(std::size_t count, ProgressLine& line) : fraction_(count), line_(line) {}
    void show(std::size_t i, const std::string& text, double fraction);
    /// Calls `print` while the progress line is cleared.
    void print(const std::function<void()>& print);

  private:
    std::mutex mutex_;
    std::vector<double> fraction_;
    double sum_ = 0;
    ProgressLine& line_;
};

}  // namespace srbf
