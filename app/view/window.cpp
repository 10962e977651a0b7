#include "app/view/window.h"

#include <epoxy/gl.h>
// After epoxy, which stands for OpenGL's own header.
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/raster.h"
#include "app/view/panels.h"
#include "app/view/plots.h"

namespace srbf {
namespace {

const ImVec4 k_red{1, 0.45f, 0.4f, 1}, k_dim{0.65f, 0.65f, 0.65f, 1}, k_hint{1, 0.86f, 0.35f, 1};
constexpr float k_controls = 262, k_messages = 58;  // pixels
/// While a fit runs the picture leaves it the processor: a frame every so many seconds.
constexpr double k_frame_beside_fit = 0.05;
/// A moving picture that takes longer than this is drawn smaller until it rests.
constexpr double k_slow_frame = 0.04, k_rest = 0.25;

/// The default font has no Greek.
std::string latin(std::string text) {
    const std::string theta = "\xCE\xB8";
    for (std::size_t at; (at = text.find(theta)) != std::string::npos;) text.replace(at, theta.size(), " theta_");
    return text;
}
ImU32 colour_of(Rgb c) { return ImColor(c.r, c.g, c.b); }

/// The name of a key as `press` takes it; empty: none of ours.
std::string name_of(int key, int scancode, int modifiers) {
    std::string name;
    switch (key) {
        case GLFW_KEY_LEFT:
            name = "Left";
            break;
        case GLFW_KEY_RIGHT:
            name = "Right";
            break;
        case GLFW_KEY_UP:
            name = "Up";
            break;
        case GLFW_KEY_DOWN:
            name = "Down";
            break;
        case GLFW_KEY_PAGE_UP:
            name = "PageUp";
            break;
        case GLFW_KEY_PAGE_DOWN:
            name = "PageDown";
            break;
        case GLFW_KEY_ENTER:
            name = "Enter";
            break;
        case GLFW_KEY_ESCAPE:
            name = "Escape";
            break;
        case GLFW_KEY_F1:
            name = "F1";
            break;
        default:
            if (const char* text = glfwGetKeyName(key, scancode); text && text[0] != 0 && text[1] == 0)
                name = char(std::toupper(text[0]));
    }
    return (modifiers & GLFW_MOD_SHIFT) != 0 && !name.empty() ? "Shift+" + name : name;
}

/// GLFW, its window and Dear ImGui, ended in the order in which they can be.
struct Screen {
    GLFWwindow* window = nullptr;
    bool has_imgui = false;
    ~Screen() {
        if (has_imgui) {
            ImGui_ImplOpenGL3_Shutdown();
            ImGui_ImplGlfw_Shutdown();
            ImGui::DestroyContext();
        }
        if (window) glfwDestroyWindow(window);
        glfwTerminate();
    }
    Result<Done> open(int width, int height);
};

Result<Done> Screen::open(int width, int height) {
    const auto found = [] {
        const char* text = nullptr;
        glfwGetError(&text);
        return std::string(text ? text : "nothing");
    };
    if (!glfwInit()) return Error{"window", {}, "display", "one, named by DISPLAY", found()};
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window = glfwCreateWindow(width, height, "srbf view", nullptr, nullptr);
    if (!window) return Error{"window", {}, "graphics library", std::string(name(Dialect::gl_450)), found()};
    glfwMakeContextCurrent(window);
    return Done{};
}

class Window {
  public:
    Window(GLFWwindow* window, Session& session, Look& look, Panels panels)
        : window_(window), session_(session), look_(look), panels_(std::move(panels)) {}

    Result<Done> run(const WindowOptions& options);
    void key(const std::string& name) {
        if (!ImGui::GetIO().WantTextInput) press(name, look_, session_), touched_ = glfwGetTime();
    }
    void drop(const std::string& path);

  private:
    void take_mesh();
    void take_materials(bool swapped);
    void draw_everything();
    void draw_controls(ImVec2 at, ImVec2 size);
    void draw_fit_controls();
    void draw_panels(ImVec2 at, ImVec2 size);
    void draw_lights(ImVec2 corner, float width, float height, bool can_drag);
    void draw_scale(float width);
    void draw_below(ImVec2 at, ImVec2 size);
    void draw_measures();
    void draw_messages(ImVec2 at, ImVec2 size);
    void draw_help();
    void save();
    Image8 read() const;
    void time_refits(int count);
    std::string name_of_fit() const;

