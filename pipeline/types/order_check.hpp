// The code's fringe orders beside what the model shows, of one placed burst.
#pragma once

#include <cstddef>

namespace enamel {

struct OrderCheck {
  std::size_t checked = 0;        ///< pixels on the model, with the order that the code gave them or with another …
  std::size_t contradicting = 0;  ///< … with another
  bool suspect = false;           ///< so many that code or placement is in doubt
  std::size_t guided_px = 0;      ///< pixels that the code left open and the model decided
  std::size_t withdrawn_px = 0;   ///< pixels left out because they contradict

  [[nodiscard]] double share() const noexcept {
    return checked > 0 ? static_cast<double>(contradicting) / static_cast<double>(checked) : 0;
  }
};

}  // namespace enamel
