#include "host/app/calibrate/bar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/judge/sphere_bar.hpp"
#include "calib/model/measuring_rig.hpp"
#include "host/app/calibration.hpp"
#include "host/record/burst_stream.hpp"
#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/stages/burst_view.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

std::vector<calib::BarPoint> points_of(const SurfacePatch& patch) {
  std::vector<calib::BarPoint> points;
  for (int v = 0; v < patch.depth_mm.height(); ++v) {
    for (int u = 0; u < patch.depth_mm.width(); ++u) {
      const std::size_t i = patch.depth_mm.index(u, v);
      if (std::isnan(patch.depth_mm[i])) continue;
      const Vec3d p = patch.points[i].cast<double>();
      points.push_back({u, v, p, static_cast<double>(patch.sigma_mm[i]) * p.norm() / p.z()});
    }
  }
  return points;
}

Json sphere_json(const calib::SphereFit& s, double design_mm) {
  return {{"diameter_mm", s.diameter_mm()},
          {"off_um", 1e3 * (s.diameter_mm() - design_mm)},
          {"sigma_um", 1e3 * s.diameter_sigma_mm()},
          {"form_p95_um", s.form_p95_um},
          {"rms_um", s.rms_um},
          {"points", s.points}};
}

Json burst_json(std::uint64_t burst, const calib::BarCheck& bar, const calib::BarDesign& design) {
  return {{"burst", burst},
          {"smaller", sphere_json(bar.spheres[0], design.diameter_mm[0])},
          {"larger", sphere_json(bar.spheres[1], design.diameter_mm[1])},
          {"distance_mm", bar.distance_mm},
          {"distance_off_um", 1e3 * (bar.distance_mm - design.distance_mm)},
          {"distance_sigma_um", 1e3 * bar.distance_sigma_mm},
          {"reasons", calib::judge_bar(bar, design)}};
}

}  // namespace

Result<Json> check_bar(const calib::Rig& rig, const BarOptions& options) {
  if (options.design_mm.size() != 3 ||
      !std::all_of(options.design_mm.begin(), options.design_mm.end(), [](double mm) { return mm > 0; }))
    return fail(ErrorCode::kUsage, "--bar-mm wants both diameters, the smaller one first, and the distance: 5,6,8");
  const calib::BarDesign design{{options.design_mm[0], options.design_mm[1]}, options.design_mm[2]};
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(options.capture));
  if (stream->rig_text().empty()) return fail(ErrorCode::kRigMissing, options.capture);
  ENAMEL_TRY_ASSIGN(const calib::Rig recorded, calib::parse_rig(stream->rig_text()));
  Json out{{"bursts", Json::array()}, {"notes", Json::array()}, {"verdict", "accepted"}};
  for (const std::uint64_t id : options.bursts) {
    ENAMEL_TRY_ASSIGN(const proto::Burst burst, stream->burst_with_id({id}));
    if (!proto::is_consistent(burst)) return fail(ErrorCode::kCaptureCorrupt, fmt::format("burst {}", id));
    const double temp_c = burst.temp_centi_c / 100.0;
    if (const auto beyond = calib::kelvins_beyond(rig, temp_c); beyond && *beyond > CalibrationLimits{}.max_kelvins) {
      out["notes"].push_back(fmt::format("burst {}: {:.1f} degrees C lies {:.1f} K beyond what the calibration covers",
                                         id, temp_c, *beyond));
    }
    ENAMEL_TRY_ASSIGN(const calib::Rig optics, calib::measuring_rig(calib::rig_at(rig, temp_c), recorded));
    ENAMEL_TRY_ASSIGN(const auto decoder, pipeline::BurstDecoder::make(optics));
    const pipeline::DecodedBurst decoded = decoder.decode(stage::view_of(burst));
    if (!decoded.accepted())
      return fail(ErrorCode::kQualityGate, fmt::format("burst {}: {}", id, pipeline::name_of(decoded.verdict)));
    ENAMEL_TRY_ASSIGN(const calib::BarCheck bar, calib::check_bar(points_of(decoded.patch)));
    out["bursts"].push_back(burst_json(id, bar, design));
    if (!out["bursts"].back()["reasons"].empty()) out["verdict"] = "refused";
  }
  return out;
}

}  // namespace enamel::app
