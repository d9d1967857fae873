// Rigs and boards of our own generator, and single discs.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/judge/prediction.hpp"
#include "calib/solve/median.hpp"
#include "tests/bench/calib_opencv.hpp"
#include "tests/bench/calib_study.hpp"
#include "tests/support/calib_scene.hpp"
#include "tests/support/disc_image.hpp"

namespace enamel::bench {
namespace {

double bow_of(const calib::VolumeDifference& d) {
  double most = 0;
  for (const auto& plane : d.planes) most = std::max({most, std::abs(plane.sag_um()), std::abs(plane.twist_um)});
  return most;
}

/// The fringes of one pose are taken after the target slipped by half a projector pixel.
void slip(calib::PoseView& view) {
  for (calib::DotView& dot : view.dots) {
    for (auto& sample : dot.samples) sample.projector_px.x() += 0.5;
    dot.map.projector_px.x() += 0.5;
  }
}

struct Disc {
  double radius_px, tilt_deg, blur_px;
};

Json disc_json(const Disc& disc) {
  constexpr int kDraws = 200;
  constexpr double kReach_px = 12;
  const int side = static_cast<int>(2 * disc.radius_px + 30);
  const double shorter = disc.radius_px * std::cos(disc.tilt_deg * std::numbers::pi / 180);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.4).toRotationMatrix();
  calib::Ellipse truth;
  truth.shape =
      turn * Eigen::Vector2d(std::pow(disc.radius_px, -2), std::pow(shorter, -2)).asDiagonal() * turn.transpose();
  Rng rng(static_cast<std::uint64_t>(disc.radius_px * 100 + disc.tilt_deg), 5, 1);
  Eigen::Vector2d sum(0, 0);
  double ours = 0, moments = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    truth.centre = {0.5 * side + rng.uniform(), 0.5 * side + rng.uniform()};
    const Map<float> image = test::noisy(test::disc_image(truth, disc.blur_px, side), rng);
    const auto start = calib::disc_moments(image, truth, kReach_px);
    const auto fit = calib::fit_disc(image, test::kDiscNoise, *start, kReach_px, calib::EdgeModel::kPixelThenTaps);
    if (!fit) continue;
    sum += (fit->ellipse.centre - truth.centre) / kDraws;
    ours += (fit->ellipse.centre - truth.centre).squaredNorm() / (2 * kDraws);
    moments += (start->centre - truth.centre).squaredNorm() / (2 * kDraws);
  }
  truth.centre = {0.5 * side, 0.5 * side};
  // The bound is along u; the disc is turned, so that u and v differ: their mean square.
  const double along_u = test::bound_px(truth, disc.blur_px, side);
  std::swap(truth.shape(0, 0), truth.shape(1, 1));
  const double along_v = test::bound_px(truth, disc.blur_px, side);
  const double bound = std::sqrt(0.5 * (along_u * along_u + along_v * along_v));
  return {{"radius_px", disc.radius_px},
          {"tilt_deg", disc.tilt_deg},
          {"blur_px", disc.blur_px},
          {"bias_px", sum.norm()},
          {"sigma_over_bound", std::sqrt(ours) / bound},
          {"moments_over_bound", std::sqrt(moments) / bound}};
}

}  // namespace

Json error_json(const calib::RigState& solved, const calib::RigState& truth) {
  const calib::VolumeDifference d = calib::compare_rigs(solved, truth, kRange);
  return {{"p95_um", d.p95_um},
          {"p95_without_scale_um", d.shape_p95_um},
          {"scale_ppm", d.scale_ppm},
          {"bow_um", bow_of(d)}};
}

Json rigs_study(std::uint64_t first_seed) {
  constexpr int kRigs = 30;
  int within = 0, named = 0, refused = 0, beyond_95 = 0;
  std::vector<double> ratio;
  for (std::uint64_t seed = first_seed; seed < first_seed + kRigs; ++seed) {
    const auto scene = test::make_calib_scene(seed, 10);
    Rng rng(seed, 1, 1);
    auto views = test::make_views(scene, {.centre_px = 0.005}, rng);
    slip(views[seed % 10]);
    const auto solved = calib::solve(views, scene.target, scene.nominal, {});
    if (!solved) {
      ++refused;
      continue;
    }
    named += solved->rejected.size() == 1 && solved->rejected[0].pose == std::to_string(seed % 10) ? 1 : 0;
    const double error = calib::compare_rigs(solved->state, scene.truth, kRange).p95_um;
    const calib::Prediction prediction(solved->state, solved->result.covariance, kRange);
    within += error < 1.2 * prediction.at(calib::kBoundQuantile).p95_um ? 1 : 0;
    beyond_95 += error > prediction.at(0.95).p95_um ? 1 : 0;
    ratio.push_back(error / prediction.at(0.5).p95_um);
  }
  return {{"first_seed", first_seed},
          {"rigs", kRigs},
          {"within", within},
          {"beyond_95", beyond_95},
          {"named", named},
          {"refused", refused},
          {"median_over_expected", ratio.empty() ? 0 : calib::median(ratio)}};
}

Json boards_study() {
  constexpr int kBoards = 20, kPoses = 20;
  std::vector<double> ours, bow, opencv, opencv_bow;
  for (std::uint64_t seed = 400; seed < 400 + kBoards; ++seed) {
    auto scene = test::make_calib_scene(seed, kPoses);
    Rng rng(seed, 1, 1);
    test::deform_target(scene, 0.003, 0.020, rng);
    const auto views = test::make_views(scene, {.centre_px = 0.002}, rng);
    const auto solved = calib::solve(views, scene.target, scene.nominal, {});
    if (!solved) continue;
    const auto d = calib::compare_rigs(solved->state, scene.truth, kRange);
    const auto peer =
        calib::compare_rigs(stereo_calibrate(views, scene.target, scene.nominal).state, scene.truth, kRange);
    ours.push_back(d.shape_p95_um);
    bow.push_back(bow_of(d));
    opencv.push_back(peer.shape_p95_um);
    opencv_bow.push_back(bow_of(peer));
  }
  return {{"boards", kBoards},
          {"solved", ours.size()},
          {"p95_um", calib::median(ours)},
          {"bow_um", calib::median(bow)},
          {"opencv_p95_um", calib::median(opencv)},
          {"opencv_bow_um", calib::median(opencv_bow)}};
}

Json centres_study() {
  Json out = Json::array();
  for (const Disc& disc :
       {Disc{9, 0, 0.6}, Disc{9, 45, 0.6}, Disc{12, 30, 0.8}, Disc{18, 0, 0.6}, Disc{18, 45, 1.2}, Disc{36, 20, 0.6}})
    out.push_back(disc_json(disc));
  return out;
}

}  // namespace enamel::bench
