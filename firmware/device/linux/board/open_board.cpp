#include "firmware/device/linux/board/open_board.hpp"

#include <array>
#include <memory>

#include "calib/model/rig.hpp"
#include "firmware/device/linux/libcamera/libcamera_source.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

Result<void> check_rig(const calib::Rig& rig, const BoardProfile& profile) {
  if (rig.camera.width == profile.width && rig.camera.height == profile.height) return {};
  return fail(ErrorCode::kRigForeign, profile.rig + ": calibrated at " + std::to_string(rig.camera.width) + "x" +
                                          std::to_string(rig.camera.height) + ", the profile's camera gives " +
                                          std::to_string(profile.width) + "x" + std::to_string(profile.height));
}

void tell_missing(const LibcameraSource& camera) {
  for (const std::string& name : camera.missing_controls()) {
    log::warn("camera", "its driver has no {}: what the profile says of it is not set", name);
  }
}

}  // namespace

Result<std::unique_ptr<Device>> open_board(const BoardProfile& profile, Clock& clock) {
  ENAMEL_TRY_ASSIGN(std::string rig_text, read_file(profile.rig));
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, calib::load_rig(profile.rig));
  ENAMEL_TRY(check_rig(rig, profile));
  BoardParts parts;
  // The light's line first: it is driven low before anything else is touched.
  const std::array<std::uint32_t, 1> light{profile.light_line}, gate{profile.gate_line};
  ENAMEL_TRY_ASSIGN(LineHandle light_line, request_lines(profile.chip, light, LineUse::kOutput));
  parts.light = std::make_unique<LineLight>(std::move(light_line), profile.led_current);
  ENAMEL_TRY_ASSIGN(LineHandle gate_line, request_lines(profile.chip, gate, LineUse::kOutput));
  const auto kept = std::make_shared<LineHandle>(std::move(gate_line));
  parts.gate = [kept](bool open) { return set_line(*kept, open); };
  const std::array<std::uint32_t, 3> edges{profile.lines.strobe, profile.lines.t1, profile.lines.t2};
  ENAMEL_TRY_ASSIGN(parts.events, request_lines(profile.chip, edges, LineUse::kEvents));
  parts.thermal = std::make_unique<SysfsThermal>(profile.thermal);
  if (profile.projector == ProjectorType::kDlpc350) {
    ENAMEL_TRY_ASSIGN(parts.hid, open_hidraw(profile.hid));
  } else {
    ENAMEL_TRY_ASSIGN(parts.bus, open_i2c(profile.bus, kDlpcAddress));
  }
  StreamWish wish;
  wish.camera = profile.camera;
  wish.format = profile.format;
  wish.width = profile.width;
  wish.height = profile.height;
  wish.buffers = profile.buffers;
  ENAMEL_TRY_ASSIGN(auto camera, LibcameraSource::open(wish));
  tell_missing(*camera);
  parts.camera = std::move(camera);
  ENAMEL_TRY_ASSIGN(auto device, BoardDevice::create(std::move(parts), profile, std::move(rig_text), clock));
  return std::unique_ptr<Device>(std::move(device));
}

}  // namespace enamel::fw
