// The window's session, tested without a window: fits follow the choice, replace each other and can be cancelled;
// files that cannot be read become messages. Also the window itself, on a virtual screen.
#include <sys/wait.h>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <chrono>
#include <thread>

#include "brdf/channels.h"
#include "errors/measures.h"
#include "extras/view/display_state.h"
#include "extras/view/ink.h"
#include "extras/view/lobes.h"
#include "extras/view/opening.h"
#include "extras/view/readings.h"
#include "extras/view/session.h"
#include "models.h"
#include "models/kind/parameters.h"
#include "observe/objectives.h"
#include "program.h"
#include "properties.h"
#include "srbf/metrics.h"

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace srbf::view_test {
namespace {

const std::string k_film = (bundled_data() / "cc_ibiza_sunset_rgb.bsdf").string();
constexpr FitChoice k_small{PmForm::horizon, 2, 2, Objective::raw};

/// Polls until `enough()`, for an hour at most. Returns false if the time ran out.
template <typename Enough> bool wait(Session& session, const Enough& enough) {
    for (int i = 0; i < 360000; ++i) {
        session.poll();
        if (enough()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}
bool wait_until_idle(Session& session) {
    return wait(session, [&] { return session.stage() == Stage::idle; });
}

TEST(Session, AChoiceIsFittedMeasuredAndSwapped) {
    Session session;
    ASSERT_TRUE(session.open(k_film));
    session.choose(k_small);
    ASSERT_TRUE(wait_until_idle(session));
    ASSERT_TRUE(session.fitted());
    EXPECT_EQ(session.fitted()->choice, k_small);
    EXPECT_FALSE(session.fitted()->quick);
    const PmModel small = std::get<PmModel>(session.fitted()->model.model);
    EXPECT_EQ(small.lobes, 2);
    EXPECT_EQ(small.form, PmForm::horizon);
    ASSERT_TRUE(session.fitted()->errors);
    const double error = session.fitted()->errors->heldout.squared_error_ratio;

    // The measures are those that the library computes for the same model.
    const Evaluate others[] = {evaluator(session.fitted()->model)};
    const Evaluate reference = evaluator(*session.subjects()[0]);
    EXPECT_EQ(measure_heldout(rgb_channels(reference), rgb_channels(others), {80 * k_degree, 0})[0].squared_error_ratio,
              error);

    // A better choice. The previous fit stays on display until the new one is ready.
    FitChoice better = k_small;
    better.form = PmForm::extended;
    better.lobes = 5, better.variates = 3;
    session.choose(better);
    EXPECT_EQ(std::get<PmModel>(session.fitted()->model.model), small);
    bool was_quick = false;
    ASSERT_TRUE(wait(session, [&] {
        was_quick = was_quick || (session.fitted()->quick && session.fitted()->choice == better);
        return session.stage() == Stage::idle;
    }));
    EXPECT_TRUE(was_quick);
    EXPECT_EQ(session.fitted()->choice, better);
    EXPECT_LT(session.fitted()->errors->heldout.squared_error_ratio, 0.5 * error);
}

TEST(Session, CancelKeepsWhatIsOnDisplay) {
    Session session;
    ASSERT_TRUE(session.open(k_film));
    const Stopwatch first;
    session.choose(k_small);
    ASSERT_TRUE(wait_until_idle(session));
    const double seconds = first.seconds();
    FitChoice large;
    large.lobes = k_most_chosen_lobes, large.variates = 8;
    session.choose(large);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    session.cancel();
    EXPECT_EQ(session.stage(), Stage::idle);
    // A small fit afterwards finishes long before the large one could.
    FitChoice other = k_small;
    other.lobes = 1;
    const Stopwatch watch;
    session.choose(other);
    ASSERT_TRUE(wait_until_idle(session));
    EXPECT_EQ(session.fitted()->choice, other);
    EXPECT_LT(watch.seconds(), 10 * seconds + 1);
    session.choose(large);
    session.choose(k_small);  // cancelled by a newer choice
    ASSERT_TRUE(wait_until_idle(session));
    EXPECT_EQ(session.fitted()->choice, k_small);
}

TEST(Session, EditsAreThoseOfTheLibrary) {
    Session session;
    ASSERT_TRUE(session.open(k_film));
    session.choose(k_small);
    EXPECT_FALSE(session.can_edit());
    ASSERT_TRUE(wait_until_idle(session));
    const Model fitted = session.fitted()->model;
    EditChoice choice;
    choice.highlight = 0.5f, choice.roughness = 1.5f;
    for (const EditChoice& last : {EditChoice{.saturation = 0.5f}, choice}) {  // the second replaces the first
        session.edit(last);
        EXPECT_EQ(session.stage(), Stage::editing);
        ASSERT_TRUE(wait_until_idle(session));
        const auto expected = edited(fitted, last.edits());
        ASSERT_TRUE(expected);
        EXPECT_EQ(std::get<PmModel>(session.fitted()->model.model), std::get<PmModel>(expected->model));
        EXPECT_EQ(session.fitted()->edit, last);
        EXPECT_FALSE(session.fitted()->errors);
    }
    EXPECT_EQ(choice.edits().size(), 2u);
    // A saved model says what was done; without edits the fit is as it was, errors included.
    const TemporaryFolder folder;
    ASSERT_TRUE(session.save(folder / "edited.srbf"));
    EXPECT_TRUE(load_model(folder / "edited.srbf")->provenance.contains("edits"));
    session.edit({});
    EXPECT_EQ(session.stage(), Stage::idle);
    EXPECT_TRUE(session.poll());
    EXPECT_EQ(std::get<PmModel>(session.fitted()->model.model), std::get<PmModel>(fitted.model));
    EXPECT_TRUE(session.fitted()->errors);
    session.edit(choice);
    session.choose({.lobes = 1, .variates = 1});  // another fit begins without edits
    EXPECT_EQ(session.edit_choice(), EditChoice{});
    ASSERT_TRUE(wait_until_idle(session));
    EXPECT_EQ(session.fitted()->edit, EditChoice{});
}
TEST(Session, EndsInTheMiddleOfAFit) {
    Session session;
    ASSERT_TRUE(session.open(k_film));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

TEST(ViewCommand, DoesNotTimeWhileItTakesAScreenshot) {
    const TemporaryFolder folder;
    const ProgramRun done = run(folder, {"view", "m.binary", "--screenshot", "x.png", "--time-refits", "1"});
    EXPECT_EQ(done.status, 2);
    EXPECT_NE(done.err.find("--screenshot: not with"), done.err.npos) << done.err;
}

TEST(Session, WhatCannotBeReadIsAMessage) {
    const TemporaryFolder folder;
    write(folder / "bad.bsdf", "no tensor file");
    Session session;
    EXPECT_FALSE(session.open(folder / "bad.bsdf"));
    EXPECT_FALSE(session.open(folder / "none.bsdf"));
    EXPECT_TRUE(session.open(k_film));
    // A model with two channels.
    std::mt19937_64 random(1);
    auto bytes = write_model({random_model(random, {.lobes = 3}), {}});
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto shape = text.find("[3,3]");
    ASSERT_NE(shape, std::string::npos);
    write(folder / "two.srbf", text.replace(shape, 5, "[3,2]"));
    EXPECT_FALSE(session.open(folder / "two.srbf"));
    ASSERT_EQ(session.messages().size(), 3u);
    for (const auto& message : session.messages()) {
        EXPECT_TRUE(message.is_error);
        EXPECT_EQ(message.text.find('\n'), std::string::npos);
    }
    EXPECT_NE(session.messages()[2].text.find("two.srbf"), std::string::npos);
    EXPECT_EQ(session.subjects().size(), 1u);
    EXPECT_EQ(session.reference(), 0);
    EXPECT_FALSE(session.save(folder / "nowhere" / "model.srbf"));
}

TEST(Session, AModelIsHeldAgainstTheMeasurementInWhateverOrder) {
    const TemporaryFolder folder;
    std::mt19937_64 random(2);
    const Model model{random_model(random, {.lobes = 3}), {{"objective", "raw"}}};
    ASSERT_TRUE(save_model(model, folder / "model.srbf"));
    for (const bool model_first : {true, false}) {
        Session session;
        ASSERT_TRUE(session.open(model_first ? std::string(folder / "model.srbf") : k_film));
        ASSERT_TRUE(session.open(model_first ? k_film : std::string(folder / "model.srbf")));
        ASSERT_TRUE(wait_until_idle(session));
        EXPECT_FALSE(session.subjects()[std::size_t(session.reference())]->is_model());
        EXPECT_EQ(session.fitted()->from, folder / "model.srbf");
        EXPECT_EQ(std::get<PmModel>(session.fitted()->model.model), rounded(std::get<PmModel>(model.model)));
        EXPECT_EQ(session.fitted()->choice.objective, Objective::raw);
        EXPECT_TRUE(session.fitted()->errors);
        EXPECT_TRUE(session.save(folder / "again.srbf"));
        // `poll` reports a replaced model once.
        EXPECT_FALSE(session.poll());
        session.show_model(model_first ? 0 : 1);
        EXPECT_TRUE(session.poll());
    }
}

TEST(Session, KeysDoWhatTheySay) {
    Session empty, session;
    DisplayState display;
    for (const Key& key : keys()) EXPECT_TRUE(press(key.name, display, empty)) << key.name;  // also without any file
    EXPECT_FALSE(press("Shift+F1", display, session));
    display = {};
    press("Right", display, session);
    EXPECT_GT(display.azimuth, 0);
    for (int i = 0; i < 40; ++i) press("Up", display, session);
    EXPECT_LE(display.elevation, 89 * k_degree);
    const Vec3d before = display.lights[1].towards;
    press("2", display, session);
    press("Shift+Left", display, session);
    EXPECT_TRUE(near(dot(display.lights[1].towards, display.lights[1].towards), 1, 1e-12));
    EXPECT_LT(dot(display.lights[1].towards, before), 0.9999);
    press("E", display, session);
    EXPECT_FALSE(display.automatic);
    ASSERT_TRUE(session.open(k_film));
    const FitChoice choice = session.choice();
    press("J", display, session), press("Shift+N", display, session), press("O", display, session),
        press("K", display, session);
    EXPECT_EQ(session.choice(),
              (FitChoice{PmForm::gaussian, choice.lobes + 1, choice.variates - 1, objectives().front()}));
    press("Escape", display, session);
    EXPECT_EQ(session.stage(), Stage::idle);
}

TEST(Session, AFileToOpenIsTypedOrChosenAmongRecentOnes) {
    Opening opening;
    opening.recent = {"/a/film.srbf", "/b/paper.bsdf", "/b/film.bsdf"};
    EXPECT_EQ(file_of(opening), "");
    press("Down", opening);
    EXPECT_EQ(file_of(opening), "/a/film.srbf");
    for (int i = 0; i < 2; ++i) press("Up", opening);
    EXPECT_EQ(file_of(opening), "");
    opening.typed = "film";
    EXPECT_EQ(file_of(opening), "film");  // the typed text, unless a match is chosen
    for (int i = 0; i < 3; ++i) press("Down", opening);
    EXPECT_EQ(file_of(opening), "/b/film.bsdf");  // the last one
    opening.typed = "~/x.srbf";
    EXPECT_EQ(file_of(opening), std::string(std::getenv("HOME")) + "/x.srbf");
    EXPECT_FALSE(opening.is_confirmed || opening.is_cancelled);
    press("Enter", opening);
    EXPECT_TRUE(opening.is_confirmed);
    press("Escape", opening);
    EXPECT_TRUE(opening.is_cancelled);

    Session session;
    DisplayState display;
    press("Shift+Y", display, session);
    EXPECT_TRUE(display.open_file);
}

TEST(Lobes, TheirSumIsTheModelAndTheirSharesAreOne) {
    std::mt19937_64 random(3);
    const Vec3f wl = to_float(spherical(0.7, k_pi));
    for (const bool axial : {true, false}) {
        const Model model{random_model(random, {.axial = axial, .lobes = 5}), {}};
        const auto terms = terms_of(model);
        ASSERT_EQ(terms.size(), 5u);
        for (int i = 0; i < 100; ++i) {
            const Vec3f wv = to_float(random_direction(random, 0.05));
            Rgb sum;
            for (const Model& term : terms)
                for (int c = 0; c < 3; ++c) sum[c] += value(term, wl, wv)[c];
            const Rgb whole = value(model, wl, wv);
            for (int c = 0; c < 3; ++c) EXPECT_TRUE(near_relative(sum[c], whole[c], 1e-4));
        }
        double shares = 0;
        for (const LobeSlice& lobe : lobe_slices(model, wl)) {
            shares += lobe.share;
            EXPECT_GE(lobe.width, 0);
            EXPECT_LE(*std::ranges::max_element(lobe.relative), 1);
        }
        EXPECT_TRUE(near(shares, 1, 1e-9));
    }
    // A Gaussian lobe of the view direction is half of its peak at the angle a where e^(λ(cos a − 1)) = 1/2.
    PmModel one;
    one.lobes = one.variates = 1;
    one.coefficient = {{1, 1, 1}};
    one.log_scale = {0};
    one.centre = {{0, 0, 1}};
    one.bandwidth = {6};
    one.parameterization = {{0, 1}};
    const auto slices = lobe_slices({one, {}}, wl);
    ASSERT_EQ(slices.size(), 1u);
    EXPECT_TRUE(near(slices[0].width, std::acos(1 - std::log(2.0) / 6), 2 * k_degree));
    EXPECT_TRUE(near(dot(to_double(slices[0].centre), Vec3d{0, 0, 1}), 1, 1e-6));
}

TEST(Slice, IsTheFunctionTimesTheCosine) {
    const auto subject = load_subject(k_film);
    ASSERT_TRUE(subject);
    const Slice half_slice = slice(evaluator(*subject), 30 * k_degree, 0, false);
    const Slice full_slice = slice(evaluator(*subject), 30 * k_degree, 0, true);
    EXPECT_EQ(full_slice.f.size(), 2 * half_slice.f.size());
    EXPECT_TRUE(std::equal(half_slice.f.begin(), half_slice.f.end(), full_slice.f.begin(),
                           [](const Rgb& a, const Rgb& b) { return a == b || !is_finite(a); }));
    const Vec3f wl = to_float(spherical(30 * k_degree, k_pi));
    for (std::size_t i = 0; i < half_slice.f.size(); i += 13) {
        const Vec3f wv{std::sin(half_slice.angle[i]), 0, std::cos(half_slice.angle[i])};
        EXPECT_TRUE(near_relative(half_slice.f[i].g, value(*subject, wl, wv).g * wv.z, 1e-3)) << half_slice.angle[i];
    }
    // Across the plane of incidence, an isotropic material is symmetric.
    const Slice across = slice(evaluator(*subject), 30 * k_degree, 90 * k_degree, false);
    for (std::size_t i = 0; i < across.f.size(); i += 13) {
        const Vec3f wv{0, std::sin(across.angle[i]), std::cos(across.angle[i])};
        EXPECT_TRUE(near_relative(across.f[i].g, value(*subject, wl, wv).g * wv.z, 1e-3)) << across.angle[i];
        EXPECT_TRUE(near_relative(across.f[i].g, across.f[across.f.size() - 1 - i].g, 1e-3)) << across.angle[i];
    }
}

/// The texts that are wider than their columns according to Dear ImGui, in the plots and tables of a window of this
/// size.
std::string clipped_texts(const Session& session, ImVec2 size, float scale) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = size;
    load_font(scale);
    ImGui::GetStyle().ScaleAllSizes(scale);
    unsigned char* texels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsAlpha8(&texels, &width, &height);
    Readings readings;
    DisplayState display;
    readings.take(session, display, true);
    std::string clipped;
    ImGuiContext& state = *ImGui::GetCurrentContext();
    for (const int tab : {0, 1}) {
        for (int frame = 0; frame < 3; ++frame) {
            ImGui::NewFrame();
            readings.draw(session, display, {0, 0}, size);
            ImGui::EndFrame();
            ImGuiTabBar& tabs = *state.TabBars.GetByIndex(0);
            if (frame == 0) tabs.NextSelectedTabId = tabs.Tabs[tab].ID;
        }
        for (const ImGuiWindow* window : state.Windows)
            if (window->ContentSize.x > window->WorkRect.GetWidth() + 1)
                clipped +=
                    fmt::format("{} {} > {}\n", window->Name, window->ContentSize.x, window->WorkRect.GetWidth());
        for (int i = 0; i < state.Tables.GetMapSize(); ++i)
            if (const ImGuiTable* table = state.Tables.TryGetMapData(i))
                for (int c = 0; c < table->ColumnsCount; ++c) {
                    const ImGuiTableColumn& column = table->Columns[c];
                    const float needed = std::max(column.ContentMaxXUnfrozen, column.ContentMaxXHeadersIdeal);
                    if (needed > column.WorkMaxX + 1)
                        clipped += fmt::format("table {} column {}: {} > {}\n", i, c, needed, column.WorkMaxX);
                }
    }
    EXPECT_EQ(state.Tables.GetMapSize(), 2);
    ImGui::DestroyContext();
    return clipped;
}

// Tests wide numbers at the default size, and other numbers also at a smaller size, on monitors of several scales.
TEST(Readings, NoTextIsWiderThanItsColumn) {
    const TemporaryFolder folder;
    std::mt19937_64 random(2);
    const PmModel model = random_model(random, {.lobes = 3});
    for (const float factor : {1e-4f, 1e4f}) {
        PmModel scaled = model;
        for (Rgb& coefficient : scaled.coefficient)
            coefficient = {factor * coefficient.r, factor * coefficient.g, factor * coefficient.b};
        ASSERT_TRUE(save_model({scaled, {}}, folder / "model.srbf"));
        Session session;
        ASSERT_TRUE(session.open(folder / "model.srbf"));
        ASSERT_TRUE(session.open(k_film));
        ASSERT_TRUE(wait_until_idle(session));
        ASSERT_TRUE(session.fitted() && session.fitted()->errors);
        for (const float scale : {1.f, 1.5f, 2.f}) {
            // Below the pictures of 1280 x 800 and of 1000 x 700.
            EXPECT_EQ(clipped_texts(session, {scale * 1018, scale * 302}, scale), "") << scale << ", " << factor;
            if (factor < 1) {
                EXPECT_EQ(clipped_texts(session, {scale * 738, scale * 257}, scale), "") << scale;
            }
        }
    }
}

/// A run of the program on a virtual screen. The status is 77 if there is none.
struct Screenshot {
    int status;
    std::string err;
};
Screenshot view(const TemporaryFolder& folder, const std::string& arguments) {
    const std::string command = "cd '" + folder.path.string() +
                                "' && xvfb-run -a -s '-screen 0 1400x900x24' '" SRBF_PROGRAM "' view " + arguments +
                                " >out 2>err";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(folder / "err")};
}

class View : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system("command -v xvfb-run xauth >/dev/null") != 0) GTEST_SKIP() << "xvfb or xauth is missing";
    }
};