    GLFWwindow* window_;
    Session& session_;
    Look& look_;
    Panels panels_;
    std::string mesh_, typed_mesh_, typed_model_;
    int reference_ = -1;  ///< the subject whose material is on the left
    std::optional<Slice> slice_of_reference_, slice_of_fit_;
    std::vector<SeenLobe> lobes_;
    double sliced_at_ = -1;
    bool is_exposed_ = false;
    int dragged_light_ = -1;
    double dome_azimuth_ = 0, dome_elevation_ = 50 * k_degree;
    std::string shown_key_;
    double touched_ = 0;                ///< when something moved last
    float reduction_ = 1;               ///< of pictures that move
    std::optional<FitChoice> sliding_;  ///< while a slider is held
    std::string panel_error_;
    // Of the refits that are timed.
    int timed_ = 0, frames_ = 0;
    bool waits_ = false;
    std::vector<double> swapped_after_;  ///< [s]
    double swapped_ = 0, asked_ = 0, slowest_ = 0, last_frame_ = 0;
};

void Window::drop(const std::string& path) {
    const auto ending = std::filesystem::path(path).extension();
    if (ending == ".ply" || ending == ".obj") return void(look_.mesh = path);
    if (!session_.open(path)) return;
    const int added = int(session_.subjects().size()) - 1;
    if (!session_.subjects().back()->is_model())
        session_.set_reference(added);
    else if (session_.reference() != added)
        session_.show_model(added);
}

void Window::take_mesh() {
    if (mesh_ == look_.mesh) return;
    auto mesh = load_mesh(look_.mesh);
    if (!mesh) {
        session_.complain(mesh.error());
        look_.mesh = mesh_.empty() ? "ball" : mesh_;
        if (!mesh_.empty()) return;
        mesh = ball();
    }
    mesh_ = look_.mesh;
    panels_.set_mesh(*mesh);
    is_exposed_ = false;
}

void Window::take_materials(bool swapped) {
    const auto set = [&](Panels::Which which, const Result<Material>& material) {
        const auto done = material ? panels_.set_material(which, *material) : Result<Done>(material.error());
        if (done) return;
        session_.complain(done.error());
        (void)panels_.set_material(which, {});
    };
    if (reference_ != session_.reference()) {
        reference_ = session_.reference();
        set(Panels::reference, material_of(*session_.subjects()[std::size_t(reference_)]));
        slice_of_reference_.reset();
        is_exposed_ = false;
        sliced_at_ = -1;
        swapped = true;
    }
    if (swapped) {
        if (session_.fitted())
            set(Panels::fit, material_of(session_.fitted()->model));
        else
            (void)panels_.set_material(Panels::fit, {});
    }
    if (swapped || sliced_at_ != look_.theta_l) {
        if (reference_ >= 0)
            slice_of_reference_ = slice(evaluator(*session_.subjects()[std::size_t(reference_)]), look_.theta_l);
        slice_of_fit_.reset();
        lobes_.clear();
        if (const auto& fitted = session_.fitted()) {
            slice_of_fit_ = slice(evaluator(fitted->model), look_.theta_l);
            lobes_ = seen_lobes(fitted->model, to_float(spherical(look_.theta_l, k_pi)));
        }
        sliced_at_ = look_.theta_l;
    }
}

std::string Window::name_of_fit() const {
    const auto& fitted = session_.fitted();
    if (!fitted) return session_.stage() == Stage::idle ? "no fit" : "fitting ...";
    std::string text = fitted->from.empty() ? "fit" : std::filesystem::path(fitted->from).filename().string();
    text += fmt::format(", {} bytes", payload_bytes(fitted->model));
    if (fitted->quick) text += session_.stage() == Stage::idle ? " (quick)" : " (quick, refining ...)";
    return text;
}

void Window::draw_fit_controls() {
    FitChoice choice = sliding_.value_or(session_.choice());
    bool changed = false, held = false;
    const auto slider = [&](const char* text, int& value, int least, int most) {
        const bool moved = ImGui::SliderInt(text, &value, least, most, "%d", ImGuiSliderFlags_AlwaysClamp);
        held = held || ImGui::IsItemActive();
        changed = changed || moved;
    };
    slider("lobes J", choice.lobes, 1, k_most_chosen_lobes);
    slider("variates N", choice.variates, 1, k_most_variates);
    const auto combo = [&](const char* text, auto& value, int count) {
        using E = std::remove_reference_t<decltype(value)>;
        if (!ImGui::BeginCombo(text, std::string(name(value)).c_str())) return;
        for (int i = 0; i < count; ++i)
            if (ImGui::Selectable(std::string(name(E(i))).c_str(), value == E(i))) value = E(i), changed = true;
        ImGui::EndCombo();
    };
    combo("form", choice.form, 3);
    combo("objective", choice.objective, 4);
    if (changed) sliding_ = choice;
    if (sliding_ && !held) {  // released
        session_.choose(*sliding_);
        sliding_.reset();
    }
    const bool is_busy = session_.stage() != Stage::idle;
    const char* const what[] = {"", "fitting", "refining", "measuring"};
    if (is_busy) {
        const bool fits = session_.stage() != Stage::measuring;
        ImGui::ProgressBar(fits ? float(session_.fraction()) : 1.f, {-70, 0},
                           fmt::format("{} {:.1f} s", what[int(session_.stage())], session_.waited()).c_str());
        ImGui::SameLine();
        if (ImGui::Button("Cancel", {-1, 0})) session_.cancel();
    } else {
        const bool can = session_.reference() >= 0;
        if (ImGui::Button("Fit again", {-1, 0}) && can) session_.refit();
    }
    if (const auto& fitted = session_.fitted(); fitted && fitted->from.empty())
        ImGui::TextColored(
            k_dim, "%s",
            fmt::format("{} fit in {:.2f} s", fitted->quick ? "quick" : "finished", fitted->seconds).c_str());
    else
        ImGui::TextColored(k_dim, "move a slider to fit the reference");
}

void Window::draw_controls(ImVec2 at, ImVec2 size) {
    ImGui::SetNextWindowPos(at), ImGui::SetNextWindowSize(size);
    ImGui::Begin("controls", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    ImGui::PushItemWidth(142);
    const auto heading = [](const char* text) {
        ImGui::Spacing(), ImGui::TextColored(k_hint, "%s", text), ImGui::Separator();
    };
    heading("Files");
    const auto& subjects = session_.subjects();
    if (subjects.empty()) ImGui::TextWrapped("Drop a measurement or a model on this window.");
    for (int i = 0; i < int(subjects.size()); ++i) {
        const std::string file = std::filesystem::path(subjects[std::size_t(i)]->path).filename().string();
        const bool is_model = subjects[std::size_t(i)]->is_model();
        ImGui::PushID(i);
        if (ImGui::RadioButton("##reference", session_.reference() == i)) session_.set_reference(i);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("the reference, on the left");
        ImGui::SameLine();
        const bool shown = session_.fitted() && session_.fitted()->from == subjects[std::size_t(i)]->path;
        if (ImGui::Selectable(file.c_str(), shown)) is_model ? session_.show_model(i) : session_.set_reference(i);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s\n%s", subjects[std::size_t(i)]->path.c_str(),
                              is_model ? "model: click to hold it against the reference"
                                       : "measurement: click to make it the reference");
        ImGui::PopID();
    }
    heading("Fit");
    draw_fit_controls();
    heading("Save");
    if (look_.name_model) ImGui::SetKeyboardFocusHere(), look_.name_model = false;
    if (typed_model_.empty() && session_.reference() >= 0)
        typed_model_ =
            std::filesystem::path(subjects[std::size_t(session_.reference())]->path).stem().string() + ".srbf";
    ImGui::InputText("##model", &typed_model_);
    ImGui::SameLine();
    if (ImGui::Button("Save model", {-1, 0})) look_.save = true;
    heading("Picture");
    if (ImGui::BeginCombo("mesh", std::filesystem::path(look_.mesh).filename().c_str())) {
        for (const auto name : k_built_in_meshes)
            if (ImGui::Selectable(std::string(name).c_str(), look_.mesh == name)) look_.mesh = name;
        ImGui::EndCombo();
    }
    if (look_.name_mesh) ImGui::SetKeyboardFocusHere(), look_.name_mesh = false;
    if (ImGui::InputTextWithHint("mesh file", ".ply or .obj, Enter", &typed_mesh_,
                                 ImGuiInputTextFlags_EnterReturnsTrue))
        look_.mesh = typed_mesh_;
    float stops = std::log2(look_.exposure);
    if (ImGui::SliderFloat("exposure", &stops, -8, 8, "%+.2f stops"))
        look_.exposure = std::exp2(stops), look_.automatic = false;
    if (ImGui::Checkbox("automatic exposure", &look_.automatic)) is_exposed_ = false;
    ImGui::SliderFloat("difference", &look_.full_scale, k_least_scale, k_most_scale, "+-%.3g",
                       ImGuiSliderFlags_Logarithmic);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("the difference that shows in full red or blue;\n1 is the brightness of white");
    if (ImGui::Button("Screenshot")) look_.screenshot = true;
    ImGui::SameLine();
    if (ImGui::Button("Keys (H)")) look_.help = !look_.help;
    heading("Lights");
    for (int k = 0; k < 3; ++k) {
        if (k > 0) ImGui::SameLine();
        if (ImGui::RadioButton(fmt::format("light {}", k + 1).c_str(), look_.light == k)) look_.light = k;
    }
    Rgb& irradiance = look_.lights[std::size_t(look_.light)].irradiance;
    if (float bright = irradiance.r; ImGui::SliderFloat("strength", &bright, 0, 10, "%.2f"))
        irradiance = {bright, bright, bright};
    ImGui::TextColored(k_dim, "Drag a light's yellow dot, or\nthe picture with the right button.");
    ImGui::PopItemWidth();
    ImGui::End();
}

void Window::draw_lights(ImVec2 corner, float width, float height, bool can_drag) {
    const Camera camera = camera_of(look_, panels_.bounds());
    const Frame axes = frame(camera);
    const Vec3d diagonal = to_double(panels_.bounds().most) - to_double(panels_.bounds().least);
    const double radius = 0.5 * std::sqrt(dot(diagonal, diagonal)) / look_.zoom, half = std::tan(camera.fov / 2);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int k = 0; k < 3; ++k) {
        const Vec3d p = camera.target + 0.72 * radius * look_.lights[std::size_t(k)].towards - camera.eye;
        const double depth = -dot(p, axes.z);
        if (!(depth > 0)) continue;
        const ImVec2 at{corner.x + width / 2 + float(dot(p, axes.x) / (depth * half) * height / 2),
                        corner.y + height / 2 - float(dot(p, axes.y) / (depth * half) * height / 2)};
        const bool behind = dot(look_.lights[std::size_t(k)].towards, axes.z) < 0;
        const ImU32 colour = IM_COL32(255, 220, 90, behind ? 130 : 255);
        if (behind)
            list.AddCircle(at, 6, colour, 0, 2);
        else
            list.AddCircleFilled(at, 6, colour);
        list.AddCircle(at, 7, IM_COL32(0, 0, 0, 160));
        if (k == look_.light) list.AddCircle(at, 10, colour, 0, 1.5f);
        list.AddText({at.x + 9, at.y - 14}, colour, fmt::format("{}", k + 1).c_str());
        const ImVec2 mouse = ImGui::GetMousePos();
        if (can_drag && ImGui::IsMouseClicked(0) && std::hypot(mouse.x - at.x, mouse.y - at.y) < 10)
            dragged_light_ = look_.light = k;
    }
}

void Window::draw_scale(float width) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float height = 12, middle = at.x + width / 2;
    using D = RasterDevelopment;
    list.AddRectFilledMultiColor(at, {middle, at.y + height}, colour_of(D::k_darker), colour_of(D::k_equal),
                                 colour_of(D::k_equal), colour_of(D::k_darker));
    list.AddRectFilledMultiColor({middle, at.y}, {at.x + width, at.y + height}, colour_of(D::k_equal),
                                 colour_of(D::k_brighter), colour_of(D::k_brighter), colour_of(D::k_equal));
    const ImU32 ink = IM_COL32(230, 230, 230, 255);
    const std::string most = fmt::format("+{:.3g}", look_.full_scale), least = fmt::format("-{:.3g}", look_.full_scale);
    list.AddText({at.x, at.y + height}, ink, (least + " fit darker").c_str());
    list.AddText({middle - 3, at.y + height}, ink, "0");
    const std::string right = "fit brighter " + most;
    list.AddText({at.x + width - ImGui::CalcTextSize(right.c_str()).x, at.y + height}, ink, right.c_str());
    ImGui::Dummy({width, height + ImGui::GetTextLineHeight()});
}

