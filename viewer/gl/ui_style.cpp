#include "viewer/gl/ui_style.hpp"

#include <array>
#include <filesystem>
#include <system_error>

namespace enamel::view {
namespace {

struct Face {
  const char* regular;
  const char* strong;
};

constexpr std::array<Face, 2> kFaces{{
    {"/usr/share/fonts/opentype/inter/Inter-Medium.otf", "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf"},
    {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"},
}};

/// Latin with supplement, dashes and quotes, arrows, comparison signs.
constexpr std::array<ImWchar, 9> kRanges{0x0020, 0x00FF, 0x2010, 0x2027, 0x2190, 0x2193, 0x2260, 0x2265, 0};

bool readable(const char* path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

ImFont* add(const char* path, float size_px) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  ImFont* font = path != nullptr ? atlas.AddFontFromFileTTF(path, size_px, nullptr, kRanges.data()) : nullptr;
  if (font != nullptr) {
    return font;
  }
  ImFontConfig config;
  config.SizePixels = size_px;
  return atlas.AddFontDefault(&config);
}

}  // namespace

Fonts load_fonts(float scale) {
  ImGui::GetIO().Fonts->Clear();
  const char* regular = nullptr;
  const char* strong = nullptr;
  for (const Face& face : kFaces) {
    if (readable(face.regular) && readable(face.strong)) {
      regular = face.regular;
      strong = face.strong;
      break;
    }
  }
  Fonts fonts;
  fonts.body = add(regular, 16.0F * scale);
  fonts.small = add(regular, 13.5F * scale);
  fonts.title = add(strong, 19.0F * scale);
  fonts.big = add(strong, 34.0F * scale);
  ImGui::GetIO().Fonts->Build();
  return fonts;
}

void apply_style(float scale) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  ImGui::StyleColorsDark(&style);
  style.WindowPadding = ImVec2(0, 0);
  style.WindowBorderSize = 0;
  style.FrameRounding = 12.0F * scale;
  style.Colors[ImGuiCol_Button] = ImVec4(kPanel.r, kPanel.g, kPanel.b, 0.86F);
  style.Colors[ImGuiCol_ButtonHovered] = ImVec4(0.16F, 0.19F, 0.23F, 0.95F);
  style.Colors[ImGuiCol_ButtonActive] = ImVec4(0.22F, 0.26F, 0.31F, 1.0F);
  style.Colors[ImGuiCol_Text] = ImVec4(kText.r, kText.g, kText.b, 1.0F);
}

ImVec2 Pen::size(const ImFont* font, std::string_view text, float wrap_px) const {
  return font->CalcTextSizeA(font->FontSize, 1e6F, wrap_px, text.data(), text.data() + text.size());
}

void Pen::text(ImVec2 at, const ImFont* font, const Colour& colour, std::string_view words, float wrap_px) const {
  list->AddText(font, font->FontSize, at, packed(colour), words.data(), words.data() + words.size(), wrap_px);
}

void Pen::text_right(ImVec2 top_right, const ImFont* font, const Colour& colour, std::string_view words) const {
  text(ImVec2(top_right.x - size(font, words).x, top_right.y), font, colour, words);
}

void Pen::panel(ImVec2 from, ImVec2 to, float alpha) const {
  list->AddRectFilled(from, to, packed(kPanel, alpha), px(12));
  list->AddRect(from, to, packed({1, 1, 1}, 0.07F), px(12), 0, px(1));
}

}  // namespace enamel::view
