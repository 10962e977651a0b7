#include "extras/view/pictures.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "brdf/frame.h"
#include "extras/render/app/raster.h"
#include "extras/view/ink.h"

namespace SRBF_NAMESPACE {
namespace {

/// During interaction, pictures that take longer than k_slow_frame [s] are drawn smaller. An interaction ends after
/// k_rest [s].
constexpr double k_slow_frame = 0.04, k_rest = 0.25;

std::string name_of_fit(const Session& session) {
    const auto& fitted = session.fitted();
    if (!fitted) return session.stage() == Stage::idle ? "no fit" : "fitting ...";
    std::string text = fitted->from.empty() ? "fit" : std::filesystem::path(fitted->from).filename().string();
    text += fmt::format(", {} bytes", payload_bytes(fitted->model));
    if (fitted->edit != EditChoice{}) text += ", edited";
    if (fitted->quick) text += session.stage() == Stage::idle ? " (quick)" : " (quick, refining ...)";
    return text;
}

std::string exposure_text(const DisplayState& display) {
    return fmt::format("exposure {:+.2f} stops{}", std::log2(display.exposure), display.automatic ? ", automatic" : "");
}

/// Draws the colour scale of differences, from darker to brighter.
void draw_scale(const DisplayState& display, float width) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float height = 12, middle = corner.x + width / 2;
    using D = RasterDevelopment;
    if (!display.in_delta_e)
        list.AddRectFilledMultiColor(corner, {middle, corner.y + height}, colour_of(D::k_darker), colour_of(D::k_equal),
                                     colour_of(D::k_equal), colour_of(D::k_darker));
    list.AddRectFilledMultiColor({display.in_delta_e ? corner.x : middle, corner.y},
                                 {corner.x + width, corner.y + height}, colour_of(D::k_equal), colour_of(D::k_brighter),
                                 colour_of(D::k_brighter), colour_of(D::k_equal));
    const ImU32 ink = IM_COL32(230, 230, 230, 255);
    const std::string upper = fmt::format("+{:.3g}", display.full_scale),
                      lower = fmt::format("-{:.3g}", display.full_scale);
    const std::string right =
        display.in_delta_e ? fmt::format("{:.3g} ΔE", display.unit() * display.full_scale) : "fit brighter " + upper;
    list.AddText({corner.x, corner.y + height}, ink, display.in_delta_e ? "0" : (lower + " fit darker").c_str());
    if (!display.in_delta_e) list.AddText({middle - 3, corner.y + height}, ink, "0");
    list.AddText({corner.x + width - ImGui::CalcTextSize(right.c_str()).x, corner.y + height}, ink, right.c_str());
    ImGui::Dummy({width, height + ImGui::GetTextLineHeight()});
}

}  // namespace

bool Pictures::moves() const { return touched_.seconds() < k_rest; }

void Pictures::take_mesh(Session& session, DisplayState& display) {
    if (mesh_ == display.mesh) return;
    auto mesh = load_mesh(display.mesh);
    if (!mesh) {
        session.complain(mesh.error());
        display.mesh = mesh_.empty() ? "ball" : mesh_;
        if (!mesh_.empty()) return;
        mesh = ball();
    }
    mesh_ = display.mesh;
    panels_.set_mesh(*mesh);
    is_exposed_ = false;
}

void Pictures::take_environment(Session& session, DisplayState& display) {
    if (environment_ == display.environment) return;
    Result<Done> done = Done{};
    if (display.has_environment()) {
        const auto loaded = load_environment(display.environment);
        done = loaded ? panels_.set_environment(&*loaded) : Result<Done>(loaded.error());
    } else {
        done = panels_.set_environment(nullptr);
    }
    if (!done) {
        session.complain(done.error());
        display.environment = environment_;
        return;
    }
    environment_ = display.environment;
    is_exposed_ = false;
}

