// Many files at a time.
#pragma once
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "app/output.h"

namespace srbf {

/// Number of files at a time: at most `most`, and one for each half GiB of free memory, which is more than a material
/// of MERL's size takes; at least 1.
int jobs_within_memory(std::uint64_t most);

/// Calls work(i) for i in 0..count−1, in order of i, `jobs` of them at a time.
void in_jobs(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

/// A progress line about the files in progress. Thread-safe.
class Board {
  public:
    Board(std::size_t count, ProgressLine& line) : fraction_(count), line_(line) {}
    void show(std::size_t i, const std::string& what, double fraction);
    /// Prints between two states of the line.
    void print(const std::function<void()>& print);

  private:
    std::mutex one_at_a_time_;
    std::vector<double> fraction_;
    double sum_ = 0;
    ProgressLine& line_;
};

}  // namespace srbf
