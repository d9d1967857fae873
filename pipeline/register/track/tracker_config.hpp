// What registration of a scan can be told. Lengths mm, angles degrees where the name says so.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/register/feature/surface_texture.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/icp/texture_term.hpp"
#include "pipeline/register/track/acceptance.hpp"
#include "pipeline/register/track/join_votes.hpp"
#include "pipeline/register/track/keyframes.hpp"
#include "pipeline/register/track/motion_model.hpp"
#include "pipeline/register/track/relocalise.hpp"

namespace enamel::pipeline {

struct TrackerConfig {
  IcpConfig icp;
  AcceptConfig accept;
  FeatureConfig features;
  KeyframeConfig keyframes;
  RelocaliseConfig relocalise;
  MotionConfig motion;
  JoinConfig join;
  SurfaceTextureConfig surface_texture;
  TextureConfig texture;
  double texture_spacing_mm = 1;     ///< chosen: texture is held against a burst that is no farther away than this …
  double texture_spacing_deg = 1.5;  ///< … nor turned by more: its picture looks the same
  double start_coverage = 0.05;      ///< share of the image's grid that must be good surface to begin a segment
  double max_gap_s = 0.5;       ///< of data time without a burst, or without a placed one: found again by features only
  double max_speed_mm_s = 200;  ///< of the point at the working distance: no hand is faster, an alignment may be
  double max_turn_deg_s = 360;
  double slack_mm = 0.5;  ///< added to what the speed limits allow
  double slack_deg = 3;
  /// In segments apart; the smallest are forgotten beyond it. Their bursts are still sought in the model at the end,
  /// but nothing is found in them any more. Chosen: 2.5 MB each; another arch has fewer, and where most bursts are shed
  /// each other one is a segment.
  std::size_t max_apart_keyframes = 128;
  std::array<double, 2> wrist_deg{12, 24};  ///< turns tried about the place looked at where no other start converges
};

}  // namespace enamel::pipeline
