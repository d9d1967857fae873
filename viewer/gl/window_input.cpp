#include "viewer/gl/window_input.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <optional>

namespace enamel::view {
namespace {

WindowInput& input_of(GLFWwindow* window) { return *static_cast<WindowInput*>(glfwGetWindowUserPointer(window)); }

std::optional<KeyCode> key_code(int key) {
  switch (key) {
    case GLFW_KEY_F1:
      return KeyCode::kF1;
    case GLFW_KEY_F12:
      return KeyCode::kF12;
    case GLFW_KEY_ESCAPE:
      return KeyCode::kEscape;
    case GLFW_KEY_SPACE:
      return KeyCode::kSpace;
    case GLFW_KEY_KP_ADD:
    case GLFW_KEY_EQUAL:
      return KeyCode::kPlus;
    case GLFW_KEY_KP_SUBTRACT:
    case GLFW_KEY_MINUS:
      return KeyCode::kMinus;
    default:
      break;
  }
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) {
    return letter(static_cast<char>('A' + (key - GLFW_KEY_A)));
  }
  return std::nullopt;
}

/// The sign or letter that the person's keyboard layout prints on this key.
std::optional<KeyCode> printed_code(int key, int scancode) {
  const char* name = glfwGetKeyName(key, scancode);
  if (name == nullptr || name[0] == '\0' || name[1] != '\0') {
    return std::nullopt;
  }
  if (name[0] >= 'a' && name[0] <= 'z') {
    return letter(static_cast<char>(name[0] - 'a' + 'A'));
  }
  return name[0] == '+' || name[0] == '-' ? std::optional(letter(name[0])) : std::nullopt;
}

void on_key(GLFWwindow* window, int key, int scancode, int action, int mods) {
  if (action != GLFW_PRESS) {
    return;
  }
  const auto printed = printed_code(key, scancode);
  const auto code = printed ? printed : key_code(key);
  if (!code) {
    return;
  }
  if (const auto wanted = action_for(*code, (mods & GLFW_MOD_CONTROL) != 0)) {
    input_of(window).actions.push_back(*wanted);
    input_of(window).any = true;
  }
}

void on_cursor(GLFWwindow* window, double x, double y) {
  WindowInput& input = input_of(window);
  const double dx = x - input.last_x;
  const double dy = y - input.last_y;
  input.last_x = x;
  input.last_y = y;
  if (ImGui::GetCurrentContext() != nullptr && ImGui::GetIO().WantCaptureMouse) {
    input.any = true;
    return;
  }
  if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
    input.left_dx += dx;
    input.left_dy += dy;
    input.any = true;
  } else if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS ||
             glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_MIDDLE) == GLFW_PRESS) {
    input.right_dx += dx;
    input.right_dy += dy;
    input.any = true;
  }
}

void on_button(GLFWwindow* window, int /*button*/, int /*action*/, int /*mods*/) { input_of(window).any = true; }

void on_wheel(GLFWwindow* window, double /*dx*/, double dy) {
  input_of(window).wheel += dy;
  input_of(window).any = true;
}

void on_damage(GLFWwindow* window) { input_of(window).any = true; }
void on_size(GLFWwindow* window, int /*width*/, int /*height*/) { input_of(window).any = true; }

}  // namespace

void connect_input(GLFWwindow* window, WindowInput& input) {
  glfwSetWindowUserPointer(window, &input);
  glfwSetKeyCallback(window, on_key);
  glfwSetCursorPosCallback(window, on_cursor);
  glfwSetMouseButtonCallback(window, on_button);
  glfwSetScrollCallback(window, on_wheel);
  glfwSetWindowRefreshCallback(window, on_damage);
  glfwSetFramebufferSizeCallback(window, on_size);
}

}  // namespace enamel::view
