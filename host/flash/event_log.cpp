#include "host/flash/event_log.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>

#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::flash_app {
namespace {

constexpr auto kKept = std::chrono::hours(24 * 30);

/// The lines that are younger than `oldest`; such that are not ours have no time and stay.
std::string without_old_lines(const std::string& text, const std::string& oldest) {
  std::string kept;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json j = nlohmann::json::parse(line, nullptr, false);
    const bool dated = j.is_object() && j.contains("ts") && j["ts"].is_string();
    if (!dated || j["ts"].get_ref<const std::string&>() >= oldest) kept += line + "\n";
  }
  return kept;
}

}  // namespace

update::Updated<EventLog> EventLog::open(const std::string& path) {
  EventLog log;
  if (path.empty()) return log;
  if (const Result<std::string> before = read_file(path)) {
    const std::string kept = without_old_lines(*before, utc_text_ms(wall_time() - kKept));
    if (kept != *before) {
      if (const auto written = write_file(path, kept); !written) {
        return update::fail(update::HostError::kLogFile, written.error().detail);
      }
    }
  }
  log.out_.open(path, std::ios::app);
  if (!log.out_) return update::fail(update::HostError::kLogFile, path);
  return log;
}

void EventLog::write(const update::PortInfo& probe, const update::FlashEvent& event) {
  if (!out_.is_open()) return;
  const nlohmann::ordered_json line = {{"ts", utc_text_ms(wall_time())},
                                       {"serial", probe.serial},
                                       {"event", event.event},
                                       {"block", event.block},
                                       {"status", event.status}};
  out_ << json_text(line) << std::endl;
}

}  // namespace enamel::flash_app