void Pictures::set_material(Session& session, Panels::Which which, const Result<Material>& material,
                            std::function<Proposals()> propose) {
    const auto done =
        material ? panels_.set_material(which, *material, std::move(propose)) : Result<Done>(material.error());
    if (done) return;
    session.complain(done.error());
    (void)panels_.set_material(which, {});
}

void Pictures::take(Session& session, DisplayState& display, bool is_new_fit) {
    take_mesh(session, display);
    take_environment(session, display);
    if (reference_ != session.reference()) {
        reference_ = session.reference();
        const auto subject = session.subjects()[std::size_t(reference_)];
        set_material(session, Panels::reference, material_of(*subject), [subject] { return proposal_of(*subject); });
        is_exposed_ = false;
        is_new_fit = true;
    }
    if (session.fitted() && is_new_fit)
        set_material(session, Panels::fit, material_of(session.fitted()->model), [model = session.fitted()->model] {
            return proposal_of({"", model});
        });
    if (!session.fitted() && panels_.has(Panels::fit)) (void)panels_.set_material(Panels::fit, {});
}

void Pictures::draw_panels(Session& session, DisplayState& display, float width, float height) {
    std::string key = fmt::format("{} {} {}", display.azimuth, display.elevation, display.zoom);
    for (const auto& light : display.lights) key += fmt::format(" {} {}", light.towards.x, light.towards.y);
    key += fmt::format(" {}", display.turned);
    if (key != shown_key_) touch(), shown_key_ = key;
    const bool is_moving = moves();
    const float scale = is_moving ? reduction_ : 1;
    const bool expose = !is_exposed_ && (panels_.has(Panels::reference) || panels_.has(Panels::fit));
    const Stopwatch watch;
    const auto drawn =
        panels_.draw(display, std::max(16, int(width * scale)), std::max(16, int(height * scale)), expose, is_moving);
    glFinish();
    const double seconds = watch.seconds();
    if (is_moving && seconds > k_slow_frame) reduction_ = std::max(0.35f, reduction_ * 0.8f);
    if (is_moving && seconds < k_slow_frame / 3) reduction_ = std::min(1.f, reduction_ * 1.1f);
    is_exposed_ = display.automatic && (is_exposed_ || expose);
    is_whole_ = scale == 1;
    if (!drawn && error_ != message(drawn.error())) session.complain(drawn.error()), error_ = message(drawn.error());
}

void Pictures::draw_lights(DisplayState& display, ImVec2 corner, float width, float height, bool can_drag) {
    const Camera camera = camera_of(display, panels_.bounds());
    const Frame axes = frame(camera);
    const Vec3d diagonal = to_double(panels_.bounds().most) - to_double(panels_.bounds().least);
    const double radius = 0.5 * std::sqrt(dot(diagonal, diagonal)) / display.zoom, half = std::tan(camera.fov / 2);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int k = 0; k < 3; ++k) {
        const Vec3d position = camera.target + 0.72 * radius * display.lights[std::size_t(k)].towards - camera.eye;
        const double depth = -dot(position, axes.z);
        if (!(depth > 0)) continue;
        const ImVec2 marker{corner.x + width / 2 + float(dot(position, axes.x) / (depth * half) * height / 2),
                            corner.y + height / 2 - float(dot(position, axes.y) / (depth * half) * height / 2)};
        const bool behind = dot(display.lights[std::size_t(k)].towards, axes.z) < 0;
        const ImU32 colour = IM_COL32(255, 220, 90, behind ? 130 : 255);
        if (behind)
            list.AddCircle(marker, 6, colour, 0, 2);
        else
            list.AddCircleFilled(marker, 6, colour);
        list.AddCircle(marker, 7, IM_COL32(0, 0, 0, 160));
        if (k == display.light) list.AddCircle(marker, 10, colour, 0, 1.5f);
        list.AddText({marker.x + 9, marker.y - 14}, colour, fmt::format("{}", k + 1).c_str());
        const ImVec2 mouse = ImGui::GetMousePos();
        if (can_drag && ImGui::IsMouseClicked(0) && std::hypot(mouse.x - marker.x, mouse.y - marker.y) < 10)
            dragged_light_ = display.light = k;
    }
}

