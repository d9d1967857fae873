// What fusion can be told. Lengths mm, angles degrees where the name says so.
#pragma once

#include <cstdint>

#include "pipeline/types/shade.hpp"

namespace enamel::pipeline {

struct FuseConfig {
  double voxel_mm = 0.1;
  double truncation_voxels = 3.0;    ///< half width of the band around the surface that is stored
  double max_incidence_deg = 70.0;   ///< steeper measurements are not fused: a projective distance is biased there
  double reference_sigma_mm = 0.01;  ///< a facing pixel of this sigma weighs 1
  double burst_weight_max = 4.0;     ///< cap of what one burst adds to a voxel
  double voxel_weight_max = 255.0;   ///< cap of the sum: later bursts keep a say
  int min_observations = 3;          ///< pixel measurements that a voxel needs to count as surface in the mesh
  int min_bursts = 2;  ///< different bursts that they must come from: one burst's outliers never reach the mesh
  double carve_margin_mm = 0.6;  ///< an unconfirmed block seen through with this margin loses its voxels
  int carve_bursts =
      3;  ///< bursts that looked through confirmed surface, for each moment it was seen in: it goes. 0: never
  double carve_confirmed_mm = 0.5;  ///< … with this margin
  double view_pitch_mm = 0.084;     ///< between pixels of ModelView; chosen: 56 um cost 2.3 times as much and place
                                    ///< bursts no better, 112 um place them 10 to 30 % worse
  double view_kept_mm = 1.0;        ///< a view is drawn anew once the camera has moved by this at what it looks at …
  double view_kept_deg = 3.0;       ///< … or turned by this, …
  int view_kept_bursts = 3;         ///< … and after so many bursts
  double view_search_mm = 1.2;      ///< how far around a guessed depth a view pixel without own measurement is searched
  std::uint8_t soft_below = kNothingSoft;  ///< shades below it are soft tissue's
};

/// What one burst did to the model.
struct FuseStats {
  std::uint64_t surfels_used = 0;   ///< sampled pixels (every second one at full size) that were fused
  std::uint64_t surfels_steep = 0;  ///< rejected: incidence beyond max_incidence_deg
  std::uint64_t voxels_updated = 0;
  std::uint32_t blocks_touched = 0;
  std::uint32_t blocks_new = 0;
  std::uint32_t blocks_carved = 0;  ///< blocks emptied because this burst saw through them
};

}  // namespace enamel::pipeline
