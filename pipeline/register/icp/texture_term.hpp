// Where shape slides, texture holds: the photometric term beside point-to-plane ICP. Along motions that leave the
// surface on itself (a plane, a ridge) the grey of a place must stay the grey of that place.
// As the intensity term of RGB-D registration (Steinbruecker, Sturm & Cremers 2011), on brightness beside the
// surroundings, so that a projector that moves with the camera changes nothing.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/texture_picture.hpp"

namespace enamel::pipeline {

struct TextureConfig {
  double min_gradient = 0.1;     ///< brightness beside the surroundings a mm; derived: five times what shot noise of
                                 ///< 0.5 % leaves in a difference over two block means, smoothed
  std::size_t min_points = 200;  ///< chosen: fewer are a scratch or a bubble
  double min_correlation = 0.6;  ///< chosen: of the greys of both bursts, once aligned; noise has 0
  double slip_mm = 0.08;      ///< derived: a block. Slid by so much along a direction that texture holds, the greys …
  double min_rise = 0.4;      ///< … must disagree by this share of what their gradients foretell: noise does not
  int rounds = 4;             ///< of Gauss-Newton, on each of two levels
  double max_step_mm = 0.15;  ///< derived: half a blurred block; a step beyond leaves what its gradient foretells
  double max_move_mm = 1.5;   ///< chosen: what a hand of 15 mm/s that starts between two of 15 bursts a second is off
                              ///< prediction by, and half as much again
  double search_mm = 1.2;  ///< where greys do not agree near prediction: so far along what slides they are sought, …
  double search_step_mm = 0.2;   ///< … derived: half of what a fit of the blurred greys finds back from
  std::size_t search_tries = 3;  ///< … and fitted from so many places
  double min_along = 0.6;  ///< correlation of what both greys do along a direction that is held; derived: chance has a
                           ///< standard deviation of 0.2 with `min_points` of which `patch_px` err alike
  double sigma_floor = 0.004;  ///< of brightness; chosen: what fine shading leaves where noise leaves less
  double patch_px = 9;         ///< picture pixels that err alike: residuals of shading hang together over a quarter mm
  double bias_mm = 0.01;       ///< chosen: what a tie by texture is off by however many points it has
  double max_sigma_mm = 0.03;  ///< beyond, texture does not hold the direction either
};

/// Points of a burst whose texture says where they are, camera frame, mm, with their brightness on both levels.
struct TexturePoints {
  std::vector<Vec3f> p;
  std::vector<std::array<float, 2>> brightness;  ///< blurred, fine
  std::vector<Vec3f> gradient;                   ///< of the fine one along the surface, a mm
};

/// What a burst's texture is held against. Immutable.
struct TextureReference {
  Pose T_model_cam = Pose::Identity();
  int step = 1;
  std::array<Map<float>, 2> brightness;  ///< blurred, fine; NaN where unknown
  bool of_surface = false;  ///< it was seen to move with the surface and not with the probe: rest may be believed
};
[[nodiscard]] TextureReference texture_reference(const TexturePicture& picture, const Pose& T_model_cam);

/// own: of the patch itself. Pure.
[[nodiscard]] TexturePoints texture_points(const SurfacePatch& patch, const TextureReference& own,
                                           const TextureConfig& config);

/// Directions of small motions (columns, orthonormal) along which a surface slides on itself.
using WeakDirections = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
[[nodiscard]] WeakDirections weak_directions(const NormalSystem& system, double weak_eigenvalue);

struct TextureHold {
  Vector6 x = Vector6::Zero();  ///< motion about the centre that texture asks for, along weak directions only
  Matrix6 H = Matrix6::Zero();  ///< information of the directions that it holds, mm^-2, bias included
  int held = 0;                 ///< how many of them
  double correlation = 0;
  bool moved = false;  ///< a pattern that stands still in the picture does not explain the greys as well
};

struct TextureAlignment {
  const TexturePoints& points;
  const TextureReference& reference;
  const calib::LensValues& lens;
  Vec3d centre;   ///< of motions, in the reference's model frame
  double rho_mm;  ///< as IcpConfig::rho_mm
};

/// Moves along `weak` until the greys agree best. nullopt: too little texture, what there is does not agree, or it may
/// be the probe's (light, fringes, dust) and not the surface's: it stands still in the picture. Pure.
[[nodiscard]] std::optional<TextureHold> hold_by_texture(const TextureAlignment& of, const Pose& T_model_cam,
                                                         const WeakDirections& weak, const TextureConfig& config);

}  // namespace enamel::pipeline
