// The state and actions of the window, independent of it: subjects, the displayed fit, and background work.
#pragma once
#include <array>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/load.h"
#include "app/output.h"
#include "srbf/edit.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {

/// The choice of a fit by the sliders.
struct FitChoice {
    PmForm form = k_default_form;
    int lobes = row_of(k_default_form).lobes, variates = row_of(k_default_form).variates;
    Objective objective = FitRequest{}.objective;
    FitRequest request() const;  ///< everything else has the defaults of `srbf fit`
    friend bool operator==(const FitChoice&, const FitChoice&) = default;
};
/// Upper limit of a slider. Fits with more lobes take too long for interaction.
inline constexpr int k_most_chosen_lobes = 24;

/// The choice of edits by the sliders. A warmth of ±1 multiplies red by 2^±1 and blue by the inverse, at the same
/// luminance.
struct EditChoice {
    float roughness = 1, highlight = 1, highlight_warmth = 0, body = 1, body_warmth = 0, saturation = 1, hue = 0;
    std::vector<Edit> edits() const;  ///< those that change something
    friend bool operator==(const EditChoice&, const EditChoice&) = default;
};

/// State of the background work.
enum class Stage {
    idle,
    editing,    ///< another edit of the fit
    fitting,    ///< nothing for this choice is displayed yet
    refining,   ///< a quick fit is displayed
    measuring,  ///< the fit is final; its errors are not complete
};

/// The BRDF displayed as the fit.
struct Fitted {
    Model model;
    FitChoice choice;    ///< the choice of the fit; for a model from a file, only the objective is meaningful
    std::string from;    ///< the file of the model; empty: fitted in this session
    bool quick = false;  ///< true if a more accurate fit will follow
    double seconds = 0;  ///< time from the choice until the fit was complete
    std::optional<StopReason> stop;
    std::optional<Comparison> errors;  ///< compared with the reference; none until they are evaluated, or if edited
    EditChoice edit;                   ///< what was done to the fit
};

/// The open subjects, one of which is the reference, and a fit that follows the choice in the background. All
/// members are called on the window's thread. The work runs on another thread; `poll` makes its results visible.
class Session {
  public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Opens a file. A file that cannot be read becomes a message. The first measurement becomes the reference, the
    /// first model the displayed fit. Without a model the reference is fitted.
    bool open(const std::string& path);
    const std::vector<std::shared_ptr<const Subject>>& subjects() const { return subjects_; }

    /// The subject with which fits are compared; −1: none.
    int reference() const { return reference_; }
    void set_reference(int subject);
    /// `show_model` displays a model from a file; `refit` fits the reference again with the choice.
    void show_model(int subject);
    void refit();
    /// Requests another fit. Work on older choices is cancelled.
    void choose(const FitChoice& choice);
    const FitChoice& choice() const { return choice_; }
    /// Displays the fit with these edits instead of earlier ones. Another fit, reference or model has no edits.
    void edit(const EditChoice& choice);
    const EditChoice& edit_choice() const { return edit_; }
    bool can_edit() const;  ///< a multivariate model is displayed that will not be replaced by a better fit
    /// Cancels the work. The display does not change.
    void cancel();

    /// Receives results of the work. Returns true if the displayed fit has changed.
    bool poll();
    Stage stage() const { return stage_; }
    double fraction() const;  ///< progress of the current fit, 0..1
    double waited() const { return stage_ == Stage::idle ? 0 : clock_.seconds(); }  ///< time since its request [s]
    /// The displayed fit; none before the first one is complete.
    const std::optional<Fitted>& fitted() const { return fitted_; }
    /// θmax of the errors [rad].
    double max_theta() const { return default_max_theta(choice_.objective); }

    /// Writes the displayed fit; a message reports the result.
    bool save(const std::string& path);

    /// The messages, newest last.
    struct Message {
        std::string text;
        bool is_error = false;
    };
    const std::vector<Message>& messages() const { return messages_; }
    void say(std::string text) { messages_.push_back({std::move(text), false}); }
    void complain(const Error& error) { messages_.push_back({message(error), true}); }

  private:
    struct Job {
        int number = 0;
        std::shared_ptr<const Subject> reference = {};
        FitChoice choice = {};
        std::optional<Model> model = {};      ///< set if only errors are evaluated
        std::optional<Fitted> unedited = {};  ///< set if it is edited
        EditChoice edit = {};
        Stopwatch clock = {};
    };
    struct Update {
        int number = 0;
        Stage stage = Stage::idle;
        std::optional<Fitted> fitted;
        std::optional<Error> error;
    };
    class Worker;

    void submit(std::optional<Model> model);
    void submit(Job job, Stage stage);

    std::vector<std::shared_ptr<const Subject>> subjects_;
    int reference_ = -1;
    FitChoice choice_;
    std::optional<Fitted> fitted_;
    std::optional<Fitted> unedited_;  ///< set while an edited model is displayed or computed
    EditChoice edit_;
    bool is_replaced_ = false;  ///< true if `show_model` has replaced the fit since the last `poll`
    std::vector<Message> messages_;
    Stage stage_ = Stage::idle;
    Stopwatch clock_;
    int last_job_ = 0;  ///< number of the last requested job
    std::unique_ptr<Worker> worker_;
};

}  // namespace srbf
