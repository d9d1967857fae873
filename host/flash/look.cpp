// enamel-flash list, info: they look and change nothing.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/flash/command.hpp"
#include "host/update/dfu_client.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/image/version_text.hpp"

namespace enamel::flash_app {
namespace {

using update::Exit;
using update::HostError;

nlohmann::json look_at(update::UsbBus& bus, const update::PortInfo& p) {
  nlohmann::json j = {{"port", p.port},
                      {"serial", p.serial},
                      {"speed_mbit", p.speed_mbit},
                      {"mode", p.recovery() ? "recovery" : "run"}};
  SteadyClock clock;
  const auto link = bus.open(p.port);
  if (!link) {
    j["problem"] = to_json(cannot_open(p, link.error()));
    return j;
  }
  const update::Linked<image::StatusBlock> status = update::DfuClient(**link, clock).read_status_block();
  if (status) {
    j.update(to_json(*status));
  } else {
    j["problem"] =
        to_json(update::make_error(HostError::kBrokenTransfer, "reading the status, " + to_text(status.error())));
  }
  return j;
}

void print_row(const nlohmann::json& j) {
  if (j.contains("problem")) {
    std::printf("%-8s %-16s %s\n  what to do: %s\n", j["port"].get<std::string>().c_str(),
                j["serial"].get<std::string>().c_str(), j["problem"]["error"].get<std::string>().c_str(),
                j["problem"]["remedy"].get<std::string>().c_str());
    return;
  }
  const nlohmann::json& slots = j["slots"];
  const auto slot = [&](std::size_t i) {
    return slots[i]["state"].get<std::string>() + " " + slots[i]["version"].get<std::string>();
  };
  std::printf("%-8s %-16s %-9s %-12s hw %-3d A: %-22s B: %-22s min counter %d, battery %.2f V, port %d Mbit/s\n",
              j["port"].get<std::string>().c_str(), j["serial"].get<std::string>().c_str(),
              j["mode"].get<std::string>().c_str(), j["running"].get<std::string>().c_str(), j["hw_rev"].get<int>(),
              slot(0).c_str(), slot(1).c_str(), j["min_security_counter"].get<int>(),
              j["battery_mv"].get<double>() / 1000, j["speed_mbit"].get<int>());
}

}  // namespace

Run add_list(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  app.add_flag("--json", *json, "as JSON");
  return [json] {
    const auto bus = update::open_usb_bus();
    if (!bus) return report(update::make_error(HostError::kNoUsb), *json);
    nlohmann::json all = nlohmann::json::array();
    Exit exit = Exit::kOk;
    for (const update::PortInfo& p : bus->probes()) {
      all.push_back(look_at(*bus, p));
      const nlohmann::json& j = all.back();
      if (exit == Exit::kOk && j.contains("problem")) exit = static_cast<Exit>(j["problem"]["exit_code"].get<int>());
    }
    if (*json) {
      std::printf("%s\n", all.dump(1).c_str());
      return exit;
    }
    if (all.empty()) return report(update::make_error(HostError::kNoProbe), false);
    for (const nlohmann::json& j : all) print_row(j);
    return exit;
  };
}

Run add_info(CLI::App& app) {
  auto file = std::make_shared<std::string>();
  app.add_option("FILE", *file, "image (*.enfw)")->required();
  return [file] {
    const auto image_file = open_image_file(*file);
    if (!image_file) return report(image_file.error(), false);
    const image::Manifest& manifest = image_file->manifest;
    std::printf(
        "version          %s\nsecurity counter %u\nhardware         %u to %u\npayload          %llu bytes, %u chunks\n"
        "signatures       %u (checked by the probe)\nmanifest         %s\n",
        image::to_text(manifest.version).c_str(), manifest.security_counter, manifest.hw_rev_min, manifest.hw_rev_max,
        static_cast<unsigned long long>(manifest.payload_len), manifest.chunk_count, manifest.signature_count,
        to_hex(sha256(manifest.bytes)).c_str());
    return Exit::kOk;
  };
}

}  // namespace enamel::flash_app
