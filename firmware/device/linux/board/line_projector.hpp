// The projector as the acquisition sees it: its controller over I2C together with the gate on its trigger line.
#pragma once

#include <mutex>

#include "firmware/device/linux/dlpc347x/dlpc347x.hpp"
#include "firmware/device/linux/lines/line_edges.hpp"
#include "firmware/hal/projector.hpp"

namespace enamel::fw {

class LineProjector final : public Projector {
 public:
  /// `controller` is armed already. Both must outlive this.
  LineProjector(Dlpc347x controller, LineEdges& edges) : controller_(controller), edges_(edges) {}

  [[nodiscard]] Result<void> arm() override {
    edges_.arm();
    return {};
  }
  void disarm() noexcept override { edges_.disarm(); }
  /// LEDs off at the controller, too.
  void blank() noexcept;
  [[nodiscard]] Result<void> restart() override;
  [[nodiscard]] ProjectorStatus status() const override;
  [[nodiscard]] int pattern_set() const override { return 0; }

 private:
  mutable std::mutex mutex_;  ///< of the bus
  mutable Dlpc347x controller_;
  LineEdges& edges_;
};

}  // namespace enamel::fw
