#include "fit/cuda/device_solver.h"

#include <algorithm>

#include <fmt/format.h>

#include "fit/cuda/kernels.h"

namespace srbf {
namespace {

using on_device::Task;

Error of_device(const std::string& what) {
    return {"cuda", {}, "device", "one of compute capability 7.5 or more", what, ErrorCode::argument};
}

/// An error if `failure`, which a function of kernels.h returned, is the text of one.
Result<Done> checked(const std::string& failure) {
    if (failure.empty()) return Done{};
    return Error{"cuda", {}, "search", "to run on the device", failure, ErrorCode::argument};
}

/// Memory of a device, or of this processor.
class Buffer {
  public:
    explicit Buffer(bool is_cuda) : is_cuda_(is_cuda) {}
    Buffer(Buffer&& other) noexcept
        : is_cuda_(other.is_cuda_), memory_(std::exchange(other.memory_, nullptr)), bytes_(other.bytes_) {}
    Buffer& operator=(Buffer&&) = delete;
    ~Buffer() { release(); }

    /// At least so many bytes; what was there is lost.
    Result<Done> reserve(std::size_t bytes) {
        if (bytes <= bytes_) return Done{};
        release();
        if (!is_cuda_) {
            memory_ = ::operator new(bytes);
        } else if (const std::string failure = on_device::allocate(bytes, memory_); !failure.empty()) {
            memory_ = nullptr;
            return Error{"cuda", {}, "memory", std::to_string(bytes >> 20) + " MiB", failure, ErrorCode::argument};
        }
        bytes_ = bytes;
        return Done{};
    }
    Result<Done> write(const void* from, std::size_t bytes) {
        if (const auto room = reserve(bytes); !room) return room;
        if (!is_cuda_) {
            std::copy_n(static_cast<const std::byte*>(from), bytes, static_cast<std::byte*>(memory_));
            return Done{};
        }
        return checked(on_device::copy_to_device(memory_, from, bytes));
    }
    Result<Done> read(void* to, std::size_t bytes) const {
        if (!is_cuda_) {
            std::copy_n(static_cast<const std::byte*>(memory_), bytes, static_cast<std::byte*>(to));
            return Done{};
        }
        return checked(on_device::copy_to_host(to, memory_, bytes));
    }
    template <typename T> T* as() const { return static_cast<T*>(memory_); }
    std::size_t bytes() const { return bytes_; }

