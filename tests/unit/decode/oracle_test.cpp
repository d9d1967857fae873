// The decoder against bursts of an independent renderer, judged by an independent scorer. Skipped where these are
// absent.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/decode/decode_maps.hpp"
#include "protocol/base/file.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/decode/folder_burst.hpp"

namespace enamel::pipeline {
namespace {

const std::string kShared = test::shared_folder();
const std::string kScorer = kShared + "/score/score.py";

using Figures = std::map<std::string, double>;

/// Figures of a depth map as score.py prints them ("name value" a line); empty when it cannot run.
Figures score(const std::string& folder, int burst, const Map<float>& depth) {
  const std::string path = testing::TempDir() + "enamel_oracle_depth.pfm";
  if (!write_file(path, pfm_bytes(depth))) return {};
  const std::string command =
      "/usr/bin/python3 " + kScorer + " depth " + folder + " " + std::to_string(burst) + " " + path;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  Figures out;
  char name[64];
  char value[64];
  while (pipe && std::fscanf(pipe.get(), "%63s %63s", name, value) == 2) out[name] = std::strtod(value, nullptr);
  return out;
}

class Oracle : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kScorer)) GTEST_SKIP() << kScorer << " is absent";
    if (std::system("/usr/bin/python3 -c 'import numpy, scipy, cv2' 2>/dev/null") != 0)
      GTEST_SKIP() << "/usr/bin/python3 lacks numpy, scipy or cv2";
  }

  /// All bursts come from one rig, which is baked once.
  static const BurstDecoder& decoder() {
    static const BurstDecoder kDecoder =
        BurstDecoder::make(calib::load_rig(kShared + "/data/oracle/plane-01/rig.json").value()).value();
    return kDecoder;
  }

  static Figures run(const std::string& set, int burst) {
    const std::string folder = kShared + "/data/oracle/" + set;
    const auto frames = test::load_folder_burst(folder, burst);
    if (!frames) return {};
    decoder().decode(frames->view(), workspace(), decoded());
    EXPECT_TRUE(decoded().accepted()) << set << " " << burst << " " << name_of(decoded().verdict);
    return score(folder, burst, decoded().patch.depth_mm);
  }

  static DecodeWorkspace& workspace() {
    static DecodeWorkspace workspace;
    return workspace;
  }
  static DecodedBurst& decoded() {
    static DecodedBurst burst;
    return burst;
  }
};

TEST_F(Oracle, planes_are_flat_whole_and_of_the_right_order) {
  for (int b = 0; b < 6; ++b) {
    Figures f = run("plane-01", b);
    ASSERT_TRUE(f.contains("plane_rms_5x5_um")) << b;
    EXPECT_LE(f["plane_rms_5x5_um"], 7) << b;
    EXPECT_EQ(f["wrong_order_pct"], 0) << b;
    EXPECT_EQ(f["order_map_mismatch_px"], 0) << b;
    EXPECT_GE(f["coverage_pct"], 99) << b;
  }
}

TEST_F(Oracle, static_spheres_have_their_diameter_and_distance) {
  for (int b = 0; b < 2; ++b) {
    Figures f = run("spheres-01", b);
    ASSERT_TRUE(f.contains("centre_distance_error_um")) << b;
    EXPECT_LE(std::abs(f["sphere1_diameter_error_um"]), 8) << b;
    EXPECT_LE(std::abs(f["sphere2_diameter_error_um"]), 8) << b;
    EXPECT_LE(std::abs(f["centre_distance_error_um"]), 5) << b;
  }
}

TEST_F(Oracle, steps_and_slots_are_placed_or_rejected_not_guessed) {
  for (int b = 0; b < 3; ++b) {
    Figures f = run("steps-01", b);
    ASSERT_TRUE(f.contains("coverage_pct")) << b;
    EXPECT_LE(f["wrong_order_pct"], 1.5) << b;
    EXPECT_GE(f["coverage_pct"], 75) << b;
  }
}

TEST_F(Oracle, molars_under_a_moving_hand_keep_their_orders) {
  for (int b = 0; b < 30; b += 5) {
    Figures f = run("sweep-01", b);
    ASSERT_TRUE(f.contains("coverage_pct")) << b;
    EXPECT_LE(f["wrong_order_pct"], 0.5) << b;
    EXPECT_EQ(f["off_object_px"], 0) << b;
  }
}

TEST_F(Oracle, gate_fails_for_a_map_that_is_one_fringe_off) {
  ASSERT_FALSE(run("plane-01", 0).empty());
  Map<float> off = decoded().patch.depth_mm;
  for (int v = 0; v < off.height(); ++v)
    for (int u = 0; u < 320; ++u) off(u, v) -= 3.5F;
  const Figures f = score(kShared + "/data/oracle/plane-01", 0, off);
  EXPECT_GT(f.at("wrong_order_pct"), 40);
}

TEST_F(Oracle, every_permutation_of_real_frames_is_detected) {
  const auto frames = test::load_folder_burst(kShared + "/data/oracle/sweep-01", 5);
  ASSERT_TRUE(frames);
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  while (std::next_permutation(order.begin(), order.end())) {
    BurstView view = frames->view();
    for (std::size_t k = 0; k < 4; ++k) view.frames[k] = frames->frames[order[k]];
    decoder().decode(view, workspace(), decoded());
    EXPECT_EQ(decoded().verdict, BurstVerdict::kPatternMismatch) << order[0] << order[1] << order[2] << order[3];
  }
}

/// Frame `bad` of burst 0 replaced, by another frame of the burst or by its own from the burst after.
class OracleFrames : public Oracle, public testing::WithParamInterface<const char*> {};

TEST_P(OracleFrames, repeated_or_left_over_are_told_from_a_burst) {
  const std::string folder = kShared + "/data/oracle/" + GetParam();
  const auto frames = test::load_folder_burst(folder, 0), other = test::load_folder_burst(folder, 1);
  ASSERT_TRUE(frames && other);
  decoder().decode(frames->view(), workspace(), decoded());
  ASSERT_EQ(decoded().verdict, BurstVerdict::kAccepted);  // the control
  for (std::size_t bad = 0; bad < 4; ++bad) {
    for (std::size_t from = 0; from <= 4; ++from) {
      if (from == bad) continue;
      BurstView view = frames->view();
      view.frames[bad] = from < 4 ? frames->frames[from] : other->frames[bad];
      decoder().decode(view, workspace(), decoded());
      const DecodeDiagnostics& d = decoded().diagnostics;
      EXPECT_EQ(decoded().verdict, BurstVerdict::kPatternMismatch)
          << "frame " << bad << (from < 4 ? " by " + std::to_string(from) : " left over") << ": "
          << name_of(decoded().verdict) << " repeated " << d.repeated_share << " odd " << d.odd_shift_rad << " unrest "
          << d.unrest;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Sets, OracleFrames, testing::Values("plane-01", "spheres-01", "steps-01", "sweep-01"));

}  // namespace
}  // namespace enamel::pipeline
