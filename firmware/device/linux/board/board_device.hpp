// A probe's board as one device.
#pragma once

#include <memory>
#include <string>

#include "firmware/device/device.hpp"
#include "firmware/device/linux/board/board_profile.hpp"
#include "firmware/device/linux/board/line_projector.hpp"

namespace enamel::fw {

/// What a board is put together from; tests bring models of them.
struct BoardParts {
  std::shared_ptr<RequestSource> camera;
  std::unique_ptr<I2cBus> bus;   ///< of a DLPC347x
  std::unique_ptr<HidPort> hid;  ///< of a DLPC350
  LineHandle events;
  GateDriver gate;
  bool follow_edges = true;  ///< by a thread of their own; false: when they are read
  std::unique_ptr<Light> light;
  std::unique_ptr<Thermal> thermal;
  std::unique_ptr<Heater> heater;      ///< null: none
  std::unique_ptr<Watchdog> watchdog;  ///< null: none
};

/// The controller of whichever port the profile names, dark; the port must outlive it.
[[nodiscard]] Result<std::unique_ptr<ProjectorController>> open_controller(const BoardParts& parts,
                                                                           const BoardProfile& profile, Clock& clock);

class BoardDevice final : public Device {
 public:
  /// Opens the projector, arms it and makes the camera; the light stays off. Errors: kProjector, kBoardTiming (the
  /// projector cannot show it), kCamera.
  [[nodiscard]] static Result<std::unique_ptr<BoardDevice>> create(BoardParts parts, const BoardProfile& profile,
                                                                   std::string rig_text, Clock& clock);
  ~BoardDevice() override;

  [[nodiscard]] Hardware hardware() noexcept override { return {*camera_, *projector_, *edges_, *light_, *thermal_}; }
  [[nodiscard]] std::string model() const override { return model_; }
  [[nodiscard]] const std::string& rig_text() const override { return rig_text_; }
  [[nodiscard]] Nanoseconds max_stamp_spread() const override { return max_stamp_spread_; }
  [[nodiscard]] Heater* heater() noexcept override { return heater_.get(); }
  [[nodiscard]] Watchdog* watchdog() noexcept override { return watchdog_.get(); }
  [[nodiscard]] std::uint64_t lost_edges() const { return edges_->lost(); }

 private:
  BoardDevice() = default;

  std::string model_, rig_text_;
  Nanoseconds max_stamp_spread_{};
  std::unique_ptr<Light> light_;  ///< in order of dependence; the light goes off last of all, and first in ~BoardDevice
  std::unique_ptr<Thermal> thermal_;
  std::unique_ptr<Heater> heater_;
  std::unique_ptr<Watchdog> watchdog_;
  std::unique_ptr<I2cBus> bus_;
  std::unique_ptr<HidPort> hid_;
  std::unique_ptr<LineEdges> edges_;
  std::unique_ptr<LineProjector> projector_;
  std::unique_ptr<RequestCamera> camera_;
};

}  // namespace enamel::fw
