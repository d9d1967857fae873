// A SIMULATED USB camera whose frames are known byte by byte.
// usage: usbip_camera [FRAMES_PER_SECOND [N]]; ends when the kernel closes the connection. N: of every N-th frame one
// bit is turned.
#include <algorithm>
#include <cstdlib>

#include "tests/guest/camera/frame_content.hpp"
#include "tests/guest/camera/usbip_link.hpp"

int main(int argc, char** argv) {
  using namespace enamel::guest;
  UvcMode mode;
  if (argc > 1) mode.frames_per_second = static_cast<std::uint32_t>(std::max(1, std::atoi(argv[1])));
  const auto spoil_every = static_cast<std::uint32_t>(argc > 2 ? std::max(0, std::atoi(argv[2])) : 0);
  UsbipCamera camera(mode, [=](std::uint32_t number, std::span<std::uint8_t> pixels) {
    fill_frame(number, pixels);
    if (spoil_every > 0 && number % spoil_every == 0) pixels.back() ^= 1U;
  });
  return camera.attach() ? camera.run() : 1;
}
