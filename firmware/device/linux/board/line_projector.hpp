// The projector as the acquisition sees it: its controller together with the gate on its trigger line.
#pragma once

#include <memory>
#include <mutex>

#include "firmware/device/linux/lines/line_edges.hpp"
#include "firmware/device/linux/projector/controller.hpp"
#include "firmware/hal/projector.hpp"

namespace enamel::fw {

class LineProjector final : public Projector {
 public:
  /// `controller` is armed before the first arm(). `edges` must outlive this.
  LineProjector(std::unique_ptr<ProjectorController> controller, LineEdges& edges)
      : controller_(std::move(controller)), edges_(edges) {}

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
  mutable std::mutex mutex_;  ///< of the controller
  std::unique_ptr<ProjectorController> controller_;
  LineEdges& edges_;
};

}  // namespace enamel::fw
