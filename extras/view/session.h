// State and actions of the window, independent of it: subjects, the displayed fit, and the background work.
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
#include "srbf/fit.h"

namespace srbf {

/// The fit that the sliders request.
struct FitChoice {
    PmForm form = PmRequest{}.form;
    int lobes = LobeCount{}.lobes, variates = PmRequest{}.variates;
    Objective objective = FitRequest{}.objective;
    FitRequest request() const;  ///< everything else as by default in `srbf fit`
    friend bool operator==(const FitChoice&, const FitChoice&) = default;
};
/// limit of a slider; a fit with more lobes takes longer than one waits
inline constexpr int k_most_chosen_lobes = 24;

/// State of the background work.
enum class Stage {
    idle,
    fitting,    ///< nothing for this choice is displayed yet
    refining,   ///< a quick fit is displayed
    measuring,  ///< the fit is final; its errors are not complete
};

/// The BRDF displayed as the fit.
struct Fitted {
    Model model;
    FitChoice choice;    ///< of the fit; for a model from a file only the objective is meaningful
    std::string from;    ///< the file of the model; empty: fitted here
    bool quick = false;  ///< a more accurate fit will follow
    double seconds = 0;  ///< from the choice until the fit was complete
    std::optional<StopReason> stop;
    std::optional<Comparison> errors;  ///< against the reference, once they are known
};

/// Subjects, one of which is the reference, and a fit that follows the choice in the background. All members are called
/// from the window's thread; the work runs on another thread, and its results become visible in `poll`.
class Session {
  public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Adds a file's subject. A file that cannot be read becomes a message. The first measurement becomes the
    /// reference, the first model the displayed fit; without a model the reference is fitted.
    bool open(const std::string& path);
    const std::vector<std::shared_ptr<const Subject>>& subjects() const { return subjects_; }

    /// The subject with which fits are compared; −1: none.
    int reference() const { return reference_; }
    void set_reference(int subject);
    /// Displays a model from a file, or fits the reference again with the choice.
    void show_model(int subject);
    void refit();
    /// Requests another fit; work for an older choice is cancelled.
    void choose(const FitChoice& choice);
    const FitChoice& choice() const { return choice_; }
    /// Cancels the work; the display does not change.
    void cancel();

    /// Takes over results of the work; returns true if the displayed fit has changed.
    bool poll();
    Stage stage() const { return stage_; }
    double fraction() const;                                                          ///< of the current fit, 0..1
    double waited() const { return stage_ == Stage::idle ? 0 : waiting_.seconds(); }  ///< [s] since it was requested
    /// The displayed fit; none before the first one is complete.
    const std::optional<Fitted>& fitted() const { return fitted_; }
    /// θmax of the errors [rad].
    double max_theta() const { return default_max_theta(choice_.objective); }

    /// Writes the displayed fit; a message reports the result.
    bool save(const std::string& path);

    /// Messages, newest last.
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
        std::shared_ptr<const Subject> reference;
        FitChoice choice;
        std::optional<Model> model;  ///< to be measured only
        Stopwatch asked;
    };
    struct News {
        int number = 0;
        Stage stage = Stage::idle;
        std::optional<Fitted> fitted;
        std::optional<Error> error;
    };
    class Worker;

    void ask(std::optional<Model> model);

    std::vector<std::shared_ptr<const Subject>> subjects_;
    int reference_ = -1;
    FitChoice choice_;
    std::optional<Fitted> fitted_;
    bool is_shown_anew_ = false;  ///< it was replaced by `show_model` since the last `poll`
    std::vector<Message> messages_;
    Stage stage_ = Stage::idle;
    Stopwatch waiting_;
    int asked_ = 0;  ///< number of the last requested job
    std::unique_ptr<Worker> worker_;
};

}  // namespace srbf
