// The files of a run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "host/app/artefact_report.hpp"
#include "host/app/bow_report.hpp"
#include "host/app/run_options.hpp"
#include "host/compare/compare.hpp"
#include "host/compare/deviation_picture.hpp"
#include "host/defects/defect_picture.hpp"
#include "host/defects/inspect.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "host/mesh_files/poses_csv.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::app {

namespace {

constexpr double kUnknown_um = 500;  // chosen: beyond, a number would say more than is known

std::vector<host::PoseRow> pose_rows(const std::vector<host::PlacedPose>& poses) {
  std::vector<host::PoseRow> rows;
  rows.reserve(poses.size());
  for (const host::PlacedPose& p : poses) rows.push_back({p.id.value, to_ns(p.t_mid), p.T_model_cam});
  return rows;
}

// Accuracy against the twin's truth, laid on it by the first pose alone: drift is not hidden by a best fit.
Result<std::string> accuracy(const Mesh& mesh, const std::vector<host::PoseRow>& estimate, const Truth& truth,
                             const std::string& folder) {
  ENAMEL_TRY_ASSIGN(const auto truth_poses, host::parse_poses_csv(truth.poses_csv));
  std::vector<host::MeshFile> references(1);
  ENAMEL_TRY_ASSIGN(references[0], host::parse_mesh(truth.surface_ply, host::MeshFormat::kPly));
  const host::CompareInput input{host::Alignment::kStart, &estimate, &truth_poses};
  ENAMEL_TRY_ASSIGN(const auto result, host::compare(mesh, references, input));
  const auto png = host::deviation_png(mesh, result);
  ENAMEL_TRY(write_file(folder + "/deviation.png", {reinterpret_cast<const char*>(png.data()), png.size()}));
  return host::compare_json(result);
}

std::string segment_folder(SegmentId id) { return fmt::format("segments/{:02}", id); }

// What is apart lies beside the model in files of the same kind. Returns the meshes, for the hash.
Result<std::string> write_apart(const std::string& folder, const std::vector<host::ApartSegment>& apart) {
  std::error_code ec;
  std::string meshes;
  for (const host::ApartSegment& segment : apart) {
    const std::string into = folder + "/" + segment_folder(segment.id);
    std::filesystem::create_directories(into, ec);
    if (ec) return fail(ErrorCode::kFileWrite, into + ": " + ec.message());
    const std::string ply = host::ply_bytes(segment.mesh);
    ENAMEL_TRY(write_file(into + "/mesh.ply", ply));
    ENAMEL_TRY(host::write_poses_csv(into + "/poses.csv", pose_rows(segment.poses)));
    meshes += ply;
  }
  return meshes;
}

std::vector<host::SegmentFacts> segment_facts(const std::vector<host::SegmentRow>& rows) {
  std::vector<host::SegmentFacts> out;
  for (const host::SegmentRow& row : rows) {
    if (row.id == kModelSegment) continue;
    host::SegmentFacts facts{row.id, row.bursts, row.first.value, row.last.value, {}, {}, {}};
    if (row.into) facts.into = *row.into;
    if (row.joined_at) facts.joined_at = row.joined_at->value;
    if (!row.into) facts.folder = segment_folder(row.id);
    out.push_back(std::move(facts));
  }
  return out;
}

std::string clock_note(const std::vector<BurstId>& at) {
  return fmt::format(
      "the probe's clock went back {} time(s), first at burst {}: placed by what is seen, none is missing", at.size(),
      at.front().value);
}

std::string repeated_note(const std::vector<BurstId>& at) {
  return fmt::format("{} burst(s) came twice, first burst {}: measured and fused again where they lie", at.size(),
                     at.front().value);
}

nlohmann::json stations_json(const pipeline::Stations& of, const std::vector<host::PlacedPose>& poses) {
  nlohmann::json out{{"way_mm", of.way_mm}, {"at", nlohmann::json::array()}, {"distances", nlohmann::json::array()}};
  for (const pipeline::Station& s : of.stations) {
    out["at"].push_back({{"share", s.share},
                         {"burst", poses[s.burst].id.value},
                         {"p_model_mm", {s.p_model.x(), s.p_model.y(), s.p_model.z()}}});
  }
  for (const pipeline::StationDistance& d : of.distances)
    out["distances"].push_back({{"a", d.a}, {"b", d.b}, {"mm", d.distance_mm}, {"sigma_um", 1e3 * d.sigma_mm}});
  return out;
}

std::string map_json(const host::ScanResult& scan) {
  const host::MapFacts& facts = *scan.map;
  const pipeline::RefinedMap& m = facts.map;
  nlohmann::json out{{"keyframes", m.keyframes},
                     {"edges", m.edges},
                     {"measured_live", m.at_hand},
                     {"loops", m.loops},
                     {"switched_off", m.switched_off},
                     {"sigma0", m.sigma0},
                     {"largest_move_um", 1e3 * m.largest_move_mm},
                     {"stations", stations_json(m.stations, scan.poses)},
                     {"seen_through_px", facts.seen_through_px},
                     {"refine_s", facts.refine_s},
                     {"seconds", facts.seconds}};
  if (m.bow) out["bow"] = bow_json(*m.bow);
  if (m.artefact) out["artefact"] = artefact_json(*m.artefact);
  return json_text(out);
}

/// Of the mesh's area: triangles most of whose corners are soft tissue's.
double soft_share(const Mesh& mesh) {
  if (mesh.soft.empty()) return 0;
  double soft = 0, all = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.vertices[t[1]] - mesh.vertices[t[0]], b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const auto area = static_cast<double>(a.cross(b).norm());
    all += area;
    soft += mesh.soft[t[0]] + mesh.soft[t[1]] + mesh.soft[t[2]] >= 2 ? area : 0;
  }
  return all > 0 ? soft / all : 0;
}