struct Pixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
    /// The mean absolute difference of two rectangles of this size, 0 to 255.
    double difference(int xa, int xb, int y, int w, int h) const {
        double sum = 0;
        for (int row = y; row < y + h; ++row)
            for (int i = 0; i < 3 * w; ++i) {
                const auto value_at = [&](int x) { return double(rgb[std::size_t(3 * (row * width + x) + i)]); };
                sum += std::abs(value_at(xa) - value_at(xb));
            }
        return sum / (3.0 * w * h);
    }
    double deviation(int x, int y, int w, int h) const {
        double sum = 0, squares = 0;
        for (int row = y; row < y + h; ++row)
            for (int i = 0; i < 3 * w; ++i) {
                const double value = double(rgb[std::size_t(3 * (row * width + x) + i)]);
                sum += value, squares += value * value;
            }
        const double n = 3.0 * w * h;
        return std::sqrt(std::max(0.0, squares / n - sum / n * sum / n));
    }
};
Pixels read_png(const std::filesystem::path& path) {
    Pixels image;
    int channels = 0;
    if (unsigned char* data = stbi_load(path.c_str(), &image.width, &image.height, &channels, 3)) {
        image.rgb.assign(data, data + 3 * image.width * image.height);
        stbi_image_free(data);
    }
    return image;
}

