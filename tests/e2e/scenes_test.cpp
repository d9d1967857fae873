// Every scene that ships renders, and one burst of it decodes to the depth that the twin says was there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

struct DepthError {
  double coverage = 0;  ///< share of the truth's lit pixels that have a depth
  double median_mm = 1e9;
  double wrong = 1;  ///< share of the measured that is off by more than half a fringe order, 1.7 mm
};

cv::Mat depth_map(const std::string& path) { return cv::imread(path, cv::IMREAD_UNCHANGED); }

DepthError compare(const cv::Mat& measured, const cv::Mat& truth, const cv::Mat& lit) {
  std::vector<double> errors;
  int wanted = 0;
  for (int v = 0; v < truth.rows; ++v) {
    for (int u = 0; u < truth.cols; ++u) {
      if (lit.at<std::uint8_t>(v, u) == 0 || !std::isfinite(truth.at<float>(v, u))) continue;
      ++wanted;
      const float z = measured.at<float>(v, u);
      if (std::isfinite(z)) errors.push_back(std::abs(z - truth.at<float>(v, u)));
    }
  }
  if (errors.empty() || wanted == 0) return {};
  std::sort(errors.begin(), errors.end());
  const auto far = errors.end() - std::lower_bound(errors.begin(), errors.end(), 1.7);
  return {static_cast<double>(errors.size()) / wanted, errors[errors.size() / 2],
          static_cast<double>(far) / static_cast<double>(errors.size())};
}

struct Shipped {
  const char* scene;
  const char* rig;                  ///< of config/rigs
  const char* mode;                 ///< its pattern mode
  int burst;                        ///< one in which left and right differ
  double wrong;                     ///< allowed: mode T takes a slot one fringe deeper for its surroundings
  std::vector<std::string> form{};  ///< overrides: a short form of the scene

  [[nodiscard]] std::string name() const { return std::string(scene) + "_" + mode; }
};

