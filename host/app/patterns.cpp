// enamel patterns: a rig's pattern set as pictures to load into its projector.
#include <cstdio>
#include <memory>
#include <string>

#include "calib/io/pattern_files.hpp"
#include "calib/model/measuring_rig.hpp"
#include "host/app/calibration.hpp"
#include "host/app/command.hpp"
#include "pipeline/decode/burst_decoder.hpp"

namespace enamel::app {

namespace {

struct PatternsOptions {
  std::string rig, calibration, out;
  bool json = false;
};

/// A code whose fringe orders no decoder could tell apart is refused before it is projected. A rig that states no depth
/// range leaves that to whoever decodes.
Result<void> check_code(const calib::Rig& rig) {
  if (!rig.depth_range) return {};
  const auto decoder = pipeline::BurstDecoder::make(rig);
  if (decoder || decoder.error().code != ErrorCode::kPatternAmbiguous) return {};
  return tl::unexpected<Error>(decoder.error());
}

Result<int> run_patterns(const PatternsOptions& o) {
  ENAMEL_TRY_ASSIGN(calib::Rig rig, calib::load_rig(o.rig));
  if (!o.calibration.empty()) {
    ENAMEL_TRY_ASSIGN(const Calibration solved, load_calibration(o.calibration));
    ENAMEL_TRY_ASSIGN(rig, calib::measuring_rig(solved.rig, rig));
  }
  ENAMEL_TRY(check_code(rig));
  ENAMEL_TRY_ASSIGN(const std::string description, calib::write_patterns(rig, o.out));
  if (o.json) {
    std::fputs(description.c_str(), stdout);
  } else {
    std::printf("%s/frame_0.png to frame_3.png, %d x %d, %s\n", o.out.c_str(), rig.projector.width,
                rig.projector.height,
                rig.response ? "through the inverse of the projector's measured response"
                             : "for a linear projector: the rig states no response");
  }
  return 0;
}

}  // namespace

Run add_patterns(CLI::App& app) {
  auto o = std::make_shared<PatternsOptions>();
  app.add_option("RIG", o->rig, "the probe's rig.json, which states the pattern set")->required();
  app.add_option("--calibration", o->calibration, "a solved rig.json of the same probe, with the projector's response");
  app.add_option("OUT", o->out, "folder for frame_0.png … frame_3.png and patterns.json")->required();
  app.add_flag("--json", o->json, "patterns.json on stdout");
  return [o]() -> Result<int> { return run_patterns(*o); };
}

}  // namespace enamel::app