  private:
    void release() {
        if (is_cuda_ && memory_) on_device::release(memory_);
        if (!is_cuda_) ::operator delete(memory_);
        memory_ = nullptr, bytes_ = 0;
    }
    bool is_cuda_;
    void* memory_ = nullptr;
    std::size_t bytes_ = 0;
};

/// All numbers of the rows one after the other: wl, wv, √w, y.
std::vector<float> numbers_of(const Rows& rows) {
    std::vector<float> all;
    const auto add = [&](const Aligned<float>& numbers) { all.insert(all.end(), numbers.begin(), numbers.end()); };
    for (const auto& component : rows.wl) add(component);
    for (const auto& component : rows.wv) add(component);
    add(rows.root_weight);
    for (const auto& channel : rows.y) add(channel);
    return all;
}
on_device::Observed observed_at(const float* numbers, const Rows& rows) {
    const std::size_t count = rows.root_weight.size();
    const auto next = [&] { return std::exchange(numbers, numbers + count); };
    on_device::Observed of{};
    for (auto& component : of.wl) component = next();
    for (auto& component : of.wv) component = next();
    of.root_weight = next();
    for (auto& channel : of.y) channel = next();
    of.pairs = int(rows.blocks * k_block);
    of.radiances = int(rows.radiances), of.rows_of_radiance = int(rows.radiance_blocks * k_block);
    of.scale = rows.scale;
    return of;
}

on_device::Shape shape_of(const Lobes& lobes) {
    return {lobes.shape.variates, lobes.shape.components(), features(lobes.shape.form), lobes.count(),
            lobes.shape.reciprocal};
}

/// Where the numbers of a trial are in the memory of those of all trials, in doubles, and its scratch memory.
struct Place {
    std::size_t x, lower, upper, loss, beta, gram, gain, candidates, scratch;
};
/// The places of all trials, and the sizes of both memories.
struct Layout {
    std::vector<Place> places;
    std::size_t numbers = 0, scratch = 0;
};
Result<Layout> laid_out(std::span<const Trial> trials) {
    Layout all;
    const auto take = [&all](std::size_t count) { return std::exchange(all.numbers, all.numbers + count); };
    for (const Trial& of : trials) {
        const on_device::Shape shape = shape_of(of.lobes);
        if (!on_device::fits(shape)) {
            const std::string most =
                fmt::format("{} or fewer, of at most {} columns", on_device::k_most_lobes, on_device::k_most_columns);
            return Error{"cuda", {}, "lobes", most, "more", ErrorCode::argument};
        }
        const auto n = std::size_t(shape.variables()), J = std::size_t(shape.lobes), count = of.additions.size(),
                   channels = std::size_t(on_device::k_channels), gains = std::size_t(shape.of_candidate());
        all.places.push_back({take(n), take(n), take(n), take(1), take(channels * J), take(J * J), take(count * gains),
                              take((count * std::size_t(shape.width()) + 1) / 2), all.scratch});
        all.scratch += on_device::Memory::doubles(shape);
    }
    return all;
}

/// Writes what a trial begins with: variables, their bounds and candidates.
void write_start(const Trial& trial, const Place& at, double* all) {
    const Eigen::VectorXd x = pack(trial.lobes);
    const LobeShape& shape = trial.lobes.shape;
    std::ranges::copy(x, all + at.x);
    for (int v = 0; v < int(x.size()); ++v) {
        constexpr double unbounded = std::numeric_limits<double>::infinity();
        const Interval range = v < shape.variates ? Interval{-unbounded, unbounded}
                                                  : weight_range((v - shape.variates) % shape.width(), shape);
        all[at.lower + std::size_t(v)] = range.least, all[at.upper + std::size_t(v)] = range.most;
    }
    auto* candidate = reinterpret_cast<float*>(all + at.candidates);
    for (const auto& weights : trial.additions)
        candidate = std::ranges::transform(weights, candidate, [](double w) { return float(w); }).out;
}
/// Reads what came of it.
void read_results(Task task, const double* all, const Place& at, Trial& trial) {
    const Eigen::Index J = trial.lobes.count(), N = trial.lobes.shape.variates;
    trial.loss = all[at.loss];
    trial.beta = Eigen::Map<const Eigen::MatrixXd>(all + at.beta, on_device::k_channels, J).transpose();
    trial.gram = Eigen::Map<const Eigen::MatrixXd>(all + at.gram, J, J);
    if (task == Task::optimise) {
        std::copy_n(all + at.x, N, trial.lobes.angle.begin());
        std::copy_n(all + at.x + N, trial.lobes.weight.size(), trial.lobes.weight.begin());
        return;
    }
    trial.addition.clear();
    double best = -1;
    const auto stride = std::size_t(shape_of(trial.lobes).of_candidate());
    for (std::size_t k = 0; k < trial.additions.size(); ++k)
        if (const double gain = all[at.gain + k * stride]; gain > best)
            best = gain, trial.addition = trial.additions[k];
}

constexpr std::size_t k_blocks = 4096;                            ///< of a launch, at most
constexpr std::size_t k_emulated_scratch = std::size_t(4) << 20;  ///< bytes of an emulated launch

}  // namespace

struct DeviceSolver::State {
    State(bool cuda, double limit)
        : is_cuda(cuda), log_peak_limit(limit), scratch(cuda), numbers(cuda), problems(cuda) {}
    bool is_cuda;
    double log_peak_limit;
    std::vector<Buffer> rows;
    std::vector<on_device::Observed> observed;
    Buffer scratch, numbers, problems;

