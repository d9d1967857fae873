#include "firmware/device/linux/board/board_device.hpp"

#include <utility>

namespace enamel::fw {
namespace {

template <class Controller>
Result<std::unique_ptr<ProjectorController>> owned(Result<Controller> opened) {
  if (!opened) return tl::unexpected<Error>(std::move(opened).error());
  return std::unique_ptr<ProjectorController>(std::make_unique<Controller>(std::move(*opened)));
}

}  // namespace

Result<std::unique_ptr<ProjectorController>> open_controller(const BoardParts& parts, const BoardProfile& profile,
                                                             Clock& clock) {
  if (profile.projector == ProjectorType::kDlpc350) {
    return owned(Dlpc350::open(*parts.hid, clock, profile.limits, profile.image));
  }
  return owned(Dlpc347x::open(*parts.bus, clock, profile.limits));
}

Result<std::unique_ptr<BoardDevice>> BoardDevice::create(BoardParts parts, const BoardProfile& profile,
                                                         std::string rig_text, Clock& clock) {
  std::unique_ptr<BoardDevice> device(new BoardDevice);
  device->model_ = profile.model;
  device->rig_text_ = std::move(rig_text);
  device->max_stamp_spread_ = Nanoseconds{static_cast<std::int64_t>(profile.max_stamp_spread_us * 1000)};
  device->light_ = std::move(parts.light);
  device->light_->set_enabled(false);
  device->thermal_ = std::move(parts.thermal);
  device->heater_ = std::move(parts.heater);
  device->watchdog_ = std::move(parts.watchdog);
  device->edges_ = std::make_unique<LineEdges>(std::move(parts.events), profile.lines, std::move(parts.gate), clock);
  device->edges_->close_gate();
  ENAMEL_TRY_ASSIGN(auto controller, open_controller(parts, profile, clock));
  device->bus_ = std::move(parts.bus);
  device->hid_ = std::move(parts.hid);
  device->projector_ =
      std::make_unique<LineProjector>(std::move(controller), *device->edges_, profile.timing.pattern, profile.led_code);
  ENAMEL_TRY(device->projector_->set_up());
  if (parts.follow_edges) device->edges_->follow();
  ENAMEL_TRY_ASSIGN(device->camera_, RequestCamera::create(std::move(parts.camera), clock, profile.camera_config()));
  return device;
}

BoardDevice::~BoardDevice() {
  light_->set_enabled(false);
  if (heater_) heater_->set_power(0);
  if (edges_) edges_->close_gate();
  if (projector_) projector_->blank();
}

}  // namespace enamel::fw