std::vector<std::string> render_command(const std::string& scene, const std::vector<std::string>& overrides,
                                        const std::string& out) {
  std::vector<std::string> argv{program("enamel-twin"), "render",
                                std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/" + scene + ".toml", "--out", out};
  for (const std::string& o : overrides) argv.insert(argv.end(), {"--set", o});
  return argv;
}

/// One stop of a desktop mount; a jaw's mesh is coarse and only what lies under the head there.
std::vector<std::string> one_stop(const std::string& rot_deg, const std::string& swing_deg, bool of_jaw = false) {
  std::vector<std::string> out{"mount.rot_deg=[" + rot_deg + "]", "mount.swing_deg=[" + swing_deg + "]"};
  if (of_jaw) out.insert(out.end(), {"object.jaw.from_mm=30", "object.jaw.to_mm=60", "object.jaw.max_edge_mm=0.2"});
  return out;
}

/// One burst at that time of the way, on a coarse mesh of that part of the arch.
std::vector<std::string> one_burst(const std::string& from_s, const std::string& from_mm, const std::string& to_mm) {
  return {"path.from_s=" + from_s, "timing.bursts=1", "object.jaw.from_mm=" + from_mm, "object.jaw.to_mm=" + to_mm,
          "object.jaw.max_edge_mm=0.2"};
}

std::vector<std::string> one_burst_of_the_ridge() {
  return {"path.from_s=11.0", "timing.bursts=1", "object.ridge.from_mm=-22", "object.ridge.to_mm=26",
          "object.ridge.max_edge_mm=0.2"};
}

class Scenes : public ::testing::TestWithParam<Shipped> {};

TEST_P(Scenes, renders_and_decodes_to_its_truth) {
  const TempFolder tmp;
  std::vector<std::string> overrides = GetParam().form;
  overrides.push_back(std::string("rig=../rigs/") + GetParam().rig + ".json");
  std::vector<std::string> command = render_command(GetParam().scene, overrides, tmp / "folder");
  command.emplace_back("--truth-maps");
  const Ran rendered = run(command, std::chrono::seconds(300));
  ASSERT_EQ(rendered.code, 0) << rendered.err;
  const Ran decoded = run({program("enamel"), "decode", tmp / "folder", "--burst", std::to_string(GetParam().burst),
                           "--out", tmp / "maps"});
  ASSERT_EQ(decoded.code, 0) << decoded.err;
  EXPECT_NE(decoded.out.find(std::string("\"mode\": \"") + GetParam().mode + "\""), std::string::npos) << decoded.out;

  const cv::Mat measured = depth_map(tmp / "maps/depth.pfm");
  const std::string number = "00000" + std::to_string(GetParam().burst);
  const cv::Mat truth = depth_map(tmp / ("folder/truth/depth_" + number + ".pfm"));
  const cv::Mat lit = depth_map(tmp / ("folder/truth/lit_" + number + ".png"));
  ASSERT_EQ(measured.size(), truth.size());
  ASSERT_EQ(lit.size(), truth.size());
  const DepthError error = compare(measured, truth, lit);
  EXPECT_GT(error.coverage, 0.75);
  EXPECT_LT(error.median_mm, 0.02);
  EXPECT_LE(error.wrong, GetParam().wrong);

  cv::Mat flipped;
  cv::flip(measured, flipped, 1);  // negative control: the same depths in other places
  EXPECT_GT(compare(flipped, truth, lit).median_mm, 0.02);
}

INSTANTIATE_TEST_SUITE_P(
    Shipped, Scenes,
    ::testing::Values(Shipped{"plane", "probe_t", "T", 4, 0.015}, Shipped{"spheres", "probe_t", "T", 0, 0.015},
                      Shipped{"steps", "probe_t", "T", 0, 0.015}, Shipped{"plane", "probe", "M", 4, 0.0005},
                      Shipped{"spheres", "probe", "M", 0, 0.0005}, Shipped{"steps", "probe", "M", 0, 0.0005},
                      Shipped{"arch", "probe", "M", 0, 0.0005, one_burst("13.5", "-40", "-4")},
                      Shipped{"arch_upper", "probe", "M", 0, 0.0005, one_burst("15.8", "-26", "26")},
                      Shipped{"gaps", "probe", "M", 0, 0.0005, one_burst("17.0", "-30", "6")},
                      Shipped{"mouth_tissue", "probe", "M", 0, 0.0005, one_burst("4.0", "20", "54")},
                      Shipped{"mouth_fog", "probe", "M", 0, 0.002, one_burst("4.0", "20", "54")},
                      Shipped{"mouth_lamp", "probe", "M", 0, 0.0005, one_burst("4.0", "20", "54")},
                      Shipped{"desktop_bar", "probe", "M", 0, 0.0005, one_stop("180", "-15")},
                      Shipped{"desktop_arch", "probe", "M", 0, 0.0005, one_stop("5", "20", true)},
                      Shipped{"edentulous", "probe", "M", 0, 0.0005, one_burst_of_the_ridge()}),
    [](const auto& shipped) { return shipped.param.name(); });

TEST(ScenesWithPauses, what_a_pause_leaves_out_is_not_lost) {
  const TempFolder tmp;
  std::vector<std::string> form = one_burst("8.0", "10", "42");
  form[1] = "timing.bursts=8";  // five before the pause at 34 mm, three behind it
  ASSERT_EQ(run(render_command("gaps", form, tmp / "gaps.mcap"), std::chrono::seconds(300)).code, 0);
  const Ran replayed = run({program("enamel"), "replay", tmp / "gaps.mcap", "--out", tmp / "out", "--headless"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
  const auto report = nlohmann::json::parse(read_file(tmp / "out/report.json").value_or(""), nullptr, false);
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["bursts"]["captured"], 8);
  EXPECT_EQ(report["bursts"]["lost_on_wire"], 0);
  EXPECT_EQ(report["bursts"]["incomplete"], 0);
}

}  // namespace
}  // namespace enamel::test
