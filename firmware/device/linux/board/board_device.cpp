#include "firmware/device/linux/board/board_device.hpp"

#include <utility>

namespace enamel::fw {

Result<std::unique_ptr<BoardDevice>> BoardDevice::create(BoardParts parts, const BoardProfile& profile,
                                                         std::string rig_text, Clock& clock) {
  std::unique_ptr<BoardDevice> device(new BoardDevice);
  device->model_ = profile.model;
  device->rig_text_ = std::move(rig_text);
  device->max_stamp_spread_ = Nanoseconds{static_cast<std::int64_t>(profile.max_stamp_spread_us * 1000)};
  device->light_ = std::move(parts.light);
  device->light_->set_enabled(false);
  device->thermal_ = std::move(parts.thermal);
  device->bus_ = std::move(parts.bus);
  device->edges_ = std::make_unique<LineEdges>(std::move(parts.events), profile.lines, std::move(parts.gate), clock);
  device->edges_->close_gate();
  ENAMEL_TRY_ASSIGN(Dlpc347x opened, Dlpc347x::open(*device->bus_, clock, profile.limits));
  auto owned = std::make_unique<Dlpc347x>(std::move(opened));
  ProjectorController& controller = *owned;
  device->projector_ = std::make_unique<LineProjector>(std::move(owned), *device->edges_);
  ENAMEL_TRY(controller.arm(profile.timing.pattern));
  ENAMEL_TRY(controller.set_led(profile.led_code));
  ENAMEL_TRY(controller.start());
  if (parts.follow_edges) device->edges_->follow();
  ENAMEL_TRY_ASSIGN(device->camera_, RequestCamera::create(std::move(parts.camera), clock, profile.camera_config()));
  return device;
}

BoardDevice::~BoardDevice() {
  light_->set_enabled(false);
  if (edges_) edges_->close_gate();
  if (projector_) projector_->blank();
}

}  // namespace enamel::fw
