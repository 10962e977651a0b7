#include "extras/view/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <utility>

#include "brdf/colour.h"
#include "brdf/values.h"
#include "fit/fit_options.h"
#include "observe/objectives.h"
#include "srbf/file.h"
#include "srbf/fit_bsdf.h"

namespace SRBF_NAMESPACE {
/// The worker thread. It runs one job at a time, always the newest.
class Session::Worker {
  public:
    Worker() : thread_([this](std::stop_token stop) { work(stop); }) {}
    ~Worker() {
        newest_ = -1;  // cancels the current job
        thread_.request_stop();
    }

    void submit(Job job) {
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
    std::vector<Update> take() {
        const std::scoped_lock lock(mutex_);
        return std::exchange(updates_, {});
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
            job->unedited ? edit(*job) : do_job(*job);
            report({job->number, Stage::idle, {}, {}});
        }
    }
    bool is_current(const Job& job) const { return newest_ == job.number; }
    void report(Update update) {
        const std::scoped_lock lock(mutex_);
        updates_.push_back(std::move(update));
    }

    /// The progress of a job that begins, cancelled by newer ones.
    ProgressToken progress_of(const Job& job) {
        fraction_ = 0;
        return [&](const Progress& now) {
            fraction_ = now.fraction;
            return is_current(job);
        };
    }

    void do_job(const Job& job) {
        const ProgressToken progress = progress_of(job);
        const FitRequest request = job.choice.request();
        Fitted fitted;
        fitted.choice = job.choice;
        FitOutcome outcome;
        if (job.model) {
            outcome.model = outcome.unrounded = *job.model;
        } else {
            report({job.number, Stage::fitting, {}, {}});
            auto fit_outcome = fit(job, request, fitted, progress.part(0, 0.75));
            if (!fit_outcome) {
                if (fit_outcome.error().code == ErrorCode::cancelled) return;
                return report({job.number, Stage::idle, {}, fit_outcome.error()});
            }
            outcome = *std::move(fit_outcome);
        }
        set_outcome(job, outcome, fitted);
        report({job.number, Stage::measuring, fitted, {}});
        if (!fitter(job).measure(outcome, request, progress.part(0.75, 1))) return;
        set_outcome(job, outcome, fitted);
        report({job.number, Stage::measuring, fitted, {}});
    }

    void edit(const Job& job) {
        auto model = edited(job.unedited->model, job.edit.edits(), {.progress = progress_of(job)});
        if (!model) {
            if (model.error().code != ErrorCode::cancelled) report({job.number, Stage::idle, {}, model.error()});
            return;
        }
        Fitted fitted = *job.unedited;
        fitted.model = *std::move(model), fitted.edit = job.edit;
        fitted.errors.reset();
        report({job.number, Stage::editing, fitted, {}});
    }

    /// The fitter of the reference, kept because later fits reuse its observations.
    Fitter& fitter(const Job& job) {
        const Subject& reference = *job.reference;
        const auto entry = fitters_.find(&reference);
        if (entry != fitters_.end()) return entry->second;
        const Measured* measured = std::get_if<Measured>(&reference.content);
        return fitters_.emplace(&reference, measured ? Fitter(*measured) : Fitter(evaluator(reference))).first->second;
    }

    /// Fits the reference with increasing effort, and reports each fit except the last.
    Result<FitOutcome> fit(const Job& job, const FitRequest& request, Fitted& fitted, const ProgressToken& progress) {
        if (const auto* measured = std::get_if<Measured>(&job.reference->content);
            measured && std::holds_alternative<BsdfTable>(measured->table)) {
            auto sides = fit_bsdf(*measured, request, progress);
            if (!sides) return sides.error();
            fitted.seconds = job.clock.seconds();
            FitOutcome outcome;
            outcome.model = outcome.unrounded = std::move(sides->model);
            return outcome;
        }
        for (int draft = 0; draft < Fitter::k_drafts; ++draft) {
            auto quick = fitter(job).draft(request, draft, progress.part(0.1 * draft, 0.1 * (draft + 1)));
            if (!quick) return quick;
            set_outcome(job, *quick, fitted);
            fitted.quick = true;
            fitted.seconds = job.clock.seconds();
            report({job.number, Stage::refining, fitted, {}});
        }
        auto whole = fitter(job).fit(request, progress.part(0.2, 1));
        fitted.quick = false;
        fitted.seconds = job.clock.seconds();
        return whole;
    }

