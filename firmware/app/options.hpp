// Command line of enamel-probe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/base/result.hpp"
#include "protocol/dds/participant.hpp"

namespace enamel::fw {

struct ProbeOptions {
  std::string twin_scene;
  std::string twin_axes;        ///< serial port of the scene's table to make; empty: the scene's own stops
  std::string twin_axes_fault;  ///< of the simulated axes
  std::string twin_surface;     ///< file for the surface behind them
  std::string twin_truth;       ///< file for what the table's bursts showed
  std::string capture;
  std::string camera;                 ///< "list", or a camera to look for
  std::string profile;                ///< of the board that this runs on
  std::optional<std::uint64_t> seed;  ///< overrides the scene's
  std::string serial;
  dds::ParticipantOptions link;
  double speed = 1.0;
  int loops = 1;
  std::optional<double> seconds;
  std::string scan_lock;   ///< shared with enamel-updated; empty: this probe is never updated
  bool check = false;      ///< no service: prove the device
  bool dark = false;       ///< no service: switch the board's light off
  std::string picture;     ///< with check: where its burst goes
  bool self_test = false;  ///< no probe: ask the one that runs
  bool exit_after_session = false;
  bool json = false;
};

/// Nullopt: --help was asked for and printed. Errors: kUsage.
[[nodiscard]] Result<std::optional<ProbeOptions>> parse_options(int argc, const char* const* argv);

}  // namespace enamel::fw
