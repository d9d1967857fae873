// What keys and mouse did between two polls. GLFW calls back on the window's thread only.
#pragma once

#include <vector>

#include "viewer/scene/keys.hpp"

struct GLFWwindow;

namespace enamel::view {

struct WindowInput {
  std::vector<Action> actions;
  double left_dx = 0, left_dy = 0;    ///< px dragged with the left button
  double right_dx = 0, right_dy = 0;  ///< px dragged with the right or middle button
  double wheel = 0;
  bool any = false;  ///< something happened: draw even if the frame is the same

  double last_x = 0, last_y = 0;
};

/// Installs the callbacks; `input` must outlive the window. To be called before ImGui installs its own, which chain to
/// these.
void connect_input(GLFWwindow* window, WindowInput& input);

}  // namespace enamel::view
