#include "extras/view/readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "extras/render/tone.h"
#include "extras/view/ink.h"
#include "extras/view/plots.h"

namespace SRBF_NAMESPACE {
namespace {

/// Replaces θ and Δ if the font lacks them; Dear ImGui's own font has no Greek.
std::string latin(std::string text) {
    if (ImGui::GetFont()->FindGlyphNoFallback(ImWchar(0x3b8))) return text;
    for (const auto& [letter, name] : {std::pair("\xCE\xB8", " theta_"), {"\xCE\x94", "Delta "}})
        for (std::size_t position; (position = text.find(letter)) != std::string::npos;)
            text.replace(position, 2, name);
    return text;
}

/// The values of both slices at the view angle [rad].
std::string values_text(const Slice* reference, const Slice* fit, double angle) {
    std::string text = fmt::format("{:.1f}\xC2\xB0", angle / k_degree);
    const auto add = [&](const char* name, const Slice* slice) {
        if (slice == nullptr || slice->angle.empty()) return;
        const auto nearest =
            std::ranges::min_element(slice->angle, {}, [&](float a) { return std::abs(double(a) - angle); });
        const Rgb f = slice->f[std::size_t(nearest - slice->angle.begin())];
        text += is_finite(f) ? fmt::format("\n{}: {:.4g} {:.4g} {:.4g}", name, f.r, f.g, f.b)
                             : fmt::format("\n{}: not measured", name);
    };
    add("reference", reference), add("fit", fit);
    return text;
}

}  // namespace

void Readings::take(const Session& session, const DisplayState& display, bool is_new_fit) {
    const bool has_lost_fit = !session.fitted() && slice_of_fit_;
    const bool is_same = theta_l_ == display.theta_l && phi_v_ == display.phi_v;
    if (!is_new_fit && !has_lost_fit && reference_ == session.reference() && is_same) return;
    reference_ = session.reference();
    theta_l_ = display.theta_l, phi_v_ = display.phi_v;
    if (reference_ >= 0) {
        const Subject& reference = *session.subjects()[std::size_t(reference_)];
        slice_of_reference_ = slice(evaluator(reference), theta_l_, phi_v_, is_two_sided(reference.content));
    }
    slice_of_fit_.reset();
    lobes_.clear();
    if (const auto& fitted = session.fitted()) {
        slice_of_fit_ = slice(evaluator(fitted->model), theta_l_, phi_v_, is_two_sided(fitted->model));
        lobes_ = lobe_slices(fitted->model, to_float(spherical(theta_l_, k_pi)));
    }
}

void Readings::draw_slice(DisplayState& display, float width, float height) const {
    write_wrapped(k_hint, "Slice: f cos(theta_v) over the view's angle");
    const char* const plane = "plane, from the light's";
    const float beside = ImGui::CalcTextSize(plane).x + ImGui::GetStyle().ItemInnerSpacing.x;
    const auto slider = [&](const char* name, double& angle, float limit) {
        ImGui::SetNextItemWidth(std::min(0.4f * width, width - beside));
        float degrees = float(angle / k_degree);
        if (ImGui::SliderFloat(name, &degrees, 0, limit, "%.0f\xC2\xB0")) angle = double(degrees) * k_degree;
    };
    slider("light theta_l", display.theta_l, 85);
    ImGui::SameLine();
    ImGui::Checkbox("log", &display.logarithmic);
    slider(plane, display.phi_v, 90);
    const Slice *reference = slice_of_reference_ ? &*slice_of_reference_ : nullptr,
                *fit = slice_of_fit_ ? &*slice_of_fit_ : nullptr;
    const double under_mouse = draw_slices(reference, fit, display.theta_l, display.phi_v, display.logarithmic,
                                           std::min(width, 1.7f * (height - 8 * ImGui::GetTextLineHeight())));
    if (std::isfinite(under_mouse)) ImGui::SetTooltip("%s", values_text(reference, fit, under_mouse).c_str());
    write_wrapped(k_dim, "dots: reference; lines: fit; red, green, blue");
}

void Readings::draw_dome(const Session& session, double theta_l, float width, float height) {
    write_wrapped(k_hint, "Lobes: where each exceeds half its peak");
    const bool over_lights = session.fitted() && is_over_lights(session.fitted()->model);
    write_wrapped(k_dim, over_lights ? "over light directions, for one view" : "over view directions, for one light");
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float dome = std::min(width, (height - 5 * ImGui::GetTextLineHeight()) / 0.85f);
    draw_lobes(lobes_, over_lights ? "view" : "light", theta_l, dome_azimuth_, dome_elevation_, dome);
    const ImVec2 end = ImGui::GetCursorScreenPos();
    ImGui::SetCursorScreenPos(corner);
    ImGui::InvisibleButton("dome", {dome, std::max(20.f, end.y - corner.y)});
    if (ImGui::IsItemActive()) {
        dome_azimuth_ -= double(ImGui::GetIO().MouseDelta.x) * 0.01;
        dome_elevation_ = std::clamp(dome_elevation_ + double(ImGui::GetIO().MouseDelta.y) * 0.01, 0.1, k_pi / 2);
    }
}

void Readings::draw_verdict(const Session& session) const {
    const auto& fitted = session.fitted();
    write_wrapped(k_hint, "Visible error");
    if (!fitted) return ImGui::Text("none yet");
    if (fitted->edit != EditChoice{}) return ImGui::TextWrapped("an edited model has none");
    if (!fitted->errors) return ImGui::Text("...");
    ImGui::TextWrapped("%s", latin(headline(*fitted->errors)).c_str());
}

void Readings::draw_measures(const Session& session) const {
    const auto& fitted = session.fitted();
    const Subject* reference = reference_ < 0 ? nullptr : session.subjects()[std::size_t(reference_)].get();
    const auto* measured = reference ? std::get_if<Measured>(&reference->content) : nullptr;
    const bool is_scattered = measured && std::holds_alternative<ScatteredSamples>(measured->table);
    write_wrapped(k_dim, fmt::format("within {:.0f}\xC2\xB0, against {}", session.max_theta() / k_degree,
                                     is_scattered ? "samples; albedo: with gaps filled by microfacet models"
                                     : reference && is_two_sided(reference->content) ? "the front's reflection"
                                     : measured                                      ? "measured"
                                                                                     : "the reference"));
    if (!fitted) return;
    if (ImGui::BeginTable("measures", 3, ImGuiTableFlags_SizingStretchProp)) {
        const std::string albedo = fitted->errors ? percent(fitted->errors->albedo_error) : "...";
        float number = std::max(ImGui::CalcTextSize("held out").x, ImGui::CalcTextSize(albedo.c_str()).x);
        for (const MeasureName& measure : k_measures)
            for (const auto* measures : {fitted->errors ? &fitted->errors->matrix : nullptr,
                                         fitted->errors ? &fitted->errors->heldout : nullptr})
                if (measures) number = std::max(number, ImGui::CalcTextSize(text(measure, *measures).c_str()).x);
        ImGui::TableSetupColumn("measure", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("matrix", ImGuiTableColumnFlags_WidthFixed, number);
        ImGui::TableSetupColumn("held out", ImGuiTableColumnFlags_WidthFixed, number);
        ImGui::TableHeadersRow();
        for (const MeasureName& measure : k_measures) {
            ImGui::TableNextColumn();
            const bool is_of_objective =
                fitted->from.empty() && &measure == &measure_named_for(fitted->choice.objective);
            write_wrapped(is_of_objective ? k_hint : k_white, latin(measure.title));
            for (const auto* measures : {fitted->errors ? &fitted->errors->matrix : nullptr,
                                         fitted->errors ? &fitted->errors->heldout : nullptr}) {
                ImGui::TableNextColumn();
                ImGui::Text("%s", measures ? text(measure, *measures).c_str() : "...");
            }
        }
        ImGui::TableNextColumn();
        ImGui::Text("albedo error");
        ImGui::TableNextColumn();
        ImGui::Text("%s", albedo.c_str());
        ImGui::EndTable();
    }
    write_wrapped(k_dim, "Yellow: the measure of the objective.");
}

void Readings::draw_lobe_table() const {
    if (lobes_.empty() || !ImGui::BeginTable("lobes", 4, ImGuiTableFlags_SizingStretchProp)) return;
    ImGui::TableSetupColumn("lobe");
    ImGui::TableSetupColumn("energy");
    ImGui::TableSetupColumn("centre");
    ImGui::TableSetupColumn("width");
    ImGui::TableHeadersRow();
    for (std::size_t k = 0; k < lobes_.size(); ++k) {
        const LobeSlice& lobe = lobes_[k];
        const auto peak_angles = angles(to_double(lobe.centre));
        ImGui::TableNextColumn();
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        ImDrawList& list = *ImGui::GetWindowDrawList();
        list.AddRectFilled({corner.x, corner.y + 2}, {corner.x + 10, corner.y + 12}, lobe_colour(k));
        const float largest = std::max({lobe.peak.r, lobe.peak.g, lobe.peak.b, 1e-30f});
        const auto encoded = [&](float x) { return float(srgb_encoded(double(std::clamp(x / largest, 0.f, 1.f)))); };
        list.AddRectFilled({corner.x + 13, corner.y + 2}, {corner.x + 23, corner.y + 12},
                           colour_of({encoded(lobe.peak.r), encoded(lobe.peak.g), encoded(lobe.peak.b)}));
        ImGui::Dummy({24, 12});
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("in the plot | its own colour");
        ImGui::TableNextColumn(), ImGui::Text("%s", fmt::format("{:.1f} %", 100 * lobe.share).c_str());
        ImGui::TableNextColumn(),
            ImGui::Text("%s", fmt::format("{:.0f}\xC2\xB0", peak_angles.theta / k_degree).c_str());
        ImGui::TableNextColumn(), ImGui::Text("%s", fmt::format("{:.1f}\xC2\xB0", lobe.width / k_degree).c_str());
    }
    ImGui::EndTable();
}

void Readings::draw(const Session& session, DisplayState& display, ImVec2 corner, ImVec2 size) {
    ImGui::SetNextWindowPos(corner), ImGui::SetNextWindowSize(size);
    ImGui::Begin("plots", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    const ImVec2 region = ImGui::GetContentRegionAvail();
    const float gap = ImGui::GetStyle().ItemSpacing.x, width = std::floor((region.x - 2 * gap) / 3);
    // A column clips text that is too wide, and scrolls if it is too long.
    const auto column = [&](const char* name, const auto& draw) {
        ImGui::BeginChild(name, {width, region.y});
        draw(ImGui::GetContentRegionAvail().x);
        ImGui::EndChild();
    };
    column("slice", [&](float column_width) { draw_slice(display, column_width, size.y); });
    ImGui::SameLine();
    column("lobes", [&](float column_width) { draw_dome(session, display.theta_l, column_width, size.y); });
    ImGui::SameLine();
    column("errors", [&](float) {
        draw_verdict(session);
        if (!ImGui::BeginTabBar("tables")) return;
        if (ImGui::BeginTabItem("errors")) draw_measures(session), ImGui::EndTabItem();
        if (ImGui::BeginTabItem("lobes")) draw_lobe_table(), ImGui::EndTabItem();
        ImGui::EndTabBar();
    });
    ImGui::End();
}

}  // namespace srbf
