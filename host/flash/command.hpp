// Subcommands of `enamel-flash`: each adds itself to the parser and returns what to run when it was chosen.
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host/update/probe_link.hpp"
#include "host/update/update_error.hpp"
#include "protocol/image/status_block.hpp"

namespace enamel::flash_app {

using Run = std::function<update::Exit()>;

/// Which probes a command means.
struct Choice {
  std::string serial, port;
  bool all = false;
  bool json = false;
};

void add_choice(CLI::App& app, Choice& choice);
/// The probes meant. Without any choice the only one there is; several are an error, never a guess.
[[nodiscard]] update::Updated<std::vector<update::PortInfo>> choose(update::UsbBus& bus, const Choice& choice);

/// An image file, checked whole (chunks, not signatures: those the probe checks).
struct ImageFile {
  std::vector<std::byte> bytes;
  image::Manifest manifest;  ///< views into `bytes`
};
[[nodiscard]] update::Updated<ImageFile> open_image_file(const std::string& path);

/// Why a probe that was seen cannot be opened.
[[nodiscard]] update::UpdateError cannot_open(const update::PortInfo& probe, update::LinkFault fault);
/// Error to stderr (three lines) or, as JSON, to stdout; its exit code.
update::Exit report(const update::UpdateError& error, bool json);
[[nodiscard]] nlohmann::json to_json(const update::UpdateError& error);
[[nodiscard]] nlohmann::json to_json(const image::StatusBlock& status);
[[nodiscard]] std::string slot_state_name(std::uint8_t state);

/// Set by SIGINT and SIGTERM.
[[nodiscard]] const std::atomic<bool>& interrupted();

Run add_list(CLI::App& app);
Run add_info(CLI::App& app);
Run add_flash(CLI::App& app);
Run add_verify(CLI::App& app);
Run add_rollback(CLI::App& app);
Run add_confirm(CLI::App& app);
Run add_factory_reset(CLI::App& app);
Run add_selftest(CLI::App& app);

}  // namespace enamel::flash_app