    static void set_outcome(const Job& job, const FitOutcome& outcome, Fitted& fitted) {
        fitted.model = outcome.model;
        if (!job.model)
            fitted.model.provenance["source"] = std::filesystem::path(job.reference->path).filename().string();
        fitted.stop = outcome.stop;
        fitted.errors = outcome.errors;
    }

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::optional<Job> next_;
    std::vector<Update> updates_;
    std::atomic<int> newest_ = 0;
    std::atomic<double> fraction_ = 0;
    std::map<const Subject*, Fitter> fitters_;  // subjects live as long as the session
    std::jthread thread_;                       // the last member, so that it ends before the data it uses
};

FitRequest FitChoice::request() const {
    return *fit_request({{"form", std::string(name(form))},
                         {"variates", std::to_string(variates)},
                         {"lobes", std::to_string(lobes)},
                         {"objective", std::string(name(objective))}});
}

std::vector<Edit> EditChoice::edits() const {
    const auto tint = [](float factor, float warmth) {
        const Rgb colour{std::exp2(warmth), 1, std::exp2(-warmth)};
        return scaled(float(double(factor) / luminance(colour)), colour);
    };
    std::vector<Edit> edits;
    const EditChoice none;
    if (roughness != none.roughness) edits.emplace_back(Roughen{double(roughness)});
    const Tint tints{tint(highlight, highlight_warmth), tint(body, body_warmth)};
    const bool is_tinted =
        highlight != none.highlight || highlight_warmth != 0 || body != none.body || body_warmth != 0;
    if (is_tinted) edits.emplace_back(tints);
    if (saturation != none.saturation) edits.emplace_back(Saturate{double(saturation)});
    if (hue != none.hue) edits.emplace_back(TurnHue{double(hue)});
    return edits;
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
        // The models came first and are now compared with this measurement.
        const int model = reference_;
        reference_ = added;
        show_model(model);
    }
    return true;
}

void Session::set_reference(int subject) {
    reference_ = subject;
    fitted_.reset();
    refit();
}

void Session::refit() {
    if (reference_ >= 0) submit({});
}

void Session::show_model(int subject) {
    const auto& model = std::get<Model>(subjects_[std::size_t(subject)]->content);
    // Its errors use the objective of its fit, if the provenance states it.
    if (const auto entry = model.provenance.find("objective"); entry != model.provenance.end())
        if (const auto objective = objective_named(entry->second)) choice_.objective = *objective;
    if (const auto* pm = std::get_if<PmModel>(&model.model)) {
        choice_.form = pm->form;
        choice_.lobes = std::min(pm->lobes, k_most_chosen_lobes);
        choice_.variates = pm->variates;
    }
    submit(model);
    fitted_ = Fitted{model, choice_, subjects_[std::size_t(subject)]->path, false, 0, {}, {}, {}};
    is_replaced_ = true;
}

void Session::choose(const FitChoice& choice) {
    choice_ = choice;
    choice_.lobes = std::clamp(choice.lobes, 1, k_most_chosen_lobes);
    choice_.variates = std::clamp(choice.variates, 1, k_most_variates);
    refit();
}

void Session::submit(std::optional<Model> model) {
    unedited_.reset(), edit_ = {};
    const Stage stage = model ? Stage::measuring : Stage::fitting;
    submit({.choice = choice_, .model = std::move(model)}, stage);
}
void Session::submit(Job job, Stage stage) {
    clock_ = {}, stage_ = stage;
    job.number = ++last_job_, job.reference = subjects_[std::size_t(reference_)], job.clock = clock_;
    worker_->submit(std::move(job));
}

bool Session::can_edit() const {
    return fitted_ && !fitted_->quick && std::holds_alternative<PmModel>(fitted_->model.model) &&
           (stage_ == Stage::idle || stage_ == Stage::measuring || stage_ == Stage::editing);
}

void Session::edit(const EditChoice& choice) {
    if (!can_edit() || choice == edit_) return;
    if (!unedited_) unedited_ = fitted_;
    edit_ = choice;
    if (choice != EditChoice{})
        return submit({.choice = choice_, .unedited = unedited_, .edit = choice}, Stage::editing);
    fitted_ = std::exchange(unedited_, {});
    is_replaced_ = true;
    if (!fitted_->errors) return submit({.choice = choice_, .model = fitted_->model}, Stage::measuring);
    worker_->cancel(++last_job_);
    stage_ = Stage::idle;
}

void Session::cancel() {
    if (stage_ == Stage::idle) return;
    worker_->cancel(++last_job_);
    say(stage_ == Stage::measuring ? "Measuring was cancelled."
        : stage_ == Stage::editing ? "The edit was cancelled."
                                   : "The fit was cancelled.");
    if (stage_ == Stage::editing) edit_ = fitted_->edit;
    stage_ = Stage::idle;
}

bool Session::poll() {
    bool is_new = std::exchange(is_replaced_, false);
    for (Update& update : worker_->take()) {
        if (update.number != last_job_) continue;  // from an outdated job
        stage_ = update.stage;
        if (update.error) complain(*update.error);
        if (!update.fitted) continue;
        if (fitted_ && !fitted_->from.empty() && update.stage == Stage::measuring) update.fitted->from = fitted_->from;
        const bool is_same = fitted_ && update.fitted->seconds == fitted_->seconds &&
                             update.fitted->quick == fitted_->quick && update.fitted->from == fitted_->from &&
                             update.fitted->edit == fitted_->edit;
        fitted_ = std::move(update.fitted);
        is_new = is_new || !is_same;
    }
    return is_new;
}

double Session::fraction() const { return worker_->fraction(); }

bool Session::save(const std::string& path) {
    if (!fitted_) return complain({path, {}, "model to save", "one", "none yet"}), false;
    const auto saved = save_model(fitted_->model, path);
    if (!saved) return complain(saved.error()), false;
    say(fmt::format("Wrote {}, {} bytes of numbers{}.", path, payload_bytes(fitted_->model),
                    fitted_->quick ? " (a quick fit; the final one follows)" : ""));
    return true;
}

}  // namespace srbf
