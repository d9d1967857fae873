// When a pattern lies inside an exposure: camera as timing master, its strobe triggers the projector.
//
//   light on   t_L = L_trig + T_pre            light off  t_D = t_L + T_illum
//   contained      m <= t_L  and  t_D + m <= E             (a pattern cut off measures another grey curve: bit planes)
//   projector free L_trig + T_pre + T_illum + T_post <= T_frame - J
//   sensor         E <= (N_lines - 25) t_line,  T_frame = N_lines t_line
#pragma once

#include <string>
#include <vector>

#include "firmware/device/linux/dlpc347x/pattern_block.hpp"

namespace enamel::fw {

/// All us. Defaults: OV9281, 640x400 at 249.8 Hz, true 8-bit patterns.
struct TriggerTiming {
  PatternTiming pattern = {};
  double exposure_us = 3776;
  double line_us = 9.1;
  int frame_lines = 440;
  double trigger_latency_us = 50;  ///< L_trig: from the strobe to the sequence's start, at most
  double margin_us = 25;           ///< m, at both ends
  double jitter_us = 20;           ///< J
  [[nodiscard]] double frame_us() const { return line_us * frame_lines; }
};

/// What fails, each with both sides of its inequality; empty: the timing holds. Pure.
[[nodiscard]] std::vector<std::string> timing_faults(const TriggerTiming& timing);

}  // namespace enamel::fw
