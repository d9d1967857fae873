#include "viewer/scene/keys.hpp"

#include <array>

namespace enamel::view {
namespace {

constexpr std::array kBindings{
    KeyBinding{KeyCode::kSpace, false, Action::kToggleScan, "Space", "Scan / pause"},
    KeyBinding{letter('F'), false, Action::kFollow, "F", "Camera follows the probe"},
    KeyBinding{letter('R'), false, Action::kRecentre, "R", "Show the whole model"},
    KeyBinding{letter('Q'), false, Action::kQualityMap, "Q", "Quality map: where to scan again"},
    KeyBinding{letter('M'), false, Action::kMono, "M", "Plain grey: shows steps and holes"},
    KeyBinding{letter('T'), false, Action::kSoftTissue, "T", "Soft tissue: striped, or hidden"},
    KeyBinding{letter('V'), false, Action::kFrustum, "V", "Probe's field of view"},
    KeyBinding{letter('G'), false, Action::kTrail, "G", "Path of the probe"},
    KeyBinding{letter('I'), false, Action::kLiveImage, "I", "Live image and distance"},
    KeyBinding{letter('O'), false, Action::kPanels, "O", "Figures"},
    KeyBinding{letter('P'), false, Action::kStages, "P", "Pipeline: what each stage takes"},
    KeyBinding{KeyCode::kPlus, false, Action::kLargerText, "+", "Larger text"},
    KeyBinding{KeyCode::kMinus, false, Action::kSmallerText, "-", "Smaller text"},
    KeyBinding{KeyCode::kF12, false, Action::kSavePicture, "F12", "Save a picture"},
    KeyBinding{KeyCode::kF1, false, Action::kHelp, "F1", "This help"},
    KeyBinding{KeyCode::kEscape, false, Action::kCloseHelp, "Esc", ""},
    KeyBinding{letter('Q'), true, Action::kQuit, "Ctrl Q", "Quit"},
};

constexpr std::array kMouse{
    MouseHelp{"Drag", "Turn the model"},
    MouseHelp{"Right drag", "Move the model"},
    MouseHelp{"Wheel", "Zoom"},
};

}  // namespace

std::span<const KeyBinding> key_bindings() noexcept { return kBindings; }
std::span<const MouseHelp> mouse_help() noexcept { return kMouse; }

std::optional<Action> action_for(KeyCode key, bool ctrl) noexcept {
  for (const KeyBinding& binding : kBindings) {
    if (binding.key == key && binding.ctrl == ctrl) {
      return binding.action;
    }
  }
  return std::nullopt;
}

bool apply_toggle(Action action, DisplayToggles& toggles) noexcept {
  const auto flip = [](bool& flag) {
    flag = !flag;
    return true;
  };
  switch (action) {
    case Action::kFollow:
      return flip(toggles.follow);
    case Action::kQualityMap:
      return flip(toggles.quality_map);
    case Action::kMono:
      return flip(toggles.mono);
    case Action::kSoftTissue:
      return flip(toggles.soft_tissue);
    case Action::kFrustum:
      return flip(toggles.frustum);
    case Action::kTrail:
      return flip(toggles.trail);
    case Action::kLiveImage:
      return flip(toggles.live_image);
    case Action::kPanels:
      return flip(toggles.panels);
    case Action::kStages:
      return flip(toggles.stages);
    case Action::kHelp:
      return flip(toggles.help);
    case Action::kCloseHelp:
      toggles.help = false;
      return true;
    default:
      return false;
  }
}

}  // namespace enamel::view
