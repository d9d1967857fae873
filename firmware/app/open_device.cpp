#include "firmware/app/open_device.hpp"

#include <utility>

#ifdef ENAMEL_HAS_SIM
#include "firmware/device/sim/capture_source.hpp"
#include "firmware/device/sim/sim_device.hpp"
#endif
#ifdef ENAMEL_HAS_TWIN
#include "tools/twin/twin_source.hpp"
#endif

namespace enamel::fw {
namespace {

#ifdef ENAMEL_HAS_SIM
Result<std::unique_ptr<BurstSource>> open_source(const ProbeOptions& options) {
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
#endif

}  // namespace

Result<std::unique_ptr<Device>> open_device(const ProbeOptions& options, Clock& clock) {
  if (!options.camera.empty()) {
    return fail(ErrorCode::kHal, "--camera " + options.camera + ": a camera alone is no probe; projector and trigger " +
                                     "lines have no driver in this build. Use --twin or --play, or --camera list");
  }
#ifdef ENAMEL_HAS_SIM
  ENAMEL_TRY_ASSIGN(auto source, open_source(options));
  SimConfig sim;
  sim.speed = options.speed;
  sim.model = options.capture.empty() ? "enamel twin" : "enamel player";
  ENAMEL_TRY_ASSIGN(auto device, SimDevice::create(std::move(source), clock, sim));
  return std::unique_ptr<Device>(std::move(device));
#else
  static_cast<void>(clock);
  return fail(ErrorCode::kHal, "--twin and --play: this build is for a probe and simulates nothing");
#endif
}

}  // namespace enamel::fw
