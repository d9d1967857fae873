#include "host/app/desktop/desktop_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "host/app/input.hpp"
#include "host/desktop/desktop_session.hpp"
#include "host/desktop/recorded_stops.hpp"
#include "host/record/axes_readings.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

/// An empty table whose bursts do not decode would take nothing out, and nobody would know.
Result<void> check_seen(const std::string& path, std::size_t bursts, const std::vector<host::StopBurst>& rejected) {
  if (rejected.empty()) return {};
  const auto foreign = std::ranges::count(rejected, "foreign_calibration", &host::StopBurst::rejected);
  if (foreign > 0) {
    return fail(ErrorCode::kRigForeign, fmt::format("{}: {} of {} bursts of the empty table name another calibration "
                                                    "than the scan: record the table anew, with this one",
                                                    path, foreign, bursts));
  }
  const std::string first = fmt::format("{} of {} bursts of the empty table cannot be used, the first, {}, as {}",
                                        rejected.size(), bursts, rejected.front().id.value, rejected.front().rejected);
  if (rejected.size() < bursts) {
    log::warn("desktop", "{}: {}", path, first);
    return {};
  }
  return fail(ErrorCode::kEmptyInput, path + ": " + first);
}

Result<void> take_empty_table(const std::string& path, host::DesktopModel& model) {
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(path));
  ENAMEL_TRY_ASSIGN(const auto stops, host::RecordedStops::open(*stream));
  std::vector<host::StopBurst> rejected;
  std::size_t bursts = 0;
  for (;;) {
    ENAMEL_TRY_ASSIGN(const auto stop, stops->next(model));
    if (!stop) break;
    for (host::StopBurst& burst : model.add_empty(*stop)) {
      ++bursts;
      if (!burst.rejected.empty()) rejected.push_back(std::move(burst));
    }
  }
  if (bursts == 0) return fail(ErrorCode::kEmptyInput, path + ": no burst of an empty table");
  return check_seen(path, bursts, rejected);
}

}  // namespace

void add_desktop_options(CLI::App& app, DesktopOptions& o) {
  app.add_option("--mount", o.mount, "mount.json of the desktop scanner's axes (default: what the recording carries)");
  app.add_option("--empty", o.empty, "recording of the empty table and holder: they are taken out of the scan");
  app.add_option("--above", o.above_mm, "take out what lies lower than this above the axes' crossing, mm")
      ->check(CLI::Range(-100.0, 100.0));
}

Result<MountFile> mount_for(const std::string& path, host::BurstStream* stream) {
  MountFile out;
  if (!path.empty()) {
    ENAMEL_TRY_ASSIGN(out.text, read_file(path));
  } else if (stream != nullptr) {
    out.text = attached_text(*stream, kMountAttachment);
  }
  if (path.empty() && out.text.empty())
    return fail(ErrorCode::kMountInvalid, "none: pass --mount mount.json, as `enamel calibrate axes` wrote it");
  auto mount = calib::parse_mount(out.text);
  if (!mount) return fail(mount.error().code, (path.empty() ? "" : path + ": ") + mount.error().detail);
  out.mount = std::move(*mount);
  return out;
}

Result<host::DesktopModel> desktop_model(const calib::Rig& rig, std::uint32_t calib_crc32, const calib::Mount& mount,
                                         const LoadedConfig& config, const DesktopOptions& options, int workers) {
  host::DesktopConfig desktop = config.desktop;
  desktop.pipeline = config.pipeline;
  desktop.calib_crc32 = calib_crc32;
  desktop.above_mm = options.above_mm;
  const auto threads = static_cast<std::size_t>(std::max(workers, 1));
  ENAMEL_TRY_ASSIGN(auto model, host::DesktopModel::make(rig, mount, desktop, threads));
  if (!options.empty.empty()) ENAMEL_TRY(take_empty_table(options.empty, model));
  return model;
}

Result<std::unique_ptr<host::Session>> recorded_desktop(const RecordedDesktop& of, Clock& clock) {
  const DesktopOptions& o = of.options;
  if (o.free_hand) return nullptr;
  const bool has_axes = host::count_axes(of.stream) > 0;
  if (!has_axes && o.mount.empty()) return nullptr;
  auto mount = mount_for(o.mount, &of.stream);
  if (!mount && o.mount.empty()) {
    log::warn("replay",
              "the recording has angles of two axes, and is taken for a free-hand scan: "
              "pass --mount mount.json to lay it by them");
    return nullptr;
  }
  if (!mount) return tl::unexpected<Error>(mount.error());
  ENAMEL_TRY_ASSIGN(auto source, host::RecordedStops::open(of.stream));
  ENAMEL_TRY_ASSIGN(auto model, desktop_model(of.rig, of.calib_crc32, mount->mount, of.config, o, of.run.workers));
  const auto recorded_rig = calib::parse_rig(of.stream.rig_text());
  host::DesktopRun about{.simulated = host::says_simulated(of.stream.info()),
                         .device_serial = recorded_rig ? recorded_rig->serial : std::string(),
                         .scanned_at = host::recorded_at(of.stream.info()),
                         .preview_model = !of.run.headless};
  return std::make_unique<host::DesktopSession>(std::move(model), std::move(source), std::move(about), clock);
}

}  // namespace enamel::app
