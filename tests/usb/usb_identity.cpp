#include "tests/usb/usb_identity.hpp"

#include <array>
#include <cstdio>

#include "protocol/base/sha256.hpp"

namespace enamel::test {
namespace {

/// Device, configuration, DFU interface, DFU functional descriptor (DFU 1.1 §4.2).
std::vector<std::uint8_t> descriptors(std::uint16_t bcd_device) {
  const auto low = static_cast<std::uint8_t>(bcd_device & 0xFFU), high = static_cast<std::uint8_t>(bcd_device >> 8U);
  // clang-format off
  return {18, 1, 0x00, 0x02, 0, 0, 0, 64, 0x09, 0x12, 0x01, 0x00, low, high, 1, 2, 3, 1,
          9, 2, 27, 0, 1, 1, 0, 0x80, 250,
          9, 4, 0, 0, 0, 0xFE, 1, 2, 0,
          9, 0x21, 0x07, 0xE8, 0x03, 0x00, 0x10, 0x10, 0x01};
  // clang-format on
}

}  // namespace

std::string syspath(int port) { return "/sys/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(port); }
std::string devnode(int port) { return "/dev/bus/usb/001/00" + std::to_string(port + 1); }

std::string testbed_text(const UsbIdentity& i) {
  std::array<char, 8> bcd{};
  std::snprintf(bcd.data(), bcd.size(), "%04x", i.bcd_device);
  const std::string address = std::to_string(i.port + 1), node = devnode(i.port);
  return "P: " + syspath(i.port).substr(4) + "\nN: " + node.substr(5) +
         "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DEVNAME=" + node + "\nE: BUSNUM=001\nE: DEVNUM=00" + address +
         "\nE: MAJOR=189\nE: MINOR=" + std::to_string(i.port) + "\nA: busnum=1\\n\nA: devnum=" + address +
         "\\n\nA: speed=" + std::to_string(i.speed_mbit) +
         "\\n\nA: bConfigurationValue=1\\n\nA: idVendor=1209\\n\nA: idProduct=0001\\n\nA: bcdDevice=" + bcd.data() +
         "\\n\nA: serial=" + i.serial + "\\n\nH: descriptors=" + to_hex(descriptors(i.bcd_device)) + "\n\n";
}

std::vector<std::byte> string_descriptor(const UsbIdentity& identity, std::size_t index) {
  const std::array<std::string, 4> strings = {"", "enamel", "enamel probe", identity.serial};
  if (index >= strings.size()) return {};
  if (index == 0) return {std::byte{4}, std::byte{3}, std::byte{9}, std::byte{4}};
  const std::string& text = strings[index];
  std::vector<std::byte> out = {static_cast<std::byte>(2 + 2 * text.size()), std::byte{3}};
  for (const char c : text) {
    out.push_back(static_cast<std::byte>(c));
    out.push_back(std::byte{0});
  }
  return out;
}

}  // namespace enamel::test
