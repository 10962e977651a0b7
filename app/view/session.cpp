#include "app/view/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>

#include "srbf/file.h"
#include "srbf/fit_samples.h"

namespace srbf {
namespace {

/// Fits before the one that `srbf fit` makes: shown while the next one is under way, so that one sees at once what a slider does.
struct Quick {
    std::size_t pairs;  ///< it looks at
    int starts, kicks;
};
constexpr Quick k_quick[] = {{4096, 3, 0}, {16384, 4, 8}};

}  // namespace

/// The thread that works: one job at a time, the newest.
class Session::Worker {
  public:
    Worker() : thread_([this](std::stop_token stop) { work(stop); }) {}
    ~Worker() {
        newest_ = -1;  // what is under way is given up
        thread_.request_stop();
    }

    void ask(Job job) {
        const std::scoped_lock lock(mutex_);
        newest_ = job.number;
        next_ = std::move(job);
        wake_.notify_all();
    }
    void cancel(int number) {
        const std::scoped_lock lock(mutex_);
        newest_ = number;
        next_.reset();
    }
    std::vector<News> take() {
        const std::scoped_lock lock(mutex_);
        return std::exchange(news_, {});
    }
    double fraction() const { return fraction_; }

  private:
    /// What a fit needs to know of a subject, found once for each.
    struct Known {
        std::optional<bool> isotropic;
        std::map<Objective, Observations> observations;
        std::map<Objective, SampleObservations> samples;
    };

    void work(std::stop_token stop) {
        for (;;) {
            std::optional<Job> job;
            {
                std::unique_lock lock(mutex_);
                if (!wake_.wait(lock, stop, [&] { return next_.has_value(); })) return;
                std::swap(job, next_);
            }
            do_job(*job);
            tell({job->number, Stage::idle, {}, {}});
        }
    }
    bool goes_on(const Job& job) const { return newest_ == job.number; }
    void tell(News news) {
        const std::scoped_lock lock(mutex_);
        news_.push_back(std::move(news));
    }

    void do_job(const Job& job) {
        fraction_ = 0;
        Fitted fitted;
        fitted.choice = job.choice;
        if (job.model) {
            fitted.model = *job.model;
        } else {
            tell({job.number, Stage::fitting, {}, {}});
            const auto done = fit(job, fitted);
            if (!done) return tell({job.number, Stage::idle, {}, done.error()});
            if (!goes_on(job)) return;
        }
        tell({job.number, Stage::measuring, fitted, {}});
        measure(job, fitted);
    }

    /// Fits the reference better and better, telling of each but the last.
    Result<Done> fit(const Job& job, Fitted& fitted) {
        Known& known = known_[job.reference.get()];
        const Objective objective = job.choice.objective;
        FitOptions options;
        options.form = job.choice.form;
        options.lobes = job.choice.lobes;
        options.variates = job.choice.variates;
        const ProgressCallback progress = [&](const Progress& now) {
            fraction_ = now.fraction;
            return goes_on(job);
        };
        const auto take = [&](Result<PmFit>&& fit, bool quick) -> Result<Done> {
            if (!fit) return fit.error();
            fitted.quick = quick;
            fitted.seconds = job.asked.seconds();
            fitted.stop = fit->stop;
            fitted.model.model = std::move(fit->model);
            fitted.model.provenance = {{"source", std::filesystem::path(job.reference->path).filename().string()},
                                       {"generator", "srbf " SRBF_VERSION},
                                       {"objective", std::string(name(objective))},
                                       {"max_theta", fmt::format("{}", default_max_theta(objective) / k_degree)}};
            if (quick && goes_on(job)) tell({job.number, Stage::refining, fitted, {}});
            return Done{};
        };

        const Measured* measured = std::get_if<Measured>(&job.reference->content);
        if (const auto* samples = measured ? std::get_if<Scattered>(&measured->table) : nullptr) {
            options.axial = samples->isotropic;
            if (!known.samples.contains(objective)) {
                auto observed = observe(*samples, ObserveSamplesOptions{.objective = objective});
                if (!observed) return observed.error();
                known.samples.emplace(objective, *std::move(observed));
            }
            return take(fit_pm(known.samples.at(objective), {options, true}, progress), false);
        }
        const Evaluate f = measured ? signed_evaluator(*measured) : evaluator(*job.reference);
        if (!known.isotropic) known.isotropic = srbf::is_isotropic(f, default_max_theta(objective));
        options.axial = *known.isotropic;
        if (!known.observations.contains(objective)) {
            auto observed = observe(f, {.objective = objective});
            if (!observed) return observed.error();
            known.observations.emplace(objective, *std::move(observed));
        }
        if (!goes_on(job)) return Done{};
        const Observations& observations = known.observations.at(objective);
        for (const Quick& quick : k_quick) {
            FitOptions in_short = options;
            in_short.starts = quick.starts;
            in_short.kicks = quick.kicks;
            const auto done = take(fit_pm(beginning(observations, quick.pairs), in_short, progress), true);
            if (!done || !goes_on(job)) return done;
        }
        return take(fit_pm(observations, options, progress), false);
    }

