// The gadget around the function: identity and connection, through configfs (Linux' gadget_configfs).
#pragma once

#include <string>

#include "protocol/image/manifest.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

struct GadgetIdentity {
  bool recovery = false;
  image::ImageVersion version;  ///< of the running firmware; hosts see major and minor as bcdDevice
  std::string serial;
};

/// `folder`: the gadget's folder in configfs, made and given its function by whoever started the program. Writes the
/// identity and connects to the first USB device controller of `controllers`. kFileNotFound, kGadget.
[[nodiscard]] Result<void> connect_gadget(const std::string& folder, const GadgetIdentity& identity,
                                          const std::string& controllers = "/sys/class/udc");
/// The host sees the probe go.
void disconnect_gadget(const std::string& folder) noexcept;

}  // namespace enamel::fw
