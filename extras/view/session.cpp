#include "extras/view/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <utility>

#include "fit/fit_options.h"
#include "srbf/file.h"
#include "srbf/fit_bsdf.h"

namespace srbf {
/// The worker thread: one job at a time, the newest.
class Session::Worker {
  public:
    Worker() : thread_([this](std::stop_token stop) { work(stop); }) {}
    ~Worker() {
        newest_ = -1;  // cancels the current job
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
        const ProgressToken progress = [&](const Progress& now) {
            fraction_ = now.fraction;
            return goes_on(job);
        };
        const FitRequest request = job.choice.request();
        Fitted fitted;
        fitted.choice = job.choice;
        FitOutcome outcome;
        if (job.model) {
            outcome.model = outcome.unrounded = *job.model;
        } else {
            tell({job.number, Stage::fitting, {}, {}});
            auto found = fit(job, request, fitted, progress.part(0, 0.75));
            if (!found) {
                if (found.error().code == ErrorCode::cancelled) return;
                return tell({job.number, Stage::idle, {}, found.error()});
            }
            outcome = *std::move(found);
        }
        take(job, outcome, fitted);
        tell({job.number, Stage::measuring, fitted, {}});
        if (!fitter(job).measure(outcome, request, progress.part(0.75, 1))) return;
        take(job, outcome, fitted);
        tell({job.number, Stage::measuring, fitted, {}});
    }

    /// Keeps what is known of the reference for its next fit.
    Fitter& fitter(const Job& job) {
        const Subject& reference = *job.reference;
        const auto at = fitters_.find(&reference);
        if (at != fitters_.end()) return at->second;
        const Measured* measured = std::get_if<Measured>(&reference.content);
        return fitters_.emplace(&reference, measured ? Fitter(*measured) : Fitter(evaluator(reference))).first->second;
    }

    /// Fits the reference with increasing effort, and reports each fit but the last.
    Result<FitOutcome> fit(const Job& job, const FitRequest& request, Fitted& fitted, const ProgressToken& progress) {
        if (const auto* measured = std::get_if<Measured>(&job.reference->content);
            measured && std::holds_alternative<BsdfTable>(measured->table)) {
            auto sides = fit_bsdf(*measured, request, progress);
            if (!sides) return sides.error();
            fitted.seconds = job.asked.seconds();
            FitOutcome outcome;
            outcome.model = outcome.unrounded = std::move(sides->model);
            return outcome;
        }
        for (int draft = 0; draft < Fitter::k_drafts; ++draft) {
            auto quick = fitter(job).draft(request, draft, progress.part(0.1 * draft, 0.1 * (draft + 1)));
            if (!quick) return quick;
            take(job, *quick, fitted);
            fitted.quick = true;
            fitted.seconds = job.asked.seconds();
            tell({job.number, Stage::refining, fitted, {}});
        }
        auto whole = fitter(job).fit(request, progress.part(0.2, 1));
        fitted.quick = false;
        fitted.seconds = job.asked.seconds();
        return whole;
    }

    static void take(const Job& job, const FitOutcome& outcome, Fitted& fitted) {
        fitted.model = outcome.model;
        if (!job.model)
            fitted.model.provenance["source"] = std::filesystem::path(job.reference->path).filename().string();
        fitted.stop = outcome.stop;
        fitted.errors = outcome.errors;
    }

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::optional<Job> next_;
    std::vector<News> news_;
    std::atomic<int> newest_ = 0;
    std::atomic<double> fraction_ = 0;
    std::map<const Subject*, Fitter> fitters_;  // subjects live as long as the session
    std::jthread thread_;                       // last member: it ends before the data it uses
};

FitRequest FitChoice::request() const {
    return *fit_request({{"form", std::string(name(form))},
                         {"variates", std::to_string(variates)},
                         {"lobes", std::to_string(lobes)},
                         {"objective", std::string(name(objective))}});
}

Session::Session() : worker_(std::make_unique<Worker>()) {}
Session::~Session() = default;

bool Session::open(const std::string& path) {
    auto loaded = load_subject(path);
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
        // The models came first: they are compared with this one.
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
    // Its errors are by the objective of its fit, if it has that metadata.
    if (const auto told = model.provenance.find("objective"); told != model.provenance.end())
        if (const auto objective = objective_named(told->second)) choice_.objective = *objective;
    if (const auto* pm = std::get_if<PmModel>(&model.model)) {
        choice_.form = pm->form;
        choice_.lobes = std::min(pm->lobes, k_most_chosen_lobes);
        choice_.variates = pm->variates;
    }
    ask(model);
    fitted_ = Fitted{model, choice_, subjects_[std::size_t(subject)]->path, false, 0, {}, {}};
    is_shown_anew_ = true;
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
    bool swapped = std::exchange(is_shown_anew_, false);
    for (News& news : worker_->take()) {
        if (news.number != asked_) continue;  // for an outdated choice
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
