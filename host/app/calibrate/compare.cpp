// enamel calibrate compare: what the difference of two rigs does to geometry, and how the lines of two mounts differ.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/judge/volume.hpp"
#include "calib/model/mount.hpp"
#include "host/app/calibrate/mount_report.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct DriftOptions {
  std::string rig, other;
};

/// Two mounts; both files were read before.
Result<int> compare_mounts(const DriftOptions& o) {
  ENAMEL_TRY_ASSIGN(const calib::Mount mount, calib::load_mount(o.rig));
  ENAMEL_TRY_ASSIGN(const calib::Mount other, calib::load_mount(o.other));
  std::puts(json_text(mount_difference_json(mount, other), 1).c_str());
  return 0;
}

Result<int> run_compare(const DriftOptions& o) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(o.rig));
  if (calib::is_mount_text(text)) return compare_mounts(o);
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, load_intact(o.rig));
  ENAMEL_TRY_ASSIGN(const calib::Rig other, load_intact(o.other));
  const auto d = calib::compare_rigs(calib::state_of(rig), calib::state_of(other), range_of(other));
  Json json{{"p95_um", d.p95_um}, {"rms_um", d.rms_um}, {"max_um", d.max_um}, {"scale_ppm", d.scale_ppm}};
  for (std::size_t k = 0; k < d.planes.size(); ++k) {
    json["depth_mm"].push_back(d.depth_mm[k]);
    json["sag_um"].push_back(d.planes[k].sag_um());
    json["twist_um"].push_back(d.planes[k].twist_um);
  }
  std::puts(json_text(json, 1).c_str());
  return 0;
}

}  // namespace

CalibrateCommand add_calibrate_compare(CLI::App& app) {
  auto o = std::make_shared<DriftOptions>();
  CLI::App* compare = app.add_subcommand(
      "compare", "what the difference of two rigs does to geometry; of two mounts, their lines (JSON)");
  compare->add_option("RIG", o->rig, "rig.json or mount.json")->required();
  compare->add_option("REFERENCE", o->other, "of the same kind")->required();
  return {compare, [o] { return run_compare(*o); }};
}

}  // namespace enamel::app
