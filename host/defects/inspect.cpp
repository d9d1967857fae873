#include "host/defects/inspect.hpp"

#include "host/defects/detect.hpp"

namespace enamel::host {

std::vector<Defect> inspect(const InspectInput& input, const InspectConfig& config) {
  std::vector<Defect> out;
  if (input.mesh.triangles.empty() || input.mesh.normals.size() != input.mesh.vertices.size()) return out;
  defects::Surface surface{input.mesh, cells_of(input.mesh), border_loops(input.mesh), {}};
  surface.from_rim_mm = distance_to_rim(surface.cells, surface.loops);
  const bool has_survey = input.survey != nullptr && input.survey->facts.size() == surface.cells.size();
  defects::find_holes(surface, config, out);
  if (has_survey) {
    const defects::Seen seen{surface, *input.survey};
    defects::find_stitching(seen, config, out);
    defects::find_tissue(seen, config, out);
    defects::find_unreliable(seen, config, out);
    defects::find_humidity(seen, config, out);
  }
  if (input.marks != nullptr)
    for (const ScanBodyMark& mark : input.marks->scan_bodies) defects::check_scan_body(surface, mark, config, out);
  defects::find_bridges(surface, config, out);
  if (input.marks != nullptr)
    for (const PreparationMark& mark : input.marks->preparations)
      defects::check_finish_line(surface, mark, config, out);
  defects::find_noise(surface, config, out);
  return out;
}

}  // namespace enamel::host