/// Rotates what is dragged: the environment, a light, or the camera.
void Pictures::drag(DisplayState& display, float height) {
    const ImVec2 delta = ImGui::GetIO().MouseDelta;
    if (delta.x == 0 && delta.y == 0) return;
    const double right = double(delta.x) / double(height) * k_pi, up = double(-delta.y) / double(height) * k_pi;
    if (display.has_environment() && (ImGui::GetIO().KeyCtrl || (ImGui::IsMouseDown(1) && !display.lamps)))
        turn_environment(display, right);
    else if (dragged_light_ >= 0 || ImGui::IsMouseDown(1))
        turn_light(display, dragged_light_ >= 0 ? dragged_light_ : display.light, right, up);
    else
        orbit(display, -right, -up);
}

std::string Pictures::caption(const Session& session, const DisplayState& display, Panels::Which which) const {
    const bool is_measured = reference_ >= 0 && !session.subjects()[std::size_t(reference_)]->is_model();
    if (which == Panels::fit) return name_of_fit(session);
    const std::string reference = is_measured ? "measured" : "reference";
    if (which == Panels::difference)
        return display.in_delta_e ? "difference in ΔE from " + reference : "difference: fit - " + reference;
    return reference + ": " +
           (reference_ < 0
                ? "no reference"
                : std::filesystem::path(session.subjects()[std::size_t(reference_)]->path).filename().string());
}

/// Shows the radiances of both materials under the mouse.
void Pictures::draw_reading(ImVec2 corner, float width, float height) const {
    const ImVec2 mouse = ImGui::GetMousePos();
    const float u = (mouse.x - corner.x) / width, v = (mouse.y - corner.y) / height;
    std::string text;
    for (const auto& [which, name] : {std::pair(Panels::reference, "reference"), {Panels::fit, "fit"}})
        if (const auto radiance = panels_.radiance_at(which, u, v))
            text += fmt::format("{}{}: {:.3g}, {:.3g}, {:.3g}", text.empty() ? "" : "\n", name, radiance->r,
                                radiance->g, radiance->b);
    if (!text.empty()) ImGui::SetTooltip("%s", text.c_str());
}

