// What a scan by stops is given beside what every run is, and the session made of a recording.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "calib/model/mount.hpp"
#include "host/app/run_options.hpp"
#include "host/desktop/desktop_model.hpp"
#include "host/record/burst_stream.hpp"
#include "host/session/session.hpp"

namespace enamel::app {

inline constexpr const char* kMountAttachment = "mount.json";  ///< of a recording: that it was scanned with

struct DesktopOptions {
  std::string mount;  ///< mount.json; empty: what the recording carries
  std::string empty;  ///< recording of the empty table; empty: none
  std::optional<double> above_mm;
  bool free_hand = false;  ///< angles are not looked at
};

/// Adds --mount, --empty, --above.
void add_desktop_options(CLI::App& app, DesktopOptions& options);

struct MountFile {
  calib::Mount mount;
  std::string text;  ///< of the file, byte for byte
};
/// Errors: of reading the file and of parse_mount; kMountInvalid where neither option nor recording has one.
[[nodiscard]] Result<MountFile> mount_for(const std::string& path, host::BurstStream* stream);

/// The model of a scan by stops with what an empty table showed, `options.empty`, taken out. calib_crc32: that the
/// bursts have to name; 0: any. Errors: those of DesktopModel::make, of the recording of the empty table.
[[nodiscard]] Result<host::DesktopModel> desktop_model(const calib::Rig& rig, std::uint32_t calib_crc32,
                                                       const calib::Mount& mount, const LoadedConfig& config,
                                                       const DesktopOptions& options, int workers);

/// A recorded scan by stops, or null where the recording is none: it has no angles, or no mount is known, which is
/// told. `stream` must outlive the session. Errors: kAxesMissing where a mount was given; those above.
struct RecordedDesktop {
  host::BurstStream& stream;
  const calib::Rig& rig;
  std::uint32_t calib_crc32;  ///< as desktop_model()
  const LoadedConfig& config;
  const DesktopOptions& options;
  const RunOptions& run;
};
[[nodiscard]] Result<std::unique_ptr<host::Session>> recorded_desktop(const RecordedDesktop& of, Clock& clock);

}  // namespace enamel::app
