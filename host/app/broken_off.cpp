#include "host/app/broken_off.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "host/app/out_folder.hpp"
#include "host/record/session_stream.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

std::string behind_link(const std::string& folder) {
  std::error_code ec;
  const fs::path target = fs::read_symlink(folder, ec);
  return ec ? folder : (fs::path(folder).parent_path() / target).string();
}

std::string ago(double seconds) {
  const auto s = static_cast<long>(seconds);
  if (s < 120) return std::to_string(s) + " s";
  return s < 7200 ? std::to_string(s / 60) + " minutes" : std::to_string(s / 3600) + " hours";
}

/// Of several goes the last one decides.
bool came_to_its_end(const std::vector<std::string>& parts, const host::BurstStream& all) {
  if (parts.size() == 1) return !all.info().truncated;
  const auto last = host::open_parts({parts.back()});
  return last && !(*last)->info().truncated;
}

}  // namespace

std::optional<BrokenOff> broken_off(const std::string& folder) {
  const auto parts = host::session_parts(folder);
  if (parts.empty() || in_use(folder)) return std::nullopt;
  const auto recording = host::open_parts(parts);
  if (!recording || (*recording)->rig_text().empty() || came_to_its_end(parts, **recording)) return std::nullopt;
  struct stat written {};
  if (::stat(parts.back().c_str(), &written) != 0) return std::nullopt;
  const double age_s = std::chrono::duration<double>(wall_time().time_since_epoch()).count() -
                       static_cast<double>(written.st_mtim.tv_sec);
  return BrokenOff{behind_link(folder), std::max(age_s, 0.0)};
}

std::optional<BrokenOff> goes_on_with(const std::string& folder) {
  auto before = broken_off(folder);
  if (!before) return std::nullopt;
  if (before->age_s > kGoesOnWithin_s) {
    log::warn("scan", "{}: a scan was broken off there {} ago; go on with it by enamel scan --resume {}",
              before->folder, ago(before->age_s), before->folder);
    return std::nullopt;
  }
  log::warn("scan", "{}: this scan was broken off {} ago and goes on now; another one is begun by enamel scan --new",
            before->folder, ago(before->age_s));
  return before;
}

}  // namespace enamel::app