/// Draws one picture with the reference left of a divider and the fit right of it.
void Pictures::draw_wipe(const Session& session, DisplayState& display, float width, float height) {
    const float half = (width - ImGui::GetStyle().ItemSpacing.x) / 2;
    ImGui::TextColored(k_white, "%s", shortened(caption(session, display, Panels::reference), half).c_str());
    const std::string right = shortened(caption(session, display, Panels::fit), half);
    ImGui::SameLine(width - ImGui::CalcTextSize(right.c_str()).x);
    ImGui::TextColored(k_white, "%s", right.c_str());
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton("wipe", {width, height},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    const float divider = std::round(display.divider * width);
    const ImVec2 mouse = ImGui::GetMousePos();
    const bool near_divider = hovered && std::abs(mouse.x - corner.x - divider) < 8;
    if (near_divider && ImGui::IsMouseClicked(0)) drags_divider_ = true;
    if (!ImGui::IsMouseDown(0)) drags_divider_ = false;
    if (drags_divider_) display.divider = std::clamp((mouse.x - corner.x) / width, 0.f, 1.f);
    if (near_divider || drags_divider_) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const auto part = [&](Panels::Which which, float left, float right_edge) {
        list.AddImage(ImTextureID(std::uintptr_t(panels_.texture(which))), {corner.x + left, corner.y},
                      {corner.x + right_edge, corner.y + height}, {left / width, 1}, {right_edge / width, 0});
    };
    part(Panels::reference, 0, divider);
    part(Panels::fit, divider, width);
    list.AddLine({corner.x + divider, corner.y}, {corner.x + divider, corner.y + height}, IM_COL32(255, 255, 255, 220),
                 2);
    list.AddRectFilled({corner.x + divider - 4, corner.y + height / 2 - 16},
                       {corner.x + divider + 4, corner.y + height / 2 + 16}, IM_COL32(255, 255, 255, 220), 3);
    ImGui::PushClipRect(corner, {corner.x + width, corner.y + height}, true);
    if (display.has_lights()) draw_lights(display, corner, width, height, hovered && !drags_divider_);
    ImGui::PopClipRect();
    if (hovered && !active && !near_divider) draw_reading(corner, width, height);
    if (active && !drags_divider_) drag(display, height);
    if (const float wheel = ImGui::GetIO().MouseWheel; hovered && wheel != 0)
        zoom(display, std::pow(1.1, double(wheel)));
    ImGui::TextColored(k_dim, "drag the line, or the picture to orbit   W: side by side   %s",
                       exposure_text(display).c_str());
}

void Pictures::draw_picture(const Session& session, DisplayState& display, Panels::Which which, float width,
                            float height) {
    const bool is_late = which == Panels::fit && session.fitted() && session.fitted()->quick;
    ImGui::TextColored(is_late ? k_hint : k_white, "%s", shortened(caption(session, display, which), width).c_str());
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::PushID(which);
    ImGui::InvisibleButton("picture", {width, height},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    ImGui::PopID();
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddImage(ImTextureID(std::uintptr_t(panels_.texture(which))), corner, {corner.x + width, corner.y + height},
                  {0, 1}, {1, 0});
    ImGui::PushClipRect(corner, {corner.x + width, corner.y + height}, true);
    if (which != Panels::difference && !panels_.has(which)) {
        const bool is_refused = which == Panels::reference && reference_ >= 0;
        const char* const reason = is_refused       ? "cannot be drawn here:\nsee the message below"
                                   : reference_ < 0 ? "Drop a measurement or\na model on this window."
                                                    : "fitting ...";
        list.AddText({corner.x + width / 2 - 70, corner.y + height / 2 - 12}, IM_COL32(255, 255, 255, 200), reason);
    } else if (which != Panels::difference && display.has_lights()) {
        draw_lights(display, corner, width, height, hovered);
    }
    ImGui::PopClipRect();
    if (hovered && !active) draw_reading(corner, width, height);
    if (active) drag(display, height);
    if (const float wheel = ImGui::GetIO().MouseWheel; hovered && wheel != 0)
        zoom(display, std::pow(1.1, double(wheel)));
    if (which == Panels::difference)
        draw_scale(display, width);
    else if (which == Panels::reference)
        ImGui::TextColored(k_dim, "%s",
                           shortened(display.has_environment() ? "drag: orbit   with Ctrl: environment"
                                                               : "drag: orbit   wheel: zoom   yellow dots: lights",
                                     width)
                               .c_str());
    else
        ImGui::TextColored(k_dim, "%s", shortened(exposure_text(display), width).c_str());
}

void Pictures::draw(Session& session, DisplayState& display, ImVec2 corner, ImVec2 size) {
    ImGui::SetNextWindowPos(corner), ImGui::SetNextWindowSize(size);
    ImGui::Begin("pictures", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoScrollWithMouse);
    const float gap = ImGui::GetStyle().ItemSpacing.x, line = ImGui::GetTextLineHeightWithSpacing();
    const float total = ImGui::GetContentRegionAvail().x;
    const float width = display.wipe ? total : std::floor((total - 2 * gap) / 3);
    const float height = std::max(40.f, ImGui::GetContentRegionAvail().y - (display.wipe ? 2 : 3) * line);
    draw_panels(session, display, width, height);
    if (display.wipe) {
        draw_wipe(session, display, width, height);
    } else {
        for (const auto which : {Panels::reference, Panels::fit, Panels::difference}) {
            if (which > 0) ImGui::SameLine();
            ImGui::BeginGroup();
            draw_picture(session, display, which, width, height);
            ImGui::EndGroup();
        }
    }
    if (!ImGui::IsMouseDown(0)) dragged_light_ = -1;
    ImGui::End();
}

}  // namespace srbf
