#include "extras/view/pictures.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "extras/render/app/raster.h"
#include "extras/view/ink.h"

namespace srbf {
namespace {

/// During interaction, pictures that take longer than this are drawn smaller.
constexpr double k_slow_frame = 0.04, k_rest = 0.25;

std::string name_of_fit(const Session& session) {
    const auto& fitted = session.fitted();
    if (!fitted) return session.stage() == Stage::idle ? "no fit" : "fitting ...";
    std::string text = fitted->from.empty() ? "fit" : std::filesystem::path(fitted->from).filename().string();
    text += fmt::format(", {} bytes", payload_bytes(fitted->model));
    if (fitted->quick) text += session.stage() == Stage::idle ? " (quick)" : " (quick, refining ...)";
    return text;
}

std::string exposure_text(const Look& look) {
    return fmt::format("exposure {:+.2f} stops{}", std::log2(look.exposure), look.automatic ? ", automatic" : "");
}

/// The colours of differences, darker to brighter.
void draw_scale(const Look& look, float width) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float height = 12, middle = at.x + width / 2;
    using D = RasterDevelopment;
    if (!look.in_delta_e)
        list.AddRectFilledMultiColor(at, {middle, at.y + height}, colour_of(D::k_darker), colour_of(D::k_equal),
                                     colour_of(D::k_equal), colour_of(D::k_darker));
    list.AddRectFilledMultiColor({look.in_delta_e ? at.x : middle, at.y}, {at.x + width, at.y + height},
                                 colour_of(D::k_equal), colour_of(D::k_brighter), colour_of(D::k_brighter),
                                 colour_of(D::k_equal));
    const ImU32 ink = IM_COL32(230, 230, 230, 255);
    const std::string most = fmt::format("+{:.3g}", look.full_scale), least = fmt::format("-{:.3g}", look.full_scale);
    const std::string right =
        look.in_delta_e ? fmt::format("{:.3g} ΔE", look.unit() * look.full_scale) : "fit brighter " + most;
    list.AddText({at.x, at.y + height}, ink, look.in_delta_e ? "0" : (least + " fit darker").c_str());
    if (!look.in_delta_e) list.AddText({middle - 3, at.y + height}, ink, "0");
    list.AddText({at.x + width - ImGui::CalcTextSize(right.c_str()).x, at.y + height}, ink, right.c_str());
    ImGui::Dummy({width, height + ImGui::GetTextLineHeight()});
}

}  // namespace

bool Pictures::moves() const { return touched_.seconds() < k_rest; }

void Pictures::take_mesh(Session& session, Look& look) {
    if (mesh_ == look.mesh) return;
    auto mesh = load_mesh(look.mesh);
    if (!mesh) {
        session.complain(mesh.error());
        look.mesh = mesh_.empty() ? "ball" : mesh_;
        if (!mesh_.empty()) return;
        mesh = ball();
    }
    mesh_ = look.mesh;
    panels_.set_mesh(*mesh);
    is_exposed_ = false;
}