TEST_F(View, TheScreenshotShowsMeasuredAndFitAlike) {
    const TemporaryFolder folder;
    const std::string paper = std::string(100, 'W') + ".bsdf";  // a name wider than its picture
    std::filesystem::copy(bundled_data() / "paper_white_rgb.bsdf", folder / paper);
    const Screenshot taken = view(folder, "'" + paper + "' missing.bsdf --screenshot shot.png");
    if (taken.err.find("graphics library") != std::string::npos) GTEST_SKIP() << taken.err;
    ASSERT_EQ(taken.status, 0) << taken.err;
    EXPECT_NE(taken.err.find("missing.bsdf"), std::string::npos);  // a file that fails among good ones
    const Pixels image = read_png(folder / "shot.png");
    ASSERT_EQ(image.width, 1280);
    ASSERT_EQ(image.height, 800);
    // The centres of the measured picture, the fit and the difference, without the first light's dot and the borders.
    const int y = 120, w = 150, h = 170, xs[3] = {360, 698, 1035};
    EXPECT_GT(image.deviation(xs[0], y, w, h), 15);  // a lit ball
    EXPECT_GT(image.deviation(xs[1], y, w, h), 15);
    EXPECT_LT(image.difference(xs[0], xs[1], y, w, h), 4);   // the same material
    EXPECT_GT(image.difference(xs[0], xs[2], y, w, h), 20);  // the difference is another picture
    EXPECT_LT(image.deviation(xs[2], y, w, h), 0.5 * image.deviation(xs[0], y, w, h));
    EXPECT_GT(image.deviation(280, 470, 300, 160), 5);  // the slices
    EXPECT_GT(image.deviation(640, 480, 240, 200), 5);  // the lobes
}

