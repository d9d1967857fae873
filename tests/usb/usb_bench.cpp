// usb_bench: plugs emulated probes into emulated USB ports, runs a command that uses libusb, then tells in JSON what
// became of the probes. Run it under umockdev-wrapper. Simulation.
#include <glib.h>
#include <umockdev.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "tests/usb/usb_port.hpp"

namespace {

using namespace enamel::test;
using enamel::test::UsbPort;

struct Child {
  GMainLoop* loop = nullptr;
  int status = 0;
};

void on_exit(GPid pid, gint status, gpointer data) {
  auto* child = static_cast<Child*>(data);
  child->status = status;
  g_spawn_close_pid(pid);
  g_main_loop_quit(child->loop);
}

/// Exit code of the command, -1 when it cannot be started or was killed.
int run(std::vector<std::string> command) {
  std::vector<char*> argv;
  for (std::string& word : command) argv.push_back(word.data());
  argv.push_back(nullptr);
  Child child;
  child.loop = g_main_loop_new(nullptr, FALSE);
  GPid pid = 0;
  const auto flags = static_cast<GSpawnFlags>(G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_SEARCH_PATH);
  if (!g_spawn_async(nullptr, argv.data(), nullptr, flags, nullptr, nullptr, &pid, nullptr)) return -1;
  g_child_watch_add(pid, on_exit, &child);
  g_main_loop_run(child.loop);
  g_main_loop_unref(child.loop);
  return WIFEXITED(child.status) ? WEXITSTATUS(child.status) : -1;
}

nlohmann::json describe(UsbPort& port) {
  const enamel::image::StatusBlock s = port.probe().status();
  nlohmann::json j = {{"serial", port.probe().options().serial},
                      {"plugged", port.plugged()},
                      {"running", *port.probe().running()},
                      {"active", s.active},
                      {"slot_state", s.slot_state},
                      {"min_security_counter", s.min_security_counter},
                      {"last_error", s.last_error},
                      {"calibration_sha256", port.probe().calibration_sha()}};
  for (const enamel::image::ImageVersion& v : s.version) j["major"].push_back(v.major);
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Emulated probes on emulated USB ports around a command. SIMULATION.", "usb_bench");
  std::vector<std::string> probes = {"{}"};
  std::string report;
  app.add_option("--probe", probes,
                 R"(one each, JSON: {"serial", "hw_rev", "healthy", "scanning", "powered", )"
                 R"("stalls_at_block", "stall_count", "pull_at_block", "replug_ms"})")
      ->allow_extra_args(false);
  app.add_option("--report", report, "JSON of the probes afterwards");
  app.footer("After -- comes the command.");
  char** const separator = std::find(argv, argv + argc, std::string_view("--"));
  const int own = static_cast<int>(separator - argv);
  CLI11_PARSE(app, own, argv);
  const std::vector<std::string> command(std::min(separator + 1, argv + argc), argv + argc);
  if (command.empty()) {
    std::fprintf(stderr, "usb_bench: no command after --\n");
    return 1;
  }

  UMockdevTestbed* testbed = umockdev_testbed_new();
  std::vector<std::unique_ptr<UsbPort>> ports;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const nlohmann::json j = nlohmann::json::parse(probes[i]);
    ProbeOptions probe;
    probe.serial = j.value("serial", "EN2-000" + std::to_string(i + 1));
    probe.hw_rev = j.value("hw_rev", probe.hw_rev);
    probe.healthy = j.value("healthy", true);
    probe.scanning = j.value("scanning", false);
    probe.powered = j.value("powered", true);
    PortFaults faults;
    faults.stalls_at_block = j.value("stalls_at_block", 0U);
    faults.stall_count = j.value("stall_count", 0U);
    if (j.contains("pull_at_block")) faults.pull_at_block = j["pull_at_block"];
    if (j.contains("replug_ms")) faults.replug_ms = j["replug_ms"];
    ports.push_back(std::make_unique<UsbPort>(testbed, static_cast<int>(i) + 1, probe, faults));
  }
  const int code = run(command);
  nlohmann::json out = {{"exit_code", code}, {"probes", nlohmann::json::array()}};
  for (const auto& port : ports) out["probes"].push_back(describe(*port));
  if (!report.empty()) std::ofstream(report) << out.dump(1) << '\n';
  ports.clear();
  g_object_unref(testbed);
  return code < 0 ? 125 : code;
}
