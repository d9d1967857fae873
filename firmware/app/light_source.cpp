#include "firmware/app/light_source.hpp"

#include <utility>

#include "firmware/sim/capture_source.hpp"
#ifdef ENAMEL_HAS_TWIN
#include "tools/twin/twin_source.hpp"
#endif

namespace enamel::fw {

Result<std::unique_ptr<BurstSource>> open_source(const ProbeOptions& options) {
  if (!options.camera.empty()) {
    return fail(ErrorCode::kHal,
                "--camera " + options.camera + ": this build has no camera back end (libcamera); use --twin or --play");
  }
  if (!options.capture.empty()) {
    ENAMEL_TRY_ASSIGN(auto capture, CaptureSource::open(options.capture, options.loops));
    return std::unique_ptr<BurstSource>(std::move(capture));
  }
#ifdef ENAMEL_HAS_TWIN
  return twin::open_twin_source(options.twin_scene, options.seed);
#else
  return fail(ErrorCode::kHal, "--twin: this build has no twin (ENAMEL_WITH_TWIN is off)");
#endif
}

}  // namespace enamel::fw
