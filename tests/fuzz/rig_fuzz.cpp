// Any text as rig.json: a rig that is let in has finite optics that can be measured with, or names why not.
#include <cmath>
#include <cstdint>
#include <string>

#include "calib/model/rig.hpp"
#include "tests/fuzz/demand.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace enamel;
  using test::demand;
  const auto rig = calib::parse_rig(std::string(reinterpret_cast<const char*>(data), size));
  if (!rig) {
    demand(!rig.error().detail.empty(), "a refusal says why");
    return 0;
  }
  demand(rig->camera.width > 0 && rig->camera.height > 0, "a picture has a size");
  for (const double v : {rig->camera.fx, rig->camera.fy, rig->camera.cx, rig->camera.cy}) {
    demand(std::isfinite(v), "optics are finite");
  }
  return 0;
}
