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
  /// What `controller`, open and dark, is to show. `edges` must outlive this.
  LineProjector(std::unique_ptr<ProjectorController> controller, LineEdges& edges, const PatternTiming& timing,
                std::uint16_t led_code)
      : controller_(std::move(controller)), edges_(edges), timing_(timing), led_code_(led_code) {}
  /// Before the first arm().
  [[nodiscard]] Result<void> set_up();

  [[nodiscard]] Result<void> arm() override {
    edges_.arm();
    return {};
  }
  void disarm() noexcept override { edges_.disarm(); }
  /// LEDs off at the controller, too.
  void blank() noexcept;
  /// One that has restarted by itself has forgotten everything, its ceiling too: it is set up anew.
  [[nodiscard]] Result<void> restart() override;
  [[nodiscard]] ProjectorStatus status() const override;
  [[nodiscard]] int pattern_set() const override { return 0; }

 private:
  [[nodiscard]] Result<void> run_again();
  [[nodiscard]] Result<void> show();

  mutable std::mutex mutex_;  ///< of the controller
  std::unique_ptr<ProjectorController> controller_;
  LineEdges& edges_;
  PatternTiming timing_;
  std::uint16_t led_code_;
};

}  // namespace enamel::fw
