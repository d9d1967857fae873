// --link, --peer and --dds-tag of every command that meets a probe.
#pragma once

#include <CLI/CLI.hpp>

#include "protocol/dds/participant.hpp"

namespace enamel::app {

inline void add_link_options(CLI::App& app, dds::LinkChoice& choice) {
  app.add_option(
         "--link", choice.link,
         "network to the probe: loopback, usb, wifi, or FILE.toml (default: loopback, or what CYCLONEDDS_URI says)")
      ->type_name("NAME|FILE");
  app.add_option("--peer", choice.peers, "with --link: address of the probe, where it is not found by multicast")
      ->type_name("ADDRESS");
  app.add_option("--dds-tag", choice.tag, "only probes with the same tag are seen")->capture_default_str();
}

}  // namespace enamel::app
