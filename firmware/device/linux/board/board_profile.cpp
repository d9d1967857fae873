#include "firmware/device/linux/board/board_profile.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "protocol/base/config.hpp"

namespace enamel::fw {
namespace {

constexpr std::uint32_t kMostLines = 1023;
constexpr std::uint16_t kDlpc347xMostLedCode = 1023;

void bind_camera(ConfigReader& r, BoardProfile& p) {
  r.bind("camera.id", p.camera, "id or model as --camera list prints it, or any");
  r.bind("camera.format", p.format, "R8, R10 or R10_CSI2P");
  r.bind("camera.width", p.width, {16, 8192}, "pixels");
  r.bind("camera.height", p.height, {16, 8192}, "pixels");
  r.bind("camera.buffers", p.buffers, {1, 64}, "requests in flight");
  r.bind("camera.gain", p.gain, {1.0, 16.0}, "analogue gain");
  r.bind("camera.max_stamp_spread_us", p.max_stamp_spread_us, {1.0, 1e5},
         "scatter of its stamps that is still trusted");
  r.bind("camera.exposure_us", p.timing.exposure_us, {10.0, 1e6}, "exposure, us");
  r.bind("camera.line_us", p.timing.line_us, {0.1, 1e4}, "time of a sensor line, us");
  r.bind("camera.frame_lines", p.timing.frame_lines, {16, 100000}, "lines of a frame, blanking included");
}

void bind_dlpc347x(ConfigReader& r, BoardProfile& p) {
  r.bind("projector.bus", p.bus, "I2C bus");
  r.bind("projector.dmd", p.dmd, "mirror array: DLP2010 or DLP3010");
  if (p.dmd != kDlp2010.name && p.dmd != kDlp3010.name) r.reject("projector.dmd", "DLP2010 or DLP3010");
}

void bind_dlpc350(ConfigReader& r, BoardProfile& p) {
  r.bind("projector.hid", p.hid, "/dev/hidrawN, or any");
  r.bind("projector.image", p.image, {0, kDlpc350LastImage}, "first of the two flash images with the patterns");
  p.limits = kDlpc350Limits;
  p.led_code = kDlpc350Limits.max_led_code / 2;
  p.timing.pattern = kDlpc350Timing;
}

void bind_projector(ConfigReader& r, BoardProfile& p) {
  constexpr std::array<std::pair<std::string_view, ProjectorType>, 2> kTypes{
      {{"dlpc347x", ProjectorType::kDlpc347x}, {"dlpc350", ProjectorType::kDlpc350}}};
  r.bind("projector.type", p.projector, kTypes, "controller: dlpc347x on I2C, dlpc350 on USB");
  const bool usb = p.projector == ProjectorType::kDlpc350;
  usb ? bind_dlpc350(r, p) : bind_dlpc347x(r, p);
  const std::uint16_t most = usb ? kDlpc350MostLedCode : kDlpc347xMostLedCode;
  r.bind("projector.max_led_code", p.limits.max_led_code, {1, most}, "ceiling of the LED current, controller's code");
  r.bind("projector.led_code", p.led_code, {1, most}, "LED current, controller's code");
  if (p.led_code > p.limits.max_led_code) r.reject("projector.led_code", "above projector.max_led_code");
  r.bind("projector.illum_us", p.timing.pattern.illum_us, {100, 1000000}, "a pattern is lit, us");
  r.bind("projector.pre_us", p.timing.pattern.pre_us, {0, 1000000}, "dark before it, us");
  r.bind("projector.post_us", p.timing.pattern.post_us, {0, 1000000}, "dark after it, us");
  r.bind("projector.trigger_latency_us", p.timing.trigger_latency_us, {0.0, 1e5},
         "strobe to sequence start at most, us");
}

void bind_lines(ConfigReader& r, BoardProfile& p) {
  r.bind("lines.chip", p.chip, "GPIO chip");
  std::set<std::uint32_t> taken;
  const auto line = [&](const char* key, std::uint32_t& value, const char* doc) {
    r.bind(key, value, {0, kMostLines}, doc);
    if (!taken.insert(value).second) r.reject(key, "this line has another use already");
  };
  line("lines.strobe", p.lines.strobe, "camera's strobe");
  line("lines.t1", p.lines.t1, "projector's TRIG_OUT_1: a set begins");
  line("lines.t2", p.lines.t2, "projector's TRIG_OUT_2: a pattern is lit");
  r.bind("lines.dark_frames", p.lines.dark_frames, {1, 1000}, "between two bursts at least");
  line("lines.gate", p.gate_line, "output: strobes pass to the projector");
  line("lines.light", p.light_line, "output: LED enable");
}

void bind_sensors(ConfigReader& r, BoardProfile& p) {
  r.bind("sensors.tip", p.thermal.tip, "file with milli-degrees: tip window");
  r.bind("sensors.led", p.thermal.led, "file with milli-degrees: LED");
  r.bind("sensors.soc", p.thermal.soc, "file with milli-degrees: processor");
  r.bind("sensors.optics", p.thermal.optics, "file with milli-degrees: measuring head");
  r.bind("sensors.led_current", p.led_current, "file with the LED's current, mA");
}

void bind_heater_and_watchdog(ConfigReader& r, BoardProfile& p) {
  r.bind("heater.pwm", p.heater_pwm, "PWM output of the tip's heater, /sys/class/pwm/pwmchipN/pwmM; empty: none");
  r.bind("heater.period_us", p.heater_period_us, {10, 1000000}, "its period, us");
  if (!p.heater_pwm.empty() && p.thermal.tip.empty()) r.reject("heater.pwm", "nothing is heated without sensors.tip");
  r.bind("watchdog.device", p.watchdog, "the board's watchdog; empty: none, or the service manager's");
  r.bind("watchdog.seconds", p.watchdog_s, {2, 120}, "it resets the board after");
}

}  // namespace

RequestCameraConfig BoardProfile::camera_config() const {
  RequestCameraConfig config;
  config.controls.exposure_us = static_cast<std::uint32_t>(std::lround(timing.exposure_us));
  config.controls.analogue_gain_q8 = static_cast<std::uint32_t>(std::lround(gain * 256));
  config.controls.frame_period = Nanoseconds{std::llround(timing.frame_us() * 1000)};
  return config;
}

Result<BoardProfile> read_profile(const std::string& path) {
  ENAMEL_TRY_ASSIGN(auto reader, ConfigReader::from_file(path));
  BoardProfile profile;
  reader.bind("probe.model", profile.model, "as a person would call it");
  reader.bind("probe.rig", profile.rig, "calibration in force");
  bind_camera(reader, profile);
  bind_projector(reader, profile);
  bind_lines(reader, profile);
  bind_sensors(reader, profile);
  bind_heater_and_watchdog(reader, profile);
  ENAMEL_TRY(reader.finish());
  auto faults = timing_faults(profile.timing);
  if (profile.projector == ProjectorType::kDlpc350) {
    for (std::string& fault : dlpc350_timing_faults(profile.timing.pattern)) faults.push_back(std::move(fault));
  }
  if (!faults.empty()) {
    return fail(ErrorCode::kBoardTiming, fmt::format("{}: {}", path, fmt::join(faults, "; ")));
  }
  if (profile.led_current.empty()) {
    return fail(ErrorCode::kConfigValue,
                path + ": sensors.led_current is needed: without it nobody knows whether the light is off");
  }
  if (profile.rig.empty()) return fail(ErrorCode::kRigMissing, path + ": probe.rig names the calibration in force");
  profile.rig = (std::filesystem::path(path).parent_path() / profile.rig).string();
  return profile;
}

}  // namespace enamel::fw
