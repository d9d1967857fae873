#include "protocol/dds/link.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>

#include "protocol/base/config.hpp"

namespace enamel::dds {
namespace {

constexpr const char* kUsbNetwork = "169.254.77.0/24";

// Datagrams below the MTU of Ethernet, and fragments that fit one each: of a datagram that the kernel cuts into ten,
// one lost packet loses all, and the pieces of others wait thirty seconds for it.
LinkProfile usb() {
  LinkProfile profile;
  profile.name = "usb";
  profile.message_bytes = 1456;
  profile.fragment_bytes = 1344;
  profile.send_window_mb = 8;
  profile.interface = kUsbNetwork;
  profile.peers.clear();
  profile.multicast = true;
  profile.max_participants = 10;
  return profile;
}

// Access points send multicast at the lowest rate, or not at all: peers are named instead.
LinkProfile wifi() {
  LinkProfile profile = usb();
  profile.name = "wifi";
  profile.interface = "auto";
  profile.multicast = false;
  return profile;
}

std::optional<LinkProfile> known(std::string_view name) {
  if (name == "loopback") return LinkProfile{};
  if (name == "usb") return usb();
  if (name == "wifi") return wifi();
  return std::nullopt;
}

Result<LinkProfile> from_file(const std::string& path) {
  ENAMEL_TRY_ASSIGN(auto reader, ConfigReader::from_file(path));
  std::string base = "usb";
  reader.bind("link.base", base, "profile that this one starts from: loopback, usb or wifi");
  const auto from = known(base);
  if (!from) reader.reject("link.base", "loopback, usb or wifi");
  LinkProfile profile = from.value_or(LinkProfile{});
  profile.name = path;
  reader.bind("link.interface", profile.interface, "name, network (169.254.77.0/24) or auto");
  reader.bind("link.peers", profile.peers, "addresses of the other end");
  reader.bind("link.multicast", profile.multicast, "find each other by multicast");
  reader.bind("link.message_bytes", profile.message_bytes, {512, 65500}, "largest datagram, bytes");
  reader.bind("link.fragment_bytes", profile.fragment_bytes, {256, 65000}, "piece of a burst, bytes");
  reader.bind("link.nack_delay_ms", profile.nack_delay_ms, {0, 1000}, "from a gap seen to asking again, ms");
  reader.bind("link.heartbeat_ms", profile.heartbeat_ms, {5, 1000}, "between two tellings of how far it goes, ms");
  reader.bind("link.send_window_mb", profile.send_window_mb, {1, 512}, "unacknowledged before a write waits, MB");
  if (profile.fragment_bytes + 100 > profile.message_bytes) {
    reader.reject("link.fragment_bytes", "a fragment and 100 bytes of headers must fit into message_bytes");
  }
  ENAMEL_TRY(reader.finish());
  return profile;
}

std::optional<std::uint32_t> ipv4(const std::string& text) {
  in_addr address{};
  if (::inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
  return ntohl(address.s_addr);
}

std::string text_of(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return text.data();
}

struct Network {
  std::uint32_t address = 0;
  std::uint32_t mask = 0;
};

/// Nullopt: no network, hence a name.
std::optional<Network> network(const std::string& text) {
  const auto slash = text.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto address = ipv4(text.substr(0, slash));
  unsigned bits = 33;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data() + slash + 1, end, bits);
  if (!address || error != std::errc{} || stopped != end || bits > 32) return std::nullopt;
  const std::uint32_t mask = bits == 0 ? 0U : ~std::uint32_t{0} << (32U - bits);
  return Network{*address & mask, mask};
}

/// Address from which this machine would talk to `peer`; nothing is sent.
std::optional<std::string> own_address_towards(const std::string& peer) {
  const auto to = ipv4(peer);
  if (!to) return std::nullopt;
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return std::nullopt;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(9);
  address.sin_addr.s_addr = htonl(*to);
  sockaddr_storage storage{};
  std::memcpy(&storage, &address, sizeof address);
  socklen_t size = sizeof storage;
  const bool routed = ::connect(fd, reinterpret_cast<const sockaddr*>(&storage), sizeof address) == 0 &&
                      ::getsockname(fd, reinterpret_cast<sockaddr*>(&storage), &size) == 0;
  ::close(fd);
  if (!routed) return std::nullopt;
  std::memcpy(&address, &storage, sizeof address);
  return text_of(address);
}

struct Interface {
  std::string name;
  std::string address;
};

std::vector<Interface> interfaces() {
  std::vector<Interface> found;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return found;
  for (const ifaddrs* i = list; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET || (i->ifa_flags & IFF_UP) == 0) continue;
    sockaddr_in address{};
    std::memcpy(&address, i->ifa_addr, sizeof address);
    found.push_back({i->ifa_name, text_of(address)});
  }
  ::freeifaddrs(list);
  return found;
}

std::optional<std::string> find(const LinkProfile& profile, const std::vector<Interface>& all) {
  if (profile.interface == "auto") {
    // Towards the other end, else towards the world (an address of the documentation's network), else what there is.
    for (const std::string& peer : profile.peers.empty() ? std::vector<std::string>{"192.0.2.1"} : profile.peers) {
      const auto own = own_address_towards(peer);
      for (const Interface& i : all) {
        if (own && i.address == *own) return i.name;
      }
    }
    for (const Interface& i : all) {
      if (i.name != "lo") return i.name;
    }
    return std::nullopt;
  }
  const auto wanted = network(profile.interface);
  for (const Interface& i : all) {
    if (!wanted && i.name == profile.interface) return i.name;
    const auto address = ipv4(i.address);
    if (wanted && address && (*address & wanted->mask) == wanted->address) return i.name;
  }
  return std::nullopt;
}

}  // namespace

Result<LinkProfile> read_link(const std::string& name_or_file) {
  if (const auto profile = known(name_or_file)) return *profile;
  if (name_or_file.ends_with(".toml")) return from_file(name_or_file);
  return fail(ErrorCode::kUsage, "--link " + name_or_file + ": loopback, usb, wifi or a file that ends in .toml");
}

std::string interfaces_text() {
  std::string text;
  for (const Interface& i : interfaces()) text += (text.empty() ? "" : ", ") + i.name + " " + i.address;
  return text.empty() ? "none" : text;
}

Result<std::string> interface_of(const LinkProfile& profile) {
  if (auto name = find(profile, interfaces())) return *name;
  std::string what = "no network interface " + profile.interface + " that is up and has an IPv4 address";
  if (profile.name == "usb") {
    what =
        "the probe's USB network (" + profile.interface + ") is not there: is its cable in, is the probe switched on?";
  } else if (profile.interface == "lo") {
    what = "the loopback interface is not up (ip link set lo up)";
  }
  return fail(ErrorCode::kDds, "link " + profile.name + ": " + what + "; there is: " + interfaces_text());
}

std::string proposed_link() { return find(usb(), interfaces()) ? "usb" : "loopback"; }

}  // namespace enamel::dds
