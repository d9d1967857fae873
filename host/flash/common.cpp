#include <array>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/flash/command.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/image/image_file.hpp"
#include "protocol/image/version_text.hpp"

namespace enamel::flash_app {
namespace {

std::atomic<bool> g_interrupted{false};

void on_signal(int) { g_interrupted = true; }

std::string plain_text(const image::Serial& serial) {
  std::string text(serial.begin(), serial.end());
  return text.substr(0, text.find('\0'));
}

}  // namespace

const std::atomic<bool>& interrupted() {
  static const bool installed = [] {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    return true;
  }();
  static_cast<void>(installed);
  return g_interrupted;
}

void add_choice(CLI::App& app, Choice& choice) {
  auto* serial = app.add_option("--serial", choice.serial, "the probe with this serial");
  auto* port = app.add_option("--port", choice.port, "the probe at this port, as `list` prints it")->excludes(serial);
  app.add_flag("--all", choice.all, "every probe that is connected")->excludes(serial)->excludes(port);
  app.add_flag("--json", choice.json, "result as JSON");
}

update::Updated<std::vector<update::PortInfo>> choose(update::UsbBus& bus, const Choice& choice) {
  std::vector<update::PortInfo> found;
  std::string denied;
  for (update::PortInfo& p : bus.probes()) {
    if (p.denied) denied = p.port;
    const bool meant =
        (choice.serial.empty() || p.serial == choice.serial) && (choice.port.empty() || p.port == choice.port);
    if (meant) found.push_back(std::move(p));
  }
  // The serial of a probe that may not be opened is not known: it may be the one that is meant.
  if (found.empty() && !denied.empty()) return update::fail(update::HostError::kNoPermission, "port " + denied);
  if (found.empty()) return update::fail(update::HostError::kNoProbe, choice.serial + choice.port);
  if (found.size() > 1 && !choice.all) {
    return update::fail(update::HostError::kSeveralProbes, std::to_string(found.size()));
  }
  return found;
}

update::Updated<ImageFile> open_image_file(const std::string& path) {
  const Result<std::string> content = read_file(path);
  if (!content) return update::fail(update::HostError::kUnreadable, content.error().detail);
  const std::span<const std::byte> read = std::as_bytes(std::span(*content));
  ImageFile file{{read.begin(), read.end()}, {}};
  const auto manifest = image::check_image_file(file.bytes, {});
  if (!manifest) return tl::unexpected(update::refused_by_probe(manifest.error()));
  file.manifest = *manifest;
  return file;
}

update::UpdateError cannot_open(const update::PortInfo& probe, update::LinkFault fault) {
  if (fault == update::LinkFault::kDenied) {
    return update::make_error(update::HostError::kNoPermission, "port " + probe.port);
  }
  return update::make_error(update::HostError::kBrokenTransfer, "opening port " + probe.port + ", " + to_text(fault));
}

nlohmann::json to_json(const update::UpdateError& error) {
  return {{"error", error.what},
          {"cause", error.cause},
          {"remedy", error.remedy},
          {"refusal", error.refusal},
          {"exit_code", static_cast<int>(error.exit)}};
}

update::Exit report(const update::UpdateError& error, bool json) {
  if (json) {
    std::printf("%s\n", json_text(to_json(error), 1).c_str());
  } else {
    const std::string number = error.refusal == 0 ? "" : " " + std::to_string(error.refusal);
    std::fprintf(stderr, "error%s: %s\n  likely cause: %s\n  what to do: %s\n", number.c_str(), error.what.c_str(),
                 error.cause.c_str(), error.remedy.c_str());
  }
  return error.exit;
}

std::string slot_state_name(std::uint8_t state) {
  static constexpr std::array kNames = {"empty", "writing", "verified", "pending", "trial", "confirmed", "bad"};
  return state < kNames.size() ? kNames[state] : "unknown";
}

nlohmann::json to_json(const image::StatusBlock& s) {
  nlohmann::json j = {{"serial", plain_text(s.serial)},
                      {"hw_rev", s.hw_rev},
                      {"battery_mv", s.battery_mv},
                      {"running", image::to_text(s.version[s.active])},
                      {"active_slot", s.active},
                      {"min_security_counter", s.min_security_counter},
                      {"manifest_sha256", to_hex(s.manifest_sha)},
                      {"last_error", s.last_error},
                      {"slots", nlohmann::json::array()}};
  for (std::size_t i = 0; i < s.slot_state.size(); ++i) {
    j["slots"].push_back({{"state", slot_state_name(s.slot_state[i])},
                          {"version", image::to_text(s.version[i])},
                          {"tries", s.tries[i]}});
  }
  return j;
}

}  // namespace enamel::flash_app