    /// The problem of a trial, once its numbers are written.
    on_device::Problem problem_of(const Trial& trial, const Place& at) const;
    Result<Done> launch(Task task, std::span<const on_device::Problem> launched);
    Result<Done> run(Task task, std::span<Trial> trials);
    /// The number of trials from the first on that are launched together.
    Result<std::size_t> together(std::span<const Trial> trials) const;
    Result<Done> run_all(Task task, std::span<Trial> trials);
};

Result<std::string> cuda_device() {
    std::string name;
    if (const std::string failure = on_device::device_name(name); !failure.empty()) return of_device(failure);
    return name;
}

DeviceSolver::DeviceSolver(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeviceSolver::DeviceSolver(DeviceSolver&&) noexcept = default;
DeviceSolver& DeviceSolver::operator=(DeviceSolver&&) noexcept = default;
DeviceSolver::~DeviceSolver() = default;

Result<DeviceSolver> DeviceSolver::make(Where where, std::span<const Rows* const> rows, double log_peak_limit) {
    const bool is_cuda = where == Where::cuda;
    if (is_cuda)
        if (const auto device = cuda_device(); !device) return device.error();
    auto state = std::make_unique<State>(is_cuda, log_peak_limit);
    for (const Rows* of : rows) {
        const std::vector<float> numbers = numbers_of(*of);
        Buffer& buffer = state->rows.emplace_back(is_cuda);
        if (const auto written = buffer.write(numbers.data(), numbers.size() * sizeof(float)); !written)
            return written.error();
        state->observed.push_back(observed_at(buffer.as<float>(), *of));
    }
    return DeviceSolver(std::move(state));
}

on_device::Problem DeviceSolver::State::problem_of(const Trial& trial, const Place& at) const {
    double* const there = numbers.as<double>();
    on_device::Problem problem{};
    problem.shape = shape_of(trial.lobes);
    problem.observed = observed[trial.rows];
    problem.log_peak_limit = log_peak_limit;
    problem.iterations = trial.steps, problem.target = trial.target;
    problem.doubles = scratch.as<double>() + at.scratch;
    problem.x = there + at.x, problem.lower = there + at.lower, problem.upper = there + at.upper;
    problem.loss = there + at.loss, problem.beta = there + at.beta, problem.gram = there + at.gram;
    problem.gain = there + at.gain, problem.candidates = reinterpret_cast<const float*>(there + at.candidates);
    problem.candidate_count = int(trial.additions.size());
    return problem;
}

Result<Done> DeviceSolver::State::launch(Task task, std::span<const on_device::Problem> launched) {
    if (is_cuda) {
        if (const auto written = problems.write(launched.data(), launched.size_bytes()); !written) return written;
        return checked(on_device::launch(task, problems.as<const on_device::Problem>(), int(launched.size())));
    }
    std::vector<float> tile(on_device::k_shared);
    const auto solve = task == Task::optimise ? on_device::levenberg_marquardt : on_device::gains_of_additions;
    for (const on_device::Problem& problem : launched) solve(on_device::Block{}, problem, tile.data());
    return Done{};
}

Result<Done> DeviceSolver::State::run(Task task, std::span<Trial> trials) {
    const auto layout = laid_out(trials);
    if (!layout) return layout.error();
    std::vector<double> all(layout->numbers);
    for (std::size_t i = 0; i < trials.size(); ++i) write_start(trials[i], layout->places[i], all.data());
    if (const auto room = scratch.reserve(layout->scratch * sizeof(double)); !room) return room;
    if (const auto written = numbers.write(all.data(), all.size() * sizeof(double)); !written) return written;
    std::vector<on_device::Problem> launched;
    for (std::size_t i = 0; i < trials.size(); ++i) launched.push_back(problem_of(trials[i], layout->places[i]));
    if (const auto done = launch(task, launched); !done) return done;
    if (const auto done = numbers.read(all.data(), all.size() * sizeof(double)); !done) return done;
    for (std::size_t i = 0; i < trials.size(); ++i) read_results(task, all.data(), layout->places[i], trials[i]);
    return Done{};
}

// Up to half of the memory that is free is for their scratch memory, some hundred kilobytes to 3 MiB each.
Result<std::size_t> DeviceSolver::State::together(std::span<const Trial> trials) const {
    std::size_t available = k_emulated_scratch;
    if (is_cuda) {
        if (const auto known = checked(on_device::free_memory(available)); !known) return known.error();
        available = (available + scratch.bytes()) / 2;
    }
    std::size_t count = 0, bytes = 0;
    for (; count < std::min(trials.size(), k_blocks); ++count) {
        bytes += on_device::Memory::doubles(shape_of(trials[count].lobes)) * sizeof(double);
        if (count > 0 && bytes > available) break;
    }
    return count;
}

Result<Done> DeviceSolver::State::run_all(Task task, std::span<Trial> trials) {
    while (!trials.empty()) {
        const auto count = together(trials);
        if (!count) return count.error();
        if (const auto done = run(task, trials.first(*count)); !done) return done;
        trials = trials.subspan(*count);
    }
    return Done{};
}

Result<Done> DeviceSolver::optimise(std::span<Trial> trials) { return state_->run_all(Task::optimise, trials); }
Result<Done> DeviceSolver::best_additions(std::span<Trial> trials) { return state_->run_all(Task::gains, trials); }

}  // namespace srbf
