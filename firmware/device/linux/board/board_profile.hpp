// What a probe's board is made of: camera, projector, lines, sensors. config/probe/*.toml.
#pragma once

#include <string>
#include <vector>

#include "firmware/device/linux/camera/request_camera.hpp"
#include "firmware/device/linux/dlpc347x/dlpc347x.hpp"
#include "firmware/device/linux/dlpc347x/trigger_timing.hpp"
#include "firmware/device/linux/dlpc350/dlpc350.hpp"
#include "firmware/device/linux/lines/line_edges.hpp"
#include "firmware/device/linux/lines/sysfs_sensors.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

enum class ProjectorType : std::uint8_t { kDlpc347x, kDlpc350 };

struct BoardProfile {
  std::string model = "enamel probe";
  std::string rig;  ///< rig.json; a relative path is taken from the profile's folder

  std::string camera = "any", format = "R8";
  int width = 640, height = 400, buffers = 8;
  double gain = 1, max_stamp_spread_us = 100;
  TriggerTiming timing;

  ProjectorType projector = ProjectorType::kDlpc347x;
  std::string bus = "/dev/i2c-1", dmd = "DLP2010";  ///< of a DLPC347x
  std::string hid = "any";                          ///< of a DLPC350, with its images
  std::uint8_t image = 0;
  ProjectorLimits limits;
  std::uint16_t led_code = 200;

  std::string chip = "/dev/gpiochip0";
  EdgeLines lines{17, 27, 22, 4};
  std::uint32_t gate_line = 23, light_line = 24;

  ThermalFiles thermal;
  std::string led_current;  ///< file with mA

  std::string heater_pwm;  ///< /sys/class/pwm/pwmchipN/pwmM; empty: no heater
  int heater_period_us = 1000;
  std::string watchdog;  ///< empty: none, or systemd feeds it
  int watchdog_s = 10;

  [[nodiscard]] RequestCameraConfig camera_config() const;
};

/// Errors: those of the file; kBoardTiming with every inequality that fails.
[[nodiscard]] Result<BoardProfile> read_profile(const std::string& path);

}  // namespace enamel::fw
