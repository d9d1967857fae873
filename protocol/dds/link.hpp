// What lies between probe and host: the network interface, and how Cyclone DDS treats it. One profile for both ends.
#pragma once

#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::dds {

/// Sizes and times are Cyclone's; what each does: docs/link.md.
struct LinkProfile {
  std::string name = "loopback";
  /// A name; a network (169.254.77.0/24): the interface that has an address in it; "auto".
  std::string interface = "lo";
  std::vector<std::string> peers{"127.0.0.1"};  ///< asked directly; one end's suffices
  bool multicast = false;                       ///< for finding each other; data is always sent to the one who reads it
  int max_participants = 60;                    ///< on one address: ports asked at each peer
  /// A datagram. Beyond the interface's MTU the kernel cuts it up, and one lost piece loses all.
  int message_bytes = 65500;
  int fragment_bytes = 65000;
  int nack_delay_ms = 5;    ///< from a gap seen to asking again
  int heartbeat_ms = 20;    ///< from a write to telling the reader how far it goes
  int send_window_mb = 24;  ///< unacknowledged before a write waits
};

/// loopback, usb or wifi, or a TOML file with `link.*` keys (`base` names the profile it starts from). Errors: kUsage
/// for an unknown name, those of the file.
[[nodiscard]] Result<LinkProfile> read_link(const std::string& name_or_file);

/// The interface's name on this machine, now. Errors: kDds with the interfaces there are.
[[nodiscard]] Result<std::string> interface_of(const LinkProfile& profile);

/// Interfaces that are up, with an IPv4 address each: "lo 127.0.0.1, usb0 169.254.77.2"; "none".
[[nodiscard]] std::string interfaces_text();

/// The profile that fits what is plugged in: usb where its network is there, else loopback.
[[nodiscard]] std::string proposed_link();

}  // namespace enamel::dds
