#include "extras/view/controls.h"

#include <fmt/format.h>
#include <imgui_stdlib.h>

#include <cmath>
#include <filesystem>

#include "extras/render/environment.h"
#include "extras/view/ink.h"

namespace SRBF_NAMESPACE {
namespace {

void heading(const char* text) { ImGui::Spacing(), ImGui::TextColored(k_hint, "%s", text), ImGui::Separator(); }

void draw_files(Session& session) {
    const auto& subjects = session.subjects();
    if (subjects.empty()) ImGui::TextWrapped("Drop a measurement or a model on this window.");
    for (int i = 0; i < int(subjects.size()); ++i) {
        const Subject& subject = *subjects[std::size_t(i)];
        const std::string file = std::filesystem::path(subject.path).filename().string();
        ImGui::PushID(i);
        if (ImGui::RadioButton("##reference", session.reference() == i)) session.set_reference(i);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("the reference, on the left");
        ImGui::SameLine();
        const bool is_selected = session.fitted() && session.fitted()->from == subject.path;
        if (ImGui::Selectable(shortened(file, ImGui::GetContentRegionAvail().x).c_str(), is_selected))
            subject.is_model() ? session.show_model(i) : session.set_reference(i);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s\n%s", subject.path.c_str(),
                              subject.is_model() ? "model: click to compare it with the reference"
                                                 : "measurement: click to make it the reference");
        ImGui::PopID();
    }
}

void draw_environment(DisplayState& display, std::string& typed) {
    const bool is_file = display.has_environment() && display.environment != k_built_in_environment;
    if (ImGui::BeginCombo("environment", std::filesystem::path(display.environment).filename().c_str())) {
        for (const std::string& name : {std::string("none"), std::string(k_built_in_environment)})
            if (ImGui::Selectable(name.c_str(), display.environment == name)) display.environment = name;
        if (is_file) ImGui::Selectable(std::filesystem::path(display.environment).filename().c_str(), true);
        ImGui::EndCombo();
    }
    if (display.name_environment) ImGui::SetKeyboardFocusHere(), display.name_environment = false;
    if (ImGui::InputTextWithHint("its file", ".hdr or .exr, Enter", &typed, ImGuiInputTextFlags_EnterReturnsTrue))
        display.environment = typed;
    if (!display.has_environment()) return;
    float degrees = float(display.turned / k_degree);
    if (ImGui::SliderFloat("turned", &degrees, -180, 180, "%.0f\xC2\xB0")) display.turned = double(degrees) * k_degree;
    ImGui::Checkbox("lights as well", &display.lamps);
}

void draw_lights(DisplayState& display) {
    for (int k = 0; k < 3; ++k) {
        if (k > 0) ImGui::SameLine();
        if (ImGui::RadioButton(fmt::format("light {}", k + 1).c_str(), display.light == k)) display.light = k;
    }
    Rgb& irradiance = display.lights[std::size_t(display.light)].irradiance;
    if (float bright = irradiance.r; ImGui::SliderFloat("strength", &bright, 0, 10, "%.2f"))
        irradiance = {bright, bright, bright};
    write_wrapped(k_dim, "Drag a light's yellow dot, or the picture with the right button.");
}

}  // namespace

