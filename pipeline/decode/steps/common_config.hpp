// What every pattern mode's decoder is told.
#pragma once

#include <optional>

#include "calib/model/rig.hpp"
#include "pipeline/decode/motion/rigid_motion.hpp"
#include "pipeline/decode/phase/light_change.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/phase/waveform_fit.hpp"
#include "pipeline/decode/steps/decode_gates.hpp"
#include "pipeline/decode/steps/translucency.hpp"
#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/unwrap/links.hpp"
#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

struct CommonConfig {
  PhaseConfig phase;
  WaveFitConfig wave;
  LinkConfig links;
  OrderConfig order;
  RigidMotionConfig rigid;
  NormalConfig normals;
  LightChangeConfig light_change;
  /// Undo what the burst itself shows of motion and of the projector's second harmonic; in mode M motion, seen by the
  /// code frame, which then joins the phase.
  bool correct_closure = true;
  /// Undo the ripple that the projector's harmonics leave, self-calibrated per burst: sin 4phi, in mode M sin 3phi.
  bool correct_ripple = true;
  TranslucencyConfig translucency;
  /// Used when the rig states none. A depth range is never assumed.
  std::optional<calib::DepthRange> depth_range_mm;

  LightGate light;
  FramesGate frames;
  WaveGate wave_shape;
  LinkGate linked;
  CodeGate code;
  OddFrameGate odd_frame;
  MotionGate motion;
};

}  // namespace enamel::pipeline