void Window::draw_panels(ImVec2 at, ImVec2 size) {
    ImGui::SetNextWindowPos(at), ImGui::SetNextWindowSize(size);
    ImGui::Begin("pictures", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoScrollWithMouse);
    const float gap = ImGui::GetStyle().ItemSpacing.x, below = 34;
    const float width = std::floor((ImGui::GetContentRegionAvail().x - 2 * gap) / 3);
    const float height =
        std::max(40.f, ImGui::GetContentRegionAvail().y - below - ImGui::GetTextLineHeightWithSpacing());

    const double now = glfwGetTime();
    std::string key = fmt::format("{} {} {}", look_.azimuth, look_.elevation, look_.zoom);
    for (const auto& light : look_.lights) key += fmt::format(" {} {}", light.towards.x, light.towards.y);
    if (key != shown_key_) touched_ = now, shown_key_ = key;
    const bool moves = now - touched_ < k_rest;
    const float share = moves ? reduction_ : 1;
    const bool expose = !is_exposed_ && (panels_.has(Panels::reference) || panels_.has(Panels::fit));
    const double before = glfwGetTime();
    const auto drawn = panels_.draw(look_, std::max(16, int(width * share)), std::max(16, int(height * share)), expose);
    glFinish();
    const double took = glfwGetTime() - before;
    if (moves && took > k_slow_frame) reduction_ = std::max(0.35f, reduction_ * 0.8f);
    if (moves && took < k_slow_frame / 3) reduction_ = std::min(1.f, reduction_ * 1.1f);
    if (expose) is_exposed_ = true;
    if (!drawn && panel_error_ != message(drawn.error()))
        session_.complain(drawn.error()), panel_error_ = message(drawn.error());

    const std::string reference =
        reference_ < 0 ? "no reference"
                       : std::filesystem::path(session_.subjects()[std::size_t(reference_)]->path).filename().string();
    const bool is_measured = reference_ >= 0 && !session_.subjects()[std::size_t(reference_)]->is_model();
    const std::array<std::string, 3> captions{
        (is_measured ? "measured: " : "reference: ") + reference, name_of_fit(),
        "difference: fit - " + std::string(is_measured ? "measured" : "reference")};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (const auto which : {Panels::reference, Panels::fit, Panels::difference}) {
        if (which > 0) ImGui::SameLine();
        ImGui::BeginGroup();
        const bool is_late = which == Panels::fit && session_.fitted() && session_.fitted()->quick;
        ImGui::PushClipRect(ImGui::GetCursorScreenPos(), {ImGui::GetCursorScreenPos().x + width, 1e4f}, true);
        ImGui::TextColored(is_late ? k_hint : ImVec4{1, 1, 1, 1}, "%s", captions[std::size_t(which)].c_str());
        ImGui::PopClipRect();
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        ImGui::PushID(which);
        ImGui::InvisibleButton("picture", {width, height},
                               ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
        ImGui::PopID();
        const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
        list.AddImage(ImTextureID(std::uintptr_t(panels_.texture(which))), corner,
                      {corner.x + width, corner.y + height}, {0, 1}, {1, 0});
        ImGui::PushClipRect(corner, {corner.x + width, corner.y + height}, true);
        if (which != Panels::difference && !panels_.has(which)) {
            const bool refused = which == Panels::reference && reference_ >= 0;
            const char* const why = refused          ? "cannot be drawn here:\nsee the message below"
                                    : reference_ < 0 ? "Drop a measurement or\na model on this window."
                                                     : "fitting ...";
            list.AddText({corner.x + width / 2 - 70, corner.y + height / 2 - 12}, IM_COL32(255, 255, 255, 200), why);
        } else if (which != Panels::difference) {
            draw_lights(corner, width, height, hovered);
        }
        ImGui::PopClipRect();
        const ImGuiIO& io = ImGui::GetIO();
        if (active && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
            const double right = double(io.MouseDelta.x) / double(height) * k_pi,
                         up = double(-io.MouseDelta.y) / double(height) * k_pi;
            if (dragged_light_ >= 0 || ImGui::IsMouseDown(1))
                turn_light(look_, dragged_light_ >= 0 ? dragged_light_ : look_.light, right, up);
            else
                orbit(look_, -right, -up);
        }
        if (hovered && io.MouseWheel != 0) zoom(look_, std::pow(1.1, double(io.MouseWheel)));
        if (which == Panels::difference)
            draw_scale(width);
        else if (which == Panels::reference)
            ImGui::TextColored(k_dim, "drag: orbit   wheel: zoom   yellow dots: lights");
        else
            ImGui::TextColored(
                k_dim, "%s",
                fmt::format("exposure {:+.2f} stops{}", std::log2(look_.exposure), look_.automatic ? ", automatic" : "")
                    .c_str());
        ImGui::EndGroup();
    }
    if (!ImGui::IsMouseDown(0)) dragged_light_ = -1;
    ImGui::End();
}

void Window::draw_measures() {
    const auto& fitted = session_.fitted();
    const Subject* reference = reference_ < 0 ? nullptr : session_.subjects()[std::size_t(reference_)].get();
    const auto* measured = reference ? std::get_if<Measured>(&reference->content) : nullptr;
    const bool is_scattered = measured && std::holds_alternative<Scattered>(measured->table);
    ImGui::TextColored(k_hint, "%s",
                       fmt::format("Errors within {:.0f}\xC2\xB0, against {}", session_.max_theta() / k_degree,
                                   is_scattered ? "interpolated samples"
                                   : measured   ? "measured"
                                                : "the reference")
                           .c_str());
    if (!fitted) return ImGui::Text("none yet");
    if (ImGui::BeginTable("measures", 3, ImGuiTableFlags_SizingStretchProp)) {
        ImGui::TableSetupColumn("measure", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("matrix", ImGuiTableColumnFlags_WidthFixed, 60);
        ImGui::TableSetupColumn("held out", ImGuiTableColumnFlags_WidthFixed, 60);
        ImGui::TableHeadersRow();
        for (const MeasureName& measure : k_measures) {
            ImGui::TableNextColumn();
            const bool is_followed = fitted->from.empty() && &measure == &measure_named_for(fitted->choice.objective);
            ImGui::TextColored(is_followed ? k_hint : ImVec4{1, 1, 1, 1}, "%s", latin(measure.title).c_str());
            for (const auto* of : {&fitted->matrix, &fitted->heldout}) {
                ImGui::TableNextColumn();
                ImGui::Text("%s", *of ? text(measure, **of).c_str() : "...");
            }
        }
        ImGui::TableNextColumn();
        ImGui::Text("albedo error");
        ImGui::TableNextColumn();
        ImGui::Text("%s", fitted->albedo_error ? percent(*fitted->albedo_error).c_str() : "...");
        ImGui::EndTable();
    }
    ImGui::TextColored(k_dim, "Yellow: what the objective follows.");
}

void Window::draw_below(ImVec2 at, ImVec2 size) {
    ImGui::SetNextWindowPos(at), ImGui::SetNextWindowSize(size);
    ImGui::Begin("plots", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    const float gap = ImGui::GetStyle().ItemSpacing.x,
                width = std::floor((ImGui::GetContentRegionAvail().x - 2 * gap - 40) / 3);
    ImGui::BeginGroup();
    ImGui::TextColored(k_hint, "Slice: f cos(theta_v), plane of the light");
    ImGui::SetNextItemWidth(0.45f * width);
    float degrees = float(look_.theta_l / k_degree);
    if (ImGui::SliderFloat("light theta_l", &degrees, 0, 85, "%.0f\xC2\xB0"))
        look_.theta_l = double(degrees) * k_degree;
    ImGui::SameLine();
    ImGui::Checkbox("log", &look_.logarithmic);
    draw_slices(slice_of_reference_ ? &*slice_of_reference_ : nullptr, slice_of_fit_ ? &*slice_of_fit_ : nullptr,
                look_.theta_l, look_.logarithmic, std::min(width, 1.7f * (size.y - 110)));
    ImGui::TextColored(k_dim, "dots: reference, lines: fit; red, green, blue");
    ImGui::EndGroup();
    ImGui::SameLine(width + 2 * gap);
    ImGui::BeginGroup();
    ImGui::TextColored(k_hint, "Lobes: where each is half its peak or more");
    const bool over_lights = session_.fitted() && is_seen_over_lights(session_.fitted()->model);
    ImGui::TextColored(
        k_dim, over_lights ? "over light directions, seen from there" : "over view directions, under the same light");
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float dome = std::min(width, (size.y - 80) / 0.85f);
    draw_lobes(lobes_, over_lights ? "view" : "light", look_.theta_l, dome_azimuth_, dome_elevation_, dome);
    const ImVec2 end = ImGui::GetCursorScreenPos();
    ImGui::SetCursorScreenPos(corner);
    ImGui::InvisibleButton("dome", {dome, std::max(20.f, end.y - corner.y)});
    if (ImGui::IsItemActive()) {
        dome_azimuth_ -= double(ImGui::GetIO().MouseDelta.x) * 0.01;
        dome_elevation_ = std::clamp(dome_elevation_ + double(ImGui::GetIO().MouseDelta.y) * 0.01, 0.1, k_pi / 2);
    }
    ImGui::EndGroup();
    ImGui::SameLine(2 * (width + gap) + gap);
    ImGui::BeginGroup();
    draw_measures();
    if (!lobes_.empty() && ImGui::BeginTable("lobes", 4, ImGuiTableFlags_SizingStretchProp)) {
        ImGui::TableSetupColumn("lobe");
        ImGui::TableSetupColumn("energy");
        ImGui::TableSetupColumn("centre");
        ImGui::TableSetupColumn("width");
        ImGui::TableHeadersRow();
        for (std::size_t k = 0; k < lobes_.size(); ++k) {
            const SeenLobe& lobe = lobes_[k];
            const auto at_peak = angles(to_double(lobe.centre));
            ImGui::TableNextColumn();
            const ImVec2 place = ImGui::GetCursorScreenPos();
            ImDrawList& list = *ImGui::GetWindowDrawList();
            list.AddRectFilled({place.x, place.y + 2}, {place.x + 10, place.y + 12}, lobe_colour(k));
            const float most = std::max({lobe.peak.r, lobe.peak.g, lobe.peak.b, 1e-30f});
            const auto shown = [&](float x) { return srgb_encoded(std::clamp(x / most, 0.f, 1.f)); };
            list.AddRectFilled({place.x + 13, place.y + 2}, {place.x + 23, place.y + 12},
                               colour_of({shown(lobe.peak.r), shown(lobe.peak.g), shown(lobe.peak.b)}));
            ImGui::Dummy({24, 12});
            if (ImGui::IsItemHovered()) ImGui::SetTooltip("in the plot | its own colour");
            ImGui::TableNextColumn(), ImGui::Text("%s", fmt::format("{:.1f} %", 100 * lobe.share).c_str());
            ImGui::TableNextColumn(),
                ImGui::Text("%s", fmt::format("{:.0f}\xC2\xB0", at_peak.theta / k_degree).c_str());
            ImGui::TableNextColumn(), ImGui::Text("%s", fmt::format("{:.1f}\xC2\xB0", lobe.width / k_degree).c_str());
        }
        ImGui::EndTable();
    }
    ImGui::EndGroup();
    ImGui::End();
}

void Window::draw_messages(ImVec2 at, ImVec2 size) {
    ImGui::SetNextWindowPos(at), ImGui::SetNextWindowSize(size);
    ImGui::Begin("messages", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove);
    const auto& messages = session_.messages();
    if (messages.empty()) ImGui::TextColored(k_dim, "Press H for the keys. Files may be dropped on this window.");
    for (auto one = messages.rbegin(); one != messages.rend(); ++one) {
        ImGui::PushStyleColor(ImGuiCol_Text, one->is_error ? k_red : ImVec4{1, 1, 1, 1});
        ImGui::TextWrapped("%s", one->text.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::End();
}

void Window::draw_help() {
    if (!look_.help) return;
    ImGui::SetNextWindowFocus();
    ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x / 2, ImGui::GetIO().DisplaySize.y / 2}, 0, {0.5f, 0.5f});
    ImGui::Begin("Keys", &look_.help, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
    if (ImGui::BeginTable("keys", 4, ImGuiTableFlags_SizingFixedFit)) {
        // Keys without words of their own go on with the line before.
        std::vector<std::pair<std::string, std::string>> lines;
        for (const Key& key : keys())
            if (key.what.empty())
                lines.back().first += ", " + std::string(key.name);
            else
                lines.emplace_back(key.name, key.what);
        const std::size_t half = (lines.size() + 1) / 2;
        for (std::size_t i = 0; i < half; ++i)
            for (const std::size_t k : {i, i + half}) {
                ImGui::TableNextColumn(),
                    ImGui::TextColored(k_hint, "%s", k < lines.size() ? lines[k].first.c_str() : "");
                ImGui::TableNextColumn(), ImGui::Text("%s   ", k < lines.size() ? lines[k].second.c_str() : "");
            }
        ImGui::EndTable();
    }
    ImGui::Text(
        "Mouse: drag a picture to orbit, a yellow dot to move that light, with the right button the chosen light; "
        "wheel: zoom.");
    ImGui::End();
}

void Window::draw_everything() {
    const ImVec2 all = ImGui::GetIO().DisplaySize;
    const float right = all.x - k_controls, pictures = std::floor((all.y - k_messages) * 0.55f);
    draw_controls({0, 0}, {k_controls, all.y});
    draw_panels({k_controls, 0}, {right, pictures});
    draw_below({k_controls, pictures}, {right, all.y - k_messages - pictures});
    draw_messages({k_controls, all.y - k_messages}, {right, k_messages});
    draw_help();
}

Image8 Window::read() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    Image8 image(width, height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadBuffer(GL_BACK);
    std::vector<Rgb8> pixels(image.pixels.size());
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    for (int y = 0; y < height; ++y)
        std::copy_n(&pixels[std::size_t(height - 1 - y) * std::size_t(width)], width, &image.at(0, y));
    return image;
}

void Window::save() {
    look_.save = false;
    std::vector<std::string> inputs;
    for (const auto& subject : session_.subjects()) inputs.push_back(subject->path);
    if (const auto writable = check_outputs(inputs, {typed_model_}); !writable)
        session_.complain(writable.error());
    else
        session_.save(typed_model_);
}

/// The next fit is asked for when the one before is there; the picture turns all the while.
void Window::time_refits(int count) {
    const double now = glfwGetTime();
    orbit(look_, 1 * k_degree, 0);
    if (!waits_ && timed_ < count && session_.stage() == Stage::idle && session_.fitted()) {
        FitChoice choice = session_.choice();
        choice.lobes = 6 + (choice.lobes + 1) % 5;
        session_.choose(choice);
        waits_ = true, swapped_after_.clear(), frames_ = 0, slowest_ = 0, asked_ = last_frame_ = now;
        return;
    }
    if (!waits_) return void(look_.quit = timed_ >= count);
    ++frames_;
    slowest_ = std::max(slowest_, now - last_frame_);
    last_frame_ = now;
    const auto& fitted = session_.fitted();
    const bool is_new = session_.stage() != Stage::fitting && fitted && fitted->seconds != swapped_;
    if (is_new) swapped_ = fitted->seconds, swapped_after_.push_back(now - asked_);
    if (session_.stage() != Stage::measuring && session_.stage() != Stage::idle) return;
    waits_ = false;
    ++timed_;
    fmt::print("J={}: fits on display after {:.2f} s; {:.1f} frames/s, slowest frame {:.0f} ms\n",
               fitted ? fitted->choice.lobes : 0, fmt::join(swapped_after_, ", "), frames_ / (now - asked_),
               1000 * slowest_);
}

Result<Done> Window::run(const WindowOptions& options) {
    int settled = 0;
    while (!glfwWindowShouldClose(window_) && !look_.quit) {
        const double began = glfwGetTime();
        const bool is_busy = session_.stage() != Stage::idle;
        const bool moves = began - touched_ < k_rest || options.timed_refits > 0 || !options.screenshot.empty();
        is_busy || moves ? glfwPollEvents() : glfwWaitEventsTimeout(0.1);
        const bool was_automatic = look_.automatic;
        const bool swapped = session_.poll();
        if (options.timed_refits > 0) time_refits(options.timed_refits);
        take_mesh();
        take_materials(swapped || (!session_.fitted() && panels_.has(Panels::fit)));

        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        draw_everything();
        if (look_.automatic && !was_automatic) is_exposed_ = false;
        if (look_.save) save();
        ImGui::Render();
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, width, height);
        glClearColor(0.1f, 0.1f, 0.1f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());

        // With what it is waited for on display, some frames until everything has its place.
        settled = session_.stage() == Stage::idle ? settled + 1 : 0;
        if (!options.screenshot.empty() && settled == 5) return write_png(read(), options.screenshot);
        if (look_.screenshot) {
            look_.screenshot = false;
            std::string name;
            for (int i = 1; name.empty() || std::filesystem::exists(name); ++i) name = fmt::format("srbf-{}.png", i);
            const auto written = write_png(read(), name);
            written ? session_.say("Wrote " + name + ".") : session_.complain(written.error());
        }
        glfwSwapBuffers(window_);
        if (is_busy)
            if (const double left = k_frame_beside_fit - (glfwGetTime() - began); left > 0) glfwWaitEventsTimeout(left);
    }
    return Done{};
}

}  // namespace

Result<Done> run_window(Session& session, Look& look, const WindowOptions& options) {
    Screen screen;
    if (const auto opened = screen.open(options.width, options.height); !opened) return opened.error();
    glfwSwapInterval(options.timed_refits > 0 ? 0 : 1);
    auto panels = Panels::make(Dialect::gl_450);
    if (!panels) return panels.error();
    Window window(screen.window, session, look, *std::move(panels));
    glfwSetWindowUserPointer(screen.window, &window);
    // Before Dear ImGui's, which then call these.
    glfwSetKeyCallback(screen.window, [](GLFWwindow* of, int key, int scancode, int action, int modifiers) {
        if (action == GLFW_RELEASE || (modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) return;
        static_cast<Window*>(glfwGetWindowUserPointer(of))->key(name_of(key, scancode, modifiers));
    });
    glfwSetDropCallback(screen.window, [](GLFWwindow* of, int count, const char** paths) {
        for (int i = 0; i < count; ++i) static_cast<Window*>(glfwGetWindowUserPointer(of))->drop(paths[i]);
    });
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::GetStyle().WindowRounding = 0;
    ImGui_ImplGlfw_InitForOpenGL(screen.window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    screen.has_imgui = true;
    return window.run(options);
}

}  // namespace srbf
