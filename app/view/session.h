// What the window knows and does, without a window: subjects, the fit on display, and the work behind it.
#pragma once
#include <array>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/load.h"
#include "app/report.h"
#include "srbf/fitting.h"

namespace srbf {

/// What the sliders ask a fit for.
struct FitChoice {
    PmForm form = PmRequest{}.form;
    int lobes = LobeCount{}.lobes, variates = PmRequest{}.variates;
    Objective objective = FitRequest{}.objective;
    FitRequest request() const;  ///< all else as `srbf fit` has it by default
    friend bool operator==(const FitChoice&, const FitChoice&) = default;
};
inline constexpr int k_most_chosen_lobes = 24;  ///< that a slider goes to: beyond, a fit takes longer than one waits

/// How far the work behind the window is.
enum class Stage {
    idle,
    fitting,    ///< nothing of this choice is on display yet
    refining,   ///< a quick fit is
    measuring,  ///< the fit is as it will be; its errors are not all known
};

/// The BRDF that is on display as the fit, and what is known of it.
struct Fitted {
    Model model;
    FitChoice choice;    ///< that it was fitted for; for a file's model the objective alone means something
    std::string from;    ///< the file that it was read from; empty: fitted here
    bool quick = false;  ///< a finer one is on its way
    double seconds = 0;  ///< from the choice until it was there
    std::optional<StopReason> stop;
    std::optional<Comparison> errors;  ///< against the reference, once they are known
};

/// Subjects, of which one is the reference; a fit that follows the choice in the background. All members are called from one thread, the
/// window's; the work is another's, and what it has found shows after `poll`.
class Session {
  public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Adds a file's subject. One that cannot be read becomes a message. The first measurement becomes the reference, and a first model what is
    /// shown as the fit; without a model the reference is fitted.
    bool open(const std::string& path);
    const std::vector<std::shared_ptr<const Subject>>& subjects() const { return subjects_; }

    /// The subject that fits are held against; −1: there is none.
    int reference() const { return reference_; }
    void set_reference(int subject);
    /// Shows a model that was read, or fits the reference again by the choice.
    void show_model(int subject);
    void refit();
    /// Asks for another fit; work under way for an older choice is given up.
    void choose(const FitChoice& choice);
    const FitChoice& choice() const { return choice_; }
    /// Gives up what is under way; what is on display stays.
    void cancel();

    /// Takes what the work has brought; true where the fit on display is another one since.
    bool poll();
    Stage stage() const { return stage_; }
    double fraction() const;                                                          ///< of the fit under way, 0..1
    double waited() const { return stage_ == Stage::idle ? 0 : waiting_.seconds(); }  ///< [s] since it was asked for
    /// What is shown as the fit; none before the first one is there.
    const std::optional<Fitted>& fitted() const { return fitted_; }
    /// θmax of the errors [rad].
    double max_theta() const { return default_max_theta(choice_.objective); }

    /// Writes the fit on display; a message tells how it went.
    bool save(const std::string& path);

    /// What there is to say, newest last.
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
        std::optional<Model> model;  ///< to be measured alone
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
    std::vector<Message> messages_;
    Stage stage_ = Stage::idle;
    Stopwatch waiting_;
    int asked_ = 0;  ///< the number of the job that was asked for last
    std::unique_ptr<Worker> worker_;
};

}  // namespace srbf
