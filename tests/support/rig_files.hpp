// Solved rig.json texts and pictures on disk, for tests that need files.
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "calib/io/rig_writer.hpp"
#include "calib/solve/bundle.hpp"
#include "pipeline/types/map.hpp"
#include "tests/support/calib_scene.hpp"

namespace enamel::test {

/// rig.json of the scene's true rig as `calibrate solve` would write it.
inline std::string solved_text(const CalibScene& scene, const std::string& serial, const std::string& calibrated_at) {
  calib::Rig nominal;
  nominal.text = R"({"format": "rig/1", "units": "mm", "nominal": true, "serial": ")" + serial + R"(",
    "camera": {}, "projector": {}, "T_proj_cam": [], "depth_range_mm": [40, 56],
    "patterns": {"mode": "multi", "cycles": [1, 4, 16, 64], "steps": 4}})";
  calib::SolvedRig solved;
  solved.camera = scene.truth.camera;
  solved.projector = scene.truth.projector;
  solved.T_proj_cam = scene.truth.T_proj_cam;
  solved.calibrated_at = calibrated_at;
  solved.rms_camera_px = 0.01;
  solved.rms_projector_px = 0.02;
  solved.poses = 10;
  for (const char* name : calib::rig_parameter_names()) solved.parameter_names.emplace_back(name);
  solved.covariance = 1e-10 * Eigen::MatrixXd::Identity(calib::kRigParameters, calib::kRigParameters);
  return calib::solved_rig_text(nominal, solved).value();
}

/// Levels rounded and held within 0…255.
inline void write_png(const std::string& path, const Map<float>& image) {
  cv::Mat out(image.height(), image.width(), CV_8U);
  for (int v = 0; v < out.rows; ++v)
    for (int u = 0; u < out.cols; ++u) out.at<unsigned char>(v, u) = cv::saturate_cast<unsigned char>(image(u, v));
  cv::imwrite(path, out);
}

}  // namespace enamel::test