void Pictures::take_environment(Session& session, Look& look) {
    if (environment_ == look.environment) return;
    Result<Done> done = Done{};
    if (look.has_environment()) {
        const auto loaded = load_environment(look.environment);
        done = loaded ? panels_.set_environment(&*loaded) : Result<Done>(loaded.error());
    } else {
        done = panels_.set_environment(nullptr);
    }
    if (!done) {
        session.complain(done.error());
        look.environment = environment_;
        return;
    }
    environment_ = look.environment;
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

void Pictures::take(Session& session, Look& look, bool swapped) {
    take_mesh(session, look);
    take_environment(session, look);
    if (reference_ != session.reference()) {
        reference_ = session.reference();
        const auto subject = session.subjects()[std::size_t(reference_)];
        set_material(session, Panels::reference, material_of(*subject), [subject] { return proposal_of(*subject); });
        is_exposed_ = false;
        swapped = true;
    }
    if (session.fitted() && swapped)
        set_material(session, Panels::fit, material_of(session.fitted()->model), [model = session.fitted()->model] {
            return proposal_of({"", model});
        });
    if (!session.fitted() && panels_.has(Panels::fit)) (void)panels_.set_material(Panels::fit, {});
}

void Pictures::draw_panels(Session& session, Look& look, float width, float height) {
    std::string key = fmt::format("{} {} {}", look.azimuth, look.elevation, look.zoom);
    for (const auto& light : look.lights) key += fmt::format(" {} {}", light.towards.x, light.towards.y);
    key += fmt::format(" {}", look.turned);
    if (key != shown_key_) touch(), shown_key_ = key;
    const bool is_moving = moves();
    const float share = is_moving ? reduction_ : 1;
    const bool expose = !is_exposed_ && (panels_.has(Panels::reference) || panels_.has(Panels::fit));
    const Stopwatch watch;
    const auto drawn =
        panels_.draw(look, std::max(16, int(width * share)), std::max(16, int(height * share)), expose, is_moving);
    glFinish();
    const double took = watch.seconds();
    if (is_moving && took > k_slow_frame) reduction_ = std::max(0.35f, reduction_ * 0.8f);
    if (is_moving && took < k_slow_frame / 3) reduction_ = std::min(1.f, reduction_ * 1.1f);
    is_exposed_ = look.automatic && (is_exposed_ || expose);
    is_whole_ = share == 1;
    if (!drawn && error_ != message(drawn.error())) session.complain(drawn.error()), error_ = message(drawn.error());
}

void Pictures::draw_lights(Look& look, ImVec2 corner, float width, float height, bool can_drag) {
    const Camera camera = camera_of(look, panels_.bounds());
    const Frame axes = frame(camera);
    const Vec3d diagonal = to_double(panels_.bounds().most) - to_double(panels_.bounds().least);
    const double radius = 0.5 * std::sqrt(dot(diagonal, diagonal)) / look.zoom, half = std::tan(camera.fov / 2);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int k = 0; k < 3; ++k) {
        const Vec3d p = camera.target + 0.72 * radius * look.lights[std::size_t(k)].towards - camera.eye;
        const double depth = -dot(p, axes.z);
        if (!(depth > 0)) continue;
        const ImVec2 at{corner.x + width / 2 + float(dot(p, axes.x) / (depth * half) * height / 2),
                        corner.y + height / 2 - float(dot(p, axes.y) / (depth * half) * height / 2)};
        const bool behind = dot(look.lights[std::size_t(k)].towards, axes.z) < 0;
        const ImU32 colour = IM_COL32(255, 220, 90, behind ? 130 : 255);
        if (behind)
            list.AddCircle(at, 6, colour, 0, 2);
        else
            list.AddCircleFilled(at, 6, colour);
        list.AddCircle(at, 7, IM_COL32(0, 0, 0, 160));
        if (k == look.light) list.AddCircle(at, 10, colour, 0, 1.5f);
        list.AddText({at.x + 9, at.y - 14}, colour, fmt::format("{}", k + 1).c_str());
        const ImVec2 mouse = ImGui::GetMousePos();
        if (can_drag && ImGui::IsMouseClicked(0) && std::hypot(mouse.x - at.x, mouse.y - at.y) < 10)
            dragged_light_ = look.light = k;
    }
}

/// Rotates the held object: the environment, a light, or the camera.
void Pictures::drag(Look& look, float height) {
    const ImVec2 delta = ImGui::GetIO().MouseDelta;
    if (delta.x == 0 && delta.y == 0) return;
    const double right = double(delta.x) / double(height) * k_pi, up = double(-delta.y) / double(height) * k_pi;
    if (look.has_environment() && (ImGui::GetIO().KeyCtrl || (ImGui::IsMouseDown(1) && !look.lamps)))
        turn_environment(look, right);
    else if (dragged_light_ >= 0 || ImGui::IsMouseDown(1))
        turn_light(look, dragged_light_ >= 0 ? dragged_light_ : look.light, right, up);
    else
        orbit(look, -right, -up);
}

std::string Pictures::caption(const Session& session, const Look& look, Panels::Which which) const {
    const bool is_measured = reference_ >= 0 && !session.subjects()[std::size_t(reference_)]->is_model();
    if (which == Panels::fit) return name_of_fit(session);
    const std::string reference = is_measured ? "measured" : "reference";
    if (which == Panels::difference)
        return look.in_delta_e ? "difference in ΔE from " + reference : "difference: fit - " + reference;
    return reference + ": " +
           (reference_ < 0
                ? "no reference"
                : std::filesystem::path(session.subjects()[std::size_t(reference_)]->path).filename().string());
}

/// The radiances under the mouse, of both materials.
void Pictures::draw_reading(ImVec2 corner, float width, float height) const {
    const ImVec2 mouse = ImGui::GetMousePos();
    const float u = (mouse.x - corner.x) / width, v = (mouse.y - corner.y) / height;
    std::string text;
    for (const auto& [which, name] : {std::pair(Panels::reference, "reference"), {Panels::fit, "fit"}})
        if (const auto seen = panels_.radiance_at(which, u, v))
            text +=
                fmt::format("{}{}: {:.3g}, {:.3g}, {:.3g}", text.empty() ? "" : "\n", name, seen->r, seen->g, seen->b);
    if (!text.empty()) ImGui::SetTooltip("%s", text.c_str());
}

