// What a person switched on or off.
#pragma once

namespace enamel::view {

struct DisplayToggles {
  bool quality_map = false;
  bool mono = false;        ///< matte grey light instead of tooth colour: shows steps and holes
  bool soft_tissue = true;  ///< shown, in its own shade and striped; off: teeth alone
  bool follow = true;
  bool frustum = true;
  bool trail = true;
  bool live_image = true;
  bool panels = true;   ///< the outline and the state's words always stay
  bool stages = false;  ///< how long each stage of the pipeline takes and which one is the bottleneck
  bool help = false;
  friend constexpr bool operator==(const DisplayToggles&, const DisplayToggles&) = default;
};

}  // namespace enamel::view
