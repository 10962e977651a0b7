#include "extras/view/controls.h"

#include <fmt/format.h>
#include <imgui_stdlib.h>

#include <cmath>
#include <filesystem>

#include "extras/render/environment.h"
#include "extras/view/ink.h"

namespace srbf {
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
        const bool shown = session.fitted() && session.fitted()->from == subject.path;
        if (ImGui::Selectable(shortened(file, ImGui::GetContentRegionAvail().x).c_str(), shown))
            subject.is_model() ? session.show_model(i) : session.set_reference(i);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s\n%s", subject.path.c_str(),
                              subject.is_model() ? "model: click to hold it against the reference"
                                                 : "measurement: click to make it the reference");
        ImGui::PopID();
    }
}

void draw_environment(Look& look, std::string& typed) {
    const bool is_file = look.has_environment() && look.environment != k_built_in_environment;
    if (ImGui::BeginCombo("environment", std::filesystem::path(look.environment).filename().c_str())) {
        for (const std::string& name : {std::string("none"), std::string(k_built_in_environment)})
            if (ImGui::Selectable(name.c_str(), look.environment == name)) look.environment = name;
        if (is_file) ImGui::Selectable(std::filesystem::path(look.environment).filename().c_str(), true);
        ImGui::EndCombo();
    }
    if (look.name_environment) ImGui::SetKeyboardFocusHere(), look.name_environment = false;
    if (ImGui::InputTextWithHint("its file", ".hdr or .exr, Enter", &typed, ImGuiInputTextFlags_EnterReturnsTrue))
        look.environment = typed;
    if (!look.has_environment()) return;
    float degrees = float(look.turned / k_degree);
    if (ImGui::SliderFloat("turned", &degrees, -180, 180, "%.0f\xC2\xB0")) look.turned = double(degrees) * k_degree;
    ImGui::Checkbox("lights as well", &look.lamps);
}

void draw_lights(Look& look) {
    for (int k = 0; k < 3; ++k) {
        if (k > 0) ImGui::SameLine();
        if (ImGui::RadioButton(fmt::format("light {}", k + 1).c_str(), look.light == k)) look.light = k;
    }
    Rgb& irradiance = look.lights[std::size_t(look.light)].irradiance;
    if (float bright = irradiance.r; ImGui::SliderFloat("strength", &bright, 0, 10, "%.2f"))
        irradiance = {bright, bright, bright};
    write_wrapped(k_dim, "Drag a light's yellow dot, or the picture with the right button.");
}

}  // namespace

void Controls::draw_fit(Session& session) {
    FitChoice choice = sliding_.value_or(session.choice());
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
    combo("form", choice.form, int(k_forms.size()));
    combo("objective", choice.objective, 4);
    if (changed) sliding_ = choice;
    if (sliding_ && !held) {  // released
        session.choose(*sliding_);
        sliding_.reset();
    }
    const bool is_busy = session.stage() != Stage::idle;
    const char* const what[] = {"", "fitting", "refining", "measuring"};
    if (is_busy) {
        const bool fits = session.stage() != Stage::measuring;
        ImGui::ProgressBar(fits ? float(session.fraction()) : 1.f, {-0.27f * ImGui::GetWindowWidth(), 0},
                           fmt::format("{} {:.1f} s", what[int(session.stage())], session.waited()).c_str());
        ImGui::SameLine();
        if (ImGui::Button("Cancel", {-1, 0})) session.cancel();
    } else {
        const bool can = session.reference() >= 0;
        if (ImGui::Button("Fit again", {-1, 0}) && can) session.refit();
    }
    if (const auto& fitted = session.fitted(); fitted && fitted->from.empty())
        ImGui::TextColored(
            k_dim, "%s",
            fmt::format("{} fit in {:.2f} s", fitted->quick ? "quick" : "finished", fitted->seconds).c_str());
    else
        ImGui::TextColored(k_dim, "move a slider to fit the reference");
}

void Controls::draw_save(const Session& session, Look& look) {
    if (look.name_model) ImGui::SetKeyboardFocusHere(), look.name_model = false;
    if (typed_model_.empty() && session.reference() >= 0) {
        const std::filesystem::path path = session.subjects()[std::size_t(session.reference())]->path;
        typed_model_ = path.stem().string() + ".srbf";
    }
    ImGui::InputText("##model", &typed_model_);
    ImGui::SameLine();
    if (ImGui::Button("Save model", {-1, 0})) look.save = true;
}

void Controls::draw_picture(Look& look) {
    if (ImGui::BeginCombo("mesh", std::filesystem::path(look.mesh).filename().c_str())) {
        for (const auto name : k_built_in_meshes)
            if (ImGui::Selectable(std::string(name).c_str(), look.mesh == name)) look.mesh = name;
        ImGui::EndCombo();
    }
    if (look.name_mesh) ImGui::SetKeyboardFocusHere(), look.name_mesh = false;
    if (ImGui::InputTextWithHint("mesh file", ".ply or .obj, Enter", &typed_mesh_,
                                 ImGuiInputTextFlags_EnterReturnsTrue))
        look.mesh = typed_mesh_;
    float stops = std::log2(look.exposure);
    if (ImGui::SliderFloat("exposure", &stops, -8, 8, "%+.2f stops"))
        look.exposure = std::exp2(stops), look.automatic = false;
    ImGui::Checkbox("automatic exposure", &look.automatic);
    float most = look.unit() * look.full_scale;
    if (ImGui::SliderFloat("difference", &most, look.unit() * k_least_scale, look.unit() * k_most_scale,
                           look.in_delta_e ? "%.3g ΔE" : "±%.3g", ImGuiSliderFlags_Logarithmic))
        look.full_scale = most / look.unit();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(look.in_delta_e
                              ? "the ΔE_ITP that shows in full red"
                              : "the difference that shows in full red or blue;\n1 is the brightness of white");
    int wiped = look.wipe;
    ImGui::RadioButton("side by side", &wiped, 0), ImGui::SameLine(), ImGui::RadioButton("wipe", &wiped, 1);
    look.wipe = wiped == 1;
    ImGui::Checkbox("difference in ΔE", &look.in_delta_e);
    if (ImGui::Button("Screenshot")) look.screenshot = true;
    ImGui::SameLine();
    if (ImGui::Button("Keys (H)")) look.help = !look.help;
}

void Controls::draw(Session& session, Look& look, ImVec2 at, ImVec2 size) {
    ImGui::SetNextWindowPos(at), ImGui::SetNextWindowSize(size);
    ImGui::Begin("controls", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    ImGui::PushItemWidth(0.54f * size.x);
    heading("Files");
    draw_files(session);
    heading("Fit");
    draw_fit(session);
    heading("Save");
    draw_save(session, look);
    heading("Picture");
    draw_picture(look);
    heading("Environment");
    draw_environment(look, typed_environment_);
    if (look.has_lights()) {
        heading("Lights");
        draw_lights(look);
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
