// enamel desktop scan: a model on the table, stop by stop.
#include <memory>
#include <string>
#include <vector>

#include "host/app/desktop/case_folder.hpp"
#include "host/app/desktop/desktop_scan.hpp"
#include "host/app/desktop/subcommand.hpp"
#include "host/app/link_options.hpp"
#include "host/app/out_folder.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {

namespace {

struct PartOptions {
  std::string name;
  bool again = false;
};

/// Told before anything moves: sizes by another table or head are others.
Result<void> compare_mounts(const std::vector<host::PartFacts>& parts, const std::string& mount_path) {
  ENAMEL_TRY_ASSIGN(const MountFile file, mount_for(mount_path, nullptr));
  for (const host::PartFacts& part : parts)
    if (!part.mount_serial.empty() && part.mount_serial != file.mount.serial)
      log::warn("case", "part {} was scanned on mount {}, and this is {}", part.name, part.mount_serial,
                file.mount.serial);
  return {};
}

Result<int> scan_part(DesktopScan scan, const PartOptions& part) {
  const std::string case_folder = scan.scan.run.out;
  ENAMEL_TRY(make_folder(case_folder));
  ENAMEL_TRY_ASSIGN(const auto parts, read_case(case_folder));
  ENAMEL_TRY(compare_mounts(parts, scan.desktop.mount));
  ENAMEL_TRY_ASSIGN(const PartFolder folder, PartFolder::open(case_folder, part.name, part.again));
  scan.scan.run.out = folder.path();
  log::info("desktop", "recording and results go to {}", folder.path());
  const auto code = run_desktop_scan(scan);
  if (!folder.close()) return code;
  drop_placed(case_folder);  // the part before had been placed, not this one
  ENAMEL_TRY(write_case(case_folder, nullptr));
  return code;
}

}  // namespace

DesktopCommand add_desktop_scan(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("scan", "scan a model on the table: home, then stop by stop");
  auto o = std::make_shared<DesktopScan>();
  add_run_options(*sub, o->scan.run);
  add_desktop_options(*sub, o->desktop);
  sub->get_option("--mount")->required();
  sub->add_option("--port", o->port, "serial port of the axes, as /dev/ttyUSB0")->required();
  sub->add_option("--profile", o->profile, "of the axes, TOML as config/desktop/grbl.toml");
  sub->add_option("--plan", o->plan,
                  "auto: where most is missing, until all that can be seen is seen; full, quick, arch: a fixed list; "
                  "or FILE.csv with columns rot_deg,swing_deg")
      ->capture_default_str();
  sub->add_option("--bursts", o->bursts, "at every stop; their mean is taken")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  sub->add_option_function<std::string>(
         "--exposures",
         [o](const std::string& of) {
           o->scan.run.settings.push_back("desktop.exposure.exposures=" + (of == "auto" ? "0" : of));
         },
         "of every stop's bursts: 1 the probe's own, 2 a shorter one too, 3 a longer one too; auto: as each stop needs")
      ->check(CLI::IsMember({"auto", "1", "2", "3"}))
      ->default_str("auto");
  sub->add_option("--out", o->scan.run.out,
                  "folder for recording and results (default: a new one, out/session-DATE-TIME)");
  sub->add_option("--probe", o->scan.serial, "serial of the probe; needed when there is more than one");
  sub->add_option("--rig", o->scan.rig_path, "calibration to measure with instead of the probe's own");
  sub->add_option("--wait-seconds", o->scan.wait_seconds, "how long to wait for a probe")->capture_default_str();
  add_link_options(*sub, o->scan.link);
  sub->add_flag("!--no-record", o->scan.record, "keep no recording");
  sub->add_flag("--base", o->base, "also closed.ply and closed.stl: walls, bottom and patches, tagged synthetic");
  auto part = std::make_shared<PartOptions>();
  CLI::Option* name = sub->add_option("--part", part->name,
                                      "upper, lower, bite or die-NN: a part of the case in folder --out; "
                                      "`enamel desktop case` lays the parts on each other");
  name->needs(sub->get_option("--out"));
  sub->add_flag("--again", part->again, "scan a part anew; the scan before is kept as PART.1, PART.2, ...")
      ->needs(name);
  return {sub, [o, part]() -> Result<int> {
            if (!part->name.empty()) return scan_part(*o, *part);
            const bool made = o->scan.run.out.empty();
            if (made) {
              ENAMEL_TRY_ASSIGN(o->scan.run.out, new_session_folder());
            }
            log::info("desktop", "recording and results go to {}", o->scan.run.out);
            auto code = run_desktop_scan(*o);
            if (made && !code) drop_if_empty(o->scan.run.out);
            return code;
          }};
}

}  // namespace enamel::app
