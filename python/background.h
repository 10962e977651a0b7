// Runs long computations while Python stays responsive.
#pragma once
#include <pybind11/pybind11.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "srbf/progress.h"

namespace srbf {

namespace py = pybind11;

/// Runs work(token) on a thread of its own. Meanwhile this thread handles signals (Ctrl-C) and calls
/// `progress(stage, fraction)`. False cancels the computation, and so does an exception, which is rethrown.
template <typename Work> auto in_background(const py::object& progress, const Work& work) {
    std::mutex mutex;
    std::condition_variable changed;
    std::string stage;
    double fraction = 0;
    bool done = false;
    const ProgressToken token([&](const Progress& now) {
        const std::lock_guard lock(mutex);
        stage = now.stage;
        fraction = now.fraction;
        return true;
    });
    std::optional<decltype(work(token))> result;
    std::exception_ptr failure, raised;
    std::thread worker([&] {
        try {
            result.emplace(work(token));
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(mutex);
        done = true;
        changed.notify_all();
    });
    {
        const py::gil_scoped_release released;
        std::unique_lock lock(mutex);
        double reported = -1;
        while (!changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; })) {
            if (raised) continue;
            const std::string current_stage = stage;
            const double current_fraction = fraction;
            lock.unlock();
            {
                const py::gil_scoped_acquire acquired;
                try {
                    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
                    if (!progress.is_none() && current_fraction > reported &&
                        progress(current_stage, current_fraction).is(py::bool_(false)))
                        token.cancel();
                    reported = current_fraction;
                } catch (...) {
                    raised = std::current_exception();
                    token.cancel();
                }
            }
            lock.lock();
        }
    }
    {
        const py::gil_scoped_release released;
        worker.join();
    }
    if (raised) std::rethrow_exception(raised);
    if (failure) std::rethrow_exception(failure);
    return *std::move(result);
}

}  // namespace srbf