    /// The errors, those first that are known soonest.
    void measure(const Job& job, Fitted& fitted) {
        const MeasureOptions options{default_max_theta(job.choice.objective), 0};
        const Evaluate reference = evaluator(*job.reference), others[] = {evaluator(fitted.model)};
        const auto tell_measures = [&] { tell({job.number, Stage::measuring, fitted, {}}); };
        if (!goes_on(job)) return;
        fitted.heldout = measure_heldout(reference, others, options)[0];
        tell_measures();
        if (!goes_on(job)) return;
        fitted.albedo_error = albedo_error(reference, others[0], options.max_theta);
        tell_measures();
        if (!goes_on(job)) return;
        fitted.matrix =
            measure_matrix(reference, others, options, matrix_directions(fitted.model, options.max_theta))[0];
        tell_measures();
    }

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::optional<Job> next_;
    std::vector<News> news_;
    std::atomic<int> newest_ = 0;
    std::atomic<double> fraction_ = 0;
    std::map<const Subject*, Known> known_;  // subjects live as long as the session
    std::jthread thread_;                    // the last member: it ends before what it works with
};

Session::Session() : worker_(std::make_unique<Worker>()) {}
Session::~Session() = default;

bool Session::open(const std::string& path) {
    auto loaded = load(path);
    if (!loaded) return complain(loaded.error()), false;
    subjects_.push_back(std::make_shared<const Subject>(*std::move(loaded)));
    const int added = int(subjects_.size()) - 1;
    const bool is_model = subjects_.back()->is_model();
    const bool had_measurement = reference_ >= 0 && !subjects_[std::size_t(reference_)]->is_model();
    if (is_model && had_measurement) {
        if (!fitted_ || fitted_->from.empty()) show_model(added);
    } else if (reference_ < 0) {
        set_reference(added);
    } else if (!is_model && !had_measurement) {
        // The models came first: they are what this one is held against.
        const int shown = reference_;
        reference_ = added;
        show_model(shown);
    }
    return true;
}

void Session::set_reference(int subject) {
    reference_ = subject;
    fitted_.reset();
    refit();
}

void Session::refit() {
    if (reference_ >= 0) ask({});
}

void Session::show_model(int subject) {
    const auto& model = std::get<Model>(subjects_[std::size_t(subject)]->content);
    // Its errors are those of what it was fitted for, where it tells.
    if (const auto told = model.provenance.find("objective"); told != model.provenance.end())
        if (const auto objective = objective_named(told->second)) choice_.objective = *objective;
    if (const auto* pm = std::get_if<PmModel>(&model.model)) {
        choice_.form = pm->form;
        choice_.lobes = std::min(pm->lobes, k_most_chosen_lobes);
        choice_.variates = pm->variates;
    }
    ask(model);
    fitted_ = Fitted{model, choice_, subjects_[std::size_t(subject)]->path, false, 0, {}, {}, {}, {}};
}

void Session::choose(const FitChoice& choice) {
    choice_ = choice;
    choice_.lobes = std::clamp(choice.lobes, 1, k_most_chosen_lobes);
    choice_.variates = std::clamp(choice.variates, 1, k_most_variates);
    refit();
}

void Session::ask(std::optional<Model> model) {
    waiting_ = {};
    stage_ = model ? Stage::measuring : Stage::fitting;
    worker_->ask({++asked_, subjects_[std::size_t(reference_)], choice_, std::move(model), waiting_});
}

void Session::cancel() {
    if (stage_ == Stage::idle) return;
    worker_->cancel(++asked_);
    say(stage_ == Stage::measuring ? "Measuring was cancelled." : "The fit was cancelled.");
    stage_ = Stage::idle;
}

bool Session::poll() {
    bool swapped = false;
    for (News& news : worker_->take()) {
        if (news.number != asked_) continue;  // of a choice that is not wanted any more
        stage_ = news.stage;
        if (news.error) complain(*news.error);
        if (!news.fitted) continue;
        if (fitted_ && !fitted_->from.empty() && news.stage == Stage::measuring) news.fitted->from = fitted_->from;
        const bool same = fitted_ && news.fitted->seconds == fitted_->seconds && news.fitted->quick == fitted_->quick &&
                          news.fitted->from == fitted_->from;
        fitted_ = std::move(news.fitted);
        swapped = swapped || !same;
    }
    return swapped;
}

double Session::fraction() const { return worker_->fraction(); }

bool Session::save(const std::string& path) {
    if (!fitted_) return complain({path, {}, "model to save", "one", "none yet"}), false;
    const auto saved = save_model(fitted_->model, path);
    if (!saved) return complain(saved.error()), false;
    say(fmt::format("Wrote {}, {} bytes of numbers{}.", path, payload_bytes(fitted_->model),
                    fitted_->quick ? " (a quick fit: a finer one is on its way)" : ""));
    return true;
}

}  // namespace srbf
