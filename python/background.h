// Runs what takes long, while Python is served.
#pragma once
#include <pybind11/pybind11.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "srbf/progress.h"

namespace srbf {

namespace py = pybind11;

/// Runs work(token) on a thread of its own, so that signals (Ctrl-C) and `progress(stage, fraction)` are served here
/// meanwhile. A callback that returns False cancels, as does an exception, which is raised again.
template <typename Work> auto in_background(const py::object& progress, const Work& work) {
    std::mutex mutex;
    std::condition_variable changed;
    std::string stage;
    double fraction = 0;
    bool done = false;
    const ProgressToken token([&](const Progress& now) {
        const std::lock_guard lock(mutex);
        stage = now.stage, fraction = now.fraction;
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
        double told = -1;
        while (!changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; })) {
            if (raised) continue;
            const std::string now = stage;
            const double at = fraction;
            lock.unlock();
            {
                const py::gil_scoped_acquire acquired;
                try {
                    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
                    if (!progress.is_none() && at > told && progress(now, at).is(py::bool_(false))) token.cancel();
                    told = at;
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
