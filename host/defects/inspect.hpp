// Looks for defects of a finished scan. Entry of host/defects. mm, model frame. Pure, thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/defects/defect.hpp"
#include "host/defects/survey.hpp"
#include "pipeline/types/mesh.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// A scan body as its maker states it: a cylinder with a flat.
struct ScanBodyForm {
  double radius_mm = 0;
  double height_mm = 0;  ///< of what stands out of the gum
  double flat_mm = 0;    ///< of its flat from the axis; 0: none
};

/// Places that a person marks: what stands there cannot be told from the surface alone.
struct ScanBodyMark {
  Vec3d p_top_mm = Vec3d::Zero();  ///< about the middle of its top
  ScanBodyForm form = {};
};
struct PreparationMark {
  Vec3d p_top_mm = Vec3d::Zero();  ///< about the middle of the stump's top
  double reach_mm = 8;             ///< its finish line lies nearer to the axis
};
struct Marks {
  std::vector<ScanBodyMark> scan_bodies;
  std::vector<PreparationMark> preparations;
};

/// {"scan_bodies": [{"p_top_mm": [x, y, z], "radius_mm": 2.2, "height_mm": 8, "flat_mm": 1.5}], "preparations":
/// [{"p_top_mm": [x, y, z], "reach_mm": 8}]}. Errors: kFileNotFound, kFileRead, kConfigSyntax, kConfigValue with the
/// key.
[[nodiscard]] Result<Marks> load_marks(const std::string& path);

/// What is told. All chosen: on scans of the twin, see docs/defects.md.
struct InspectConfig {
  double hole_mm2 = 0.8;          ///< least area of a hole …
  double hole_roundness = 0.4;    ///< … and 4 pi area / length^2: undercuts and contacts leave ragged slits …
  double hole_width_mm = 3.0;     ///< … unless it is so wide: 4 area / length
  double drift_um = 80;           ///< stitching: early and late bursts disagree by more than this …
  double drift_sigmas = 3;        ///< … and this times what their scatter explains …
  double drift_mm2 = 2.0;         ///< … over such an area
  double passed_mm2 = 4.0;        ///< tissue: a burst with so much of it …
  int passed_bursts = 2;          ///< … such bursts at one place
  int few_views = 3;              ///< reliability: seen by no more bursts …
  double few_views_mm2 = 6.0;     ///< … over such an area …
  double from_rim_mm = 2.0;       ///< … so far from the edge of the scan, where every surface is seen by few
  double few_views_share = 0.55;  ///< … or such a share of the whole surface, its edge included
  int glare_bursts = 3;           ///< humidity: glare in so many bursts at one place
  double place_mm = 5.0;          ///< what lies nearer together is one place of tissue or glare
  double thin_mm = 0.6;           ///< bridge: two sides no farther apart …
  double thin_mm2 = 1.0;          ///< … over such an area of one side
  double rough_um = 10;           ///< noise: rms about a smooth surface, of the smoothest quarter of a place …
  double rough_mm2 = 8.0;         ///< … over such an area
  double rough_half_um = 4.5;     ///< … or beyond this where half of the whole surface is
  double edge_radius_um = 200;    ///< finish line: radius of its edge
  double body_error_um = 50;      ///< scan body: of its radius …
  double body_form_um = 30;       ///< … rms of its form …
  double body_missing = 0.75;     ///< … or this share of its side not seen
};

struct InspectInput {
  const Mesh& mesh;
  const SurveyResult* survey = nullptr;  ///< null: shape alone, so holes, bridges, noise and what is marked
  const Marks* marks = nullptr;
};

/// By class, each class largest first. An empty mesh, or one without normals, has none.
[[nodiscard]] std::vector<Defect> inspect(const InspectInput& input, const InspectConfig& config = {});

}  // namespace enamel::host
