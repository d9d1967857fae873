// Which bursts were taken while the table stood at a stop. Host clock. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "protocol/base/time.hpp"

namespace enamel::host {

/// When a burst was exposed, on the host's clock, and how uncertain that is.
struct HostExposure {
  HostTime began{}, ended{};
  Nanoseconds uncertainty{};
};

enum class BurstPlace : std::uint8_t {
  kAtStop,  ///< the table stands for the stop that is being taken, and stood all the while
  kMoving,  ///< the table moved or may have, or nobody waited for it to stand
  kSpare,   ///< it stood for the stop before, which has its bursts
};

class RestWindow {
 public:
  /// The table stands for a stop, and has settled.
  void open(HostTime since) {
    since_ = since;
    until_.reset();
  }
  /// The stop has what it needs: the table may move.
  void close(HostTime until) {
    if (since_ && !until_) until_ = until;
  }
  [[nodiscard]] bool is_open() const { return since_ && !until_; }

  /// nullopt: when it was exposed is not known.
  [[nodiscard]] BurstPlace place_of(const std::optional<HostExposure>& burst) const {
    if (!burst || !since_ || burst->began - burst->uncertainty < *since_) return BurstPlace::kMoving;
    if (!until_) return BurstPlace::kAtStop;
    return burst->ended + burst->uncertainty <= *until_ ? BurstPlace::kSpare : BurstPlace::kMoving;
  }

 private:
  std::optional<HostTime> since_, until_;
};

}  // namespace enamel::host
