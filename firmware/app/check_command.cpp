#include "firmware/app/check_command.hpp"

#include <fmt/core.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "firmware/app/open_device.hpp"
#include "firmware/check/board_check.hpp"
#include "firmware/control/vigil.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#ifdef ENAMEL_HAS_LIBCAMERA
#include "firmware/device/linux/board/open_board.hpp"
#endif

namespace enamel::fw {
namespace {

constexpr Nanoseconds kPoll{20'000'000};

/// Prints each finding as it comes; a person sees where it stands.
class Findings {
 public:
  explicit Findings(bool json) : json_(json) {}
  void add(const CheckFinding& f) {
    all_.push_back(f);
    if (!json_) std::cout << fmt::format("{:<4} {:<10} {}", f.fault ? "BAD" : "ok", f.part, f.found) << std::endl;
  }
  void add(const std::string& part, const Error& error) { add({part, error.detail, error.code}); }
  /// The first that is bad as an error.
  Result<int> end() const {
    if (json_) print_json();
    for (const CheckFinding& f : all_) {
      if (f.fault) return fail(*f.fault, f.part + ": " + f.found);
    }
    if (!json_) std::cout << "all is good" << std::endl;
    return 0;
  }

 private:
  void print_json() const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    bool good = true;
    for (const CheckFinding& f : all_) {
      list.push_back({{"part", f.part}, {"good", !f.fault}, {"found", f.found}});
      if (f.fault) list.back()["code"] = static_cast<int>(*f.fault);
      good = good && !f.fault;
    }
    std::cout << json_text(nlohmann::ordered_json{{"good", good}, {"findings", list}}) << std::endl;
  }

  bool json_;
  std::vector<CheckFinding> all_;
};

Result<std::unique_ptr<Device>> open(const ProbeOptions& options, Clock& clock, Findings& findings) {
  const auto opened = [&](const std::string& name, const std::string& what) {
    findings.add({name, what, std::nullopt});
  };
  auto device = open_device(options, clock, opened);
  if (!device) {
    findings.add("device", device.error());
  } else {
    findings.add({"device", (*device)->model(), std::nullopt});
  }
  return device;
}

Result<void> save(const CheckReport& report, const std::string& path) {
  if (path.empty() || !report.picture) return {};
  return write_file(path, pgm_of(*report.picture));
}

}  // namespace

Result<int> run_check(const ProbeOptions& options, const std::atomic<bool>& stop) {
  SteadyClock clock;
  Findings findings(options.json);
  const auto device = open(options, clock, findings);
  if (!device) return findings.end();
  Vigil vigil((*device)->watchdog(), (*device)->max_silence());
  CheckConfig config;
  config.meanwhile = [&](Nanoseconds silence) {
    vigil.step(silence, clock.now());
    clock.sleep_for(kPoll);
    return !stop.load(std::memory_order_acquire);
  };
  config.found = [&](const CheckFinding& f) { findings.add(f); };
  const CheckReport report = check_device(**device, clock, config);
  ENAMEL_TRY(save(report, options.picture));
  return findings.end();
}

Result<int> run_dark(const ProbeOptions& options) {
#ifdef ENAMEL_HAS_LIBCAMERA
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const BoardProfile profile, read_profile(options.profile));
  ENAMEL_TRY(darken_board(profile, clock));
  std::cout << "light, gate, heater and projector are off" << std::endl;
  return 0;
#else
  return fail(ErrorCode::kHal, options.profile + ": this build has no board back end (ENAMEL_WITH_LIBCAMERA is off)");
#endif
}

}  // namespace enamel::fw
