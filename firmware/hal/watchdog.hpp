// Hardware that resets the board when its program hangs.
#pragma once

namespace enamel::fw {

class Watchdog {
 public:
  /// Destruction disarms it: the program has ended as it meant to.
  virtual ~Watchdog() = default;
  virtual void feed() noexcept = 0;
};

}  // namespace enamel::fw