void Controls::draw_fit(Session& session) {
    FitChoice choice = sliding_.value_or(session.choice());
    bool changed = false, is_held = false;
    const auto slider = [&](const char* text, int& value, int lower, int upper) {
        const bool is_changed = ImGui::SliderInt(text, &value, lower, upper, "%d", ImGuiSliderFlags_AlwaysClamp);
        is_held = is_held || ImGui::IsItemActive();
        changed = changed || is_changed;
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
    combo("form", choice.form, int(k_forms.size()));
    combo("objective", choice.objective, 4);
    if (changed) sliding_ = choice;
    if (sliding_ && !is_held) {  // released
        session.choose(*sliding_);
        sliding_.reset();
    }
    const bool is_busy = session.stage() != Stage::idle;
    const char* const stage_names[] = {"", "editing", "fitting", "refining", "measuring"};
    if (is_busy) {
        const bool fits = session.stage() != Stage::measuring;
        ImGui::ProgressBar(fits ? float(session.fraction()) : 1.f, {-0.27f * ImGui::GetWindowWidth(), 0},
                           fmt::format("{} {:.1f} s", stage_names[int(session.stage())], session.waited()).c_str());
        ImGui::SameLine();
        if (ImGui::Button("Cancel", {-1, 0})) session.cancel();
    } else {
        const bool has_reference = session.reference() >= 0;
        if (ImGui::Button("Fit again", {-1, 0}) && has_reference) session.refit();
    }
    if (const auto& fitted = session.fitted(); fitted && fitted->from.empty())
        ImGui::TextColored(
            k_dim, "%s",
            fmt::format("{} fit in {:.2f} s", fitted->quick ? "quick" : "finished", fitted->seconds).c_str());
    else
        ImGui::TextColored(k_dim, "move a slider to fit the reference");
}

void Controls::draw_edit(Session& session) {
    ImGui::SetNextItemOpen(ImGui::GetWindowHeight() > 40 * ImGui::GetFrameHeightWithSpacing(), ImGuiCond_Once);
    if (!ImGui::CollapsingHeader("Edit")) return;
    EditChoice choice = edit_sliding_.value_or(session.edit_choice());
    bool changed = false, is_held = false;
    const auto slider = [&](const char* text, float& value, float lower, float upper, const char* format, float none,
                            ImGuiSliderFlags flags = 0) {
        const bool is_changed = ImGui::SliderFloat(text, &value, lower, upper, format, flags);
        is_held = is_held || ImGui::IsItemActive();
        changed = changed || is_changed;
        if (value == none) return;
        ImGui::SameLine(ImGui::GetWindowWidth() - 1.6f * ImGui::GetFrameHeight());
        ImGui::PushID(text);
        if (ImGui::SmallButton("x")) value = none, changed = true;
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("reset");
        ImGui::PopID();
    };
    constexpr ImGuiSliderFlags k_log = ImGuiSliderFlags_Logarithmic;
    ImGui::BeginDisabled(!session.can_edit());
    slider("roughness", choice.roughness, 1 / 3.f, 3, "\xC3\x97 %.2f", 1, k_log);
    slider("highlight", choice.highlight, 0, 3, "\xC3\x97 %.2f", 1);
    slider("its warmth", choice.highlight_warmth, -1, 1, "%+.2f", 0);
    slider("body", choice.body, 0, 3, "\xC3\x97 %.2f", 1);
    slider("its warmth##body", choice.body_warmth, -1, 1, "%+.2f", 0);
    slider("saturation", choice.saturation, 0, 3, "\xC3\x97 %.2f", 1);
    slider("hue", choice.hue, -180, 180, "%.0f\xC2\xB0", 0);
    ImGui::EndDisabled();
    if (changed) edit_sliding_ = choice;
    if (edit_sliding_ && !is_held) {  // released
        session.edit(*edit_sliding_);
        edit_sliding_.reset();
    }
}

void Controls::draw_save(const Session& session, DisplayState& display) {
    if (display.name_model) ImGui::SetKeyboardFocusHere(), display.name_model = false;
    if (typed_model_.empty() && session.reference() >= 0) {
        const std::filesystem::path path = session.subjects()[std::size_t(session.reference())]->path;
        typed_model_ = path.stem().string() + ".srbf";
    }
    ImGui::InputText("##model", &typed_model_);
    ImGui::SameLine();
    if (ImGui::Button("Save model", {-1, 0})) display.save = true;
}

void Controls::draw_picture(DisplayState& display) {
    if (ImGui::BeginCombo("mesh", std::filesystem::path(display.mesh).filename().c_str())) {
        for (const auto name : k_built_in_meshes)
            if (ImGui::Selectable(std::string(name).c_str(), display.mesh == name)) display.mesh = name;
        ImGui::EndCombo();
    }
    if (display.name_mesh) ImGui::SetKeyboardFocusHere(), display.name_mesh = false;
    if (ImGui::InputTextWithHint("mesh file", ".ply or .obj, Enter", &typed_mesh_,
                                 ImGuiInputTextFlags_EnterReturnsTrue))
        display.mesh = typed_mesh_;
    float stops = std::log2(display.exposure);
    if (ImGui::SliderFloat("exposure", &stops, -8, 8, "%+.2f stops"))
        display.exposure = std::exp2(stops), display.automatic = false;
    ImGui::Checkbox("automatic exposure", &display.automatic);
    float limit = display.unit() * display.full_scale;
    if (ImGui::SliderFloat("difference", &limit, display.unit() * k_least_scale, display.unit() * k_most_scale,
                           display.in_delta_e ? "%.3g ΔE" : "±%.3g", ImGuiSliderFlags_Logarithmic))
        display.full_scale = limit / display.unit();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(display.in_delta_e ? "the ΔE_ITP of full red"
                                             : "the difference of full red or blue;\n1 is the brightness of white");
    int is_wiped = display.wipe;
    ImGui::RadioButton("side by side", &is_wiped, 0), ImGui::SameLine(), ImGui::RadioButton("wipe", &is_wiped, 1);
    display.wipe = is_wiped == 1;
    ImGui::Checkbox("difference in ΔE", &display.in_delta_e);
    if (ImGui::Button("Screenshot")) display.screenshot = true;
    ImGui::SameLine();
    if (ImGui::Button("Keys (H)")) display.help = !display.help;
}

void Controls::draw(Session& session, DisplayState& display, ImVec2 corner, ImVec2 size) {
    ImGui::SetNextWindowPos(corner), ImGui::SetNextWindowSize(size);
    ImGui::Begin("controls", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    ImGui::PushItemWidth(0.54f * size.x);
    heading("Files");
    draw_files(session);
    heading("Fit");
    draw_fit(session);
    draw_edit(session);
    heading("Save");
    draw_save(session, display);
    heading("Picture");
    draw_picture(display);
    heading("Environment");
    draw_environment(display, typed_environment_);
    if (display.has_lights()) {
        heading("Lights");
        draw_lights(display);
    }
    ImGui::PopItemWidth();
    ImGui::End();
}

void Controls::save(Session& session) const {
    std::vector<std::string> inputs;
    for (const auto& subject : session.subjects()) inputs.push_back(subject->path);
    if (const auto writable = check_outputs(inputs, {typed_model_}); !writable)
        session.complain(writable.error());
    else
        session.save(typed_model_);
}

}  // namespace srbf
