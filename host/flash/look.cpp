// enamel-flash list, info: they look and change nothing.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/flash/command.hpp"
#include "host/update/dfu_client.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/image/version_text.hpp"

namespace enamel::flash_app {
namespace {

using update::Exit;
using update::HostError;

nlohmann::json look_at(update::UsbBus& bus, const update::PortInfo& p) {
  nlohmann::json j = {{"port", p.port},
                      {"serial", p.serial},
                      {"model", p.model},
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
  std::printf("%-8s %-16s %-13s %-9s %-12s hw %-3d A: %-22s B: %-22s min counter %d, battery %.2f V, port %d Mbit/s\n",
              j["port"].get<std::string>().c_str(), j["serial"].get<std::string>().c_str(),
              j["model"].get<std::string>().c_str(), j["mode"].get<std::string>().c_str(),
              j["running"].get<std::string>().c_str(), j["hw_rev"].get<int>(), slot(0).c_str(), slot(1).c_str(),
              j["min_security_counter"].get<int>(), j["battery_mv"].get<double>() / 1000, j["speed_mbit"].get<int>());
}

Exit print_image(const std::string& path) {
  const auto image_file = open_image_file(path);
  if (!image_file) return report(image_file.error(), false);
  const image::Manifest& manifest = image_file->manifest;
  std::printf(
      "version          %s\nsecurity counter %u\nhardware         %u to %u\npayload          %llu bytes, %u chunks\n"
      "signatures       %u (checked by the probe)\nmanifest         %s\n",
      image::to_text(manifest.version).c_str(), manifest.security_counter, manifest.hw_rev_min, manifest.hw_rev_max,
      static_cast<unsigned long long>(manifest.payload_len), manifest.chunk_count, manifest.signature_count,
      to_hex(sha256(manifest.bytes)).c_str());
  return Exit::kOk;
}

/// Of one probe; read-only.
update::Updated<std::size_t> copy_calibration(update::UsbBus& bus, const update::PortInfo& probe,
                                              const std::string& path) {
  const auto link = bus.open(probe.port);
  if (!link) return tl::unexpected(cannot_open(probe, link.error()));
  SteadyClock clock;
  const auto bytes = update::DfuClient(**link, clock).read_calibration();
  if (!bytes && bytes.error().refusal != 0) return tl::unexpected(update::refused_by_probe(bytes.error().refusal));
  if (!bytes)
    return update::fail(HostError::kBrokenTransfer, "reading the calibration, " + to_text(bytes.error().fault));
  if (const auto written = write_file(path, {reinterpret_cast<const char*>(bytes->data()), bytes->size()}); !written) {
    return update::fail(HostError::kCopyFile, written.error().detail);
  }
  return bytes->size();
}

Exit save_calibration(const Choice& choice, const std::string& path) {
  const auto bus = update::open_usb_bus();
  if (!bus) return report(update::make_error(HostError::kNoUsb), choice.json);
  const auto probes = choose(*bus, choice);
  if (!probes) return report(probes.error(), choice.json);
  if (probes->size() > 1) return report(update::make_error(HostError::kSeveralProbes), choice.json);
  const update::PortInfo& probe = probes->front();
  const auto length = copy_calibration(*bus, probe, path);
  if (!length) return report(length.error(), choice.json);
  if (choice.json) {
    std::printf("%s\n",
                json_text(nlohmann::json{{"serial", probe.serial}, {"bytes", *length}, {"exit_code", 0}}).c_str());
  } else {
    std::printf("%s: %zu bytes written to %s\n", probe.serial.c_str(), *length, path.c_str());
  }
  return Exit::kOk;
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
      std::printf("%s\n", json_text(all, 1).c_str());
      return exit;
    }
    if (all.empty()) return report(update::make_error(HostError::kNoProbe), false);
    for (const nlohmann::json& j : all) print_row(j);
    return exit;
  };
}

Run add_info(CLI::App& app) {
  struct Options {
    std::string file, save_calibration;
    Choice choice;
  };
  auto o = std::make_shared<Options>();
  auto* what = app.add_option_group("what", "one of");
  what->add_option("FILE", o->file, "image (*.enfw): what it is");
  what->add_option("--save-calib", o->save_calibration, "write a copy of the probe's calibration (rig.json) there");
  what->require_option(1);
  add_choice(app, o->choice);
  return [o] { return o->file.empty() ? save_calibration(o->choice, o->save_calibration) : print_image(o->file); };
}

}  // namespace enamel::flash_app
