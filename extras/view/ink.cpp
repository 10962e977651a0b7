#include "extras/view/ink.h"

#include <cmath>
#include <cstdint>
#include <filesystem>

namespace SRBF_NAMESPACE {

void load_font(float scale) {
    constexpr float height = 16;
    static const ImWchar ranges[] = {0x20, 0xff, 0x391, 0x3c9, 0x2010, 0x2026, 0x2212, 0x2212, 0};
    for (const char* path :
         {"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf", "/usr/share/fonts/noto/NotoSans-Regular.ttf",
          "/usr/share/fonts/google-noto/NotoSans-Regular.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
          "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
          "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"})
        if (std::filesystem::exists(path) &&
            ImGui::GetIO().Fonts->AddFontFromFileTTF(path, std::round(height * scale), nullptr, ranges))
            return;
    ImGui::GetIO().FontGlobalScale = scale;
}

std::string shortened(std::string text, float width) {
    const auto is_wide = [&](const std::string& line) { return ImGui::CalcTextSize(line.c_str()).x > width; };
    if (!is_wide(text)) return text;
    const auto continues = [](char c) { return (std::uint8_t(c) & 0xc0) == 0x80; };  // a continuation byte of UTF-8
    while (!text.empty() && is_wide(text + "...")) {
        while (text.size() > 1 && continues(text.back())) text.pop_back();
        text.pop_back();
    }
    return text + "...";
}

void write_wrapped(const ImVec4& colour, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextWrapped("%s", text.c_str());
    ImGui::PopStyleColor();
}

}  // namespace srbf
