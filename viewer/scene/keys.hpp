// One table of keys: what a key does and what F1 says of it.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "viewer/scene/toggles.hpp"

namespace enamel::view {

/// Printable keys carry their upper-case character code; the rest lies above them.
enum class KeyCode : int { kSpace = ' ', kPlus = '+', kMinus = '-', kF1 = 256, kF12 = 257, kEscape = 258 };
[[nodiscard]] constexpr KeyCode letter(char upper_case) noexcept { return KeyCode{upper_case}; }

enum class Action {
  kToggleScan,
  kFollow,
  kRecentre,
  kQualityMap,
  kMono,
  kSoftTissue,
  kFrustum,
  kTrail,
  kLiveImage,
  kPanels,
  kStages,
  kLargerText,
  kSmallerText,
  kSavePicture,
  kHelp,
  kCloseHelp,
  kQuit,
};

struct KeyBinding {
  KeyCode key;
  bool ctrl;
  Action action;
  std::string_view key_text;  ///< as written on the keyboard
  std::string_view help;      ///< empty: not listed
};

[[nodiscard]] std::span<const KeyBinding> key_bindings() noexcept;
[[nodiscard]] std::optional<Action> action_for(KeyCode key, bool ctrl) noexcept;

/// What the mouse does, for the same help page.
struct MouseHelp {
  std::string_view gesture;
  std::string_view help;
};
[[nodiscard]] std::span<const MouseHelp> mouse_help() noexcept;

/// Carries out the actions that only switch something on or off. False: the action is another's business.
bool apply_toggle(Action action, DisplayToggles& toggles) noexcept;

}  // namespace enamel::view