/// What moved by itself and was left out of the final model, and what of the model is soft.
std::string tissue_json(const host::MapFacts& facts, const host::ScanResult& scan) {
  const auto measured = static_cast<double>(std::max<std::uint64_t>(facts.measured_px, 1));
  const nlohmann::json out{{"foreign_removed_px", facts.seen_through_px},
                           {"foreign_share", static_cast<double>(facts.seen_through_px) / measured},
                           {"soft_share", soft_share(scan.mesh)},
                           {"shades",
                            {{"told_apart", scan.shades.soft_below != kNothingSoft},
                             {"octaves_between", (scan.shades.hard_middle - scan.shades.soft_middle) / kShadeSteps},
                             {"parted", scan.shades.parted}}}};
  return json_text(out);
}

/// What to look at again, into the report and as a picture.
Result<void> inspect(const host::ScanResult& scan, const std::string& folder, host::Report& report) {
  const auto defects = host::inspect({scan.mesh, scan.survey ? &*scan.survey : nullptr});
  report.defects_json = host::defects_json(defects);
  report.defects_line = host::defects_summary(defects);
  if (defects.empty()) return {};
  const auto png = host::defects_png(scan.mesh, defects);
  return write_file(folder + "/defects.png", {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace

std::string known_line(const host::ScanResult& scan) {
  if (!scan.desktop_line.empty()) return scan.desktop_line;
  if (!scan.map || scan.map->map.stations.distances.empty()) return "";
  const pipeline::StationDistance& farthest =
      *std::ranges::max_element(scan.map->map.stations.distances, {}, &pipeline::StationDistance::distance_mm);
  const double sigma_um = 1e3 * farthest.sigma_mm;
  if (sigma_um > kUnknown_um) return fmt::format("{:.1f} mm from end to end is not determined", farthest.distance_mm);
  return fmt::format("{:.1f} mm from end to end, known to +-{:.0f} um", farthest.distance_mm, sigma_um);
}

Result<host::Report> write_outputs(const std::string& folder, const host::ScanResult& scan, host::Report report,
                                   const Truth& truth) {
  const auto poses = pose_rows(scan.poses);
  const std::string ply = host::ply_bytes(scan.mesh);
  ENAMEL_TRY_ASSIGN(const std::string apart, write_apart(folder, scan.apart));
  report.hash = scan.trace.hash(RollingHash().update(ply).update(apart).hex());
  report.segments = segment_facts(scan.segments);
  for (const BurstId id : scan.undetermined) report.undetermined.push_back(id.value);
  if (!scan.repeated.empty()) report.notes["repeated"] = repeated_note(scan.repeated);
  if (!scan.clock_went_back.empty()) report.notes["clock"] = clock_note(scan.clock_went_back);
  if (scan.map) report.map_json = map_json(scan);
  if (scan.map) report.tissue_json = tissue_json(*scan.map, scan);
  report.desktop_json = scan.desktop_json;
  report.known_line = known_line(scan);
  report.stage_ms = scan.stage_ms;
  report.latency_ms = scan.latency_ms;
  report.pixel_ms = scan.pixel_ms;
  report.link_ms = scan.link_ms;
  report.pipeline_json = scan.graph_json;
  report.bottleneck = scan.figures.bottleneck;
  report.rate_hz = scan.seconds > 0 ? static_cast<double>(report.bursts.accepted) / scan.seconds : 0;
  report.mesh_vertices = scan.mesh.vertices.size();
  report.mesh_triangles = scan.mesh.triangles.size();
  ENAMEL_TRY(write_file(folder + "/mesh.ply", ply));
  ENAMEL_TRY(write_file(folder + "/mesh.stl", host::stl_bytes(scan.mesh)));
  ENAMEL_TRY(host::write_poses_csv(folder + "/poses.csv", poses));
  ENAMEL_TRY(write_file(folder + "/stages.csv", scan.trace.to_csv()));
  ENAMEL_TRY(inspect(scan, folder, report));
  if (truth.known() && !scan.mesh.triangles.empty()) {
    log::info("outputs", "comparing with the truth");
    auto compared = accuracy(scan.mesh, poses, truth, folder);
    if (compared) {
      report.accuracy_json = std::move(*compared);
    } else {
      report.notes["accuracy"] = "none: " + compared.error().detail;
    }
  }
  ENAMEL_TRY(host::write_report(report, folder + "/report.json"));
  return report;
}

}  // namespace enamel::app
