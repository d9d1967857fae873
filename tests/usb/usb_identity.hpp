// What an emulated probe shows of itself on the bus before any firmware is asked: descriptors, sysfs attributes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace enamel::test {

struct UsbIdentity {
  int port = 1;  ///< port of the root hub of bus 1, from 1
  std::uint16_t bcd_device = 0;
  int speed_mbit = 480;
  std::string serial;
};

[[nodiscard]] std::string syspath(int port);
[[nodiscard]] std::string devnode(int port);

/// The device in umockdev's own text format, of which libudev and sysfs are then made.
[[nodiscard]] std::string testbed_text(const UsbIdentity& identity);

/// String descriptor `index`, in UTF-16; index 0 are the languages. Empty for an index that there is not.
[[nodiscard]] std::vector<std::byte> string_descriptor(const UsbIdentity& identity, std::size_t index);

}  // namespace enamel::test
