#include "tools/twin/board/nominal_rig.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "protocol/base/json_text.hpp"
#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFocal = 0.003, kCentre_px = 3, kShift_mm = 0.15;
constexpr double kTurn_rad = 0.2 * std::numbers::pi / 180;
constexpr std::uint64_t kUnitStream = 7200;  // of the random numbers

class Tolerance {
 public:
  explicit Tolerance(std::uint64_t seed) : random_(seed, kUnitStream) {}
  double within(double most) { return random_.uniform(counter_++, -most, most); }

 private:
  CounterRandom random_;
  std::uint64_t counter_ = 0;
};

void blur_lens(Json& lens, const calib::LensValues& truth, Tolerance& t) {
  const double f = 1 + t.within(kFocal);
  lens["fx"] = truth.fx * f;
  lens["fy"] = truth.fy * f;
  lens["cx"] = truth.cx + t.within(kCentre_px);
  lens["cy"] = truth.cy + t.within(kCentre_px);
  lens["dist"] = {0, 0, 0, 0, 0};
}

Json moved(const calib::Rig& truth, Tolerance& t) {
  Eigen::Matrix4d m;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) m(r, c) = truth.T_proj_cam[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  Eigen::Isometry3d pose(m);
  const Eigen::Vector3d turn(t.within(kTurn_rad), t.within(kTurn_rad), t.within(kTurn_rad));
  const Eigen::Vector3d shift(t.within(kShift_mm), t.within(kShift_mm), t.within(kShift_mm));
  if (turn.norm() > 0)
    pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * pose.linear();
  pose.translation() += shift;
  Json rows = Json::array();
  for (int r = 0; r < 4; ++r)
    rows.push_back({pose.matrix()(r, 0), pose.matrix()(r, 1), pose.matrix()(r, 2), pose.matrix()(r, 3)});
  return rows;
}

}  // namespace

Result<std::string> nominal_rig_text(const calib::Rig& truth, const MultiPatterns& patterns, int frames,
                                     std::uint64_t seed) {
  Json json = Json::parse(truth.text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return fail(ErrorCode::kRigInvalid, "rig text is not JSON");
  Tolerance tolerance(seed);
  json["nominal"] = true;
  blur_lens(json["camera"], truth.camera, tolerance);
  blur_lens(json["projector"], truth.projector, tolerance);
  json["T_proj_cam"] = moved(truth, tolerance);
  json["patterns"] = {{"mode", "multi"},
                      {"steps", 4},
                      {"cycles", patterns.cycles()},
                      {"mean", patterns.mean()},
                      {"amplitude", patterns.amplitude()}};
  if (frames > 1) json["noise"]["averaged_frames"] = frames;
  std::string text = json_text(json, 1) + "\n";
  ENAMEL_TRY(calib::parse_rig(text));
  return text;
}

}  // namespace enamel::twin
