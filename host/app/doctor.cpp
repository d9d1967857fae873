// enamel doctor: what is wrong with this machine and how to mend it.
#include <sys/statvfs.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "host/app/command.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/dds/topics.hpp"
#include "viewer/gl/offscreen.hpp"
#include "viewer/gl/viewer_window.hpp"

namespace enamel::app {

namespace {

enum class Verdict { kOk, kWarning, kBad };

struct Finding {
  std::string check;
  Verdict verdict = Verdict::kOk;
  std::string found;
  std::string remedy;  ///< empty when nothing is to be done
};

const char* word(Verdict v) { return v == Verdict::kOk ? "ok" : v == Verdict::kWarning ? "warning" : "bad"; }

std::int64_t number_in(const std::string& path) {
  const auto text = read_file(path);
  return text ? std::strtoll(text->c_str(), nullptr, 10) : -1;
}

// One burst is 1.2 MB: three of them must fit, or a moment's inattention of the host loses fragments.
Finding receive_buffer() {
  constexpr std::int64_t kNeeded = 4 << 20;
  const std::int64_t have = number_in("/proc/sys/net/core/rmem_max");
  Finding f{"socket receive buffer", Verdict::kOk, std::to_string(have / 1024) + " KiB at most", ""};
  if (have < kNeeded) {
    f.verdict = Verdict::kWarning;
    f.remedy = "echo 'net.core.rmem_max=8388608' | sudo tee /etc/sysctl.d/60-enamel.conf && sudo sysctl --system";
  }
  return f;
}

Finding disk() {
  constexpr double kNeededGb = 2.0;  // a minute of bursts is 1.1 GB raw
  struct statvfs s {};
  if (::statvfs(".", &s) != 0) return {"disk", Verdict::kBad, "cannot be read", "run in a folder that exists"};
  const double free_gb = static_cast<double>(s.f_bavail) * static_cast<double>(s.f_frsize) * 1e-9;
  char found[64];
  std::snprintf(found, sizeof(found), "%.1f GB free here", free_gb);
  if (free_gb >= kNeededGb) return {"disk", Verdict::kOk, found, ""};
  return {"disk", Verdict::kBad, found, "free space, or record elsewhere with --session DIR"};
}

Finding processor() {
  const unsigned cores = std::thread::hardware_concurrency();
  const std::string found = std::to_string(cores) + " cores";
  if (cores >= 2) return {"processor", Verdict::kOk, found, ""};
  return {"processor", Verdict::kWarning, found, "live scanning at 30 bursts/s needs two cores; bursts will be shed"};
}

// A participant of its own, a status written and read back: discovery, loopback and types all work.
Finding dds_round_trip() {
  const char* uri = std::getenv("CYCLONEDDS_URI");
  const std::string by = uri != nullptr ? "CYCLONEDDS_URI rules" : "own configuration";
  const std::string remedy = "unset CYCLONEDDS_URI, check that the loopback interface is up (ip link set lo up)";
  const auto participant = dds::Participant::create({.domain = 77, .tag = "enamel-doctor"});
  if (!participant) return {"DDS", Verdict::kBad, participant.error().detail, remedy};
  auto reader = dds::Reader<proto::Status>::create(*participant);
  auto writer = dds::Writer<proto::Status>::create(*participant);
  if (!reader || !writer) return {"DDS", Verdict::kBad, "no reader or writer", remedy};
  proto::Status status;
  status.probe_id = 1;
  if (!writer->write(status)) return {"DDS", Verdict::kBad, "write failed", remedy};
  static_cast<void>(reader->wait(std::chrono::seconds(3)));
  const auto taken = reader->take();
  if (!taken || taken->empty()) return {"DDS", Verdict::kBad, "nothing came back in 3 s, " + by, remedy};
  return {"DDS", Verdict::kOk, "round trip works, " + by, ""};
}

Finding network() {
  return {"network", Verdict::kOk,
          "for the probe: --link " + dds::proposed_link() + "; there is: " + dds::interfaces_text(), ""};
}

Finding display() {
  SteadyClock clock;
  view::ViewerOptions options;
  options.visible = false;
  options.width = options.height = 64;
  auto window = view::ViewerWindow::open(options, clock);
  if (window) return {"display", Verdict::kOk, (*window)->gl_description(), ""};
  const auto picture = view::draw_offscreen({}, options);
  if (picture) {
    return {"display", Verdict::kWarning, "no window (" + window.error().detail + "); pictures by " + picture->drawn_by,
            "run on a desktop or under xvfb-run; --headless works as it is"};
  }
  return {"display", Verdict::kBad, picture.error().detail,
          "apt-get install libgl1-mesa-dri libegl-mesa0, or run on a desktop"};
}

Finding usb_rule() {
  std::error_code ec;
  for (const auto& entry : std::filesystem::directory_iterator("/etc/udev/rules.d", ec)) {
    if (entry.path().filename().string().find("enamel") != std::string::npos) {
      return {"USB rule", Verdict::kOk, entry.path().string(), ""};
    }
  }
  return {"USB rule", Verdict::kWarning, "no udev rule for the probe: only root can reach it by USB",
          "echo 'SUBSYSTEM==\"usb\", ATTR{idVendor}==\"1209\", TAG+=\"uaccess\"' | sudo tee "
          "/etc/udev/rules.d/60-enamel.rules && sudo udevadm control --reload"};
}

void print_findings(const std::vector<Finding>& findings) {
  for (const Finding& f : findings) {
    std::printf("%-8s %-22s %s\n", word(f.verdict), f.check.c_str(), f.found.c_str());
    if (!f.remedy.empty()) std::printf("         %-22s -> %s\n", "", f.remedy.c_str());
  }
}

void print_json(const std::vector<Finding>& findings) {
  nlohmann::json out = nlohmann::json::array();
  for (const Finding& f : findings) {
    out.push_back({{"check", f.check}, {"verdict", word(f.verdict)}, {"found", f.found}, {"remedy", f.remedy}});
  }
  std::puts(json_text(out, 1).c_str());
}

}  // namespace

Run add_doctor(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  app.add_flag("--json", *json, "one JSON array on stdout");
  return [json]() -> Result<int> {
    const std::vector<Finding> findings{processor(), disk(),    receive_buffer(), dds_round_trip(),
                                        network(),   display(), usb_rule()};
    *json ? print_json(findings) : print_findings(findings);
    for (const Finding& f : findings) {
      if (f.verdict == Verdict::kBad) return exit_code(ErrorCode::kHal);
    }
    return 0;
  };
}

}  // namespace enamel::app
