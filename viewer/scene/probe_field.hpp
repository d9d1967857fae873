// The volume that the probe sees, as the viewer draws it. Camera frame: x right, y down, z forward, mm.
#pragma once

#include <array>

#include "pipeline/types/geometry.hpp"
#include "viewer/scene/ball.hpp"

namespace enamel::view {

struct ProbeField {
  /// Rays through the image corners (top left, top right, bottom right, bottom left), scaled to z = 1.
  std::array<Vec3f, 4> corner_rays{Vec3f{-0.18F, -0.14F, 1}, Vec3f{0.18F, -0.14F, 1}, Vec3f{0.18F, 0.14F, 1},
                                   Vec3f{-0.18F, 0.14F, 1}};
  double near_mm = 40;  ///< depth range of the rig
  double far_mm = 56;
  double optimum_near_mm = 45;  ///< best working distance
  double optimum_far_mm = 51;
};

/// Lens distortion moves the field's corners by less than a line's width here.
struct Pinhole {
  int width_px = 0, height_px = 0;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};

/// Field of the camera over the rig's depth range; the optimum keeps the default rig's shares of that range. Values out
/// of range (sizes or focal lengths <= 0, far <= near) give the default field.
[[nodiscard]] ProbeField probe_field(const Pinhole& camera, double near_mm, double far_mm);

struct FrustumGeometry {
  std::array<Vec3f, 9> points;  ///< 0: apex, 1–4: near corners, 5–8: far corners
  static constexpr std::array<std::array<int, 2>, 12> kEdges{
      {{1, 2}, {2, 3}, {3, 4}, {4, 1}, {5, 6}, {6, 7}, {7, 8}, {8, 5}, {1, 5}, {2, 6}, {3, 7}, {4, 8}}};
  static constexpr std::array<std::array<int, 2>, 4> kApexEdges{{{0, 1}, {0, 2}, {0, 3}, {0, 4}}};
  static constexpr std::array<std::array<int, 4>, 4> kSides{{{1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}}};
};

/// Corners of the field in the destination frame of T_dst_cam.
[[nodiscard]] FrustumGeometry frustum(const ProbeField& field, const Pose& T_dst_cam);

/// About the optimum's depths, where the surface is.
[[nodiscard]] Ball field_ball(const ProbeField& field, const Pose& T_dst_cam);

}  // namespace enamel::view
