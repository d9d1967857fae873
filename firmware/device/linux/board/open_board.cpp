#include "firmware/device/linux/board/open_board.hpp"

#include <fmt/core.h>

#include <array>
#include <memory>
#include <optional>

#include "calib/model/rig.hpp"
#include "firmware/device/linux/libcamera/libcamera_source.hpp"
#include "firmware/device/linux/lines/kernel_watchdog.hpp"
#include "firmware/device/linux/lines/pwm_heater.hpp"
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

std::string missing_controls(const LibcameraSource& camera) {
  std::string missing;
  for (const std::string& name : camera.missing_controls()) missing += (missing.empty() ? "" : ", ") + name;
  return missing.empty() ? "" : "; its driver has no " + missing + ": what the profile says of it is not set";
}

Result<LineHandle> request_output(const BoardProfile& profile, std::uint32_t line) {
  const std::array<std::uint32_t, 1> lines{line};
  return request_lines(profile.chip, lines, LineUse::kOutput);
}

/// The light's line first: it is driven low before anything else is touched.
Result<void> open_lines(BoardParts& parts, const BoardProfile& profile) {
  ENAMEL_TRY_ASSIGN(LineHandle light_line, request_output(profile, profile.light_line));
  parts.light = std::make_unique<LineLight>(std::move(light_line), profile.led_current);
  ENAMEL_TRY_ASSIGN(LineHandle gate_line, request_output(profile, profile.gate_line));
  const auto kept = std::make_shared<LineHandle>(std::move(gate_line));
  parts.gate = [kept](bool open) { return set_line(*kept, open); };
  const std::array<std::uint32_t, 3> edges{profile.lines.strobe, profile.lines.t1, profile.lines.t2};
  ENAMEL_TRY_ASSIGN(parts.events, request_lines(profile.chip, edges, LineUse::kEvents));
  return {};
}

Result<void> open_tip(BoardParts& parts, const BoardProfile& profile) {
  parts.thermal = std::make_unique<SysfsThermal>(profile.thermal);
  if (profile.heater_pwm.empty()) return {};
  ENAMEL_TRY_ASSIGN(parts.heater, PwmHeater::open(profile.heater_pwm, profile.heater_period_us));
  return {};
}

std::string temperatures(const Thermal& thermal) {
  const auto text = [](const std::optional<std::int16_t>& cc) {
    return cc ? fmt::format("{:.1f}", 0.01 * *cc) : std::string("none");
  };
  const Temperatures t = thermal.read();
  return fmt::format("tip {}, LED {}, processor {}, optics {} degC", text(t.tip_cc), text(t.led_cc), text(t.soc_cc),
                     text(t.optics_cc));
}

/// Returns its port's name.
Result<std::string> open_projector(BoardParts& parts, const BoardProfile& profile) {
  if (profile.projector == ProjectorType::kDlpc350) {
    ENAMEL_TRY_ASSIGN(parts.hid, open_hidraw(profile.hid));
    return profile.hid;
  }
  ENAMEL_TRY_ASSIGN(parts.bus, open_i2c(profile.bus, kDlpcAddress));
  return profile.bus;
}

Result<std::string> open_camera(BoardParts& parts, const BoardProfile& profile) {
  StreamWish wish;
  wish.camera = profile.camera;
  wish.format = profile.format;
  wish.width = profile.width;
  wish.height = profile.height;
  wish.buffers = profile.buffers;
  ENAMEL_TRY_ASSIGN(auto camera, LibcameraSource::open(wish));
  const std::string missing = missing_controls(*camera);
  if (!missing.empty()) log::warn("camera", "{}", missing.substr(2));
  parts.camera = std::move(camera);
  return fmt::format("{} {}x{}{}", profile.format, profile.width, profile.height, missing);
}

}  // namespace

Result<std::unique_ptr<Device>> open_board(const BoardProfile& profile, Clock& clock, const PartHandler& opened) {
  const auto is_open = [&](const char* part, const std::string& what) {
    if (opened) opened(part, what);
  };
  ENAMEL_TRY_ASSIGN(std::string rig_text, read_file(profile.rig));
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, calib::load_rig(profile.rig));
  ENAMEL_TRY(check_rig(rig, profile));
  is_open("rig", profile.rig);
  BoardParts parts;
  ENAMEL_TRY(open_lines(parts, profile));
  is_open("lines", profile.chip);
  ENAMEL_TRY(open_tip(parts, profile));
  is_open("sensors", temperatures(*parts.thermal));
  if (parts.heater) is_open("heater", profile.heater_pwm);
  ENAMEL_TRY_ASSIGN(const std::string port, open_projector(parts, profile));
  is_open("port", port);
  ENAMEL_TRY_ASSIGN(const std::string camera, open_camera(parts, profile));
  is_open("camera", camera);
  if (!profile.watchdog.empty()) {
    ENAMEL_TRY_ASSIGN(parts.watchdog, KernelWatchdog::open(profile.watchdog, profile.watchdog_s));
    is_open("watchdog", fmt::format("{}, {} s", profile.watchdog, profile.watchdog_s));
  }
  ENAMEL_TRY_ASSIGN(auto device, BoardDevice::create(std::move(parts), profile, std::move(rig_text), clock));
  is_open("projector", "ready for triggers, dark");
  return std::unique_ptr<Device>(std::move(device));
}

Result<void> darken_board(const BoardProfile& profile, Clock& clock) {
  std::optional<Error> first;
  const auto note = [&](const Error& e) {
    if (first) {
      if (first->detail.find(e.detail) == std::string::npos) first->detail += "; " + e.detail;
    } else {
      first = e;
    }
  };
  // An output is driven low when it is requested.
  for (const std::uint32_t line : {profile.light_line, profile.gate_line}) {
    if (const auto low = request_output(profile, line); !low) note(low.error());
  }
  if (!profile.heater_pwm.empty()) {
    if (const auto off = PwmHeater::open(profile.heater_pwm, profile.heater_period_us); !off) note(off.error());
  }
  // A controller that is opened goes dark first.
  BoardParts parts;
  if (const auto port = open_projector(parts, profile); !port) {
    note(port.error());
  } else if (const auto dark = open_controller(parts, profile, clock); !dark) {
    note(dark.error());
  }
  if (first) return tl::unexpected(*first);
  return {};
}

}  // namespace enamel::fw
