#include "tools/twin/scene/fault_keys.hpp"

namespace enamel::twin {

void bind_fault(ConfigReader& reader, SceneConfig& config) {
  ConfigReader r = reader.table("fault");
  FaultConfig& f = config.jaw.fault;
  r.bind("tooth", f.tooth, {1, 7}, "of the right quadrant, that it befalls");
  r.bind("spot_mm", f.spot_mm, {0, 10}, "radius of a spot on its biting side that returns no light");
  r.bind("gap_mm", f.gap_mm, {0, 10}, "the teeth behind it stand farther off by so much");
  r.bind("web_um", f.web_um, {0, 2000}, "thickness of a web of saliva across that gap; 0: none");
  r.bind("move_um", f.move_um, {0, 2000}, "the tooth goes towards the cheek by so much ...");
  r.bind("move_at_s", f.move_at_s, {0, 1000}, "... at that time of the scan");
  r.bind("prepared", f.is_prepared, "ground for a crown, with a shoulder all round");
  r.bind("finish_edge_mm", f.finish_edge_mm, {0, 3}, "its finish line is rounded over so wide a strip");
  r.bind("scan_body", f.is_scan_body, "an implant's scan body stands in its stead");
  r.bind("body_error_um", f.body_error_um, {-1000, 1000}, "the scan body is so much thicker, in radius");
  const bool any = f.spot_mm > 0 || f.gap_mm > 0 || f.web_um > 0 || f.move_um > 0 || f.is_prepared || f.is_scan_body;
  if (any && config.object != ObjectKind::kJaw) reader.reject("fault", "goes with object.type = jaw");
  if (f.move_um > 0 && !config.bar.arc_mm.empty()) reader.reject("fault.move_um", "goes without an artefact");
  if (f.is_prepared && f.is_scan_body) reader.reject("fault.prepared", "a scan body has no finish line");
}

}  // namespace enamel::twin
