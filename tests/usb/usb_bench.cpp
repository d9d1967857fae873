// usb_bench: plugs emulated probes into emulated USB ports, runs a command that uses libusb, then tells in JSON what
// became of the probes. Run it under umockdev-wrapper. Simulation.
#include <glib.h>
#include <sys/resource.h>
#include <umockdev.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
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
int run(std::vector<std::string> command, const std::vector<std::unique_ptr<UsbPort>>& ports) {
  std::vector<char*> argv;
  argv.reserve(command.size() + 1);
  for (std::string& word : command) argv.push_back(word.data());
  argv.push_back(nullptr);
  Child child;
  child.loop = g_main_loop_new(nullptr, FALSE);
  GPid pid = 0;
  const auto flags = static_cast<GSpawnFlags>(G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_SEARCH_PATH);
  if (!g_spawn_async(nullptr, argv.data(), nullptr, flags, nullptr, nullptr, &pid, nullptr)) return -1;
  for (const auto& port : ports) port->watch(pid);
  g_child_watch_add(pid, on_exit, &child);
  g_main_loop_run(child.loop);
  g_main_loop_unref(child.loop);
  return WIFEXITED(child.status) ? WEXITSTATUS(child.status) : -1;
}

nlohmann::json describe(UsbPort& port) {
  // A probe that was pulled for good is switched on again to see what boots on it.
  if (!port.plugged()) port.probe().boot();
  const enamel::image::StatusBlock s = port.probe().status();
  nlohmann::json j = {{"serial", port.probe().options().serial},
                      {"plugged", port.plugged()},
                      {"running", *port.probe().running()},
                      {"active", s.active},
                      {"slot_state", s.slot_state},
                      {"dfu_state", port.probe().dfu_state()},
                      {"min_security_counter", s.min_security_counter},
                      {"last_error", s.last_error},
                      {"calibration_sha256", port.probe().calibration_sha()}};
  for (const enamel::image::ImageVersion& v : s.version) j["major"].push_back(v.major);
  if (const auto ms = port.meter().wall_ms()) j["transfer_ms"] = *ms;
  if (const auto ms = port.meter().cpu_ms()) j["transfer_cpu_ms"] = *ms;
  return j;
}

ProbeOptions probe_options(const nlohmann::json& j, std::size_t index) {
  ProbeOptions probe;
  probe.serial = j.value("serial", "EN2-000" + std::to_string(index + 1));
  probe.hw_rev = j.value("hw_rev", probe.hw_rev);
  probe.healthy = j.value("healthy", true);
  probe.scanning = j.value("scanning", false);
  probe.powered = j.value("powered", true);
  probe.rig_bytes = j.value("rig_bytes", probe.rig_bytes);
  return probe;
}

PortFaults port_faults(const nlohmann::json& j) {
  PortFaults faults;
  faults.stalls_at_block = j.value("stalls_at_block", 0U);
  faults.stall_count = j.value("stall_count", 0U);
  faults.silent_at_block = j.value("silent_at_block", 0U);
  faults.silent_count = j.value("silent_count", 0U);
  faults.power_lost = j.value("power_lost", false);
  faults.speed_mbit = j.value("speed_mbit", faults.speed_mbit);
  if (j.contains("mode")) faults.mode = std::stoul(j["mode"].get<std::string>(), nullptr, 8);
  if (j.contains("pull_at_block")) faults.pull_at_block = j["pull_at_block"];
  if (j.contains("replug_ms")) faults.replug_ms = j["replug_ms"];
  if (j.contains("replug_port")) faults.replug_port = j["replug_port"];
  if (j.contains("interrupt_at_block")) faults.interrupt_at_block = j["interrupt_at_block"];
  return faults;
}

/// Version 2.0.0 for emulated probes, which run 1.0.0.
void write_image(const std::string& path, std::size_t payload) {
  enamel::image::ImageDescription d = plain_description();
  d.version = {2, 0, 0, 0};
  const KeyRing keys;
  const std::vector<std::byte> file = build(d, random_payload(payload, 2), {&keys.signer(0), 1});
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  if (!out) throw std::runtime_error("cannot write " + path);
}

/// User and system time of the children that have ended.
double children_cpu_ms() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  const auto ms = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_usec) / 1e3;
  };
  return ms(used.ru_utime) + ms(used.ru_stime);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Emulated probes on emulated USB ports around a command. SIMULATION.", "usb_bench");
  std::vector<std::string> probes = {"{}"};
  std::string report, image;
  std::size_t image_bytes = 16U << 20U;
  app.add_option(
         "--probe", probes,
         R"(one each, JSON: {"serial", "hw_rev", "healthy", "scanning", "powered", "rig_bytes", "mode" (octal), "speed_mbit", )"
         R"("stalls_at_block", "stall_count", "silent_at_block", "silent_count", "pull_at_block", "replug_ms", )"
         R"("replug_port", "power_lost", "interrupt_at_block"})")
      ->allow_extra_args(false);
  app.add_option("--report", report, "JSON of the probes afterwards");
  app.add_option("--image", image, "write an image that the probes trust there first");
  app.add_option("--image-bytes", image_bytes, "its payload");
  app.footer("After -- comes the command.");
  char** const separator = std::find(argv, argv + argc, std::string_view("--"));
  const int own = static_cast<int>(separator - argv);
  CLI11_PARSE(app, own, argv);
  const std::vector<std::string> command(std::min(separator + 1, argv + argc), argv + argc);
  if (command.empty()) {
    std::fprintf(stderr, "usb_bench: no command after --\n");
    return 1;
  }

  if (!image.empty()) write_image(image, image_bytes);
  UMockdevTestbed* testbed = umockdev_testbed_new();
  std::vector<std::unique_ptr<UsbPort>> ports;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const nlohmann::json j = nlohmann::json::parse(probes[i]);
    ports.push_back(std::make_unique<UsbPort>(testbed, static_cast<int>(i) + 1, probe_options(j, i), port_faults(j)));
  }
  const int code = run(command, ports);
  nlohmann::json out = {{"exit_code", code}, {"cpu_ms", children_cpu_ms()}, {"probes", nlohmann::json::array()}};
  for (const auto& port : ports) out["probes"].push_back(describe(*port));
  if (!report.empty()) std::ofstream(report) << out.dump(1) << '\n';
  ports.clear();
  g_object_unref(testbed);
  return code < 0 ? 125 : code;
}
