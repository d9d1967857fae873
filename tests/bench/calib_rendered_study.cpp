// The rendered set of another program, solved blind, and spoilt in three ways; beside OpenCV on the same centres.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "calib/judge/plane_check.hpp"
#include "calib/judge/prediction.hpp"
#include "calib/model/lens.hpp"
#include "calib/solve/ground.hpp"
#include "calib/solve/measure_folder.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/rng.hpp"
#include "tests/bench/calib_opencv.hpp"
#include "tests/bench/calib_study.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/true_poses.hpp"

namespace enamel::bench {
namespace {

using calib::PoseView;

struct Set {
  calib::CalibFolder folder;
  calib::MeasuredFolder measured;
  calib::RigState truth;
};

calib::SolveOptions options_of(const Set& set) {
  calib::SolveOptions options;
  options.fringe_period_px = calib::finest_periods_px(set.folder);
  return options;
}

/// Ours, OpenCV on the same centres, and what our covariance expects.
Json both(const Set& set, const std::vector<PoseView>& views) {
  const auto solution = calib::solve(views, set.folder.target, set.folder.nominal, options_of(set));
  if (!solution) return {{"refused", solution.error().detail}};
  const OpenCvRig peer = stereo_calibrate(solution->poses, set.folder.target, set.folder.nominal);
  const auto expected = calib::Prediction(solution->state, solution->result.covariance, kRange).at(0.5);
  return {{"poses", solution->poses.size()},
          {"ours", error_json(solution->state, set.truth)},
          {"opencv", error_json(peer.state, set.truth)},
          {"expected_p95_um", expected.p95_um},
          {"rms_camera_px", solution->result.rms_camera_px},
          {"rms_projector_px", solution->result.rms_projector_px},
          {"opencv_rms_camera_px", peer.rms_camera_px},
          {"opencv_rms_projector_px", peer.rms_projector_px}};
}

/// Noise of the pictures raised to four times the stated one, rounded as a camera rounds.
std::vector<PoseView> noisier(const Set& set) {
  Rng rng(4, 1, 1);
  std::vector<PoseView> views;
  const calib::PixelNoise stated = *set.folder.noise;
  const auto first = calib::load_pose(set.folder, set.folder.poses[0]).value();
  const auto edges = calib::choose_edge_model(first, set.folder.target, stated).value();
  for (const std::string& name : set.folder.poses) {
    auto frames = calib::load_pose(set.folder, name).value();
    const auto spoil = [&](Map<float>& image) {
      for (float& p : image.pixels()) {
        const double sigma = std::sqrt(15 * stated.variance(static_cast<double>(p)));
        p = static_cast<float>(std::clamp(std::round(static_cast<double>(p) + sigma * rng.normal()), 0.0, 255.0));
      }
    };
    spoil(frames.white);
    spoil(frames.black);
    for (auto* levels : {&frames.along_u, &frames.along_v}) {
      for (auto& level : *levels)
        for (auto& frame : level.frames) spoil(frame);
    }
    const calib::LensValues& p = set.folder.nominal.projector;
    auto view =
        calib::measure_pose(frames, set.folder.target, stated, set.folder.saturation_dn, {p.width, p.height}, edges);
    if (view) views.push_back(std::move(*view));
  }
  return views;
}

std::vector<PoseView> with_hidden_dots(std::vector<PoseView> views) {
  Rng rng(2, 1, 1);
  for (PoseView& view : views) {
    for (int k = 0; k < 2; ++k) {
      const double at = rng.uniform() * static_cast<double>(view.dots.size() - 1);
      view.dots.erase(view.dots.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
  return views;
}

/// Images of the disc centres against their true places, px rms an axis.
double centre_error_px(const Set& set, const calib::Solution& solution) {
  const auto poses = test::true_poses(set.folder.path + "/truth/poses.csv");
  double squares = 0, n = 0;
  for (const PoseView& pose : solution.poses) {
    for (const calib::DotView& dot : pose.dots) {
      const Vec3d p = poses.at(std::stoi(pose.name)) * set.folder.target.place(dot.dot);
      const calib::PlanePoint q = calib::project(set.truth.camera, {p.x() / p.z(), p.y() / p.z()});
      squares += std::pow(dot.camera_px.x() - q.x, 2) + std::pow(dot.camera_px.y() - q.y, 2);
      n += 2;
    }
  }
  return std::sqrt(squares / n);
}

/// A pose with the ground between its dots, measured as if nothing had looked there before.
PoseView with_ground(const Set& set, const PoseView& dots) {
  const auto frames = calib::load_pose(set.folder, dots.name).value();
  const int width = set.folder.nominal.projector.width;
  const auto u = calib::decode_coordinate(frames.along_u, width, set.measured.noise).value();
  PoseView view{.name = dots.name, .dots = {}, .ground = {}, .blur_px = dots.blur_px};
  const double period_px = static_cast<double>(width) / frames.along_u.back().cycles;
  view.ground = calib::ground_samples(u, dots, set.folder.target, period_px);
  return view;
}

/// Held-out poses: rms of their planes by the rig that did not see them and by the true one.
Json held_out(const Set& set) {
  const std::set<std::string> names{"02", "05", "08"};
  std::vector<PoseView> seen, judges;
  for (const PoseView& view : set.measured.views) (names.contains(view.name) ? judges : seen).push_back(view);
  const auto solution = calib::solve(seen, set.folder.target, set.folder.nominal, options_of(set)).value();
  const auto rms = [&](const calib::RigState& rig) {
    double squares = 0, points = 0;
    for (const PoseView& view : judges) {
      const auto plane =
          calib::check_plane(with_ground(set, view), set.folder.target, rig, set.measured.ripple).value();
      squares += plane.rms_um * plane.rms_um * static_cast<double>(plane.points);
      points += static_cast<double>(plane.points);
    }
    return std::sqrt(squares / points);
  };
  return {{"ours_um", rms(solution.state)}, {"truth_um", rms(set.truth)}};
}

}  // namespace

Json rendered_study(const std::string& path) {
  if (!std::filesystem::exists(path + "/target.json")) return Json::object();
  Set set{
      calib::open_calib_folder(path).value(), {}, calib::state_of(calib::load_rig(path + "/truth/rig.json").value())};
  const double begin = thread_ms();
  set.measured = calib::measure_folder(set.folder, {}).value();
  const double measured = thread_ms();
  const auto solution =
      calib::solve(set.measured.views, set.folder.target, set.folder.nominal, options_of(set)).value();
  const double solved = thread_ms();
  std::vector<PoseView> four, detected;
  for (std::size_t j = 0; j < set.measured.views.size(); j += 3) four.push_back(set.measured.views[j]);
  for (const PoseView& view : solution.poses)
    detected.push_back(detector_view(calib::load_pose(set.folder, view.name).value(), view));
  Json json{{"blind", both(set, set.measured.views)}};
  const OpenCvRig peer = stereo_calibrate(detected, set.folder.target, set.folder.nominal);
  json["opencv_detector"] = error_json(peer.state, set.truth);
  json["four_poses"] = both(set, four);
  json["four_times_noise"] = both(set, noisier(set));
  json["two_dots_hidden"] = both(set, with_hidden_dots(set.measured.views));
  json["held_out"] = held_out(set);
  json["centre_error_px"] = centre_error_px(set, solution);
  json["measure_ms_per_pose"] = (measured - begin) / static_cast<double>(set.folder.poses.size());
  json["solve_ms"] = solved - measured;
  return json;
}

}  // namespace enamel::bench