TEST_F(View, WhatCannotBeShownIsALine) {
    const TemporaryFolder folder;
    for (const std::string arguments : {"missing.bsdf --screenshot shot.png", "--screenshot nowhere/shot.png"}) {
        const Screenshot taken = view(folder, arguments);
        EXPECT_EQ(taken.status, 1) << arguments << taken.err;
        EXPECT_EQ(std::ranges::count(taken.err, '\n'), 1) << taken.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "shot.png"));
    }
    // Without a display. Wayland's would be sought in this folder; its library complains if none is set.
    const std::string command = "env -u DISPLAY -u WAYLAND_DISPLAY XDG_RUNTIME_DIR='" + folder.path.string() +
                                "' '" SRBF_PROGRAM "' view '" + k_film + "' 2>'" + (folder / "err").string() + "'";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1);
    EXPECT_NE(contents(folder / "err").find("display"), std::string::npos) << contents(folder / "err");
    EXPECT_EQ(std::ranges::count(contents(folder / "err"), '\n'), 1);
}

TEST_F(View, NoFileIsAWindowThatSaysSo) {
    const TemporaryFolder folder;
    const Screenshot taken = view(folder, "--screenshot shot.png");
    if (taken.err.find("graphics library") != std::string::npos) GTEST_SKIP() << taken.err;
    EXPECT_EQ(taken.status, 0) << taken.err;
    EXPECT_EQ(read_png(folder / "shot.png").width, 1280);
}

}  // namespace
}  // namespace srbf::view_test
