#include "firmware/app/open_device.hpp"

#include <utility>

#ifdef ENAMEL_HAS_LIBCAMERA
#include "firmware/device/linux/board/open_board.hpp"
#include "firmware/device/linux/libcamera/camera_list.hpp"
#endif
#ifdef ENAMEL_HAS_SIM
#include "firmware/device/sim/capture_source.hpp"
#include "firmware/device/sim/sim_device.hpp"
#endif
#ifdef ENAMEL_HAS_TWIN
#include "tools/twin/live_table.hpp"
#include "tools/twin/twin_source.hpp"
#endif

namespace enamel::fw {
namespace {

/// Says what is missing: the camera, or everything else of a probe.
Result<std::unique_ptr<Device>> only_a_camera(const std::string& name) {
#ifdef ENAMEL_HAS_LIBCAMERA
  ENAMEL_TRY(find_camera(name));
  return fail(ErrorCode::kUsage, "--camera " + name + " is there, but a camera alone is no probe: write it into a " +
                                     "profile as camera.id and give that with --profile");
#else
  return fail(ErrorCode::kHal, "--camera " + name + ": this build has no libcamera (ENAMEL_WITH_LIBCAMERA is off)");
#endif
}

#ifdef ENAMEL_HAS_SIM
Result<std::unique_ptr<BurstSource>> open_source(const ProbeOptions& options, [[maybe_unused]] Clock& clock) {
  if (!options.capture.empty()) {
    ENAMEL_TRY_ASSIGN(auto capture, CaptureSource::open(options.capture, options.loops));
    return std::unique_ptr<BurstSource>(std::move(capture));
  }
#ifdef ENAMEL_HAS_TWIN
  if (!options.twin_axes.empty()) {
    ENAMEL_TRY_ASSIGN(const auto fault, twin::parse_table_fault(options.twin_axes_fault));
    return twin::open_live_table({options.twin_scene, options.seed, options.twin_axes, fault, options.twin_truth, options.twin_surface},
                                 clock);
  }
  return twin::open_twin_source(options.twin_scene, options.seed);
#else
  return fail(ErrorCode::kHal, "--twin: this build has no twin (ENAMEL_WITH_TWIN is off)");
#endif
}
#endif

}  // namespace

Result<std::unique_ptr<Device>> open_device(const ProbeOptions& options, Clock& clock, const PartHandler& opened) {
  if (!options.camera.empty()) return only_a_camera(options.camera);
  if (!options.profile.empty()) {
#ifdef ENAMEL_HAS_LIBCAMERA
    ENAMEL_TRY_ASSIGN(const BoardProfile profile, read_profile(options.profile));
    if (opened) opened("profile", options.profile + ", its timing holds");
    return open_board(profile, clock, opened);
#else
    return fail(ErrorCode::kHal, "--profile: this build has no libcamera (ENAMEL_WITH_LIBCAMERA is off)");
#endif
  }
#ifdef ENAMEL_HAS_SIM
  ENAMEL_TRY_ASSIGN(auto source, open_source(options, clock));
  SimConfig sim;
  sim.speed = options.speed;
  sim.model = options.capture.empty() ? "enamel twin" : "enamel player";
  ENAMEL_TRY_ASSIGN(auto device, SimDevice::create(std::move(source), clock, sim));
  return std::unique_ptr<Device>(std::move(device));
#else
  static_cast<void>(clock);
  static_cast<void>(opened);
  return fail(ErrorCode::kHal, "--twin and --play: this build is for a probe and simulates nothing");
#endif
}

}  // namespace enamel::fw
