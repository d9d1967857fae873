// enamel-flash verify, rollback, confirm, factory-reset, selftest: one request each.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/flash/command.hpp"
#include "host/update/dfu_client.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::flash_app {
namespace {

using image::VendorRequest;
using update::Exit;
using update::HostError;
using update::Updated;

/// Opens each chosen probe and calls act(client, probe) on it; the first failure is the exit code.
template <class Act>
Exit for_each(const Choice& choice, Act act) {
  const auto bus = update::open_usb_bus();
  if (!bus) return report(update::make_error(update::HostError::kNoUsb), choice.json);
  const auto probes = choose(*bus, choice);
  if (!probes) return report(probes.error(), choice.json);
  SteadyClock clock;
  Exit exit = Exit::kOk;
  for (const update::PortInfo& p : *probes) {
    Updated<void> done;
    const auto link = bus->open(p.port);
    if (!link) {
      done = tl::unexpected(cannot_open(p, link.error()));
    } else {
      update::DfuClient client(**link, clock);
      done = act(client);
    }
    if (!done) {
      const Exit code = report(done.error(), choice.json);
      if (exit == Exit::kOk) exit = code;
    } else if (choice.json) {
      std::printf("%s\n",
                  enamel::json_text(nlohmann::json{{"serial", p.serial}, {"port", p.port}, {"exit_code", 0}}).c_str());
    } else {
      std::printf("%s: ok\n", p.serial.c_str());
    }
  }
  return exit;
}

/// A vendor request and the probe's word on it.
Updated<void> ask(update::DfuClient& client, VendorRequest request, std::uint16_t value = 0,
                  std::span<const std::byte> data = {}) {
  const auto done = client.ask(request, value, data);
  if (done) return {};
  if (done.error().refusal != 0) return tl::unexpected(update::refused_by_probe(done.error().refusal));
  return update::fail(HostError::kBrokenTransfer, "asking the probe, " + to_text(done.error().fault));
}

Updated<void> same_firmware(update::DfuClient& client, const Sha256Digest& wanted) {
  const auto status = client.read_status_block();
  if (!status) return update::fail(HostError::kBrokenTransfer, "reading the status, " + to_text(status.error()));
  if (status->manifest_sha == wanted) return {};
  return update::fail(HostError::kOtherFirmware);
}

struct Simple {
  Choice choice;
  std::string file, serial;
  bool commit = false;
};

}  // namespace

Run add_verify(CLI::App& app) {
  auto o = std::make_shared<Simple>();
  app.add_option("FILE", o->file, "image (*.enfw) that the probe should run")->required();
  add_choice(app, o->choice);
  return [o] {
    const auto file = open_image_file(o->file);
    if (!file) return report(file.error(), o->choice.json);
    const Sha256Digest wanted = sha256(file->manifest.bytes);
    return for_each(o->choice, [&](update::DfuClient& client) { return same_firmware(client, wanted); });
  };
}

Run add_rollback(CLI::App& app) {
  auto o = std::make_shared<Simple>();
  add_choice(app, o->choice);
  return [o] {
    return for_each(o->choice, [](update::DfuClient& client) -> Updated<void> {
      if (auto back = ask(client, VendorRequest::kRollback); !back) return back;
      return ask(client, VendorRequest::kReboot);
    });
  };
}

Run add_confirm(CLI::App& app) {
  auto o = std::make_shared<Simple>();
  add_choice(app, o->choice);
  app.add_flag("--commit", o->commit, "raise the minimum security counter now: no way back to older counters");
  return [o] {
    return for_each(o->choice,
                    [&](update::DfuClient& client) { return ask(client, VendorRequest::kConfirm, o->commit ? 1 : 0); });
  };
}

Run add_factory_reset(CLI::App& app) {
  auto o = std::make_shared<Simple>();
  app.add_option("--yes-really", o->serial, "serial of the probe whose settings are erased")->required();
  app.add_flag("--json", o->choice.json, "result as JSON");
  return [o] {
    o->choice.serial = o->serial;
    image::Serial serial{};
    std::copy_n(o->serial.begin(), std::min(o->serial.size(), serial.size()), serial.begin());
    return for_each(o->choice, [&](update::DfuClient& client) {
      return ask(client, VendorRequest::kFactoryReset, 0, std::as_bytes(std::span(serial)));
    });
  };
}

Run add_selftest(CLI::App& app) {
  auto o = std::make_shared<Simple>();
  add_choice(app, o->choice);
  return [o] {
    return for_each(o->choice, [](update::DfuClient& client) { return ask(client, VendorRequest::kSelfTest); });
  };
}

}  // namespace enamel::flash_app
