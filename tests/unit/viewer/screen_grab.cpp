#include "tests/unit/viewer/screen_grab.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <cstddef>

// As GLFW/glfw3native.h declares them; that header would also want the headers of Xrandr.
extern "C" Display* glfwGetX11Display(void);
extern "C" Window glfwGetX11Window(GLFWwindow* window);

namespace enamel::view::test {

Picture grab_screen() {
  Picture picture;
  GLFWwindow* window = glfwGetCurrentContext();
  if (window == nullptr) {
    return picture;
  }
  // The same connection as the drawing: the server answers after it has shown the picture.
  Display* display = glfwGetX11Display();
  int width = 0;
  int height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  XImage* image = XGetImage(display, glfwGetX11Window(window), 0, 0, static_cast<unsigned>(width),
                            static_cast<unsigned>(height), AllPlanes, ZPixmap);
  if (image == nullptr) {
    return picture;
  }
  picture = {width, height, {}, "X server"};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const unsigned long value = image->f.get_pixel(image, x, y);
      for (const int shift : {16, 8, 0}) {
        picture.rgb.push_back(static_cast<std::uint8_t>((value >> shift) & 0xFFU));
      }
    }
  }
  image->f.destroy_image(image);
  return picture;
}

}  // namespace enamel::view::test