/// One picture, measured to the left of a divider and the fit to the right of it.
void Pictures::draw_wipe(const Session& session, Look& look, float width, float height) {
    const float half = (width - ImGui::GetStyle().ItemSpacing.x) / 2;
    ImGui::TextColored(k_white, "%s", shortened(caption(session, look, Panels::reference), half).c_str());
    const std::string right = shortened(caption(session, look, Panels::fit), half);
    ImGui::SameLine(width - ImGui::CalcTextSize(right.c_str()).x);
    ImGui::TextColored(k_white, "%s", right.c_str());
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton("wipe", {width, height},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    const float at = std::round(look.divider * width);
    const ImVec2 mouse = ImGui::GetMousePos();
    const bool near_divider = hovered && std::abs(mouse.x - corner.x - at) < 8;
    if (near_divider && ImGui::IsMouseClicked(0)) drags_divider_ = true;
    if (!ImGui::IsMouseDown(0)) drags_divider_ = false;
    if (drags_divider_) look.divider = std::clamp((mouse.x - corner.x) / width, 0.f, 1.f);
    if (near_divider || drags_divider_) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const auto part = [&](Panels::Which which, float from, float to) {
        list.AddImage(ImTextureID(std::uintptr_t(panels_.texture(which))), {corner.x + from, corner.y},
                      {corner.x + to, corner.y + height}, {from / width, 1}, {to / width, 0});
    };
    part(Panels::reference, 0, at);
    part(Panels::fit, at, width);
    list.AddLine({corner.x + at, corner.y}, {corner.x + at, corner.y + height}, IM_COL32(255, 255, 255, 220), 2);
    list.AddRectFilled({corner.x + at - 4, corner.y + height / 2 - 16}, {corner.x + at + 4, corner.y + height / 2 + 16},
                       IM_COL32(255, 255, 255, 220), 3);
    ImGui::PushClipRect(corner, {corner.x + width, corner.y + height}, true);
    if (look.has_lights()) draw_lights(look, corner, width, height, hovered && !drags_divider_);
    ImGui::PopClipRect();
    if (hovered && !active && !near_divider) draw_reading(corner, width, height);
    if (active && !drags_divider_) drag(look, height);
    if (const float wheel = ImGui::GetIO().MouseWheel; hovered && wheel != 0) zoom(look, std::pow(1.1, double(wheel)));
    ImGui::TextColored(k_dim, "drag the line, or the picture to orbit   W: side by side   %s",
                       exposure_text(look).c_str());
}

void Pictures::draw_picture(const Session& session, Look& look, Panels::Which which, float width, float height) {
    const bool is_late = which == Panels::fit && session.fitted() && session.fitted()->quick;
    ImGui::TextColored(is_late ? k_hint : k_white, "%s", shortened(caption(session, look, which), width).c_str());
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
        const bool refused = which == Panels::reference && reference_ >= 0;
        const char* const why = refused          ? "cannot be drawn here:\nsee the message below"
                                : reference_ < 0 ? "Drop a measurement or\na model on this window."
                                                 : "fitting ...";
        list.AddText({corner.x + width / 2 - 70, corner.y + height / 2 - 12}, IM_COL32(255, 255, 255, 200), why);
    } else if (which != Panels::difference && look.has_lights()) {
        draw_lights(look, corner, width, height, hovered);
    }
    ImGui::PopClipRect();
    if (hovered && !active) draw_reading(corner, width, height);
    if (active) drag(look, height);
    if (const float wheel = ImGui::GetIO().MouseWheel; hovered && wheel != 0) zoom(look, std::pow(1.1, double(wheel)));
    if (which == Panels::difference)
        draw_scale(look, width);
    else if (which == Panels::reference)
        ImGui::TextColored(k_dim, "%s",
                           shortened(look.has_environment() ? "drag: orbit   with Ctrl: environment"
                                                            : "drag: orbit   wheel: zoom   yellow dots: lights",
                                     width)
                               .c_str());
    else
        ImGui::TextColored(k_dim, "%s", shortened(exposure_text(look), width).c_str());
}

void Pictures::draw(Session& session, Look& look, ImVec2 at, ImVec2 size) {
    ImGui::SetNextWindowPos(at), ImGui::SetNextWindowSize(size);
    ImGui::Begin("pictures", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoScrollWithMouse);
    const float gap = ImGui::GetStyle().ItemSpacing.x, line = ImGui::GetTextLineHeightWithSpacing();
    const float whole = ImGui::GetContentRegionAvail().x;
    const float width = look.wipe ? whole : std::floor((whole - 2 * gap) / 3);
    const float height = std::max(40.f, ImGui::GetContentRegionAvail().y - (look.wipe ? 2 : 3) * line);
    draw_panels(session, look, width, height);
    if (look.wipe) {
        draw_wipe(session, look, width, height);
    } else {
        for (const auto which : {Panels::reference, Panels::fit, Panels::difference}) {
            if (which > 0) ImGui::SameLine();
            ImGui::BeginGroup();
            draw_picture(session, look, which, width, height);
            ImGui::EndGroup();
        }
    }
    if (!ImGui::IsMouseDown(0)) dragged_light_ = -1;
    ImGui::End();
}

}  // namespace srbf
